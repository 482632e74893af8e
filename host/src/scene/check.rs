//! From a scene file's keys to checked quantities in SI units, with their allowed ranges. Which keys need which effect, and what stands for them
//! where they are left out, is in the controller's table of effects.

mod tissue;
mod tool;

use sutura_controller::effects::{Key, TABLE, key};
use sutura_shared::scene::{self, Effect, Effects, Solver};
use toml::Spanned;

use super::file::{self, File, Number};
use super::plan::{Hand, Plan};
use super::setting::Setting;
use super::source::{Error, Source};

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
        stitch: keys.stitch(file)?,
        thread: keys.thread(file)?,
        output: keys.output(&file.output)?,
        profile: file.device.profile,
        hand: keys.hand(&file.hand)?,
        operator: keys.operator(file)?,
        person: keys.person(file)?,
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
    for (row, name) in TABLE.iter().flat_map(|row| names.iter().map(move |name| (row, name))) {
        if let Some(needed) = row
            .needs
            .filter(|&needed| row.effect.name() == name.get_ref() && !effects.has(needed))
        {
            let what = format!(
                "effects: `{}` changes nothing without effect `{}`",
                name.get_ref(),
                needed.name()
            );
            return Err(source.fault(name.span(), what));
        }
    }
    Ok(effects)
}

fn solver(source: &Source, text: &Spanned<String>) -> Result<Setting<Solver>, Error> {
    let name = text.get_ref();
    name.parse()
        .map_err(|error| source.fault(text.span(), format!("solver = \"{name}\": {error}")))
}

/// The keys of one file and the effects that say which of them may stand.
struct Keys<'a> {
    source: &'a Source,
    effects: Effects,
}

