//! What the thread does to the hand: F = c Δl / Σ 1/k_i (Lian & Chen Eqs 9–11).

use super::config::Params;
use super::eyelet::pieces;
use super::link::tied_stiffness;
use super::state::{NODES_MAX, Place, Run, State};
use crate::math::{Vec3, direction, length};

/// Eq. 11 is for springs in series at one tension, of which the needle's coupling is one. While a slack thread is drawn along,
/// single links overshoot within a tick and the coupling bears nothing of it: more than this multiple of what it bears is no
/// pull. A taut thread differs from its coupling by its weight and inertia alone, and is left as Eq. 11 has it.
const OVERSHOOT: f32 = 2.0;

/// The thread at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pull {
    /// Tension by Eq. 11 with c = 1, between the needle and what holds the thread [N]; at most twice what the needle's coupling bears.
    pub tension: f32,
    /// Direction from N₀ along the thread; zero where the first link has no length.
    pub direction: Vec3,
    /// Force of the thread on the swage, through the coupling [N].
    pub on_needle: Vec3,
    /// Overall elongation Δl of Eq. 10, below zero where the thread is slack [m].
    pub elongation: f32,
    /// Tension between the two punctures [N], the needle's until the knot; zero before the thread runs through the right one.
    pub stitch: f32,
    /// Length of thread between the two punctures, along its links [m].
    pub between: f32,
}

/// Eq. 11: force of a chain of springs whose elongations add to `elongation` [m] and whose compliances 1/k_i add to
/// `compliance` [m/N], mapped by `c`; a thread does not push.
#[must_use]
pub fn eq11(c: f32, elongation: f32, compliance: f32) -> f32 {
    if elongation > 0.0 && compliance > 0.0 {
        c * elongation / compliance
    } else {
        0.0
    }
}

/// Sums of a run of links.
#[derive(Clone, Copy, Default)]
struct Sum {
    length: f32,
    elongation: f32,
    compliance: f32,
}

impl Sum {
    fn link(&mut self, params: &Params, length: f32) {
        self.length += length;
        self.elongation += length - params.rest;
        self.compliance += params.rest / params.axial;
    }

    fn piece(&mut self, length: f32, rest: f32, stiffness: f32) {
        self.length += length;
        self.elongation += length - rest;
        self.compliance += 1.0 / stiffness;
    }

    fn tension(&self) -> f32 {
        eq11(1.0, self.elongation, self.compliance)
    }
}

/// The thread's pull, from where its nodes are.
pub(super) fn pull(params: &Params, state: &State, swage: Option<Vec3>) -> Pull {
    let [first, second, ..] = &state.nodes;
    let on_needle = swage.map_or_else(Vec3::zeros, |swage| Place::new(swage).to(first) * params.coupling);
    let most = swage.map_or(f32::INFINITY, |_| OVERSHOOT * length(on_needle));
    let (run, eyelet) = match state.eyelet {
        Some(eyelet) => (state.run, Place::new(eyelet)),
        None => (Run::Free, Place::default()),
    };
    let start = match run {
        Run::Sliding { link: 0 } | Run::Tied { link: 0, .. } => first.to(&eyelet),
        _ => first.to(second),
    };
    let (needle, stitch, between) = match run {
        Run::Free => {
            let whole = straight(params, &state.nodes, 0, params.nodes - 1);
            (whole, 0.0, 0.0)
        }
        Run::Sliding { link } => {
            let [a, b] = pieces(&state.nodes, params.nodes, link, &eyelet);
            let mut whole = straight(params, &state.nodes, 0, link);
            let inside = straight(params, &state.nodes, link + 1, params.nodes - 1);
            whole.link(params, a.length + b.length);
            whole.elongation += inside.elongation;
            whole.compliance += inside.compliance;
            (whole, whole.tension().min(most), b.length + inside.length)
        }
        Run::Tied { link, rest } => {
            let [a, b] = pieces(&state.nodes, params.nodes, link, &eyelet);
            let [a_rest, b_rest] = rest;
            let mut outside = straight(params, &state.nodes, 0, link);
            outside.piece(a.length, a_rest, tied_stiffness(params, a_rest));
            let mut inside = straight(params, &state.nodes, link + 1, params.nodes - 1);
            inside.piece(b.length, b_rest, tied_stiffness(params, b_rest));
            (outside, inside.tension(), inside.length)
        }
    };
    Pull {
        tension: needle.tension().min(most),
        direction: direction(start, 1e-9),
        on_needle,
        elongation: needle.elongation,
        stitch,
        between,
    }
}

/// The ordinary links from node `from` to node `to`.
fn straight(params: &Params, nodes: &[Place; NODES_MAX], from: usize, to: usize) -> Sum {
    let mut sum = Sum::default();
    let links = nodes.iter().zip(nodes.iter().skip(1));
    for (a, b) in links.take(to).skip(from) {
        sum.link(params, length(a.to(b)));
    }
    sum
}
