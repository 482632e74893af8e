//! Prints what every solver leaves of a block under a moved node, as a hash of its bits: one line a solver, the same on every
//! instruction level of this processor, or it fails. Whoever builds it otherwise compares the lines.

use std::process::ExitCode;

use sutura_controller::coupling::{A, Coupling, Kernel};
use sutura_controller::hash::Hasher;
use sutura_controller::lanes::Level;
use sutura_controller::lattice::{Field, Lattice, STEPS, Tissue, at};
use sutura_controller::law::{BARRIER, Curve, Material, Stiffness, stiffness};
use sutura_controller::math::{Mat3, Vec3};
use sutura_controller::solver::{Choice, Problem, Solver, Work};
use sutura_shared::scene::{self, Law, Segment};

/// Nodes along x, y, z: layers that do not fill whole vectors.
const NODES: [u32; 3] = [11, 9, 6];
const N: usize = Lattice::<0>::guard(NODES) as usize;
const PITCH: f32 = 2e-3;
const YOUNG: f32 = 1e5;
const TICKS: u32 = 120;
const SOLVERS: [scene::Solver; 5] = [
    scene::Solver::Explicit { substeps: 0 },
    scene::Solver::BePcg {
        iterations: 10,
        newton: 1,
    },
    scene::Solver::BePcg {
        iterations: 5,
        newton: 2,
    },
    scene::Solver::BeChebyshev { iterations: 10 },
    scene::Solver::Vbd { sweeps: 4, omega: 1.5 },
];
const LAWS: [Law; 2] = [Law::Isotropic, Law::Volume { poisson: 0.45 }];

fn main() -> ExitCode {
    let mut same = true;
    for (law, solver) in LAWS.into_iter().flat_map(|law| SOLVERS.map(|solver| (law, solver))) {
        let hashes: Vec<_> = Level::all()
            .map(|level| (level.name(), hash(law, solver, level)))
            .collect();
        let Some((_, Some(first))) = hashes.first() else {
            eprintln!("error: {solver} is refused");
            same = false;
            continue;
        };
        println!("{} {solver} {first:016x}", law.name());
        for (name, hash) in hashes.iter().filter(|(_, hash)| *hash != Some(*first)) {
            eprintln!("error: {solver} on {name} gives {hash:x?}");
            same = false;
        }
    }
    if same { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The bits after a node was lifted and dragged while a tool's spring pulled at others.
fn hash(law: Law, solver: scene::Solver, level: Level) -> Option<u64> {
    let stiffness = stiffness(law);
    let lattice = block(stiffness);
    let mut material = Material {
        stiffening: true,
        mass_damping: 50.0,
        spring_damping: 1e-4,
        volume: matches!(law, Law::Volume { .. }),
        ..Material::default()
    };
    let slopes = [(0.0, 1.0), (0.03, 4.0), (0.06, 10.0)].map(|(from_strain, slope)| Segment {
        from_strain,
        slope_pa: slope * YOUNG,
    });
    material.curves[0] = Curve::new(&slopes, stiffness);
    let mut tissue: Box<Tissue<N>> = bytemuck::zeroed_box();
    let mut work: Box<Work<N>> = bytemuck::zeroed_box();
    let load: Box<Field<N>> = bytemuck::zeroed_box();
    let mut coupling = pull(&lattice);
    let patch = (&*lattice, &material);
    let Ok(choice) = Choice::new(solver, &problem(patch, &coupling, level), &mut work) else {
        return None;
    };
    work.clear();
    let moved = lattice.index([5, 4, 5]);
    for tick in 0..TICKS {
        let phase = tick as f32 / TICKS as f32;
        let velocity = [0.05 - 0.1 * phase, 0.02, 0.03];
        tissue
            .velocity
            .iter_mut()
            .zip(velocity)
            .for_each(|(part, v)| part[moved] = v);
        let [x, y, z] = coupling.gather(&tissue.displacement)[A].into();
        coupling.force[A] = Vec3::new(-x, 1e-3 - y, -1e-3 - z) * 400.0;
        choice.advance(&problem(patch, &coupling, level), &load, &mut tissue, &mut work);
    }
    let mut hasher = Hasher::default();
    for (_, node) in lattice.nodes() {
        hasher.vector(at(&tissue.displacement, node));
        hasher.vector(at(&tissue.velocity, node));
    }
    Some(hasher.get())
}

fn problem<'a>(
    (lattice, material): (&'a Lattice<N>, &'a Material),
    coupling: &'a Coupling,
    level: Level,
) -> Problem<'a, N> {
    Problem {
        lattice,
        material,
        coupling,
        faces: None,
        level,
    }
}

/// A block on a held bottom with one held node on top.
fn block(stiffness: Stiffness) -> Box<Lattice<N>> {
    let mut lattice: Box<Lattice<N>> = bytemuck::zeroed_box();
    (lattice.nodes, lattice.pitch) = (NODES, PITCH);
    let all: Vec<_> = lattice.nodes().collect();
    for (node, index) in all {
        lattice.mass[index] = 1000.0 * PITCH * PITCH * PITCH;
        lattice.free[index] = if node[2] == 0 || node == [5, 4, 5] { 0.0 } else { 1.0 };
        for (direction, step) in STEPS.iter().enumerate() {
            let inside = |axis: usize| (0..NODES[axis] as i32).contains(&(node[axis] as i32 + step[axis]));
            if (0..3).all(inside) {
                let over_ea = if direction < 3 {
                    stiffness.edge
                } else {
                    stiffness.diagonal
                };
                lattice.stiffness[0][direction][index] = over_ea * YOUNG * PITCH;
            }
        }
        if (0..3).all(|axis| node[axis] + 1 < NODES[axis]) {
            lattice.volume[index] = stiffness.volume * YOUNG;
            lattice.barrier[index] = BARRIER * YOUNG;
        }
    }
    lattice
}

/// A tool's spring on four nodes.
fn pull(lattice: &Lattice<N>) -> Coupling {
    let mut coupling = Coupling::default();
    let mut kernel = Kernel::default();
    for node in [[2, 2, 5], [3, 2, 5], [2, 3, 5], [3, 3, 5]] {
        kernel.push(lattice.index(node) as u32, 0.25);
    }
    coupling.kernels[A] = kernel;
    coupling.stiffness[A][A] = Mat3::identity() * 400.0;
    coupling
}
