//! A hard case, and one run of it.

use std::fmt::{self, Debug, Formatter};
use std::sync::atomic::{AtomicBool, Ordering};

use sutura_controller::lanes::Level;
use sutura_controller::solver::Refused;
use sutura_controller::tick::ConfigError;
use sutura_shared::scene::Solver;

use super::setting::Setting;
use super::watch::Trace;

/// Something that a person, a device or a bad scene may do to the tissue.
pub struct Case {
    /// `family` or `family:variant`.
    pub name: String,
    /// In one line.
    pub what: String,
    /// Where it ends, where that is not the rest it began from: stated beforehand.
    pub equilibrium: Option<Equilibrium>,
    /// Runs it: at least two seconds of simulated time, one or more of them after the input has stopped.
    pub run: Run,
}

/// What a case does.
pub type Run = Box<dyn Fn(&Attempt<'_>) -> Result<Trace, Unfinished> + Send + Sync>;

/// Another state of rest than the undisturbed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// Largest displacement of any node there [m].
    pub displacement_m: f64,
    /// Why it is there.
    pub reason: &'static str,
}

/// One run of a case.
#[derive(Clone, Copy, Debug)]
pub struct Attempt<'a> {
    /// The solver and the springs.
    pub setting: Setting,
    /// What the controller's passes run on.
    pub level: Level,
    interrupted: &'a AtomicBool,
}

impl<'a> Attempt<'a> {
    /// A run that ends when `interrupted` is set.
    #[must_use]
    pub const fn new(setting: Setting, level: Level, interrupted: &'a AtomicBool) -> Self {
        Self {
            setting,
            level,
            interrupted,
        }
    }

    /// Whether to go on.
    ///
    /// # Errors
    /// [`Unfinished::Interrupted`].
    pub fn go_on(&self) -> Result<(), Unfinished> {
        match self.interrupted.load(Ordering::Relaxed) {
            true => Err(Unfinished::Interrupted),
            false => Ok(()),
        }
    }
}

impl Case {
    /// A case that ends at the undisturbed rest.
    #[must_use]
    pub fn new(name: &str, what: &str, run: fn(&Attempt<'_>) -> Result<Trace, Unfinished>) -> Self {
        Self {
            name: name.to_owned(),
            what: what.to_owned(),
            equilibrium: None,
            run: Box::new(run),
        }
    }

    /// Whether `name` is the case's own or its family's.
    #[must_use]
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || self.family() == name
    }

    /// Its name without the variant.
    #[must_use]
    pub fn family(&self) -> &str {
        self.name.split_once(':').map_or(&self.name, |(family, _)| family)
    }
}

impl Debug for Case {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Why a run has no trace; one line each.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfinished {
    /// A formula foretells that the solver would be unstable.
    #[error("{solver} is unstable on this lattice: explicit:{least} is the smallest stable count")]
    Refused {
        /// What was asked for.
        solver: Solver,
        /// The smallest stable count of substeps.
        least: u16,
    },
    /// The scene.
    #[error("the controller refuses its scene: {0:?}")]
    Scene(ConfigError),
    /// The piece of the built-in scene that the case is about.
    #[error("{0}")]
    Built(&'static str),
    /// Ctrl+C.
    #[error("interrupted")]
    Interrupted,
}

impl Unfinished {
    /// What the controller says against a scene with this solver.
    #[must_use]
    pub const fn of(solver: Solver, error: ConfigError) -> Self {
        match error {
            ConfigError::Solver(Refused::Unstable { least }) => Self::Refused { solver, least },
            other => Self::Scene(other),
        }
    }
}
