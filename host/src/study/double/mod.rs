//! The lattice in double precision, computed apart from the controller: what a solver's result is compared with.
//!
//! Springs are those that the controller has assembled, each T(ε) = k L₀ (ε + Σ r_m max(0, ε − ε_m) − ½ g max(0, −ε − ε_c)²) with the
//! curve's breakpoints ε_m, rises r_m, lock ε_c and its gain g, where a breakpoint below zero acts on its other side; geometry, forces,
//! energies and steps in time are its own. Voxels of the law `volume` add their own energy.

mod field;
mod gradients;
mod linear;
mod march;
mod newton;
mod pull;
mod stability;
mod tangent;
mod volume;

pub use field::Field;
pub use gradients::{Stiffness, relax};
pub use march::{March, Moved};
pub use newton::NoEquilibrium;

use nalgebra::Vector3;
use sutura_controller::lattice::{CURVES, DIRECTIONS, EDGES, Lattice, STEPS};
use sutura_controller::law::{self, Breaks, Material};

use self::volume::Voxels;

/// A vector in double precision.
pub type V = Vector3<f64>;

/// Springs, voxels, masses and what is held.
#[derive(Clone, Debug)]
pub struct Model {
    families: Vec<Family>,
    voxels: Voxels,
    mass: Vec<f64>,
    /// Whether a node moves, by component.
    free: [Vec<bool>; 3],
    damping: f64,
}

/// All springs of one direction and one tissue's curve; each belongs to its lower node.
#[derive(Clone, Debug)]
struct Family {
    /// Index distance to the other node.
    offset: usize,
    rest: V,
    length: f64,
    /// First-slope stiffness by lower node, zero where there is no spring [N/m].
    stiffness: Vec<f64>,
    curve: Curve,
}

/// The form of T/(k L₀) over the strain.
#[derive(Clone, Debug)]
struct Curve {
    /// Strain of each breakpoint and the rise of the slope there.
    breaks: Vec<[f64; 2]>,
    /// Steepest slope over the first, without the lock.
    steepest: f64,
    /// Compression from which a spring locks, and by how much its slope rises a unit of strain from there.
    lock: [f64; 2],
}

/// One spring as it is now.
#[derive(Clone, Copy, Debug)]
struct Stretched {
    /// Unit vector from the lower node.
    direction: V,
    /// l [m].
    length: f64,
    /// T [N].
    tension: f64,
    /// dT/dl [N/m].
    slope: f64,
}

impl Model {
    /// From the controller's lattice.
    #[must_use]
    pub fn new<const N: usize>(lattice: &Lattice<N>, material: &Material) -> Self {
        let n = lattice.len();
        let wide = |values: &[f32]| -> Vec<f64> { values.iter().take(n).map(|value| f64::from(*value)).collect() };
        // Without stiffening every spring is linear, and the first slot holds them all.
        let slots = if material.stiffening { CURVES } else { 1 };
        let tissues = material.curves.iter().zip(&lattice.stiffness).take(slots);
        let family = |(curve, stiffness): (&law::Curve, &[[f32; N]; DIRECTIONS]), direction: usize| {
            let [x, y, z] = STEPS[direction];
            let rest = V::new(f64::from(x), f64::from(y), f64::from(z)) * f64::from(lattice.pitch);
            let breaks = if direction < EDGES {
                &curve.edge
            } else {
                &curve.diagonal
            };
            Family {
                offset: lattice.offsets()[direction],
                rest,
                length: rest.norm(),
                stiffness: wide(&stiffness[direction]),
                curve: if material.stiffening {
                    Curve::new(breaks)
                } else {
                    Curve::default()
                },
            }
        };
        Self {
            families: tissues
                .filter(|(curve, _)| curve.young > 0.0)
                .flat_map(|tissue| (0..DIRECTIONS).map(move |direction| family(tissue, direction)))
                .collect(),
            voxels: Voxels::new(lattice),
            mass: wide(&lattice.mass),
            free: std::array::from_fn(|_| lattice.free.iter().take(n).map(|free| *free > 0.0).collect()),
            damping: f64::from(material.mass_damping),
        }
    }

