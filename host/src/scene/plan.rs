//! A scene that has been checked, before its meshes are read. Lengths that meet geometry stay in millimetres, the rest is SI.

use sutura_shared::scene::{Assembly, Contact, Effects, Law, Output, Profile, Solver, Thread, Tool};

use super::file::{Mesh, Phantom};
use super::operator::Operator;
use super::setting::Setting;
use super::skill::Person;

/// Everything a scene file says.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Effects that are on.
    pub effects: Effects,
    /// How the tissue is advanced.
    pub solver: Setting<Solver>,
    /// A generated body in place of mesh files.
    pub phantom: Option<Phantom>,
    /// The block to cut out.
    pub patch: Patch,
    /// Tissues from the outside in.
    pub tissues: Vec<Tissue>,
    /// The cut.
    pub wound: Option<Wound>,
    /// What the hand holds.
    pub tool: Tool,
    /// How the tool meets the tissue.
    pub contact: Contact,
    /// The punctures.
    pub stitch: Option<Stitch>,
    /// The thread.
    pub thread: Option<Thread>,
    /// The output edge.
    pub output: Output,
    /// The device's limits.
    pub profile: Profile,
    /// The simulated hand.
    pub hand: Hand,
    /// What the hand does.
    pub operator: Operator,
    /// Whose hand it is; none is the script's own.
    pub person: Option<Person>,
}

/// The block of tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Across the wound, along it, deep [mm].
    pub size_mm: [f64; 3],
    /// Voxel edge [mm].
    pub pitch_mm: f64,
    /// Where the wound's middle is to be, in the meshes' frame [mm].
    pub site_mm: Option<[f64; 3]>,
    /// Outward normal there.
    pub normal: Option<[f64; 3]>,
    /// Direction of the wound, in the meshes' frame.
    pub along: [f64; 3],
    /// Spring constants from Young's modulus.
    pub law: Law,
    /// What voxels that share an edge give it.
    pub assembly: Assembly,
    /// Mass damping [1/s].
    pub damping_per_s: f32,
    /// Time constant of the dashpots [s].
    pub spring_damping_s: f32,
}

/// One tissue.
#[derive(Clone, Debug)]
pub struct Tissue {
    /// Its name.
    pub name: String,
    /// What the controller is told of it.
    pub body: sutura_shared::scene::Tissue,
    /// Thickness, where it is a layer under the outer surface [mm].
    pub sheet_mm: Option<f64>,
    /// Its surface; none with a phantom.
    pub mesh: Option<Mesh>,
}

/// The cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wound {
    /// Width across x [mm].
    pub gap_mm: f64,
    /// Length along y [mm].
    pub length_mm: f64,
    /// Depth below the skin [mm].
    pub depth_mm: f64,
    /// Contact stiffness of a pair of nodes [N/m].
    pub penalty_n_per_m: f32,
}

/// The punctures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stitch {
    /// From the wound's edge to a puncture [mm].
    pub bite_mm: f64,
    /// How many stitches the thread sews.
    pub stitches: u8,
    /// From one stitch to the next along the wound [mm]; 0 for one.
    pub spacing_mm: f64,
    /// Puncture force by site [N].
    pub f0_n: [f32; 4],
    /// Distance from a surface at which the tip, coming from inside, begins to lift it [m].
    pub under_m: f32,
    /// Friction of the shaft [N/m].
    pub friction_n_per_m: f32,
    /// Force of the cutting tip [N].
    pub cutting_n: f32,
    /// Growth of F0 with the skin's strain.
    pub tension_gain: f32,
}

/// The simulated hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Mass [kg].
    pub mass_kg: f32,
    /// Damping [N·s/m].
    pub damping_n_s_per_m: f32,
    /// Stiffness [N/m].
    pub stiffness_n_per_m: f32,
}
