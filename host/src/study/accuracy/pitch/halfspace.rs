//! Smooth rigid indenters on a half-space of the lattice.
//!
//! A quarter of a box is solved under a unit force on the corner where its planes of symmetry meet the surface; its far sides and its bottom
//! are put where Boussinesq's solution has them, so that they might be at any distance and no correction is due. That gives how far a
//! force moves the surface around it, and an indenter is the sum of the forces of the nodes it touches: those that end at its surface
//! where a force pushes, and above it where none does.

use std::f64::consts::PI;

use super::{Force, HERTZ, NOMINAL, POISSON, PUNCH, YOUNG, body, voxels};
use crate::study::double::{NoEquilibrium, V};
use crate::study::poke;

/// Quarter of the box along x, y, z [mm].
const SIZE_MM: [f64; 3] = [48.0; 3];
/// Radius of the flat punch [m].
const RADIUS: f64 = 12e-3;
/// Radius of the sphere [m]; with the depth it makes a contact of √(Rδ) = 12 mm.
const SPHERE: f64 = 72e-3;
/// How far an indenter is pushed in [m].
const DEPTH: f64 = 2e-3;
/// Depths on the sphere's way, at equal steps.
const DEPTHS: i32 = 12;
/// Largest distance along x or y of an indenter's node from its axis [m]: half of what the solved quarter knows.
const WIDEST: f64 = 24e-3;
/// Sweeps over the indenter's nodes after which there is no hope.
const SWEEPS_MAX: usize = 20_000;
/// Change of a force in a sweep over the whole force, of a converged indenter.
const CONVERGED: f64 = 1e-10;

/// Surface node: steps along x and y from the origin.
type Place = [i32; 2];

/// Under a sphere and under a punch.
pub(super) fn forces(pitch_m: f64) -> Result<Vec<Force>, poke::Error> {
    let half_space = HalfSpace::new(pitch_m)?;
    let [of_area, nominal] = half_space.under_a_punch()?;
    Ok(vec![half_space.under_a_sphere()?, of_area, nominal])
}

/// The surface under a unit force on one of its nodes.
struct HalfSpace {
    pitch_m: f64,
    /// Nodes of the solved quarter.
    nodes: usize,
    /// Nodes along a side of the quarter.
    side: usize,
    /// How far a node moves in, by its distance along x and y from the force [m/N].
    sunk: Vec<f64>,
}

impl HalfSpace {
    fn new(pitch_m: f64) -> Result<Self, poke::Error> {
        let mut body = body(SIZE_MM, pitch_m)?;
        let last = voxels(SIZE_MM, pitch_m);
        let far = |[i, j, k]: [u32; 3]| i == last[0] || j == last[1] || k == 0;
        body.hold(|node| [node[0] == 0 || far(node), node[1] == 0 || far(node), far(node)]);
        let mut at = body.field(|node| {
            let [x, y, z] = node.map(|n| f64::from(n) * pitch_m);
            let depth = f64::from(last[2]) * pitch_m - z;
            if far(node) { boussinesq(x, y, depth) } else { V::zeros() }
        });
        // The other three quarters carry the rest of the unit force.
        let corner = [0, 0, last[2]];
        let load = body.field(|node| V::z() * if node == corner { -0.25 } else { 0.0 });
        body.model.relax_under(&load, &mut at)?;
        let top = body.nodes.iter().filter(|([_, _, k], _)| *k == last[2]);
        Ok(Self {
            pitch_m,
            nodes: body.nodes.len(),
            side: last[0] as usize + 1,
            sunk: top.map(|(_, index)| -at.get(*index).z).collect(),
        })
    }

    /// F = 4/3 E/(1 − ν²) √R δ^1.5 (Hertz), whose sphere is the paraboloid that osculates it.
    fn under_a_sphere(&self) -> Result<Force, NoEquilibrium> {
        let (mut measured, mut expected) = (0.0, 0.0);
        let (mut apart, mut whole) = (0.0, 0.0);
        for step in 1..=DEPTHS {
            let depth = DEPTH * f64::from(step) / f64::from(DEPTHS);
            let disc = Disc::new(self.pitch_m, |r| depth - 0.5 * r * r / SPHERE);
            measured = self.indent(&disc)?;
            expected = 4.0 / 3.0 * YOUNG / (1.0 - POISSON * POISSON) * SPHERE.sqrt() * depth.powf(1.5);
            apart += (measured - expected).powi(2);
            whole += expected.powi(2);
        }
        Ok(Force {
            case: HERTZ,
            pitch_m: self.pitch_m,
            nodes: self.nodes,
            measured,
            expected,
            path_error: (apart / whole).sqrt(),
        })
    }

