//! The records that cross the tick's edges: what the device says, what the tick answers.

use crate::math::{Pose, Vec3};
use crate::safety::LimitedForce;
use sutura_shared::scene::Stage;

/// What the device says at the start of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// `device_from_stylus`: position of the gimbal's centre [m] and the stylus' orientation, from the encoders.
    pub pose: Pose,
    /// The stylus button.
    pub button: bool,
}

/// One tick's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Number of the tick, from 1: it ends at t = `tick` ms.
    pub tick: u32,
    /// Where the stitch is.
    pub stage: Stage,
    /// What went wrong, if anything; zero force while any bit stands.
    pub faults: Faults,
    /// Force on the hand as the scene says, patch frame [N].
    pub simulated: Vec3,
    /// Force on the hand as the device is told, device frame [N].
    pub rendered: LimitedForce,
    /// Constraint torque about the grasp point, patch frame [N·m]: recorded, not rendered by a 3-DOF device.
    pub torque: Vec3,
    /// Grasp point of the tool, patch frame [m].
    pub position: Vec3,
    /// The thread's tension by Eq. 11 with c = 1 [N].
    pub thread: f32,
    /// Width of the wound at the stitch [m]; negative where the rims overlap, 0 without a wound.
    pub gap: f32,
    /// Mean width of the wound over its length [m].
    pub gap_mean: f32,
    /// Whether the device's limit shortened the force.
    pub saturated: bool,
    /// A puncture that happened in this tick.
    pub puncture: Option<Puncture>,
}

/// One puncture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Puncture {
    /// Where.
    pub site: sutura_shared::scene::Site,
    /// Force along the needle at which the skin gave way [N].
    pub force: f32,
    /// The scene's F0 [N].
    pub f0: f32,
    /// How far the skin had been pushed along the needle [m].
    pub depth: f32,
}

/// Faults of a run, a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(pub u32);

/// One fault. The discriminant is its bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Fault {
    /// The device gave a pose that is not finite.
    Pose = 1 << 0,
    /// The force was not finite.
    Force = 1 << 1,
    /// A tissue or thread position was not finite.
    State = 1 << 2,
}

impl Fault {
    /// Every fault in the order of its bit.
    pub const ALL: [Self; 3] = [Self::Pose, Self::Force, Self::State];

    /// The name in tables and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose-not-finite",
            Self::Force => "force-not-finite",
            Self::State => "state-not-finite",
        }
    }
}

impl Faults {
    /// Whether `fault` is in the set.
    #[must_use]
    pub const fn has(self, fault: Fault) -> bool {
        self.0 & fault as u32 != 0
    }

    /// The set with `fault` in it where `present`.
    #[must_use]
    pub const fn with(self, fault: Fault, present: bool) -> Self {
        if present { Self(self.0 | fault as u32) } else { self }
    }

    /// Whether nothing is wrong.
    #[must_use]
    pub const fn none(self) -> bool {
        self.0 == 0
    }
}
