//! How far every solver is from the truth on one case: the converged solutions are computed once, every solver runs against them.
//!
//! *Solver error*: against the same scheme, converged. *Total error*: against the equation of motion, its time step going to zero. What
//! takes substeps approximates that equation itself, and both are one number.

use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::solver::Solver;

use super::case::{Case, Dial, TICKS};
use crate::study::double::{Field, Model, V};
use crate::study::method::Method;
use crate::study::poke::drive::Poke;
use crate::study::poke::{self, Converged, Distance, Equation};

/// Errors of a solver over a run, each over the root mean square of what is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Root mean square of the force's solver error.
    pub solver: f64,
    /// Root mean square of the force's total error.
    pub total: f64,
    /// Largest solver error of the force.
    pub force_max: f64,
    /// Solver error of the displacement, root mean square over nodes and ticks.
    pub shape: f64,
}

/// What a dial came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// On what.
    pub case: Case,
    /// The setting.
    pub dial: Dial,
    /// The setting as a method with its numbers.
    pub method: Method,
    /// Errors; none where it has diverged.
    pub errors: Option<Errors>,
}

/// Why a run ends before its time.
enum Ended {
    Diverged,
    Told(poke::Error),
}

/// Runs every dial on a case; `go_on` is asked each tick whether to, `done` is told the part of the work that is done.
///
/// # Errors
/// The block, a reference that does not converge, or what `go_on` says.
pub(super) fn measure(
    case: &Case,
    dials: &[Dial],
    level: Level,
    go_on: &impl Fn() -> Result<(), poke::Error>,
    mut done: impl FnMut(f64),
) -> Result<Vec<Measured>, poke::Error> {
    // Of the work, about.
    const REFERENCES: f64 = 0.5;
    let (poke, model) = poke::prepare(&case.request(Method::explicit(0), level))?;
    let step = follow(&poke, &model, Equation::BackwardEuler, go_on)?;
    let motion = follow(&poke, &model, Equation::Motion, go_on)?;
    done(REFERENCES);
    let mut measured = Vec::new();
    for (count, &dial) in (1..).zip(dials) {
        if let Some((method, solver)) = dial.build(&poke.block, level) {
            let scheme = match Equation::of(method) {
                Equation::BackwardEuler => &step,
                Equation::Motion => &motion,
            };
            let run = Run {
                poke: &poke,
                model: &model,
                scheme,
                motion: &motion,
            };
            let errors = match run.errors(&*solver, go_on) {
                Ok(errors) => Some(errors),
                Err(Ended::Diverged) => None,
                Err(Ended::Told(error)) => return Err(error),
            };
            measured.push(Measured {
                case: *case,
                dial,
                method,
                errors,
            });
        }
        done(REFERENCES + (1.0 - REFERENCES) * f64::from(count) / dials.len() as f64);
    }
    Ok(measured)
}

/// A converged solution at the end of every tick.
struct Reference {
    /// Displacement from rest [m].
    displacement: Vec<Field>,
    /// Reaction of the moved node [N].
    force: Vec<V>,
}

/// Computes a converged solution.
fn follow(
    poke: &Poke,
    model: &Model,
    equation: Equation,
    go_on: &impl Fn() -> Result<(), poke::Error>,
) -> Result<Reference, poke::Error> {
    let mut converged = Converged::new(poke, model, equation);
    let mut reference = Reference {
        displacement: Vec::new(),
        force: Vec::new(),
    };
    for tick in 1..=TICKS {
        converged.advance(tick)?;
        reference.displacement.push(converged.displacement().clone());
        reference.force.push(converged.reaction());
        go_on()?;
    }
    Ok(reference)
}

/// What a solver runs against.
struct Run<'a> {
    poke: &'a Poke,
    model: &'a Model,
    /// The same scheme, converged.
    scheme: &'a Reference,
    /// The equation of motion, converged.
    motion: &'a Reference,
}

impl Run<'_> {
    fn errors(
        &self,
        solver: &dyn Solver<PC_NODES>,
        go_on: &impl Fn() -> Result<(), poke::Error>,
    ) -> Result<Errors, Ended> {
        let (mut own, mut total) = (Distance::default(), Distance::default());
        let ticks = self.scheme.force.len() as u32;
        self.poke.run(solver, ticks, |state, _| {
            let force = self.model.reaction(self.poke.node, |node| state.displacement(node));
            if !state.is_finite() || !force.iter().all(|part| part.is_finite()) {
                return Err(Ended::Diverged);
            }
            let tick = state.tick as usize - 1;
            own.add_force(force, self.scheme.force[tick]);
            own.add_shape(state, &self.scheme.displacement[tick]);
            total.add_force(force, self.motion.force[tick]);
            go_on().map_err(Ended::Told)
        })?;
        let (own, total) = (own.errors(), total.errors());
        Ok(Errors {
            solver: own.force_error_rms,
            total: total.force_error_rms,
            force_max: own.force_error_max,
            shape: own.shape_error,
        })
    }
}
