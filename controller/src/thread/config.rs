//! Coefficients of the thread, with the period folded in.

use sutura_shared::scene::{self, Effect, Effects};

use super::state::NODES_MAX;
use crate::math::DT;

/// Standard gravity [m/s²].
const GRAVITY: f32 = 9.806_65;

/// Distance from the eyelet below which a node's own direction is no longer trusted [m].
pub(super) const EYELET: f32 = 1e-4;

/// Immutable coefficients of a thread; made by [`build`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Mass elements n, 3 to [`NODES_MAX`].
    pub(super) nodes: usize,
    /// Rest length of a link l₀ [m].
    pub(super) rest: f32,
    /// Axial stiffness EA [N].
    pub(super) axial: f32,
    /// m (1 + α dt)/dt² of an inner node [N/m]; an end has half.
    pub(super) inertia: f32,
    /// dt/(1 + α dt) [s]: velocity to the displacement of a free node in one tick.
    pub(super) coast: f32,
    /// Weight of an inner node [N]; nothing without effect `gravity`.
    pub(super) weight: Option<f32>,
    /// Spring between N₀ and the swage [N/m].
    pub(super) coupling: f32,
    /// Penalty of Eq. 8 [N/m]; nothing without effect `thread-contact`.
    pub(super) penalty: Option<f32>,
    /// Coefficient of friction at the punctures; nothing without effect `thread-friction`.
    pub(super) friction: Option<f32>,
    /// Difference of tension at which the knot slips [N]; nothing without effect `knot`.
    pub(super) knot: Option<f32>,
    /// EI/l₀³ [N/m]; nothing without effect `thread-bending`.
    pub(super) bending: Option<f32>,
}

impl Params {
    /// Mass elements n.
    #[must_use]
    pub const fn nodes(&self) -> usize {
        self.nodes
    }

    /// Length of the whole thread at rest [m].
    #[must_use]
    pub fn length(&self) -> f32 {
        self.rest * (self.nodes - 1) as f32
    }

    /// Stiffness of one link EA/l₀ [N/m].
    #[must_use]
    pub fn stiffness(&self) -> f32 {
        self.axial / self.rest
    }

    /// Share of an inner node's mass that node `index` has: the ends carry half a link.
    pub(super) const fn share(&self, index: usize) -> f32 {
        if index == 0 || index + 1 == self.nodes {
            0.5
        } else {
            1.0
        }
    }
}

/// Why a thread cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// `nodes` is outside 3 to [`NODES_MAX`].
    Nodes(u16),
    /// The links are shorter than two millimetres or not finite: the eyelet needs room for one node at a time.
    Link,
    /// A coefficient, by its name, is not finite or has the wrong sign.
    Coefficient(&'static str),
}

/// Coefficients of `thread`, hung on the needle by `coupling_n_per_m` [N/m], with those of `effects` that concern a thread.
///
/// # Errors
/// A count, a length or a coefficient out of its range.
pub fn build(thread: &scene::Thread, coupling_n_per_m: f32, effects: Effects) -> Result<Params, ConfigError> {
    let nodes = usize::from(thread.nodes);
    if !(3..=NODES_MAX).contains(&nodes) {
        return Err(ConfigError::Nodes(thread.nodes));
    }
    if !(thread.link_m.is_finite() && thread.link_m >= 20.0 * EYELET) {
        return Err(ConfigError::Link);
    }
    let positive = [
        ("axial_n", thread.axial_n),
        ("mass_kg_per_m", thread.mass_kg_per_m),
        ("coupling_n_per_m", coupling_n_per_m),
    ];
    let not_negative = [
        ("damping_per_s", thread.damping_per_s),
        ("penalty_n_per_m", thread.penalty_n_per_m),
        ("friction", thread.friction),
        ("knot_hold_n", thread.knot_hold_n),
        ("bending_n_m2", thread.bending_n_m2),
    ];
    if let Some((name, _)) = positive.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
        return Err(ConfigError::Coefficient(name));
    }
    if let Some((name, _)) = not_negative
        .iter()
        .find(|(_, value)| !(value.is_finite() && *value >= 0.0))
    {
        return Err(ConfigError::Coefficient(name));
    }
    let cube = thread.link_m * thread.link_m * thread.link_m;
    let mass = thread.mass_kg_per_m * thread.link_m;
    let damped = 1.0 + thread.damping_per_s * DT;
    Ok(Params {
        nodes,
        rest: thread.link_m,
        axial: thread.axial_n,
        inertia: mass * damped / (DT * DT),
        coast: DT / damped,
        weight: effects.has(Effect::Gravity).then_some(mass * GRAVITY),
        coupling: coupling_n_per_m,
        penalty: effects.has(Effect::ThreadContact).then_some(thread.penalty_n_per_m),
        friction: effects.has(Effect::ThreadFriction).then_some(thread.friction),
        knot: effects.has(Effect::Knot).then_some(thread.knot_hold_n),
        bending: effects.has(Effect::ThreadBending).then_some(thread.bending_n_m2 / cube),
    })
}
