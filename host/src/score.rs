//! The score card of a run: what an instructor would look at, with published thresholds where there are any.
//!
//! It is made from the files of a run alone, so that whoever has them gets the same numbers. A row that counts gives its points by how far its
//! value misses what is best: weight · half/(half + miss), all of the weight without a miss, half of it at a miss of `half`, none where the
//! run did not come that far. The total is the sum over what it could be, out of 100; several stitches share a row's weight.

mod record;
mod rows;
mod show;
mod table;

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::run::files;
use crate::scene;
pub use table::Threshold;
use table::{Kind, MARKS, Mark, Miss};

/// What the numbers are not.
pub const NOTE: &str = "A training aid: its numbers are not validated for credentialing.";

/// Scores the run in a folder.
///
/// # Errors
/// A file of it is missing, cut off or wrong.
pub fn of(folder: &Path) -> Result<Score, Error> {
    let mut rows = rows::rows(&record::read(folder)?);
    share(&mut rows);
    let sum = |of: fn(&Points) -> f64| rows.iter().filter_map(|row| row.points.as_ref()).map(of).sum::<f64>();
    Ok(Score {
        total: 100.0 * sum(|points| points.got) / sum(|points| points.of),
        note: NOTE,
        rows,
    })
}

/// Writes score.json and score.md into the run's folder.
///
/// # Errors
/// The file system refuses.
pub fn write(folder: &Path, score: &Score) -> Result<(), files::Error> {
    let json = serde_json::to_string_pretty(score).map(|text| text + "\n");
    for (name, text) in [("score.json", json.unwrap_or_default()), ("score.md", score.markdown())] {
        let path = folder.join(name);
        files::whole(&path, |beside| {
            std::fs::write(beside, &text).map_err(|cause| files::Error::File {
                path: path.clone(),
                cause,
            })
        })?;
    }
    Ok(())
}

/// Gives rows their points; rows of several stitches share those of their kind.
fn share(rows: &mut [Row]) {
    let whole = |row: &Row| row.stage.is_none();
    for mark in &MARKS {
        let among = rows
            .iter()
            .filter(|row| whole(row) && row.name == mark.kind.name)
            .count() as f64;
        for row in rows.iter_mut().filter(|row| whole(row) && row.name == mark.kind.name) {
            row.points = Some(Points {
                got: row.part(mark) * mark.weight / among,
                of: mark.weight / among,
            });
        }
    }
}

impl Row {
    fn new(kind: Kind, value: Option<f64>) -> Self {
        Self {
            name: kind.name,
            stitch: None,
            stage: None,
            value,
            unit: kind.unit,
            best: None,
            threshold: kind.threshold,
            meets: kind
                .threshold
                .zip(value)
                .and_then(|(threshold, value)| threshold.met(value)),
            source: kind.source,
            points: None,
        }
    }

    /// The part of its points that a row gets: 1 without a miss, nothing without a value.
    fn part(&self, Mark { half, miss, .. }: &Mark) -> f64 {
        let missed = |value: f64| match *miss {
            Miss::Size => value.abs(),
            Miss::BelowBest => (self.best.unwrap_or(90.0) - value).max(0.0),
            Miss::Outside([least, most]) => (least - value).max(value - most).max(0.0),
        };
        self.value.map_or(0.0, |value| half / (half + missed(value)))
    }
}

/// A score card.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Out of 100; higher is better.
    pub total: f64,
    /// [`NOTE`].
    pub note: &'static str,
    /// One for each number.
    pub rows: Vec<Row>,
}

/// A number of a score card.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What it is.
    pub name: &'static str,
    /// The stitch that it belongs to, if to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stitch: Option<u32>,
    /// The stage that it belongs to, if to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<&'static str>,
    /// The number; none where the run did not come that far.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: &'static str,
    /// The best that this needle could do, where that is not the threshold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best: Option<f64>,
    /// What has been published as good.
    pub threshold: Option<Threshold>,
    /// Whether the value is.
    pub meets: Option<bool>,
    /// Where the threshold is from, or that there is none.
    pub source: &'static str,
    /// What it counts in the total; none for what is only shown.
    pub points: Option<Points>,
}

/// Points of a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Points {
    /// What it got.
    pub got: f64,
    /// What it could have got.
    pub of: f64,
}

/// Why a run has no score; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The copy of its scene.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// A table of it.
    #[error("{}: {what}", path.display())]
    Recording {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The files of the score.
    #[error(transparent)]
    Files(#[from] files::Error),
}
