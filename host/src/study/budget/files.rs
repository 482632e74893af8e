//! The files of a survey, each written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use sutura_shared::scene::Solver;

use super::Table;
use crate::plot::budget::{Picture, png};
use crate::run::files::{Error, folder, whole};

/// Writes budget.csv, budget.json and budget.png into `out`; `title` is the picture's.
///
/// # Errors
/// The file system refuses, or the picture cannot be drawn.
pub fn write(out: &Path, title: &str, table: &Table) -> Result<(), Error> {
    folder(out)?;
    let file = |name: &str, fill: &dyn Fn(&Path) -> io::Result<()>| {
        whole(&out.join(name), |path| {
            fill(path).map_err(|cause| Error::File {
                path: path.to_owned(),
                cause,
            })
        })
    };
    file("budget.csv", &|path| csv(path, table))?;
    file("budget.json", &|path| {
        Ok(serde_json::to_writer(std::fs::File::create(path)?, table)?)
    })?;
    whole(&out.join("budget.png"), |path| {
        png(path, &picture(title, table)).map_err(Error::Plot)
    })
}

fn csv(path: &Path, table: &Table) -> io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "solver,us_median,us_p99,force_error,within")?;
    for row in &table.rows {
        let error = row.force_error.map_or_else(String::new, |error| error.to_string());
        let (solver, median, p99, within) = (row.solver, row.us_median, row.us_p99, row.within);
        writeln!(file, "{solver},{median},{p99},{error},{within}")?;
    }
    file.flush()
}

fn picture(title: &str, table: &Table) -> Picture {
    let mut families: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for row in &table.rows {
        let Some(error) = row.force_error else { continue };
        let (name, at) = (family(row.solver), (row.us_median, 100.0 * error));
        match families.iter_mut().find(|(known, _)| *known == name) {
            Some((_, points)) => points.push(at),
            None => families.push((name, vec![at])),
        }
    }
    let auto = &table.auto;
    Picture {
        title: title.to_owned(),
        families,
        budget_us: auto.budget_us.into(),
        chosen: (table.solver.to_string(), (auto.us_median, 100.0 * auto.force_error)),
    }
}

/// What a legend calls solvers that differ in their count of iterations alone.
fn family(solver: Solver) -> String {
    match solver {
        Solver::Explicit { .. } => "explicit".to_owned(),
        Solver::BePcg { newton: 1, .. } => "be-pcg, 1 Newton step".to_owned(),
        Solver::BePcg { newton, .. } => format!("be-pcg, {newton} Newton steps"),
        Solver::BeChebyshev { .. } => "be-chebyshev".to_owned(),
        Solver::Vbd { .. } => "vbd".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::budget::Row;

    #[test]
    fn a_survey_leaves_a_table_and_a_picture() {
        let row = |solver: &str, us: f64, force_error| Row {
            solver: solver.parse().unwrap(),
            us_median: us,
            us_p99: us,
            force_error,
            within: us <= 500.0,
        };
        let rows = vec![
            row("be-pcg:5:1", 100.0, Some(0.1)),
            row("be-pcg:10:1", 200.0, Some(0.01)),
            row("vbd:2", 700.0, None),
        ];
        let table = Table::new(500, rows).unwrap();
        assert_eq!(picture("", &table).families.len(), 1);
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join("o"), "Error against time", &table).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join("o").join(name)).unwrap();
        assert_eq!(read("budget.csv").lines().nth(3), Some("vbd:2:1.5,700,700,,false"));
        let json: serde_json::Value = serde_json::from_str(&read("budget.json")).unwrap();
        assert_eq!(
            (&json["solver"], &json["rows"][0]["solver"]),
            (&"be-pcg:10:1".into(), &"be-pcg:5:1".into())
        );
        assert!(folder.path().join("o/budget.png").exists());
    }
}
