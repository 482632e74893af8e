//! The scene as the controller takes it: SI units in every name, frames as `patch_from_…`.
//!
//! The host makes it from TOML and meshes; `sutura-controller` turns it into coefficients in one fallible build.
//! On the wire a scene is `postcard(Scene)` followed by one byte a cell (see [`Lattice::cells`]).

pub use crate::effect::{Effect, Effects};

use heapless::Vec;
use serde::{Deserialize, Serialize};

mod hand;
mod law;
mod solver;
mod validate;

pub use hand::{Hand, Motion, STEPS_MAX, Step, Tremor, Until};
pub use law::{Assembly, Law, NoAssembly, NoLaw, POISSON};
pub use solver::{NoSolver, Solver};

/// Most tissues in one scene (fixed ones count).
pub const TISSUES_MAX: usize = 4;
/// Radius of the tip's kernel over the pitch: from what spreads a tip over more than one node to what a controller's kernel holds.
pub const KERNEL_PITCHES: [f32; 2] = [1.5, 3.5];
/// Most stitches that one thread sews.
pub const STITCHES_MAX: usize = 3;
/// Most segments of a stress–strain curve.
pub const SEGMENTS_MAX: usize = 5;

/// Everything the controller needs, apart from the cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// What is simulated; see [`Effect`].
    pub effects: Effects,
    /// How the tissue is advanced.
    pub solver: Solver,
    /// The voxel lattice.
    pub lattice: Lattice,
    /// Tissue `i` is cell byte `i + 1`.
    pub tissues: Vec<Tissue, TISSUES_MAX>,
    /// What the hand holds.
    pub tool: Tool,
    /// How the tool meets the tissue.
    pub contact: Contact,
    /// The wound and where it is to be sewn; needs effect `puncture`.
    pub stitch: Option<Stitch>,
    /// The suture thread; needs effect `thread`.
    pub thread: Option<Thread>,
    /// The wound's two faces, where there is a wound; effect `wound-contact` needs one.
    pub wound: Option<Wound>,
    /// From simulated newtons to rendered newtons.
    pub output: Output,
    /// Where the device stands.
    pub device: Device,
    /// The simulated hand that holds a simulated device; a real device has a real one.
    pub hand: Option<Hand>,
}

/// The regular voxel lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lattice {
    /// Cells along x, y, z; the lattice has one node more along each. One byte a cell, x fastest:
    /// 0 is empty, `1 + i` is tissue `i`.
    pub cells: [u16; 3],
    /// Voxel edge a [m].
    pub pitch_m: f32,
    /// Node (0, 0, 0) in the patch frame [m].
    pub origin_m: [f32; 3],
    /// Spring constants from Young's modulus.
    pub law: Law,
    /// What voxels that share an edge give it.
    pub assembly: Assembly,
    /// Mass damping α of m v̇ = f − α m v [1/s].
    pub damping_per_s: f32,
    /// Time constant β of stiffness-proportional dashpots [s]; used by effect `spring-damping`.
    pub spring_damping_s: f32,
}

/// One tissue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tissue {
    /// Density ρ [kg/m³].
    pub density_kg_m3: f32,
    /// What it does under load.
    pub body: Body,
}

/// What a tissue does under load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// Bone: its nodes do not move.
    Fixed,
    /// A soft tissue.
    Soft {
        /// Segments of nominal stress against strain, first from zero strain; slopes do not decrease.
        curve: Vec<Segment, SEGMENTS_MAX>,
        /// Thickness of a sheet over that of its voxel layers, else 1: scales stiffness in the plane (0, 2].
        sheet: f32,
        /// Pull of a thread along the skin at which it cuts through [N]; used by effect `tearing`.
        strength_n: f32,
    },
}

/// One segment of a piecewise-linear stress–strain curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Strain at which the segment begins (0 for the first).
    pub from_strain: f32,
    /// Slope of stress against strain [Pa].
    pub slope_pa: f32,
}

/// What the hand holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Tool {
    /// A ball tip at the device's own tip.
    Ball {
        /// Radius [m]: the contact starts when the ball touches.
        radius_m: f32,
    },
    /// A needle bent to an arc, in a needle driver (Lian & Chen Fig. 11).
    Needle {
        /// Arc radius R [m].
        radius_m: f32,
        /// Arc length from tip to swage [m].
        length_m: f32,
        /// Arc length from the swage to where the driver holds it [m].
        grasp_m: f32,
    },
}

/// How the tool meets the tissue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Virtual coupling between device and proxy K_c [N/m].
    pub coupling_n_per_m: f32,
    /// Damping of the virtual coupling B_c [N·s/m].
    pub coupling_n_s_per_m: f32,
    /// Radius of the tip's kernel [m]; within [`KERNEL_PITCHES`].
    pub kernel_m: f32,
}

