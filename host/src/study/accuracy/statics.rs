//! Errors that no solver can mend: of the discretisation and of the model, from bodies at rest.

use std::fmt::{self, Display, Formatter};
use std::thread;

use serde::Serialize;

use super::{model, pitch};
use crate::plot::pitch::Curve;
use crate::study::poke;

/// How much of it is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Without the finest pitches and meshes.
    Quick,
    /// All.
    Whole,
}

/// Both.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statics {
    /// What the pitch costs.
    pub pitch: Vec<pitch::Row>,
    /// What law and assembly cost.
    pub model: Vec<model::Row>,
}

/// What a quick study leaves out.
pub(super) const LEFT_OUT: &str =
    "pitches of 1.5 and 1 mm, elements of 0.5 mm and the laws' errors without a pitch: the whole study solves them";

/// Solves; `go_on` may end it between two solves, `progress` is told how much is done, from 0 to 1.
///
/// # Errors
/// That of `go_on`, or a body that does not come to rest: a defect of ours.
pub(super) fn run(
    extent: Extent,
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    progress: &(impl Fn(f64) + Sync),
) -> Result<Statics, poke::Error> {
    // One takes about as long as a third of the other.
    Ok(Statics {
        pitch: pitch::run(extent, go_on, &|part| progress(0.25 * part))?,
        model: model::run(extent, go_on, &|part| progress(0.25 + 0.75 * part))?,
    })
}

/// Threads that solve.
pub(super) fn workers() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

impl Statics {
    /// Error over pitch, by case.
    pub(super) fn curves(&self) -> Vec<Curve> {
        let curve = |(case, name): (&str, &str)| {
            let rows: Vec<_> = self.pitch.iter().filter(|row| row.case == case).collect();
            let order = rows.first().map_or(f64::NAN, |row| row.order);
            Curve {
                name: format!("{name}: order {order:.1}"),
                points: rows.iter().map(|row| (row.pitch_mm, 100.0 * row.path_error)).collect(),
            }
        };
        pitch::CASES.into_iter().map(curve).collect()
    }
}

/// Two sections of a report.
impl Display for Statics {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.pitch_section(f)?;
        self.model_section(f)
    }
}

impl Statics {
    fn pitch_section(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\n## What the pitch costs\n\n\
             The lattice at rest and small strain, law isotropic, per voxel, in double precision: error of the force on the way of the tool. \
             The sphere and the punch push a half-space in by 2 mm in contacts of 12 mm radius, the cantilever is 12 mm thick: 3 to 12 voxels \
             in each. The punch takes the nodes within its radius, and is held against the circle of their area, a² each; its nominal radius has \
             the staircase of the rim in its error. The sphere's nodes are those that push.\n\n\
             ![Error of the force over the pitch](pitch.png)\n"
        )?;
        let names = pitch::CASES.map(|(_, name)| name);
        writeln!(f, "| pitch | {} |\n|---|---|---|---|---|", names.join(" | "))?;
        let cases = pitch::CASES.map(|(case, _)| self.pitch.iter().filter(move |row| row.case == case));
        let [first, ..] = &cases;
        for (at, row) in first.clone().enumerate() {
            write!(f, "| {} mm |", row.pitch_mm)?;
            for case in &cases {
                let error = case.clone().nth(at).map_or(f64::NAN, |row| row.path_error);
                write!(f, " {:.2} % |", 100.0 * error)?;
            }
            writeln!(f)?;
        }
        write!(f, "| order |")?;
        for mut case in cases {
            write!(f, " {:.2} |", case.next().map_or(f64::NAN, |row| row.order))?;
        }
        writeln!(f)
    }

    fn model_section(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\n## What law and assembly cost\n\n\
             A block of 12 × 12 × 6 voxels of 2 mm, bottom held, 5 × 5 nodes of its top pressed or dragged by 0.5 mm, against trilinear finite \
             elements with B̄ of the same E and ν, converged. *Law alone* is what is left of the force's error without a pitch. Elements on the \
             lattice's own nodes show what any model pays for the pitch. Laws `axial` and `paper` state no ν and are held against 0.25. \
             The last columns hold the force against tissue that keeps its volume, ν = 0.49.\n\n\
             | law | ν | assembly | press: force | law alone | shape | drag: force | law alone | shape | press at ν = 0.49 | drag at ν = 0.49 |\n\
             |---|---|---|---|---|---|---|---|---|---|---|"
        )?;
        let under = |load| self.model.iter().filter(move |row| row.load == load);
        let pairs = || under("press").zip(under("drag"));
        let mut before = 0.0;
        for (press, drag) in pairs().filter(|(press, _)| tighter(&mut before, press.poisson)) {
            let elements = |row: &model::Row| cells(row.elements_force_error, None, row.elements_shape_error);
            let (poisson, press, drag) = (press.poisson, elements(press), elements(drag));
            writeln!(f, "| *elements* | {poisson} | | {press} | {drag} | – | – |")?;
        }
        for (press, drag) in pairs() {
            let [own, other] = [press, drag].map(|row| cells(row.force_error, row.law_error, row.shape_error));
            let [tissue, dragged] = [press, drag].map(|row| signed(row.tissue_error));
            let model::Row {
                law, poisson, assembly, ..
            } = press;
            writeln!(
                f,
                "| `{law}` | {poisson} | {assembly} | {own} | {other} | {tissue} | {dragged} |"
            )?;
        }
        Ok(())
    }
}

