//! Which cells of a grid are inside a surface.
//!
//! Rows are filled between their signed crossings ([`scanline`](super::scanline)), which is exact for closed surfaces; inside is where the winding number is not
//! zero, so that inverted surfaces, overlaps and parts within parts are solid. A row whose crossings do not balance, or that enters and leaves through holes,
//! is filled cell by cell where the generalized winding number exceeds one half ([`winding`](super::winding)), so that holes neither leak nor close.

use super::grid::Grid;
use super::mesh::Mesh;
use super::scanline::{Crossing, Crossings, crossings};
use super::winding::Caps;

/// Cells inside a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inside {
    /// For each cell, x fastest: 1 inside, 0 outside.
    pub mask: Vec<u8>,
    /// Rows whose signed crossings do not sum to zero.
    pub unbalanced_rows: usize,
}

/// A surface with more open edges than this, and more than this part of its triangles, is in shreds: its open edges are seams, not holes.
///
/// Rows through holes are worth a winding number for each of their cells; where every triangle is loose, all rows pass "holes".
const SHREDS: (usize, f64) = (1000, 0.5);

/// The cells of `grid` inside a surface.
#[must_use]
pub fn inside(mesh: &Mesh, grid: &Grid) -> Inside {
    let surface = crossings(mesh.corners(), grid);
    let mut mask = vec![0; grid.len()];
    let caps = Caps::of(mesh);
    let closing = crossings(caps.triangles(), grid);
    let shreds = caps.edges() > SHREDS.0.max((SHREDS.1 * mesh.triangles.len() as f64) as usize);
    let mut unbalanced_rows = 0;
    for (row, cells) in mask.chunks_exact_mut(grid.cells[0]).enumerate() {
        let steps = surface.row(row);
        let balanced = steps.iter().map(|c| c.step).sum::<i32>() == 0;
        unbalanced_rows += usize::from(!balanced);
        if balanced && (shreds || closing.row(row).is_empty()) {
            fill(steps, cells);
        } else {
            fill_by_winding(row, [&surface, &closing], (&caps, grid), cells);
        }
    }
    Inside { mask, unbalanced_rows }
}

/// The cells of `grid` between signed crossings, holes or not: what [`inside`] costs without looking for holes.
#[must_use]
pub fn between_crossings(mesh: &Mesh, grid: &Grid) -> Vec<u8> {
    let surface = crossings(mesh.corners(), grid);
    let mut mask = vec![0; grid.len()];
    for (row, cells) in mask.chunks_exact_mut(grid.cells[0]).enumerate() {
        fill(surface.row(row), cells);
    }
    mask
}

fn fill(steps: &[Crossing], cells: &mut [u8]) {
    let mut winding = 0;
    for (crossing, next) in steps.iter().zip(steps.iter().skip(1)) {
        winding += crossing.step;
        if winding != 0 {
            cells[crossing.cell as usize..next.cell as usize].fill(1);
        }
    }
}

fn fill_by_winding(row: usize, chains: [&Crossings; 2], (caps, grid): (&Caps, &Grid), cells: &mut [u8]) {
    let [mut surface, mut closing] = chains.map(|chain| chain.row(row).iter().peekable());
    let (j, k) = (row % grid.cells[1], row / grid.cells[1]);
    let (mut closed, mut answer, mut holds_to) = (0, false, f64::NEG_INFINITY);
    for (i, cell) in cells.iter_mut().enumerate() {
        let centre = grid.centre([i, j, k]);
        for chain in [&mut surface, &mut closing] {
            while let Some(crossing) = chain.next_if(|c| c.cell as usize <= i) {
                closed += crossing.step;
                holds_to = f64::NEG_INFINITY;
            }
        }
        if centre.x >= holds_to {
            let (inside, reach) = caps.inside(closed, centre);
            (answer, holds_to) = (inside, centre.x + reach);
        }
        *cell = u8::from(answer);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Vec3;
    use super::super::mesh::tests::cube;
    use super::super::winding::tests::direct;
    use super::*;

    fn grid() -> Grid {
        Grid {
            origin: Vec3::new(-0.51, -0.53, -0.52),
            pitch: 0.101,
            cells: [20, 20, 20],
        }
    }

    fn voxels(mask: &[u8]) -> usize {
        mask.iter().map(|&cell| usize::from(cell)).sum()
    }

    /// Each hole is compared with the definition of the winding number, wherever rows pass it.
    #[test]
    fn rows_through_holes_agree_with_the_winding_number() {
        let grid = grid();
        for hole in [0..1, 2..4, 8..9, 8..10, 8..12, 3..9] {
            let mut open = cube(Vec3::zeros());
            open.triangles.drain(hole.clone());
            let filled = inside(&open, &grid);
            let (surface, caps) = (
                crossings(open.corners(), &grid),
                crossings(Caps::of(&open).triangles(), &grid),
            );
            for row in (0..400).filter(|&row| !caps.row(row).is_empty() || surface.row(row).len() % 2 == 1) {
                for i in 0..20 {
                    let cell = [i, row % 20, row / 20];
                    let expected = u8::from(direct(&open, grid.centre(cell)).abs() > 0.5);
                    assert_eq!(filled.mask[grid.index(cell)], expected, "hole {hole:?}, cell {cell:?}");
                }
            }
        }
    }

    /// Rows along a tube cross no surface, but its ends are holes.
    #[test]
    fn a_tube_along_the_rows_is_filled() {
        let mut tube = cube(Vec3::zeros());
        let whole = voxels(&inside(&tube, &grid()).mask);
        tube.triangles.truncate(8);
        let filled = inside(&tube, &grid());
        assert_eq!(filled.unbalanced_rows, 0);
        assert!(
            voxels(&filled.mask) * 10 > whole * 7,
            "{} of {whole}",
            voxels(&filled.mask)
        );
        assert_eq!(voxels(&between_crossings(&tube, &grid())), 0);
    }

    #[test]
    fn inverted_nested_and_overlapping_surfaces_are_solid() {
        let grid = grid();
        let cube = cube(Vec3::zeros());
        let whole = inside(&cube, &grid).mask;
        let mut inverted = cube.clone();
        inverted.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        assert_eq!(inside(&inverted, &grid).mask, whole);
        let small = cube.mapped(|p| p * 0.5 + Vec3::repeat(0.25));
        let corners: Vec<_> = cube.corners().chain(small.corners()).collect();
        assert_eq!(inside(&Mesh::from_corners(&corners).0, &grid).mask, whole);
        // Turned inside out, the small cube is a cavity.
        let cavity: Vec<_> = cube
            .corners()
            .chain(small.corners().map(|[a, b, c]| [a, c, b]))
            .collect();
        let hollow = voxels(&inside(&Mesh::from_corners(&cavity).0, &grid).mask);
        assert_eq!(hollow, voxels(&whole) - voxels(&inside(&small, &grid).mask));
    }

    #[test]
    fn a_mesh_larger_than_the_grid_fills_it() {
        let large = cube(Vec3::zeros()).mapped(|p| (p - Vec3::repeat(0.5)) * 10.0);
        let filled = inside(&large, &grid());
        assert_eq!((voxels(&filled.mask), filled.unbalanced_rows), (8000, 0));
    }
}
