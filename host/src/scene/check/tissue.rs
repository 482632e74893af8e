//! The block of tissue: `[patch]`, `[[tissue]]`, `[wound]`.

use sutura_controller::effects::key;
use sutura_controller::lattice::CURVES;
use sutura_shared::scene::{self, Assembly, Body, Effect, Law, NoLaw, SEGMENTS_MAX, Segment, TISSUES_MAX};
use toml::Spanned;

use super::{Keys, seconds};
use crate::geometry::{patch, phantom};
use crate::scene::file::{self, File, Number};
use crate::scene::plan::{Patch, Tissue, Wound};
use crate::scene::source::Error;

impl Keys<'_> {
    pub(super) fn patch(&self, file: &File) -> Result<Patch, Error> {
        let patch = &file.patch;
        let [x, y, z] = &patch.size_mm;
        let size = |value| self.source.number("patch.size_mm", value, [1.0, 1000.0]);
        let beta = self.own(&key::SPRING_DAMPING, patch.spring_damping_ms.as_ref())?;
        if let (None, None) = (&file.phantom, &patch.site_mm) {
            return Err(self.source.fault(
                patch.pitch_mm.span(),
                "key patch.site_mm is missing: a point on the skin, in the meshes' frame",
            ));
        }
        if let (Some(normal), None) = (&patch.normal, &patch.site_mm) {
            return Err(self.source.fault(
                normal.span(),
                "key patch.normal changes nothing without key patch.site_mm; remove it, or add a point on the skin",
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
            along: *patch.along.get_ref(),
            law: self.law(patch)?,
            assembly: self.assembly(patch)?,
            damping_per_s: self
                .source
                .number("patch.damping_per_s", &patch.damping_per_s, [0.0, 1000.0])? as f32,
            spring_damping_s: seconds(beta),
        })
    }

    fn law(&self, patch: &file::Patch) -> Result<Law, Error> {
        let law = self.named(patch)?;
        if let (Law::Volume { .. }, true) = (law, self.effects.has(Effect::Barrier)) {
            let what = "effect barrier changes nothing under patch.law = \"volume\", which has it; remove the effect";
            return Err(self.source.fault(patch.law.span(), what));
        }
        Ok(law)
    }

    fn named(&self, patch: &file::Patch) -> Result<Law, Error> {
        let name = patch.law.get_ref();
        let poisson = patch.poisson.as_ref();
        Law::named(name, poisson.map(|poisson| *poisson.get_ref() as f32)).map_err(|error| match (error, poisson) {
            (NoLaw::Fixed | NoLaw::Range, Some(poisson)) => {
                self.source.fault(poisson.span(), format!("patch.poisson: {error}"))
            }
            _ => self
                .source
                .fault(patch.law.span(), format!("patch.law = \"{name}\": {error}")),
        })
    }

    fn assembly(&self, patch: &file::Patch) -> Result<Assembly, Error> {
        let Some(name) = &patch.assembly else {
            return Ok(Assembly::default());
        };
        name.get_ref().parse().map_err(|error| {
            self.source
                .fault(name.span(), format!("patch.assembly = \"{}\": {error}", name.get_ref()))
        })
    }

    pub(super) fn tissues(&self, file: &File) -> Result<Vec<Tissue>, Error> {
        if let Some(extra) = file.tissue.get(TISSUES_MAX) {
            return Err(self.source.fault(
                extra.span(),
                format!("{} tissues: at most {TISSUES_MAX}", file.tissue.len()),
            ));
        }
        if file.phantom.is_some() {
            self.phantom(file)?;
        }
        let mut tissues: Vec<Tissue> = Vec::new();
        for entry in &file.tissue {
            let tissue = entry.get_ref();
            let name = tissue.name.get_ref();
            if let (Some(thickness), true) = (
                &tissue.thickness_mm,
                tissues.iter().any(|known| known.sheet_mm.is_some()),
            ) {
                return Err(self.source.fault(
                    thickness.span(),
                    format!("tissue {name}: one tissue may have thickness_mm, another one has it"),
                ));
            }
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
                (None, None) if tissue.thickness_mm.is_none() => {
                    let what =
                        format!("tissue {name}: key mesh is missing, such as mesh = {{ path = \"{name}.stl\" }}");
                    return Err(self.source.fault(entry.span(), what));
                }
                _ => {}
            }
            tissues.push(Tissue {
                name: name.clone(),
                body: self.body(entry, *file.patch.pitch_mm.get_ref())?,
                sheet_mm: tissue.thickness_mm.as_ref().map(|thickness| *thickness.get_ref()),
                mesh: tissue.mesh.as_ref().map(|mesh| mesh.get_ref().clone()),
            });
        }
        let soft = |entry: &&Spanned<file::Tissue>| *entry.get_ref().body.get_ref() == file::Body::Soft;
        match file.tissue.iter().filter(soft).nth(CURVES) {
            Some(extra) if self.effects.has(Effect::Stiffening) => {
                let name = extra.get_ref().name.get_ref();
                let what =
                    format!("tissue {name}: with effect stiffening at most {CURVES} tissues may have body = \"soft\"");
                Err(self.source.fault(extra.span(), what))
            }
            _ => Ok(tissues),
        }
    }

    /// The tissues are those of the phantom, all of them: its site and its depth belong to the whole.
    fn phantom(&self, file: &File) -> Result<(), Error> {
        let names = || file.tissue.iter().map(|entry| &entry.get_ref().name);
        let known = phantom::TISSUES.join(", ");
        if let Some(name) = names().find(|name| !phantom::TISSUES.contains(&name.get_ref().as_str())) {
            let what = format!(
                "tissue `{}`: the phantom has no such tissue, it has {known}",
                name.get_ref()
            );
            return Err(self.source.fault(name.span(), what));
        }
        match phantom::TISSUES
            .iter()
            .find(|tissue| names().all(|name| name.get_ref() != *tissue))
        {
            None => Ok(()),
            Some(tissue) => {
                let what = format!("[[tissue]] `{tissue}` is missing: the phantom has {known}");
                Err(self
                    .source
                    .fault(file.phantom.as_ref().map_or(0..0, Spanned::span), what))
            }
        }
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
                // Its nodes do not move, so any mass will do.
                None => Ok(scene::Tissue {
                    density_kg_m3: 1000.0,
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
            // E·t of the tissue is that of its cells, however many there are.
            Some(thickness) => {
                let thickness_mm = self.source.number("thickness_mm", thickness, [0.05, 50.0])?;
                thickness_mm / (patch::layers(thickness_mm, pitch_mm) as f64 * pitch_mm)
            }
            None => 1.0,
        };
        Ok(scene::Tissue {
            density_kg_m3: self.source.number("density_kg_m3", density, [100.0, 5000.0])? as f32,
            body: Body::Soft {
                curve: self.curve(slopes, tissue.breaks_percent.as_ref())?,
                sheet: sheet as f32,
                strength_n: self.own(&key::STRENGTH, tissue.strength_n.as_ref())? as f32,
            },
        })
    }

    fn curve(
        &self,
        slopes: &Spanned<Vec<Number>>,
        breaks: Option<&Spanned<Vec<Number>>>,
    ) -> Result<heapless::Vec<Segment, SEGMENTS_MAX>, Error> {
        if let (Some(breaks), false) = (breaks, self.effects.has(Effect::Stiffening)) {
            return Err(self.needs(breaks.span(), &format!("key {}", key::BREAKS.name), Effect::Stiffening));
        }
        let [first, most] = key::BREAKS.range;
        let wanted = breaks.map_or(0, |breaks| breaks.get_ref().len()) + 1;
        let count = slopes.get_ref().len();
        if count != wanted || count > SEGMENTS_MAX {
            let what = format!(
                "slopes_kpa has {count} slopes: one more than breaks_percent is right, here {wanted}, at most {SEGMENTS_MAX}"
            );
            return Err(self.source.fault(slopes.span(), what));
        }
        let mut curve = heapless::Vec::new();
        let mut low = [0.001, first];
        for (i, slope) in slopes.get_ref().iter().enumerate() {
            let slope_kpa = self.source.number("slopes_kpa", slope, [low[0], 1e5])?;
            let from = match i.checked_sub(1).and_then(|i| breaks?.get_ref().get(i)) {
                Some(strain) => self.source.number(key::BREAKS.name, strain, [low[1], most])?,
                None => 0.0,
            };
            low = [slope_kpa, from + first];
            let segment = Segment {
                from_strain: (from * 1e-2) as f32,
                slope_pa: (slope_kpa * 1e3) as f32,
            };
            // The count was checked above.
            let _ = curve.push(segment);
        }
        Ok(curve)
    }

    pub(super) fn wound(&self, wound: &file::Wound, file: &File) -> Result<Wound, Error> {
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
            penalty_n_per_m: self.own(&key::WOUND_PENALTY, wound.penalty_n_per_m.as_ref())? as f32,
        })
    }
}
