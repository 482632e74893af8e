//! One backward Euler step: linearise, eliminate every node onto the tissue's points, substitute back.

use core::ops::Range;

use super::adhere::{adhere, grip};
use super::answer::answer;
use super::chain::Chain;
use super::config::Params;
use super::contact::{Ground, Touch, press};
use super::course::{Course, slide};
use super::front::{Condensed, Crossing, Front, Row};
use super::link::{self, Link};
use super::pull::{Pull, pull};
use super::state::{NODES_MAX, Place, State};
use crate::coupling::{POINTS, PUNCTURES};
use crate::math::{DT, Mat3, Vec3};

/// Newton iterations of the thread alone before it is linearised for the tissue.
const ITERATIONS: usize = 7;
/// In the first iteration a link this much shorter than at rest, of its length, is taken for taut: a thread becomes taut all
/// along at once, and would do so link by link otherwise.
const NEARLY_TAUT: f32 = 0.02;

/// What holds the thread, at its predicted position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ends {
    /// The needle's swage [m]; none where the thread is cut from the needle.
    pub swage: Option<Vec3>,
    /// The tissue's point that holds N₍ₙ₋₁₎ [m]; none where the tail is free.
    pub tail: Option<Vec3>,
    /// The tissue's points through which the thread runs [m], in the order of its [`Course`]; only so many have a meaning.
    pub eyelets: [Vec3; PUNCTURES],
    /// About what the tissue answers a point's displacement with, springs and inertia [N/m]; more than zero. It steers the
    /// thread's own iterations and has no part in the result once they have converged.
    pub end_stiffness: f32,
}

/// What `condense` leaves for `settle`.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// Force of each node on the ground [N], after `settle`.
    pub reaction: [Vec3; NODES_MAX],
    nodes: [Place; NODES_MAX],
    course: Course,
    ends: Ends,
    reduced: Condensed,
    touch: [Option<Touch>; NODES_MAX],
    rows: [Row; NODES_MAX],
    crossings: [Crossing; PUNCTURES],
    crossed: usize,
}

impl Default for Work {
    fn default() -> Self {
        Self {
            reaction: [Vec3::zeros(); NODES_MAX],
            nodes: [Place::default(); NODES_MAX],
            course: Course::default(),
            ends: Ends::default(),
            reduced: Condensed::default(),
            touch: [None; NODES_MAX],
            rows: [Row::default(); NODES_MAX],
            crossings: [Crossing::default(); PUNCTURES],
            crossed: 0,
        }
    }
}

/// Advances the thread in thought against tissue that answers with `ends.end_stiffness`, linearises it there and eliminates
/// every node. The operation count is that of the nodes and eyelets there are; `state` is not changed.
pub fn condense<'w, G: Ground>(
    params: &Params,
    state: &State,
    ends: &Ends,
    ground: &G,
    work: &'w mut Work,
) -> &'w Condensed {
    begin(params, state, ends, work);
    look(params, ground, work);
    for iteration in 0..ITERATIONS {
        let slack = if iteration == 0 { NEARLY_TAUT * params.rest } else { 0.0 };
        eliminate(params, state, work, slack);
        let moved = answer(&work.reduced, ends.end_stiffness, &unbalanced(params, state, work));
        substitute(params, work, &moved);
    }
    eliminate(params, state, work, 0.0);
    // What was linearised about the iterate, counted from the predicted positions.
    let back = iterate(params, work).map(|c| -c);
    work.reduced.force = work.reduced.at(&back);
    &work.reduced
}

/// Ends the tick that `condense` began: the points, the tail's and then the eyelets', have `moved` by this much from their predicted
/// positions [m].
pub fn settle(params: &Params, state: &mut State, work: &mut Work, moved: &[Vec3; POINTS]) -> Pull {
    let mut further = *moved;
    let reached = iterate(params, work);
    further.iter_mut().zip(&reached).for_each(|(f, r)| *f -= r);
    substitute(params, work, &further);
    let all = state.nodes.iter_mut().zip(&mut state.velocity);
    for ((node, velocity), new) in all.zip(&work.nodes).take(params.nodes) {
        *velocity = node.to(new) / DT;
        *node = new.normalised();
    }
    state.course = work.course;
    for eyelet in &mut state.course.eyelets {
        eyelet.place = Place::new(eyelet.place.point());
    }
    state.load = work.reduced.at(moved);
    adhere(params, state);
    react(params, work);
    pull(params, state, work.ends.swage)
}

/// The first iterate is the thread as it was, points included: only from there is it known which node is before the eyelet
/// and which has passed it.
fn begin(params: &Params, state: &State, ends: &Ends, work: &mut Work) {
    work.ends = *ends;
    work.course = state.course;
    work.nodes = state.nodes;
    work.reduced.len = state.course.count.min(PUNCTURES) + 1;
    for (eyelet, predicted) in work.course.eyelets.iter_mut().zip(&ends.eyelets) {
        eyelet.place = from(*predicted, &eyelet.place);
    }
    if let (Some(tail), Some(node)) = (ends.tail, work.nodes.get_mut(params.nodes - 1)) {
        *node = from(tail, node);
    }
}

