//! A scene file, key by key, before anything is checked. Every key carries its unit.
//!
//! Numbers are [`Spanned`], so that an error can name their line. Optional keys belong to an effect, or to one of several kinds of a thing:
//! [`super::check`] refuses them where they would change nothing.

use std::path::PathBuf;

use serde::Deserialize;
use sutura_shared::scene::Profile;
use toml::Spanned;

use crate::geometry::units::Units;

/// A number and its place in the file.
pub type Number = Spanned<f64>;

/// The whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Names of the effects that are on.
    pub effects: Vec<Spanned<String>>,
    /// As [`sutura_shared::scene::Solver`] is written.
    pub solver: Spanned<String>,
    /// A generated body in place of mesh files.
    pub phantom: Option<Spanned<Phantom>>,
    /// The block of tissue that is simulated.
    pub patch: Patch,
    /// Tissues from the outside in: where two overlap the later one counts.
    pub tissue: Vec<Spanned<Tissue>>,
    /// The cut.
    pub wound: Option<Spanned<Wound>>,
    /// A needle in the hand.
    pub needle: Option<Spanned<Needle>>,
    /// A ball tip in the hand.
    pub ball: Option<Spanned<Ball>>,
    /// How the tool meets the tissue.
    pub contact: Contact,
    /// Where the wound is sewn, and against what force; may be left out.
    pub stitch: Option<Spanned<Stitch>>,
    /// The suture thread; may be left out.
    pub thread: Option<Spanned<Thread>>,
    /// What of the force reaches the device.
    pub output: Output,
    /// The force-feedback device.
    pub device: Device,
    /// The simulated hand.
    pub hand: Hand,
    /// What the hand does.
    pub operator: Spanned<Operator>,
    /// Whose hand sews; the script's own where it is left out.
    pub skill: Option<Spanned<Skill>>,
}

/// A generated body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phantom {
    /// A forearm: skin, muscle, bone.
    Forearm,
}

/// `[patch]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Across the wound, along it, deep.
    pub size_mm: [Number; 3],
    /// Voxel edge.
    pub pitch_mm: Number,
    /// A point near the skin where the wound's middle is to be, in the meshes' frame; a phantom has its own.
    pub site_mm: Option<Spanned<[f64; 3]>>,
    /// Outward normal of the skin there, in the meshes' frame; without it the mean of the mesh.
    pub normal: Option<Spanned<[f64; 3]>>,
    /// Direction of the wound, in the meshes' frame; its part along the skin counts.
    pub along: Spanned<[f64; 3]>,
    /// Name of the law that gives spring constants from Young's modulus.
    pub law: Spanned<String>,
    /// Poisson's ratio; law `volume`.
    pub poisson: Option<Number>,
    /// What voxels that share an edge give it; without it `per-voxel`.
    pub assembly: Option<Spanned<String>>,
    /// Mass damping.
    pub damping_per_s: Number,
    /// Time constant of the dashpots; effect `spring-damping`.
    pub spring_damping_ms: Option<Number>,
}

/// `[[tissue]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tissue {
    /// Its name.
    pub name: Spanned<String>,
    /// Whether it moves.
    pub body: Spanned<Body>,
    /// Density; soft tissue.
    pub density_kg_m3: Option<Number>,
    /// Slopes of stress against strain; more than one need effect `stiffening`.
    pub slopes_kpa: Option<Spanned<Vec<Number>>>,
    /// Strains between the slopes; effect `stiffening`.
    pub breaks_percent: Option<Spanned<Vec<Number>>>,
    /// Pull of a thread at which it cuts through; effect `tearing`.
    pub strength_n: Option<Number>,
    /// Thickness of the layer under the outer surface that this tissue is; one soft tissue.
    pub thickness_mm: Option<Number>,
    /// Its surface; not with a phantom.
    pub mesh: Option<Spanned<Mesh>>,
}

/// Whether a tissue moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// It does.
    Soft,
    /// Bone.
    Fixed,
}

/// `mesh = { … }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    /// STL file, relative to the scene's.
    pub path: PathBuf,
    /// Unit of its coordinates.
    #[serde(default)]
    pub units: Units,
    /// Rows of the matrix from the file's frame to the scene's, rotation and scale beside translation [mm].
    pub transform: Option<Spanned<[[f64; 4]; 3]>>,
}

/// `[wound]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wound {
    /// Width; a multiple of the pitch.
    pub gap_mm: Number,
    /// Length along y.
    pub length_mm: Number,
    /// Depth below the skin.
    pub depth_mm: Number,
    /// Contact stiffness of a pair of nodes; effect `wound-contact`.
    pub penalty_n_per_m: Option<Number>,
}

