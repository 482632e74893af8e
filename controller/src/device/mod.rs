//! The hand's side: a force-feedback arm, real or simulated.

pub mod sim;

use crate::record::{Output, Sample};

/// A force-feedback device: two calls a tick.
pub trait Device {
    /// What the encoders say now.
    fn sense(&mut self) -> Sample;
    /// Takes the tick's answer: the force to hold until the next one, and what the person sees meanwhile.
    fn actuate(&mut self, output: &Output);
}
