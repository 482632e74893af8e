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
    /// Rest length that goes from the needle's side to the tail's at the end of the tick [m].
    pub(super) slip: f32,
}

/// Two parts of a link, `length` long and of rest lengths `rest` [m], on both sides of a knot. Within a tick it holds; at the end it slips
/// by what brings the difference of their tensions back to the limit.
pub(super) fn hold(params: &Params, length: [f32; 2], rest: [f32; 2]) -> Held {
    let [needle, tail] = [0, 1].map(|side| {
        let stiffness = tied_stiffness(params, rest[side]);
        spring(stiffness, length[side] - rest[side], 0.0)
    });
    let difference = tail.0 - needle.0;
    let limit = params.knot.unwrap_or_default();
    let excess = difference - difference.max(-limit).min(limit);
    Held {
        tension: [needle.0, tail.0],
        stiffness: [needle.1, tail.1],
        slip: excess / (needle.1 + tail.1).max(f32::MIN_POSITIVE),
    }
}

/// Lets `slip` through the knot in `link`, whose parts have `rest` lengths; a node that slips through leaves the knot in the next link.
pub(super) fn slip(params: &Params, link: usize, rest: [f32; 2], slip: f32) -> (usize, [f32; 2]) {
    let [needle, tail] = rest;
    // A blow is no slip: half a link a tick is more than a knot gives way by.
    let most = 0.5 * params.rest;
    let slip = slip.max(-most).min(most);
    let (needle, tail) = (needle - slip, tail + slip);
    if slip == 0.0 {
        (link, rest)
    } else if needle < 0.0 && link > 0 {
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
