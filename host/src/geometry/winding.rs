//! Generalized winding numbers of surfaces with holes (Jacobson, Kavan & Sorkine-Hornung 2013), from the holes alone.
//!
//! The winding number of a surface M at a point is the solid angle it subtends there over 4π. Closing M with any surface C along its open edges
//! makes it a closed chain, whose winding number is a whole number N that signed crossings count exactly; so
//!
//! ```text
//! w_M = N − w_C,      w_C = Σ over the triangles of C of their solid angle / 4π
//! ```
//!
//! Here C is a cone from each loop of open edges to a point amid it. There are few open edges where there are few holes,
//! so a winding number costs a handful of triangles instead of the whole surface, and is not an approximation.
//! Two bounds save most of the work. The winding number of a cone of area A at a distance D is at most A/(4π D²). And between crossings w_M is smooth,
//! with a slope that depends on the open edges alone (Biot and Savart's law): at most G = Σ l/(4π d²), where an edge of length l is no nearer than d.
//! A step s towards edges no nearer than D makes each of these bounds at most (1 − s/D)⁻² times as large, so the winding number changes
//! by at most ∫ G (1 − s/D)⁻² ds = G s/(1 − s/D), and an answer with a margin m holds as far as m/(G + m/D).

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::iter;

use super::Vec3;
use super::mesh::Mesh;

/// Triangles that close a surface, one cone for each loop of open edges.
#[derive(Clone, Debug, Default)]
pub struct Caps {
    cones: Vec<Cone>,
}

/// A cone over a loop of open edges.
#[derive(Clone, Debug)]
struct Cone {
    /// Points of the loop in the direction of the open edges, with the length of the edge to the next; the last is joined to the first.
    rim: Vec<(Vec3, f64)>,
    apex: Vec3,
    /// Largest distance of a point from the apex.
    radius: f64,
    area: f64,
    /// Length of the rim.
    length: f64,
}

impl Caps {
    /// Cones over the open edges of a surface, facing so that the surface and the cones together are closed.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        // As many open edges leave a point as arrive, so a walk that uses each edge once ends only where it began.
        let mut onward: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for [from, to] in mesh.open_edges() {
            onward.entry(from).or_default().push(to);
        }
        let mut cones = Vec::new();
        while let Some((&start, _)) = onward.first_key_value() {
            let mut at = start;
            let walk = iter::from_fn(|| {
                let ends = onward.get_mut(&at)?;
                let point = mesh.vertices[at as usize];
                let next = ends.pop()?;
                if ends.is_empty() {
                    onward.remove(&at);
                }
                at = next;
                Some((point, next))
            });
            let mut rim = Vec::new();
            for (point, next) in walk {
                rim.push(point);
                if next == start {
                    break;
                }
            }
            cones.push(Cone::over(&rim));
        }
        Self { cones }
    }

    /// Number of open edges, and of triangles of the caps.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.cones.iter().map(|cone| cone.rim.len()).sum()
    }

    /// The triangles of all caps.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.cones.iter().flat_map(Cone::triangles)
    }

    /// Whether the surface winds around a point by more than one half, either way, where surface and caps together wind around it `closed` times;
    /// and how far from the point that certainly stays so, if neither surface nor caps are crossed.
    #[must_use]
    pub fn inside(&self, closed: i32, point: Vec3) -> (bool, f64) {
        let from_half = |sum: &Sum| ((f64::from(closed) - sum.winding).abs() - 0.5).abs();
        let sum = self.sum(point, FAR);
        // Where the bound of the far cones leaves the answer open, they are summed like the others.
        let sum = if from_half(&sum) > sum.error {
            sum
        } else {
            self.sum(point, 0.0)
        };
        let margin = from_half(&sum) - sum.error;
        (
            (f64::from(closed) - sum.winding).abs() > 0.5,
            margin / (sum.slope + margin / sum.distance),
        )
    }

    /// The winding number of all caps at a point, where cones with a bound below `far` only add to the error.
    fn sum(&self, point: Vec3, far: f64) -> Sum {
        let mut sum = Sum {
            winding: 0.0,
            error: 0.0,
            slope: 0.0,
            distance: f64::INFINITY,
        };
        for cone in &self.cones {
            let distance = (point - cone.apex).norm() - cone.radius;
            let bound = cone.area / (4.0 * PI * distance * distance);
            if distance > 0.0 && bound < far {
                sum.error += bound;
                sum.slope += cone.length / (4.0 * PI * distance * distance);
                sum.distance = sum.distance.min(distance);
            } else {
                cone.add_to(&mut sum, point);
            }
        }
        sum
    }
}

/// What is known of the caps at a point.
struct Sum {
    winding: f64,
    /// How much the winding number may differ from `winding`.
    error: f64,
    /// How fast it may change [1/mm].
    slope: f64,
    /// No open edge is nearer [mm].
    distance: f64,
}

/// Bound of its winding number below which a cone is far.
const FAR: f64 = 0.1;

