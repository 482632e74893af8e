//! What law and assembly cost: blocks of the lattice against converged finite elements of the same body, at small strain.
//!
//! The body: 12 × 12 × 6 voxels of 2 mm, bottom held, sides free; a square of 5 × 5 nodes in the middle of its top is moved by 0.5 mm, down
//! or aside, and held in all components, as a tool holds the nodes of its kernel. Its force is 2U/δ by the energy U.
//!
//! The reference is [`crate::study::fem`], first on the lattice's own nodes, then on refinements, extrapolated. It has the E asked for
//! and the law's own ν; the laws `axial` and `paper` state none and are held against 0.25, that of isotropic central springs.

mod bodies;

use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;
use sutura_shared::scene::{Assembly, Law};

use self::bodies::{Limit, Load};
use super::statics::{self, Extent};
use crate::study::{parallel, poke};

/// ν of the elements, the tightest first: it takes longest.
const POISSONS: [f64; 4] = [0.49, 0.45, 0.3, 0.25];
/// Of tissue, which keeps its volume nearly: the first of these.
const TISSUE: usize = 0;
/// The laws, and which of these each is compared with.
const LAWS: [(Law, usize); 7] = [
    (Law::Isotropic, 3),
    (Law::Axial, 3),
    (Law::Paper, 3),
    (Law::Volume { poisson: 0.25 }, 3),
    (Law::Volume { poisson: 0.3 }, 2),
    (Law::Volume { poisson: 0.45 }, 1),
    (Law::Volume { poisson: 0.49 }, TISSUE),
];
const ASSEMBLIES: [(Assembly, &str); 2] = [(Assembly::PerVoxel, "per-voxel"), (Assembly::EveryEdge, "every-edge")];
/// Time of the elements over that of a lattice at two pitches.
const MESHED: usize = 6;

/// One law, assembled one way, under one load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The law's name.
    pub law: &'static str,
    /// ν of the elements: the law's own, 0.25 of a law that states none.
    pub poisson: f64,
    /// `per-voxel` or `every-edge`.
    pub assembly: &'static str,
    /// `press` or `drag`.
    pub load: &'static str,
    /// Of the lattice [N].
    pub force_n: f64,
    /// Of the elements, converged [N].
    pub fem_n: f64,
    /// Force over that of the elements, minus one.
    pub force_error: f64,
    /// Root mean square over the lattice's nodes of the distance between both displacements, over that of the elements' displacement.
    pub shape_error: f64,
    /// Force of the elements on the lattice's own nodes over the converged one, minus one: what the pitch costs without any law.
    pub elements_force_error: f64,
    /// Distance of their displacement, likewise.
    pub elements_shape_error: f64,
    /// Force of the finest elements over the converged one, minus one: what is left to the extrapolation.
    pub fem_left: f64,
    /// Force of the lattice without a pitch, from 2 and 1 mm as if its error fell as that of the elements does, over the elements',
    /// minus one: what law and assembly cost alone, to about a hundredth; none in a quick study.
    pub law_error: Option<f64>,
    /// Force over that of converged elements of ν = 0.49, minus one: what law and pitch cost where the tissue keeps its volume.
    pub tissue_error: f64,
}

/// Solves all; `go_on` may end it between two solves, `progress` is told how much is done, from 0 to 1.
///
/// # Errors
/// That of `go_on`, or a body that does not come to rest: a defect of ours.
pub fn run(
    extent: Extent,
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    progress: &(impl Fn(f64) + Sync),
) -> Result<Vec<Row>, poke::Error> {
    let pairs = POISSONS.map(|poisson| Load::ALL.map(|load| (load, poisson)));
    let pairs = pairs.as_flattened();
    let works: Vec<Work> = works().collect();
    let all = (MESHED * pairs.len() + works.len()) as f64;
    let done = AtomicUsize::new(0);
    let step = |weight| {
        progress((done.fetch_add(weight, Ordering::Relaxed) + weight) as f64 / all);
        go_on()
    };
    let limit = |(load, poisson): &(Load, f64)| -> Result<_, poke::Error> {
        let limit = Limit::new(*load, *poisson, extent)?;
        step(MESHED).map(|()| limit)
    };
    let limits = parallel::map(pairs, statics::workers(), limit)?;
    let row = |work: &Work| {
        let [own, tissue] = [work.poisson, TISSUE].map(|at| &limits[at * Load::ALL.len() + work.load as usize]);
        let row = work.row(extent, own, tissue)?;
        step(1).map(|()| row)
    };
    parallel::map(&works, statics::workers(), row)
}

/// What a row is about.
struct Work {
    law: Law,
    /// Place of its ν among [`POISSONS`].
    poisson: usize,
    assembly: (Assembly, &'static str),
    load: Load,
}

/// All of them.
fn works() -> impl Iterator<Item = Work> {
    let laws = LAWS
        .into_iter()
        .flat_map(|law| ASSEMBLIES.map(|assembly| (law, assembly)));
    laws.flat_map(|((law, poisson), assembly)| {
        Load::ALL.map(|load| Work {
            law,
            poisson,
            assembly,
            load,
        })
    })
}

impl Work {
    /// Beside elements of the law's own ν, and of that of tissue.
    fn row(&self, extent: Extent, own: &Limit, tissue: &Limit) -> Result<Row, poke::Error> {
        let (assembly, name) = self.assembly;
        let lattice = |refinement| bodies::lattice(self.law, assembly, self.load, refinement);
        let here = lattice(1)?;
        let finer = match extent {
            Extent::Quick => None,
            Extent::Whole => Some(lattice(2)?),
        };
        let exact = own.answer.force_n;
        Ok(Row {
            law: self.law.name(),
            poisson: POISSONS[self.poisson],
            assembly: name,
            load: self.load.name(),
            force_n: here.force_n,
            fem_n: exact,
            force_error: here.force_n / exact - 1.0,
            shape_error: here.distance(&own.answer),
            elements_force_error: own.coarsest.force_n / exact - 1.0,
            elements_shape_error: own.coarsest.distance(&own.answer),
            fem_left: own.finest_n / exact - 1.0,
            law_error: finer.map(|finer| own.of(&here, &finer).force_n / exact - 1.0),
            tissue_error: here.force_n / tissue.answer.force_n - 1.0,
        })
    }
}

#[cfg(test)]
mod tests;
