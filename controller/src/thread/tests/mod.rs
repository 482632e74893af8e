//! Tests of the thread.

mod behaviour;
mod exact;

mod reference;

use sutura_shared::scene::{self, Effect, Effects};

use super::*;
use crate::math::{DT, Vec3};

/// Nylon 3-0: EA 76 N, 43 mg/m.
pub(super) fn nylon(nodes: u16, link_m: f32) -> scene::Thread {
    scene::Thread {
        nodes,
        link_m,
        axial_n: 76.0,
        mass_kg_per_m: 43e-6,
        damping_per_s: 20.0,
        penalty_n_per_m: 200.0,
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

/// Two points of tissue, each a mass on a spring to its place at rest.
#[derive(Clone)]
pub(super) struct Tissue {
    pub(super) mass: f32,
    pub(super) stiffness: f32,
    pub(super) rest: [Vec3; 2],
    pub(super) at: [Vec3; 2],
    pub(super) velocity: [Vec3; 2],
}

impl Tissue {
    pub(super) fn new(rest: [Vec3; 2]) -> Self {
        Self {
            mass: 8e-6,
            stiffness: 250.0,
            rest,
            at: rest,
            velocity: [Vec3::zeros(); 2],
        }
    }

    /// A backward Euler step together with the thread, as the tissue's solver makes it.
    pub(super) fn tick(&mut self, params: &Params, thread: &mut Thread, swage: Vec3, ground: &impl Ground) -> Pull {
        let Thread { state, work } = thread;
        let predicted = [0, 1].map(|i| self.at[i] + self.velocity[i] * DT);
        let inertia = self.mass / (DT * DT);
        let diagonal = inertia + self.stiffness;
        let ends = Ends {
            swage: Some(swage),
            tail: Some(predicted[0]),
            eyelet: (state.run != Run::Free).then_some(predicted[1]),
            end_stiffness: diagonal,
        };
        let reduced = condense(params, state, &ends, ground, work);
        let mut matrix = vec![vec![0.0_f64; 6]; 6];
        let mut right = vec![0.0_f64; 6];
        for i in 0..2 {
            let force = reduced.force[i] - (predicted[i] - self.rest[i]) * self.stiffness;
            for r in 0..3 {
                right[3 * i + r] = f64::from(force[r]);
                matrix[3 * i + r][3 * i + r] += f64::from(diagonal);
                for j in 0..2 {
                    for c in 0..3 {
                        matrix[3 * i + r][3 * j + c] += f64::from(reduced.stiffness[i][j][(r, c)]);
                    }
                }
            }
        }
        let solved = reference::solve(matrix, right);
        let moved = [0, 1].map(|i| Vec3::new(solved[3 * i] as f32, solved[3 * i + 1] as f32, solved[3 * i + 2] as f32));
        for i in 0..2 {
            let new = predicted[i] + moved[i];
            self.velocity[i] = (new - self.at[i]) / DT;
            self.at[i] = new;
        }
        settle(params, state, work, moved)
    }
}
