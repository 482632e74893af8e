//! The needle's way: a turn about the centre of the circle through its punctures (Lian & Chen Fig. 11).

use std::f32::consts::{FRAC_PI_2, PI};

use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_shared::scene::{Scene, Tool};

/// The circle, patch frame; angles run from x towards z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Circle {
    centre: Vec3,
    radius: f32,
    /// From the grasp to the tip [rad].
    ahead: f32,
    /// Where the tip is at the puncture a [rad].
    entry: f32,
}

impl Circle {
    /// That of a scene's needle through its punctures; skin is at z = 0.
    pub(super) fn of(scene: &Scene) -> Self {
        let half = scene.stitch.map_or(0.0, |stitch| -stitch.a_m[0]);
        Self::through(scene, [-half, half])
    }

    /// That of a scene's needle through two places of the skin, given by x [m].
    pub(super) fn through(scene: &Scene, [from, to]: [f32; 2]) -> Self {
        let half = 0.5 * (to - from);
        let (radius, ahead) = match scene.tool {
            Tool::Needle {
                radius_m,
                length_m,
                grasp_m,
            } => (radius_m, length_m - grasp_m),
            Tool::Ball { radius_m } => (radius_m, 0.0),
        };
        Self {
            centre: Vec3::new(0.5 * (from + to), 0.0, (radius * radius - half * half).max(0.0).sqrt()),
            radius,
            ahead: ahead / radius,
            entry: PI + (half / radius).acos(),
        }
    }

    /// The same at another y of the skin [m].
    pub(super) fn beside(&self, y: f32) -> Self {
        Self {
            centre: Vec3::new(self.centre.x, y, self.centre.z),
            ..*self
        }
    }

    /// Turn that takes the tip along by `way` [rad].
    pub(super) fn turn(&self, way: f32) -> f32 {
        way / self.radius
    }

    /// The needle with its tip `turned` beyond the puncture a [rad].
    pub(super) fn at(&self, turned: f32) -> Pose {
        let direction = |angle: f32| Vec3::new(angle.cos(), 0.0, angle.sin());
        let grasp = self.entry + turned - self.ahead;
        let (out, on) = (direction(grasp), direction(grasp + FRAC_PI_2));
        Pose {
            position: self.centre + out * self.radius,
            rotation: Mat3::from_columns(&[out, on, -Vec3::y()]),
        }
    }
}
