//! The outer surface of a patch as quads between nodes, for drawing.
//!
//! Normals are means over the quads around a node by their area, from positions as they are now; texture coordinates belong to the shape at rest.

use super::Vec3;
use super::grid::Grid;

/// One face of a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quad {
    /// Corners, counter-clockwise seen from outside, as indices into [`Surface::nodes`].
    pub corners: [u32; 4],
    /// What the voxel's cell holds: 1 + i for tissue i.
    pub cell: u8,
}

/// The faces of soft voxels with no voxel on the other side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Lattice index of each node of the surface, x fastest, (nx + 1)(ny + 1)(nz + 1) in all; ascending.
    pub nodes: Vec<u32>,
    /// Texture coordinates of each node: x and y at rest over the extent of the block, from 0 to 1.
    pub texture: Vec<[f32; 2]>,
    /// Skin, and the faces of the wound.
    pub quads: Vec<Quad>,
    /// Sides and bottom, where the patch was cut out of the body.
    pub cut_quads: Vec<Quad>,
}

/// The faces of a voxel: axis and direction across, and the corners of the face in the unit cube, counter-clockwise seen from outside.
const FACES: [(usize, isize, [[usize; 3]; 4]); 6] = [
    (0, -1, [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]]),
    (0, 1, [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]]),
    (1, -1, [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]),
    (1, 1, [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]]),
    (2, -1, [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]),
    (2, 1, [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]),
];

/// The surface of the voxels of a patch that `is_soft` accepts; `cells` as in [`Patch`](super::patch::Patch), 0 empty.
#[must_use]
pub fn surface(cells: &[u8], grid: &Grid, is_soft: impl Fn(u8) -> bool) -> Surface {
    let [nx, ny, nz] = grid.cells;
    let mut surface = Surface::default();
    for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
        let cell = cells[grid.index([i, j, k])];
        if cell == 0 || !is_soft(cell) {
            continue;
        }
        for (axis, step, corners) in FACES {
            let mut next = [i, j, k];
            next[axis] = next[axis].wrapping_add_signed(step);
            let inside = next[axis] < grid.cells[axis];
            if inside && cells[grid.index(next)] != 0 {
                continue;
            }
            let corners = corners.map(|[a, b, c]| (i + a + (nx + 1) * (j + b + (ny + 1) * (k + c))) as u32);
            // The top of the block is where the skin ends, its other borders are cuts.
            let is_cut = !inside && (axis, step) != (2, 1);
            let quads = if is_cut {
                &mut surface.cut_quads
            } else {
                &mut surface.quads
            };
            quads.push(Quad { corners, cell });
        }
    }
    surface.number_nodes();
    let part = |node: usize, n: usize| (node % (n + 1)) as f32 / n as f32;
    surface.texture = surface
        .nodes
        .iter()
        .map(|&n| [part(n as usize, nx), part(n as usize / (nx + 1), ny)])
        .collect();
    surface
}

impl Surface {
    /// Lists the nodes that quads use, and lets quads refer to the list instead of the lattice.
    fn number_nodes(&mut self) {
        let quads = || self.quads.iter().chain(&self.cut_quads);
        let mut nodes: Vec<_> = quads().flat_map(|quad| quad.corners).collect();
        nodes.sort_unstable();
        nodes.dedup();
        for corner in self
            .quads
            .iter_mut()
            .chain(&mut self.cut_quads)
            .flat_map(|quad| &mut quad.corners)
        {
            // Every corner is in the list, so its place is found.
            *corner = nodes.partition_point(|node| node < corner) as u32;
        }
        self.nodes = nodes;
    }

