//! The patch frame: z along the mean outward skin normal at the wound's middle, x across the wound, y along it, origin on the skin.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

use super::Vec3;
use super::mesh::Mesh;

/// Where the wound's middle is and how it lies, in the frame of the meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// A point on the skin or near it [mm].
    pub point: Vec3,
    /// Outward normal, of any length; without it the mean normal of the skin within `radius_mm` is taken.
    pub normal: Option<Vec3>,
    /// Direction of the wound, of any length; its part along the skin counts.
    pub along: Vec3,
    /// How far around the point the skin's normal is averaged [mm].
    pub radius_mm: f64,
}

/// How far from the skin a site may be given [mm].
pub const OFF_SKIN_MM_MAX: f64 = 5.0;

/// Why a site has no frame.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// Too far from every surface.
    #[error("site ({:.1}, {:.1}, {:.1}) mm is {distance_mm:.1} mm from the nearest surface, at most {OFF_SKIN_MM_MAX} mm are allowed: the nearest point is ({:.1}, {:.1}, {:.1})", site[0], site[1], site[2], nearest[0], nearest[1], nearest[2])]
    OffSkin {
        /// The site [mm].
        site: [f64; 3],
        /// Nearest point of the surface [mm].
        nearest: [f64; 3],
        /// How far that is [mm].
        distance_mm: f64,
    },
    /// No length, or along the normal.
    #[error("wound direction ({:.3}, {:.3}, {:.3}) does not lie along the skin, whose normal there is ({:.3}, {:.3}, {:.3})", along[0], along[1], along[2], normal[0], normal[1], normal[2])]
    Direction {
        /// The direction.
        along: [f64; 3],
        /// The normal.
        normal: [f64; 3],
    },
    /// A given normal of no length, or triangles that face each other.
    #[error("site ({:.1}, {:.1}, {:.1}) mm has no outward normal: give one that is not zero", site[0], site[1], site[2])]
    Normal {
        /// The site [mm].
        site: [f64; 3],
    },
}

/// The rigid motion `patch_from_world` [mm] of a site on a skin.
///
/// # Errors
/// The site is off the skin, or has no normal or no direction.
pub fn patch_from_world(skin: &Mesh, site: &Site) -> Result<Isometry3<f64>, FrameError> {
    let (nearest, facing) = nearest(skin, site.point);
    let distance_mm = (nearest - site.point).norm();
    // So that a distance that is no number is refused as well.
    let is_near = distance_mm <= OFF_SKIN_MM_MAX;
    if !is_near {
        return Err(FrameError::OffSkin {
            site: site.point.into(),
            nearest: nearest.into(),
            distance_mm,
        });
    }
    let outwards = if skin.signed_volume() < 0.0 { -1.0 } else { 1.0 };
    let normal = site
        .normal
        .unwrap_or_else(|| mean_normal(skin, nearest, facing, site.radius_mm) * outwards);
    let Some(z) = normal.try_normalize(0.0) else {
        return Err(FrameError::Normal {
            site: site.point.into(),
        });
    };
    let along = site.along.try_normalize(0.0).unwrap_or_default();
    // A direction within a thousandth of the normal is a mistake, not a wound.
    let Some(y) = (along - z * along.dot(&z)).try_normalize(1e-3) else {
        return Err(FrameError::Direction {
            along: site.along.into(),
            normal: z.into(),
        });
    };
    let rows = Matrix3::from_rows(&[y.cross(&z).transpose(), y.transpose(), z.transpose()]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows));
    Ok(Isometry3::from_parts(
        Translation3::from(-(rotation * nearest)),
        rotation,
    ))
}

/// The nearest point of a surface, and the doubled area vector of its triangle.
fn nearest(mesh: &Mesh, point: Vec3) -> (Vec3, Vec3) {
    let start = (Vec3::repeat(f64::INFINITY), Vec3::zeros(), f64::INFINITY);
    let (nearest, facing, _) = mesh.corners().fold(start, |best, triangle| {
        let candidate = nearest_on_triangle(&triangle, point);
        let distance = (candidate - point).norm_squared();
        if distance < best.2 {
            (candidate, area_vector(&triangle), distance)
        } else {
            best
        }
    });
    (nearest, facing)
}