    /// F = 2 R E δ/(1 − ν²) (Boussinesq) of the punch that takes the nodes within its radius: R of their area, and R as it is.
    fn under_a_punch(&self) -> Result<[Force; 2], NoEquilibrium> {
        let rounding = 1.0 + 1e-9;
        let disc = Disc::new(self.pitch_m, |r| if r <= RADIUS * rounding { DEPTH } else { -DEPTH });
        let measured = self.indent(&disc)?;
        let nodes: usize = disc.rings.iter().map(|ring| ring.nodes.len()).sum();
        let of_area = (nodes as f64 / PI).sqrt() * self.pitch_m;
        Ok([(PUNCH, of_area), (NOMINAL, RADIUS)].map(|(case, radius)| {
            let expected = 2.0 * radius * YOUNG * DEPTH / (1.0 - POISSON * POISSON);
            Force::linear(case, [measured, expected], self.pitch_m, self.nodes)
        }))
    }

    /// Force of an indenter [N]: Gauss–Seidel on the forces of its nodes, none of which may pull.
    fn indent(&self, Disc { rings }: &Disc) -> Result<f64, NoEquilibrium> {
        // The nodes of a ring bear the same, so one of them stands for all.
        let between = |of: &Ring, on: &Ring| on.nodes.iter().map(|node| self.between(of.nodes[0], *node)).sum();
        let compliance: Vec<Vec<f64>> = rings
            .iter()
            .map(|of| rings.iter().map(|on| between(of, on)).collect())
            .collect();
        let mut force = vec![0.0; rings.len()];
        let mut change = 0.0;
        for _ in 0..SWEEPS_MAX {
            change = 0.0;
            for (n, (ring, row)) in rings.iter().zip(&compliance).enumerate() {
                let sunk: f64 = row.iter().zip(&force).map(|(per_newton, f)| per_newton * f).sum();
                let next = (force[n] + (ring.depth - sunk) / row[n]).max(0.0);
                change = f64::max(change, (next - force[n]).abs() * ring.nodes.len() as f64);
                force[n] = next;
            }
            let parts = rings.iter().zip(&force);
            let whole = parts.map(|(ring, f)| ring.nodes.len() as f64 * f).sum();
            if change <= CONVERGED * whole {
                return Ok(whole);
            }
        }
        Err(NoEquilibrium { residual_n: change })
    }

    /// How far a unit force at one node moves another in [m/N].
    fn between(&self, [ax, ay]: Place, [bx, by]: Place) -> f64 {
        self.sunk[ay.abs_diff(by) as usize * self.side + ax.abs_diff(bx) as usize]
    }
}

/// The surface nodes that an indenter would pass through.
struct Disc {
    rings: Vec<Ring>,
}

/// Those that the symmetry of a square makes alike.
struct Ring {
    nodes: Vec<Place>,
    /// How far down the indenter reaches there [m].
    depth: f64,
}

impl Disc {
    /// Of an indenter that reaches `depth` [m] down at a distance [m] from its axis.
    fn new(pitch_m: f64, depth: impl Fn(f64) -> f64) -> Self {
        let steps = (WIDEST / pitch_m).round() as i32;
        let octant = (0..=steps).flat_map(|i| (0..=i).map(move |j| [i, j]));
        let ring = |[i, j]: Place| {
            let images = [[i, j], [j, i]].into_iter();
            let mut nodes: Vec<Place> = images.flat_map(|[a, b]| [[a, b], [-a, b], [a, -b], [-a, -b]]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            let radius = f64::from(i).hypot(f64::from(j)) * pitch_m;
            Ring {
                nodes,
                depth: depth(radius),
            }
        };
        Self {
            rings: octant.map(ring).filter(|ring| ring.depth > 0.0).collect(),
        }
    }
}

/// Displacement of a half-space from a unit force down on the origin [m/N], at a place x, y aside and `depth` below (Boussinesq).
fn boussinesq(x: f64, y: f64, depth: f64) -> V {
    let far = (x * x + y * y + depth * depth).sqrt();
    let outward = depth / far.powi(3) - (1.0 - 2.0 * POISSON) / (far * (far + depth));
    let down = depth * depth / far.powi(3) + 2.0 * (1.0 - POISSON) / far;
    V::new(x * outward, y * outward, -down) * ((1.0 + POISSON) / (2.0 * PI * YOUNG))
}
