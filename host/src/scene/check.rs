//! From a scene file's keys to checked quantities in SI units: the only place that knows allowed ranges and which key needs which effect.

use sutura_shared::scene::{self, Body, Effect, Effects, SEGMENTS_MAX, Segment, Solver, TISSUES_MAX};
use toml::Spanned;

use super::file::{self, File, Number};
use super::operator::{Operator, Sew, Touch};
use super::plan::{Hand, Patch, Plan, Stitch, Tissue, Wound};
use super::source::{Error, Source};

/// Half the distance of the punctures over the needle's radius, at most: beyond it the needle meets the skin too flat.
const WIDEST: f64 = 0.95;

/// Checks a file.
///
/// # Errors
/// The first thing wrong: with line, key, value and what would be right.
pub fn check(source: &Source, file: &File) -> Result<Plan, Error> {
    let keys = Keys {
        source,
        effects: effects(source, &file.effects)?,
    };
    keys.sections(file)?;
    Ok(Plan {
        effects: keys.effects,
        solver: solver(source, &file.solver)?,
        phantom: file.phantom.as_ref().map(|phantom| *phantom.get_ref()),
        patch: keys.patch(file)?,
        tissues: keys.tissues(file)?,
        wound: file
            .wound
            .as_ref()
            .map(|wound| keys.wound(wound.get_ref(), file))
            .transpose()?,
        tool: keys.tool(file)?,
        contact: keys.contact(file)?,
        stitch: file
            .stitch
            .as_ref()
            .map(|stitch| keys.stitch(stitch.get_ref(), file))
            .transpose()?,
        thread: file.thread.as_ref().map(|thread| keys.thread(thread)).transpose()?,
        output: keys.output(&file.output)?,
        profile: file.device.profile,
        hand: keys.hand(&file.hand)?,
        operator: keys.operator(file)?,
    })
}

fn effects(source: &Source, names: &[Spanned<String>]) -> Result<Effects, Error> {
    let mut effects = Effects::default();
    for name in names {
        let Some(effect) = Effect::ALL.into_iter().find(|effect| effect.name() == name.get_ref()) else {
            let known = Effect::ALL.map(Effect::name).join(", ");
            return Err(source.fault(
                name.span(),
                format!("effects: no effect `{}`; there are {known}", name.get_ref()),
            ));
        };
        if effects.has(effect) {
            return Err(source.fault(
                name.span(),
                format!("effects: `{}` stands twice; once is enough", effect.name()),
            ));
        }
        effects = effects.with(effect);
    }
    for name in names {
        let needs = match name.get_ref().as_str() {
            "gravity" | "thread-contact" => Effect::Thread,
            "thread" | "shaft-friction" => Effect::Puncture,
            _ => continue,
        };
        if !effects.has(needs) {
            let what = format!(
                "effects: `{}` changes nothing without effect `{}`",
                name.get_ref(),
                needs.name()
            );
            return Err(source.fault(name.span(), what));
        }
    }
    Ok(effects)
}

fn solver(source: &Source, text: &Spanned<String>) -> Result<Solver, Error> {
    let fault = |what: &str| Err(source.fault(text.span(), format!("solver = \"{}\": {what}", text.get_ref())));
    let mut parts = text.get_ref().split(':');
    if parts.next() != Some("be-pcg") {
        return fault("there is be-pcg[:iterations[:newton]], such as \"be-pcg:10:1\"");
    }
    let mut count = |default: u16, most: u16| match parts.next() {
        None => Some(default),
        Some(part) => part.parse().ok().filter(|count| (1..=most).contains(count)),
    };
    let (iterations, newton) = (count(10, 200), count(1, 8));
    match (iterations, newton, parts.next()) {
        (Some(iterations), Some(newton), None) => Ok(Solver::BePcg { iterations, newton }),
        _ => fault("be-pcg[:iterations[:newton]] takes 1 to 200 iterations and 1 to 8 Newton steps"),
    }
}

/// The keys of one file and the effects that say which of them may stand.
struct Keys<'a> {
    source: &'a Source,
    effects: Effects,
}

