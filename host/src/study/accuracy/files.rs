//! The files of the study, each written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::report::{Lattice, Report, Row};
use super::verdict::front;
use crate::plot::{
    self,
    accuracy::{self as draw, Panel, Picture, Point},
    pitch::{self, Curve},
};
use crate::run::files::{Error, whole};

/// Writes accuracy.csv, .json, .md, .png and .svg into `out`, and pitch.png and .svg.
pub(super) fn write(out: &Path, report: &Report) -> Result<(), Error> {
    let file = |name: &str, fill: &dyn Fn(&Path) -> io::Result<()>| {
        whole(&out.join(name), |path| {
            fill(path).map_err(|cause| Error::File {
                path: path.to_owned(),
                cause,
            })
        })
    };
    file("accuracy.csv", &|path| csv(path, &report.rows))?;
    file("accuracy.json", &|path| {
        Ok(serde_json::to_writer(std::fs::File::create(path)?, report)?)
    })?;
    file("accuracy.md", &|path| std::fs::write(path, report.to_string()))?;
    let picture = picture(report);
    let drawn = |name: &str, into: fn(&Path, &Picture) -> Result<(), plot::Error>| {
        whole(&out.join(name), |path| into(path, &picture).map_err(Error::Plot))
    };
    drawn("accuracy.png", draw::png)?;
    drawn("accuracy.svg", draw::svg)?;
    let Some(statics) = &report.statics else {
        return Ok(());
    };
    let curves = statics.curves();
    let drawn = |name: &str, into: fn(&Path, &[Curve]) -> Result<(), plot::Error>| {
        whole(&out.join(name), |path| into(path, &curves).map_err(Error::Plot))
    };
    drawn("pitch.png", pitch::png)?;
    drawn("pitch.svg", pitch::svg)
}

fn csv(path: &Path, rows: &[Row]) -> io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    writeln!(
        file,
        "nodes,young_kpa,stiffening,path,solver,us_median,limit_ratio,instructions,solver_error,total_error,force_error_max,shape_error,finite"
    )?;
    for row in rows {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        writeln!(
            file,
            "{},{},{},{},{},{},{},{},{},{},{},{},{}",
            row.nodes,
            row.young_kpa,
            row.stiffening,
            row.path,
            row.solver,
            row.us_median,
            number(row.limit_ratio),
            row.instructions.map_or_else(String::new, |count| count.to_string()),
            number(row.solver_error),
            number(row.total_error),
            number(row.force_error_max),
            number(row.shape_error),
            row.finite
        )?;
    }
    file.flush()
}

/// Total error over price, one panel for each lattice.
fn picture(report: &Report) -> Picture {
    let ratio = report.lattices.iter().all(|lattice| lattice.limit_us.is_some());
    let price = |us: f64, over: Option<f64>| if ratio { over.unwrap_or(us) } else { us };
    let panel = |lattice: &Lattice| {
        let rows = report.rows.iter().filter(|row| row.nodes == lattice.nodes);
        let dots = rows.filter_map(|row| {
            let at = (price(row.us_median, row.limit_ratio), 100.0 * row.total_error?);
            Some((row.dial.solver(), at))
        });
        let points: Vec<_> = lattice
            .settings
            .iter()
            .map(|setting| Point {
                solver: setting.solver,
                name: setting.setting.clone(),
                at: (
                    price(setting.us_median, setting.limit_ratio),
                    100.0 * setting.total_error,
                ),
            })
            .collect();
        let at: Vec<_> = points.iter().map(|point| point.at).collect();
        Panel {
            title: match lattice.limit_us {
                Some(us) => format!("{} nodes, C kernel {us:.0} µs", lattice.nodes),
                None => format!("{} nodes", lattice.nodes),
            },
            dots: dots.collect(),
            front: front(&at),
            points,
        }
    };
    Picture {
        title: "Force error of a solver against the time of its tick".into(),
        price: if ratio {
            "CPU time of a tick over the C kernel's"
        } else {
            "CPU time of a tick [µs]"
        },
        panels: report.lattices.iter().map(panel).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::{Case, Dial};
    use super::super::measure::{Errors, Measured};
    use super::*;
    use crate::study::path;

    /// The keys of the rows, as scripts read them.
    const KEYS: [&str; 13] = [
        "nodes",
        "young_kpa",
        "stiffening",
        "path",
        "solver",
        "us_median",
        "limit_ratio",
        "instructions",
        "solver_error",
        "total_error",
        "force_error_max",
        "shape_error",
        "finite",
    ];

    fn report() -> Report {
        let nodes = [8, 8, 4];
        let rows = ["be-pcg:5:1", "xpbd:10"].map(|solver| {
            let method = solver.parse().unwrap();
            let finite = solver != "xpbd:10";
            let mut row = Row::new(&Measured {
                case: Case {
                    nodes,
                    young_pa: 1e5,
                    stiffening: true,
                    path: path::Path::Drag,
                },
                dial: Dial::Method(method),
                method,
                errors: finite.then_some(Errors {
                    solver: 0.005,
                    total: 0.02,
                    force_max: 0.05,
                    shape: 0.03,
                }),
            });
            row.us_median = 12.0;
            row
        });
        Report {
            statics: None,
            lattices: vec![Lattice::new(nodes, None, &rows)],
            rows: rows.to_vec(),
            ticks: 200,
            ramp_ms: 100,
            simd: "avx2",
            notes: vec!["the C kernel is not there".into()],
            out: String::new(),
        }
    }

    #[test]
    fn rows_have_their_keys_and_what_is_unknown_is_null() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &report()).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        let json: serde_json::Value = serde_json::from_str(&read("accuracy.json")).unwrap();
        let rows = json["rows"].as_array().unwrap();
        for row in rows {
            let row = row.as_object().unwrap();
            assert!(KEYS.iter().all(|key| row.contains_key(*key)) && row.len() == KEYS.len());
            assert!(row["limit_ratio"].is_null() && row["instructions"].is_null());
        }
        assert_eq!(
            (&rows[0]["nodes"], &rows[0]["young_kpa"]),
            (&"8x8x4".into(), &100.0.into())
        );
        assert_eq!((&rows[0]["finite"], &rows[1]["finite"]), (&true.into(), &false.into()));
        assert!(rows[1]["solver_error"].is_null() && rows[1]["total_error"].is_null());
        let csv = read("accuracy.csv");
        assert_eq!(csv.lines().next().unwrap().split(',').collect::<Vec<_>>(), KEYS);
        assert_eq!(csv.lines().nth(2), Some("8x8x4,100,true,drag,xpbd:10,12,,,,,,,false"));
        let text = read("accuracy.md");
        assert!(
            text.contains("under 1 % of the force is `be-pcg:5:1`") && text.contains("under 0.1 % none"),
            "{text}"
        );
        assert!(text.contains("the C kernel is not there"), "{text}");
        for name in ["accuracy.png", "accuracy.svg"] {
            assert!(folder.path().join(name).metadata().unwrap().len() > 1000);
        }
    }
}
