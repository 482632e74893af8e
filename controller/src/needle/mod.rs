//! The tool in the hand: a ball tip, or a needle bent to an arc (Lian & Chen §3.1, Figs 8, 11, 12).
//!
//! Each puncture site is passed in the same way:
//!
//! ```text
//!            tip meets the skin        F·t ≥ F0            swage passes
//!   Ahead ─────────────────────▶ Touch ────────▶ Hole ─────────────────▶ Passed
//!     ▲                            │               │
//!     └──────── skin let go ───────┴─ needle drawn back
//! ```
//!
//! *Touch*: the tip holds a material point of the skin (a weighted mean of nodes under the tip's kernel) through the virtual coupling
//! and pushes it until the force along the needle reaches F0. *Hole*: that point is the constraint point A: it stays on the
//! arc, so needle and tissue move freely against each other along the tangent t only, but for friction. A three-axis device
//! renders the two forces across t; the three rotations are the passive gimbal's, and their torque is recorded.

mod arc;
mod grip;
mod passage;

pub use arc::{Arc, Nearest};
pub use grip::{Grip, Holds, couple, settle};
pub use passage::{Hole, Passage, Point, Touch, detect};

use crate::math::{DT, Pose};
use sutura_shared::scene::{Effect, Scene, Tool};

/// Coefficients of the tool; immutable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// The tool's shape.
    pub tool: Tool,
    /// Virtual coupling K_c [N/m].
    pub stiffness: f32,
    /// Damping of the virtual coupling over the period, B_c/dt [N/m].
    pub rate: f32,
    /// Radius of the tip's kernel [m].
    pub kernel: f32,
    /// Puncture forces F0 by site [N]; `None` without effect `puncture`.
    pub f0: Option<[f32; 2]>,
    /// Depth below the right site at which the tip begins to lift the skin [m].
    pub under: f32,
    /// Shaft friction [N/m] and cutting force [N]; zero without effect `shaft-friction`.
    pub friction: [f32; 2],
}

impl Params {
    /// Coefficients of a scene's tool.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let stitch = scene.stitch.filter(|_| scene.effects.has(Effect::Puncture));
        let rubs = scene.effects.has(Effect::ShaftFriction);
        Self {
            tool: scene.tool,
            stiffness: scene.contact.coupling_n_per_m,
            rate: scene.contact.coupling_n_s_per_m / DT,
            kernel: scene.contact.kernel_m,
            f0: stitch.map(|s| s.f0_n),
            under: stitch.map_or(0.0, |s| s.under_m),
            friction: stitch
                .filter(|_| rubs)
                .map_or([0.0; 2], |s| [s.friction_n_per_m, s.cutting_n]),
        }
    }
}

/// What changes: both sites and where the tool was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// The left site; the only one of a tool without puncture.
    pub left: Passage,
    /// The right site.
    pub right: Passage,
    /// Tool pose of the tick before, patch frame.
    pub before: Option<Pose>,
}
