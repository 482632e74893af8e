//! The two sweeps over the nodes: elimination from N₀ to the tail at an iterate, and back.

use core::ops::Range;

use super::adhere::grip;
use super::bend::{self, Joint};
use super::chain::Chain;
use super::config::Params;
use super::contact::press;
use super::course::slide;
use super::front::{Condensed, Crossing, Front, Row};
use super::link::{self, Link};
use super::state::{NODES_MAX, Place, State};
use super::work::Work;
use crate::coupling::{POINTS, PUNCTURES};
use crate::math::{Mat3, Vec3};

/// Linearises at the iterate and eliminates the nodes; the result is about the iterate. An effect that is off has no part in the pass.
pub(super) fn eliminate(params: &Params, state: &State, work: &mut Work, slack: f32) {
    let (floats, hovers) = (|_: f32, _: &mut Front| (), |_: &Work, _: usize, _: &mut Front| ());
    let weighs = |weight: f32| move |share: f32, front: &mut Front| front.force.z -= weight * share;
    let lies = |penalty: f32| move |work: &Work, index: usize, front: &mut Front| lie(penalty, work, index, front);
    match (params.weight, params.penalty) {
        (None, None) => join(params, state, work, slack, (floats, hovers)),
        (None, Some(penalty)) => join(params, state, work, slack, (floats, lies(penalty))),
        (Some(weight), None) => join(params, state, work, slack, (weighs(weight), hovers)),
        (Some(weight), Some(penalty)) => join(params, state, work, slack, (weighs(weight), lies(penalty))),
    }
}

/// The same; `fall` adds the weight of a node with this share of mass to the front, and `lie` what the ground does to it.
fn join(
    params: &Params,
    state: &State,
    work: &mut Work,
    slack: f32,
    (fall, lie): (impl Fn(f32, &mut Front), impl Fn(&Work, usize, &mut Front)),
) {
    let hangs =
        |work: &mut Work, index: usize, _: usize, front: &mut Front| front.eliminate(&at(params, work, index, slack));
    match params.bending {
        None => forward(params, state, work, slack, (fall, lie, hangs)),
        Some(stiffness) => {
            let bends = |work: &mut Work, index: usize, newer: usize, front: &mut Front| {
                bend(params, stiffness, work, (index, newer), front)
            };
            forward(params, state, work, slack, (fall, lie, bends));
        }
    }
}

/// The same; `pass` eliminates a node whose link is free of eyelets, with those from the given one on before it.
fn forward(
    params: &Params,
    state: &State,
    work: &mut Work,
    slack: f32,
    (fall, lie, pass): (
        impl Fn(f32, &mut Front),
        impl Fn(&Work, usize, &mut Front),
        impl Fn(&mut Work, usize, usize, &mut Front) -> Row,
    ),
) {
    work.reduced = Condensed {
        len: work.reduced.len,
        ..Condensed::default()
    };
    work.crossed = 0;
    let mut front = Front::default();
    let mut newer = work.course.count;
    let (last, held) = (params.nodes - 1, work.ends.tail.is_some());
    let free = params.nodes - usize::from(held);
    for index in 0..free {
        own(params, state, work, index, (&fall, &mut front));
        lie(work, index, &mut front);
        let eyelets = work.course.within(index, newer);
        let row = if eyelets.is_empty() || index == last {
            pass(work, index, newer, &mut front)
        } else {
            newer = eyelets.start;
            cross(params, work, (index, eyelets), slack, &mut front)
        };
        if let Some(slot) = work.rows.get_mut(index) {
            *slot = row;
        }
    }
    let seen = seen(work);
    front.end(held, &seen, &mut work.reduced);
    work.reduced.symmetrise();
}

/// What nodes behind the last crossing see of the eyelets.
fn seen(work: &Work) -> [Mat3; PUNCTURES] {
    let last = work.crossed.checked_sub(1).and_then(|last| work.crossings.get(last));
    last.map_or([Mat3::zeros(); PUNCTURES], |crossing| crossing.seen)
}

/// Eliminates node `index`, whose link passes `eyelets`.
fn cross(
    params: &Params,
    work: &mut Work,
    (index, eyelets): (usize, Range<usize>),
    slack: f32,
    front: &mut Front,
) -> Row {
    let passed = seen(work);
    let tied = work.course.knot.filter(|_| eyelets.end == work.course.count);
    let chain = Chain::new((&work.nodes, params.nodes), &work.course, index, eyelets.clone());
    let strain = chain.strain(params, slack, tied);
    grip(params, &mut work.course, (&chain, eyelets.clone()), &strain);
    let forces = chain.forces(&strain);
    let mut crossing = Crossing {
        link: index,
        eyelets: [eyelets.start, eyelets.end],
        tangents: chain.tangents,
        ..Crossing::default()
    };
    let row = front.cross(&forces, &mut crossing, &passed, &mut work.reduced);
    if let Some(slot) = work.crossings.get_mut(work.crossed) {
        *slot = crossing;
        work.crossed += 1;
    }
    row
}

