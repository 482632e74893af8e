//! One backward Euler step: linearise, eliminate every node onto the tissue's points, substitute back.

use super::adhere::adhere;
use super::answer::answer;
use super::config::Params;
use super::contact::{Ground, press};
use super::front::Condensed;
use super::pull::{Pull, pull};
use super::state::{Place, State};
use super::sweep::{eliminate, substitute};
use super::work::{Ends, Work};
use crate::coupling::{POINTS, PUNCTURES};
use crate::math::{DT, Vec3};

/// Newton iterations of the thread alone before it is linearised for the tissue.
const ITERATIONS: usize = 7;
/// In the first iteration a link this much shorter than at rest, of its length, is taken for taut: a thread becomes taut all
/// along at once, and would do so link by link otherwise.
const NEARLY_TAUT: f32 = 0.02;

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
