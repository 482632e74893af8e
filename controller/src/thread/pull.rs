//! What the thread does to the hand: F = c Δl / Σ 1/k_i (Lian & Chen Eqs 9–11).

use super::chain::Chain;
use super::config::Params;
use super::knot::tied_stiffness;
use super::link::spring;
use super::state::{Place, State};
use crate::math::{Vec3, direction, length};

/// Eq. 11 is for springs in series at one tension, of which the needle's coupling is one. While a slack thread is drawn along,
/// single links overshoot within a tick and the coupling bears nothing of it: more than this multiple of what it bears is no
/// pull. A taut thread differs from its coupling by its weight and inertia alone, and is left as Eq. 11 has it.
const OVERSHOOT: f32 = 2.0;

/// The thread at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pull {
    /// What the hand feels [N]: the tension by Eq. 11, or with friction that of N₀'s own link.
    pub tension: f32,
    /// Tension by Eq. 11 with c = 1, between the needle and what holds the thread [N]; at most twice what the needle's coupling bears.
    pub eq11: f32,
    /// Direction from N₀ along the thread; zero where the first link has no length.
    pub direction: Vec3,
    /// Force of the thread on the swage, through the coupling [N].
    pub on_needle: Vec3,
    /// Overall elongation Δl of Eq. 10, below zero where the thread is slack [m].
    pub elongation: f32,
    /// Tension between the last puncture and the tail [N], the needle's until the knot; zero before the thread runs through one.
    pub stitch: f32,
    /// Length of thread from the last puncture to the tail, along its links [m].
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
pub(super) struct Sum {
    length: f32,
    elongation: f32,
    /// [m/N].
    pub(super) compliance: f32,
}

impl Sum {
    pub(super) fn link(&mut self, params: &Params, length: f32) {
        self.length += length;
        self.elongation += length - params.rest;
        self.compliance += params.rest / params.axial;
    }

    pub(super) fn part(&mut self, params: &Params, length: f32, rest: f32) {
        self.length += length;
        self.elongation += length - rest;
        self.compliance += 1.0 / tied_stiffness(params, rest);
    }

    fn and(&self, other: &Self) -> Self {
        Self {
            length: self.length + other.length,
            elongation: self.elongation + other.elongation,
            compliance: self.compliance + other.compliance,
        }
    }

    pub(super) fn tension(&self) -> f32 {
        eq11(1.0, self.elongation, self.compliance)
    }
}

/// The thread's pull, from where its nodes are.
pub(super) fn pull(params: &Params, state: &State, swage: Option<Vec3>) -> Pull {
    let [first, second, ..] = &state.nodes;
    let on_needle = swage.map_or_else(Vec3::zeros, |swage| Place::new(swage).to(first) * params.coupling);
    let most = swage.map_or(f32::INFINITY, |_| OVERSHOOT * length(on_needle));
    let course = &state.course;
    let newest = course.through().last();
    let towards = newest
        .filter(|eyelet| eyelet.link == 0)
        .map_or(second, |eyelet| &eyelet.place);
    let (outside, inside) = parts(params, state);
    let whole = if course.knot.is_some() {
        outside
    } else {
        outside.and(&inside)
    };
    let eq11 = whole.tension().min(most);
    let rubs = params.friction.is_some();
    let stitch = match (course.knot, newest) {
        (Some(_), _) if !rubs => inside.tension(),
        (_, Some(newest)) if rubs => {
            let [_, behind] = around(params, state, newest.link, course.count);
            behind
        }
        (_, Some(_)) => eq11,
        (_, None) => 0.0,
    };
    let tension = if rubs {
        let [own, _] = around(params, state, 0, course.count);
        own.min(most)
    } else {
        eq11
    };
    Pull {
        tension,
        eq11,
        direction: direction(first.to(towards), 1e-9),
        on_needle,
        elongation: whole.elongation,
        stitch,
        between: if newest.is_some() { inside.length } else { 0.0 },
    }
}

/// Tensions of a link's first piece and of what is behind its first eyelet [N]; `newer` eyelets are not before it.
fn around(params: &Params, state: &State, link: usize, newer: usize) -> [f32; 2] {
    let eyelets = state.course.within(link, newer);
    if eyelets.is_empty() {
        let ends = state.nodes.get(link).zip(state.nodes.get(link + 1));
        let long = ends.map_or(0.0, |(a, b)| length(a.to(b)));
        let (tension, _) = spring(params.stiffness(), long - params.rest, 0.0);
        return [tension; 2];
    }
    let tied = state.course.knot.filter(|_| eyelets.end == state.course.count);
    let chain = Chain::new((&state.nodes, params.nodes), &state.course, link, eyelets);
    let [first, second, ..] = chain.strain(params, 0.0, tied).tension;
    [first, second]
}

/// The thread from the needle to the last puncture, and from there to the tail. A link that slides through that puncture counts as a
/// whole with the former but for its length.
fn parts(params: &Params, state: &State) -> (Sum, Sum) {
    let (mut outside, mut inside) = (Sum::default(), Sum::default());
    let course = &state.course;
    let mut newer = course.count;
    let links = state.nodes.iter().zip(state.nodes.iter().skip(1)).enumerate();
    for (index, (a, b)) in links.take(params.nodes - 1) {
        let eyelets = course.within(index, newer);
        let last = !eyelets.is_empty() && eyelets.end == course.count;
        let whole = if eyelets.is_empty() {
            length(a.to(b))
        } else {
            let chain = Chain::new((&state.nodes, params.nodes), course, index, eyelets.clone());
            newer = eyelets.start;
            let tail_side = chain.length_from(1);
            match course.knot.filter(|_| last) {
                Some([a_rest, b_rest]) => {
                    outside.part(params, chain.length_from(0) - tail_side, a_rest);
                    inside.part(params, tail_side, b_rest);
                    continue;
                }
                None if last => {
                    outside.link(params, chain.length_from(0));
                    outside.length -= tail_side;
                    inside.length += tail_side;
                    continue;
                }
                None => chain.length_from(0),
            }
        };
        if newer == course.count {
            outside.link(params, whole);
        } else {
            inside.link(params, whole);
        }
    }
    (outside, inside)
}
