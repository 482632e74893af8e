//! The files of a curve, each written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::curve::{Fit, Point};
use crate::plot::curve::stress_strain;
use crate::run::files::{Error, folder, whole};

/// Writes moduli.csv and moduli.png into `out`.
pub(super) fn write(out: &Path, title: &str, fit: &Fit) -> Result<(), Error> {
    folder(out)?;
    whole(&out.join("moduli.csv"), |path| {
        csv(path, fit).map_err(|cause| Error::File {
            path: path.to_owned(),
            cause,
        })
    })?;
    whole(&out.join("moduli.png"), |path| {
        let of = |stress: fn(&Point) -> f64| -> Vec<_> {
            let points = fit.points.iter();
            points.map(|point| (100.0 * point.strain, stress(point))).collect()
        };
        let (asked, measured) = (of(|point| point.asked_kpa), of(|point| point.measured_kpa));
        stress_strain(path, title, &asked, &measured).map_err(Error::Plot)
    })
}

fn csv(path: &Path, fit: &Fit) -> io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "strain,asked_kpa,measured_kpa")?;
    for point in &fit.points {
        writeln!(file, "{},{},{}", point.strain, point.asked_kpa, point.measured_kpa)?;
    }
    file.flush()
}
