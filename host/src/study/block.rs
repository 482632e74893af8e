//! A plain block of tissue without a scene file: the controller's own lattice, assembled and then held as a study wants it.

use bytemuck::zeroed_box;
use sutura_controller::lattice::{Lattice, PC_NODES};
use sutura_controller::law::Material;
use sutura_controller::tissue;
use sutura_shared::scene::{
    self, Assembly, Body, Contact, Device, Effect, Effects, Law, Output, Pose, Profile, Scene, Segment, Solver, Tool,
};

use crate::run::embedded::NODES_MAX;

/// Slopes over the first one and where they begin: strains of 3 and 6 %.
const STIFFENING: [(f32, f64); 3] = [(0.0, 1.0), (0.03, 4.0), (0.06, 10.0)];

/// What the block is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spec {
    /// Nodes along x, y, z; two or more.
    pub nodes: [u32; 3],
    /// Voxel edge a [m].
    pub pitch_m: f64,
    /// Young's modulus E [Pa], of the first slope.
    pub young_pa: f64,
    /// Density ρ [kg/m³].
    pub density_kg_m3: f64,
    /// From E to springs.
    pub law: Law,
    /// What voxels that share an edge give it.
    pub assembly: Assembly,
    /// Whether the stress–strain curve has slopes 1 : 4 : 10 with breaks at strains of 3 and 6 %.
    pub stiffening: bool,
    /// Mass damping α [1/s].
    pub damping_per_s: f64,
}

/// An assembled block.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Nodes, masses, springs, and what is held.
    pub lattice: Box<Lattice<PC_NODES>>,
    /// What the springs follow.
    pub material: Material,
}

impl Block {
    /// Assembles a block of which the controller holds sides and bottom; mass is ρa³/8 from each voxel around a node.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn new(spec: &Spec) -> Result<Self, Error> {
        let [nx, ny, nz] = spec.nodes;
        let capacity = NODES_MAX as u64;
        // In 64 bits: a user may ask for more than 32 hold.
        let [x, y, z] = spec.nodes.map(u64::from);
        let fits = [x, y, z].iter().all(|n| (2..=256).contains(n)) && x * y * z <= capacity;
        if !fits || Lattice::<0>::guard(spec.nodes) as usize > PC_NODES {
            return Err(Error::Nodes { nodes: [nx, ny, nz] });
        }
        let scene = scene(spec);
        let cells = vec![1; scene.lattice.count()];
        Self::of(&scene, &cells)
    }

    /// Assembles the lattice of a scene: layers, curves of its own.
    ///
    /// # Errors
    /// [`Error::Assembly`].
    pub fn of(scene: &Scene, cells: &[u8]) -> Result<Self, Error> {
        let mut lattice = zeroed_box::<Lattice<PC_NODES>>();
        let material = tissue::assemble(scene, cells, &mut lattice).map_err(Error::Assembly)?;
        Ok(Self { lattice, material })
    }

    /// Lets every node move but those of the bottom layer.
    pub fn hold_bottom(&mut self) {
        for ([_, _, k], index) in self.lattice.nodes() {
            self.lattice.free[index] = if k == 0 { 0.0 } else { 1.0 };
        }
    }

    /// Gives every node the mass `kg`.
    pub fn weigh(&mut self, kg: f32) {
        for (_, index) in self.lattice.nodes() {
            self.lattice.mass[index] = kg;
        }
    }

    /// Distinct springs.
    #[must_use]
    pub fn springs(&self) -> usize {
        tissue::springs(&self.lattice).into_iter().sum()
    }
}

/// A scene that is a full block of one tissue; what a block has no use for is given the plainest value.
#[must_use]
pub fn scene(spec: &Spec) -> Scene {
    let nowhere = Pose {
        position_m: [0.0; 3],
        quaternion: [1.0, 0.0, 0.0, 0.0],
    };
    let effects = if spec.stiffening {
        Effects(0).with(Effect::Stiffening)
    } else {
        Effects(0)
    };
    Scene {
        effects,
        solver: Solver::BePcg {
            iterations: 10,
            newton: 1,
        },
        lattice: scene::Lattice {
            cells: spec.nodes.map(|n| (n - 1) as u16),
            pitch_m: spec.pitch_m as f32,
            origin_m: [0.0; 3],
            law: spec.law,
            assembly: spec.assembly,
            damping_per_s: spec.damping_per_s as f32,
            spring_damping_s: 0.0,
        },
        tissues: std::iter::once(tissue(spec)).collect(),
        tool: Tool::Ball {
            radius_m: spec.pitch_m as f32,
        },
        contact: Contact {
            coupling_n_per_m: 1.0,
            coupling_n_s_per_m: 0.0,
            kernel_m: 2.0 * spec.pitch_m as f32,
        },
        stitch: None,
        thread: None,
        wound: None,
        output: Output {
            scale: 1.0,
            slew_n: 0.5,
            passivity_n_s_per_m: 0.0,
        },
        device: Device {
            profile: Profile::Premium15,
            patch_from_device: nowhere,
        },
        hand: None,
    }
}

fn tissue(spec: &Spec) -> scene::Tissue {
    let segments = if spec.stiffening { STIFFENING.len() } else { 1 };
    let curve = STIFFENING
        .into_iter()
        .take(segments)
        .map(|(from_strain, slope)| Segment {
            from_strain,
            slope_pa: (slope * spec.young_pa) as f32,
        });
    scene::Tissue {
        density_kg_m3: spec.density_kg_m3 as f32,
        body: Body::Soft {
            curve: curve.collect(),
            sheet: 1.0,
            strength_n: 0.0,
        },
    }
}

/// Why there is no such block; one line each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// Too few or too many nodes.
    #[error(
        "{}x{}x{} nodes: 2 or more along each axis are needed, at most 256, and as many in all as 24x24x12",
        nodes[0], nodes[1], nodes[2]
    )]
    Nodes {
        /// Nodes along x, y, z.
        nodes: [u32; 3],
    },
    /// The controller refuses it.
    #[error("the block cannot be assembled: {0:?}")]
    Assembly(tissue::Error),
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: Spec = Spec {
        nodes: [8, 8, 4],
        pitch_m: 2e-3,
        young_pa: 1e5,
        density_kg_m3: 1000.0,
        law: Law::Paper,
        assembly: Assembly::EveryEdge,
        stiffening: false,
        damping_per_s: 50.0,
    };

    /// 7·8·4 edges along x and along y, 8·8·3 along z, four diagonals in each of 7·7·3 voxels.
    #[test]
    fn a_block_has_its_springs_and_its_bottom_held() {
        let mut block = Block::new(&SPEC).unwrap();
        assert_eq!(block.springs(), 2 * 7 * 8 * 4 + 8 * 8 * 3 + 4 * 7 * 7 * 3);
        block.hold_bottom();
        let held = block.lattice.free.iter().take(256).filter(|free| **free <= 0.0);
        assert_eq!(held.count(), 64);
    }

    #[test]
    fn a_block_beyond_the_capacity_is_refused() {
        for nodes in [[1, 8, 4], [24, 24, 24], [2000, 2, 2], [u32::MAX; 3]] {
            let error = Block::new(&Spec { nodes, ..SPEC }).unwrap_err();
            assert_eq!(error, Error::Nodes { nodes });
        }
        assert!(
            Block::new(&Spec {
                nodes: [24, 24, 12],
                ..SPEC
            })
            .is_ok()
        );
    }
}