fn area_vector([a, b, c]: &[Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// Mean normal by area of the triangles around a point; those that face against `facing` belong to another side of the tissue.
fn mean_normal(mesh: &Mesh, point: Vec3, facing: Vec3, radius: f64) -> Vec3 {
    let near = |[a, b, c]: &[Vec3; 3]| ((a + b + c) / 3.0 - point).norm() <= radius;
    let sum: Vec3 = mesh
        .corners()
        .filter(near)
        .map(|t| area_vector(&t))
        .filter(|area| area.dot(&facing) > 0.0)
        .sum();
    // Triangles larger than the radius have their middle outside of it.
    if sum == Vec3::zeros() { facing } else { sum }
}

/// The nearest point of a triangle: within it, or on the nearest edge.
fn nearest_on_triangle(triangle: &[Vec3; 3], point: Vec3) -> Vec3 {
    let [a, b, c] = *triangle;
    let normal = area_vector(triangle);
    let size = normal.norm_squared();
    let within = |from: Vec3, to: Vec3| (to - from).cross(&(point - from)).dot(&normal) >= 0.0;
    if size > 0.0 && within(a, b) && within(b, c) && within(c, a) {
        return point - normal * ((point - a).dot(&normal) / size);
    }
    let on_edge = |from: Vec3, to: Vec3| {
        let edge = to - from;
        let part = (point - from).dot(&edge) / edge.norm_squared().max(f64::MIN_POSITIVE);
        from + edge * part.clamp(0.0, 1.0)
    };
    let distance = |p: &Vec3| (p - point).norm_squared();
    [on_edge(a, b), on_edge(b, c), on_edge(c, a)]
        .into_iter()
        .min_by(|p, q| distance(p).total_cmp(&distance(q)))
        .unwrap_or(a)
}

#[cfg(test)]
mod tests {
    use super::super::mesh::tests::cube;
    use super::*;

    fn site(point: Vec3) -> Site {
        Site {
            point,
            normal: None,
            along: Vec3::new(0.2, 1.0, 0.7),
            radius_mm: 0.4,
        }
    }

    #[test]
    fn frame_of_a_cube_face_is_right_handed_and_upright() {
        let cube = cube(Vec3::zeros());
        let frame = patch_from_world(&cube, &site(Vec3::new(1.1, 0.5, 0.4))).unwrap();
        // The face x = 1 looks along +x; the wound lies along the part of its direction within the face.
        let along = Vec3::new(0.0, 1.0, 0.7).normalize();
        assert!((frame.rotation * Vec3::x() - Vec3::z()).norm() < 1e-12);
        assert!((frame.rotation * along - Vec3::y()).norm() < 1e-12);
        assert!((frame.rotation * along.cross(&Vec3::x()) - Vec3::x()).norm() < 1e-12);
        assert!((frame * nalgebra::Point3::new(1.0, 0.5, 0.4)).coords.norm() < 1e-12);
    }

    #[test]
    fn an_inverted_skin_gives_the_same_frame() {
        let (outward, mut inward) = (cube(Vec3::zeros()), cube(Vec3::zeros()));
        inward.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let site = site(Vec3::new(0.3, 0.6, 1.0));
        let difference = patch_from_world(&outward, &site).unwrap().to_homogeneous()
            - patch_from_world(&inward, &site).unwrap().to_homogeneous();
        assert!(difference.norm() < 1e-12);
    }

    #[test]
    fn a_site_off_the_skin_or_a_wound_along_the_normal_is_refused() {
        let cube = cube(Vec3::zeros());
        let far = patch_from_world(&cube, &site(Vec3::new(9.0, 0.5, 0.5)));
        assert!(matches!(far, Err(FrameError::OffSkin { distance_mm, .. }) if (distance_mm - 8.0).abs() < 1e-12));
        let stabbed = Site {
            along: Vec3::x(),
            ..site(Vec3::new(1.0, 0.5, 0.5))
        };
        assert!(matches!(
            patch_from_world(&cube, &stabbed),
            Err(FrameError::Direction { .. })
        ));
        let flat = Site {
            normal: Some(Vec3::zeros()),
            ..site(Vec3::new(1.0, 0.5, 0.5))
        };
        assert!(matches!(patch_from_world(&cube, &flat), Err(FrameError::Normal { .. })));
    }
}
