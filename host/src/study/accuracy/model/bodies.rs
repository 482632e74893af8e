//! The body, once of the lattice and once of finite elements.

use std::collections::HashMap;

use sutura_shared::scene::{Assembly, Law};

use crate::study::accuracy::body::Body;
use crate::study::accuracy::statics::Extent;
use crate::study::block::Spec;
use crate::study::double::{Field, NoEquilibrium, V};
use crate::study::fem::{Elastic, Solid};
use crate::study::poke;

/// Voxels along x, y, z.
const VOXELS: [u32; 3] = [12, 12, 6];
/// Voxels from the middle of the top to the edge of the moved square.
const HALF: u32 = 2;
/// Voxel edge [m].
const PITCH: f64 = 2e-3;
/// E [Pa].
const YOUNG: f64 = 1e5;
/// How far the square is moved [m].
const STROKE: f64 = 0.5e-3;

/// How the square is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Load {
    /// Down.
    Press,
    /// Along x.
    Drag,
}

impl Load {
    pub(super) const ALL: [Self; 2] = [Self::Press, Self::Drag];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Drag => "drag",
        }
    }

    /// Way of the square [m].
    fn way(self) -> V {
        match self {
            Self::Press => V::z() * -STROKE,
            Self::Drag => V::x() * STROKE,
        }
    }

    /// Components held in the planes x = 0 and y = 0 through the middle, of which the body's other three quarters are images.
    const fn held_in_planes(self) -> [[bool; 3]; 2] {
        match self {
            Self::Press => [[true, false, false], [false, true, false]],
            // What is mirrored across x is turned about as well.
            Self::Drag => [[false, true, true], [false, true, false]],
        }
    }
}

/// What the body answers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answer {
    /// Force that holds the square, along its way [N].
    pub(super) force_n: f64,
    /// Displacement of the lattice's nodes in the quarter of positive x and y, x fastest [m].
    shape: Vec<V>,
}

impl Answer {
    /// Root mean square distance of the displacements, over that of the other's.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let pairs = self.shape.iter().zip(&other.shape);
        let (apart, whole) = pairs.fold((0.0, 0.0), |(apart, whole), (a, b)| {
            (apart + (a - b).norm_squared(), whole + b.norm_squared())
        });
        (apart / whole).sqrt()
    }

    /// self + factor · (self − other).
    fn beyond(&self, other: &Self, factor: f64) -> Self {
        let pairs = self.shape.iter().zip(&other.shape);
        Self {
            force_n: self.force_n + factor * (self.force_n - other.force_n),
            shape: pairs.map(|(a, b)| a + (a - b) * factor).collect(),
        }
    }
}

/// Nodes of the lattice in the quarter of positive x and y, counted from the middle.
fn quarter() -> impl Iterator<Item = [u32; 3]> {
    let [x, y, z] = VOXELS;
    (0..=z).flat_map(move |k| (0..=y / 2).flat_map(move |j| (0..=x / 2).map(move |i| [i, j, k])))
}

/// The whole body of the lattice, `refinement` voxels along the edge of one of [`PITCH`].
pub(super) fn lattice(law: Law, assembly: Assembly, load: Load, refinement: u32) -> Result<Answer, poke::Error> {
    let [x, y, z] = VOXELS.map(|n| n * refinement);
    let mut body = Body::new(&Spec {
        nodes: [x, y, z].map(|n| n + 1),
        pitch_m: PITCH / f64::from(refinement),
        young_pa: YOUNG,
        density_kg_m3: 1000.0,
        law,
        assembly,
        stiffening: false,
        damping_per_s: 0.0,
    })?;
    let reach = HALF * refinement;
    let square = |[i, j, k]: [u32; 3]| k == z && i.abs_diff(x / 2) <= reach && j.abs_diff(y / 2) <= reach;
    body.hold(|node| [square(node) || node[2] == 0; 3]);
    let mut at = body.field(|node| if square(node) { load.way() } else { V::zeros() });
    let energy = body.model.relax(&mut at)?;
    let index: HashMap<_, _> = body.nodes.iter().copied().collect();
    let place = |[i, j, k]: [u32; 3]| {
        let node = [x / 2 + i * refinement, y / 2 + j * refinement, k * refinement];
        at.get(index[&node])
    };
    Ok(Answer {
        force_n: 2.0 * energy / STROKE,
        shape: quarter().map(place).collect(),
    })
}

/// A quarter of the body in cubes, `refinement` of them along the edge of a voxel.
pub(super) fn elements(poisson: f64, load: Load, refinement: usize) -> Result<Answer, NoEquilibrium> {
    let [x, y, z] = VOXELS.map(|n| n as usize * refinement);
    let material = Elastic {
        young_pa: YOUNG,
        poisson,
    };
    let mut solid = Solid::new([x / 2, y / 2, z], PITCH / refinement as f64, material);
    let reach = HALF as usize * refinement;
    let square = |[i, j, k]: [usize; 3]| k == z && i <= reach && j <= reach;
    let [in_x, in_y] = load.held_in_planes();
    solid.hold(|node| {
        let [i, j, k] = node;
        let all = k == 0 || square(node);
        std::array::from_fn(|axis| all || (i == 0 && in_x[axis]) || (j == 0 && in_y[axis]))
    });
    let mut at = solid.field(|node| if square(node) { load.way().into() } else { [0.0; 3] });
    let energy = solid.relax(&Field::zeros(at.len()), &mut at)?;
    let place = |node: [u32; 3]| at.get(solid.index(node.map(|n| n as usize * refinement)));
    Ok(Answer {
        force_n: 4.0 * 2.0 * energy / STROKE,
        shape: quarter().map(place).collect(),
    })
}

/// What finite elements tend to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limit {
    pub(super) answer: Answer,
    /// On the lattice's own nodes.
    pub(super) coarsest: Answer,
    /// Force of the finest mesh [N].
    pub(super) finest_n: f64,
    /// By what a mesh twice as fine divides the error.
    gain: f64,
}

impl Limit {
    /// Of meshes each twice as fine as the one before: of two with errors of the first order, which is what the edge of a held square
    /// allows; of three with the order that they show (Aitken).
    pub(super) fn new(load: Load, poisson: f64, extent: Extent) -> Result<Self, NoEquilibrium> {
        let [coarse, middle] = [elements(poisson, load, 1)?, elements(poisson, load, 2)?];
        let (gain, before, finest) = match extent {
            Extent::Quick => (2.0, &coarse, middle),
            Extent::Whole => {
                let fine = elements(poisson, load, 4)?;
                let gain = (middle.force_n - coarse.force_n) / (fine.force_n - middle.force_n);
                (gain, &middle, fine)
            }
        };
        let mut limit = Self {
            answer: finest.clone(),
            finest_n: finest.force_n,
            gain,
            coarsest: coarse.clone(),
        };
        limit.answer = limit.of(before, &finest);
        Ok(limit)
    }

    /// What two bodies tend to, the second with half the edge of the first, whose errors fall as those of the elements do.
    pub(super) fn of(&self, coarse: &Answer, fine: &Answer) -> Answer {
        fine.beyond(coarse, 1.0 / (self.gain - 1.0))
    }
}
