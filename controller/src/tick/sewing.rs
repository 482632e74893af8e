//! Thread and tissue: the points that hold it, and the skin it lies on.

use super::State;
use super::params::Params;
use crate::coupling::{Coupling, D, POINTS, PUNCTURES, TAIL};
use crate::lattice::{Field, Lattice, Tissue};
use crate::math::Vec3;
use crate::needle::{self, Arc, Passage};
use crate::surface::{self, Bridge};
use crate::thread::{self, Ends, Ground, Pull, Touch};
use sutura_shared::scene::{Site, Stage};

/// About what skin answers a point's displacement with [N/m]; it steers the thread's own iterations only.
const SURFACE_STIFFNESS: f32 = 300.0;

/// The sites that the thread runs through, in the order in which the needle passes them, each with the point that it has in common with the
/// needle: d alone, where it leaves the tissue.
const RUNS_THROUGH: [(Site, usize); 1] = [(Site::D, D)];

/// The points that hold the thread, in its order: its tail, then the punctures that it runs through.
fn slots() -> impl Iterator<Item = usize> {
    [TAIL].into_iter().chain(RUNS_THROUGH.map(|(_, slot)| slot))
}

/// Leads the thread through every site that the needle has passed, and gives where each will be if nothing pulls on it [m].
fn lead_through<const N: usize>(
    run: &mut thread::State,
    needle: &needle::State,
    tissue: &Tissue<N>,
) -> [Vec3; PUNCTURES] {
    let mut eyelets = [Vec3::zeros(); PUNCTURES];
    let sites = RUNS_THROUGH.iter().zip(&mut eyelets).enumerate();
    for (index, ((site, _), eyelet)) in sites {
        let Passage::Passed(point) = needle.at(*site) else {
            break;
        };
        if run.course.count == index {
            run.lead_through(point.place(tissue));
        }
        *eyelet = point.predicted(tissue);
    }
    eyelets
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
    let eyelets = lead_through(run, &state.needle, tissue);
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
    coupling.kernels[TAIL] = params.tail.kernel;
    let held = || slots().zip(0..condensed.len);
    for (a, p) in held() {
        coupling.force[a] += condensed.force[p];
        for (b, q) in held() {
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
    ends.iter_mut().zip(slots()).for_each(|(end, a)| *end = moved[a]);
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
