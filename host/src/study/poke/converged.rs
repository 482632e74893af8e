//! The same block on the same way in double precision, converged.

use sutura_controller::math::TICK_HZ;

use super::drive::Poke;
use crate::study::double::{Field, March, Model, Moved, NoEquilibrium, V};
use crate::study::method::Method;

/// Substeps of the explicit reference: the tick over 200, or what makes its step half of the largest stable one, with springs as steep
/// as they are at the tick's start.
const SUBSTEPS: u32 = 200;

/// What a converged solution solves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Equation {
    /// The backward Euler step of the tick.
    BackwardEuler,
    /// The equation of motion, its time step going to zero.
    Motion,
}

impl Equation {
    /// The one that a method converges to.
    pub(crate) const fn of(method: Method) -> Self {
        if method.is_substepped() {
            Self::Motion
        } else {
            Self::BackwardEuler
        }
    }
}

/// A converged solution on its way.
pub(crate) struct Converged<'a> {
    poke: &'a Poke,
    model: &'a Model,
    march: March<'a>,
    equation: Equation,
    /// Largest angular frequency at rest that an explicit step has to resolve [rad/s].
    fastest: f64,
}

impl<'a> Converged<'a> {
    /// At rest.
    pub(crate) fn new(poke: &'a Poke, model: &'a Model, equation: Equation) -> Self {
        Self {
            poke,
            model,
            march: March::new(model),
            equation,
            fastest: match equation {
                Equation::BackwardEuler => 0.0,
                Equation::Motion => model.fastest(),
            },
        }
    }

    /// Advances to the end of a tick, counted from 1.
    pub(crate) fn advance(&mut self, tick: u32) -> Result<(), NoEquilibrium> {
        let moved = Moved {
            node: self.poke.node,
            place: V::from(self.poke.place(tick).map(f64::from)),
        };
        match self.equation {
            Equation::BackwardEuler => self.march.backward_euler(moved),
            Equation::Motion => {
                let now = self.fastest * self.model.steepness(&self.march.displacement).sqrt();
                // Stable are ω dt/2 and more.
                let substeps = (now / f64::from(TICK_HZ)).ceil() as u32;
                self.march.symplectic_euler(moved, substeps.max(SUBSTEPS));
                Ok(())
            }
        }
    }

    /// Displacement from rest [m].
    pub(crate) fn displacement(&self) -> &Field {
        &self.march.displacement
    }

    /// Reaction of the moved node [N].
    pub(crate) fn reaction(&self) -> V {
        self.model
            .reaction(self.poke.node, |node| self.march.displacement.get(node))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::accuracy::case::Case;
    use crate::study::path::Path;
    use crate::study::poke::prepare;
    use sutura_controller::lanes::Level;

    /// Symplectic Euler on this work is of second order in the places at a step's end (it is the leapfrog scheme, but for the damping), so half
    /// of the step takes away three quarters of the error: what halving it moves the force by is nearly all of the reference's own error.
    #[test]
    fn the_time_step_of_the_reference_is_small_enough() {
        for (stiffening, most) in [(false, 1e-5), (true, 1e-3)] {
            let case = Case {
                nodes: [8, 8, 4],
                young_pa: 1e5,
                stiffening,
                path: Path::Drag,
            };
            let (poke, model) = prepare(&case.request(Method::explicit(0), Level::best())).unwrap();
            let mut converged = Converged::new(&poke, &model, Equation::Motion);
            let mut finer = March::new(&model);
            let mut sums = [0.0; 2];
            for tick in 1..=100 {
                converged.advance(tick).unwrap();
                let place = V::from(poke.place(tick).map(f64::from));
                finer.symplectic_euler(Moved { node: poke.node, place }, 2 * SUBSTEPS);
                let force = model.reaction(poke.node, |node| finer.displacement.get(node));
                sums[0] += (converged.reaction() - force).norm_squared();
                sums[1] += force.norm_squared();
            }
            let error = (sums[0] / sums[1]).sqrt();
            assert!(error < most, "{error:e}");
        }
    }
}
