//! What a thread may do: go taut all along its punctures, pull on the thinnest of edges, and be tied by a knot that bears no more.

use sutura_controller::lattice::{Lattice, PC_NODES, Tissue};
use sutura_controller::math::{Pose, Vec3};
use sutura_shared::scene::Scene;

use super::circle::Circle;
use super::patch::{long, sewn, undermined};
use super::run::Run;
use crate::study::stability::bench::memory;
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// Turns of the needle from before the left puncture to behind the right one, its swage out [rad].
const STITCH: [f32; 2] = [-0.5, 5.2];
/// Speed of its tip on the way [m/s].
const DRIVEN: f32 = 0.05;
/// Where the thread is drawn to, from the right puncture.
const AWAY: Vec3 = Vec3::new(-0.6, 0.0, 0.8);
/// What is slack again, from where the thread was taut [m].
const SLACK: f32 = 0.04;
/// Way beyond taut that ends a stitch [m].
const TAUT: f32 = 5e-3;
/// How fast the edges of the wound are drawn apart [m/s], and for how long that takes and lasts [ticks].
const APART: f32 = 0.02;
const OPENING: [u32; 2] = [150, 350];

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    vec![
        Case::new(
            "thread-taut",
            "the thread goes taut at 1 m/s, is drawn 10 mm further and let go after half a second",
            |attempt| drawn(attempt, &sewn(attempt)?, [10e-3, 1.0]),
        ),
        Case::new(
            "thread-200-links",
            "a thread of 200 links through the punctures of three stitches goes taut at 1 m/s, is drawn 10 mm further and goes slack",
            |attempt| drawn(attempt, &long(attempt)?, [10e-3, 1.0]),
        ),
        Case::new(
            "edge-one-voxel",
            "the edges of the wound are undermined to a layer of one voxel, which the taut thread is drawn 10 mm further through and let go",
            |attempt| drawn(attempt, &undermined(attempt)?, [10e-3, 0.1]),
        ),
        Case::new(
            "knot-overloaded",
            "the edges of the wound are drawn apart until the knot of the stitch slips at 20 N, and let go half a second later",
            |attempt| overloaded(attempt, |_| ()),
        ),
    ]
}

/// A thread with its stitches behind it, in the hand.
#[derive(Clone, Copy, Debug, Default)]
struct Sewn {
    /// Where the last stitch comes out of the skin [m].
    out: Vec3,
    /// Length of thread from there to the needle [m].
    length: f32,
    /// From the needle's swage to the hand [m].
    grasp: Vec3,
}

impl Sewn {
    /// Where the hand is when the thread is longer than taut by this [m].
    fn at(&self, way: f32) -> Vec3 {
        self.out + AWAY * (self.length + way) + self.grasp
    }
}

/// Sews every stitch of a scene; all but the last are drawn taut and left slack.
fn sew(run: &mut Run<'_>, scene: &Scene) -> Result<Sewn, Unfinished> {
    let Some(stitch) = scene.stitch else {
        return Err(Unfinished::Built("there is no stitch to sew"));
    };
    let circle = Circle::of(scene);
    let mut sewn = Sewn::default();
    for (n, row) in (1..=stitch.count).zip(stitch.rows_m()) {
        let beside = circle.beside(row);
        if n > 1 {
            run.turn_to(beside.at(STITCH[0]))?;
        }
        run.turn(&beside, STITCH, DRIVEN)?;
        sewn = behind(run, scene);
        run.go(sewn.at(-SLACK), 1.0)?;
        if n < stitch.count {
            tighten(run, &sewn)?;
        }
    }
    Ok(sewn)
}

/// The thread as it runs now, straight from its tail through every puncture.
fn behind(run: &Run<'_>, scene: &Scene) -> Sewn {
    let controller = run.controller();
    let tail = controller.thread().last().map(|(tail, _)| tail);
    let places: Vec<_> = controller.eyelets().map(|(_, place)| place).chain(tail).collect();
    let path: f32 = places.windows(2).map(|leg| (leg[1] - leg[0]).norm()).sum();
    let whole = scene
        .thread
        .map_or(0.0, |thread| thread.link_m * f32::from(thread.nodes - 1));
    Sewn {
        out: places.first().copied().unwrap_or_default(),
        length: whole - path,
        grasp: run.grasp(),
    }
}

/// Draws the thread taut, for long enough that it counts as that, and lets it go slack, likewise.
fn tighten(run: &mut Run<'_>, sewn: &Sewn) -> Result<(), Unfinished> {
    run.go(sewn.at(TAUT), 0.1)?;
    run.wait(50)?;
    run.go(sewn.at(-SLACK), 1.0)?;
    run.wait(50)
}

/// Sews, and draws the thread `beyond` taut [m] at `speed` [m/s].
pub(super) fn drawn(
    attempt: &Attempt<'_>,
    scene: &(Scene, Vec<u8>),
    [beyond, speed]: [f32; 2],
) -> Result<Trace, Unfinished> {
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, scene, start(&scene.0))?;
    let sewn = sew(&mut run, &scene.0)?;
    run.go(sewn.at(beyond), speed)?;
    run.wait(500)?;
    run.go(sewn.at(-SLACK), 2.0)?;
    run.rest()
}

