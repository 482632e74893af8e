//! What a controller in this process shows of itself beside its telemetry: the tool's pose and the thread after every tick, and now and then
//! the whole patch. Looking changes no result; the microsecond it takes counts to the tick's time.

use crossbeam_channel::Sender;
use nalgebra::{Rotation3, UnitQuaternion};
use sutura_controller::lattice;
use sutura_controller::link::{LoadError, Loaded, Plant};
use sutura_controller::math::Vec3;
use sutura_controller::needle::Passage;
use sutura_controller::record::Output;
use sutura_controller::wound::Edges;
use sutura_shared::scene::{STITCHES_MAX, Scene, Site};

use super::embedded::PcRig;

/// How tool and thread move: one record a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Orientation of the tool in the patch frame: unit quaternion w, x, y, z.
    pub quaternion: [f32; 4],
    /// Force on the hand across the needle, at the site nearest to the tip [N].
    pub side_n: f32,
    /// Tension between the punctures [N].
    pub stitch_n: f32,
    /// Thread between the punctures [m].
    pub stitch_m: f32,
    /// How much higher the wound's right edge stands than the left one, at each stitch [m].
    pub step_m: [f32; STITCHES_MAX],
    /// Force with which the thread draws the wound together at each stitch [N].
    pub closing_n: [f32; STITCHES_MAX],
    /// How far the thread has cut through the tissue [m]; effect `tearing`.
    pub torn_m: f32,
}

/// What was seen after one tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Tool and thread.
    pub motion: Motion,
    /// The wound's edges row by row, with the place along the wound [m].
    pub wound: Vec<(f32, Edges)>,
    /// Where the tissue was punctured in this tick: the place before anything moved, patch frame [m].
    pub puncture_m: Option<[f32; 3]>,
    /// The whole patch, where its time has come.
    pub frame: Option<Box<Frame>>,
}

/// The patch, tool and thread at one moment, patch frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// The tick after which it was seen.
    pub tick: u32,
    /// Displacement of every node of the patch, x fastest [m].
    pub displacement: Vec<Vec3>,
    /// Place and orientation of the tool, its grasp point and axes by columns [m].
    pub tool: sutura_controller::math::Pose,
    /// Places [m] and velocities [m/s] along the thread, from the needle to the tail, the places where it is led through tissue among them.
    pub thread: Vec<(Vec3, Vec3)>,
    /// Tension on the needle [N].
    pub tension_n: f32,
    /// The sites that the needle has touched and where they are [m].
    pub sites: Vec<(Site, Vec3)>,
}

/// A rig that is watched.
#[derive(Debug)]
pub(crate) struct Watched<'m> {
    pub(crate) rig: PcRig<'m>,
    /// Ticks from frame to frame; none for no frames.
    pub(crate) every: Option<u32>,
    pub(crate) sink: Sender<Seen>,
}

impl Plant for Watched<'_> {
    fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<Loaded, LoadError> {
        self.rig.load(scene, cells)
    }

    fn tick(&mut self) -> Output {
        let output = self.rig.tick();
        // Who no longer listens wants nothing.
        self.sink.send(seen(&self.rig, &output, self.every)).ok();
        output
    }

    fn state_hash(&self) -> u64 {
        self.rig.state_hash()
    }

    fn release(&mut self) {
        self.rig.release();
    }

    fn stop(&mut self) {
        self.rig.stop();
    }
}

fn seen(rig: &PcRig<'_>, output: &Output, every: Option<u32>) -> Seen {
    let site = output.puncture.map(|puncture| puncture.site);
    let mut sites = rig.controller().sites();
    let point = sites
        .find(|(name, _)| Some(*name) == site)
        .and_then(|(_, passage)| passage.point());
    Seen {
        motion: motion(rig, output),
        wound: rig
            .controller()
            .wound()
            .map_or_else(Vec::new, |(rows, _)| rows.collect()),
        puncture_m: point.map(|point| point.rest.into()),
        frame: every
            .filter(|every| output.tick.is_multiple_of(*every))
            .map(|_| Box::new(frame(rig, output))),
    }
}

fn motion(rig: &PcRig<'_>, output: &Output) -> Motion {
    let controller = rig.controller();
    let Some(arc) = controller.tool() else {
        return Motion::default();
    };
    let pull = controller.pull();
    let on_needle = output.simulated - pull.direction * pull.tension;
    let tangents = controller.sites().filter_map(|(_, site)| match site {
        Passage::Ahead | Passage::Track(_) | Passage::Passed(_) => None,
        Passage::Touch(_) => Some(arc.tip().1),
        Passage::Hole(hole) => Some(arc.nearest(hole.point.place(controller.tissue())).tangent),
    });
    let across = |along: Vec3| (on_needle - along * along.dot(&on_needle)).norm();
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(arc.pose.rotation));
    Motion {
        quaternion: [turn.w, turn.i, turn.j, turn.k],
        side_n: tangents.last().map_or(0.0, across),
        stitch_n: pull.stitch,
        stitch_m: pull.between,
        step_m: controller
            .wound()
            .map_or([0.0; STITCHES_MAX], |(_, stitches)| stitches.map(|edges| edges.step)),
        closing_n: controller.closing(),
        torn_m: controller.torn(),
    }
}

fn frame(rig: &PcRig<'_>, output: &Output) -> Frame {
    let controller = rig.controller();
    let (patch, tissue) = (controller.lattice(), controller.tissue());
    let nodes = patch
        .nodes()
        .map(|(_, node)| node)
        .filter(|node| patch.mass[*node] > 0.0);
    let mut thread: Vec<_> = controller.thread().collect();
    let eyelets: Vec<_> = controller.eyelets().collect();
    for (node, place) in eyelets.into_iter().rev() {
        thread.insert(node + 1, (place, Vec3::zeros()));
    }
    let touched = |(name, passage): (Site, &Passage)| Some((name, passage.point()?.place(tissue)));
    Frame {
        tick: output.tick,
        displacement: nodes.map(|node| lattice::at(&tissue.displacement, node)).collect(),
        tool: controller.tool().map(|arc| arc.pose).unwrap_or_default(),
        thread,
        tension_n: controller.pull().tension,
        sites: controller.sites().filter_map(touched).collect(),
    }
}
