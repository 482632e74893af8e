//! The solver of a run: as the scene names it, counted where it gives no number, or chosen by a clock.

use std::sync::atomic::AtomicBool;

use sutura_controller::lanes::Level;
use sutura_shared::scene::Solver;

use super::Error;
use crate::scene::build::Built;
use crate::scene::draft::{Draft, Key};
use crate::scene::setting::Setting;
use crate::study::block::Block;
use crate::study::budget::scene::{self, Request};
use crate::study::budget::{Auto, Extent};
use crate::study::method::{Method, NEAR, NotBuilt};

/// The solver that a scene's setting comes to, and the record of a clock's choice.
pub(crate) fn settled(
    setting: Setting<Solver>,
    (draft, built): (&Draft, &Built),
    level: Level,
    interrupted: &AtomicBool,
) -> Result<(Solver, Option<Auto>), Error> {
    let fault = |error: &dyn std::error::Error| {
        Error::Scene(draft.fault(Key::Solver, format!("solver = \"{setting}\": {error}")))
    };
    match setting {
        Setting::Fixed(Solver::Explicit { substeps }) => {
            let block = Block::of(&built.scene, &built.cells).map_err(Error::Lattice)?;
            let substeps = counted(substeps, &block, level).map_err(|error| fault(&error))?;
            Ok((Solver::Explicit { substeps }, None))
        }
        Setting::Fixed(solver) => Ok((solver, None)),
        Setting::Auto { budget_us } => {
            let request = Request {
                draft,
                built,
                budget_us,
                level,
                extent: Extent::Choice,
            };
            let table = scene::run(&request, interrupted).map_err(|error| match error {
                scene::Error::Interrupted(_) => Error::Interrupted,
                error => fault(&error),
            })?;
            table.auto.warn();
            Ok((table.solver, Some(table.auto)))
        }
    }
}

/// Explicit substeps: without a number the smallest stable count. Fewer are refused, as the controller does, but with the count that is
/// enough; where they hardly are, there is a warning.
fn counted(asked: u16, block: &Block, level: Level) -> Result<u16, NotBuilt> {
    let (method, _) = Method::explicit(asked).build(block, level)?;
    let (fewest, _) = Method::explicit(0).build(block, level)?;
    let [substeps, least] = [method, fewest].map(|method| method.explicit_substeps().unwrap_or(asked));
    if asked > 0 && f64::from(least) > NEAR * f64::from(asked) {
        tracing::warn!("solver: explicit:{asked} is close to unstable: explicit:{least} is the smallest stable count");
    }
    Ok(substeps)
}
