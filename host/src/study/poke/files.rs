//! The files of a poke, each written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::Request;
use super::drive::{Poke, State};
use crate::run::files::{Error, whole};
use crate::study::double::V;

/// Writes the files that were asked for.
pub(super) fn write(request: &Request, poke: &Poke, end: &State, forces: &[V]) -> Result<(), Error> {
    if let Some(path) = &request.positions {
        let rest = |node| poke.block.lattice.rest_place(node).map(f64::from);
        let places = poke
            .block
            .lattice
            .nodes()
            .map(|(_, node)| rest(node) + end.displacement(node));
        let lines = places.map(|place| format!("{},{},{}", place.x, place.y, place.z));
        table(path, "x_m,y_m,z_m", lines)?;
    }
    if let Some(path) = &request.forces {
        let lines = (1..)
            .zip(forces)
            .map(|(tick, force): (u32, _)| format!("{tick},{},{},{}", force.x, force.y, force.z));
        table(path, "tick,fx_n,fy_n,fz_n", lines)?;
    }
    Ok(())
}

fn table(path: &Path, header: &str, lines: impl Iterator<Item = String>) -> Result<(), Error> {
    let fill = |beside: &Path| -> io::Result<()> {
        let mut file = BufWriter::new(std::fs::File::create(beside)?);
        writeln!(file, "{header}")?;
        for line in lines {
            writeln!(file, "{line}")?;
        }
        file.flush()
    };
    whole(path, |beside| {
        fill(beside).map_err(|cause| Error::File {
            path: path.to_owned(),
            cause,
        })
    })
}
