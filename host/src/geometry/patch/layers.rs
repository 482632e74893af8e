//! Which tissue a cell belongs to, what hangs together, and how deep the soft tissue goes.

use nalgebra::{Isometry3, Point3};

use super::plan::Plan;
use super::{Anatomy, PatchError, layers};
use crate::geometry::Vec3;
use crate::geometry::grid::Grid;
use crate::geometry::voxelize::inside;

/// The tissue of each cell, by the rules of the module above.
pub(super) fn tissues(anatomy: &Anatomy, patch_from_world: &Isometry3<f64>, grid: &Grid) -> Vec<u8> {
    let to_patch = |p: Vec3| (patch_from_world * Point3::from(p)).coords;
    let masks: Vec<_> = anatomy
        .tissues
        .iter()
        .map(|tissue| tissue.mesh.map(|mesh| inside(&mesh.mapped(to_patch), grid).mask))
        .collect();
    let is_in = |tissue: usize, cell: usize| masks[tissue].as_ref().is_some_and(|mask| mask[cell] != 0);
    let all = 0..anatomy.tissues.len();
    let layers = anatomy.shell.map_or(0, |shell| layers(shell.thickness_mm, grid.pitch));
    let shell = anatomy.shell.map(|shell| shell.tissue);
    let mut cells = vec![0; grid.len()];
    let layer = grid.cells[0] * grid.cells[1];
    for column in 0..layer {
        let mut depth = 0;
        for cell in (column..cells.len()).step_by(layer).rev() {
            if !all.clone().any(|tissue| is_in(tissue, cell)) {
                depth = 0;
                continue;
            }
            depth += 1;
            let rigid = all.clone().find(|&t| anatomy.tissues[t].rigid && is_in(t, cell));
            let layered = || shell.filter(|_| depth <= layers);
            let soft = || all.clone().find(|&t| Some(t) != shell && is_in(t, cell));
            cells[cell] = 1 + rigid.or_else(layered).or_else(soft).unwrap_or(anatomy.fill) as u8;
        }
    }
    cells
}

/// Empties cells that no chain of faces links to the largest linked part; says how many.
pub(super) fn drop_loose(cells: &mut [u8], [nx, ny, nz]: [usize; 3]) -> usize {
    let mut part_of = vec![0_usize; cells.len()];
    let mut sizes = vec![0_usize];
    for start in 0..cells.len() {
        if cells[start] == 0 || part_of[start] != 0 {
            continue;
        }
        let part = sizes.len();
        let (mut size, mut open) = (0, vec![start]);
        part_of[start] = part;
        while let Some(cell) = open.pop() {
            size += 1;
            let (i, j, k) = (cell % nx, cell / nx % ny, cell / (nx * ny));
            let steps = [
                (i > 0, -1),
                (i + 1 < nx, 1),
                (j > 0, -(nx as isize)),
                (j + 1 < ny, nx as isize),
            ];
            let layer = (nx * ny) as isize;
            for (exists, step) in steps.into_iter().chain([(k > 0, -layer), (k + 1 < nz, layer)]) {
                let next = cell.wrapping_add_signed(step);
                if exists && cells[next] != 0 && part_of[next] == 0 {
                    part_of[next] = part;
                    open.push(next);
                }
            }
        }
        sizes.push(size);
    }
    let largest = (1..sizes.len()).max_by_key(|&part| sizes[part]).unwrap_or(0);
    let mut dropped = 0;
    for (cell, part) in cells.iter_mut().zip(part_of) {
        if *cell != 0 && part != largest {
            *cell = 0;
            dropped += 1;
        }
    }
    dropped
}

/// The least soft tissue from the top of a column down, over the columns of the wound and one cell around it.
pub(super) fn soft_depth(
    anatomy: &Anatomy,
    (cells, grid): (&[u8], &Grid),
    plan: &Plan,
    needed_mm: f64,
) -> Result<f64, PatchError> {
    let [nx, ny, nz] = grid.cells;
    let (mut least, mut below) = (usize::MAX, String::new());
    for (i, j) in (0..ny)
        .flat_map(|j| (0..nx).map(move |i| (i, j)))
        .filter(|&(i, j)| plan.is_wound([i, j], 1))
    {
        let column = (0..nz)
            .rev()
            .map(|k| cells[grid.index([i, j, k])])
            .skip_while(|&cell| cell == 0);
        let tissue = |cell: u8| usize::from(cell).checked_sub(1).map(|t| &anatomy.tissues[t]);
        let mut depth = 0;
        let mut end = "the end of the patch";
        for cell in column {
            match tissue(cell) {
                Some(tissue) if !tissue.rigid => depth += 1,
                other => {
                    end = other.map_or("air", |tissue| tissue.name);
                    break;
                }
            }
        }
        if depth < least {
            (least, below) = (depth, end.into());
        }
    }
    let found_mm = least.min(nz) as f64 * grid.pitch;
    if found_mm + 1e-9 < needed_mm {
        return Err(PatchError::Shallow {
            found_mm,
            needed_mm,
            below,
        });
    }
    Ok(found_mm)
}
