//! The error of a solver's force: one node of a tissue is moved on some ways, as `sutura poke` does it, and its reaction compared with the
//! converged one.
//!
//! Converged is the same equation in single precision, solved on with [`CONVERGED`]; a test holds it to the double-precision reference.

use std::sync::atomic::{AtomicBool, Ordering};

use sutura_controller::lanes::Level;
use sutura_shared::scene::Solver;

use super::Interrupted;
use crate::run::report::TickTime;
use crate::study::block::Block;
use crate::study::double::{Model, V};
use crate::study::method::Method;
use crate::study::path::Course;
use crate::study::poke::drive::Poke;

/// The solver that converges: on the lattices that a controller holds its force is good to 1e-5.
pub const CONVERGED: Solver = Solver::BePcg {
    iterations: 60,
    newton: 6,
};

/// A tissue, what moves it, and its converged answer.
pub struct Probe<'a> {
    ways: Vec<Way>,
    ticks: u32,
    model: Model,
    substeps: Option<u16>,
    interrupted: &'a AtomicBool,
}

/// One way, and the converged reaction at each tick [N].
struct Way {
    poke: Poke,
    converged: Vec<V>,
}

impl<'a> Probe<'a> {
    /// Moves `node` of the block, which becomes a held one, for some ticks on each of the courses.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn new(
        (mut block, node): (Block, usize),
        (courses, ticks): (&[Course], u32),
        level: Level,
        interrupted: &'a AtomicBool,
    ) -> Result<Self, Interrupted> {
        // Of the tissue as it came: a node less to move has a fastest mode a little slower.
        let explicit = Method::explicit(0).build(&block, level).ok();
        let substeps = explicit.and_then(|(method, _)| method.explicit_substeps());
        block
            .lattice
            .free
            .iter_mut()
            .skip(node)
            .take(1)
            .for_each(|free| *free = 0.0);
        let model = Model::new(&block.lattice, &block.material);
        let mut probe = Self {
            ways: Vec::new(),
            ticks,
            model,
            substeps,
            interrupted,
        };
        for &course in courses {
            let block = block.clone();
            let poke = Poke {
                block,
                node,
                course,
                level,
            };
            let (converged, _) = probe.reactions(&poke, CONVERGED)?;
            probe.ways.push(Way { poke, converged });
        }
        Ok(probe)
    }

    /// The fewest explicit substeps that are stable on this tissue.
    #[must_use]
    pub const fn substeps(&self) -> Option<u16> {
        self.substeps
    }

    /// Error of a solver's force, as of [`super::Row::force_error`]; `None` where it is no number.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn error(&self, solver: Solver) -> Result<Option<f64>, Interrupted> {
        let mut worst = 0.0_f64;
        for Way { poke, converged } in &self.ways {
            let (forces, _) = self.reactions(poke, solver)?;
            let wrong: f64 = forces.iter().zip(converged).map(|(a, b)| (a - b).norm_squared()).sum();
            let whole: f64 = converged.iter().map(V::norm_squared).sum();
            let error = (wrong / whole).sqrt();
            if forces.len() < converged.len() || !error.is_finite() {
                return Ok(None);
            }
            worst = worst.max(error);
        }
        Ok(Some(worst))
    }

    /// CPU time of the solve alone, on the first of the ways.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn time(&self, solver: Solver) -> Result<Option<TickTime>, Interrupted> {
        let Some(Way { poke, converged }) = self.ways.first() else {
            return Ok(None);
        };
        let (forces, ns) = self.reactions(poke, solver)?;
        Ok((forces.len() == converged.len()).then(|| TickTime::of(ns)))
    }

    /// Reaction and CPU time [ns] of every tick; none for a solver that the block does not allow.
    fn reactions(&self, poke: &Poke, solver: Solver) -> Result<(Vec<V>, Vec<u64>), Interrupted> {
        let (mut forces, mut times) = (Vec::new(), Vec::new());
        let Ok((_, method)) = Method::Controller(solver).build(&poke.block, poke.level) else {
            return Ok((forces, times));
        };
        poke.run(&*method, self.ticks, |state, ns| {
            times.push(ns);
            forces.push(self.model.reaction(poke.node, |node| state.displacement(node)));
            if self.interrupted.load(Ordering::Relaxed) {
                Err(Interrupted)
            } else {
                Ok(())
            }
        })?;
        Ok((forces, times))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::embedded::NODES_MAX;
    use crate::scene::{self, build::build};
    use crate::study::double::{March, Moved};
    use crate::study::path::Path;
    use sutura_shared::scene::{Effect, Effects};

    /// The built-in scene's stiffening layers around its wound, without dashpots, which the reference in double precision has not: far less
    /// apart than the 0.1 % below which solvers are told apart no more.
    #[test]
    fn what_counts_as_converged_is() {
        let mut built = build(&scene::load(None).unwrap(), NODES_MAX).unwrap();
        let effects = Effect::ALL
            .into_iter()
            .filter(|effect| built.scene.effects.has(*effect));
        let without = effects.filter(|effect| *effect != Effect::SpringDamping);
        built.scene.effects = without.fold(Effects(0), Effects::with);
        let block = Block::of(&built.scene, &built.cells).unwrap();
        let node = block.lattice.top(7, 8).unwrap();
        let courses = [Path::Drag, Path::Tap].map(|path| Course { path, ramp_s: 0.02 });
        let go_on = AtomicBool::new(false);
        let probe = Probe::new((block, node), (&courses, 30), Level::best(), &go_on).unwrap();
        for Way { poke, converged } in &probe.ways {
            let mut march = March::new(&probe.model);
            let (mut wrong, mut whole) = (0.0, 0.0);
            for (tick, force) in (1..).zip(converged) {
                let place = V::from(poke.place(tick).map(f64::from));
                march.backward_euler(Moved { node, place }).unwrap();
                let expected = probe.model.reaction(node, |node| march.displacement.get(node));
                wrong += (force - expected).norm_squared();
                whole += expected.norm_squared();
            }
            let error = (wrong / whole).sqrt();
            assert!(error < 2e-5, "{:?}: {error:e}", poke.course);
        }
        assert!(probe.error(CONVERGED).unwrap().unwrap() <= 0.0);
    }

    #[test]
    fn fewer_iterations_are_further_from_the_converged_force() {
        let spec = crate::study::block::Spec {
            nodes: [8, 8, 4],
            pitch_m: 2e-3,
            young_pa: 1e5,
            density_kg_m3: 1000.0,
            law: sutura_shared::scene::Law::Isotropic,
            assembly: sutura_shared::scene::Assembly::PerVoxel,
            stiffening: true,
            damping_per_s: 50.0,
        };
        let mut block = Block::new(&spec).unwrap();
        block.hold_bottom();
        let node = block.lattice.index([4, 4, 3]);
        let courses = [Course {
            path: Path::Drag,
            ramp_s: 0.02,
        }];
        let go_on = AtomicBool::new(false);
        let probe = Probe::new((block, node), (&courses, 60), Level::best(), &go_on).unwrap();
        let error = |solver: &str| probe.error(solver.parse().unwrap()).unwrap().unwrap();
        let errors = ["be-pcg:2:1", "be-pcg:10:1", "be-pcg:20:3"].map(error);
        assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
        // Fewer substeps than are stable are no solver here.
        assert_eq!(probe.error("explicit:1".parse().unwrap()), Ok(None));
        assert!(probe.substeps().is_some_and(|least| least > 1));
    }
}
