//! Extended position-based dynamics: every spring is a compliant constraint, projected once a substep, one after the other
//! (Macklin, Müller, Chentanez 2016; one iteration in many substeps, Macklin et al. 2019). A comparator, for blocks of one tissue of
//! springs alone.
//!
//! A linear spring has the compliance 1/k. One that stiffens is moved to where its new length and its tension there agree,
//! l⁺ = l − h² (w_a + w_b) T(l⁺), a scalar equation that is solved by Newton's method in a fixed count of steps.
//! Mass damping is implicit: v and w come over 1 + α h.

use sutura_controller::coupling::POINTS;
use sutura_controller::lattice::{Field, Tissue, add, at};
use sutura_controller::math::{DT, Vec3};
use sutura_controller::solver::{Problem, Solver, Work};

use super::spring::Spring;

/// The method's dial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Xpbd {
    /// Substeps a tick.
    pub substeps: u16,
}

/// A substep h and its coefficients, with what it acts on.
struct Substep<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    /// h [s].
    h: f32,
    /// 1/(1 + α h).
    keep: f32,
}

/// Springs of one direction.
struct Direction {
    offset: usize,
    rest: Vec3,
    length: f32,
    spring: Spring,
}

impl<const N: usize> Solver<N> for Xpbd {
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        _work: &mut Work<N>,
    ) -> [Vec3; POINTS] {
        let h = DT / f32::from(self.substeps);
        let keep = 1.0 / (1.0 + problem.material.mass_damping * h);
        let substep = Substep { problem, h, keep };
        let lattice = problem.lattice;
        let shapes = lattice
            .offsets()
            .into_iter()
            .zip(lattice.rest())
            .zip(lattice.rest_lengths());
        let directions: Vec<_> = (0..)
            .zip(shapes)
            .map(|(direction, ((offset, rest), length))| Direction {
                offset,
                rest: Vec3::from(rest),
                length,
                spring: Spring::new(problem.material, direction),
            })
            .collect();
        let [stiffness, ..] = &lattice.stiffness;
        for _ in 0..self.substeps {
            substep.predict(load, tissue);
            for (direction, stiffness) in directions.iter().zip(stiffness) {
                let springs = stiffness.iter().enumerate();
                for (low, k) in springs.filter(|(_, k)| **k > 0.0) {
                    substep.project(direction, low, *k, tissue);
                }
            }
        }
        [Vec3::zeros(); POINTS]
    }
}

impl<const N: usize> Substep<'_, N> {
    /// Moves every node by its velocity, free ones under load and damping.
    fn predict(&self, load: &Field<N>, tissue: &mut Tissue<N>) {
        let lattice = self.problem.lattice;
        let parts = tissue.displacement.iter_mut().zip(&mut tissue.velocity).zip(load);
        for ((displacement, velocity), load) in parts {
            let nodes = displacement.iter_mut().zip(velocity).zip(load);
            let inertia = lattice.mass.iter().zip(&lattice.free);
            for (((x, v), f), (mass, free)) in nodes.zip(inertia).take(lattice.len()) {
                if *free > 0.0 {
                    *v = (*v + self.h * f / mass) * self.keep;
                }
                *x += self.h * *v;
            }
        }
    }

    /// Moves the two ends of a spring to where its length and its tension agree; what moves a node also changes its velocity.
    fn project(&self, direction: &Direction, low: usize, stiffness: f32, tissue: &mut Tissue<N>) {
        let high = low + direction.offset;
        let [a, b] = [low, high].map(|node| self.mobility(node));
        if a + b <= 0.0 {
            return;
        }
        let delta = at(&tissue.displacement, high) - at(&tissue.displacement, low);
        let now = direction.rest + delta;
        let length = now.norm();
        let strain = delta.dot(&(direction.rest * 2.0 + delta)) / (length + direction.length) / direction.length;
        let settled = settle(&direction.spring, strain, self.h * self.h * (a + b) * stiffness);
        // Each end takes its share of the change of length.
        let change = now * ((settled - strain) * direction.length / (length * (a + b)));
        for (node, share) in [(low, -a), (high, b)] {
            add(&mut tissue.displacement, node, change * share);
            add(&mut tissue.velocity, node, change * (share / self.h));
        }
    }

    /// w of a node with damping, zero where it is held [1/kg].
    fn mobility(&self, node: usize) -> f32 {
        let lattice = self.problem.lattice;
        match (lattice.mass.get(node), lattice.free.get(node)) {
            (Some(mass), Some(free)) if *free > 0.0 => self.keep / mass,
            _ => 0.0,
        }
    }
}

/// Newton steps for the length of one spring, at most; one is exact for a linear spring.
const NEWTON: usize = 4;

/// The strain ε⁺ with ε⁺ − ε + c τ(ε⁺) = 0, τ = T/(k L₀).
fn settle(spring: &Spring, strain: f32, c: f32) -> f32 {
    (0..spring.pieces().min(NEWTON)).fold(strain, |settled, _| {
        let (tension, slope) = spring.follow(settled);
        settled - (settled - strain + c * tension) / (1.0 + c * slope)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::block::{Block, Spec};
    use sutura_shared::scene::{Assembly, Law};

    /// A linear spring moves by −C/(1 + α̃/w) of its constraint: XPBD's own formula with the compliance α̃ = 1/(k h²).
    #[test]
    fn a_linear_spring_is_projected_as_its_compliance_says() {
        for c in [0.01, 1.0, 100.0] {
            let settled = settle(&Spring::default(), 0.1, c);
            assert!((settled - 0.1 * (1.0 - 1.0 / (1.0 + 1.0 / c))).abs() < 1e-7);
        }
    }

    /// Beyond a breakpoint the new length and its tension agree.
    #[test]
    fn a_spring_that_stiffens_settles_where_length_and_tension_agree() {
        let spec = Spec {
            nodes: [2, 2, 2],
            pitch_m: 2e-3,
            young_pa: 1e5,
            density_kg_m3: 1000.0,
            law: Law::Paper,
            assembly: Assembly::PerVoxel,
            stiffening: true,
            damping_per_s: 0.0,
        };
        let spring = Spring::new(&Block::new(&spec).unwrap().material, 0);
        for strain in [-0.2, 0.01, 0.04, 0.2, 1.0] {
            let settled = settle(&spring, strain, 0.5);
            let miss = settled - strain + 0.5 * spring.follow(settled).0;
            assert!(miss.abs() < 1e-6, "{strain} {settled}");
        }
    }
}
