//! A block of voxels as a scene without a hand, assembled.

use sutura_controller::coupling::{A, Coupling, Kernel, POINTS};
use sutura_controller::lanes::Level;
use sutura_controller::lattice::{Balance, Field, Lattice, Tissue, at};
use sutura_controller::law::Material;
use sutura_controller::math::{Mat3, Vec3};
use sutura_controller::solver::{BePcg, Choice, Problem, Solver, Work, elastic_force, predict};
use sutura_controller::surface::kernel_at;
use sutura_controller::tissue;
use sutura_controller::wound::Faces;
use sutura_shared::scene::{
    self, Body, Contact, Device, Effect, Effects, Law, Output, Pose, Profile, Scene, Segment, Tool,
};

/// Array length: up to 16 × 16 × 10 nodes.
pub(crate) const N: usize = Lattice::<0>::guard([16, 16, 10]) as usize;
/// Voxel edge a [m].
pub(crate) const PITCH: f32 = 2e-3;
/// Density ρ [kg/m³].
pub(crate) const DENSITY: f32 = 1000.0;
/// The solver of the built-in scenes.
pub(crate) const DEFAULT: BePcg = BePcg {
    iterations: 10,
    newton: 1,
};

/// As good as single precision allows.
pub(crate) const CONVERGED: BePcg = BePcg {
    iterations: 400,
    newton: 20,
};

/// A soft tissue of one slope.
pub(crate) fn linear(young: f32) -> scene::Tissue {
    stiffening(&[(0.0, young)])
}

/// A soft tissue of several segments: strain at which each begins, and its slope [Pa].
pub(crate) fn stiffening(segments: &[(f32, f32)]) -> scene::Tissue {
    let curve = segments.iter().map(|(from_strain, slope_pa)| Segment {
        from_strain: *from_strain,
        slope_pa: *slope_pa,
    });
    scene::Tissue {
        density_kg_m3: DENSITY,
        body: Body::Soft {
            curve: curve.collect(),
            sheet: 1.0,
            strength_n: 0.0,
        },
    }
}