/// Whether ν is above all before it.
fn tighter(before: &mut f64, poisson: f64) -> bool {
    let above = poisson > *before;
    *before = before.max(poisson);
    above
}

/// Cells of a table: errors of force, of the law alone, and of the shape.
fn cells(force: f64, law: Option<f64>, shape: f64) -> String {
    let law = law.map_or_else(|| "–".to_owned(), signed);
    format!("{} | {law} | {:.1} %", signed(force), 100.0 * shape)
}

fn signed(part: f64) -> String {
    format!("{:+.1} %", 100.0 * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statics() -> Statics {
        let pitch = |(case, _): (&'static str, &str), pitch_mm| pitch::Row {
            case,
            pitch_mm,
            nodes: 8,
            measured: 0.9,
            expected: 1.0,
            unit: "N",
            error: -0.1,
            path_error: 0.1,
            order: 1.0,
        };
        let model = |poisson, load| model::Row {
            law: "volume",
            poisson,
            assembly: "per-voxel",
            load,
            force_n: 1.1,
            fem_n: 1.0,
            force_error: 0.1,
            shape_error: 0.2,
            elements_force_error: 0.05,
            elements_shape_error: 0.06,
            fem_left: 0.01,
            law_error: (load == "drag").then_some(-0.01),
            tissue_error: 0.3,
        };
        let cases = pitch::CASES.iter();
        Statics {
            pitch: cases.flat_map(|case| [4.0, 2.0].map(|mm| pitch(*case, mm))).collect(),
            model: [0.25, 0.45, 0.45]
                .into_iter()
                .flat_map(|poisson| ["press", "drag"].map(|load| model(poisson, load)))
                .collect(),
        }
    }

    /// One line for each pitch and the order; one for each ν of the elements, and for each pair of loads.
    #[test]
    fn tables_have_a_line_for_each_setting_and_no_cell_too_few() {
        let text = statics().to_string();
        let lines = |columns: usize| {
            let cells = |line: &&str| line.starts_with('|') && line.matches('|').count() == columns + 1;
            text.lines().filter(cells).count()
        };
        let table = text.lines().filter(|line| line.starts_with('|')).count();
        assert_eq!([lines(5), lines(11)], [2 + 2 + 1, 2 + 2 + 3]);
        assert_eq!(table, lines(5) + lines(11));
        assert!(text.contains(
            "| `volume` | 0.45 | per-voxel | +10.0 % | – | 20.0 % | +10.0 % | -1.0 % | 20.0 % | +30.0 % | +30.0 % |"
        ));
    }

    #[test]
    fn curves_are_the_cases_over_the_pitch() {
        let curves = statics().curves();
        assert_eq!(curves.len(), pitch::CASES.len());
        for curve in curves {
            assert!(curve.name.ends_with(": order 1.0"), "{}", curve.name);
            assert_eq!(curve.points, [(4.0, 10.0), (2.0, 10.0)]);
        }
    }

    #[test]
    fn rows_stand_under_their_keys() {
        let json = serde_json::to_value(statics()).unwrap();
        let keys = |of: &str| -> Vec<String> { json[of][0].as_object().unwrap().keys().cloned().collect() };
        let has = |of, wanted: &[&str]| wanted.iter().all(|key| keys(of).contains(&(*key).to_owned()));
        assert!(has(
            "pitch",
            &[
                "case", "pitch_mm", "nodes", "measured", "expected", "unit", "error", "order"
            ]
        ));
        let model = [
            "law",
            "poisson",
            "assembly",
            "load",
            "force_n",
            "fem_n",
            "force_error",
            "shape_error",
        ];
        assert!(has("model", &model) && json["model"][0]["law_error"].is_null());
    }
}
