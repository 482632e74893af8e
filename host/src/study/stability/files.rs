//! The files of a study of hard cases, each written whole or not at all.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::case::Case;
use super::report::{Report, Row};
use super::setting::{SOLVERS, SPRINGS, Setting};
use crate::plot::matrix::{Matrix, Outcome, matrix};
use crate::run::files::{Error, whole};

/// Writes stability.csv, .json, .md, .png and .svg into `out`.
pub(super) fn write(out: &Path, cases: &[Case], report: &Report) -> Result<(), Error> {
    let put = |name: &str, fill: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
        let path = out.join(name);
        whole(&path, |beside| {
            let mut filled = std::fs::File::create(beside).map(BufWriter::new);
            let done = filled
                .as_mut()
                .map_err(|error| io::Error::new(error.kind(), error.to_string()));
            done.and_then(|file| fill(file).and_then(|()| file.flush()))
                .map_err(|cause| Error::File {
                    path: path.clone(),
                    cause,
                })
        })
    };
    put("stability.csv", &|file| csv(file, report))?;
    put("stability.json", &|file| {
        serde_json::to_writer_pretty(&mut *file, report)?;
        writeln!(file)
    })?;
    put("stability.md", &|file| {
        file.write_all(markdown(cases, report).as_bytes())
    })?;
    let table = picture(cases, report);
    for name in ["stability.png", "stability.svg"] {
        whole(&out.join(name), |path| matrix(path, &table).map_err(Error::Plot))?;
    }
    Ok(())
}

fn csv(file: &mut dyn Write, report: &Report) -> io::Result<()> {
    writeln!(file, "case,solver,law,passed,why,worst")?;
    for row in &report.rows {
        let Row {
            case,
            solver,
            law,
            passed,
            why,
            worst,
            ..
        } = row;
        writeln!(file, "{case},{solver},{law},{passed},\"{why}\",{worst}")?;
    }
    Ok(())
}

/// Columns that have the default solver or the default law in common.
struct Group {
    /// What they have in common.
    title: String,
    /// Their heads.
    heads: Vec<String>,
    /// Solver and law of each.
    settings: Vec<[String; 2]>,
}

/// Solvers across with the default law; then laws across with the default solver, or with the only one that was asked for.
fn groups(report: &Report) -> Vec<Group> {
    let Setting { solver, springs } = Setting::DEFAULT;
    let (solver, law) = (solver.to_string(), springs.to_string());
    let solvers = names(report, SOLVERS.map(|solver| solver.to_string()), |row| &row.solver);
    let laws = names(report, SPRINGS.map(|springs| springs.to_string()), |row| &row.law);
    let by_solver = Group {
        title: format!("law {law}, by solver"),
        settings: solvers.iter().map(|solver| [solver.clone(), law.clone()]).collect(),
        heads: solvers,
    };
    let by_law = |solver: &str| Group {
        title: format!("solver {solver}, by law"),
        settings: laws.iter().map(|law| [solver.to_owned(), law.clone()]).collect(),
        heads: laws.clone(),
    };
    match by_solver.heads.as_slice() {
        [only] => vec![by_law(only)],
        _ => {
            let by_law = by_law(&solver);
            vec![by_solver, by_law]
        }
    }
}

fn markdown(cases: &[Case], report: &Report) -> String {
    let (mut text, mut notes) = (String::new(), Vec::new());
    for Group { title, heads, settings } in groups(report) {
        let _ = writeln!(text, "{title}:\n");
        let _ = writeln!(text, "| case | what happens | {} |", heads.join(" | "));
        let _ = writeln!(text, "|---|---|{}", "---|".repeat(heads.len()));
        for case in cases {
            let _ = write!(text, "| {} | {} |", case.name, case.what);
            for setting in &settings {
                let _ = write!(text, " {} |", mark(found(report, case, setting), &mut notes));
            }
            text.push('\n');
        }
        text.push('\n');
    }
    for (n, note) in (1..).zip(&notes) {
        let _ = writeln!(text, "{n}. {note}");
    }
    text
}

/// The row of a case under a setting.
fn found<'a>(report: &'a Report, case: &Case, [solver, law]: &[String; 2]) -> Option<&'a Row> {
    let rows = report.rows.iter();
    rows.into_iter()
        .find(|row| row.case == case.name && row.solver == *solver && row.law == *law)
}

/// The same as a picture.
fn picture(cases: &[Case], report: &Report) -> Matrix {
    let groups = groups(report);
    let outcome = |row: Option<&Row>| match row {
        None => Outcome::Untried,
        Some(row) if row.passed => Outcome::Passed,
        Some(row) if row.refused => Outcome::Refused,
        Some(_) => Outcome::Failed,
    };
    let across = |case: &Case| -> Vec<_> {
        let settings = groups.iter().flat_map(|group| &group.settings);
        settings.map(|setting| outcome(found(report, case, setting))).collect()
    };
    Matrix {
        title: "Hard cases: does the tissue come to rest, without gaining energy on the way?".to_owned(),
        rows: cases.iter().map(|case| (case.name.clone(), across(case))).collect(),
        groups: groups.into_iter().map(|group| (group.title, group.heads)).collect(),
    }
}

/// The names among `order` that the rows have, and then any other.
fn names<const N: usize>(report: &Report, order: [String; N], of: fn(&Row) -> &String) -> Vec<String> {
    let mut names: Vec<_> = order
        .into_iter()
        .filter(|name| report.rows.iter().any(|row| of(row) == name))
        .collect();
    for row in &report.rows {
        if !names.contains(of(row)) {
            names.push(of(row).clone());
        }
    }
    names
}

/// A row's cell; why it fails goes to the notes.
fn mark(row: Option<&Row>, notes: &mut Vec<String>) -> String {
    let Some(row) = row else { return String::new() };
    if row.passed {
        return "✓".to_owned();
    }
    let place = notes.iter().position(|note| *note == row.why);
    let number = place.unwrap_or_else(|| {
        notes.push(row.why.clone());
        notes.len() - 1
    }) + 1;
    format!("{} ({number})", if row.refused { "refused" } else { "✗" })
}
