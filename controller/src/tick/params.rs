//! From a scene to coefficients: the only step that can fail.

use crate::coupling::{Coupling, PUNCTURES};
use crate::lanes::Level;
use crate::lattice::{Lattice, Tissue};
use crate::law::Material;
use crate::math::{Pose, Vec3};
use crate::needle::{self, Body, Point};
use crate::safety;
use crate::solver::{Choice, Problem, Refused};
use crate::surface::{self, Bridge};
use crate::tear;
use crate::thread;
use crate::tissue;
use crate::wound::{self, Faces, Gap};
use sutura_shared::scene::{Effect, Scene, Site};

/// Why a scene cannot run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// The solver cannot run this patch.
    Solver(Refused),
    /// The lattice.
    Tissue(tissue::Error),
    /// The thread.
    Thread(thread::ConfigError),
    /// There is no skin where the thread's tail is to be held.
    NoSkinAtSite,
    /// The wound has more facing nodes than [`wound::PAIRS_MAX`] pairs.
    Wound,
    /// More stitches than this controller has points for.
    Stitches,
}

impl From<tissue::Error> for ConfigError {
    fn from(error: tissue::Error) -> Self {
        Self::Tissue(error)
    }
}

impl From<Refused> for ConfigError {
    fn from(refused: Refused) -> Self {
        Self::Solver(refused)
    }
}

impl From<wound::TooManyPairs> for ConfigError {
    fn from(_: wound::TooManyPairs) -> Self {
        Self::Wound
    }
}

impl From<thread::ConfigError> for ConfigError {
    fn from(error: thread::ConfigError) -> Self {
        Self::Thread(error)
    }
}

/// Coefficients of a scene; immutable while it runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Params {
    pub(super) material: Material,
    pub(super) solver: Choice,
    pub(super) needle: needle::Params,
    pub(super) thread: Option<thread::Params>,
    /// What the tissue bears of the thread; nothing without effect `tearing`.
    pub(super) tear: Option<tear::Params>,
    /// Where the thread's tail is held at first.
    pub(super) tail: Point,
    /// How many stitches there are.
    pub(super) stitches: usize,
    /// The wound as the thread crosses it.
    pub(super) bridge: Option<Bridge>,
    /// The thread lies on the skin.
    pub(super) lies: bool,
    pub(super) faces: Option<Faces>,
    /// The faces meet.
    pub(super) meet: bool,
    pub(super) safety: safety::Params,
    pub(super) patch_from_device: Pose,
}

impl Params {
    /// What the tissue's solver is given in this tick.
    pub(super) fn problem<'a, const N: usize>(
        &'a self,
        lattice: &'a Lattice<N>,
        coupling: &'a Coupling,
        level: Level,
    ) -> Problem<'a, N> {
        Problem {
            lattice,
            material: &self.material,
            coupling,
            faces: self.faces.as_ref().filter(|_| self.meet),
            level,
        }
    }

    /// What the tool meets.
    pub(super) const fn body<'a, const N: usize>(
        &'a self,
        lattice: &'a Lattice<N>,
        tissue: &'a Tissue<N>,
    ) -> Body<'a, N> {
        Body {
            lattice,
            tissue,
            faces: self.faces.as_ref(),
        }
    }

    /// Width of the wound now; zero without one.
    pub(super) fn gap<const N: usize>(&self, lattice: &Lattice<N>, tissue: &Tissue<N>) -> Gap {
        let faces = self.faces.as_ref();
        faces.map_or_else(Gap::default, |faces| wound::gap(faces, lattice, tissue))
    }

    pub(super) fn new<const N: usize>(
        (scene, cells): (&Scene, &[u8]),
        (material, solver): (Material, Choice),
        lattice: &Lattice<N>,
        tissue: &Tissue<N>,
    ) -> Result<Self, ConfigError> {
        let needle = needle::Params::new(scene);
        let thread = match scene.thread.as_ref().filter(|_| scene.effects.has(Effect::Thread)) {
            Some(thread) => Some(thread::build(thread, scene.contact.coupling_n_per_m, scene.effects)?),
            None => None,
        };
        let stitches = scene.stitch.map_or(1, |stitch| usize::from(stitch.count));
        if stitches * Site::ALL.len() > PUNCTURES {
            return Err(ConfigError::Stitches);
        }
        let mut tail = Point::default();
        if let (Some(_), Some(stitch)) = (&thread, &scene.stitch) {
            let [x, y] = stitch.a_m;
            let above = Vec3::new(x, y, 0.0);
            let z = surface::height(lattice, tissue, above).ok_or(ConfigError::NoSkinAtSite)?;
            let place = Vec3::new(x, y, z);
            tail = Point::new(surface::kernel_at(lattice, tissue, place, needle.kernel), place, tissue);
        }
        Ok(Self {
            material,
            solver,
            needle,
            thread,
            tear: tear::Params::new(scene, cells),
            tail,
            stitches,
            bridge: scene.wound.as_ref().map(|wound| Bridge {
                columns: wound.faces.map(u32::from),
                rows: wound.rows.map(u32::from),
            }),
            lies: scene.effects.has(Effect::ThreadContact),
            faces: match &scene.wound {
                Some(wound) => Some(wound::faces(wound, scene.stitch.as_ref(), lattice)?),
                None => None,
            },
            meet: scene.effects.has(Effect::WoundContact),
            safety: safety::Params::new(&scene.output, scene.device.profile, scene.effects),
            patch_from_device: Pose::from(scene.device.patch_from_device),
        })
    }
}
