//! What a spring is: stiffness from Young's modulus (Lian & Chen Eqs 1–6) and the piecewise-linear
//! stress–strain curve (Lian & Chen Fig. 3).
//!
//! A voxel of edge a owns its springs: twelve edges of k_n/4 each and four body diagonals of k_d each. Summed over
//! voxels this gives a block of any size the bulk's moduli exactly, and tissues side by side their own.
//! Of a lattice so assembled C11 = (k_n + 4k_d/3)/a and C12 = C44 = 4k_d/(3a).
//!
//! Those are the moduli of deformations that are smooth over several voxels. Edges upright and body diagonals join nodes of equal i + j
//! only, so columns of even i + j slide along those of odd i + j at no linear cost, and likewise about the other axes: a force on one node
//! moves it about twice as far as a continuum, one spread over both kinds ([`crate::coupling::Kernel`]) does not. Where such a
//! pattern is compressed and nothing near holds it, it buckles; held sides and bottoms delay that.

mod breaks;
mod curve;
mod fit;
mod material;

pub use breaks::{BREAKS, Breaks};
pub use curve::Curve;
pub use material::Material;

use sutura_shared::scene::Law;

/// Stiffness of edges k_n and of body diagonals k_d of one voxel over E·a, and of its volume over E; no unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// All edges along one axis together, over E a.
    pub edge: f32,
    /// One body diagonal, over E a.
    pub diagonal: f32,
    /// Λ of the volume energy ½ Λ (J − 1)² a³, over E.
    pub volume: f32,
}

/// J_b, the part of its volume that a voxel keeps before the barrier acts: less than any scene leaves it that is not a blow.
pub const BARRIER_BELOW: f32 = 0.3;
/// B of the barrier ½ B max(0, J_b − J)² a³ against inverted voxels, over E: enough that no mirrored voxel rests. Law `volume` has it, and
/// every law with effect `barrier`.
///
/// Springs are as content mirrored as they are upright, and hold a voxel diag(1, 1, s) a of −1 < s < 0 back from flattening with the force
/// k_n (1 + s) a of the edges and that of the shortened diagonals. The barrier's, B (J_b − s) a², is greater all the way where
/// B > k_n/(J_b a) = 2.7 E; where the diagonals lock ([`Breaks::lock`]), where B > 6.4 E. Past s = 0 the edges push on by themselves.
/// It is quadratic, and a slope that rises no more than a curve's own breakpoints do is what one Newton step a tick can follow.
pub const BARRIER: f32 = 8.0;

/// The stiffness a law gives.
#[must_use]
pub const fn stiffness(law: Law) -> Stiffness {
    match law {
        Law::Isotropic => Stiffness {
            edge: 0.8,
            diagonal: 0.3,
            volume: 0.0,
        },
        // √(2/3) makes E₁₀₀ = E where k_d gives G = E/3.
        Law::Axial => Stiffness {
            edge: 0.816_496_6,
            diagonal: 0.25,
            volume: 0.0,
        },
        Law::Paper => Stiffness {
            edge: 0.45,
            diagonal: 0.25,
            volume: 0.0,
        },
        // C44 = 4k_d/(3a) = G whatever Λ is, which adds to C11 and C12 alone: C12 = G + Λ = 2Gν/(1 − 2ν) and C11 = C12 + 2G.
        Law::Volume { poisson } => {
            let shear = 0.5 / (1.0 + poisson);
            Stiffness {
                edge: 2.0 * shear,
                diagonal: 0.75 * shear,
                volume: shear * (4.0 * poisson - 1.0) / (1.0 - 2.0 * poisson),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sutura_shared::scene::Segment;

    /// Of a voxel diag(1, 1, s) a the springs hold less than the barrier pushes, at every s from −1 to 0, with locks and without.
    #[test]
    fn the_barrier_is_stronger_than_a_mirrored_voxel() {
        let line = [Segment {
            from_strain: 0.0,
            slope_pa: 1.0,
        }];
        let volume = [0.25, 0.3, 0.4, 0.45, 0.49].map(|poisson| Law::Volume { poisson });
        for law in [Law::Isotropic, Law::Axial, Law::Paper].into_iter().chain(volume) {
            let stiffness = stiffness(law);
            let locked = Curve::new(&line, stiffness).diagonal;
            for diagonal in [locked, Breaks::default()] {
                for thousandths in -1000..0_i16 {
                    let s = 0.001 * f32::from(thousandths);
                    let over = libm::sqrtf((2.0 + s * s) / 3.0);
                    let diagonals = 4.0 * stiffness.diagonal * diagonal.tension(over - 1.0) * s / over;
                    let springs = stiffness.edge * (1.0 + s) + diagonals;
                    let barrier = BARRIER * (BARRIER_BELOW - s);
                    assert!(barrier > 1.2 * springs, "{law:?} {s}: {barrier} against {springs}");
                }
            }
        }
    }
}
