//! States that tissue may be in without any tool: crumpled, inside out, collapsed, compressed.

use sutura_controller::lattice::{Lattice, PC_NODES, Tissue, at};
use sutura_controller::math::Vec3;

use super::patch::{AFTER, FLESH, Patch, Stuff};
use crate::study::stability::bench::{Bench, memory};
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// Where the tool stays, far above the skin [m].
const AWAY: Vec3 = Vec3::new(0.0, 0.0, 0.1);
/// Time in which a plate comes down, and in which it stays there [ticks].
const PLATE: [u32; 2] = [300, 700];
/// How far it comes down, over the height of the block.
const DOWN: f32 = 0.3;

/// Puts a patch into a state.
type Put = fn(&mut Lattice<PC_NODES>, &mut Tissue<PC_NODES>);

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let crumpled = [("0.1-mpa", 1e5), ("10-mpa", 1e7)].map(|(name, young_pa)| {
        let stuff = Stuff { young_pa, ..FLESH };
        let patch = Patch {
            stuff: [stuff; 2],
            ..Patch::default()
        };
        let what = "every node is up to half a voxel out of place along each axis";
        from_state(format!("nodes-randomised:{name}"), what, patch, crumple)
    });
    let states: [(&str, &str, Put); 4] = [
        (
            "nodes-randomised:velocities",
            "every node moves by up to 1 m/s along each axis",
            kick,
        ),
        (
            "coincident-nodes:pairs",
            "pairs of neighbours share a place, and their springs have no length",
            pair,
        ),
        (
            "coincident-nodes:voxel",
            "the eight corners of a voxel are in one place",
            |l, t| collapse(l, t, 1),
        ),
        (
            "coincident-nodes:block",
            "the corners of 4 × 4 × 3 voxels are all in one place",
            |l, t| collapse(l, t, 4),
        ),
    ];
    let states = states.map(|(name, what, put)| from_state(name.to_owned(), what, Patch::default(), put));
    crumpled
        .into_iter()
        .chain(states)
        .chain(inverted())
        .chain([compressed()])
        .collect()
}

/// Springs are as content mirrored as they are upright, so a scene in which that may happen calls for effect `barrier`.
fn inverted() -> [Case; 2] {
    let states: [(&str, &str, Put); 2] = [
        (
            "voxels-inverted:one-node",
            "a node of the skin is pushed a voxel below the one under it, effect barrier on",
            |l, t| mirror(l, t, 0),
        ),
        (
            "voxels-inverted:25-nodes",
            "5 × 5 nodes of the skin are pushed a voxel below those under them, effect barrier on",
            |l, t| mirror(l, t, 2),
        ),
    ];
    let patch = Patch {
        barrier: true,
        ..Patch::default()
    };
    states.map(|(name, what, put)| from_state(name.to_owned(), what, patch, put))
}

/// Starts from a state, without a tool.
fn from_state(name: String, what: &str, patch: Patch, put: Put) -> Case {
    Case {
        name,
        what: what.to_owned(),
        equilibrium: None,
        run: Box::new(move |attempt| {
            let (scene, cells) = patch.scene(attempt);
            let mut memory = memory();
            let mut bench = Bench::new(*attempt, &mut memory, &scene, &cells)?;
            let (lattice, tissue) = bench.patch_mut();
            put(lattice, tissue);
            bench.let_go(AWAY, 500 + AFTER)
        }),
    }
}

fn compressed() -> Case {
    Case {
        name: "compressed:30-percent".to_owned(),
        what: "a plate presses a block with free sides together by 30 % within 0.3 s, stays for 0.7 s and is gone"
            .to_owned(),
        equilibrium: None,
        run: Box::new(compress),
    }
}

fn compress(attempt: &Attempt<'_>) -> Result<Trace, Unfinished> {
    let patch = Patch {
        fill: |[i, j, _]| u8::from((1..7).contains(&i) && (1..7).contains(&j)),
        ..Patch::default()
    };
    let (scene, cells) = patch.scene(attempt);
    let mut memory = memory();
    let mut bench = Bench::new(*attempt, &mut memory, &scene, &cells)?;
    let [down, stay] = PLATE;
    let height = patch.voxels[2] as f32 * patch.pitch();
    let speed = -DOWN * height / (down as f32 * 1e-3);
    for (free, speed, ticks) in [(0.0, speed, down), (0.0, 0.0, stay)] {
        plate(&mut bench, free, speed);
        for _ in 0..ticks {
            bench.tick(AWAY)?;
        }
    }
    plate(&mut bench, 1.0, 0.0);
    bench.let_go(AWAY, AFTER)
}