impl Keys<'_> {
    /// Sections that an effect or another section needs, or refuses.
    fn sections(&self, file: &File) -> Result<(), Error> {
        let pairs = [
            ("stitch", Effect::Puncture, file.stitch.as_ref().map(Spanned::span)),
            ("thread", Effect::Thread, file.thread.as_ref().map(Spanned::span)),
        ];
        for (section, effect, span) in pairs {
            match (self.effects.has(effect), span) {
                (false, Some(span)) => return Err(self.needs(span, &format!("section [{section}]"), effect)),
                (true, None) => return Err(self.lacks(&format!("section [{section}]"), effect)),
                _ => {}
            }
        }
        let wounded = [Effect::Puncture, Effect::WoundContact];
        match (
            &file.wound,
            wounded.into_iter().find(|&effect| self.effects.has(effect)),
        ) {
            (None, Some(effect)) => Err(self.lacks("section [wound]", effect)),
            _ => Ok(()),
        }
    }

    fn patch(&self, file: &File) -> Result<Patch, Error> {
        let patch = &file.patch;
        let [x, y, z] = &patch.size_mm;
        let size = |value| self.source.number("patch.size_mm", value, [1.0, 1000.0]);
        let beta = self.gated(
            "patch.spring_damping_ms",
            &patch.spring_damping_ms,
            Effect::SpringDamping,
            [0.01, 100.0],
        )?;
        if let (None, None) = (&file.phantom, &patch.site_mm) {
            return Err(self.source.fault(
                patch.pitch_mm.span(),
                "key patch.site_mm is missing: a point on the skin, in the meshes' frame",
            ));
        }
        if let Some(normal) = &patch.normal {
            let length = normal.get_ref().iter().map(|n| n * n).sum::<f64>().sqrt();
            if !(0.5..=2.0).contains(&length) {
                let what = format!("patch.normal has length {length}; a direction of about unit length is needed");
                return Err(self.source.fault(normal.span(), what));
            }
        }
        Ok(Patch {
            size_mm: [size(x)?, size(y)?, size(z)?],
            pitch_mm: self.source.number("patch.pitch_mm", &patch.pitch_mm, [0.1, 20.0])?,
            site_mm: patch.site_mm.as_ref().map(|site| *site.get_ref()),
            normal: patch.normal.as_ref().map(|normal| *normal.get_ref()),
            law: patch.law,
            damping_per_s: self
                .source
                .number("patch.damping_per_s", &patch.damping_per_s, [0.0, 1000.0])? as f32,
            spring_damping_s: metres(beta),
        })
    }

    fn tissues(&self, file: &File) -> Result<Vec<Tissue>, Error> {
        if let Some(extra) = file.tissue.get(TISSUES_MAX) {
            return Err(self.source.fault(
                extra.span(),
                format!("{} tissues: at most {TISSUES_MAX}", file.tissue.len()),
            ));
        }
        let mut tissues: Vec<Tissue> = Vec::new();
        for entry in &file.tissue {
            let tissue = entry.get_ref();
            let name = tissue.name.get_ref();
            if tissues.iter().any(|known| known.name == *name) {
                return Err(self
                    .source
                    .fault(tissue.name.span(), format!("tissue `{name}` stands twice")));
            }
            match (&file.phantom, &tissue.mesh) {
                (Some(_), Some(mesh)) => {
                    let what =
                        format!("tissue {name}: key mesh changes nothing beside key phantom; remove one of them");
                    return Err(self.source.fault(mesh.span(), what));
                }
                (None, None) => {
                    let what =
                        format!("tissue {name}: key mesh is missing, such as mesh = {{ path = \"{name}.stl\" }}");
                    return Err(self.source.fault(entry.span(), what));
                }
                _ => {}
            }
            tissues.push(Tissue {
                name: name.clone(),
                body: self.body(entry, *file.patch.pitch_mm.get_ref())?,
                mesh: tissue.mesh.as_ref().map(|mesh| mesh.get_ref().clone()),
            });
        }
        Ok(tissues)
    }

    fn body(&self, entry: &Spanned<file::Tissue>, pitch_mm: f64) -> Result<scene::Tissue, Error> {
        let tissue = entry.get_ref();
        let name = tissue.name.get_ref();
        if *tissue.body.get_ref() == file::Body::Fixed {
            let soft = [
                tissue.density_kg_m3.as_ref().map(Spanned::span),
                tissue.thickness_mm.as_ref().map(Spanned::span),
            ];
            let curve = [
                tissue.slopes_kpa.as_ref().map(Spanned::span),
                tissue.breaks_percent.as_ref().map(Spanned::span),
            ];
            return match soft.into_iter().chain(curve).flatten().next() {
                Some(span) => Err(self.source.fault(
                    span,
                    format!("tissue {name}: this key changes nothing where body = \"fixed\""),
                )),
                None => Ok(scene::Tissue {
                    density_kg_m3: 0.0,
                    body: Body::Fixed,
                }),
            };
        }
        let missing = |key: &str| {
            self.source
                .fault(entry.span(), format!("tissue {name}: key {key} is missing"))
        };
        let density = tissue.density_kg_m3.as_ref().ok_or_else(|| missing("density_kg_m3"))?;
        let slopes = tissue.slopes_kpa.as_ref().ok_or_else(|| missing("slopes_kpa"))?;
        let sheet = match &tissue.thickness_mm {
            Some(thickness) => (self.source.number("thickness_mm", thickness, [0.05, 50.0])? / pitch_mm).min(1.0),
            None => 1.0,
        };
        Ok(scene::Tissue {
            density_kg_m3: self.source.number("density_kg_m3", density, [100.0, 5000.0])? as f32,
            body: Body::Soft {
                curve: self.curve(slopes, tissue.breaks_percent.as_ref())?,
                sheet: sheet as f32,
            },
        })
    }

    fn curve(
        &self,
        slopes: &Spanned<Vec<Number>>,
        breaks: Option<&Spanned<Vec<Number>>>,
    ) -> Result<heapless::Vec<Segment, SEGMENTS_MAX>, Error> {
        if let (Some(breaks), false) = (breaks, self.effects.has(Effect::Stiffening)) {
            return Err(self.needs(breaks.span(), "key breaks_percent", Effect::Stiffening));
        }
        let wanted = breaks.map_or(0, |breaks| breaks.get_ref().len()) + 1;
        let count = slopes.get_ref().len();
        if count != wanted || count > SEGMENTS_MAX {
            let what = format!(
                "slopes_kpa has {count} slopes: one more than breaks_percent is right, here {wanted}, at most {SEGMENTS_MAX}"
            );
            return Err(self.source.fault(slopes.span(), what));
        }
        let mut curve = heapless::Vec::new();
        let mut low = [0.001, 0.0];
        for (i, slope) in slopes.get_ref().iter().enumerate() {
            let slope_kpa = self.source.number("slopes_kpa", slope, [low[0], 1e5])?;
            let from = match i.checked_sub(1).and_then(|i| breaks?.get_ref().get(i)) {
                Some(strain) => self.source.number("breaks_percent", strain, [low[1] + 0.1, 500.0])?,
                None => 0.0,
            };
            low = [slope_kpa, from];
            let segment = Segment {
                from_strain: (from * 1e-2) as f32,
                slope_pa: (slope_kpa * 1e3) as f32,
            };
            // The count was checked above.
            let _ = curve.push(segment);
        }
        Ok(curve)
    }

    fn wound(&self, wound: &file::Wound, file: &File) -> Result<Wound, Error> {
        let [x, y, z] = file.patch.size_mm.each_ref().map(|size| *size.get_ref());
        let pitch = *file.patch.pitch_mm.get_ref();
        let gap_mm = self
            .source
            .number("wound.gap_mm", &wound.gap_mm, [pitch, x - 2.0 * pitch])?;
        let columns = gap_mm / pitch;
        if (columns - columns.round()).abs() > 1e-6 {
            let near = columns.round() * pitch;
            let what =
                format!("wound.gap_mm = {gap_mm} is no multiple of patch.pitch_mm = {pitch}; the nearest is {near}");
            return Err(self.source.fault(wound.gap_mm.span(), what));
        }
        Ok(Wound {
            gap_mm,
            length_mm: self
                .source
                .number("wound.length_mm", &wound.length_mm, [pitch, y - 2.0 * pitch])?,
            depth_mm: self
                .source
                .number("wound.depth_mm", &wound.depth_mm, [pitch, z - pitch])?,
            penalty_n_per_m: self.gated(
                "wound.penalty_n_per_m",
                &wound.penalty_n_per_m,
                Effect::WoundContact,
                [1.0, 1e5],
            )? as f32,
        })
    }

    fn tool(&self, file: &File) -> Result<scene::Tool, Error> {
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

    fn contact(&self, file: &File) -> Result<scene::Contact, Error> {
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
                [1.5 * pitch, 5.0 * pitch],
            )?),
        })
    }

    fn stitch(&self, stitch: &file::Stitch, file: &File) -> Result<Stitch, Error> {
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

    fn thread(&self, thread: &Spanned<file::Thread>) -> Result<scene::Thread, Error> {
        let thread = thread.get_ref();
        let link = self.source.number("thread.link_mm", &thread.link_mm, [0.5, 20.0])?;
        let length = self
            .source
            .number("thread.length_mm", &thread.length_mm, [3.0 * link, 400.0])?;
        let penalty = self.gated(
            "thread.penalty_n_per_m",
            &thread.penalty_n_per_m,
            Effect::ThreadContact,
            [1.0, 1e5],
        )?;
        let links = (length / link).round();
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

    fn output(&self, output: &file::Output) -> Result<scene::Output, Error> {
        let passivity = &output.passivity_n_s_per_m;
        Ok(scene::Output {
            scale: self.source.number("output.scale", &output.scale, [0.01, 20.0])? as f32,
            slew_n: self
                .source
                .number("output.slew_n_per_tick", &output.slew_n_per_tick, [0.001, 0.5])? as f32,
            passivity_n_s_per_m: self.gated("output.passivity_n_s_per_m", passivity, Effect::Passivity, [0.1, 50.0])?
                as f32,
        })
    }

    fn hand(&self, hand: &file::Hand) -> Result<Hand, Error> {
        Ok(Hand {
            mass_kg: self.source.number("hand.mass_kg", &hand.mass_kg, [0.01, 5.0])? as f32,
            damping_n_s_per_m: self
                .source
                .number("hand.damping_n_s_per_m", &hand.damping_n_s_per_m, [0.0, 100.0])?
                as f32,
            stiffness_n_per_m: self
                .source
                .number("hand.stiffness_n_per_m", &hand.stiffness_n_per_m, [1.0, 1e4])?
                as f32,
        })
    }

    fn operator(&self, file: &File) -> Result<Operator, Error> {
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

    /// A number that must stand where `effect` is on and must not where it is off; 0 where it is off.
    fn gated(&self, key: &str, value: &Option<Number>, effect: Effect, allowed: [f64; 2]) -> Result<f64, Error> {
        match (self.effects.has(effect), value) {
            (true, Some(value)) => self.source.number(key, value, allowed),
            (false, None) => Ok(0.0),
            (false, Some(value)) => Err(self.needs(value.span(), &format!("key {key}"), effect)),
            (true, None) => Err(self.lacks(&format!("key {key}"), effect)),
        }
    }

    fn needs(&self, at: std::ops::Range<usize>, what: &str, effect: Effect) -> Error {
        self.source.fault(
            at,
            format!(
                "{what} needs effect {0}: add \"{0}\" to effects or remove it",
                effect.name()
            ),
        )
    }

    fn lacks(&self, what: &str, effect: Effect) -> Error {
        self.source
            .fault(0..0, format!("{what} is missing: effect {} needs it", effect.name()))
    }
}

fn metres(mm: f64) -> f32 {
    (mm * 1e-3) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BUILT_IN;

    /// The built-in scene with one piece of text replaced.
    fn altered(from: &str, to: &str) -> Result<Plan, String> {
        assert_eq!(BUILT_IN.matches(from).count(), 1, "{from}");
        let source = Source {
            name: "s.toml".into(),
            text: BUILT_IN.replace(from, to),
        };
        source
            .parse()
            .and_then(|file| check(&source, &file))
            .map_err(|error| error.to_string())
    }

    fn line_of(text: &str) -> usize {
        BUILT_IN.lines().position(|line| line.contains(text)).unwrap() + 1
    }

    #[test]
    fn the_built_in_scene_is_in_si_units() {
        let plan = altered("law = \"isotropic\"", "law = \"axial\"").unwrap();
        assert_eq!(plan.patch.law, scene::Law::Axial);
        assert_eq!(
            plan.solver,
            Solver::BePcg {
                iterations: 10,
                newton: 1
            }
        );
        let thread = plan.thread.unwrap();
        assert_eq!((thread.nodes, thread.link_m, thread.mass_kg_per_m), (24, 0.005, 43e-6));
        // R = L/θ: a half circle of 26 mm has R = 8.276 mm.
        assert!(matches!(plan.tool, scene::Tool::Needle { radius_m, .. } if (radius_m - 8.276e-3).abs() < 1e-6));
        let Body::Soft { curve, sheet } = &plan.tissues[0].body.body else {
            panic!("skin is soft")
        };
        assert!((sheet - 0.6).abs() < 1e-6);
        assert_eq!(
            curve[2],
            Segment {
                from_strain: 0.6,
                slope_pa: 3.66e6
            }
        );
        assert_eq!(plan.tissues[2].body.body, Body::Fixed);
    }

    #[test]
    fn every_fault_is_one_line_with_its_place() {
        let cases = [
            (
                "pitch_mm = 2 ",
                "pitch_mm = 0 ",
                "pitch_mm",
                "patch.pitch_mm = 0 is out of range: 0.1 to 20",
            ),
            (
                "pitch_mm = 2 ",
                "pitch_mm = nan ",
                "pitch_mm",
                "patch.pitch_mm = NaN is out of range: 0.1 to 20",
            ),
            (
                "pitch_mm = 2 ",
                "pitch_mm = \"2\" ",
                "pitch_mm",
                "pitch_mm: invalid type: string \"2\", expected f64",
            ),
            ("pitch_mm = 2 ", "pich_mm = 2 ", "pitch_mm", "unknown field `pich_mm`"),
            (
                "law = \"isotropic\"",
                "law = \"hooke\"",
                "law =",
                "law: unknown variant `hooke`, expected one of `isotropic`",
            ),
            (
                "gap_mm = 4 ",
                "gap_mm = 5 ",
                "gap_mm",
                "wound.gap_mm = 5 is no multiple of patch.pitch_mm = 2; the nearest is 6",
            ),
            (
                "kernel_mm = 3 ",
                "kernel_mm = 2 ",
                "kernel_mm",
                "contact.kernel_mm = 2 is out of range: 3 to 10",
            ),
            (
                "bite_mm = 4 ",
                "bite_mm = 9 ",
                "bite_mm",
                "stitch.bite_mm = 9 is out of range: 0.5 to 5.86",
            ),
            (
                "[30, 60]",
                "[60, 30]",
                "breaks_percent = [30",
                "breaks_percent = 30 is out of range: 60.1 to 500",
            ),
            (
                "[281, 1700, 3660]",
                "[281, 1700]",
                "slopes_kpa = [281",
                "slopes_kpa has 2 slopes",
            ),
            (
                "be-pcg:10:1\"\n",
                "pd:3\"\n",
                "solver = ",
                "solver = \"pd:3\": there is be-pcg",
            ),
            (
                "be-pcg:10:1\"\n",
                "be-pcg:0\"\n",
                "solver = ",
                "takes 1 to 200 iterations",
            ),
            (
                "\"passivity\",",
                "\"magic\",",
                "\"passivity\",",
                "effects: no effect `magic`; there are gravity, ",
            ),
        ];
        for (from, to, at, what) in cases {
            let error = altered(from, to).unwrap_err();
            assert!(
                error.starts_with(&format!("s.toml:{}: ", line_of(at))) && error.contains(what),
                "{to}: {error}"
            );
            assert!(!error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn a_key_of_an_effect_that_is_off_is_refused() {
        let cases = [
            ("\"stiffening\", ", "key breaks_percent needs effect stiffening"),
            (
                "\"spring-damping\", ",
                "key patch.spring_damping_ms needs effect spring-damping",
            ),
            (
                "\"shaft-friction\",\n",
                "key stitch.friction_n_per_mm needs effect shaft-friction",
            ),
            (
                "\"thread-contact\", ",
                "key thread.penalty_n_per_m needs effect thread-contact",
            ),
            (
                "\"wound-contact\", ",
                "key wound.penalty_n_per_m needs effect wound-contact",
            ),
            (
                "\"passivity\",",
                "key output.passivity_n_s_per_m needs effect passivity",
            ),
            (
                "\"thread\", ",
                "effects: `gravity` changes nothing without effect `thread`",
            ),
            ("\"puncture\", ", "changes nothing without effect `puncture`"),
        ];
        for (effect, what) in cases {
            let error = altered(effect, "").unwrap_err();
            assert!(error.contains(what), "{effect}: {error}");
        }
    }

    #[test]
    fn a_key_that_an_effect_needs_is_asked_for() {
        let error = altered("penalty_n_per_m = 2000", "").unwrap_err();
        assert!(
            error.contains("key wound.penalty_n_per_m is missing: effect wound-contact needs it"),
            "{error}"
        );
    }
}