/// The same place as a displacement from `predicted`.
fn from(predicted: Vec3, place: &Place) -> Place {
    let new = Place::new(predicted);
    Place {
        fine: new.to(place),
        ..new
    }
}

/// Looks for the ground under every free node, once a tick.
fn look<G: Ground>(params: &Params, ground: &G, work: &mut Work) {
    if params.penalty.is_none() {
        return;
    }
    let free = params.nodes - usize::from(work.ends.tail.is_some());
    for (index, (touch, node)) in work.touch.iter_mut().zip(&work.nodes).enumerate().take(params.nodes) {
        *touch = if index < free { ground.at(node.point()) } else { None };
        // The plane is kept relative to the node's coarse part, from which it moves.
        if let Some(touch) = touch {
            touch.gap -= touch.normal.dot(&node.fine);
        }
    }
}

/// Displacements of the points' iterates from their predictions.
fn iterate(params: &Params, work: &Work) -> [Vec3; POINTS] {
    let mut moved = [Vec3::zeros(); POINTS];
    let tail = work.nodes.get(params.nodes - 1).filter(|_| work.ends.tail.is_some());
    let eyelets = work.course.through().iter().map(|eyelet| eyelet.place.fine);
    let points = [tail.map_or_else(Vec3::zeros, |node| node.fine)]
        .into_iter()
        .chain(eyelets);
    moved.iter_mut().zip(points).for_each(|(moved, fine)| *moved = fine);
    moved
}

/// What pulls on the points at the iterate, if the tissue at its prediction bears the thread's last forces and answers any change
/// with springs of `end_stiffness`.
fn unbalanced(params: &Params, state: &State, work: &Work) -> [Vec3; POINTS] {
    let mut force = work.reduced.force;
    let tissue = state.load.iter().zip(iterate(params, work));
    for (force, (load, moved)) in force.iter_mut().zip(tissue) {
        *force -= load + moved * work.ends.end_stiffness;
    }
    if let (None, [tail, ..]) = (work.ends.tail, &mut force) {
        *tail = Vec3::zeros();
    }
    force
}

/// Linearises at the iterate and eliminates the nodes; the result is about the iterate. An effect that is off has no part in the pass.
fn eliminate(params: &Params, state: &State, work: &mut Work, slack: f32) {
    let (floats, hovers) = (|_: f32, _: &mut Front| (), |_: &Work, _: usize, _: &mut Front| ());
    let weighs = |weight: f32| move |share: f32, front: &mut Front| front.force.z -= weight * share;
    let lies = |penalty: f32| move |work: &Work, index: usize, front: &mut Front| lie(penalty, work, index, front);
    match (params.weight, params.penalty) {
        (None, None) => forward(params, state, work, slack, (floats, hovers)),
        (None, Some(penalty)) => forward(params, state, work, slack, (floats, lies(penalty))),
        (Some(weight), None) => forward(params, state, work, slack, (weighs(weight), hovers)),
        (Some(weight), Some(penalty)) => forward(params, state, work, slack, (weighs(weight), lies(penalty))),
    }
}

/// The same; `fall` adds the weight of a node with this share of mass to the front, and `lie` what the ground does to it.
fn forward(
    params: &Params,
    state: &State,
    work: &mut Work,
    slack: f32,
    (fall, lie): (impl Fn(f32, &mut Front), impl Fn(&Work, usize, &mut Front)),
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
            front.eliminate(&at(params, work, index, slack))
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
fn substitute(params: &Params, work: &mut Work, moved: &[Vec3; POINTS]) {
    let [tail, eyelets @ ..] = moved;
    let held = usize::from(work.ends.tail.is_some());
    let mut next = *tail;
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
        let mut by = Vec3::zeros();
        if let Some(crossing) = crossings.next_if(|crossing| crossing.link == index) {
            by = sum(&crossing.columns);
            y = crossings
                .peek()
                .map_or_else(Vec3::zeros, |crossing| sum(&crossing.seen));
        }
        next = row.alone - row.next * next - row.onto * y - by;
        node.fine += next;
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

/// Forces of the nodes on the ground.
fn react(params: &Params, work: &mut Work) {
    let Some(penalty) = params.penalty else {
        return;
    };
    let all = work.reaction.iter_mut().zip(&work.touch).zip(&work.nodes);
    for ((reaction, touch), node) in all.take(params.nodes) {
        *reaction = touch.map_or_else(Vec3::zeros, |touch| -press(&touch, penalty, node.fine).0);
    }
}
