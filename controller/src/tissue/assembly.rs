//! From voxels to masses and springs: each voxel gives ρa³/8 to its eight corners, k_n/4 to its twelve edges
//! and k_d to its four body diagonals. Assembled by [`Assembly::EveryEdge`], an edge has instead the mean of its voxels' k_n.
//!
//! Bone, the sides and the bottom of the patch are held. A sheet thinner than a voxel has all but its upright edges
//! scaled by thickness over pitch: E t of the membrane is what the hand feels.

use crate::lattice::{DIRECTIONS, EDGES, Lattice, STEPS};
use crate::law::{self, Curve, Material};
use sutura_shared::scene::{self, Assembly, Body, Effect, Law, Scene};

/// Why a lattice cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// More nodes than the controller's capacity.
    TooManyNodes {
        /// Nodes of the scene's box.
        nodes: u32,
        /// What fits.
        capacity: u32,
    },
    /// The cells are not as many as the lattice says.
    CellCount,
    /// A cell names a tissue that the scene does not have.
    UnknownTissue,
    /// More soft tissues than stress–strain curves that a spring can hold.
    TooManyCurves,
    /// No cell is filled.
    Empty,
}

/// Fills `lattice` in place from the scene and its cells.
///
/// # Errors
///
/// See [`Error`]; `lattice` holds no scene after one.
pub fn assemble<const N: usize>(scene: &Scene, cells: &[u8], lattice: &mut Lattice<N>) -> Result<Material, Error> {
    clear(lattice);
    let grid = &scene.lattice;
    let [cx, cy, cz] = grid.cells.map(u32::from);
    let nodes = (cx + 1) * (cy + 1) * (cz + 1);
    if Lattice::<N>::guard([cx + 1, cy + 1, cz + 1]) as usize > N {
        return Err(Error::TooManyNodes {
            nodes,
            capacity: N as u32,
        });
    }
    if cells.len() != (cx * cy * cz) as usize {
        return Err(Error::CellCount);
    }
    if cells.iter().all(|cell| *cell == 0) {
        return Err(Error::Empty);
    }
    let mut material = Material {
        stiffening: scene.effects.has(Effect::Stiffening),
        volume: has_barrier(scene),
        mass_damping: grid.damping_per_s,
        spring_damping: if scene.effects.has(Effect::SpringDamping) {
            grid.spring_damping_s
        } else {
            0.0
        },
        ..Material::default()
    };
    let parts = parts(scene, &mut material)?;
    lattice.nodes = [cx + 1, cy + 1, cz + 1];
    lattice.pitch = grid.pitch_m;
    lattice.origin = grid.origin_m;
    let bricks = (0..cz).flat_map(|k| (0..cy).flat_map(move |j| (0..cx).map(move |i| [i, j, k])));
    for (corner, cell) in bricks.zip(cells) {
        let Some(tissue) = usize::from(*cell).checked_sub(1) else {
            continue;
        };
        let Some(part) = parts.get(tissue).copied().flatten() else {
            clear(lattice);
            return Err(Error::UnknownTissue);
        };
        add_voxel(lattice, corner, part);
    }
    if let Assembly::EveryEdge = grid.assembly {
        let soft = |cell: u8| {
            let part = usize::from(cell).checked_sub(1).and_then(|tissue| parts.get(tissue));
            part.copied().flatten().is_some_and(|part| part.springs.is_some())
        };
        make_edges_whole(lattice, |[i, j, k]| {
            let inside = i < cx && j < cy && k < cz;
            let cell = || cells.get(((k * cy + j) * cx + i) as usize);
            inside && cell().is_some_and(|cell| soft(*cell))
        });
    }
    hold_boundary(lattice);
    find_tops(lattice);
    Ok(material)
}

/// What one voxel of a tissue gives.
#[derive(Clone, Copy)]
struct Part {
    /// ρa³/8 [kg].
    mass: f32,
    /// `None` for bone.
    springs: Option<Springs>,
}

/// Springs of one voxel.
#[derive(Clone, Copy)]
struct Springs {
    /// Slot of their curve.
    slot: usize,
    /// One edge in the plane [N/m].
    flat: f32,
    /// One upright edge [N/m].
    upright: f32,
    /// One diagonal [N/m].
    diagonal: f32,
    /// Λ [Pa].
    volume: f32,
    /// B [Pa].
    barrier: f32,
}

/// Whether voxels resist being turned inside out.
fn has_barrier(scene: &Scene) -> bool {
    matches!(scene.lattice.law, Law::Volume { .. }) || scene.effects.has(Effect::Barrier)
}

fn parts(scene: &Scene, material: &mut Material) -> Result<[Option<Part>; scene::TISSUES_MAX], Error> {
    let a = scene.lattice.pitch_m;
    let stiffness = law::stiffness(scene.lattice.law);
    let barrier = if has_barrier(scene) { law::BARRIER } else { 0.0 };
    let mut parts = [None; scene::TISSUES_MAX];
    let mut soft = 0;
    for (part, tissue) in parts.iter_mut().zip(&scene.tissues) {
        let springs = match &tissue.body {
            Body::Fixed => None,
            Body::Soft { curve, sheet, .. } => {
                let curve = Curve::new(curve, stiffness);
                // Without stiffening every spring is linear, so one slot holds them all.
                let slot = if material.stiffening { soft } else { 0 };
                soft += 1;
                *material.curves.get_mut(slot).ok_or(Error::TooManyCurves)? = curve;
                let ea = curve.young * a;
                let edge = stiffness.edge * ea / 4.0;
                Some(Springs {
                    slot,
                    flat: edge * sheet,
                    upright: edge,
                    diagonal: stiffness.diagonal * ea * sheet,
                    volume: stiffness.volume * curve.young * sheet,
                    barrier: barrier * curve.young * sheet,
                })
            }
        };
        *part = Some(Part {
            mass: tissue.density_kg_m3 * a * a * a / 8.0,
            springs,
        });
    }
    Ok(parts)
}

