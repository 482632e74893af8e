//! Law `volume`: springs and the voxels' energy a³ (½ Λ (J − 1)² + ½ B max(0, 0.3 − J)²), computed apart in double precision.

use super::block::{Block, PITCH, Random, linear, scene};
use super::reference::{Springs, V, wide};
use nalgebra::Matrix3;
use sutura_shared::scene::Law;

const YOUNG: f64 = 100e3;
const NUS: [f32; 4] = [0.25, 0.3, 0.45, 0.49];

/// Springs and voxels in double precision.
pub(crate) struct Whole {
    springs: Springs,
    /// Corners of each voxel; bit i of a corner's number is its place along axis i.
    voxels: Vec<[usize; 8]>,
    /// Λ and B [Pa].
    stiffness: [f64; 2],
}

impl Whole {
    fn new(block: &Block, poisson: f64) -> Self {
        let shear = 0.5 / (1.0 + poisson);
        let [nx, ny, nz] = block.lattice.nodes;
        let lowest = block
            .nodes()
            .filter(|(_, [i, j, k])| i + 1 < nx && j + 1 < ny && k + 1 < nz);
        let corners = |[i, j, k]: [u32; 3]| {
            core::array::from_fn(|c| {
                let c = c as u32;
                block.lattice.index([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)])
            })
        };
        Self {
            springs: Springs::of(block, [2.0 * shear, 0.75 * shear], |_| YOUNG),
            voxels: lowest.map(|(_, at)| corners(at)).collect(),
            stiffness: [shear * (4.0 * poisson - 1.0) / (1.0 - 2.0 * poisson), 8.0].map(|k| k * YOUNG),
        }
    }

    /// J of a voxel.
    fn growth(voxel: &[usize; 8], u: &[V]) -> f64 {
        let edge = |axis: usize| -> V {
            let signed = voxel.iter().enumerate().map(|(c, node)| {
                let sign = if c >> axis & 1 == 1 { 0.25 } else { -0.25 };
                u[*node] * (sign / f64::from(PITCH))
            });
            signed.sum::<V>() + V::ith(axis, 1.0)
        };
        Matrix3::from_columns(&[edge(0), edge(1), edge(2)]).determinant()
    }

    fn energy(&self, u: &[V]) -> f64 {
        let [volume, barrier] = self.stiffness;
        let of = |voxel: &[usize; 8]| {
            let j = Self::growth(voxel, u);
            let under = (0.3 - j).max(0.0);
            0.5 * (volume * (j - 1.0) * (j - 1.0) + barrier * under * under) * f64::from(PITCH).powi(3)
        };
        self.springs.energy(u) + self.voxels.iter().map(of).sum::<f64>()
    }
}

fn block(cells: [u16; 3], poisson: f32) -> Block {
    Block::filled(&scene(cells, Law::Volume { poisson }, &[linear(YOUNG as f32)], &[]))
}

/// Every node out of place by up to `shift` [m].
fn shake(block: &mut Block, shift: f32, seed: u64) {
    let mut random = Random::new(seed);
    for (n, _) in block.nodes() {
        for c in 0..3 {
            block.tissue.displacement[c][n] = shift * random.next() * block.lattice.free[n];
        }
    }
}

/// By central differences along each coordinate of every node; the larger shift inverts voxels.
#[test]
fn the_force_is_the_slope_of_the_energy() {
    for (poisson, shift) in NUS.iter().flat_map(|nu| [(*nu, 2e-4), (*nu, 3e-3)]) {
        let mut block = block([3, 2, 4], poisson);
        block.release();
        shake(&mut block, shift, 5);
        let whole = Whole::new(&block, f64::from(poisson));
        let n = block.lattice.len();
        let mut u = wide(&block.tissue.displacement, n);
        if shift > 1e-3 {
            assert!(whole.voxels.iter().any(|voxel| Whole::growth(voxel, &u) < 0.0));
        }
        let force = wide(&block.elastic(None), n);
        let largest = force.iter().map(V::norm).fold(0.0, f64::max);
        for (node, _) in block.nodes() {
            for c in 0..3 {
                let (place, step) = (u[node][c], 1e-8);
                let [plus, minus] = [step, -step].map(|step| {
                    u[node][c] = place + step;
                    whole.energy(&u)
                });
                u[node][c] = place;
                let expected = -(plus - minus) / (2.0 * step);
                let off = (force[node][c] - expected).abs() / largest;
                assert!(off < 2e-5, "{poisson} {shift} {node} {c}: {off:e}");
            }
        }
    }
}