    /// Nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether there is no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Whether a node moves in any direction.
    fn moves(&self, node: usize) -> bool {
        self.free.iter().any(|free| free[node])
    }

    /// Fills `force` with the elastic force on every node at the displacements `at` [N], and gives the elastic energy [J].
    pub fn elastic(&self, at: &Field, force: &mut Field) -> f64 {
        force.clear();
        let mut energy = 0.0;
        for family in &self.families {
            energy += family.pull(at, force);
        }
        energy + self.voxels.elastic(at, force)
    }

    /// Elastic force on one node at displacements that `at` gives by node [N].
    pub fn reaction(&self, node: usize, at: impl Fn(usize) -> V) -> V {
        let mut force = V::zeros();
        for family in &self.families {
            let lows = [Some(node), node.checked_sub(family.offset)];
            for (low, sign) in lows.into_iter().zip([1.0, -1.0]) {
                let Some(low) = low.filter(|low| family.stiffness.get(*low).is_some_and(|k| *k > 0.0)) else {
                    continue;
                };
                let spring = family.stretch(low, at(low + family.offset) - at(low));
                force += spring.direction * (sign * spring.tension);
            }
        }
        force + self.voxels.reaction(node, at)
    }
}

impl Family {
    /// Lower nodes of the springs.
    fn springs(&self) -> impl Iterator<Item = usize> + '_ {
        let there = self.stiffness.iter().enumerate().filter(|(_, k)| **k > 0.0);
        there.map(|(low, _)| low)
    }

    /// The spring of node `low` where its ends have moved apart by `delta` [m].
    #[inline]
    fn stretch(&self, low: usize, delta: V) -> Stretched {
        let now = self.rest + delta;
        let length = now.norm();
        // l − L₀ from l² − L₀², which keeps the digits that the difference of lengths would lose.
        let longer = delta.dot(&(self.rest * 2.0 + delta)) / (length + self.length);
        let [[tension], [slope], _] = self.curve.follow(&[longer / self.length]);
        let k = self.stiffness[low];
        Stretched {
            direction: now / length,
            length,
            tension: k * self.length * tension,
            slope: k * slope,
        }
    }
}

impl Default for Curve {
    fn default() -> Self {
        Self {
            breaks: Vec::new(),
            steepest: 1.0,
            lock: [0.0; 2],
        }
    }
}

impl Curve {
    fn new(breaks: &Breaks) -> Self {
        let pairs = breaks.strain.iter().zip(&breaks.rise);
        let used = pairs.filter(|(_, rise)| rise.abs() > 0.0);
        let (from, gain) = breaks.lock;
        Self {
            breaks: used
                .map(|(strain, rise)| [f64::from(*strain), f64::from(*rise)])
                .collect(),
            steepest: f64::from(breaks.steepest()),
            lock: [f64::from(from), f64::from(gain)],
        }
    }

    /// T/(k L₀), its slope and its integral over the strain, for each of some strains.
    #[inline]
    fn follow<const M: usize>(&self, strain: &[f64; M]) -> [[f64; M]; 3] {
        let [from, gain] = self.lock;
        let [mut tension, mut slope, mut energy] = [[0.0; M]; 3];
        for i in 0..M {
            let under = (-strain[i] - from).max(0.0);
            tension[i] = strain[i] - 0.5 * gain * under * under;
            slope[i] = 1.0 + gain * under;
            energy[i] = 0.5 * strain[i] * strain[i] + gain * under * under * under / 6.0;
        }
        for [at, rise] in &self.breaks {
            let side = at.signum();
            for i in 0..M {
                let over = side * (side * (strain[i] - at)).max(0.0);
                tension[i] += rise * over;
                slope[i] += if over.abs() > 0.0 { *rise } else { 0.0 };
                energy[i] += 0.5 * rise * over * over;
            }
        }
        [tension, slope, energy]
    }
}

#[cfg(test)]
mod tests;
