//! The built-in anatomy: a forearm of skin, muscle and two bones, so that a first run needs no foreign mesh.
//!
//! Each part is a superellipsoid |x/a|ᵖ + |y/b|^q + |z/c|ʳ = 1, the forearm lying along y with its flat side up: blunt exponents make the top flat and
//! the ends round, and the volume has a closed form. Such a solid is seen whole from its middle, so a box of square facets is drawn onto it along the rays
//! from there; the surface is closed and of one orientation by construction, which marching through a grid of distances would have to be made to be.

use std::path::{Path, PathBuf};

use super::Vec3;
use super::mesh::Mesh;
use super::stl::{self, StlError};

/// Names of its tissues, from the outside in.
pub const TISSUES: [&str; 3] = ["skin", "muscle", "bone"];

/// Where the stitch goes: on the flat side of the skin, between the bones [mm].
pub const SITE: [f64; 3] = [0.0, 0.0, 32.0];

/// Outward skin normal at [`SITE`].
pub const NORMAL: [f64; 3] = [0.0, 0.0, 1.0];

/// Edge of a facet of the box before it is drawn onto a solid [mm].
const FACET: f64 = 2.0;

/// Facets along half an edge of the box, at least, so that slender solids are round.
const ROUND: f64 = 7.0;

/// The skin's outer surface; the muscle leaves 1.5 mm of skin all around.
const SKIN: Solid = Solid {
    middle: [0.0; 3],
    half: [55.0, 60.0, 32.0],
    exponents: [3.0, 8.0, 3.0],
};
const MUSCLE: Solid = Solid {
    middle: [0.0; 3],
    half: [53.5, 58.5, 30.5],
    exponents: [3.0, 8.0, 3.0],
};
/// Radius and ulna, with 14 and 15 mm of soft tissue above.
const BONES: [Solid; 2] = [
    Solid {
        middle: [15.0, 0.0, 10.0],
        half: [8.0, 52.0, 8.0],
        exponents: [2.0, 8.0, 2.0],
    },
    Solid {
        middle: [-15.0, 0.0, 10.0],
        half: [7.0, 52.0, 7.0],
        exponents: [2.0, 8.0, 2.0],
    },
];

/// A superellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Its middle [mm].
    pub middle: [f64; 3],
    /// Half its extent along x, y and z [mm].
    pub half: [f64; 3],
    /// How blunt it is along x, y and z: 2 is an ellipsoid, more is nearer to a box.
    pub exponents: [f64; 3],
}

impl Solid {
    /// Signed distance to the surface to first order, negative inside [mm]: the implicit function over the size of its gradient (Taubin 1994).
    #[must_use]
    pub fn distance(&self, point: Vec3) -> f64 {
        let (value, gradient) = self.implicit(point - Vec3::from(self.middle));
        value / gradient.norm()
    }

    /// The implicit function, zero on the surface, and its gradient, about the middle.
    fn implicit(&self, from_middle: Vec3) -> (f64, Vec3) {
        let (mut value, mut gradient) = (-1.0, Vec3::zeros());
        for axis in 0..3 {
            let (part, exponent) = (from_middle[axis] / self.half[axis], self.exponents[axis]);
            value += part.abs().powf(exponent);
            gradient[axis] = exponent * part.abs().powf(exponent - 1.0) * part.signum() / self.half[axis];
        }
        (value, gradient)
    }

    /// Where the ray from the middle along `direction` leaves the solid: Newton's method from outside, as the function is convex along the ray.
    fn edge(&self, direction: Vec3) -> Vec3 {
        const STEPS: usize = 60;
        let largest = (0..3)
            .map(|axis| direction[axis].abs() / self.half[axis])
            .fold(0.0, f64::max);
        let mut scale = 1.0 / largest;
        for _ in 0..STEPS {
            let (value, gradient) = self.implicit(direction * scale);
            let next = scale - value / gradient.dot(&direction);
            if next >= scale {
                break;
            }
            scale = next;
        }
        direction * scale
    }

    /// The surface as triangles of about 2 mm, facing outwards.
    #[must_use]
    pub fn surface(&self) -> Mesh {
        let mut corners = Vec::new();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                self.face(axis, side, &mut corners);
            }
        }
        // Corners along the edges of the box are computed alike on both faces and become one.
        Mesh::from_corners(&corners).0
    }

    /// One face of the box, drawn onto the solid.
    fn face(&self, axis: usize, side: f64, corners: &mut Vec<[Vec3; 3]>) {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let facet = self.half.iter().map(|half| half / ROUND).fold(FACET, f64::min);
        let [nu, nv] = across.map(|a| (2.0 * self.half[a] / facet).ceil() as usize);
        let point = |u: usize, v: usize| {
            let mut direction = Vec3::zeros();
            direction[axis] = side * self.half[axis];
            for (a, part) in across.into_iter().zip([u as f64 / nu as f64, v as f64 / nv as f64]) {
                direction[a] = (2.0 * part - 1.0) * self.half[a];
            }
            self.edge(direction) + Vec3::from(self.middle)
        };
        let row = |v| (0..=nu).map(|u| point(u, v)).collect::<Vec<_>>();
        let mut low = row(0);
        for v in 1..=nv {
            let high = row(v);
            for (from, to) in low.windows(2).zip(high.windows(2)) {
                let [a, b, c, d] = if side > 0.0 {
                    [from[0], from[1], to[1], to[0]]
                } else {
                    [from[0], to[0], to[1], from[1]]
                };
                corners.extend([[a, b, c], [a, c, d]]);
            }
            low = high;
        }
    }
}

