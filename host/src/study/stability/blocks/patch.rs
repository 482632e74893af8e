//! The patch of a case: a small block whose sides and bottom are held, under a ball tip.

use sutura_controller::math::Vec3;
use sutura_shared::scene::{Body, Effect, Scene, Segment, Tissue, Tool};

use crate::study::block::{self, Spec};
use crate::study::stability::bench::Bench;
use crate::study::stability::case::{Attempt, Unfinished};
use crate::study::stability::setting::Curve;
use crate::study::stability::watch::Trace;

/// Mass damping α of the built-in scenes [1/s].
const DAMPING_PER_S: f64 = 50.0;
/// Virtual coupling of the built-in scenes [N/m, N·s/m].
const COUPLING: [f32; 2] = [800.0, 1.0];
/// Radius of the ball and of its kernel [pitches], as of the built-in scenes.
const BALL: f32 = 1.5;
const KERNEL: f32 = 1.75;
/// Slopes over the first one and the strains at which they begin, of [`Curve::Stiffening`].
const STIFFENING: [(f32, f32); 3] = [(0.0, 1.0), (0.03, 4.0), (0.06, 10.0)];
/// How fast a tool is lifted off the skin: about as fast as a hand can [m/tick].
const LIFT_M: f32 = 5e-4;
/// How high [ticks].
const LIFT_TICKS: u16 = 30;
/// How long a case goes on when its input has stopped [ticks].
pub(super) const AFTER: u32 = 1500;

/// What a voxel is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stuff {
    /// E of the first slope [Pa].
    pub(super) young_pa: f64,
    /// ρ [kg/m³].
    pub(super) density_kg_m3: f64,
}

/// Soft tissue: 100 kPa and the density of water.
pub(super) const FLESH: Stuff = Stuff {
    young_pa: 1e5,
    density_kg_m3: 1e3,
};

/// A block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Voxels along x, y, z.
    pub(super) voxels: [u32; 3],
    /// Voxel edge a [m].
    pub(super) pitch_m: f64,
    /// Tissues 1 and 2.
    pub(super) stuff: [Stuff; 2],
    /// Tissue of the voxel in a column, row and layer; 0 for none.
    pub(super) fill: fn([u32; 3]) -> u8,
    /// Whether the scene calls for effect `barrier`; law `volume` has it in any case.
    pub(super) barrier: bool,
}

impl Default for Patch {
    /// 8 × 8 × 5 voxels of 2 mm.
    fn default() -> Self {
        Self {
            voxels: [8, 8, 5],
            pitch_m: 2e-3,
            stuff: [FLESH; 2],
            fill: |_| 1,
            barrier: false,
        }
    }
}

impl Patch {
    /// The scene under an attempt's setting: skin at z = 0, middle at x = y = 0, and its cells.
    pub(super) fn scene(&self, attempt: &Attempt<'_>) -> (Scene, Vec<u8>) {
        let springs = attempt.setting.springs;
        let [first, _] = self.stuff;
        let mut scene = block::scene(&Spec {
            nodes: self.voxels.map(|n| n + 1),
            pitch_m: self.pitch_m,
            young_pa: first.young_pa,
            density_kg_m3: first.density_kg_m3,
            law: springs.law,
            assembly: springs.assembly,
            stiffening: springs.curve == Curve::Stiffening,
            damping_per_s: DAMPING_PER_S,
        });
        scene.tissues = self.stuff.iter().map(|stuff| tissue(*stuff, &STIFFENING)).collect();
        let pitch = self.pitch();
        let [x, y, z] = self.voxels.map(|n| n as f32 * pitch);
        scene.solver = attempt.setting.solver;
        if self.barrier {
            scene.effects = scene.effects.with(Effect::Barrier);
        }
        scene.lattice.origin_m = [-0.5 * x, -0.5 * y, -z];
        scene.tool = Tool::Ball { radius_m: BALL * pitch };
        scene.contact.kernel_m = KERNEL * pitch;
        [scene.contact.coupling_n_per_m, scene.contact.coupling_n_s_per_m] = COUPLING;
        let [nx, ny, nz] = self.voxels;
        let voxels = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
        (scene, voxels.map(self.fill).collect())
    }

    /// Voxel edge a [m].
    pub(super) const fn pitch(&self) -> f32 {
        self.pitch_m as f32
    }

    /// Where the hand is when the ball's lowest point is at `tip` [m].
    pub(super) fn grasp(&self, tip: Vec3) -> Vec3 {
        tip + Vec3::z() * (BALL * self.pitch())
    }

    /// Lifts the ball from `tip` out of the skin, and lets the tissue be.
    pub(super) fn lift_off(&self, mut bench: Bench<'_>, tip: Vec3) -> Result<Trace, Unfinished> {
        let lifted = |ticks: u16| self.grasp(tip + Vec3::z() * (LIFT_M * f32::from(ticks)));
        for ticks in 1..=LIFT_TICKS {
            bench.tick(lifted(ticks))?;
        }
        bench.let_go(lifted(LIFT_TICKS), AFTER)
    }
}

/// A soft tissue whose curve has these slopes over its first one, from these strains on.
pub(super) fn tissue(stuff: Stuff, slopes: &[(f32, f32)]) -> Tissue {
    let curve = slopes.iter().map(|(from_strain, slope)| Segment {
        from_strain: *from_strain,
        slope_pa: slope * stuff.young_pa as f32,
    });
    Tissue {
        density_kg_m3: stuff.density_kg_m3 as f32,
        body: Body::Soft {
            curve: curve.collect(),
            sheet: 1.0,
            strength_n: 0.0,
        },
    }
}
