//! The knot: it ties the thread at its last puncture. Within a tick it holds; it slips at the end of one in which the tensions on its two sides differ by
//! more than it holds.

use super::config::Params;
use super::link::spring;

/// Two parts of a link, `length` long and of rest lengths `rest` [m], on both sides of a knot that holds, towards the needle and towards
/// the tail: tension [N], and what it gains with its own length [N/m]. For `slack` see [`spring`].
pub(super) fn hold(params: &Params, length: [f32; 2], rest: [f32; 2], slack: f32) -> [(f32, f32); 2] {
    [0, 1].map(|side| spring(tied_stiffness(params, rest[side]), length[side] - rest[side], slack))
}

/// Rest length that goes from the needle's side of a knot to the tail's at the end of a tick, so that their tensions `needle` and `tail`
/// [N] come to differ by no more than the limit. `compliance` is that of the thread on both sides up to what holds it next [m/N]; that
/// gives way too, so this is never too much.
pub(super) fn slip(params: &Params, [needle, tail]: [f32; 2], compliance: [f32; 2]) -> f32 {
    let limit = params.knot.unwrap_or_default();
    let difference = tail - needle;
    let excess = difference - difference.max(-limit).min(limit);
    let stiffness: f32 = compliance.iter().map(|compliance| 1.0 / compliance).sum();
    // A blow is no slip: half a link a tick is more than a knot gives way by.
    let most = 0.5 * params.rest;
    (excess / stiffness).max(-most).min(most)
}

/// Lets `slip` through the knot in `link`, whose parts have `rest` lengths; a node that slips through leaves the knot in the next link.
pub(super) fn lead(params: &Params, link: usize, rest: [f32; 2], slip: f32) -> (usize, [f32; 2]) {
    let [needle, tail] = rest;
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
