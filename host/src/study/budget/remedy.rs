//! What would meet a budget that no solver meets: a coarser pitch, or a smaller patch, each tried before it is suggested.

use std::fmt::{self, Display, Formatter};

use sutura_shared::scene::{KERNEL_PITCHES, Solver};

use super::Row;
use crate::scene::draft::{Change, Draft};
use crate::scene::plan::Plan;

/// Part of the budget that a suggestion may take, for it is timed on a busy machine.
const MARGIN: f64 = 0.9;
/// Pitches over the scene's, where no wound says which ones fit.
const COARSER: [f64; 5] = [1.25, 1.5, 2.0, 2.5, 3.0];
/// Widths and lengths over the scene's.
const SMALLER: [f64; 7] = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3];
/// Tissue that a wound needs beyond its ends [pitches].
const BEYOND_WOUND: f64 = 4.0;

/// Other values for a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remedy {
    /// Larger voxels, and a kernel that fits them.
    Pitch {
        /// `patch.pitch_mm` [mm]
        pitch_mm: f64,
        /// `contact.kernel_mm` where the scene's own does not fit [mm].
        kernel_mm: Option<f64>,
    },
    /// A smaller patch.
    Size {
        /// `patch.size_mm` [mm]
        size_mm: [f64; 3],
    },
}

/// No solver within the budget; one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmet {
    /// The budget [µs].
    pub budget_us: u16,
    /// The cheapest solver, and what it takes [µs].
    pub cheapest: (Solver, f64),
    /// What would do, and what it took with the cheapest solver [µs].
    pub remedies: Vec<(Remedy, f64)>,
    /// Where nothing would: the smallest lattice that the scene can have, and what that takes [µs].
    pub least: Option<(Remedy, f64)>,
}

impl std::error::Error for Unmet {}

/// Tries what would meet the budget: `time` gives the time of a tick with the cheapest solver, or `None` where there is no such scene.
///
/// # Errors
/// The scene's text, or what `time` ends it with.
pub(super) fn search<E: From<crate::scene::Error>>(
    draft: &Draft,
    (budget_us, cheapest): (u16, &Row),
    mut time: impl FnMut(&Draft) -> Result<Option<f64>, E>,
) -> Result<Unmet, E> {
    let plan = draft.plan()?;
    let enough = MARGIN * f64::from(budget_us);
    // Time goes at least with the nodes' number: what is too many is not tried.
    let hopeful = |remedy: &Remedy| {
        cheapest.us_median * remedy.nodes(&plan) / nodes(plan.patch.size_mm, plan.patch.pitch_mm) <= enough
    };
    let mut remedies = Vec::new();
    for list in [pitches(&plan), sizes(&plan)] {
        for remedy in list.into_iter().filter(hopeful) {
            let us = time(&draft.with(&remedy.changes())?)?;
            if let Some(us) = us.filter(|us| *us <= enough) {
                remedies.push((remedy, us));
                break;
            }
        }
    }
    let mut least = None;
    if remedies.is_empty() {
        for remedy in sizes(&plan).into_iter().rev() {
            if let Some(us) = time(&draft.with(&remedy.changes())?)? {
                least = Some((remedy, us));
                break;
            }
        }
    }
    Ok(Unmet {
        budget_us,
        cheapest: (cheapest.solver, cheapest.us_median),
        remedies,
        least,
    })
}

impl Remedy {
    /// The values in the scene.
    fn changes(&self) -> Vec<Change> {
        match *self {
            Self::Pitch { pitch_mm, kernel_mm } => {
                let kernel = kernel_mm.map(Change::Kernel);
                [Change::Pitch(pitch_mm)].into_iter().chain(kernel).collect()
            }
            Self::Size { size_mm } => vec![Change::Size(size_mm)],
        }
    }

    /// About how many nodes the lattice then has.
    fn nodes(&self, plan: &Plan) -> f64 {
        match *self {
            Self::Pitch { pitch_mm, .. } => nodes(plan.patch.size_mm, pitch_mm),
            Self::Size { size_mm } => nodes(size_mm, plan.patch.pitch_mm),
        }
    }
}

fn nodes(size_mm: [f64; 3], pitch_mm: f64) -> f64 {
    size_mm.map(|size| size / pitch_mm + 1.0).iter().product()
}

/// Coarser pitches, the finest first: those of which the wound's gap is a multiple, or some over the scene's.
fn pitches(plan: &Plan) -> Vec<Remedy> {
    let pitch = plan.patch.pitch_mm;
    let pitches: Vec<f64> = match plan.wound {
        Some(wound) => {
            let voxels = (wound.gap_mm / pitch).round().max(1.0) as u32;
            let pitches = (1..voxels).rev().map(|voxels| wound.gap_mm / f64::from(voxels));
            pitches.filter(|pitch| is_short(*pitch)).collect()
        }
        None => COARSER.map(|factor| tenths(factor * pitch)).to_vec(),
    };
    let kernel_mm = f64::from(plan.contact.kernel_m) * 1e3;
    let remedy = |pitch_mm: f64| {
        let [low, high] = KERNEL_PITCHES.map(|pitches| f64::from(pitches) * pitch_mm);
        let fits = (low..=high).contains(&kernel_mm);
        Remedy::Pitch {
            pitch_mm,
            kernel_mm: (!fits).then(|| tenths(kernel_mm * pitch_mm / pitch).clamp(low, high)),
        }
    };
    pitches.into_iter().map(remedy).collect()
}

