//! What the springs of a family pull their nodes with, many at a time: the work that a step in time consists of.

use super::{Family, Field};

/// Springs at a time: what stays in the first cache.
const CHUNK: usize = 128;

/// A number of each spring of a chunk.
type Chunk = [f64; CHUNK];

impl Family {
    /// Adds the springs' force on every node at the displacements `at` [N], and gives their energy [J]. Places without a spring have
    /// no stiffness and add nothing.
    pub(super) fn pull(&self, at: &Field, force: &mut Field) -> f64 {
        let springs = self.stiffness.len() - self.offset;
        let mut energy = [0.0; CHUNK];
        for low in (0..springs).step_by(CHUNK) {
            let m = CHUNK.min(springs - low);
            let high = low + self.offset;
            // The last chunk's rest stays without stiffness, and so without force.
            let mut k = [0.0; CHUNK];
            k[..m].copy_from_slice(&self.stiffness[low..low + m]);
            let mut delta = [[0.0; CHUNK]; 3];
            for (delta, part) in delta.iter_mut().zip(&at.parts) {
                let ends = part[low..low + m].iter().zip(&part[high..high + m]);
                delta
                    .iter_mut()
                    .zip(ends)
                    .for_each(|(delta, (near, far))| *delta = far - near);
            }
            let (strain, length) = self.strains(&delta);
            let [tension, _, stored] = self.curve.follow(&strain);
            let mut over_length = [0.0; CHUNK];
            for i in 0..CHUNK {
                over_length[i] = k[i] * self.length * tension[i] / length[i];
                energy[i] += k[i] * self.length * self.length * stored[i];
            }
            for ((delta, rest), part) in delta.iter_mut().zip(&self.rest).zip(&mut force.parts) {
                delta
                    .iter_mut()
                    .zip(&over_length)
                    .for_each(|(x, over)| *x = (rest + *x) * over);
                part[low..low + m]
                    .iter_mut()
                    .zip(&*delta)
                    .for_each(|(f, pull)| *f += pull);
                part[high..high + m]
                    .iter_mut()
                    .zip(&*delta)
                    .for_each(|(f, pull)| *f -= pull);
            }
        }
        energy.iter().sum()
    }

    /// Strain and length [m] of springs whose ends have moved apart by `delta` [m].
    fn strains(&self, delta: &[Chunk; 3]) -> (Chunk, Chunk) {
        let [rx, ry, rz] = [self.rest.x, self.rest.y, self.rest.z];
        let [dx, dy, dz] = delta;
        let mut strain = [0.0; CHUNK];
        let mut length = [0.0; CHUNK];
        for i in 0..CHUNK {
            let (x, y, z) = (rx + dx[i], ry + dy[i], rz + dz[i]);
            length[i] = (x * x + y * y + z * z).sqrt();
            // l − L₀ from l² − L₀², which keeps the digits that the difference of lengths would lose.
            let squares = dx[i] * (rx + x) + dy[i] * (ry + y) + dz[i] * (rz + z);
            strain[i] = squares / ((length[i] + self.length) * self.length);
        }
        (strain, length)
    }
}
