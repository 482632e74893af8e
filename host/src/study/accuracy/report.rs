//! What the study says at its end: one JSON object, and a text for people.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use super::case::{Case, Dial, RAMP_MS, TICKS, named};
use super::measure::Measured;
use super::statics::Statics;
use super::verdict::{Setting, WANTED, cheapest, settings};

/// One solver on one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Nodes along x, y and z, such as 16x16x8.
    pub nodes: String,
    /// Young's modulus of the first slope [kPa].
    pub young_kpa: f64,
    /// Whether slopes are 1 : 4 : 10.
    pub stiffening: bool,
    /// Way of the moved node.
    pub path: &'static str,
    /// How the tissue was advanced.
    pub solver: String,
    /// Median CPU time of the solver alone [µs a tick].
    pub us_median: f64,
    /// The same over the C kernel's for as many nodes; none without it.
    pub limit_ratio: Option<f64>,
    /// Instructions of the solver alone [a tick]; none where they were not counted.
    pub instructions: Option<u64>,
    /// Force against the same scheme, converged: root mean square of the error over that of the force; none where it has diverged.
    pub solver_error: Option<f64>,
    /// The same against the equation of motion, its time step going to zero.
    pub total_error: Option<f64>,
    /// Largest solver error of the force over the root mean square of the force.
    pub force_error_max: Option<f64>,
    /// Solver error of the displacement, root mean square over nodes and ticks, over that of the displacement.
    pub shape_error: Option<f64>,
    /// Whether it stayed finite.
    pub finite: bool,
    /// The setting that the solver's numbers come from.
    #[serde(skip)]
    pub dial: Dial,
    #[serde(skip)]
    case: Case,
}

impl Row {
    /// Without a price.
    pub(super) fn new(measured: &Measured) -> Self {
        let Measured {
            case,
            dial,
            method,
            errors,
        } = *measured;
        Self {
            nodes: case.lattice(),
            young_kpa: case.young_kpa(),
            stiffening: case.stiffening,
            path: case.path.name(),
            solver: method.to_string(),
            us_median: f64::NAN,
            limit_ratio: None,
            instructions: None,
            solver_error: errors.map(|errors| errors.solver),
            total_error: errors.map(|errors| errors.total),
            force_error_max: errors.map(|errors| errors.force_max),
            shape_error: errors.map(|errors| errors.shape),
            finite: errors.is_some(),
            dial,
            case,
        }
    }
}

/// The verdict on one lattice.
#[derive(Clone, Debug, Serialize)]
pub struct Lattice {
    /// Nodes along x, y and z.
    pub nodes: String,
    /// Median of the C kernel [µs a tick]; none without it.
    pub limit_us: Option<f64>,
    /// The cheapest settings under 1 % and 0.1 %, at their worst over all cases.
    pub sentence: String,
    /// Every setting that stayed finite in all cases, at its worst.
    pub settings: Vec<Setting>,
    /// The cheapest settings for one material.
    #[serde(skip)]
    materials: Vec<[String; 6]>,
}

/// The keys of `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Every solver on every case.
    pub rows: Vec<Row>,
    /// The verdict on every lattice.
    pub lattices: Vec<Lattice>,
    /// Errors of pitch and model, as keys `pitch` and `model`; neither where they were not wanted.
    #[serde(flatten)]
    pub statics: Option<Statics>,
    /// Length of a run [ticks].
    pub ticks: u32,
    /// Time in which a path reaches its full size [ms].
    pub ramp_ms: u32,
    /// What the controller's passes were timed on.
    pub simd: &'static str,
    /// What is missing, one line each.
    pub notes: Vec<String>,
    /// Folder of the files.
    pub out: String,
}

impl Lattice {
    /// From all rows of `nodes`.
    pub(super) fn new(nodes: [u32; 3], limit_us: Option<f64>, rows: &[Row]) -> Self {
        let rows: Vec<_> = rows.iter().filter(|row| [row.case.nodes] == [nodes]).collect();
        let mut cases: Vec<Case> = Vec::new();
        for row in &rows {
            if !cases.contains(&row.case) {
                cases.push(row.case);
            }
        }
        let settings = settings(rows.iter().copied(), cases.len());
        Self {
            nodes: named(nodes),
            limit_us,
            sentence: sentence(&named(nodes), cases.len(), &settings),
            materials: materials(&rows, &cases),
            settings,
        }
    }
}

fn solver_error(setting: &Setting) -> f64 {
    setting.solver_error
}

fn total_error(setting: &Setting) -> f64 {
    setting.total_error
}

/// The cheapest settings by both errors.
fn sentence(nodes: &str, cases: usize, settings: &[Setting]) -> String {
    let name = |error: fn(&Setting) -> f64, wanted| match cheapest(settings, error, wanted) {
        Some(setting) => {
            let times = setting
                .limit_ratio
                .map_or_else(String::new, |ratio| format!(", {ratio:.2} × the C kernel"));
            format!(
                "`{}` ({}{times}, {:.0} µs)",
                setting.setting,
                percent(error(setting)),
                setting.us_median
            )
        }
        None => "none of these".to_owned(),
    };
    let [some, few] = WANTED;
    format!(
        "{nodes}: at its worst over {cases} cases, the cheapest setting with a solver error under 1 % of the force is {}, under 0.1 % {}; \
         with a total error, the time step's own in it, under 1 % {}, under 0.1 % {}.",
        name(solver_error, some),
        name(solver_error, few),
        name(total_error, some),
        name(total_error, few)
    )
}

