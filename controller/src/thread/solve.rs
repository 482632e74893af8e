//! One backward Euler step: linearise, eliminate every node onto the tissue's two points, substitute back.
//!
//! With u the nodes' displacements and c those of the points, −∂²/∂(u, c)² of the incremental energy is block-tridiagonal in u
//! with one column for the eyelet. A forward elimination from N₀ to the tail leaves `force − stiffness·c` at the points.

use super::config::Params;
use super::contact::{Ground, Touch, press};
use super::eyelet::{pieces, slide};
use super::factor::Factor;
use super::link::{self, Link, Piece};
use super::pull::{Pull, pull};
use super::state::{NODES_MAX, Place, Run, State};
use crate::math::{DT, Mat3, Vec3};

/// Newton iterations of the thread alone before it is linearised for the tissue.
const ITERATIONS: usize = 6;
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
    /// The tissue's point through which the thread runs [m]; it must be given unless the thread's [`Run`] is `Free`.
    pub eyelet: Option<Vec3>,
    /// About what the tissue answers a point's displacement with, springs and inertia [N/m]; more than zero. It steers the
    /// thread's own iterations and has no part in the result once they have converged.
    pub end_stiffness: f32,
}

/// The thread as the tissue sees it: its force at displacements c of tail and eyelet from their predicted positions is
/// `force − stiffness·c`. A point that does not hold the thread has zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Condensed {
    /// Force on the tail's and the eyelet's point [N].
    pub force: [Vec3; 2],
    /// Stiffness, symmetric and positive semidefinite [N/m].
    pub stiffness: [[Mat3; 2]; 2],
}

impl Condensed {
    /// The same with displacements counted from `c`.
    fn about(&self, c: [Vec3; 2]) -> Self {
        Self {
            force: self.at(c),
            ..*self
        }
    }

    /// The forces at displacements `c`.
    fn at(&self, c: [Vec3; 2]) -> [Vec3; 2] {
        let [tail, eyelet] = c;
        let [on_tail, on_eyelet] = self.force;
        let [[tt, te], [et, ee]] = self.stiffness;
        [on_tail - tt * tail - te * eyelet, on_eyelet - et * tail - ee * eyelet]
    }
}

/// What `condense` leaves for `settle`.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// Force of each node on the ground [N], after `settle`.
    pub reaction: [Vec3; NODES_MAX],
    nodes: [Place; NODES_MAX],
    eyelet: Place,
    ends: Ends,
    reduced: Condensed,
    run: Run,
    pieces: Option<[Piece; 2]>,
    touch: [Option<Touch>; NODES_MAX],
    rows: [Row; NODES_MAX],
}

impl Default for Work {
    fn default() -> Self {
        Self {
            reaction: [Vec3::zeros(); NODES_MAX],
            nodes: [Place::default(); NODES_MAX],
            eyelet: Place::default(),
            ends: Ends::default(),
            reduced: Condensed::default(),
            run: Run::Free,
            pieces: None,
            touch: [None; NODES_MAX],
            rows: [Row::default(); NODES_MAX],
        }
    }
}

/// An eliminated node: its displacement is `alone − next·u₊₁ − point·c`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Row {
    alone: Vec3,
    next: Mat3,
    point: Mat3,
}

/// What the eliminated nodes leave to the next node and to the eyelet.
#[derive(Clone, Copy, Default)]
struct Front {
    force: Vec3,
    block: Mat3,
    /// Block of the next node with the eyelet.
    shared: Mat3,
    eyelet_force: Vec3,
    eyelet_block: Mat3,
    /// Whether the eyelet has been reached; no node before it has a part in the eyelet's blocks.
    through: bool,
}

