//! Coulomb friction at the eyelets: T_out/T_in = e^{μφ} where the thread slips (Euler, Eytelwein), φ the angle by which it turns.
//!
//! A force F along the way of the thread parts the tension of the pieces before and behind an eyelet: T̄ + F/2 and T̄ − F/2. They are in
//! the ratio e^{μφ} at |F| = 2 T̄ tanh(μφ/2). Below that the thread adheres by a spring to the point w of its way s (Hayward & Armstrong
//! 2000), which follows where it slips; so the energy's curvature stays symmetric, and a slack thread, T̄ = 0, rubs nowhere.
//!
//! It is right for slow slides only: within 3 % of the capstan's law at up to 4 mm/s, and 3 to 17 % above it at 20 mm/s, for within a tick
//! the slipping thread is held by a spring too. Where two eyelets come within 0.1 mm of each other the tension jumps.

use super::chain::{Chain, Strain};
use super::config::Params;
use crate::math::{Vec3, length};

/// How the thread holds at an eyelet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    /// The point w of its way at which it adheres [m]; none before it has been there for a tick.
    pub adhesion: Option<f32>,
    /// F, the tension towards the needle over that towards the tail [N].
    pub drag: f32,
}

/// Adds what friction does at the eyelets of a chain behind piece `from`, which is the first of those that slide as one.
pub(super) fn rub(params: &Params, chain: &Chain, from: usize, strain: &mut Strain) {
    let Some(friction) = params.friction else { return };
    let tension = strain.tension.get(from).copied().unwrap_or_default();
    let before: f32 = chain.grips().iter().skip(from).map(|grip| grip.drag).sum();
    // Of the eyelets ahead the forces are those of the last iterate.
    let mut ahead = before;
    let mut behind = 0.0;
    for eyelet in from + 1..=chain.eyelets() {
        let Some(grip) = chain.grips().get(eyelet - 1) else {
            break;
        };
        ahead -= grip.drag;
        let mean = if tension > 0.0 {
            (tension + 0.5 * (ahead - behind)).max(0.0)
        } else {
            0.0
        };
        let limit = 2.0 * mean * libm::tanhf(0.5 * friction * turn(chain, eyelet));
        let way = chain.way(from, eyelet);
        let strained = way - grip.adhesion.unwrap_or(way);
        let elastic = params.stiffness() * strained;
        let drag = elastic.max(-limit).min(limit);
        behind += drag;
        strain.part(from, eyelet, drag);
        // Where it slips, the parabola through force and place: a constant force would throw the thread as far as its inertia lets it.
        let stiffness = if elastic.abs() > limit {
            limit / strained.abs()
        } else {
            params.stiffness()
        };
        strain.hold(from, eyelet, if limit > 0.0 { stiffness } else { 0.0 });
    }
}

/// The angle by which the thread turns at an eyelet [rad].
fn turn(chain: &Chain, eyelet: usize) -> f32 {
    let along = |index: usize| chain.pieces().get(index).map_or_else(Vec3::zeros, |piece| piece.along);
    let (before, behind) = (along(eyelet - 1), along(eyelet));
    libm::atan2f(length(before.cross(&behind)), before.dot(&behind))
}