fn clear<const N: usize>(lattice: &mut Lattice<N>) {
    lattice.nodes = [0; 3];
    lattice.mass.fill(0.0);
    lattice.free.fill(0.0);
    lattice.stiffness.iter_mut().flatten().for_each(|k| k.fill(0.0));
    lattice.volume.fill(0.0);
    lattice.barrier.fill(0.0);
    lattice.top.fill(0);
}

fn add_voxel<const N: usize>(lattice: &mut Lattice<N>, [i, j, k]: [u32; 3], part: Part) {
    for corner in 0..8_u32 {
        let index = lattice.index([i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)]);
        if let (Some(mass), Some(free)) = (lattice.mass.get_mut(index), lattice.free.get_mut(index)) {
            // A node that bone has taken stays held.
            let held = part.springs.is_none() || (*mass > 0.0 && *free <= 0.0);
            *mass += part.mass;
            *free = if held { 0.0 } else { 1.0 };
        }
    }
    let Some(springs) = part.springs else {
        return;
    };
    let lowest = lattice.index([i, j, k]);
    if let (Some(volume), Some(barrier)) = (lattice.volume.get_mut(lowest), lattice.barrier.get_mut(lowest)) {
        (*volume, *barrier) = (springs.volume, springs.barrier);
    }
    for (direction, step) in STEPS.iter().enumerate() {
        let stiffness = match direction {
            2 => springs.upright,
            0..EDGES => springs.flat,
            _ => springs.diagonal,
        };
        let ends = if direction < EDGES { 4 } else { 1 };
        for end in 0..ends {
            let [x, y, z] = lower_end(*step, direction, end);
            let index = lattice.index([i + x, j + y, k + z]);
            let all = lattice
                .stiffness
                .get_mut(springs.slot)
                .and_then(|s| s.get_mut(direction));
            if let Some(total) = all.and_then(|s| s.get_mut(index)) {
                *total += stiffness;
            }
        }
    }
}

/// From k_n/4 of each voxel around an edge to the mean of their k_n; `soft` says of a cell, inside the box or not, whether it has springs.
fn make_edges_whole<const N: usize>(lattice: &mut Lattice<N>, soft: impl Fn([u32; 3]) -> bool) {
    let [nx, ny, nz] = lattice.nodes;
    for direction in 0..EDGES {
        for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
            let around = (0..4).filter(|end| {
                let [x, y, z] = lower_end([0; 3], direction, *end);
                soft([i.wrapping_sub(x), j.wrapping_sub(y), k.wrapping_sub(z)])
            });
            let share = 4.0 / around.count().max(1) as f32;
            let index = lattice.index([i, j, k]);
            let springs = lattice.stiffness.iter_mut().filter_map(|s| s.get_mut(direction));
            springs.filter_map(|s| s.get_mut(index)).for_each(|k| *k *= share);
        }
    }
}

/// Corner of a voxel where its `end`th spring of a direction begins.
fn lower_end([x, y, _]: [i32; 3], direction: usize, end: u32) -> [u32; 3] {
    let (a, b) = (end & 1, end >> 1);
    match direction {
        0 => [0, a, b],
        1 => [a, 0, b],
        2 => [a, b, 0],
        _ => [u32::from(x < 0), u32::from(y < 0), 0],
    }
}

fn hold_boundary<const N: usize>(lattice: &mut Lattice<N>) {
    let [nx, ny, _] = lattice.nodes;
    for ([i, j, k], index) in lattice.nodes() {
        let side = i == 0 || i + 1 == nx || j == 0 || j + 1 == ny || k == 0;
        if let (true, Some(free)) = (side, lattice.free.get_mut(index)) {
            *free = 0.0;
        }
    }
}

fn find_tops<const N: usize>(lattice: &mut Lattice<N>) {
    let [nx, ny, nz] = lattice.nodes;
    for j in 0..ny {
        for i in 0..nx {
            let highest = (0..nz)
                .rev()
                .map(|k| lattice.index([i, j, k]))
                .find(|index| lattice.mass.get(*index).is_some_and(|m| *m > 0.0));
            if let (Some(index), Some(top)) = (highest, lattice.top.get_mut((j * nx + i) as usize)) {
                *top = index as u32 + 1;
            }
        }
    }
}

/// Springs that exist, by direction; for reports and tests.
#[must_use]
pub fn springs<const N: usize>(lattice: &Lattice<N>) -> [usize; DIRECTIONS] {
    core::array::from_fn(|direction| {
        let of = |index: usize| {
            let mut curves = lattice.stiffness.iter().filter_map(|s| s.get(direction));
            curves.any(|k| k.get(index).is_some_and(|k| *k > 0.0))
        };
        (0..lattice.len()).filter(|index| of(*index)).count()
    })
}