/// `[needle]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Needle {
    /// Its maker's name.
    pub kind: Option<Spanned<String>>,
    /// Part of a circle; without a name.
    pub arc_of_circle: Option<Number>,
    /// From tip to swage along the arc; without a name.
    pub length_mm: Option<Number>,
    /// Where the driver holds it: part of the length from the swage; without it a third.
    pub grasp: Option<Number>,
}

/// `[ball]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Radius.
    pub radius_mm: Number,
}

/// `[contact]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Virtual coupling: stiffness.
    pub coupling_n_per_m: Number,
    /// Virtual coupling: damping.
    pub coupling_n_s_per_m: Number,
    /// Radius of the tip's kernel.
    pub kernel_mm: Number,
}

/// `[stitch]`: effect `puncture`
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stitch {
    /// From the wound's edge to a puncture.
    pub bite_mm: Option<Number>,
    /// How many stitches the thread sews.
    pub stitches: Option<Number>,
    /// From one stitch to the next along the wound.
    pub spacing_mm: Option<Number>,
    /// Puncture force at the sites a to d.
    pub f0_n: Option<[Number; 4]>,
    /// Distance from a surface at which the tip, coming from inside, begins to lift it.
    pub under_mm: Option<Number>,
    /// Friction per length of shaft in the tissue; effect `shaft-friction`.
    pub friction_n_per_mm: Option<Number>,
    /// Force of the cutting tip; effect `shaft-friction`.
    pub cutting_n: Option<Number>,
    /// Growth of F0 with the skin's strain; effect `skin-tension`.
    pub tension_gain: Option<Number>,
}

/// `[thread]`: effect `thread`
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thread {
    /// Length.
    pub length_mm: Option<Number>,
    /// Length of one link.
    pub link_mm: Option<Number>,
    /// Material and USP size.
    pub kind: Option<Spanned<String>>,
    /// Axial stiffness EA; without a name.
    pub axial_n: Option<Number>,
    /// Mass per length; without a name.
    pub mass_mg_per_m: Option<Number>,
    /// Damping over mass.
    pub damping_per_s: Option<Number>,
    /// Penalty stiffness on the skin; effect `thread-contact`.
    pub penalty_n_per_m: Option<Number>,
    /// Coefficient of friction with the tissue; effect `thread-friction`.
    pub friction: Option<Number>,
    /// Difference of tension at which the knot slips; effect `knot`.
    pub knot_hold_n: Option<Number>,
    /// Bending stiffness EI; effect `thread-bending`.
    pub bending_nn_m2: Option<Number>,
}

/// `[output]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Rendered over simulated force.
    pub scale: Number,
    /// Largest change of the rendered force.
    pub slew_n_per_tick: Number,
    /// Cap of the passivity damping; effect `passivity`.
    pub passivity_n_s_per_m: Option<Number>,
}

/// `[device]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Device {
    /// Whose limits it has.
    #[serde(with = "ProfileName")]
    pub profile: Profile,
}

/// `[hand]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    /// Mass.
    pub mass_kg: Number,
    /// Damping.
    pub damping_n_s_per_m: Number,
    /// Stiffness.
    pub stiffness_n_per_m: Number,
}

/// `[operator.sew]` or `[operator.touch]`
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Operator {
    /// One stitch with a needle.
    Sew(Sew),
    /// Push, drag and release with a ball tip.
    Touch(Touch),
}

/// `[operator.sew]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sew {
    /// Speed through the air.
    pub approach_mm_per_s: Number,
    /// Speed of the tip against the skin.
    pub insert_mm_per_s: Number,
    /// Turn of the needle in the tissue.
    pub drive_deg_per_s: Number,
    /// Turn of the needle while it comes out.
    pub exit_deg_per_s: Number,
    /// Speed of the hand while the thread is slack; effect `thread`.
    pub pull_mm_per_s: Option<Number>,
    /// Speed of the hand while the thread is taut; effect `thread`.
    pub tighten_mm_per_s: Option<Number>,
    /// Tension at which the knot is laid; effect `thread`.
    pub tension_n: Option<Number>,
}

/// `[skill]`: effect `puncture`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Skill {
    /// Its name.
    pub name: Spanned<String>,
    /// What distinguishes the hand from others of this skill.
    pub seed: u32,
}

/// `[operator.touch]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Touch {
    /// Speed through the air.
    pub approach_mm_per_s: Number,
    /// Speed in contact.
    pub push_mm_per_s: Number,
    /// How deep.
    pub push_mm: Number,
    /// How far sideways, across the wound's direction.
    pub drag_mm: Number,
}

/// The names of [`Profile`] in a file.
#[derive(Deserialize)]
#[serde(remote = "Profile")]
enum ProfileName {
    #[serde(rename = "premium-1.5")]
    Premium15,
    #[serde(rename = "premium-3.0")]
    Premium30,
    #[serde(rename = "touch")]
    Touch,
    #[serde(rename = "desktop")]
    Desktop,
}
