//! What works on the tissue: `[needle]` or `[ball]`, `[contact]`, `[stitch]`, `[thread]`, `[operator]`.

use sutura_controller::device::sim::BEARS;
use sutura_controller::effects::key;
use sutura_shared::scene::{self, Effect, KERNEL_PITCHES};
use toml::Spanned;

use super::{Keys, metres};
use crate::scene::file::{self, File, Number};
use crate::scene::needle::{self, KINDS, Needle};
use crate::scene::operator::{Draw, Operator, Sew, Touch};
use crate::scene::plan::Stitch;
use crate::scene::skill::{Manner, Person, Skill};
use crate::scene::source::Error;
use crate::scene::suture::{self, Suture};

/// Where a needle is held if the scene does not say: at the third next to its swage (BMC Med Educ 2021, table 3).
const GRASP: f64 = 1.0 / 3.0;

/// Fewest links of the controller's thread.
const LINKS_MIN: f64 = 2.0;
/// Most links of the controller's thread.
const LINKS_MAX: f64 = (sutura_controller::thread::NODES_MAX - 1) as f64;

impl Keys<'_> {
    pub(super) fn tool(&self, file: &File) -> Result<scene::Tool, Error> {
        match (&file.needle, &file.ball) {
            (Some(needle), None) => {
                let [arc, length_mm] = self.shape(needle)?;
                let radius_m = metres(length_mm / (arc * std::f64::consts::TAU));
                Ok(scene::Tool::Needle {
                    radius_m,
                    length_m: metres(length_mm),
                    grasp_m: metres(length_mm * self.grasp(needle.get_ref())?),
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

    /// Part of a circle and length [mm], by a needle's name or by themselves.
    fn shape(&self, needle: &Spanned<file::Needle>) -> Result<[f64; 2], Error> {
        let file::Needle {
            kind,
            arc_of_circle,
            length_mm,
            ..
        } = needle.get_ref();
        match (kind, arc_of_circle, length_mm) {
            (Some(name), None, None) => {
                let known = KINDS.iter().find(|kind| kind.name == name.get_ref());
                let kind = known.ok_or_else(|| {
                    let names = KINDS.map(|kind| kind.name).join(", ");
                    let what = format!("needle.kind = \"{}\": there are {names}", name.get_ref());
                    self.source.fault(name.span(), what)
                })?;
                Ok([kind.arc_of_circle, kind.length_mm])
            }
            (None, Some(arc), Some(length)) => Ok([
                self.source.number("needle.arc_of_circle", arc, [0.25, 0.75])?,
                self.source.number("needle.length_mm", length, [4.0, 80.0])?,
            ]),
            _ => Err(self.source.fault(
                needle.span(),
                "[needle] has either kind, or arc_of_circle and length_mm",
            )),
        }
    }

    /// Where the driver holds the needle: part of its length from the swage.
    fn grasp(&self, needle: &file::Needle) -> Result<f64, Error> {
        needle
            .grasp
            .as_ref()
            .map_or(Ok(GRASP), |grasp| self.source.number("needle.grasp", grasp, [0.1, 0.6]))
    }

    pub(super) fn contact(&self, file: &File) -> Result<scene::Contact, Error> {
        let contact = &file.contact;
        let pitch = *file.patch.pitch_mm.get_ref();
        Ok(scene::Contact {
            coupling_n_per_m: self.coupling(file)? as f32,
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

    /// Stiffness of the virtual coupling [N/m]: rendered, it is what the arm meets where the tissue does not give, as on bone.
    fn coupling(&self, file: &File) -> Result<f64, Error> {
        let coupling = &file.contact.coupling_n_per_m;
        let stiffness = self.source.number("contact.coupling_n_per_m", coupling, [1.0, 1e5])?;
        let scale = self.output(&file.output)?.scale;
        let most = (f64::from(BEARS) / f64::from(scale)).floor();
        if stiffness > most {
            let what = format!(
                "contact.coupling_n_per_m = {stiffness} at output.scale = {scale} is more than the device's friction and encoders bear: at most {most}"
            );
            return Err(self.source.fault(coupling.span(), what));
        }
        Ok(stiffness)
    }

    /// The punctures; none without effect `puncture`.
    pub(super) fn stitch(&self, file: &File) -> Result<Option<Stitch>, Error> {
        let Some(needle) = Needle::of(&self.tool(file)?) else {
            return Ok(None);
        };
        if !self.effects.has(Effect::Puncture) {
            return Ok(None);
        }
        let nothing = file::Stitch::default();
        let stitch = file.stitch.as_ref().map_or(&nothing, Spanned::get_ref);
        let half_gap = file
            .wound
            .as_ref()
            .map_or(0.0, |wound| *wound.get_ref().gap_mm.get_ref() / 2.0);
        let inside = file.patch.size_mm[0].get_ref() / 2.0 - file.patch.pitch_mm.get_ref();
        let [least, _] = key::BITE.range;
        let bite = self.own_within(&key::BITE, stitch.bite_mm.as_ref(), [least, inside - half_gap])?;
        self.reaches(file, &needle, [half_gap, bite])?;
        let (stitches, spacing_mm) = self.row(file, stitch)?;
        let f0 = |site: usize| match &stitch.f0_n {
            Some(f0) => self.source.number(key::F0.name, &f0[site], key::F0.range),
            None => self.default(&key::F0, site, key::F0.range),
        };
        let friction = self.own(&key::FRICTION, stitch.friction_n_per_mm.as_ref())?;
        Ok(Some(Stitch {
            bite_mm: bite,
            stitches,
            spacing_mm,
            f0_n: [f0(0)? as f32, f0(1)? as f32, f0(2)? as f32, f0(3)? as f32],
            under_m: metres(self.own(&key::UNDER, stitch.under_mm.as_ref())?),
            friction_n_per_m: (friction * 1e3) as f32,
            cutting_n: self.own(&key::CUTTING, stitch.cutting_n.as_ref())? as f32,
            tension_gain: self.own(&key::TENSION_GAIN, stitch.tension_gain.as_ref())? as f32,
        }))
    }

    /// How many stitches, and how far apart [mm].
    fn row(&self, file: &File, stitch: &file::Stitch) -> Result<(u8, f64), Error> {
        let span = |number: &Option<Number>| number.as_ref().map_or(0..0, Spanned::span);
        let asked = stitch.stitches.as_ref();
        let stitches = asked.map_or(Ok(1.0), |asked| {
            self.source.number(key::STITCHES.name, asked, key::STITCHES.range)
        })?;
        let fault = |at: &Option<Number>, what: String| Err(self.source.fault(span(at), what));
        if stitches.fract() != 0.0 {
            return fault(
                &stitch.stitches,
                format!("stitch.stitches = {stitches}: a whole number is right"),
            );
        }
        match &stitch.spacing_mm {
            None if stitches < 2.0 => Ok((1, 0.0)),
            Some(_) if stitches < 2.0 => fault(
                &stitch.spacing_mm,
                "stitch.spacing_mm is from one stitch to the next: stitch.stitches = 2 or 3 is right with it"
                    .to_owned(),
            ),
            _ if !self.effects.has(Effect::Thread) => fault(
                &stitch.stitches,
                format!("stitch.stitches = {stitches} needs effect thread, which joins them: add it or sew one stitch"),
            ),
            None => fault(
                &stitch.stitches,
                format!("stitch.stitches = {stitches} needs stitch.spacing_mm, from one to the next"),
            ),
            Some(spacing) => {
                let [least, _] = key::SPACING.range;
                let inside = *file.patch.size_mm[1].get_ref() - 2.0 * *file.patch.pitch_mm.get_ref();
                let wound = file.wound.as_ref();
                let long = wound.map_or(inside, |wound| *wound.get_ref().length_mm.get_ref());
                let most = long.min(inside) / (stitches - 1.0);
                let spacing = self.source.number(key::SPACING.name, spacing, [least, most])?;
                Ok((stitches as u8, spacing))
            }
        }
    }

    /// Refuses a bite that the needle cannot make at this gap, with the numbers and a needle that can.
    fn reaches(&self, file: &File, needle: &Needle, [half_gap, bite]: [f64; 2]) -> Result<(), Error> {
        let (half, widest) = (half_gap + bite, needle.widest_mm());
        if half <= widest {
            return Ok(());
        }
        let held = file.needle.as_ref().map(|needle| self.grasp(needle.get_ref()));
        let grasp = held.transpose()?.unwrap_or(GRASP);
        let depth = *file.patch.size_mm[2].get_ref() - file.patch.pitch_mm.get_ref();
        let remedy = match (needle::that_can(half, depth, grasp), widest - half_gap) {
            (Some(name), most) if most > 0.0 => format!("needle.kind = \"{name}\" can, or a bite of at most {most:.2}"),
            (Some(name), _) => format!("needle.kind = \"{name}\" can"),
            (None, most) if most > 0.0 => format!("a bite of at most {most:.2} is right"),
            (None, _) => "a narrower wound is right".to_owned(),
        };
        let what = format!(
            "stitch.bite_mm = {bite}: a gap of {:.2} mm and two such bites take {:.1} mm of needle from driver to tip with {} mm at either end for \
             the jaws; this one has {:.1} mm on R = {:.2} mm: {remedy}",
            2.0 * half_gap,
            needle.needed_mm(half),
            needle::JAWS_MM,
            needle.ahead_mm,
            needle.radius_mm,
        );
        let bite = file
            .stitch
            .as_ref()
            .and_then(|stitch| stitch.get_ref().bite_mm.as_ref());
        let at = bite.or(file
            .needle
            .as_ref()
            .and_then(|needle| needle.get_ref().length_mm.as_ref()));
        Err(self.source.fault(at.map_or(0..0, Spanned::span), what))
    }

    /// The thread; none without effect `thread`.
    pub(super) fn thread(&self, file: &File) -> Result<Option<scene::Thread>, Error> {
        if !self.effects.has(Effect::Thread) {
            return Ok(None);
        }
        let nothing = file::Thread::default();
        let thread = file.thread.as_ref().map_or(&nothing, Spanned::get_ref);
        let link = self.own(&key::LINK, thread.link_mm.as_ref())?;
        let length = self.own_within(
            &key::LENGTH,
            thread.length_mm.as_ref(),
            [LINKS_MIN * link, link * LINKS_MAX],
        )?;
        let [shortest, _] = key::LINK.range;
        // Whole links, as near as may be to what is asked for.
        let links = (length / link).round().min((length / shortest + 1e-6).floor());
        let suture = self.suture(thread)?;
        Ok(Some(scene::Thread {
            nodes: links as u16 + 1,
            link_m: metres(length / links),
            axial_n: suture.axial_n as f32,
            mass_kg_per_m: (suture.mass_mg_per_m * 1e-6) as f32,
            damping_per_s: self.own(&key::DAMPING, thread.damping_per_s.as_ref())? as f32,
            penalty_n_per_m: self.own(&key::THREAD_PENALTY, thread.penalty_n_per_m.as_ref())? as f32,
            friction: self.own(&key::THREAD_FRICTION, thread.friction.as_ref())? as f32,
            knot_hold_n: self.own(&key::KNOT_HOLD, thread.knot_hold_n.as_ref())? as f32,
            bending_n_m2: (suture.bending_nn_m2 * 1e-9) as f32,
        }))
    }

    /// Stiffness and mass, by a suture's name or by themselves; a bending stiffness that is given counts before that of the name.
    fn suture(&self, thread: &file::Thread) -> Result<Suture, Error> {
        let (axial, mass) = (&thread.axial_n, &thread.mass_mg_per_m);
        let bending = thread.bending_nn_m2.as_ref();
        let own = self.own(&key::BENDING, bending)?;
        match &thread.kind {
            Some(name) if axial.is_none() && mass.is_none() => {
                let named = suture::named(name.get_ref()).ok_or_else(|| {
                    let what = format!("thread.kind = \"{}\": right is {}", name.get_ref(), suture::names());
                    self.source.fault(name.span(), what)
                })?;
                let silent = bending.is_none() && self.effects.has(Effect::ThreadBending);
                Ok(Suture {
                    bending_nn_m2: if silent { named.bending_nn_m2 } else { own },
                    ..named
                })
            }
            Some(name) => Err(self
                .source
                .fault(name.span(), "[thread] has either kind, or axial_n and mass_mg_per_m")),
            None => Ok(Suture {
                axial_n: self.own(&key::AXIAL, axial.as_ref())?,
                mass_mg_per_m: self.own(&key::MASS, mass.as_ref())?,
                bending_nn_m2: own,
            }),
        }
    }

    pub(super) fn operator(&self, file: &File) -> Result<Operator, Error> {
        let number =
            |key: &str, value: &Number, allowed| self.source.number(&format!("operator.{key}"), value, allowed);
        let operator = &file.operator;
        let pierces = self.effects.has(Effect::Puncture);
        match (operator.get_ref(), &file.ball) {
            (file::Operator::Sew(sew), _) if pierces => Ok(Operator::Sew(Sew {
                approach_m_per_s: number("sew.approach_mm_per_s", &sew.approach_mm_per_s, [1.0, 500.0])? * 1e-3,
                insert_m_per_s: number("sew.insert_mm_per_s", &sew.insert_mm_per_s, [0.5, 100.0])? * 1e-3,
                drive_rad_per_s: number("sew.drive_deg_per_s", &sew.drive_deg_per_s, [1.0, 360.0])?.to_radians(),
                exit_rad_per_s: number("sew.exit_deg_per_s", &sew.exit_deg_per_s, [1.0, 360.0])?.to_radians(),
                draw: self.draw(sew)?,
                manner: self.person(file)?.map_or(Manner::SCRIPT, |person| person.manner()),
            })),
            (file::Operator::Touch(touch), Some(_)) if !pierces => Ok(Operator::Touch(Touch {
                approach_m_per_s: number("touch.approach_mm_per_s", &touch.approach_mm_per_s, [1.0, 500.0])? * 1e-3,
                push_m_per_s: number("touch.push_mm_per_s", &touch.push_mm_per_s, [0.5, 100.0])? * 1e-3,
                push_m: number("touch.push_mm", &touch.push_mm, [0.1, 20.0])? * 1e-3,
                drag_m: number("touch.drag_mm", &touch.drag_mm, [0.0, 20.0])? * 1e-3,
            })),
            (file::Operator::Sew(_), _) => Err(self.needs(operator.span(), "[operator.sew]", Effect::Puncture)),
            (file::Operator::Touch(_), _) => Err(self
                .source
                .fault(operator.span(), "[operator.touch] needs [ball], and no effect puncture")),
        }
    }

    /// Whose hand sews.
    pub(super) fn person(&self, file: &File) -> Result<Option<Person>, Error> {
        let Some(section) = &file.skill else { return Ok(None) };
        if !self.effects.has(Effect::Puncture) {
            return Err(self.needs(section.span(), "section [skill]", Effect::Puncture));
        }
        let file::Skill { name, seed } = section.get_ref();
        let fault = |error| {
            self.source
                .fault(name.span(), format!("skill.name = \"{}\": {error}", name.get_ref()))
        };
        let skill = Skill::named(name.get_ref()).map_err(fault)?;
        Ok(Some(Person { skill, seed: *seed }))
    }

    /// What the hand does with a thread; nothing without effect `thread`.
    fn draw(&self, sew: &file::Sew) -> Result<Option<Draw>, Error> {
        let draw = Draw {
            pull_m_per_s: self.own(&key::PULL, sew.pull_mm_per_s.as_ref())? * 1e-3,
            tighten_m_per_s: self.own(&key::TIGHTEN, sew.tighten_mm_per_s.as_ref())? * 1e-3,
            tension_n: self.own(&key::TENSION, sew.tension_n.as_ref())?,
        };
        Ok(Some(draw).filter(|_| self.effects.has(Effect::Thread)))
    }
}
