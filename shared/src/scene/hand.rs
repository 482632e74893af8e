//! The simulated hand and what it does.

use super::{Pose, Site, Stage};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Most steps of a hand's script.
pub const STEPS_MAX: usize = 48;

/// The simulated hand: a mass on a spring and a damper that follows a script (science of the hand: 0.1–0.5 kg, 2–10 N·s/m, 100–800 N/m).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hand {
    /// Mass [kg].
    pub mass_kg: f32,
    /// Damping [N·s/m].
    pub damping_n_s_per_m: f32,
    /// Stiffness [N/m].
    pub stiffness_n_per_m: f32,
    /// How it trembles; none where it is steady.
    pub tremor: Option<Tremor>,
    /// Where the script begins, pose of the grasp point in the patch frame.
    pub start: Pose,
    /// What it does, one step after the other; the last pose is held.
    pub steps: Vec<Step, STEPS_MAX>,
}

/// A tremor of the hand's target: a sine along each axis of the patch frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tremor {
    /// Amplitude of each sine [m].
    pub amplitude_m: f32,
    /// Frequency [Hz].
    pub frequency_hz: f32,
    /// Phase at tick 0 by axis [rad].
    pub phases_rad: [f32; 3],
}

/// One step of the script. A step starts from the pose at which the step before it ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The path.
    pub motion: Motion,
    /// Time for the whole path [ticks].
    pub ticks: u32,
    /// What ends the step early.
    pub until: Until,
    /// Whether the stylus button is held during the step (it ties the knot).
    pub button: bool,
}

/// A path of the hand, in the patch frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Motion {
    /// A straight line to `to`, turning along the shortest arc; speed follows a minimum-jerk profile.
    Line {
        /// End of the path.
        to: Pose,
    },
    /// The same at constant speed, from wherever the hand is; it waits at the end for the rest of the step's time.
    Steady {
        /// End of the path.
        to: Pose,
        /// Speed along it [m/s].
        speed_m_per_s: f32,
    },
    /// A turn about an axis, as the wrist drives a curved needle, at constant speed.
    Turn {
        /// A point on the axis [m].
        centre_m: [f32; 3],
        /// Direction of the axis, unit length.
        axis: [f32; 3],
        /// Angle, right-handed about the axis [rad].
        angle_rad: f32,
    },
    /// No motion.
    Hold,
}

/// What the hand waits for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Until {
    /// The end of the path.
    Elapsed,
    /// The needle has passed the site.
    Punctured(Site),
    /// The thread's tension reaches this [N].
    Tension(f32),
    /// The stage has been reached.
    Stage(Stage),
}