/// Where the needle is before the first stitch.
fn start(scene: &Scene) -> Pose {
    let row = scene.stitch.map_or(0.0, |stitch| stitch.a_m[1]);
    Circle::of(scene).beside(row).at(STITCH[0])
}

/// Ties a stitch that is just slack, and draws the wound open against it, which lets thread through the knot; `see` is told of every tick of that.
/// What is let go of has more thread than it needs at rest.
fn overloaded(attempt: &Attempt<'_>, mut see: impl FnMut(&Run<'_>)) -> Result<Trace, Unfinished> {
    let scene = sewn(attempt)?;
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, start(&scene.0))?;
    let sewn = sew(&mut run, &scene.0)?;
    tighten(&mut run, &sewn)?;
    run.wait(200)?;
    run.tie()?;
    run.wait(50)?;
    let edges = edges(&scene.0, run.controller().lattice());
    let [open, last] = OPENING;
    for (speed, ticks) in [(APART, open), (0.0, last)] {
        take(run.patch_mut(), &edges, (0.0, speed));
        for _ in 0..ticks {
            run.wait(1)?;
            see(&run);
        }
    }
    take(run.patch_mut(), &edges, (1.0, 0.0));
    run.rest()
}

/// Nodes of the wound's edges from the punctures to the wound, as deep as it is, and which way each goes to open it.
fn edges(scene: &Scene, lattice: &Lattice<PC_NODES>) -> Vec<(usize, f32)> {
    let (Some(wound), Some(stitch)) = (scene.wound, scene.stitch) else {
        return Vec::new();
    };
    let rows = u32::from(wound.rows[0])..=u32::from(wound.rows[1]);
    let near = |n: usize| lattice.rest_place(n).x.abs() <= -stitch.a_m[0] + 0.1 * lattice.pitch;
    let all = lattice.nodes();
    let edges = all.filter(|([_, j, k], n)| {
        let open = rows.contains(j) && *k >= u32::from(wound.floor);
        open && near(*n) && lattice.mass[*n] > 0.0 && lattice.free[*n] > 0.0
    });
    edges.map(|(_, n)| (n, lattice.rest_place(n).x.signum())).collect()
}

/// Nodes that are held where `free` is 0, and glide on along their ways at `speed` [m/s].
fn take(
    (lattice, tissue): (&mut Lattice<PC_NODES>, &mut Tissue<PC_NODES>),
    nodes: &[(usize, f32)],
    (free, speed): (f32, f32),
) {
    for (n, way) in nodes {
        lattice.free[*n] = free;
        let velocity = [way * speed, 0.0, 0.0];
        tissue
            .velocity
            .iter_mut()
            .zip(velocity)
            .for_each(|(part, v)| part[*n] = v);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use sutura_controller::lanes::Level;

    use super::*;
    use crate::study::stability::setting::Setting;

    fn default(check: impl FnOnce(&Attempt<'_>)) {
        let interrupted = AtomicBool::new(false);
        check(&Attempt::new(Setting::DEFAULT, Level::best(), &interrupted));
    }

    /// The thread runs through a and d of every stitch but for its tail's. Drawn 10 mm beyond taut it bears a hundred times its weight, and no more
    /// than the coupling with the hand, stretched by all of that.
    #[test]
    fn every_stitch_holds_the_thread_that_is_drawn() {
        default(|attempt| {
            for (scene, punctures) in [(sewn(attempt), 1), (undermined(attempt), 1), (long(attempt), 5)] {
                let scene = scene.unwrap();
                let mut memory = memory();
                let mut run = Run::new(*attempt, &mut memory, &scene, start(&scene.0)).unwrap();
                let sewn = sew(&mut run, &scene.0).unwrap();
                run.go(sewn.at(10e-3), 0.1).unwrap();
                run.wait(100).unwrap();
                let controller = run.controller();
                assert_eq!(controller.eyelets().count(), punctures);
                let thread = scene.0.thread.unwrap();
                let weight = thread.mass_kg_per_m * thread.link_m * f32::from(thread.nodes - 1) * 9.81;
                let most = scene.0.contact.coupling_n_per_m * 10e-3;
                let pull = controller.pull().tension;
                assert!(pull > 100.0 * weight && pull < most, "{pull} N, {weight} N, {most} N");
            }
        });
    }

    /// The load comes to what the knot holds, as closely as the thread's own iterations do, and no further than it grows by in a tick: EA/l of the
    /// stitch times the way of both edges.
    #[test]
    fn the_knot_bears_20_n_and_slips() {
        default(|attempt| {
            let mut loads = Vec::new();
            overloaded(attempt, |run| loads.push(run.controller().pull().stitch)).unwrap();
            let most = loads.iter().copied().fold(0.0, f32::max);
            let growth = 76.0 / 12e-3 * 2.0 * APART * 1e-3;
            assert!((19.98..20.0 + growth).contains(&most), "{most} N");
        });
    }
}
