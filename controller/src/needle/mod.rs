//! The tool in the hand: a ball tip, or a needle bent to an arc (Lian & Chen §3.1, Figs 8, 11, 12).
//!
//! Each puncture site, a to d, is passed in the same way:
//!
//! ```text
//!          tip meets the surface       F·t ≥ F0            swage passes
//!   Ahead ─────────────────────▶ Touch ────────▶ Hole ─────────────────▶ Passed
//!     ▲                            │             │  ▲
//!     └───────── it lets go ───────┘  drawn back ▼  │ comes back: no F0, nothing left to cut
//!                                               Track
//! ```
//!
//! *Touch*: the tip holds a material point of the surface (a weighted mean of nodes under the tip's kernel) and pushes it until the force
//! along the needle reaches F0. *Hole*: that point is a constraint point: it stays on the arc, so needle and tissue move freely against
//! each other along the tangent t only, but for friction.
//!
//! The needle is a rigid body as its driver turns it, and hangs on the hand by one virtual coupling: the offset between the two is what
//! balances the coupling against all points at once, so several punctures share the hand's force by least squares, and the hand never
//! feels more than the coupling's own stiffness. A three-axis device renders the force; the three rotations are the passive gimbal's, and
//! their torque is recorded.

mod arc;
mod detect;
mod grip;
mod passage;
mod rub;

pub use arc::{Arc, Nearest};
pub use detect::{Body, detect};
pub use grip::{Grip, Holds, couple, settle};
pub use passage::{Hole, Passage, Point, Touch, Track};
pub use rub::{Rub, Shaft, rub, shafts};

use crate::math::{DT, Pose, Vec3};
use sutura_shared::scene::{Effect, Scene, Site, Tool};

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
    pub f0: Option<[f32; 4]>,
    /// Growth of F0 at the skin with the skin's strain; zero without effect `skin-tension`.
    pub tension_gain: f32,
    /// Distance from a surface at which the tip, coming from inside, begins to lift it [m].
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
            tension_gain: stitch
                .filter(|_| scene.effects.has(Effect::SkinTension))
                .map_or(0.0, |s| s.tension_gain),
            under: stitch.map_or(0.0, |s| s.under_m),
            friction: stitch
                .filter(|_| rubs)
                .map_or([0.0; 2], |s| [s.friction_n_per_m, s.cutting_n]),
        }
    }
}

/// What changes: the sites and where the tool is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// By [`Site`]; a tool without puncture has the first alone.
    pub sites: [Passage; 4],
    /// Pose in which the hand wants the tool, as of the tick before, patch frame.
    pub before: Option<Pose>,
    /// From there to where the tool is, the virtual coupling's stretch [m].
    pub offset: Vec3,
}

impl State {
    /// How far a site is passed.
    #[must_use]
    pub const fn at(&self, site: Site) -> &Passage {
        let [a, b, c, d] = &self.sites;
        match site {
            Site::A => a,
            Site::B => b,
            Site::C => c,
            Site::D => d,
        }
    }

    /// The same, to be changed.
    pub const fn at_mut(&mut self, site: Site) -> &mut Passage {
        let [a, b, c, d] = &mut self.sites;
        match site {
            Site::A => a,
            Site::B => b,
            Site::C => c,
            Site::D => d,
        }
    }
}
