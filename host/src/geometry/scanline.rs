//! Where the rows of a grid, lines along x through cell centres, cross a surface, and in which direction.
//!
//! The sum of the crossings up to a point is the winding number there, 1 inside a closed surface, −1 where it is inside out.
//! Every decision about a triangle is made edge by edge from numbers that depend on the edge alone: which layers of rows lie between its ends,
//! and where it meets a layer. Both triangles of an edge see the same numbers, so each row of a closed surface balances exactly,
//! whatever the rounding and however rows hit edges and corners. The intervals are half-open, so nothing is counted twice.

use super::Vec3;
use super::grid::Grid;

/// A row passing through a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossing {
    /// Row `j + k·ny`.
    pub row: u32,
    /// First cell of the row at or behind the crossing, `nx` if there is none.
    pub cell: u32,
    /// Change of the winding number: 1 on the way in, −1 on the way out.
    pub step: i32,
}

/// Crossings of the rows of a grid, sorted by row and cell.
#[derive(Clone, Debug)]
pub struct Crossings {
    sorted: Vec<Crossing>,
    /// Where each row begins in `sorted`, and the end.
    start: Vec<u32>,
}

impl Crossings {
    /// The crossings of one row, from the first cell to the last.
    #[must_use]
    pub fn row(&self, row: usize) -> &[Crossing] {
        &self.sorted[self.start[row] as usize..self.start[row + 1] as usize]
    }

    /// The rows that cross anything, in order.
    pub fn crossed_rows(&self) -> impl Iterator<Item = usize> {
        self.start
            .windows(2)
            .enumerate()
            .filter(|(_, ends)| ends[0] < ends[1])
            .map(|(row, _)| row)
    }
}

/// All crossings of the rows of `grid` with triangles, counter-clockwise seen from outside.
#[must_use]
pub fn crossings(triangles: impl Iterator<Item = [Vec3; 3]>, grid: &Grid) -> Crossings {
    let mut found = Vec::new();
    for triangle in triangles {
        cross(&triangle, grid, &mut found);
    }
    sort(&found, grid.cells[1] * grid.cells[2])
}

fn cross(corners: &[Vec3; 3], grid: &Grid, found: &mut Vec<Crossing>) {
    let layers = corners.map(|p| grid.centres_below(2, p.z));
    let first = layers[0].min(layers[1]).min(layers[2]);
    let last = layers[0].max(layers[1]).max(layers[2]);
    for layer in first..last {
        // One edge passes the layer upwards and one downwards. Seen from +x with z up, the upward one is the right one where the outside is in front.
        let z = grid.origin.z + (layer as f64 + 0.5) * grid.pitch;
        let (mut up, mut down) = ([0.0; 2], [0.0; 2]);
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            match (layers[from] <= layer, layers[to] <= layer) {
                (true, false) => up = at_height(corners[from], corners[to], z),
                (false, true) => down = at_height(corners[to], corners[from], z),
                _ => {}
            }
        }
        let (up_row, down_row) = (grid.centres_below(1, up[0]), grid.centres_below(1, down[0]));
        let step = if up_row < down_row { 1 } else { -1 };
        for row in up_row.min(down_row)..up_row.max(down_row) {
            let y = grid.origin.y + (row as f64 + 0.5) * grid.pitch;
            let part = ((y - up[0]) / (down[0] - up[0])).clamp(0.0, 1.0);
            let x = up[1] + part * (down[1] - up[1]);
            let cell = grid.centres_below(0, x) as u32;
            found.push(Crossing {
                row: (row + grid.cells[1] * layer) as u32,
                cell,
                step,
            });
        }
    }
}

/// (y, x) of an edge at a height between its ends.
fn at_height(low: Vec3, high: Vec3, z: f64) -> [f64; 2] {
    let part = ((z - low.z) / (high.z - low.z)).clamp(0.0, 1.0);
    [low.y + part * (high.y - low.y), low.x + part * (high.x - low.x)]
}

/// Counting sort by row, then by cell within a row, where crossings are few.
fn sort(found: &[Crossing], rows: usize) -> Crossings {
    let mut start = vec![0_u32; rows + 1];
    for crossing in found {
        start[crossing.row as usize + 1] += 1;
    }
    let mut total = 0;
    for s in &mut start {
        total += *s;
        *s = total;
    }
    let mut place = start.clone();
    let mut sorted = vec![
        Crossing {
            row: 0,
            cell: 0,
            step: 0
        };
        found.len()
    ];
    for crossing in found {
        let slot = &mut place[crossing.row as usize];
        sorted[*slot as usize] = *crossing;
        *slot += 1;
    }
    for ends in start.windows(2) {
        sorted[ends[0] as usize..ends[1] as usize].sort_unstable_by_key(|c| c.cell);
    }
    Crossings { sorted, start }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::tests::cube;
    use super::*;

    /// Rows through the middles, the edges and the corners of a cube at once: every row balances and none is counted twice.
    #[test]
    fn rows_through_edges_and_corners_balance() {
        let cube = cube(Vec3::zeros());
        for shift in [0.0, 0.25, 0.5, 0.1] {
            // With shift 0.5, centres lie at whole numbers: rows run along the cube's edges.
            let grid = Grid {
                origin: Vec3::new(-1.0, -1.0 - shift, -1.0 - shift),
                pitch: 0.5,
                cells: [6, 8, 8],
            };
            let crossings = crossings(cube.corners(), &grid);
            let mut crossed = 0;
            for row in 0..64 {
                let steps: Vec<_> = crossings.row(row).iter().map(|c| c.step).collect();
                assert!(
                    steps.is_empty() || steps == [1, -1],
                    "shift {shift}, row {row}: {steps:?}"
                );
                crossed += steps.len() / 2;
            }
            // The half-open square of side 1 holds 2 × 2 points of spacing 0.5 wherever it lies.
            assert_eq!(crossed, 4, "shift {shift}");
        }
    }

    #[test]
    fn crossings_outside_of_the_grid_keep_the_balance() {
        let cube = cube(Vec3::zeros());
        let grid = Grid {
            origin: Vec3::new(0.2, 0.2, 0.2),
            pitch: 0.1,
            cells: [3, 3, 3],
        };
        let crossings = crossings(cube.corners(), &grid);
        for row in crossings.crossed_rows() {
            let cells: Vec<_> = crossings.row(row).iter().map(|c| (c.cell, c.step)).collect();
            assert_eq!(cells, [(0, 1), (3, -1)]);
        }
        assert_eq!(crossings.crossed_rows().count(), 9);
    }
}
