//! The needle's arc in its plane xoy (Lian & Chen Fig. 11): centre o, radius R, held by a driver between swage and tip.

use crate::math::{Pose, Vec3};
use core::f32::consts::TAU;
use sutura_shared::scene::Tool;

/// A tool in space. A ball is an arc of no length whose tip is its lowest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Tool pose: grasp point and axes, patch frame.
    pub pose: Pose,
    /// Radius R [m].
    radius: f32,
    /// Arc length from tip to swage [m].
    pub length: f32,
    /// Arc length from the grasp point to the tip [m].
    ahead: f32,
    /// Radius of a ball tip [m].
    ball: f32,
}

/// The point of the arc nearest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The point, patch frame [m].
    pub point: Vec3,
    /// Tangent t towards the tip, unit length.
    pub tangent: Vec3,
    /// Arc length from the tip [m]: negative before the tip, more than the needle's behind the swage.
    pub from_tip: f32,
}

impl Arc {
    /// The tool at `pose`, grasp point at angle 0.
    #[must_use]
    pub fn new(tool: Tool, pose: Pose) -> Self {
        match tool {
            Tool::Ball { radius_m } => Self {
                pose,
                radius: 0.0,
                length: 0.0,
                ahead: 0.0,
                ball: radius_m,
            },
            Tool::Needle {
                radius_m,
                length_m,
                grasp_m,
            } => Self {
                pose,
                radius: radius_m,
                length: length_m,
                ahead: length_m - grasp_m,
                ball: 0.0,
            },
        }
    }

    /// The tool moved by `way`.
    #[must_use]
    pub fn shifted(&self, way: Vec3) -> Self {
        let position = self.pose.position + way;
        Self {
            pose: Pose { position, ..self.pose },
            ..*self
        }
    }

    /// Angle of the tip about the centre, from the grasp point [rad].
    fn tip_angle(&self) -> f32 {
        if self.radius > 0.0 {
            self.ahead / self.radius
        } else {
            0.0
        }
    }

    /// Centre o, patch frame [m].
    #[must_use]
    pub fn centre(&self) -> Vec3 {
        self.pose.position - self.pose.rotation.column(0) * self.radius
    }

    /// Point and forward tangent at `angle` from the grasp point.
    fn at(&self, angle: f32) -> (Vec3, Vec3) {
        let (sin, cos) = libm::sincosf(angle);
        let (x, y) = (self.pose.rotation.column(0), self.pose.rotation.column(1));
        (self.centre() + (x * cos + y * sin) * self.radius, y * cos - x * sin)
    }

    /// Tip and its direction of advance; a ball advances into the tissue, against z.
    #[must_use]
    pub fn tip(&self) -> (Vec3, Vec3) {
        if self.radius > 0.0 {
            self.at(self.tip_angle())
        } else {
            (self.pose.position - Vec3::z() * self.ball, -Vec3::z())
        }
    }

    /// Where the thread is swaged on [m].
    #[must_use]
    pub fn swage(&self) -> Vec3 {
        self.end().0
    }

    /// The swage and the needle's forward tangent there; the tangent is zero for a ball.
    #[must_use]
    pub fn end(&self) -> (Vec3, Vec3) {
        if self.radius > 0.0 {
            self.at(self.tip_angle() - self.length / self.radius)
        } else {
            (self.pose.position, Vec3::zeros())
        }
    }

    /// The point of the whole circle nearest to `p`, its arc length counted from the tip.
    #[must_use]
    pub fn nearest(&self, p: Vec3) -> Nearest {
        let d = p - self.centre();
        let angle = libm::atan2f(
            d.dot(&self.pose.rotation.column(1)),
            d.dot(&self.pose.rotation.column(0)),
        );
        // The open part of the circle is split in the middle between what lies before the tip and what lies behind the swage.
        let open = TAU - self.length / self.radius.max(1e-9);
        let ahead = self.tip_angle() - angle;
        let ahead = if ahead < -0.5 * open {
            ahead + TAU
        } else if ahead > TAU - 0.5 * open {
            ahead - TAU
        } else {
            ahead
        };
        let (point, tangent) = self.at(angle);
        Nearest {
            point,
            tangent,
            from_tip: ahead * self.radius,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{length, rotation};

    /// A half circle of 26 mm, R = L/π.
    fn needle() -> Arc {
        let tool = Tool::Needle {
            radius_m: 0.026 / core::f32::consts::PI,
            length_m: 0.026,
            grasp_m: 0.026 / 3.0,
        };
        let pose = Pose {
            position: Vec3::new(0.01, -0.02, 0.005),
            rotation: rotation(Vec3::new(0.6, 0.0, 0.8), 0.7),
        };
        Arc::new(tool, pose)
    }

    #[test]
    fn tip_and_swage_are_a_diameter_apart() {
        let arc = needle();
        assert!((length(arc.tip().0 - arc.swage()) - 2.0 * 0.026 / core::f32::consts::PI).abs() < 1e-7);
        assert!((arc.nearest(arc.swage()).from_tip - 0.026).abs() < 1e-6);
        assert!(arc.nearest(arc.tip().0).from_tip.abs() < 1e-6);
        assert!((arc.nearest(arc.pose.position).from_tip - 0.026 * 2.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn the_ends_of_a_quarter_and_of_three_quarters_of_a_circle_are_told_apart() {
        for part in [0.25, 0.75] {
            let radius_m = 0.008;
            let length_m = part * TAU * radius_m;
            let tool = Tool::Needle {
                radius_m,
                length_m,
                grasp_m: 0.25 * length_m,
            };
            let arc = Arc::new(tool, Pose::default());
            for (from_tip, expected) in [(-5e-4, -5e-4), (5e-4, 5e-4), (length_m + 5e-4, length_m + 5e-4)] {
                let p = arc.at(arc.tip_angle() - from_tip / radius_m).0;
                assert!((arc.nearest(p).from_tip - expected).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn the_nearest_point_is_across_the_tangent() {
        let arc = needle();
        let p = arc.pose.position + Vec3::new(1e-3, 5e-4, -2e-3);
        let near = arc.nearest(p);
        assert!((p - near.point).dot(&near.tangent).abs() < 1e-8);
    }

    #[test]
    fn beyond_the_tip_is_negative_and_behind_the_swage_is_more_than_the_length() {
        let arc = needle();
        let (tip, t) = arc.tip();
        assert!(arc.nearest(tip + t * 1e-3).from_tip < 0.0);
        let behind = arc.at(arc.tip_angle() - 0.027 / arc.radius).0;
        assert!(arc.nearest(behind).from_tip > 0.026);
    }
}
