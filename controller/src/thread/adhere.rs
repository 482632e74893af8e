//! What holds the thread from tick to tick: where it adheres in its punctures, and what has slipped through its knot.

use core::ops::Range;

use super::chain::{Chain, Strain};
use super::config::Params;
use super::course::Course;
use super::knot;
use super::pull::Sum;
use super::state::{Place, State};
use crate::math::{Vec3, direction, length};

/// Keeps the friction of the iterate.
pub(super) fn grip(params: &Params, course: &mut Course, (chain, eyelets): (&Chain, Range<usize>), strain: &Strain) {
    if params.friction.is_none() {
        return;
    }
    let tied = usize::from(course.knot.is_some() && eyelets.end == course.count);
    let held = course.eyelets.get_mut(eyelets).unwrap_or_default().iter_mut().rev();
    let parted = strain.tension.iter().zip(strain.tension.iter().skip(1));
    for (eyelet, (before, behind)) in held.zip(parted).take(chain.eyelets()).skip(tied) {
        eyelet.grip.drag = before - behind;
    }
}

/// Lets the thread adhere where it has come to, and the knot slip: the tick's end.
pub(super) fn adhere(params: &Params, state: &mut State) {
    if params.friction.is_none() && state.course.knot.is_none() {
        return;
    }
    let mut newer = state.course.count;
    while let Some(newest) = newer.checked_sub(1).and_then(|index| state.course.eyelets.get(index)) {
        let link = newest.link;
        let eyelets = state.course.within(link, newer);
        let tied = state.course.knot.filter(|_| eyelets.end == state.course.count);
        let chain = Chain::new((&state.nodes, params.nodes), &state.course, link, eyelets.clone());
        let strain = chain.strain(params, 0.0, tied);
        grip(params, &mut state.course, (&chain, eyelets.clone()), &strain);
        let from = usize::from(tied.is_some());
        let held = state.course.eyelets.get_mut(eyelets.clone()).unwrap_or_default();
        for (index, eyelet) in held.iter_mut().rev().enumerate().skip(from) {
            let strained = eyelet.grip.drag / params.stiffness();
            eyelet.grip.adhesion = Some(chain.way(from, index + 1) - strained);
        }
        newer = eyelets.start;
        if let Some(rest) = tied {
            let sides = sides(params, state, (&chain, link, eyelets), rest);
            let tension = sides.map(|side| side.tension());
            let slip = knot::slip(params, tension, sides.map(|side| side.compliance));
            let (next, rest) = knot::lead(params, link, rest, slip);
            state.course.knot = Some(rest);
            if next != link {
                pass_knot(params, state, (link, next), tension);
            }
        }
    }
}

/// The thread from its knot in `link` to N₀, and to the next puncture or the tail: single links of a slack thread snap within a tick, all
/// of them together do not.
fn sides(
    params: &Params,
    state: &State,
    (chain, link, eyelets): (&Chain, usize, Range<usize>),
    [needle_rest, tail_rest]: [f32; 2],
) -> [Sum; 2] {
    let older = eyelets
        .end
        .checked_sub(2)
        .and_then(|index| state.course.through().get(index));
    let last = older.map_or(params.nodes - 1, |eyelet| eyelet.link);
    let (mut needle, mut tail) = (Sum::default(), Sum::default());
    let tail_side = chain.length_from(1);
    needle.part(params, chain.length_from(0) - tail_side, needle_rest);
    tail.part(params, tail_side, tail_rest);
    let links = state.nodes.iter().zip(state.nodes.iter().skip(1)).enumerate();
    for (index, (a, b)) in links.take(last).filter(|(index, _)| *index != link) {
        let side = if index < link { &mut needle } else { &mut tail };
        side.link(params, length(a.to(b)));
    }
    [needle, tail]
}

/// Passes the node between links `from` and `to` through the knot: it is put on the other side, on the line to its neighbour there, so far
/// from the knot that its new part has the tension of that side.
fn pass_knot(params: &Params, state: &mut State, (from, to): (usize, usize), [needle, tail]: [f32; 2]) {
    let Some(index) = state.course.count.checked_sub(1) else {
        return;
    };
    let Some(knot) = state.course.eyelets.get_mut(index) else {
        return;
    };
    knot.link = to;
    let place = knot.place;
    let alone = index..index + 1;
    let [needle_rest, tail_rest] = state.course.knot.unwrap_or_default();
    let (node, neighbour, rest, tension) = if to < from {
        let after = state.course.after((&state.nodes, params.nodes), to, &alone);
        (from, after, tail_rest, tail)
    } else {
        (to, state.course.before(&state.nodes, to, &alone), needle_rest, needle)
    };
    let way = neighbour.map_or_else(Vec3::zeros, |neighbour| direction(place.to(neighbour), 1e-9));
    if let Some(node) = state.nodes.get_mut(node) {
        let length = rest + tension / knot::tied_stiffness(params, rest);
        let beyond = Place {
            fine: place.fine + way * length,
            ..place
        };
        *node = beyond.normalised();
    }
}