/// Smaller patches, the largest first, no less than the wound needs.
fn sizes(plan: &Plan) -> Vec<Remedy> {
    let [width, length, depth] = plan.patch.size_mm;
    let pitch = plan.patch.pitch_mm;
    let [gap, long] = plan.wound.map_or([0.0; 2], |wound| [wound.gap_mm, wound.length_mm]);
    let part = |size: f64, wound: f64, factor: f64| {
        let voxels = (factor * size).max(wound + BEYOND_WOUND * pitch) / pitch;
        tenths(voxels.ceil() * pitch).min(size)
    };
    let mut sizes = SMALLER
        .map(|factor| [part(width, gap, factor), part(length, long, factor), depth])
        .to_vec();
    sizes.dedup();
    sizes.into_iter().map(|size_mm| Remedy::Size { size_mm }).collect()
}

/// Whether a length can be written in hundredths of a millimetre.
fn is_short(mm: f64) -> bool {
    let hundredths = 100.0 * mm;
    (hundredths - hundredths.round()).abs() < 1e-9
}

/// To a tenth of a millimetre.
fn tenths(mm: f64) -> f64 {
    (10.0 * mm).round() / 10.0
}

impl Display for Remedy {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pitch { pitch_mm, kernel_mm } => {
                write!(f, "patch.pitch_mm = {pitch_mm}")?;
                kernel_mm.map_or(Ok(()), |kernel| write!(f, " with contact.kernel_mm = {kernel}"))
            }
            Self::Size { size_mm: [x, y, z] } => write!(f, "patch.size_mm = [{x}, {y}, {z}]"),
        }
    }
}

impl Display for Unmet {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (solver, us) = self.cheapest;
        write!(
            f,
            "no solver takes {} µs or less a tick: {solver}, the cheapest, takes {us:.0} µs",
            self.budget_us
        )?;
        if !self.remedies.is_empty() {
            let remedies = self
                .remedies
                .iter()
                .map(|(remedy, us)| format!("{remedy} ({us:.0} µs)"));
            return write!(f, "; right would be {}", remedies.collect::<Vec<_>>().join(" or "));
        }
        let (smallest, us) = match self.least {
            Some((remedy, us)) => (format!("; even {remedy} takes {us:.0} µs"), us),
            None => (String::new(), us),
        };
        write!(f, "{smallest}, so {:.0} µs or more are right", (us / MARGIN).ceil())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Error;

    /// A clock of 1 µs for a hundred nodes, and 10 µs for all else; some patches are no scene, for the bite is beyond them.
    fn clock(draft: &Draft) -> Result<Option<f64>, Error> {
        let scene = draft.plan().ok();
        Ok(scene.map(|plan| 10.0 + 0.01 * nodes(plan.patch.size_mm, plan.patch.pitch_mm)))
    }

    fn unmet(draft: &Draft, budget_us: u16) -> Unmet {
        let row = Row {
            solver: Solver::BePcg {
                iterations: 3,
                newton: 1,
            },
            us_median: clock(draft).unwrap().unwrap(),
            us_p99: 0.0,
            force_error: None,
            within: false,
        };
        search(draft, (budget_us, &row), clock).unwrap()
    }

    /// 21·16·7 nodes take 34 µs, a gap of 4 mm allows voxels of 4 mm, 11·8.5·4 nodes, for which a kernel of 3.5 mm is too small.
    #[test]
    fn what_is_suggested_meets_the_budget_and_is_a_scene() {
        let draft = Draft::open(None, &[]).unwrap();
        let unmet = unmet(&draft, 25);
        let found: Vec<_> = unmet.remedies.iter().map(|(remedy, _)| *remedy).collect();
        let coarse = Remedy::Pitch {
            pitch_mm: 4.0,
            kernel_mm: Some(7.0),
        };
        assert!(
            matches!(found[..], [first, Remedy::Size { .. }] if first == coarse),
            "{found:?}"
        );
        for (remedy, us) in &unmet.remedies {
            assert!(*us <= MARGIN * 25.0);
            assert!(draft.with(&remedy.changes()).unwrap().plan().is_ok(), "{remedy}");
        }
        let line = unmet.to_string();
        assert!(
            line.contains("patch.pitch_mm = 4 with contact.kernel_mm = 7 (14 µs) or patch.size_mm = ["),
            "{line}"
        );
    }

    /// Half of the time is the rest of the tick's.
    #[test]
    fn what_nothing_meets_says_so_with_the_smallest_patch_and_its_time() {
        let unmet = unmet(&Draft::open(None, &[]).unwrap(), 1);
        assert!(unmet.remedies.is_empty());
        let line = unmet.to_string();
        assert!(
            line.contains("even patch.size_mm = [") && line.contains("µs or more are right"),
            "{line}"
        );
    }

    /// Without a wound every pitch is right that has its kernel.
    #[test]
    fn a_patch_without_a_wound_takes_other_pitches() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("touch.toml");
        std::fs::write(&path, include_str!("../../../scenes/touch.toml")).unwrap();
        let unmet = unmet(&Draft::open(Some(&path), &[]).unwrap(), 25);
        let Some((Remedy::Pitch { pitch_mm, kernel_mm }, _)) = unmet.remedies.first() else {
            panic!("{unmet:?}")
        };
        // Of 2.5, 3, 4, 5 and 6 mm the first at which 10 µs and 1 for a hundred nodes is 22.5 or less.
        assert!(
            (pitch_mm - 3.0).abs() < 1e-12 && kernel_mm.is_some(),
            "{pitch_mm} {kernel_mm:?}"
        );
    }
}
