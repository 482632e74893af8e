//! What a poke says at its end: one JSON object, or a few lines for people.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use super::errors::Errors;
use crate::run::report::TickTime;
use crate::study::budget::Auto;

/// The keys of `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Mass points.
    pub nodes: usize,
    /// Distinct springs.
    pub springs: usize,
    /// How the tissue was advanced.
    pub solver: String,
    /// What it was chosen by, where a clock chose it; its time is that of the solve alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub auto: Option<Auto>,
    /// Whether everything stayed finite.
    pub finite: bool,
    /// Magnitude of the reaction at the end [N].
    pub force_n: f64,
    /// CPU time of the solve alone [µs].
    pub us_per_tick: TickTime,
    /// The median over springs and substeps [ns]; explicit solvers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ns_per_spring_substep: Option<f64>,
    /// Distance from the converged solution, where it was asked for.
    #[serde(flatten)]
    pub errors: Option<Errors>,
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            nodes, springs, solver, ..
        } = self;
        writeln!(f, "{nodes} nodes, {springs} springs; solver {solver}")?;
        if let Some(auto) = &self.auto {
            writeln!(f, "the solver was chosen {auto}")?;
        }
        if self.finite {
            writeln!(f, "reaction at the end: {:.6} N", self.force_n)?;
        } else {
            writeln!(f, "the solver has diverged")?;
        }
        let TickTime { median, p99, max } = self.us_per_tick;
        write!(
            f,
            "a tick took {median:.1} µs (median), {p99:.1} µs (99 %), {max:.1} µs (most)"
        )?;
        if let Some(ns) = self.ns_per_spring_substep {
            write!(f, "; {ns:.2} ns a spring and substep")?;
        }
        if let Some(errors) = self.errors {
            write!(
                f,
                "\nagainst the converged solution: force {:.3} % (rms), {:.3} % (most); shape {:.3} %",
                100.0 * errors.force_error_rms,
                100.0 * errors.force_error_max,
                100.0 * errors.shape_error
            )?;
        }
        Ok(())
    }
}