    /// Unit normals of the nodes by the area of the skin and wound quads around them; `positions` in the order of `nodes`, in any unit.
    ///
    /// Nodes of cut faces alone get their normal from those; a node whose quads cancel gets the zero vector.
    #[must_use]
    pub fn normals(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let sum = |quads: &[Quad]| {
            let mut sums = vec![Vec3::zeros(); positions.len()];
            for quad in quads {
                let [a, b, c, d] = quad.corners.map(|corner| positions[corner as usize]);
                // Half the cross product of the diagonals is the area vector of a quad, bent or not.
                let area = (c - a).cross(&(d - b)) / 2.0;
                quad.corners.iter().for_each(|&corner| sums[corner as usize] += area);
            }
            sums
        };
        let unit = |v: &Vec3| v.try_normalize(0.0);
        let (outer, cut) = (sum(&self.quads), sum(&self.cut_quads));
        outer
            .iter()
            .zip(&cut)
            .map(|(outer, cut)| unit(outer).or_else(|| unit(cut)).unwrap_or_default())
            .collect()
    }

    /// Places of the nodes at rest [mm], in the order of `nodes`.
    #[must_use]
    pub fn at_rest(&self, grid: &Grid) -> Vec<Vec3> {
        let [nx, ny, _] = grid.cells.map(|n| n + 1);
        let place = |node: usize| Vec3::new((node % nx) as f64, (node / nx % ny) as f64, (node / (nx * ny)) as f64);
        self.nodes
            .iter()
            .map(|&node| grid.origin + place(node as usize) * grid.pitch)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice;
    use super::*;

    fn grid(cells: [usize; 3]) -> Grid {
        Grid {
            origin: Vec3::new(-2.0, -1.0, -3.0),
            pitch: 0.5,
            cells,
        }
    }

    #[test]
    fn block_has_its_faces_and_surface_nodes() {
        let grid = grid([4, 3, 2]);
        let surface = surface(&[1; 24], &grid, |_| true);
        assert_eq!(
            (surface.quads.len(), surface.cut_quads.len()),
            (12, 12 + 2 * (4 * 2 + 3 * 2))
        );
        assert_eq!(surface.nodes.len(), lattice::count(&[1; 24], grid.cells).surface_nodes);
        let (first, last) = (surface.texture[0], surface.texture[surface.texture.len() - 1]);
        assert_eq!((first, last), ([0.0, 0.0], [1.0, 1.0]));
    }

    /// The divergence theorem: area vectors of a closed surface sum to zero, and their moments to the volume.
    #[test]
    fn quads_face_outwards_and_enclose_the_voxels() {
        let grid = grid([3, 3, 3]);
        let mut cells = [1; 27];
        cells[13] = 0;
        cells[26] = 0;
        let surface = surface(&cells, &grid, |_| true);
        let at = surface.at_rest(&grid);
        let (mut sum, mut volume) = (Vec3::zeros(), 0.0);
        for quad in surface.quads.iter().chain(&surface.cut_quads) {
            let [a, b, c, d] = quad.corners.map(|corner| at[corner as usize]);
            let area = (c - a).cross(&(d - b)) / 2.0;
            sum += area;
            volume += area.dot(&((a + b + c + d) / 4.0)) / 3.0;
        }
        assert!(sum.norm() < 1e-12);
        assert!((volume - 25.0 * 0.125).abs() < 1e-12);
    }

    #[test]
    fn wound_faces_are_outer_and_bone_has_no_surface() {
        let grid = grid([3, 1, 2]);
        // Bone left of a wound, skin over muscle right of it.
        let cells = [1, 2, 2, 1, 0, 3];
        let surface = surface(&cells, &grid, |cell| cell != 1);
        // The wound's floor, its right face and the top of the skin; sides and bottom are cut, and so are the ends of the wound's neighbours.
        assert_eq!(surface.quads.len(), 3);
        assert!(
            surface
                .quads
                .iter()
                .chain(&surface.cut_quads)
                .all(|quad| quad.cell != 1)
        );
        assert_eq!(surface.cut_quads.len(), 2 + 2 * 3 + 2);
    }

    #[test]
    fn flat_skin_has_upright_normals() {
        let grid = grid([4, 4, 1]);
        let surface = surface(&[1; 16], &grid, |_| true);
        let at = surface.at_rest(&grid);
        for (place, normal) in at.iter().zip(surface.normals(&at)) {
            let top = (place.z - grid.origin.z) > 0.25;
            assert!(!top || (normal - Vec3::z()).norm() < 1e-12, "{place:?} {normal:?}");
        }
    }
}
