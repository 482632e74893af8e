//! The files of a study of effects, each written whole or not at all.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use super::report::{Report, Row, fixed};
use crate::plot::bars::{Panel, bars};
use crate::run::files::{Error, whole};

/// Writes effects.csv, .json, .md, .png and .svg into `out`.
pub(super) fn write(out: &Path, report: &Report) -> Result<(), Error> {
    let texts = [("csv", csv(report)), ("json", json(report)?), ("md", markdown(report))];
    for (kind, text) in texts {
        let path = out.join("effects").with_extension(kind);
        whole(&path, |path| text_file(path, &text).map_err(|cause| fault(path, cause)))?;
    }
    let names: Vec<_> = report.rows.iter().map(name).collect();
    let title = format!("What each effect costs and what it is worth: {}", report.scene);
    for kind in ["png", "svg"] {
        let path = out.join("effects").with_extension(kind);
        whole(&path, |path| {
            bars(path, &title, &names, &panels(report)).map_err(Error::Plot)
        })?;
    }
    Ok(())
}

fn fault(path: &Path, cause: io::Error) -> Error {
    let path = path.to_owned();
    Error::File { path, cause }
}

fn text_file(path: &Path, text: &str) -> io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    file.write_all(text.as_bytes())?;
    file.flush()
}

fn json(report: &Report) -> Result<String, Error> {
    serde_json::to_string_pretty(report).map_err(|cause| fault(Path::new("effects.json"), cause.into()))
}

/// A number of a row.
type Number = fn(&Row) -> Option<f64>;

/// The columns of numbers, by the names that JSON has for them.
const COLUMNS: [(&str, Number); 7] = [
    ("us_with", |row| row.us_with),
    ("us_without", |row| row.us_without),
    ("instructions_with", |row| row.instructions_with),
    ("instructions_without", |row| row.instructions_without),
    ("force_change_rms_n", |row| row.force_change_rms_n),
    ("peak_change_n", |row| row.peak_change_n),
    ("gap_change_mm", |row| row.gap_change_mm),
];

fn csv(report: &Report) -> String {
    let head = COLUMNS.map(|(name, _)| name).join(",");
    let mut text = format!("effect,on,stages,state_bytes,{head},peak_change_stage\n");
    for row in &report.rows {
        let numbers = COLUMNS.map(|(_, of)| of(row).map_or_else(String::new, |value| value.to_string()));
        let _ = writeln!(
            text,
            "{},{},{},{},{},{}",
            row.effect,
            row.on,
            row.stages.join(" "),
            row.state_bytes,
            numbers.join(","),
            row.peak_change_stage.unwrap_or_default()
        );
    }
    text
}

fn markdown(report: &Report) -> String {
    let mut text = format!(
        "# Price and worth of each effect: {}\n\n{}\n\n",
        report.scene,
        report.spans()
    );
    text.push_str(
        "| effect | simulates | works in | bytes | µs a tick with / without | instructions a tick with / without | \
         force moves, RMS | stage's peak moves most | gap moves |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in &report.rows {
        let pair = |values: [Option<f64>; 2], digits: usize| match values {
            [Some(with), Some(without)] => format!("{} / {}", fixed(with, digits), fixed(without, digits)),
            _ => "–".to_owned(),
        };
        let one = |value: Option<f64>, unit: &str, digits: usize| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{} {unit}", fixed(value, digits)))
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} {} | {} |",
            name(row),
            row.why.as_deref().unwrap_or(row.simulates),
            row.stages.join(", "),
            row.state_bytes,
            pair([row.us_with, row.us_without], 1),
            pair([row.instructions_with, row.instructions_without], 0),
            one(row.force_change_rms_n, "N", 4),
            one(row.peak_change_n, "N", 3),
            row.peak_change_stage.unwrap_or_default(),
            one(row.gap_change_mm, "mm", 3),
        );
    }
    text.push_str(
        "\nAn effect is left out together with those that need it. Force is the simulated force on the hand; it moves from tick to tick of the \
         same number, so an event that comes earlier or later counts in full. A peak and a gap are those without the effect less those with it, \
         the gap at the end.\n",
    );
    text
}

/// The effect's name, and what comes or goes with it.
fn name(row: &Row) -> String {
    match (row.on, row.also.is_empty()) {
        (true, true) => row.effect.to_owned(),
        (true, false) => format!("{} (with {})", row.effect, row.also.join(", ")),
        (false, _) => format!("{} (off)", row.effect),
    }
}

/// Price and worth side by side.
fn panels(report: &Report) -> [Panel; 3] {
    let values = |of: Number| report.rows.iter().map(of).collect();
    let price = match report.counted_ticks {
        Some(_) => Panel {
            title: "price: instructions a tick [thousands]",
            values: values(|row| Some(row.instructions()? * 1e-3)),
        },
        None => Panel {
            title: "price: CPU time of a tick [µs]",
            values: values(Row::us),
        },
    };
    [
        price,
        Panel {
            title: "worth: force moves by [N], RMS",
            values: values(|row| row.force_change_rms_n),
        },
        Panel {
            title: "worth: gap moves by [mm]",
            values: values(|row| row.gap_change_mm.map(f64::abs)),
        },
    ]
}
