//! Thread and tissue: the points that hold it, and the skin it lies on.

use super::State;
use super::params::Params;
use crate::coupling::{A, Coupling, D, POINTS, PUNCTURES, SEWN, TAIL};
use crate::lattice::{Field, Lattice, Tissue};
use crate::math::{DT, Vec3};
use crate::needle::{self, Arc, Body, Passage, Point};
use crate::record::Sample;
use crate::stage::{self, Signs};
use crate::surface::{self, Bridge};
use crate::tear;
use crate::thread::{self, Ends, Ground, Pull, Touch};
use sutura_shared::scene::{Site, Stage};

/// About what skin answers a point's displacement with [N/m]; it steers the thread's own iterations only.
const SURFACE_STIFFNESS: f32 = 300.0;

/// The punctures that the thread runs through after its tail, in the order in which the needle passes them.
const RUNS_THROUGH: [(Site, usize); 2] = [(Site::A, A), (Site::D, D)];

/// The stitches before this one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sewn {
    /// Where the thread's tail is held.
    pub(super) tail: Point,
    /// How many there are.
    pub(super) stitches: usize,
    /// Where the thread runs through the tissue, in order from its tail, which is at site a of the first.
    pub(super) points: heapless::Vec<Point, { PUNCTURES - D }>,
    /// How far the thread has cut through the tissue, at all punctures together [m]; effect `tearing`.
    pub(super) torn: f32,
}

/// The stage after this tick; a new stitch begins with all its sites ahead.
pub(super) fn advance(params: &Params, state: &mut State, sample: &Sample) {
    let before = state.stage.stage;
    let signs = Signs {
        needle: &state.needle,
        pierces: params.needle.f0.is_some(),
        tension: params.thread.as_ref().map(|_| state.pull.tension),
        ahead: params.stitches.saturating_sub(state.sewn.stitches + 1),
        button: sample.button,
    };
    state.stage = stage::next(state.stage, &signs);
    if (before, state.stage.stage) == (Stage::Tension, Stage::Approach) {
        // Every stitch of the scene has its place: there are no more than the points allow.
        for (_, point) in under_way(state.sewn.stitches, &state.needle) {
            state.sewn.points.push(*point).ok();
        }
        state.sewn.stitches += 1;
        state.needle.sites = Default::default();
    }
}

/// The points that the thread runs through so far in a stitch with so many `before` it, each with its slot.
fn under_way(before: usize, needle: &needle::State) -> impl Iterator<Item = (usize, &Point)> {
    runs_through(before).map_while(|(site, slot)| match needle.at(site) {
        Passage::Passed(point) => Some((slot, point)),
        _ => None,
    })
}

/// The punctures of a stitch with so many `before` it that the thread runs through after its tail.
fn runs_through(before: usize) -> impl Iterator<Item = (Site, usize)> {
    // Site a of the first stitch holds the tail.
    RUNS_THROUGH.into_iter().skip(usize::from(before == 0))
}

/// The points that hold the thread, in its order, each with its slot.
fn held<'a>(sewn: &'a Sewn, needle: &'a needle::State) -> impl Iterator<Item = (usize, &'a Point)> {
    let sewn_points = (SEWN..).zip(&sewn.points);
    [(TAIL, &sewn.tail)]
        .into_iter()
        .chain(sewn_points)
        .chain(under_way(sewn.stitches, needle))
}

