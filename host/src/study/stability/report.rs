//! What a study of hard cases says at its end: a row for each run.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use super::setting::Setting;

/// The keys of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// By case, solver and law.
    pub rows: Vec<Row>,
}

/// One case under one setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Which case.
    pub case: String,
    /// How the tissue was advanced.
    pub solver: String,
    /// What its springs were.
    pub law: String,
    /// Whether every criterion holds.
    pub passed: bool,
    /// Which criterion fails, or comes nearest to failing, with its number.
    pub why: String,
    /// That number over its bound: above 1 fails. Of a refused setting, the smallest stable count of substeps over the asked one.
    pub worst: f64,
    /// Whether a formula refuses the setting before it runs.
    #[serde(skip)]
    pub refused: bool,
}

impl Report {
    /// Rows that failed under the setting that scenes have where they choose nothing.
    pub fn failed_by_default(&self) -> impl Iterator<Item = &Row> {
        let Setting { solver, springs } = Setting::DEFAULT;
        let (solver, law) = (solver.to_string(), springs.to_string());
        let rows = self.rows.iter().filter(|row| !row.passed);
        rows.filter(move |row| row.solver == solver && row.law == law)
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let count = |what: fn(&Row) -> bool| self.rows.iter().filter(|row| what(row)).count();
        for row in self.rows.iter().filter(|row| !row.passed) {
            let Row {
                case, solver, law, why, ..
            } = row;
            let word = if row.refused { "refused" } else { "failed" };
            writeln!(f, "{word}: {case}, {solver}, {law}: {why}")?;
        }
        let (passed, refused) = (count(|row| row.passed), count(|row| row.refused));
        let failed = self.rows.len() - passed - refused;
        write!(f, "{passed} passed, {failed} failed, {refused} refused")?;
        match self.failed_by_default().count() {
            0 => Ok(()),
            n => write!(f, "; {n} with the default solver and law"),
        }
    }
}
