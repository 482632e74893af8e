//! A PHANToM Premium 1.5 held by a hand that follows a script.
//!
//! Each tick the motors hold the rendered force while hand and arm move together for 1 ms. Whatever the scene's force profile, the
//! arm and its motors are those of the Premium 1.5. The gimbal is passive: the hand gives the orientation, the arm the position.

pub mod dynamics;
pub mod encoder;
pub mod hand;
pub mod kinematics;
pub mod script;

use crate::device::Device;
use crate::math::{DT, Pose, Vec3, finite};
use crate::record::{Output, Sample};
use heapless::Vec;
use kinematics::Posture;
use sutura_shared::scene::{self, STEPS_MAX, Step};

/// Steps of the arm in one tick: 0.1 ms each, short against the arm on a hand or a wall (10 ms and more).
const SUBSTEPS: u16 = 10;
/// One step of the arm [s].
const SUBSTEP: f32 = DT / SUBSTEPS as f32;

/// Stiffness at the tip that the arm's friction and encoders bear without a limit cycle, 2 f_c/Δ (Abbott & Okamura 2005) with f_c = 0.04 N and
/// Δ = 0.03 mm of the Premium 1.5's data sheet [N/m].
pub const BEARS: f32 = 2.0 * 0.04 / 3e-5;

/// Why there is no simulated device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// The arm cannot put its tip where the script begins.
    Unreachable {
        /// The place in the device's frame [m].
        device_m: [f32; 3],
    },
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self::Unreachable { device_m: [x, y, z] } = self;
        let [x, y, z] = [x, y, z].map(|m| m * 1e3);
        write!(
            f,
            "hand.start is ({x:.0}, {y:.0}, {z:.0}) mm in the device's frame, out of the arm's reach; move it or the device to within 60 mm of (0, 0, 0)"
        )
    }
}

impl core::error::Error for Error {}

/// What does not change during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// The hand.
    pub hand: hand::Params,
    /// What the hand does, in the patch frame.
    pub steps: Vec<Step, STEPS_MAX>,
    /// From the script's frame to the device's.
    pub device_from_patch: Pose,
}

/// What changes: plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// The arm.
    pub arm: dynamics::State,
    /// The script.
    pub script: script::State,
}

impl State {
    /// Every number as its bits, in a fixed order, for hashes.
    pub fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let (arm, script) = (&self.arm, &self.script);
        let poses = [&script.from, &script.target];
        [script.step, script.elapsed, script.punctured, script.felt]
            .into_iter()
            .chain(arm.angle.iter().chain(&arm.rate).map(|x| x.to_bits()))
            .chain(
                poses
                    .into_iter()
                    .flat_map(|pose| pose.position_m.iter().chain(&pose.quaternion).map(|x| x.to_bits())),
            )
    }
}

/// The simulated device with its hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    params: Params,
    state: State,
}

impl Simulated {
    /// The arm at rest where the script begins.
    ///
    /// # Errors
    /// [`Error::Unreachable`] if the arm's links or stops do not let the tip be there.
    pub fn new(device: &scene::Device, hand: &scene::Hand) -> Result<Self, Error> {
        let device_from_patch = Pose::from(device.patch_from_device).inverse();
        let tip = device_from_patch.point(Vec3::from(hand.start.position_m));
        let angle = kinematics::inverse(tip)
            .filter(|q| finite(*q) && kinematics::within_stops(*q))
            .ok_or(Error::Unreachable { device_m: tip.into() })?;
        Ok(Self {
            params: Params {
                hand: hand::Params {
                    mass: hand.mass_kg,
                    damping: hand.damping_n_s_per_m,
                    stiffness: hand.stiffness_n_per_m,
                },
                steps: hand.steps.clone(),
                device_from_patch,
            },
            state: State {
                arm: dynamics::State {
                    angle,
                    rate: Vec3::zeros(),
                },
                script: script::State::new(hand.start),
            },
        })
    }

    /// Whether every step of the script is over.
    #[must_use]
    pub fn script_done(&self) -> bool {
        script::current(&self.params.steps, &self.state.script).is_none()
    }

    /// Where the tip really is, device frame [m].
    #[must_use]
    pub fn tip(&self) -> Vec3 {
        Posture::at(self.state.arm.angle).tip()
    }

    /// Everything that changes.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Where the hand wants the stylus, `device_from_stylus`.
    fn target(&self) -> Pose {
        let wanted = Pose::from(self.state.script.target);
        self.params.device_from_patch.then(&wanted)
    }
}

impl Device for Simulated {
    fn sense(&mut self) -> Sample {
        let arm = Posture::at(self.state.arm.angle);
        let measured = Posture::at(encoder::joints(self.state.arm.angle));
        let step = script::current(&self.params.steps, &self.state.script);
        Sample {
            pose: Pose {
                position: measured.tip(),
                rotation: encoder::orientation(self.target().rotation, &arm, &measured),
            },
            button: step.is_some_and(|step| step.button),
        }
    }

    fn actuate(&mut self, output: &Output) {
        let from = self.target().position;
        script::advance(&self.params.steps, &mut self.state.script, output);
        let way = self.target().position - from;
        hold(&self.params.hand, &mut self.state.arm, output.rendered.get(), from, way);
    }
}

/// One tick: the motors push with `force` [N] while the hand's target moves by `way` [m] from `from`, all in the device's frame.
pub fn hold(hand: &hand::Params, arm: &mut dynamics::State, force: Vec3, from: Vec3, way: Vec3) {
    for part in 1..=SUBSTEPS {
        let posture = Posture::at(arm.angle);
        let target = hand::Point {
            position: from + way * (f32::from(part) / f32::from(SUBSTEPS)),
            velocity: way / DT,
        };
        let tip = hand::Point {
            position: posture.tip(),
            velocity: posture.jacobian() * arm.rate,
        };
        let load = dynamics::Load {
            torque: dynamics::motor_torque(&posture, force),
            ..hand::grip(hand, &target, &tip, SUBSTEP)
        };
        dynamics::step(arm, &posture, &load, SUBSTEP);
    }
}

#[cfg(test)]
mod tests;
