//! Tests of the thread.

mod behaviour;
mod bending;
mod exact;
mod friction;
mod knot;

mod reference;

use sutura_shared::scene::{self, Effect, Effects};

use super::*;
use crate::coupling::POINTS;
use crate::math::{DT, Vec3, length};

/// Nylon 3-0: EA 76 N, 43 mg/m, EI 230 nN·m².
pub(super) fn nylon(nodes: u16, link_m: f32) -> scene::Thread {
    scene::Thread {
        nodes,
        link_m,
        axial_n: 76.0,
        mass_kg_per_m: 43e-6,
        damping_per_s: 20.0,
        penalty_n_per_m: 200.0,
        friction: 0.2,
        knot_hold_n: 20.0,
        bending_n_m2: 2.3e-7,
    }
}

pub(super) fn params(nodes: u16, link_m: f32, effects: &[Effect]) -> Params {
    let effects = effects.iter().fold(Effects::default(), |all, effect| all.with(*effect));
    build(&nylon(nodes, link_m), 500.0, effects).unwrap()
}

/// Nothing to lie on.
pub(super) struct Air;

impl Ground for Air {
    fn at(&self, _: Vec3) -> Option<Touch> {
        None
    }
}

/// A thread and its scratch.
pub(super) struct Thread {
    pub(super) state: State,
    pub(super) work: Work,
}

impl Thread {
    pub(super) fn new(state: State) -> Self {
        Self {
            state,
            work: Work::default(),
        }
    }
}

/// Points of tissue that hold the thread, its tail and then its eyelets: each a mass on a spring to its place at rest.
#[derive(Clone)]
pub(super) struct Tissue {
    pub(super) mass: f32,
    pub(super) stiffness: f32,
    pub(super) rest: Vec<Vec3>,
    pub(super) at: Vec<Vec3>,
    pub(super) velocity: Vec<Vec3>,
    /// The direction in which the thread leaves the needle.
    pub(super) heading: Vec3,
}

impl Tissue {
    pub(super) fn new(rest: &[Vec3]) -> Self {
        Self {
            mass: 8e-6,
            stiffness: 250.0,
            rest: rest.to_vec(),
            at: rest.to_vec(),
            velocity: vec![Vec3::zeros(); rest.len()],
            heading: Vec3::zeros(),
        }
    }

    /// What holds the thread where the points would be if nothing acted on them.
    pub(super) fn ends(&self, swage: Vec3) -> Ends {
        let predicted = self
            .at
            .iter()
            .zip(&self.velocity)
            .map(|(at, velocity)| at + velocity * DT);
        let mut ends = Ends {
            swage: Some(swage),
            heading: self.heading,
            end_stiffness: self.mass / (DT * DT) + self.stiffness,
            ..Ends::default()
        };
        ends.tail = predicted.clone().next();
        ends.eyelets
            .iter_mut()
            .zip(predicted.skip(1))
            .for_each(|(eyelet, at)| *eyelet = at);
        ends
    }

    /// A backward Euler step together with the thread, as the tissue's solver makes it.
    pub(super) fn tick(&mut self, params: &Params, thread: &mut Thread, swage: Vec3, ground: &impl Ground) -> Pull {
        let Thread { state, work } = thread;
        let ends = self.ends(swage);
        let reduced = condense(params, state, &ends, ground, work);
        let n = self.at.len();
        assert_eq!(reduced.len, n);
        let predicted: Vec<Vec3> = ends.tail.into_iter().chain(ends.eyelets).take(n).collect();
        let mut matrix = vec![vec![0.0_f64; 3 * n]; 3 * n];
        let mut right = vec![0.0_f64; 3 * n];
        for i in 0..n {
            let force = reduced.force[i] - (predicted[i] - self.rest[i]) * self.stiffness;
            for r in 0..3 {
                right[3 * i + r] = f64::from(force[r]);
                matrix[3 * i + r][3 * i + r] += f64::from(ends.end_stiffness);
                for j in 0..n {
                    for c in 0..3 {
                        matrix[3 * i + r][3 * j + c] += f64::from(reduced.stiffness[i][j][(r, c)]);
                    }
                }
            }
        }
        let solved = reference::solve(matrix, right);
        let mut moved = [Vec3::zeros(); POINTS];
        for i in 0..n {
            moved[i] = Vec3::from_iterator(solved[3 * i..3 * i + 3].iter().map(|x| *x as f32));
            let new = predicted[i] + moved[i];
            self.velocity[i] = (new - self.at[i]) / DT;
            self.at[i] = new;
        }
        settle(params, state, work, &moved)
    }
}

/// A thread laid straight from its tail at the first of `stops` through eyelets at the others and on along `way`, a hair short of taut; one that
/// bends at rest.
pub(super) fn laid(params: &Params, stops: &[Vec3], way: Vec3) -> State {
    let n = params.nodes();
    let fit = if params.bending.is_some() { 1.0 } else { 0.99 };
    let from_tail = |i: usize| fit * params.rest * (n - 1 - i) as f32;
    let mut state = State::laid(params, stops[0] + way, stops[0], Vec3::z());
    for (i, node) in state.nodes.iter_mut().enumerate().take(n) {
        let mut left = from_tail(i);
        let mut place = stops[stops.len() - 1] + way * left;
        for leg in stops.windows(2) {
            let whole = length(leg[1] - leg[0]);
            place = leg[0] + (leg[1] - leg[0]) * (left / whole);
            if left < whole {
                break;
            }
            left -= whole;
            place = stops[stops.len() - 1] + way * left;
        }
        *node = Place::new(place);
    }
    let mut reached = 0.0;
    for leg in stops.windows(2) {
        reached += length(leg[1] - leg[0]);
        state.lead_through(leg[1]);
        let newest = state.course.count - 1;
        state.course.eyelets[newest].link = (0..n).filter(|i| from_tail(*i) > reached).count() - 1;
    }
    state
}