impl Front {
    /// Eliminates the node at the front, which `link` joins to the next.
    fn eliminate(&mut self, link: &Link) -> Row {
        let factor = Factor::new(&(self.block + link.aa));
        let mut row = Row {
            alone: factor.solve(self.force + link.on_a),
            next: factor.solve_columns(&link.ab),
            point: Mat3::zeros(),
        };
        let to_next = link.ab.transpose();
        self.force = link.on_b - to_next * row.alone;
        self.block = link.bb - to_next * row.next;
        self.through |= link.through.is_some();
        if self.through {
            let through = link.through.unwrap_or_default();
            let shared = self.shared + through.ap;
            let to_eyelet = shared.transpose();
            row.point = factor.solve_columns(&shared);
            self.shared = through.bp - to_next * row.point;
            self.eyelet_force += through.on_p - to_eyelet * row.alone;
            self.eyelet_block += through.pp - to_eyelet * row.point;
        }
        row
    }
}

/// Advances the thread in thought against tissue that answers with `ends.end_stiffness`, linearises it there and eliminates
/// every node. Fixed operation count; `state` is not changed.
pub fn condense<G: Ground>(params: &Params, state: &State, ends: &Ends, ground: &G, work: &mut Work) -> Condensed {
    begin(params, state, ends, work);
    look(params, ground, work);
    for iteration in 0..ITERATIONS {
        let slack = if iteration == 0 { NEARLY_TAUT * params.rest } else { 0.0 };
        let reduced = eliminate(params, state, work, slack);
        let moved = answer(&reduced, state, ends, iterate(params, work));
        substitute(params, work, moved);
    }
    let [tail, eyelet] = iterate(params, work);
    work.reduced = eliminate(params, state, work, 0.0).about([-tail, -eyelet]);
    work.reduced
}

/// Ends the tick that `condense` began: the points have `moved` by this much from their predicted positions [m].
pub fn settle(params: &Params, state: &mut State, work: &mut Work, moved: [Vec3; 2]) -> Pull {
    let [tail, eyelet] = moved;
    let [tail_iterate, eyelet_iterate] = iterate(params, work);
    substitute(params, work, [tail - tail_iterate, eyelet - eyelet_iterate]);
    let all = state.nodes.iter_mut().zip(&mut state.velocity);
    for ((node, velocity), new) in all.zip(&work.nodes).take(params.nodes) {
        *velocity = node.to(new) / DT;
        *node = new.normalised();
    }
    state.eyelet = work.ends.eyelet.map(|_| work.eyelet.point());
    if state.eyelet.is_some() {
        state.run = work.run;
    }
    state.load = work.reduced.at(moved);
    react(params, work);
    pull(params, state, work.ends.swage)
}