/// States the thread's pull on its points, condensed, and adds it to the coupling.
pub(super) fn strain<const N: usize>(
    params: &Params,
    state: &mut State,
    arc: &Arc,
    (lattice, tissue): (&Lattice<N>, &Tissue<N>),
    (work, coupling): (&mut thread::Work, &mut Coupling),
) {
    let Some(thread) = &params.thread else { return };
    let tail = state.sewn.tail.predicted(tissue);
    let laid = || thread::State::laid(thread, arc.swage(), tail, Vec3::y());
    let run = state.thread.get_or_insert_with(laid);
    let mut slots = [0; POINTS];
    let mut eyelets = [Vec3::zeros(); PUNCTURES];
    for (index, (slot, point)) in held(&state.sewn, &state.needle).enumerate() {
        if let (Some(kernel), Some(place)) = (coupling.kernels.get_mut(slot), slots.get_mut(index)) {
            (*kernel, *place) = (point.kernel, slot);
        }
        let Some(eyelet) = index.checked_sub(1) else { continue };
        if run.course.count == eyelet {
            run.lead_through(point.place(tissue));
        }
        if let Some(predicted) = eyelets.get_mut(eyelet) {
            *predicted = point.predicted(tissue);
        }
    }
    if state.stage.stage == Stage::Tie && state.stage.ticks == 0 {
        // The knot holds before the needle is cut off.
        run.tie(thread);
    }
    let (swage, forward) = arc.end();
    let ends = Ends {
        swage: Some(swage).filter(|_| state.stage.stage < Stage::Tie),
        heading: -forward,
        tail: Some(tail),
        eyelets,
        end_stiffness: SURFACE_STIFFNESS,
    };
    let skin = Skin {
        lattice,
        tissue,
        bridge: params.bridge.as_ref(),
    };
    let condensed = thread::condense(thread, run, &ends, &skin, work);
    let held = || slots.iter().zip(0..condensed.len);
    for (&a, p) in held() {
        coupling.force[a] += condensed.force[p];
        for (&b, q) in held() {
            coupling.stiffness[a][b] += condensed.stiffness[p][q];
        }
    }
}

/// Ends the thread's tick; its weight on the skin loads the nodes in the next one.
pub(super) fn relax<const N: usize>(
    params: &Params,
    state: &mut State,
    moved: &[Vec3; POINTS],
    (lattice, load): (&Lattice<N>, &mut Field<N>),
    work: &mut thread::Work,
) -> Pull {
    let (Some(thread), Some(run)) = (&params.thread, &mut state.thread) else {
        return Pull::default();
    };
    let mut ends = [Vec3::zeros(); POINTS];
    for (end, (slot, _)) in ends.iter_mut().zip(held(&state.sewn, &state.needle)) {
        *end = moved[slot];
    }
    let pull = thread::settle(thread, run, work, &ends);
    if params.lies {
        load.iter_mut()
            .for_each(|c| c.iter_mut().take(lattice.len()).for_each(|f| *f = 0.0));
        for ((node, _), reaction) in run.live(thread).zip(&work.reaction) {
            surface::lifted(lattice, params.bridge.as_ref(), node, *reaction, load);
        }
    }
    pull
}

/// Lets the thread cut its way where the tissue does not bear it: in each tick at one puncture, in turn, for the time since its last turn.
pub(super) fn tear<const N: usize>(params: &Params, state: &mut State, body: &Body<'_, N>) {
    let (Some(tear), Some(run)) = (&params.tear, &state.thread) else {
        return;
    };
    let turns = run.course.count.min(PUNCTURES) + 1;
    let turn = (state.tick as usize).checked_rem(turns).unwrap_or_default();
    let (point, pull) = (point(&mut state.sewn, &mut state.needle, turn), run.load.get(turn));
    if let (Some(point), Some(pull)) = (point, pull) {
        state.sewn.torn += tear::advance(tear, point, (*pull, turns as f32 * DT), body);
    }
}

/// The point that holds the thread at `index` of [`held`].
fn point<'a>(sewn: &'a mut Sewn, needle: &'a mut needle::State, index: usize) -> Option<&'a mut Point> {
    let Some(eyelet) = index.checked_sub(1) else {
        return Some(&mut sewn.tail);
    };
    let Some(of_stitch) = eyelet.checked_sub(sewn.points.len()) else {
        return sewn.points.get_mut(eyelet);
    };
    let (site, _) = runs_through(sewn.stitches).nth(of_stitch)?;
    match needle.at_mut(site) {
        Passage::Passed(point) => Some(point),
        _ => None,
    }
}

/// The skin as the thread's ground.
struct Skin<'a, const N: usize> {
    lattice: &'a Lattice<N>,
    tissue: &'a Tissue<N>,
    bridge: Option<&'a Bridge>,
}

impl<const N: usize> Ground for Skin<'_, N> {
    fn at(&self, p: Vec3) -> Option<Touch> {
        let (height, normal) = surface::surface(self.lattice, self.tissue, self.bridge, p)?;
        let gap = (p.z - height) * normal.z;
        // A node far below the skin is being led through the tissue, not lying on it.
        (gap > -DEEP * self.lattice.pitch).then_some(Touch { gap, normal })
    }
}

/// Depth from which a node counts as led through the tissue [pitches].
const DEEP: f32 = 1.5;