impl Cone {
    fn over(points: &[Vec3]) -> Self {
        let mean = points.iter().sum::<Vec3>() / points.len() as f64;
        let size = points.iter().map(|p| (p - mean).norm()).fold(0.0, f64::max);
        // Not quite in the middle: rows through cell centres would meet flat and symmetric caps edge-on, where sides are a matter of rounding.
        let apex = mean + Vec3::new(3e-4, 5e-4, 7e-4) * size;
        let radius = points.iter().map(|p| (p - apex).norm()).fold(0.0, f64::max);
        let next = points.iter().cycle().skip(1);
        let rim: Vec<_> = points
            .iter()
            .zip(next)
            .map(|(from, to)| (*from, (to - from).norm()))
            .collect();
        let length = rim.iter().map(|(_, length)| length).sum();
        let mut cone = Self {
            rim,
            apex,
            radius,
            area: 0.0,
            length,
        };
        cone.area = cone
            .triangles()
            .map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0)
            .sum();
        cone
    }

    /// The triangles, against the direction of the open edges that they close.
    fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        let next = self.rim.iter().cycle().skip(1);
        self.rim
            .iter()
            .zip(next)
            .map(|((from, _), (to, _))| [*to, *from, self.apex])
    }

    /// Adds the winding number at a point, half solid angles over 2π.
    fn add_to(&self, sum: &mut Sum, point: Vec3) {
        let seen = |p: Vec3| (p - point, (p - point).norm());
        let apex = seen(self.apex);
        let Some(&(first, _)) = self.rim.first() else {
            return;
        };
        let mut to = seen(first);
        let mut angle = HalfAngles::default();
        // Backwards along the rim, as the cone faces against the open edges.
        for &(from, length) in self.rim.iter().rev() {
            let from = seen(from);
            angle.add([to, from, apex]);
            // A point of the edge lies on both sides of the triangle inequality with its ends.
            let distance = ((from.1 + to.1 - length) / 2.0).max(0.0);
            sum.slope += length / (4.0 * PI * distance * distance);
            sum.distance = sum.distance.min(distance);
            to = from;
        }
        sum.winding += angle.total() / (2.0 * PI);
    }
}

/// A sum of half solid angles of triangles seen from the origin, positive where they are seen from inside.
///
/// van Oosterom & Strackee (1983, Eq. 8) give the tangent of each as a quotient; the two numbers are a direction in the plane,
/// and adding angles is multiplying directions as complex numbers. Counting the passages through ±π makes do with one arctangent in the end.
struct HalfAngles {
    cosine: f64,
    sine: f64,
    turns: f64,
}

impl Default for HalfAngles {
    fn default() -> Self {
        Self {
            cosine: 1.0,
            sine: 0.0,
            turns: 0.0,
        }
    }
}

impl HalfAngles {
    /// Adds a triangle, given by its corners and their distances from the origin.
    fn add(&mut self, [(a, la), (b, lb), (c, lc)]: [(Vec3, f64); 3]) {
        let sine = a.dot(&b.cross(&c));
        let cosine = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        let was_above = self.sine >= 0.0;
        let product = [
            self.cosine * cosine - self.sine * sine,
            self.cosine * sine + self.sine * cosine,
        ];
        let size = product[0].abs() + product[1].abs();
        if size <= 0.0 {
            // The origin is a corner of the triangle, where the solid angle has no value.
            return;
        }
        // Only the direction counts; its length is kept from running out of range.
        let scale = if (1e-100..1e100).contains(&size) {
            1.0
        } else {
            1.0 / size
        };
        (self.cosine, self.sine) = (product[0] * scale, product[1] * scale);
        let is_above = self.sine >= 0.0;
        if sine > 0.0 && was_above && !is_above {
            self.turns += 1.0;
        } else if sine < 0.0 && !was_above && is_above {
            self.turns -= 1.0;
        }
    }

    fn total(&self) -> f64 {
        self.sine.atan2(self.cosine) + 2.0 * PI * self.turns
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::mesh::tests::cube;
    use super::*;

    /// Winding number of a surface by the sum over all its triangles: the definition.
    pub(crate) fn direct(mesh: &Mesh, point: Vec3) -> f64 {
        mesh.corners().map(|t| half_angle(t.map(|p| p - point))).sum::<f64>() / (2.0 * PI)
    }

    fn half_angle(triangle: [Vec3; 3]) -> f64 {
        let mut sum = HalfAngles::default();
        sum.add(triangle.map(|p| (p, p.norm())));
        sum.total()
    }

    #[test]
    fn closed_cube_winds_once_inside_and_not_outside() {
        let cube = cube(Vec3::zeros());
        assert!((direct(&cube, Vec3::new(0.3, 0.6, 0.2)) - 1.0).abs() < 1e-12);
        assert!(direct(&cube, Vec3::new(1.3, 0.6, 0.2)).abs() < 1e-12);
    }

    #[test]
    fn surface_and_caps_wind_a_whole_number_of_times() {
        let mut open = cube(Vec3::zeros());
        // Half the face at x = 0 and the whole face at x = 1.
        open.triangles.drain(9..12);
        let caps = Caps::of(&open);
        assert_eq!((caps.cones.len(), caps.edges()), (2, 7));
        for point in [
            Vec3::new(0.4, 0.7, 0.3),
            Vec3::new(2.0, 0.2, 0.1),
            Vec3::new(-0.1, 0.5, 0.5),
        ] {
            let sum = direct(&open, point) + caps.sum(point, 0.0).winding;
            assert!((sum - sum.round()).abs() < 1e-12, "{point:?}: {sum}");
        }
    }

    #[test]
    fn inside_agrees_with_the_definition_everywhere() {
        let mut open = cube(Vec3::zeros());
        open.triangles.drain(2..4);
        let caps = Caps::of(&open);
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 40) as f64 / (1 << 24) as f64 * 4.0 - 1.5
        };
        for _ in 0..2000 {
            let point = Vec3::new(random(), random(), random());
            let whole = direct(&open, point) + caps.sum(point, 0.0).winding;
            let expected = direct(&open, point).abs() > 0.5;
            assert_eq!(caps.inside(whole.round() as i32, point).0, expected, "{point:?}");
        }
    }

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let octant = [Vec3::x(), Vec3::y(), Vec3::z()];
        assert!((half_angle(octant) / (2.0 * PI) - 0.125).abs() < 1e-15);
    }
}