/// The first iterate is the thread as it was, points included: only from there is it known which node is before the eyelet
/// and which has passed it.
fn begin(params: &Params, state: &State, ends: &Ends, work: &mut Work) {
    work.ends = *ends;
    work.run = if ends.eyelet.is_some() { state.run } else { Run::Free };
    work.nodes = state.nodes;
    work.eyelet = Place::default();
    if let Some(eyelet) = ends.eyelet {
        work.eyelet = Place::new(eyelet);
        work.eyelet.fine = state.eyelet.map_or_else(Vec3::zeros, |old| old - eyelet);
    }
    if let (Some(tail), Some(node)) = (ends.tail, work.nodes.get_mut(params.nodes - 1)) {
        let new = Place::new(tail);
        *node = Place {
            fine: new.to(node),
            ..new
        };
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
fn iterate(params: &Params, work: &Work) -> [Vec3; 2] {
    let tail = work
        .nodes
        .get(params.nodes - 1)
        .map_or_else(Vec3::zeros, |node| node.fine);
    [
        if work.ends.tail.is_some() { tail } else { Vec3::zeros() },
        work.eyelet.fine,
    ]
}

/// Linearises at the iterate and eliminates the nodes; the result is about the iterate. An effect that is off has no part in the pass.
fn eliminate(params: &Params, state: &State, work: &mut Work, slack: f32) -> Condensed {
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
) -> Condensed {
    work.pieces = match work.run {
        Run::Free => None,
        Run::Sliding { link } | Run::Tied { link, .. } => Some(pieces(&work.nodes, params.nodes, link, &work.eyelet)),
    };
    let mut front = Front::default();
    let last = params.nodes - 1;
    for index in 0..params.nodes {
        let held = index == last && work.ends.tail.is_some();
        if held {
            break;
        }
        own(params, state, work, index, (&fall, &mut front));
        lie(work, index, &mut front);
        let link = if index < last {
            at(params, work, index, slack)
        } else {
            Link::default()
        };
        let row = front.eliminate(&link);
        if let Some(slot) = work.rows.get_mut(index) {
            *slot = row;
        }
    }
    let symmetric = |m: Mat3| (m + m.transpose()) * 0.5;
    Condensed {
        force: [front.force, front.eyelet_force],
        stiffness: [
            [symmetric(front.block), front.shared],
            [front.shared.transpose(), symmetric(front.eyelet_block)],
        ],
    }
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

/// Link `index` at the iterate.
fn at(params: &Params, work: &Work, index: usize, slack: f32) -> Link {
    match (work.run, &work.pieces) {
        (Run::Sliding { link }, Some(pieces)) if link == index => link::sliding(params, pieces, slack),
        (Run::Tied { link, rest }, Some(pieces)) if link == index => link::tied(params, pieces, rest),
        _ => match (work.nodes.get(index), work.nodes.get(index + 1)) {
            (Some(a), Some(b)) => link::plain(params, a.to(b), slack),
            _ => Link::default(),
        },
    }
}

/// How far the points go from their iterates if the tissue, at its prediction, bears the thread's last forces and answers any
/// change with springs of `end_stiffness`.
fn answer(reduced: &Condensed, state: &State, ends: &Ends, iterate: [Vec3; 2]) -> [Vec3; 2] {
    let [tail, eyelet] = iterate;
    let [tail_load, eyelet_load] = state.load;
    let [[tt, te], [_, ee]] = reduced.stiffness;
    let [mut on_tail, mut on_eyelet] = reduced.force;
    let spring = Mat3::from_diagonal_element(ends.end_stiffness);
    let mut eyelet_block = ee + spring;
    on_eyelet -= eyelet_load + eyelet * ends.end_stiffness;
    let (mut alone, mut shared) = (Vec3::zeros(), Mat3::zeros());
    if ends.tail.is_some() {
        on_tail -= tail_load + tail * ends.end_stiffness;
        let factor = Factor::new(&(tt + spring));
        alone = factor.solve(on_tail);
        shared = factor.solve_columns(&te);
        on_eyelet -= te.transpose() * alone;
        eyelet_block -= te.transpose() * shared;
    }
    let eyelet = if ends.eyelet.is_some() {
        Factor::new(&eyelet_block).solve(on_eyelet)
    } else {
        Vec3::zeros()
    };
    [alone - shared * eyelet, eyelet]
}

/// Moves the iterate: the points by `moved`, the nodes by what follows from it; then lets the thread slide by a node.
fn substitute(params: &Params, work: &mut Work, moved: [Vec3; 2]) {
    let [tail, eyelet] = moved;
    let mut next = tail;
    let held = usize::from(work.ends.tail.is_some());
    if let (1, Some(node)) = (held, work.nodes.get_mut(params.nodes - 1)) {
        node.fine += tail;
    }
    if work.ends.eyelet.is_some() {
        work.eyelet.fine += eyelet;
    }
    let nodes = work.nodes.iter_mut().zip(&work.rows);
    for (node, row) in nodes.take(params.nodes - held).rev() {
        next = row.alone - row.next * next - row.point * eyelet;
        node.fine += next;
    }
    if let Some(pieces) = &work.pieces {
        slide(params, &mut work.nodes, &mut work.run, &work.eyelet, pieces);
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
