//! A box of the lattice at rest, in double precision, as large as a study wants it.

use bytemuck::zeroed_box;
use sutura_controller::lattice::Lattice;
use sutura_controller::tissue;

use crate::study::block::{self, Spec};
use crate::study::double::{Field, Model, V};

/// Array length of the largest box: a cube of 48 voxels, three quarters of a million springs.
const CAPACITY: usize = Lattice::<0>::guard([49; 3]) as usize;

/// A box of which nothing is held yet.
pub(super) struct Body {
    /// The springs and what of them is held.
    pub(super) model: Model,
    /// Node (i, j, k) and its index; x is fastest.
    pub(super) nodes: Vec<([u32; 3], usize)>,
}

impl Body {
    /// A full box, as the controller assembles it.
    pub(super) fn new(spec: &Spec) -> Result<Self, block::Error> {
        let scene = block::scene(spec);
        let mut lattice = zeroed_box::<Lattice<CAPACITY>>();
        let cells = vec![1; scene.lattice.count()];
        let material = tissue::assemble(&scene, &cells, &mut lattice).map_err(block::Error::Assembly)?;
        Ok(Self {
            model: Model::new(&lattice, &material),
            nodes: lattice.nodes().collect(),
        })
    }

    /// Holds the components that `held` says of node (i, j, k), and no others.
    pub(super) fn hold(&mut self, held: impl Fn([u32; 3]) -> [bool; 3]) {
        let mut by_index = vec![[true; 3]; self.model.len()];
        for (node, index) in &self.nodes {
            by_index[*index] = held(*node);
        }
        self.model.hold(|index| by_index[index]);
    }

    /// The vector that `of` gives of node (i, j, k).
    pub(super) fn field(&self, of: impl Fn([u32; 3]) -> V) -> Field {
        let mut field = Field::zeros(self.model.len());
        for (node, index) in &self.nodes {
            field.set(*index, of(*node));
        }
        field
    }
}
