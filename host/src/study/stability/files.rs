//! The files of a study of hard cases, each written whole or not at all.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::case::Case;
use super::report::{Report, Row};
use super::setting::{SOLVERS, SPRINGS, Setting};
use crate::run::files::{Error, whole};

/// Writes stability.csv, stability.json and stability.md into `out`.
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
    })
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

/// Cases down, solvers across with the default law; then laws across with the default solver.
fn markdown(cases: &[Case], report: &Report) -> String {
    let Setting { solver, springs } = Setting::DEFAULT;
    let (mut text, mut notes) = (String::new(), Vec::new());
    let solvers = names(report, SOLVERS.map(|solver| solver.to_string()), |row| &row.solver);
    let laws = names(report, SPRINGS.map(|springs| springs.to_string()), |row| &row.law);
    let (solver, law) = (solver.to_string(), springs.to_string());
    let pairs = solvers.iter().map(|solver| [solver.as_str(), &law]);
    let _ = writeln!(text, "Law {law}, by solver:\n");
    table(
        &mut text,
        &mut notes,
        (cases, report),
        (&solvers, &pairs.collect::<Vec<_>>()),
    );
    if solvers.contains(&solver) {
        let pairs = laws.iter().map(|law| [&solver, law.as_str()]);
        let _ = writeln!(text, "\nSolver {solver}, by law:\n");
        table(
            &mut text,
            &mut notes,
            (cases, report),
            (&laws, &pairs.collect::<Vec<_>>()),
        );
    }
    text.push('\n');
    for (n, note) in (1..).zip(&notes) {
        let _ = writeln!(text, "{n}. {note}");
    }
    text
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

/// One table; `across` are the columns' heads, and the solver and law of each.
fn table(
    text: &mut String,
    notes: &mut Vec<String>,
    (cases, report): (&[Case], &Report),
    (heads, across): (&[String], &[[&str; 2]]),
) {
    let _ = writeln!(text, "| case | what happens | {} |", heads.join(" | "));
    let _ = writeln!(text, "|---|---|{}", "---|".repeat(heads.len()));
    for case in cases {
        let _ = write!(text, "| {} | {} |", case.name, case.what);
        for [solver, law] in across {
            let found = |row: &&Row| row.case == case.name && row.solver == *solver && row.law == *law;
            let _ = write!(text, " {} |", mark(report.rows.iter().find(found), notes));
        }
        text.push('\n');
    }
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