impl Keys<'_> {
    /// Refuses sections of effects that are off, and effects whose sections are missing.
    fn sections(&self, file: &File) -> Result<(), Error> {
        let spans = [
            ("stitch", file.stitch.as_ref().map(Spanned::span)),
            ("thread", file.thread.as_ref().map(Spanned::span)),
            ("needle", file.needle.as_ref().map(Spanned::span)),
            ("wound", file.wound.as_ref().map(Spanned::span)),
        ];
        let span = |section: &str| spans.iter().find(|(name, _)| *name == section)?.1.clone();
        for row in &TABLE {
            if self.effects.has(row.effect) {
                if let Some(missing) = row.asks.iter().find(|section| span(section).is_none()) {
                    let what = format!("section [{missing}] is missing: effect {} needs it", row.effect.name());
                    return Err(self.source.fault(0..0, what));
                }
            } else if let Some((section, span)) = row.section.and_then(|section| Some((section, span(section)?))) {
                return Err(self.needs(span, &format!("section [{section}]"), row.effect));
            }
        }
        Ok(())
    }

    fn output(&self, output: &file::Output) -> Result<scene::Output, Error> {
        let passivity = output.passivity_n_s_per_m.as_ref();
        Ok(scene::Output {
            scale: self.source.number("output.scale", &output.scale, [0.01, 20.0])? as f32,
            slew_n: self
                .source
                .number("output.slew_n_per_tick", &output.slew_n_per_tick, [0.001, 0.5])? as f32,
            passivity_n_s_per_m: self.own(&key::PASSIVITY, passivity)? as f32,
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

    /// The number of an effect's key, or its default; 0 where the effect is off, and there the key must not stand.
    fn own(&self, key: &Key, value: Option<&Number>) -> Result<f64, Error> {
        self.own_within(key, value, key.range)
    }

    /// The same where the rest of the scene narrows the key's range.
    fn own_within(&self, key: &Key, value: Option<&Number>, allowed: [f64; 2]) -> Result<f64, Error> {
        match (self.effects.has(key.effect), value) {
            (true, Some(value)) => self.source.number(key.name, value, allowed),
            (true, None) => self.default(key, 0, allowed),
            (false, Some(value)) => Err(self.needs(value.span(), &format!("key {}", key.name), key.effect)),
            (false, None) => Ok(0.0),
        }
    }

    /// The `index`th number of a key's default, if it is allowed here.
    fn default(&self, key: &Key, index: usize, [low, high]: [f64; 2]) -> Result<f64, Error> {
        let default = key.default.get(index).copied().unwrap_or_default();
        if (low..=high).contains(&default) {
            return Ok(default);
        }
        let what = format!(
            "key {} is missing, and its default {default} is out of range here: {low} to {high}",
            key.name
        );
        Err(self.source.fault(0..0, what))
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
}

fn metres(mm: f64) -> f32 {
    (mm * 1e-3) as f32
}

fn seconds(ms: f64) -> f32 {
    (ms * 1e-3) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BUILT_IN;
    use sutura_shared::scene::{Body, Segment};

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
        let plan = altered("thickness_mm = 2 ", "thickness_mm = 1.2 ").unwrap();
        assert_eq!(
            plan.solver,
            Setting::Fixed(Solver::BePcg {
                iterations: 10,
                newton: 1
            })
        );
        let thread = plan.thread.unwrap();
        assert_eq!((thread.nodes, thread.link_m, thread.mass_kg_per_m), (24, 0.005, 43e-6));
        // 1.2 mm of skin in voxels of 2 mm; R = L/θ: a half circle of 26 mm has R = 8.276 mm.
        assert!(matches!(plan.tool, scene::Tool::Needle { radius_m, .. } if (radius_m - 8.276e-3).abs() < 1e-6));
        let Body::Soft { curve, sheet, .. } = &plan.tissues[0].body.body else {
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

    /// What is replaced, by what, where the line is, what the error says.
    const FAULTS: [(&str, &str, &str, &str); 20] = [
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
            "patch.law = \"hooke\": there are isotropic, axial, paper, volume",
        ),
        (
            "law = \"isotropic\"",
            "poisson = 0.45\nlaw = \"isotropic\"",
            "law =",
            "patch.poisson: Poisson's ratio is free with law volume only",
        ),
        (
            "law = \"isotropic\"",
            "poisson = 0.5\nlaw = \"volume\"",
            "law =",
            "patch.poisson: Poisson's ratio is 0.25 to 0.49",
        ),
        (
            "law = \"isotropic\"",
            "assembly = \"each\"\nlaw = \"isotropic\"",
            "law =",
            "patch.assembly = \"each\": there are per-voxel, every-edge",
        ),
        (
            "gap_mm = 4 ",
            "gap_mm = 5 ",
            "gap_mm",
            "wound.gap_mm = 5 is no multiple of patch.pitch_mm = 2; the nearest is 6",
        ),
        (
            "kernel_mm = 3.5 ",
            "kernel_mm = 2 ",
            "kernel_mm",
            "contact.kernel_mm = 2 is out of range: 3 to ",
        ),
        (
            "bite_mm = 4 ",
            "bite_mm = 9 ",
            "bite_mm",
            "stitch.bite_mm = 9: a gap of 4.00 mm and two such bites take 29.0 mm of needle",
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
            "along = [0, 1, 0]",
            "normal = [0, 0, 1]\nalong = [0, 1, 0]",
            "along = [0, 1, 0]",
            "patch.normal changes nothing without key patch.site_mm",
        ),
        (
            "name = \"bone\"",
            "name = \"bones\"",
            "name = \"bone\"",
            "tissue `bones`: the phantom has no such tissue, it has skin, muscle, bone",
        ),
        (
            "[[tissue]]\nname = \"bone\"\nbody = \"fixed\"\n",
            "",
            "phantom = ",
            "[[tissue]] `bone` is missing: the phantom has skin, muscle, bone",
        ),
        (
            "link_mm = 5\n",
            "link_mm = 1\n",
            "link_mm = 5",
            "thread.link_mm = 1 is out of range: 2 to 20",
        ),
        (
            "be-pcg:10:1\"\n",
            "pd:3\"\n",
            "solver = ",
            "solver = \"pd:3\": there are explicit[:substeps], be-pcg",
        ),
        (
            "be-pcg:10:1\"\n",
            "be-pcg:0\"\n",
            "solver = ",
            "solver.iterations is 1 to 1000",
        ),
        (
            "\"passivity\",",
            "\"magic\",",
            "\"passivity\",",
            "effects: no effect `magic`; there are gravity, ",
        ),
    ];

    #[test]
    fn every_fault_is_one_line_with_its_place() {
        for (from, to, at, what) in FAULTS {
            let error = altered(from, to).unwrap_err();
            assert!(
                error.starts_with(&format!("s.toml:{}: ", line_of(at))) && error.contains(what),
                "{to}: {error}"
            );
            assert!(!error.contains('\n'), "{error}");
        }
    }

    /// E·t: what the cells are thicker than the tissue they are softer.
    #[test]
    fn a_layer_is_as_stiff_as_it_is_thick() {
        for (thickness, cells_mm) in [(0.5, 2.0), (2.0, 2.0), (2.9, 4.0), (4.0, 4.0), (4.1, 6.0)] {
            let plan = altered("thickness_mm = 2 ", &format!("thickness_mm = {thickness} ")).unwrap();
            let Body::Soft { sheet, .. } = &plan.tissues[0].body.body else {
                panic!("skin is soft")
            };
            assert!((f64::from(*sheet) * cells_mm - thickness).abs() < 1e-6, "{thickness}");
        }
    }

    /// 9 mm in links of 2.1 mm would be 4 of 2.25 mm; 7 mm would be 3.33 links, 3 of them; 5.3 mm in links of 2 mm would be 2.65, but 3 are too short.
    #[test]
    fn links_are_whole_and_as_long_as_the_controller_needs() {
        for (length, link, nodes) in [(9.0, 2.1, 5), (7.0, 2.1, 4), (5.3, 2.0, 3), (126.0, 2.0, 64)] {
            let changed = format!("length_mm = {length}\nlink_mm = {link}\n");
            let thread = altered("length_mm = 115\nlink_mm = 5\n", &changed)
                .unwrap()
                .thread
                .unwrap();
            assert_eq!(thread.nodes, nodes);
            assert!(thread.link_m >= 0.002, "{thread:?}");
        }
    }

    #[test]
    fn a_fourth_curve_is_refused() {
        let soft = "[[tissue]]\nname = \"NAME\"\nmesh = { path = \"a.stl\" }\nbody = \"soft\"\ndensity_kg_m3 = 1000\nslopes_kpa = [50]\n";
        let head = include_str!("../../scenes/head-stl.toml").replace(
            "body = \"fixed\"",
            "body = \"soft\"\ndensity_kg_m3 = 1000\nslopes_kpa = [90]",
        );
        let line = head.lines().count() + 1;
        let source = Source {
            name: "s.toml".into(),
            text: format!("{head}{}", soft.replace("NAME", "fat")),
        };
        let error = check(&source, &source.parse().unwrap()).unwrap_err().to_string();
        let expected = "tissue fat: with effect stiffening at most 3 tissues may have body = \"soft\"";
        assert_eq!(error, format!("s.toml:{line}: {expected}"));
    }

    #[test]
    fn a_key_of_an_effect_that_is_off_is_refused() {
        let cases = [
            ("\"stiffening\", ", "key tissue.breaks_percent needs effect stiffening"),
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

    /// 2 f_c/Δ = 2 · 0.04 N/0.03 mm = 2,667 N/m at scale 1.
    #[test]
    fn a_coupling_beyond_the_edge_of_the_device_is_refused() {
        let stiff = |coupling: &str, scale: &str| {
            let text = BUILT_IN
                .replace("coupling_n_per_m = 800", &format!("coupling_n_per_m = {coupling}"))
                .replace("scale = 1 ", &format!("scale = {scale} "));
            let source = Source {
                name: "s.toml".into(),
                text,
            };
            check(&source, &source.parse().unwrap()).map(|_| ())
        };
        assert!(stiff("2666", "1").is_ok() && stiff("1333", "2").is_ok());
        let error = stiff("800", "-1").unwrap_err().to_string();
        assert!(error.contains("output.scale"), "{error}");
        let error = stiff("1334", "2").unwrap_err().to_string();
        let expected = "contact.coupling_n_per_m = 1334 at output.scale = 2 is more than the device's friction and encoders bear: at most 1333";
        assert!(error.ends_with(expected), "{error}");
    }

    #[test]
    fn the_barrier_of_law_volume_is_not_asked_for_twice() {
        let error = altered("law = \"isotropic\"", "law = \"volume\"\npoisson = 0.45");
        assert!(error.is_ok(), "{error:?}");
        let text = BUILT_IN
            .replace("\"passivity\",", "\"passivity\", \"barrier\",")
            .replace("law = \"isotropic\"", "law = \"volume\"\npoisson = 0.45");
        let source = Source {
            name: "s.toml".into(),
            text,
        };
        let error = check(&source, &source.parse().unwrap()).unwrap_err().to_string();
        assert!(error.contains("effect barrier changes nothing under"), "{error}");
    }

    /// Punctures at 2 + 6 mm from the middle are 8 mm: beyond the 6.30 mm of an SH, within the 9.09 mm of a CT-1.
    #[test]
    fn a_bite_beyond_the_needle_is_refused_with_one_that_can() {
        let error = altered("bite_mm = 4 ", "bite_mm = 6 ").unwrap_err();
        let remedy = "needle.kind = \"CT-1\" can, or a bite of at most 4.30";
        assert!(error.starts_with("s.toml:") && error.ends_with(remedy), "{error}");
        let error = altered("length_mm = 26 ", "length_mm = 9 ").unwrap_err();
        assert!(error.ends_with(": needle.kind = \"FS-1\" can"), "{error}");
        assert!(altered("length_mm = 26 ", "length_mm = 26\ngrasp = 0.45 ").is_err());
    }

    #[test]
    fn a_needle_has_a_name_or_a_shape() {
        let shape = "arc_of_circle = 0.5\nlength_mm = 26 ";
        let named = altered(shape, "kind = \"SH\" ").unwrap();
        assert_eq!(named.tool, altered(shape, shape).unwrap().tool);
        for (other, what) in [
            (
                "kind = \"SH\"\nlength_mm = 26 ",
                "[needle] has either kind, or arc_of_circle and length_mm",
            ),
            (
                "length_mm = 26 ",
                "[needle] has either kind, or arc_of_circle and length_mm",
            ),
            (
                "kind = \"XL\" ",
                "needle.kind = \"XL\": there are P-3, FS-2, PS-2, FS-1, SH, CT-1",
            ),
        ] {
            let error = altered(shape, other).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }

    /// A 3-0 nylon thread has 76 N and 43 mg/m.
    #[test]
    fn a_thread_has_a_name_or_its_numbers() {
        let numbers = "axial_n = 76\nmass_mg_per_m = 43\n";
        let thread = altered(numbers, "kind = \"nylon 3-0\"\n").unwrap().thread.unwrap();
        assert!((thread.axial_n - 76.0).abs() < 0.1 && (thread.mass_kg_per_m - 43e-6).abs() < 0.5e-6);
        // Of nylon 4-0 it is 82 nN·m², where it bends.
        let source = Source {
            name: "s.toml".into(),
            text: BUILT_IN
                .replace(numbers, "kind = \"nylon 4-0\"\n")
                .replace("\"thread\", ", "\"thread\", \"thread-bending\", "),
        };
        let bends = check(&source, &source.parse().unwrap()).unwrap().thread.unwrap();
        assert!(thread.bending_n_m2 <= 0.0 && (bends.bending_n_m2 / 82e-9 - 1.0).abs() < 0.01);
        for (other, what) in [
            (
                "kind = \"nylon 3-0\"\naxial_n = 76\n",
                "[thread] has either kind, or axial_n and mass_mg_per_m",
            ),
            (
                "kind = \"steel 3-0\"\n",
                "thread.kind = \"steel 3-0\": right is a material (nylon, silk, polypropylene) and a USP size (6-0,",
            ),
        ] {
            let error = altered(numbers, other).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }

    #[test]
    fn a_default_that_does_not_fit_is_asked_for() {
        // A patch of 12 mm has 4 mm from its middle to the last layer of nodes that move, 2 mm of them in the gap.
        let short = BUILT_IN
            .replace("size_mm = [40, ", "size_mm = [12, ")
            .replace("bite_mm = 4 ", "# ");
        let source = Source {
            name: "s.toml".into(),
            text: short,
        };
        let error = check(&source, &source.parse().unwrap()).unwrap_err().to_string();
        let what = "s.toml:1: key stitch.bite_mm is missing, and its default 4 is out of range here: 0.5 to 2";
        assert!(error.starts_with(what), "{error}");
    }

    #[test]
    fn a_section_that_an_effect_works_on_is_asked_for() {
        let touch = include_str!("../../scenes/touch.toml");
        for (name, missing) in [("puncture", "needle"), ("wound-contact", "wound")] {
            let source = Source {
                name: "s.toml".into(),
                text: touch.replace("\"passivity\"", &format!("\"passivity\", \"{name}\"")),
            };
            let error = check(&source, &source.parse().unwrap()).unwrap_err().to_string();
            assert_eq!(
                error,
                format!("s.toml:1: section [{missing}] is missing: effect {name} needs it")
            );
        }
    }
}
