//! Nodes and springs of a set of cells, counted.
//!
//! A node is a corner of at least one voxel, an edge spring a distinct voxel edge, and each voxel has four body diagonals.

/// How large a lattice is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LatticeCounts {
    /// Cells that are voxels.
    pub voxels: usize,
    /// Corners of voxels.
    pub nodes: usize,
    /// Corners of voxel faces that have no voxel on the other side.
    pub surface_nodes: usize,
    /// Distinct edges of voxels.
    pub edges: usize,
    /// Four for each voxel.
    pub body_diagonals: usize,
}

/// Counts the lattice of the cells that are not zero; `mask` has `nx·ny·nz` entries, x fastest.
#[must_use]
pub fn count(mask: &[u8], [nx, ny, nz]: [usize; 3]) -> LatticeCounts {
    let mut counts = LatticeCounts::default();
    let empty = vec![0; nx];
    let row = |j: usize, k: usize| {
        // Rows before the first wrap around to a huge index and are empty like those behind the last.
        if j < ny && k < nz {
            &mask[nx * (j + ny * k)..][..nx]
        } else {
            &empty[..]
        }
    };
    // Whether any and all of the cells around each edge along x are voxels, with a margin of one on either side.
    let (mut any, mut all) = (vec![false; nx + 2], vec![false; nx + 2]);
    for k in 0..=nz {
        for j in 0..=ny {
            let (jl, kl) = (j.wrapping_sub(1), k.wrapping_sub(1));
            let (low, before) = (row(jl, kl), row(j, kl));
            let (behind, here) = (row(jl, k), row(j, k));
            for i in 0..nx {
                let cells = [low[i], before[i], behind[i], here[i]].map(|cell| cell != 0);
                any[i + 1] = cells.contains(&true);
                all[i + 1] = !cells.contains(&false);
                // An edge along x belongs to the cells all around it.
                counts.edges += usize::from(any[i + 1]);
                counts.voxels += usize::from(cells[3]);
            }
            for i in 0..=nx {
                let node = any[i] | any[i + 1];
                counts.nodes += usize::from(node);
                // The eight cells around a node are linked by faces: if they differ, some face between voxel and no voxel has the node as corner.
                counts.surface_nodes += usize::from(node && !(all[i] && all[i + 1]));
            }
            counts.edges += edges_between(behind, here) + edges_between(before, here);
        }
    }
    counts.body_diagonals = 4 * counts.voxels;
    counts
}

/// Edges across the rows, along z for rows side by side and along y for rows on top of each other: one at each end of a voxel in either row.
fn edges_between(one: &[u8], other: &[u8]) -> usize {
    let mut last = false;
    let mut edges = 0;
    for (a, b) in one.iter().zip(other) {
        let voxel = (*a | *b) != 0;
        edges += usize::from(voxel || last);
        last = voxel;
    }
    edges + usize::from(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_blocks_meet_the_closed_form() {
        for [nx, ny, nz] in [[1_usize, 1, 1], [4, 6, 3], [2, 1, 5]] {
            let (x, y, z) = (nx + 1, ny + 1, nz + 1);
            let inner = x.saturating_sub(2) * y.saturating_sub(2) * z.saturating_sub(2);
            let expected = LatticeCounts {
                voxels: nx * ny * nz,
                nodes: x * y * z,
                surface_nodes: x * y * z - inner,
                edges: nx * y * z + x * ny * z + x * y * nz,
                body_diagonals: 4 * nx * ny * nz,
            };
            assert_eq!(
                count(&vec![1; nx * ny * nz], [nx, ny, nz]),
                expected,
                "{nx} × {ny} × {nz}"
            );
        }
    }

    #[test]
    fn voxels_that_share_only_an_edge_or_a_corner_share_its_nodes() {
        // Two cubes of 8 nodes and 12 edges share 2 nodes and 1 edge, or 1 node.
        let along_edge = count(&[1, 0, 0, 1], [2, 2, 1]);
        assert_eq!(
            (along_edge.nodes, along_edge.edges, along_edge.surface_nodes),
            (14, 23, 14)
        );
        let at_corner = count(&[1, 0, 0, 0, 0, 0, 0, 1], [2, 2, 2]);
        assert_eq!(
            (at_corner.nodes, at_corner.edges, at_corner.surface_nodes),
            (15, 24, 15)
        );
    }
}