/// Takes the uppermost nodes, which are held where `free` is 0 and glide on at `speed` along z [m/s].
fn plate(bench: &mut Bench<'_>, free: f32, speed: f32) {
    let (lattice, tissue) = bench.patch_mut();
    let [_, _, nz] = lattice.nodes;
    for ([_, _, k], n) in lattice.nodes() {
        if k + 1 == nz && lattice.mass[n] > 0.0 {
            lattice.free[n] = free;
            put(&mut tissue.velocity, n, Vec3::z() * speed);
        }
    }
}

/// Every free node's field at random, each component up to `size`.
fn shake(lattice: &Lattice<PC_NODES>, field: &mut [[f32; PC_NODES]; 3], size: f32) {
    // Knuth's MMIX linear congruential generator, high bits only.
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    };
    for (_, n) in lattice.nodes() {
        let v = Vec3::from_fn(|_, _| random()) * (size * lattice.free[n]);
        put(field, n, v);
    }
}

fn crumple(lattice: &mut Lattice<PC_NODES>, tissue: &mut Tissue<PC_NODES>) {
    shake(lattice, &mut tissue.displacement, 0.5 * lattice.pitch);
}

fn kick(lattice: &mut Lattice<PC_NODES>, tissue: &mut Tissue<PC_NODES>) {
    shake(lattice, &mut tissue.velocity, 1.0);
}

/// Pushes the nodes of the skin up to `reach` from its middle two voxels down, through those under them.
fn mirror(lattice: &mut Lattice<PC_NODES>, tissue: &mut Tissue<PC_NODES>, reach: u32) {
    let [nx, ny, nz] = lattice.nodes;
    let near = |i: u32, n: u32| i.abs_diff(n / 2) <= reach;
    for (_, n) in lattice
        .nodes()
        .filter(|([i, j, k], _)| near(*i, nx) && near(*j, ny) && k + 1 == nz)
    {
        put(&mut tissue.displacement, n, -Vec3::z() * (2.0 * lattice.pitch));
    }
}

/// Puts every fourth free node along x where its neighbour is, of even rows and layers along x, of odd ones along the diagonal.
fn pair(lattice: &mut Lattice<PC_NODES>, tissue: &mut Tissue<PC_NODES>) {
    let [nx, ny, nz] = lattice.nodes;
    for ([i, j, k], n) in lattice.nodes().filter(|([i, _, _], _)| i % 4 == 1) {
        let other = if (j + k) % 2 == 0 {
            [i + 1, j, k]
        } else {
            [i + 1, j + 1, k + 1]
        };
        if lattice.free[n] > 0.0 && other.into_iter().zip([nx, ny, nz]).all(|(at, all)| at < all) {
            let place = lattice.rest_place(lattice.index(other)) + at(&tissue.displacement, lattice.index(other));
            put(&mut tissue.displacement, n, place - lattice.rest_place(n));
        }
    }
}

/// Puts the corners of voxels in the middle, `wide` along x and y, into one place.
fn collapse(lattice: &mut Lattice<PC_NODES>, tissue: &mut Tissue<PC_NODES>, wide: u32) {
    let [nx, ny, nz] = lattice.nodes;
    let first = [nx, ny].map(|n| (n - 1 - wide) / 2);
    let low = if wide > 1 { 1 } else { nz / 2 };
    let high = if wide > 1 { nz - 2 } else { nz / 2 + 1 };
    let place = lattice.rest_place(lattice.index([nx / 2, ny / 2, nz / 2]));
    let inside = |[i, j, k]: [u32; 3]| {
        (first[0]..=first[0] + wide).contains(&i)
            && (first[1]..=first[1] + wide).contains(&j)
            && (low..=high).contains(&k)
    };
    for (_, n) in lattice.nodes().filter(|(node, _)| inside(*node)) {
        put(&mut tissue.displacement, n, place - lattice.rest_place(n));
    }
}

fn put(field: &mut [[f32; PC_NODES]; 3], node: usize, v: Vec3) {
    field.iter_mut().zip(v.iter()).for_each(|(part, v)| part[node] = *v);
}
