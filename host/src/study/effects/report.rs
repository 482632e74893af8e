//! What a study of effects says: one JSON object, or a table for people.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;
use sutura_controller::effects;

use super::course::Course;

/// The keys of `--json` and of effects.json.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// The scene file.
    pub scene: String,
    /// Nodes of the patch's box.
    pub nodes: usize,
    /// How the tissue was advanced.
    pub solver: String,
    /// Ticks of the whole course, over which times are taken and forces compared.
    pub ticks: usize,
    /// Ticks over which instructions were counted, from where the hand's first way through the air ends; none where they were not.
    pub counted_ticks: Option<u32>,
    /// Why they were not.
    pub not_counted: Option<String>,
    /// One for each effect.
    pub rows: Vec<Row>,
    /// Folder of the files.
    pub out: String,
}

/// Price and worth of one effect. What could not be measured is none.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Row {
    /// Its name.
    pub effect: &'static str,
    /// Whether it is on in the scene.
    pub on: bool,
    /// What is simulated.
    pub simulates: &'static str,
    /// Parts of the tick in which it works.
    pub stages: Vec<&'static str>,
    /// What it has to remember, or to hold ready.
    pub state: &'static str,
    /// Memory for that on this patch [bytes].
    pub state_bytes: usize,
    /// Effects that come or go with it.
    pub also: Vec<&'static str>,
    /// Median CPU time of a tick with it [µs].
    pub us_with: Option<f64>,
    /// The same without it [µs].
    pub us_without: Option<f64>,
    /// Mean instructions of a tick with it.
    pub instructions_with: Option<f64>,
    /// The same without it.
    pub instructions_without: Option<f64>,
    /// Root mean square over all ticks of how far the simulated force on the hand moves when it is left out [N].
    pub force_change_rms_n: Option<f64>,
    /// Peak of a stage without it less that with it, of the stage where this is largest; a stage that is not reached has none [N].
    pub peak_change_n: Option<f64>,
    /// That stage.
    pub peak_change_stage: Option<&'static str>,
    /// Width of the wound at the end without it less that with it [mm]; none without a wound.
    pub gap_change_mm: Option<f64>,
    /// Why it could not be added to the scene.
    pub why: Option<String>,
}

/// Instructions of a tick.
pub enum Counted {
    /// Counted.
    Over {
        /// Over so many ticks.
        ticks: u32,
        /// For each scene, the studied one first.
        counts: Vec<f64>,
    },
    /// Not counted, and why.
    Not(String),
}

impl Counted {
    pub(super) const fn ticks(&self) -> Option<u32> {
        match self {
            Self::Over { ticks, .. } => Some(*ticks),
            Self::Not(_) => None,
        }
    }

    pub(super) fn why(&self) -> Option<String> {
        match self {
            Self::Over { .. } => None,
            Self::Not(why) => Some(why.clone()),
        }
    }
}

impl Row {
    pub(super) fn new(row: &effects::Row, on: bool, nodes: usize) -> Self {
        Self {
            effect: row.effect.name(),
            on,
            simulates: row.simulates,
            stages: row.parts.iter().map(|part| part.name()).collect(),
            state: row.state,
            state_bytes: row.bytes_on(nodes),
            ..Self::default()
        }
    }

    /// Takes times and changes from the courses with and without the effect.
    pub(super) fn compare(&mut self, [with, without]: [&Course; 2], wounded: bool) {
        self.us_with = Some(with.median_us());
        self.us_without = Some(without.median_us());
        self.force_change_rms_n = Some(with.force_change_rms_n(without));
        let (stage, change) = with.peak_change_n(without);
        self.peak_change_n = Some(change);
        self.peak_change_stage = Some(stage.name());
        self.gap_change_mm = wounded.then(|| with.gap_change_mm(without));
    }

    /// Takes the instructions of the scenes with and without the effect.
    pub(super) fn count(&mut self, counted: &Counted, [with, without]: [usize; 2]) {
        if let Counted::Over { counts, .. } = counted {
            self.instructions_with = counts.get(with).copied();
            self.instructions_without = counts.get(without).copied();
        }
    }

    /// Instructions that it adds to a tick.
    #[must_use]
    pub fn instructions(&self) -> Option<f64> {
        Some(self.instructions_with? - self.instructions_without?)
    }

    /// CPU time that it adds to a tick [µs].
    #[must_use]
    pub fn us(&self) -> Option<f64> {
        Some(self.us_with? - self.us_without?)
    }
}

impl Report {
    /// What the figures were taken over, in sentences.
    #[must_use]
    pub fn spans(&self) -> String {
        let counted = match (self.counted_ticks, &self.not_counted) {
            (Some(ticks), _) => format!(
                "Instructions are those of a tick, the mean over {ticks} ticks from where the hand's first way through the air ends."
            ),
            (None, Some(why)) => format!("No instructions: {why}."),
            (None, None) => String::new(),
        };
        format!(
            "{} nodes, solver {}. Times (median) and changes are of all {} ticks, every scene in turn. {counted}",
            self.nodes, self.solver, self.ticks
        )
    }
}

/// A number with so many digits after the point; never a negative nothing.
#[must_use]
pub(super) fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(nothing) if nothing.chars().all(|c| matches!(c, '0' | '.')) => nothing.to_owned(),
        _ => text,
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.scene, self.spans())?;
        writeln!(f)?;
        writeln!(
            f,
            "                             a tick with it and without            without it"
        )?;
        writeln!(
            f,
            "effect            bytes       µs       µs  instructions  instructions  force N    peak N                gap mm"
        )?;
        for row in &self.rows {
            if let Some(why) = &row.why {
                writeln!(f, "{:<16}{:>7}  off: {why}", row.effect, row.state_bytes)?;
                continue;
            }
            let cell = |value: Option<f64>, digits| value.map_or_else(|| "-".to_owned(), |v| fixed(v, digits));
            writeln!(
                f,
                "{:<16}{:>7}{:>9}{:>9}{:>14}{:>14}{:>9}{:>10} {:<13}{:>8}{}",
                row.effect,
                row.state_bytes,
                cell(row.us_with, 1),
                cell(row.us_without, 1),
                cell(row.instructions_with, 0),
                cell(row.instructions_without, 0),
                cell(row.force_change_rms_n, 4),
                cell(row.peak_change_n, 4),
                row.peak_change_stage.unwrap_or_default(),
                cell(row.gap_change_mm, 3),
                if row.on { "" } else { "  off in the scene" }
            )?;
        }
        writeln!(f)?;
        writeln!(
            f,
            "force: how far it moves, root mean square; peak: of the stage named, without less with; gap: at the end, without less with"
        )?;
        write!(f, "files: {0}/effects.csv, .json, .md, .png, .svg", self.out)
    }
}