/// The stitches and their punctures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stitch {
    /// Where the thread's tail is held: site a of the first stitch, x and y in the patch frame [m].
    pub a_m: [f32; 2],
    /// How many stitches the thread sews, up to [`STITCHES_MAX`], each further along y than the one before.
    pub count: u8,
    /// From one stitch to the next along y [m].
    pub spacing_m: f32,
    /// Puncture force F0 by [`Site`] [N] (Lian & Chen Fig. 8).
    pub f0_n: [f32; 4],
    /// Distance from a surface at which the tip, coming from inside the tissue, begins to lift it [m].
    pub under_m: f32,
    /// Friction per metre of shaft in the tissue [N/m]; used by effect `shaft-friction`.
    pub friction_n_per_m: f32,
    /// Force of the advancing cutting tip [N]; used by effect `shaft-friction`.
    pub cutting_n: f32,
    /// Growth of F0 with the strain of the skin, F0·(1 + gain·strain); used by effect `skin-tension`.
    pub tension_gain: f32,
}

/// The suture thread (Lian & Chen Fig. 13).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thread {
    /// Mass elements N_0 … N_{n−1}.
    pub nodes: u16,
    /// Rest length of one link [m].
    pub link_m: f32,
    /// Axial stiffness EA [N].
    pub axial_n: f32,
    /// Mass per length [kg/m].
    pub mass_kg_per_m: f32,
    /// Damping c_i of Eq. 7 over the mass [1/s].
    pub damping_per_s: f32,
    /// Penalty k of Eq. 8 [N/m]; used by effect `thread-contact`.
    pub penalty_n_per_m: f32,
    /// Coefficient of friction with the tissue μ; used by effect `thread-friction`.
    pub friction: f32,
    /// Difference of tension at which the knot slips [N]; used by effect `knot`.
    pub knot_hold_n: f32,
    /// Bending stiffness EI [N·m²]; used by effect `thread-bending`.
    pub bending_n_m2: f32,
}

/// The wound: a box of removed cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wound {
    /// Node columns of the left and the right face along x, [0, nodes).
    pub faces: [u16; 2],
    /// First and last node row of the faces along y.
    pub rows: [u16; 2],
    /// Lowest node layer of the faces along z.
    pub floor: u16,
    /// Contact stiffness of one pair of nodes [N/m]; used by effect `wound-contact`.
    pub penalty_n_per_m: f32,
}

/// From simulated newtons to what the device is told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// The paper's constant c of Eq. 11: rendered over simulated.
    pub scale: f32,
    /// Largest change of the rendered force a tick [N].
    pub slew_n: f32,
    /// Cap of the passivity damping [N·s/m]; used by effect `passivity`.
    pub passivity_n_s_per_m: f32,
}

/// A force-feedback device and its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Device {
    /// Force limits.
    pub profile: Profile,
    /// The device's frame (x right, y up, z to the user; origin at the neutral pose) in the patch frame.
    pub patch_from_device: Pose,
}

/// Devices whose limits are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Profile {
    /// PHANToM Premium 1.5: 8.5 N peak, 1.4 N continuous.
    Premium15,
    /// PHANToM Premium 3.0: 22 N peak, 3 N continuous.
    Premium30,
    /// Touch (Omni): 3.3 N peak, 0.88 N continuous.
    Touch,
    /// Desktop (Touch X): 7.9 N peak, 1.75 N continuous.
    Desktop,
}

/// A position and an orientation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Origin [m].
    pub position_m: [f32; 3],
    /// Unit quaternion w, x, y, z.
    pub quaternion: [f32; 4],
}

impl Stitch {
    /// Where the stitches cross the wound, y in the patch frame [m]; only the first [`Self::count`] have a meaning.
    #[must_use]
    pub fn rows_m(&self) -> [f32; STITCHES_MAX] {
        let [_, first] = self.a_m;
        core::array::from_fn(|stitch| first + stitch as f32 * self.spacing_m)
    }
}

/// A puncture site (Lian & Chen Fig. 10), in the order in which the needle passes them from left to right. A needle that goes under the
/// wound's floor, or where there is no wound, passes a and d alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Site {
    /// Into the skin on the left; the thread's tail is held here.
    A,
    /// Out of the left face into the wound.
    B,
    /// Out of the wound into the right face.
    C,
    /// Out of the skin on the right.
    D,
}

impl Site {
    /// Every site in order.
    pub const ALL: [Self; 4] = [Self::A, Self::B, Self::C, Self::D];

    /// The name in tables, files and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
            Self::C => "c",
            Self::D => "d",
        }
    }
}

/// Stages of a stitch, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Stage {
    /// The tool is free.
    Approach,
    /// The tool presses on the skin.
    Indent,
    /// The needle has punctured site a and moves along its arc.
    Drive,
    /// The tip meets the skin from below, at site d, and comes out.
    Exit,
    /// The needle is out; slack thread follows.
    PullThrough,
    /// The thread is taut.
    Tension,
    /// The knot is laid.
    Tie,
    /// The stitch is finished, or the tool has let go of the tissue.
    Done,
}

impl Stage {
    /// Every stage in order.
    pub const ALL: [Self; 8] = [
        Self::Approach,
        Self::Indent,
        Self::Drive,
        Self::Exit,
        Self::PullThrough,
        Self::Tension,
        Self::Tie,
        Self::Done,
    ];

    /// The name in tables, files and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::Indent => "indent",
            Self::Drive => "drive",
            Self::Exit => "exit",
            Self::PullThrough => "pull-through",
            Self::Tension => "tension",
            Self::Tie => "tie",
            Self::Done => "done",
        }
    }
}