/// For every stiffness and curve: the cheapest settings under 1 % and 0.1 % by both errors, at their worst over the paths.
fn materials(rows: &[&Row], cases: &[Case]) -> Vec<[String; 6]> {
    let mut lines = Vec::new();
    let mut before: Option<Case> = None;
    for case in cases {
        let same =
            |other: &Case| (other.young_kpa() - case.young_kpa()).abs() <= 0.0 && other.stiffening == case.stiffening;
        if before.as_ref().is_some_and(same) {
            continue;
        }
        before = Some(*case);
        let here = rows.iter().filter(|row| same(&row.case)).copied();
        let settings = settings(here, cases.iter().filter(|other| same(other)).count());
        let name = |error: fn(&Setting) -> f64, wanted| {
            cheapest(&settings, error, wanted).map_or_else(
                || "–".to_owned(),
                |setting| format!("`{}` {:.0} µs", setting.setting, setting.us_median),
            )
        };
        let [some, few] = WANTED;
        let curve = if case.stiffening { "1 : 4 : 10" } else { "linear" };
        lines.push([
            format!("{} kPa", case.young_kpa()),
            curve.to_owned(),
            name(solver_error, some),
            name(solver_error, few),
            name(total_error, some),
            name(total_error, few),
        ]);
    }
    lines
}

/// Two digits of a percentage.
pub(super) fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    let before_point = if percent.abs() > 0.0 {
        percent.abs().log10().floor()
    } else {
        1.0
    };
    let digits = (1.0 - before_point).clamp(0.0, 6.0) as usize;
    format!("{percent:.digits$} %")
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "# What accuracy costs in time\n")?;
        for note in &self.notes {
            writeln!(f, "Missing: {note}.\n")?;
        }
        for lattice in &self.lattices {
            writeln!(f, "- {}", lattice.sentence)?;
        }
        writeln!(f, "\n![Error against time](accuracy.png)")?;
        method(f, self)?;
        self.lattices.iter().try_for_each(|lattice| tables(f, lattice))?;
        self.statics.iter().try_for_each(|statics| write!(f, "{statics}"))
    }
}

/// How it was measured.
fn method(f: &mut Formatter<'_>, report: &Report) -> fmt::Result {
    writeln!(
        f,
        "\n## How it was measured\n\n\
         Every case is the work of `sutura poke`: law isotropic, per voxel, pitch 2 mm, {TICKS} ticks of which the first {RAMP_MS} are the ramp; \
         `sutura poke --nodes N --young-kpa E --path P --solver S --run-ms {TICKS} --reference` repeats a row's solver error. \
         An error is the root mean square over all ticks of the tool force's error, over the root mean square of the force. \
         The solver error is against the same scheme converged in double precision; for explicit and xpbd that is the equation of motion itself. \
         The total error is against the equation of motion by symplectic Euler at a 200th of a tick or finer; its own error is below 0.001 % on \
         linear springs and some hundredths of a percent on stiffening ones, and no error here is known better. \
         A setting stands here at its worst over all stiffnesses, curves and paths; one that diverged in any of them is left out, and is a row \
         with `finite` false in accuracy.csv. `explicit` is the smallest stable count of substeps, at the stiffest the most of them.\n\n\
         Time is the thread's CPU time of the solver alone, its passes on {}: the least of three medians, in turn with the C kernel (five explicit \
         substeps of the bare lattice of as many nodes), of which the least counts too. Stiffness and path change no solver's operations, \
         so each setting is timed and its instructions are counted once for a lattice and a curve, the latter with AVX2 at most.",
        report.simd
    )
}

fn tables(f: &mut Formatter<'_>, lattice: &Lattice) -> fmt::Result {
    let limit = lattice
        .limit_us
        .map_or_else(String::new, |us| format!(" (C kernel: {us:.1} µs)"));
    writeln!(f, "\n## {} nodes{limit}\n", lattice.nodes)?;
    writeln!(f, "Cheapest for one material, at the worst of its paths:\n")?;
    writeln!(
        f,
        "| E | curve | solver error < 1 % | < 0.1 % | total error < 1 % | < 0.1 % |\n|---|---|---|---|---|---|"
    )?;
    for line in &lattice.materials {
        writeln!(f, "| {} |", line.join(" | "))?;
    }
    writeln!(f, "\nEvery setting at its worst:\n")?;
    writeln!(
        f,
        "| setting | µs | × C kernel | instructions | solver error | total error | largest force error | shape error |\n\
         |---|---|---|---|---|---|---|---|"
    )?;
    for setting in &lattice.settings {
        let ratio = setting
            .limit_ratio
            .map_or_else(|| "–".into(), |ratio| format!("{ratio:.2}"));
        let instructions = setting
            .instructions
            .map_or_else(|| "–".into(), |count| count.to_string());
        writeln!(
            f,
            "| `{}` | {:.1} | {ratio} | {instructions} | {} | {} | {} | {} |",
            setting.setting,
            setting.us_median,
            percent(setting.solver_error),
            percent(setting.total_error),
            percent(setting.force_error_max),
            percent(setting.shape_error)
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_have_two_digits() {
        for (part, text) in [
            (0.123_45, "12 %"),
            (0.012_34, "1.2 %"),
            (0.001_234, "0.12 %"),
            (1.2345e-5, "0.0012 %"),
            (1.5, "150 %"),
            (0.0, "0 %"),
        ] {
            assert_eq!(percent(part), text);
        }
    }
}
