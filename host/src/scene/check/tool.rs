//! What works on the tissue: `[needle]` or `[ball]`, `[contact]`, `[stitch]`, `[thread]`, `[operator]`.

use sutura_shared::scene::{self, Effect, KERNEL_PITCHES};
use toml::Spanned;

use super::{Keys, metres};
use crate::scene::file::{self, File, Number};
use crate::scene::operator::{Operator, Sew, Touch};
use crate::scene::plan::Stitch;
use crate::scene::source::Error;

/// Half the distance of the punctures over the needle's radius, at most: beyond it the needle meets the skin too flat.
const WIDEST: f64 = 0.95;

/// Shortest link of the controller's thread [mm]: its eyelet has room for one node at a time.
const LINK_MM: f64 = 2.0;
/// Fewest links of the controller's thread.
const LINKS_MIN: f64 = 2.0;
/// Most links of the controller's thread.
const LINKS_MAX: f64 = (sutura_controller::thread::NODES_MAX - 1) as f64;

impl Keys<'_> {
    pub(super) fn tool(&self, file: &File) -> Result<scene::Tool, Error> {
        match (&file.needle, &file.ball) {
            (Some(needle), None) => {
                let needle = needle.get_ref();
                let arc = self
                    .source
                    .number("needle.arc_of_circle", &needle.arc_of_circle, [0.25, 0.75])?;
                let length_mm = self.source.number("needle.length_mm", &needle.length_mm, [4.0, 80.0])?;
                let radius_m = metres(length_mm / (arc * std::f64::consts::TAU));
                Ok(scene::Tool::Needle {
                    radius_m,
                    length_m: metres(length_mm),
                })
            }
            (None, Some(ball)) => {
                let ball = ball.get_ref();
                Ok(scene::Tool::Ball {
                    radius_m: metres(self.source.number("ball.radius_mm", &ball.radius_mm, [0.1, 20.0])?),
                })
            }
            (Some(needle), Some(_)) => Err(self
                .source
                .fault(needle.span(), "[needle] and [ball]: the hand holds one of them")),
            (None, None) => Err(self.source.fault(
                0..0,
                "section [needle] or [ball] is missing: the hand holds one of them",
            )),
        }
    }

    pub(super) fn contact(&self, file: &File) -> Result<scene::Contact, Error> {
        let contact = &file.contact;
        let pitch = *file.patch.pitch_mm.get_ref();
        Ok(scene::Contact {
            coupling_n_per_m: self
                .source
                .number("contact.coupling_n_per_m", &contact.coupling_n_per_m, [1.0, 1e5])?
                as f32,
            coupling_n_s_per_m: self.source.number(
                "contact.coupling_n_s_per_m",
                &contact.coupling_n_s_per_m,
                [0.0, 100.0],
            )? as f32,
            kernel_m: metres(self.source.number(
                "contact.kernel_mm",
                &contact.kernel_mm,
                KERNEL_PITCHES.map(|pitches| f64::from(pitches) * pitch),
            )?),
        })
    }

    pub(super) fn stitch(&self, stitch: &file::Stitch, file: &File) -> Result<Stitch, Error> {
        let half_gap = file
            .wound
            .as_ref()
            .map_or(0.0, |wound| *wound.get_ref().gap_mm.get_ref() / 2.0);
        let inside = file.patch.size_mm[0].get_ref() / 2.0 - file.patch.pitch_mm.get_ref();
        let reach = match self.tool(file)? {
            scene::Tool::Needle { radius_m, .. } => f64::from(radius_m) * 1e3 * WIDEST,
            scene::Tool::Ball { .. } => {
                return Err(self
                    .source
                    .fault(0..0, "section [needle] is missing: [stitch] needs it"));
            }
        };
        let [left, right] = &stitch.f0_n;
        let f0 = |value| {
            self.source
                .number("stitch.f0_n", value, [0.05, 20.0])
                .map(|f0| f0 as f32)
        };
        let friction = self.gated(
            "stitch.friction_n_per_mm",
            &stitch.friction_n_per_mm,
            Effect::ShaftFriction,
            [0.0, 1.0],
        )?;
        Ok(Stitch {
            bite_mm: self
                .source
                .number("stitch.bite_mm", &stitch.bite_mm, [0.5, reach.min(inside) - half_gap])?,
            f0_n: [f0(left)?, f0(right)?],
            under_m: metres(self.source.number("stitch.under_mm", &stitch.under_mm, [0.1, 20.0])?),
            friction_n_per_m: (friction * 1e3) as f32,
            cutting_n: self.gated("stitch.cutting_n", &stitch.cutting_n, Effect::ShaftFriction, [0.0, 5.0])? as f32,
        })
    }

    pub(super) fn thread(&self, thread: &Spanned<file::Thread>) -> Result<scene::Thread, Error> {
        let thread = thread.get_ref();
        let link = self.source.number("thread.link_mm", &thread.link_mm, [LINK_MM, 20.0])?;
        let length = self.source.number(
            "thread.length_mm",
            &thread.length_mm,
            [LINKS_MIN * link, link * LINKS_MAX],
        )?;
        let penalty = self.gated(
            "thread.penalty_n_per_m",
            &thread.penalty_n_per_m,
            Effect::ThreadContact,
            [1.0, 1e5],
        )?;
        // Whole links, as near as may be to what is asked for.
        let links = (length / link).round().min((length / LINK_MM + 1e-6).floor());
        Ok(scene::Thread {
            nodes: links as u16 + 1,
            link_m: metres(length / links),
            axial_n: self.source.number("thread.axial_n", &thread.axial_n, [0.1, 1000.0])? as f32,
            mass_kg_per_m: (self
                .source
                .number("thread.mass_mg_per_m", &thread.mass_mg_per_m, [1.0, 1e4])?
                * 1e-6) as f32,
            damping_per_s: self
                .source
                .number("thread.damping_per_s", &thread.damping_per_s, [0.0, 1000.0])?
                as f32,
            penalty_n_per_m: penalty as f32,
        })
    }
    pub(super) fn operator(&self, file: &File) -> Result<Operator, Error> {
        let number =
            |key: &str, value: &Number, allowed| self.source.number(&format!("operator.{key}"), value, allowed);
        let operator = &file.operator;
        match (operator.get_ref(), &file.needle, &file.stitch, &file.thread) {
            (file::Operator::Sew(sew), Some(_), Some(_), Some(_)) => Ok(Operator::Sew(Sew {
                approach_m_per_s: number("sew.approach_mm_per_s", &sew.approach_mm_per_s, [1.0, 500.0])? * 1e-3,
                insert_m_per_s: number("sew.insert_mm_per_s", &sew.insert_mm_per_s, [0.5, 100.0])? * 1e-3,
                drive_rad_per_s: number("sew.drive_deg_per_s", &sew.drive_deg_per_s, [1.0, 360.0])?.to_radians(),
                exit_rad_per_s: number("sew.exit_deg_per_s", &sew.exit_deg_per_s, [1.0, 360.0])?.to_radians(),
                pull_m_per_s: number("sew.pull_mm_per_s", &sew.pull_mm_per_s, [1.0, 500.0])? * 1e-3,
                tighten_m_per_s: number("sew.tighten_mm_per_s", &sew.tighten_mm_per_s, [0.5, 100.0])? * 1e-3,
                tension_n: number("sew.tension_n", &sew.tension_n, [0.05, 10.0])?,
            })),
            (file::Operator::Touch(touch), None, None, None) => Ok(Operator::Touch(Touch {
                approach_m_per_s: number("touch.approach_mm_per_s", &touch.approach_mm_per_s, [1.0, 500.0])? * 1e-3,
                push_m_per_s: number("touch.push_mm_per_s", &touch.push_mm_per_s, [0.5, 100.0])? * 1e-3,
                push_m: number("touch.push_mm", &touch.push_mm, [0.1, 20.0])? * 1e-3,
                drag_m: number("touch.drag_mm", &touch.drag_mm, [0.0, 20.0])? * 1e-3,
            })),
            (file::Operator::Sew(_), ..) => Err(self
                .source
                .fault(operator.span(), "[operator.sew] needs [needle], [stitch] and [thread]")),
            (file::Operator::Touch(_), ..) => Err(self.source.fault(
                operator.span(),
                "[operator.touch] needs [ball], and no [stitch] or [thread]",
            )),
        }
    }
}
