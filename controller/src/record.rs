//! The records that cross the tick's edges: what the device says, what the tick answers.

pub use crate::event::{Fault, Faults, Puncture};

use crate::math::{Pose, Vec3};
use crate::safety::LimitedForce;
use sutura_shared::scene::{STITCHES_MAX, Stage};

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
    /// Number of the stitch, from 1.
    pub stitch: u8,
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
    /// Width of the wound at each stitch [m]; negative where the rims overlap, 0 without a wound or a stitch.
    pub gap: [f32; STITCHES_MAX],
    /// Mean width of the wound: between the end stitches, or over its length for one stitch [m].
    pub gap_mean: f32,
    /// Whether the device's limit shortened the force.
    pub saturated: bool,
    /// A puncture that happened in this tick.
    pub puncture: Option<Puncture>,
}

impl Output {
    /// The answer of a controller without a scene: zero force.
    #[must_use]
    pub fn idle() -> Self {
        Self {
            tick: 0,
            stage: Stage::Approach,
            stitch: 1,
            faults: Faults::default(),
            simulated: Vec3::zeros(),
            rendered: LimitedForce::default(),
            torque: Vec3::zeros(),
            position: Vec3::zeros(),
            thread: 0.0,
            gap: [0.0; STITCHES_MAX],
            gap_mean: 0.0,
            saturated: false,
            puncture: None,
        }
    }
}