/// The forearm's surfaces, each closed.
#[derive(Clone, Debug, PartialEq)]
pub struct Forearm {
    /// Radius and ulna.
    pub bone: Mesh,
    /// All within the skin, bones included.
    pub muscle: Mesh,
    /// The outer surface.
    pub skin: Mesh,
}

/// Draws the forearm [mm].
#[must_use]
pub fn forearm() -> Forearm {
    let bones: Vec<_> = BONES.iter().map(Solid::surface).collect();
    let corners: Vec<_> = bones.iter().flat_map(Mesh::corners).collect();
    Forearm {
        bone: Mesh::from_corners(&corners).0,
        muscle: MUSCLE.surface(),
        skin: SKIN.surface(),
    }
}

/// Names of the files that [`write()`] makes, in order of priority.
pub const FILES: [&str; 3] = ["bone.stl", "muscle.stl", "skin.stl"];

/// Writes the forearm as STL files in millimetres into an existing folder, and names them in the order of [`FILES`].
///
/// # Errors
/// The file system refuses.
pub fn write(folder: &Path) -> Result<[PathBuf; 3], StlError> {
    let Forearm { bone, muscle, skin } = forearm();
    let paths = FILES.map(|name| folder.join(name));
    for (path, mesh) in paths.iter().zip([bone, muscle, skin]) {
        stl::write(path, &mesh)?;
    }
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dirichlet's integral: V = 8abc Γ(1+1/p)Γ(1+1/q)Γ(1+1/r) / Γ(1+1/p+1/q+1/r).
    fn volume(solid: &Solid) -> f64 {
        let gamma = |sum: f64| gamma_function(1.0 + sum);
        let [p, q, r] = solid.exponents.map(|e| 1.0 / e);
        8.0 * solid.half.iter().product::<f64>() * gamma(p) * gamma(q) * gamma(r) / gamma(p + q + r)
    }

    /// Γ by its integral ∫ tˣ⁻¹ e⁻ᵗ dt, with t = s² to be smooth at zero, by Simpson's rule.
    fn gamma_function(x: f64) -> f64 {
        let (steps, end) = (20_000, 8.0);
        let h = end / f64::from(steps);
        let f = |s: f64| 2.0 * s.powf(2.0 * x - 1.0) * (-s * s).exp();
        (0..steps)
            .map(|i| f64::from(i) * h)
            .map(|s| h / 6.0 * (f(s) + 4.0 * f(s + h / 2.0) + f(s + h)))
            .sum()
    }

    #[test]
    fn each_part_is_closed_and_has_its_volume() {
        for solid in [SKIN, MUSCLE, BONES[0], BONES[1]] {
            let mesh = solid.surface();
            assert_eq!(mesh.survey(), []);
            let expected = volume(&solid);
            assert!(
                (mesh.signed_volume() / expected - 1.0).abs() < 0.01,
                "{} {expected}",
                mesh.signed_volume()
            );
        }
    }

    #[test]
    fn corners_lie_on_the_solid() {
        for solid in [SKIN, BONES[0]] {
            assert!(solid.surface().vertices.iter().all(|&p| solid.distance(p).abs() < 1e-9));
        }
    }

    /// A patch of 40 × 30 mm stays within half a cell of 2 mm, and has 12 mm of soft tissue over bone.
    #[test]
    fn site_is_flat_and_deep() {
        for x in [-20.0, 0.0, 20.0] {
            for y in [-15.0, 0.0, 15.0] {
                let point = Vec3::from(SITE) + Vec3::new(x, y, 0.0);
                assert!(SKIN.distance(point).abs() < 0.6);
                assert!(BONES.iter().all(|bone| bone.distance(point - Vec3::z() * 12.0) > 1.0));
            }
        }
    }

    #[test]
    fn files_read_back_as_written() {
        let folder = tempfile::tempdir().unwrap();
        for (path, mesh) in write(folder.path())
            .unwrap()
            .iter()
            .zip([forearm().bone, forearm().muscle, forearm().skin])
        {
            let read = stl::read(path).unwrap();
            assert_eq!(read.warnings, []);
            assert_eq!(read.mesh.triangles.len(), mesh.triangles.len());
            assert!((read.mesh.signed_volume() / mesh.signed_volume() - 1.0).abs() < 1e-6);
        }
    }
}
