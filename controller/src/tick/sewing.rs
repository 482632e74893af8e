//! Thread and tissue: the points that hold it, and the skin it lies on.

use super::State;
use super::params::Params;
use crate::coupling::{A, Coupling, D, POINTS, PUNCTURES, SEWN, TAIL};
use crate::lattice::{Field, Lattice, Tissue};
use crate::math::Vec3;
use crate::needle::{self, Arc, Passage, Point};
use crate::record::Sample;
use crate::stage::{self, Signs};
use crate::surface::{self, Bridge};
use crate::thread::{self, Ends, Ground, Pull, Touch};
use sutura_shared::scene::{Site, Stage};

/// About what skin answers a point's displacement with [N/m]; it steers the thread's own iterations only.
const SURFACE_STIFFNESS: f32 = 300.0;

/// The punctures that the thread runs through after its tail, in the order in which the needle passes them.
const RUNS_THROUGH: [(Site, usize); 2] = [(Site::A, A), (Site::D, D)];

/// The stitches before this one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sewn {
    /// How many there are.
    pub(super) stitches: usize,
    /// Where the thread runs through the tissue, in order from its tail, which is at site a of the first.
    pub(super) points: heapless::Vec<Point, { PUNCTURES - D }>,
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
    // Site a of the first stitch holds the tail.
    let sites = RUNS_THROUGH.into_iter().skip(usize::from(before == 0));
    sites.map_while(|(site, slot)| match needle.at(site) {
        Passage::Passed(point) => Some((slot, point)),
        _ => None,
    })
}

/// The points that hold the thread, in its order, each with its slot.
fn held<'a>(params: &'a Params, sewn: &'a Sewn, needle: &'a needle::State) -> impl Iterator<Item = (usize, &'a Point)> {
    let sewn_points = (SEWN..).zip(&sewn.points);
    [(TAIL, &params.tail)]
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
    let tail = params.tail.predicted(tissue);
    let laid = || thread::State::laid(thread, arc.swage(), tail, Vec3::y());
    let run = state.thread.get_or_insert_with(laid);
    let mut slots = [0; POINTS];
    let mut eyelets = [Vec3::zeros(); PUNCTURES];
    for (index, (slot, point)) in held(params, &state.sewn, &state.needle).enumerate() {
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
    let ends = Ends {
        swage: Some(arc.swage()).filter(|_| state.stage.stage < Stage::Tie),
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
    for (end, (slot, _)) in ends.iter_mut().zip(held(params, &state.sewn, &state.needle)) {
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
