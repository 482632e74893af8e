//! The knot: it ties the thread at its last puncture, and slips where the tensions on its two sides differ by more than it holds.

use super::config::Params;
use super::link::spring;

/// Both sides of a knot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Held {
    /// Tensions towards the needle and towards the tail [N].
    pub(super) tension: [f32; 2],
    /// What each gains with its own length [N/m].
    pub(super) stiffness: [f32; 2],
    /// What each gains with the other's [N/m].
    pub(super) shared: f32,
    /// Rest length that goes from the needle's side to the tail's [m].
    pub(super) slip: f32,
}

/// Two parts of a link, `length` long and of rest lengths `rest` [m], on both sides of a knot. It slips by what brings the difference of
/// their tensions back to the limit.
pub(super) fn hold(params: &Params, length: [f32; 2], rest: [f32; 2]) -> Held {
    let [ka, kb] = rest.map(|rest| tied_stiffness(params, rest));
    let ([a, b], [a_rest, b_rest]) = (length, rest);
    let (ea, eb) = (a - a_rest, b - b_rest);
    let ((ta, sa), (tb, sb)) = (spring(ka, ea, 0.0), spring(kb, eb, 0.0));
    let limit = params.knot.unwrap_or_default();
    if (tb - ta).abs() <= limit {
        return Held {
            tension: [ta, tb],
            stiffness: [sa, sb],
            ..Held::default()
        };
    }
    let difference = if tb > ta { limit } else { -limit };
    // Both sides taut: springs in series, their tensions apart by the limit.
    let series = ka * kb / (ka + kb);
    let towards_needle = series * (ea + eb - difference / kb);
    let towards_tail = towards_needle + difference;
    // One side slack: the other has the limit, and the parabola through force and place for its stiffness.
    let (tension, stiffness, shared) = if towards_needle.min(towards_tail) > 0.0 {
        ([towards_needle, towards_tail], [series; 2], series)
    } else if difference > 0.0 {
        ([0.0, limit], [0.0, limit / eb], 0.0)
    } else {
        ([limit, 0.0], [limit / ea, 0.0], 0.0)
    };
    let [_, end] = tension;
    let slip = eb - end / kb;
    Held {
        tension,
        stiffness,
        shared,
        slip,
    }
}

/// Lets `slip` through the knot in `link`, whose parts have `rest` lengths; a node that slips through leaves the knot in the next link.
pub(super) fn slip(params: &Params, link: usize, rest: [f32; 2], slip: f32) -> (usize, [f32; 2]) {
    let [needle, tail] = [rest[0] - slip, rest[1] + slip];
    if needle < 0.0 && link > 0 {
        (link - 1, [needle + params.rest, -needle])
    } else if tail < 0.0 && link + 2 < params.nodes {
        (link + 1, [-tail, tail + params.rest])
    } else {
        (link, [needle.max(0.0), tail.max(0.0)])
    }
}

/// Stiffness of a tied piece of rest length `rest` [N/m]. A knot is no stiffer than a tenth of a link of its thread.
pub(super) fn tied_stiffness(params: &Params, rest: f32) -> f32 {
    params.axial / rest.max(0.1 * params.rest)
}

/// The rest length of a piece `length` long under `tension`.
pub(super) fn tied_rest(params: &Params, length: f32, tension: f32) -> f32 {
    let even = length / (1.0 + tension / params.axial);
    if even >= 0.1 * params.rest {
        even
    } else {
        length - tension / tied_stiffness(params, 0.0)
    }
}
