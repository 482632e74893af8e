//! What a survey comes to: the table, and what is chosen from it.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;
use sutura_shared::scene::Solver;

use super::{Auto, Row, choose};

/// Solvers with their prices, and one of them chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// The solvers, family by family.
    pub rows: Vec<Row>,
    /// The chosen one.
    #[serde(serialize_with = "super::as_text")]
    pub solver: Solver,
    /// Its time and its error.
    pub auto: Auto,
}

impl Table {
    /// Chooses from the rows.
    ///
    /// # Errors
    /// Nothing can be chosen: the rows as they came.
    pub fn new(budget_us: u16, rows: Vec<Row>) -> Result<Self, Vec<Row>> {
        let chosen = choose(&rows).and_then(|row| Some((row.solver, Auto::new(budget_us, row)?)));
        match chosen {
            Some((solver, auto)) => Ok(Self { rows, solver, auto }),
            None => Err(rows),
        }
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "solver              median µs     99 % µs   force error %  within {} µs",
            self.auto.budget_us
        )?;
        for row in &self.rows {
            let error = row
                .force_error
                .map_or_else(|| "-".to_owned(), |error| format!("{:.4}", 100.0 * error));
            writeln!(
                f,
                "{:<18}{:>11.1}{:>12.1}{error:>16}  {}",
                row.solver.to_string(),
                row.us_median,
                row.us_p99,
                if row.within { "yes" } else { "no" }
            )?;
        }
        write!(f, "\nsolver {} {}", self.solver, self.auto)
    }
}