/// A scene of `cells` voxels whose uppermost layer of nodes is z = 0 and whose middle is x = y = 0.
pub(crate) fn scene(cells: [u16; 3], law: Law, tissues: &[scene::Tissue], effects: &[Effect]) -> Scene {
    let [x, y, z] = cells.map(|n| f32::from(n) * PITCH);
    let nowhere = Pose {
        position_m: [0.0; 3],
        quaternion: [1.0, 0.0, 0.0, 0.0],
    };
    Scene {
        effects: effects.iter().fold(Effects(0), |all, effect| all.with(*effect)),
        solver: scene::Solver::BePcg {
            iterations: DEFAULT.iterations,
            newton: DEFAULT.newton,
        },
        lattice: scene::Lattice {
            cells,
            pitch_m: PITCH,
            origin_m: [-0.5 * x, -0.5 * y, -z],
            law,
            assembly: scene::Assembly::PerVoxel,
            damping_per_s: 0.0,
            spring_damping_s: 0.0,
        },
        tissues: tissues.iter().cloned().collect(),
        tool: Tool::Ball { radius_m: 2e-3 },
        contact: Contact {
            coupling_n_per_m: 1000.0,
            coupling_n_s_per_m: 1.0,
            kernel_m: 2.0 * PITCH,
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

/// An assembled patch and its state.
pub(crate) struct Block {
    pub(crate) lattice: Box<Lattice<N>>,
    pub(crate) material: Material,
    pub(crate) tissue: Box<Tissue<N>>,
    pub(crate) load: Box<Field<N>>,
    pub(crate) work: Box<Work<N>>,
    /// What the passes run on.
    pub(crate) level: Level,
}

impl Block {
    /// The scene's patch at rest.
    pub(crate) fn new(scene: &Scene, cells: &[u8]) -> Self {
        let mut lattice: Box<Lattice<N>> = bytemuck::zeroed_box();
        let material = tissue::assemble(scene, cells, &mut lattice).unwrap();
        Self {
            lattice,
            material,
            tissue: bytemuck::zeroed_box(),
            load: bytemuck::zeroed_box(),
            work: bytemuck::zeroed_box(),
            level: Level::best(),
        }
    }

    /// Every cell filled with the first tissue.
    pub(crate) fn filled(scene: &Scene) -> Self {
        Self::new(scene, &vec![1; scene.lattice.count()])
    }

    /// Lets every node of the block move, the sides and the bottom too.
    pub(crate) fn release(&mut self) {
        for (free, mass) in self.lattice.free.iter_mut().zip(&self.lattice.mass) {
            *free = if *mass > 0.0 { 1.0 } else { 0.0 };
        }
    }

    /// Column, row and layer of every node of the box with its index.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (usize, [u32; 3])> + use<> {
        self.lattice.nodes().map(|(at, n)| (n, at))
    }

    /// Moves every node to where `displacement` of its rest place says [m].
    pub(crate) fn impose(&mut self, displacement: impl Fn([f64; 3]) -> [f64; 3]) {
        for (n, at) in self.nodes() {
            let u = displacement(at.map(|i| f64::from(i) * f64::from(PITCH)));
            for (component, u) in self.tissue.displacement.iter_mut().zip(u) {
                component[n] = u as f32;
            }
        }
        self.tissue.balance = Balance::default();
    }

    /// Elastic force on the nodes of the upper face across `axis`, summed [N]: what the block pulls back with.
    pub(crate) fn pull(&mut self, axis: usize) -> [f64; 3] {
        let last = self.lattice.nodes[axis] - 1;
        let face: Vec<usize> = self
            .nodes()
            .filter(|(_, at)| at[axis] == last)
            .map(|(n, _)| n)
            .collect();
        let force = self.elastic(None);
        force.map(|component| -face.iter().map(|n| f64::from(component[*n])).sum::<f64>())
    }

    /// Elastic force on every node [N].
    pub(crate) fn elastic(&mut self, faces: Option<&Faces>) -> Field<N> {
        let problem = Problem {
            lattice: &self.lattice,
            material: &self.material,
            coupling: &Coupling::default(),
            faces,
            level: self.level,
        };
        *elastic_force(&problem, &self.tissue, &mut self.work)
    }

    /// The solver of a name, for this patch.
    pub(crate) fn solver(&mut self, name: &str) -> Choice {
        let alone = Problem {
            lattice: &self.lattice,
            material: &self.material,
            coupling: &Coupling::default(),
            faces: None,
            level: self.level,
        };
        let choice = Choice::new(name.parse().unwrap(), &alone, &mut self.work).unwrap();
        self.work.clear();
        choice
    }

    /// One tick; how far the points have moved from their predicted places [m].
    pub(crate) fn tick(
        &mut self,
        solver: impl Solver<N>,
        coupling: &Coupling,
        faces: Option<&Faces>,
    ) -> [Vec3; POINTS] {
        let problem = Problem {
            lattice: &self.lattice,
            material: &self.material,
            coupling,
            faces,
            level: self.level,
        };
        solver.advance(&problem, &self.load, &mut self.tissue, &mut self.work)
    }

    /// Largest displacement of any node [m].
    pub(crate) fn largest(&self) -> f32 {
        self.nodes()
            .map(|(n, _)| at(&self.tissue.displacement, n).norm())
            .fold(0.0, f32::max)
    }

    /// Smallest volume that the three edges at any corner of a voxel span, over a³: not positive where a voxel is inverted. For a full block.
    pub(crate) fn least_volume(&self) -> f32 {
        let place = |corner: [u32; 3]| self.lattice.place(&self.tissue, self.lattice.index(corner));
        let [nx, ny, nz] = self.lattice.nodes;
        let lowest = self
            .nodes()
            .filter(|(_, [i, j, k])| i + 1 < nx && j + 1 < ny && k + 1 < nz);
        let corners =
            lowest.flat_map(|(_, [i, j, k])| (0..8_u32).map(move |c| ([i, j, k], [c & 1, c >> 1 & 1, c >> 2])));
        let volume = |(low, bits): ([u32; 3], [u32; 3])| {
            let corner: [u32; 3] = core::array::from_fn(|a| low[a] + bits[a]);
            let [x, y, z] = [0, 1, 2].map(|a| {
                let mut other = corner;
                other[a] = low[a] + 1 - bits[a];
                (place(other) - place(corner)) * if bits[a] == 0 { 1.0 } else { -1.0 }
            });
            x.cross(&y).dot(&z)
        };
        corners.map(volume).fold(f32::INFINITY, f32::min) / (PITCH * PITCH * PITCH)
    }

    /// Whether all state is finite.
    pub(crate) fn is_finite(&self) -> bool {
        let fields = [&self.tissue.displacement, &self.tissue.velocity];
        fields.into_iter().flatten().flatten().all(|x| x.is_finite())
    }
}

/// A spring from a weighted point of the tissue to a place given as the point's displacement.
#[derive(Clone, Debug)]
pub(crate) struct Hold {
    /// Nodes and weights, summing to one.
    pub(crate) nodes: Vec<(usize, f32)>,
    /// [N/m].
    pub(crate) stiffness: f32,
    /// [m].
    pub(crate) anchor: Vec3,
}

impl Hold {
    /// On the smallest kernel of a tool's tip, in the middle of the upper face.
    pub(crate) fn on_top(block: &Block, stiffness: f32, anchor: Vec3) -> Self {
        Self::within(block, 1.5 * PITCH, stiffness, anchor)
    }

    /// On a tip's kernel of `radius` [m] in the middle of the upper face.
    pub(crate) fn within(block: &Block, radius: f32, stiffness: f32, anchor: Vec3) -> Self {
        let kernel = kernel_at(&block.lattice, &block.tissue, Vec3::zeros(), radius);
        Self {
            nodes: kernel.iter().collect(),
            stiffness,
            anchor,
        }
    }

    /// What it pulls the tissue with [N].
    pub(crate) fn pull(&self, tissue: &Tissue<N>) -> Vec3 {
        let point: Vec3 = self
            .nodes
            .iter()
            .map(|(node, w)| at(&tissue.displacement, *node) * *w)
            .sum();
        (self.anchor - point) * self.stiffness
    }

    /// As the solver takes it: stated at the predicted place.
    pub(crate) fn coupling(&self, tissue: &Tissue<N>) -> Coupling {
        let mut coupling = Coupling::default();
        let mut kernel = Kernel::default();
        self.nodes.iter().for_each(|(node, w)| kernel.push(*node as u32, *w));
        coupling.kernels[A] = kernel;
        let predicted = kernel.gather(&tissue.displacement) + predict(&coupling, tissue)[A];
        coupling.force[A] = (self.anchor - predicted) * self.stiffness;
        coupling.stiffness[A][A] = Mat3::identity() * self.stiffness;
        coupling
    }
}

/// Uniform numbers from −1 to 1: a linear congruential generator (Knuth's MMIX constants), high bits only.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }
}

/// Relative difference.
pub(crate) fn apart(value: f64, expected: f64) -> f64 {
    ((value - expected) / expected).abs()
}
