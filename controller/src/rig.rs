//! The controller with a simulated device in a simulated hand: what stands behind the frames where there is no real arm.

use crate::device::Device;
use crate::device::sim::Simulated;
use crate::hash::Hasher;
use crate::lanes::Level;
use crate::link::{LoadError, Loaded, Plant};
use crate::record::Output;
use crate::safety::LimitedForce;
use crate::thread;
use crate::tick::{ConfigError, Controller, Memory};
use crate::tissue;
use sutura_shared::scene::Scene;

/// Every so many ticks all live state enters the hash, not the output alone.
const HASH_ALL: u32 = 1000;

/// Controller, device and the hash of all they do.
#[derive(Debug)]
pub struct Rig<'m, const N: usize> {
    controller: Controller<'m, N>,
    device: Option<Simulated>,
    force: LimitedForce,
    hash: Hasher,
}

impl<'m, const N: usize> Rig<'m, N> {
    /// A rig without a scene, in this memory. Its passes run on `level`.
    #[must_use]
    pub fn new(memory: &'m mut Memory<N>, level: Level) -> Self {
        Self {
            controller: Controller::new(memory, level),
            device: None,
            force: LimitedForce::default(),
            hash: Hasher::default(),
        }
    }

    /// The simulated device; `None` without a scene.
    #[must_use]
    pub const fn device(&self) -> Option<&Simulated> {
        self.device.as_ref()
    }

    /// The controller, for reports.
    #[must_use]
    pub const fn controller(&self) -> &Controller<'m, N> {
        &self.controller
    }

    /// The force that the device is told now, device frame; zero while no tick is granted, and without a scene.
    #[must_use]
    pub const fn force(&self) -> LimitedForce {
        self.force
    }

    /// The hash with all live state.
    fn hash_all(&self) -> Hasher {
        let mut hash = self.hash;
        self.controller.add_to(&mut hash);
        let words = self.device.iter().flat_map(|device| device.state().words());
        words.for_each(|word| hash.word(word));
        hash
    }
}

impl<const N: usize> Plant for Rig<'_, N> {
    fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<Loaded, LoadError> {
        self.stop();
        let hand = scene
            .hand
            .as_ref()
            .ok_or(LoadError("hand: a simulated device needs one"))?;
        let device = Simulated::new(&scene.device, hand)
            .map_err(|_| LoadError("hand.start: within 100 mm of the device's origin"))?;
        self.controller
            .load(scene, cells)
            .map_err(|error| LoadError(what_fits(error)))?;
        self.device = Some(device);
        self.hash = Hasher::default();
        let nodes = self
            .controller
            .lattice()
            .mass
            .iter()
            .filter(|mass| **mass > 0.0)
            .count();
        let voxels = cells.iter().filter(|cell| **cell != 0).count();
        Ok(Loaded {
            voxels: voxels as u32,
            nodes: nodes as u32,
        })
    }

    fn tick(&mut self) -> Output {
        let Some(device) = &mut self.device else {
            return Output::idle();
        };
        let output = self.controller.tick(&device.sense());
        device.actuate(&output);
        self.force = output.rendered;
        for word in [output.tick, output.stage as u32, output.faults.0] {
            self.hash.word(word);
        }
        self.hash.vector(output.simulated);
        self.hash.vector(output.rendered.get());
        if output.tick.is_multiple_of(HASH_ALL) {
            self.hash = self.hash_all();
        }
        output
    }

    fn state_hash(&self) -> u64 {
        self.hash_all().get()
    }

    // The simulated device knows no time between ticks: its motors hold over a whole tick what that tick told them.
    fn release(&mut self) {
        self.force = LimitedForce::default();
    }

    fn stop(&mut self) {
        self.device = None;
        self.release();
    }
}

/// What would be right instead.
const fn what_fits(error: ConfigError) -> &'static str {
    match error {
        ConfigError::Tissue(tissue::Error::TooManyNodes { .. }) => {
            "lattice.cells: fewer nodes than the controller's capacity"
        }
        ConfigError::Tissue(tissue::Error::CellCount) => "cells: as many as lattice.cells says",
        ConfigError::Tissue(tissue::Error::UnknownTissue) => "cells: tissues of the scene only",
        ConfigError::Tissue(tissue::Error::TooManyCurves) => "tissues: at most three soft ones",
        ConfigError::Tissue(tissue::Error::Empty) => "cells: at least one filled",
        ConfigError::Thread(thread::ConfigError::Nodes(_)) => "thread.nodes: within the controller's capacity",
        ConfigError::Thread(thread::ConfigError::Link) => "thread.link_m: at least 2 mm",
        ConfigError::Thread(thread::ConfigError::Coefficient(name)) => name,
        ConfigError::Solver(_) => "solver: explicit without a number takes as few as are stable",
        ConfigError::Stitches => "stitch.count: within the controller's capacity",
        ConfigError::Wound => "wound: at most 1,024 pairs of facing nodes",
        ConfigError::NoSkinAtSite => "stitch: skin where the thread's tail is held",
    }
}
