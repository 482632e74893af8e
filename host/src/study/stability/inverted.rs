//! Voxels that are inside out somewhere.

use sutura_controller::lattice::{Lattice, Tissue};

/// Counts voxels with a corner at which the three edges span no positive volume; `cells` are the scene's, x fastest.
#[must_use]
pub fn inverted<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, cells: &[u8]) -> usize {
    let [cx, cy, _] = lattice.nodes.map(|nodes| nodes - 1);
    let turned = |cell: u32| {
        let low = [cell % cx, cell / cx % cy, cell / (cx * cy)];
        let place = |bits: [u32; 3]| {
            let [i, j, k] = [0, 1, 2].map(|axis| low[axis] + bits[axis]);
            lattice.place(tissue, lattice.index([i, j, k]))
        };
        (0..8_u32).any(|corner| {
            let bits = [corner & 1, corner >> 1 & 1, corner >> 2];
            let here = place(bits);
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let mut other = bits;
                other[axis] = 1 - other[axis];
                place(other) - here
            });
            // At a corner with an odd number of upper sides the three edges are left-handed.
            let handed = if bits.iter().sum::<u32>() % 2 == 0 { 1.0 } else { -1.0 };
            x.cross(&y).dot(&z) * handed <= 0.0
        })
    };
    let voxels = (0..).zip(cells).filter(|(_, tissue)| **tissue != 0);
    voxels.filter(|(cell, _)| turned(*cell)).count()
}
