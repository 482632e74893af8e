//! A Premium 1.5 with its encoders, in a hand that goes where a case says.

use std::f32::consts::TAU;

use sutura_controller::device::sim::kinematics::{self, Posture};
use sutura_controller::device::sim::{dynamics, encoder, hand, hold};
use sutura_controller::math::{Pose, Vec3};

use super::felt::Felt;
use super::run::Run;
use crate::study::stability::case::Unfinished;

/// When the motors get a tick's force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Latency {
    /// For the millisecond that the tick begins.
    None,
    /// One tick later.
    Tick,
}

/// What becomes of a millisecond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It is a tick.
    Tick,
    /// The encoders' sample is that of the millisecond before.
    Stale,
    /// There is no tick: the motors hold what they have.
    Lost,
}

/// A scene whose tool is in the hand.
pub(super) struct Held<'a> {
    pub(super) run: Run<'a>,
    hand: hand::Params,
    arm: dynamics::State,
    /// Where the hand wants to be, device frame.
    target: Pose,
    sample: Pose,
    latency: Latency,
    /// What the motors get next, and what they have [N].
    next: Vec3,
    sent: Vec3,
    pub(super) felt: Felt,
}

impl<'a> Held<'a> {
    /// At rest at `target`, patch frame.
    pub(super) fn new(run: Run<'a>, hand: hand::Params, latency: Latency, target: Pose) -> Result<Self, Unfinished> {
        let target = run.in_device(target);
        let angle = kinematics::inverse(target.position).filter(|q| kinematics::within_stops(*q));
        let arm = dynamics::State {
            angle: angle.ok_or(Unfinished::Built("the arm cannot reach the scene"))?,
            rate: Vec3::zeros(),
        };
        Ok(Self {
            run,
            hand,
            arm,
            target,
            sample: target,
            latency,
            next: Vec3::zeros(),
            sent: Vec3::zeros(),
            felt: Felt::default(),
        })
    }

    /// One millisecond, in which the hand's target goes to `target` in the patch frame.
    pub(super) fn pass(&mut self, target: Pose, fate: Fate) -> Result<(), Unfinished> {
        if fate == Fate::Tick {
            self.sample = self.seen();
        }
        if fate != Fate::Lost {
            let force = self.run.sense(self.sample)?.rendered.get();
            let late = std::mem::replace(&mut self.next, force);
            self.sent = match self.latency {
                Latency::None => force,
                Latency::Tick => late,
            };
        }
        self.felt.note(self.sent, Posture::at(self.arm.angle).tip());
        let target = self.run.in_device(target);
        let from = self.target.position;
        hold(&self.hand, &mut self.arm, self.sent, from, target.position - from);
        self.target = target;
        Ok(())
    }

    /// From one place to another in `ticks`, then with tremor of 0.2 mm at 10 Hz along `shake` where that is not zero; `fate` by millisecond.
    pub(super) fn go(
        &mut self,
        [from, to]: [Pose; 2],
        ticks: u32,
        shake: Vec3,
        mut fate: impl FnMut() -> Fate,
    ) -> Result<(), Unfinished> {
        (1..=ticks).try_for_each(|tick| {
            let part = tick as f32 / ticks as f32;
            let tremor = shake * (2e-4 * (TAU * 0.01 * (tick % 100) as f32).sin());
            let position = from.position + (to.position - from.position) * part + tremor;
            self.pass(Pose { position, ..to }, fate())
        })
    }

    /// The pose that the encoders say.
    fn seen(&self) -> Pose {
        let arm = Posture::at(self.arm.angle);
        let measured = Posture::at(encoder::joints(self.arm.angle));
        Pose {
            position: measured.tip(),
            rotation: encoder::orientation(self.target.rotation, &arm, &measured),
        }
    }
}