/// Eliminates node `index` of a thread that bends; its link is free of eyelets, and those from `newer` on are before it.
fn bend(params: &Params, stiffness: f32, work: &mut Work, (index, newer): (usize, usize), front: &mut Front) -> Row {
    let mut link = Link::default();
    if let (Some(a), Some(b)) = (work.nodes.get(index), work.nodes.get(index + 1))
        && index + 1 < params.nodes
    {
        link = link::rod(params, a.to(b));
        if index == 0 {
            let clamp = bend::clamp(params, stiffness, &work.ends, a.to(b));
            link.on_a += clamp.on_a;
            link.block += clamp.block;
        }
    }
    let joint = if index + 2 < params.nodes && work.course.within(index + 1, newer).is_empty() {
        Joint::new(stiffness, &work.nodes, index)
    } else {
        Joint::default()
    };
    let (row, beyond) = front.bend(&link, &joint);
    if let Some(slot) = work.beyond.get_mut(index) {
        *slot = beyond;
    }
    row
}

/// Adds what acts on node `index` alone: inertia, weight and the swage.
fn own(
    params: &Params,
    state: &State,
    work: &Work,
    index: usize,
    (fall, front): (impl Fn(f32, &mut Front), &mut Front),
) {
    let (Some(old), Some(velocity), Some(new)) =
        (state.nodes.get(index), state.velocity.get(index), work.nodes.get(index))
    else {
        return;
    };
    let share = params.share(index);
    let inertia = params.inertia * share;
    let mut diagonal = inertia;
    front.force += (velocity * params.coast - old.to(new)) * inertia;
    fall(share, front);
    if let (0, Some(swage)) = (index, work.ends.swage) {
        front.force += new.to(&Place::new(swage)) * params.coupling;
        diagonal += params.coupling;
    }
    front.block += Mat3::from_diagonal_element(diagonal);
}

/// Adds what the ground under node `index` does to it.
fn lie(penalty: f32, work: &Work, index: usize, front: &mut Front) {
    if let (Some(Some(touch)), Some(node)) = (work.touch.get(index), work.nodes.get(index)) {
        let (force, block) = press(touch, penalty, node.fine);
        front.force += force;
        front.block += block;
    }
}

/// Link `index` at the iterate; none behind the last node.
fn at(params: &Params, work: &Work, index: usize, slack: f32) -> Link {
    match (work.nodes.get(index), work.nodes.get(index + 1)) {
        (Some(a), Some(b)) if index + 1 < params.nodes => link::plain(params, a.to(b), slack),
        _ => Link::default(),
    }
}

/// Moves the iterate: the points by `moved`, the nodes by what follows from it; then lets the thread slide by a node.
pub(super) fn substitute(params: &Params, work: &mut Work, moved: &[Vec3; POINTS]) {
    if params.bending.is_some() {
        back(params, work, moved, |beyond, index, further| {
            beyond.get(index).map_or_else(Vec3::zeros, |block| block * further)
        });
    } else {
        back(params, work, moved, |_, _, _| Vec3::zeros());
    }
    let Work {
        nodes,
        course,
        crossings,
        crossed,
        ..
    } = work;
    for crossing in crossings.iter().take(*crossed) {
        slide(
            params,
            nodes,
            course,
            (crossing.link, crossing.range()),
            crossing.tangents,
        );
    }
}

/// Moves the iterate; `reach` says what a node has of the displacement of the one after the next.
fn back(
    params: &Params,
    work: &mut Work,
    moved: &[Vec3; POINTS],
    reach: impl Fn(&[Mat3; NODES_MAX], usize, Vec3) -> Vec3,
) {
    let [tail, eyelets @ ..] = moved;
    let held = usize::from(work.ends.tail.is_some());
    let (mut next, mut further) = (*tail, Vec3::zeros());
    if let (1, Some(node)) = (held, work.nodes.get_mut(params.nodes - 1)) {
        node.fine += tail;
    }
    for (eyelet, moved) in work.course.eyelets.iter_mut().zip(eyelets).take(work.course.count) {
        eyelet.place.fine += moved;
    }
    let sum = |blocks: &[Mat3; PUNCTURES]| -> Vec3 { blocks.iter().zip(eyelets).map(|(block, c)| block * c).sum() };
    let mut crossings = work.crossings.iter().take(work.crossed).rev().peekable();
    let mut y = crossings
        .peek()
        .map_or_else(Vec3::zeros, |crossing| sum(&crossing.seen));
    let nodes = work.nodes.iter_mut().zip(&work.rows).enumerate();
    for (index, (node, row)) in nodes.take(params.nodes - held).rev() {
        let by = if let Some(crossing) = crossings.next_if(|crossing| crossing.link == index) {
            y = crossings
                .peek()
                .map_or_else(Vec3::zeros, |crossing| sum(&crossing.seen));
            sum(&crossing.columns)
        } else {
            reach(&work.beyond, index, further)
        };
        let own = row.alone - row.next * next - row.onto * y - by;
        node.fine += own;
        (further, next) = (next, own);
    }
}
