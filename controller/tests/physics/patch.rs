//! Patch tests: a block whose every node follows an affine displacement pulls back with the moduli of the law,
//! C11 = (k_n + 4k_d/3)/a and C12 = C44 = 4k_d/(3a), whatever its size and whatever stands beside it.

use super::block::{Block, DENSITY, PITCH, apart, linear, scene, stiffening};
use sutura_shared::scene::{self, Assembly, Body, Effect, Law, Scene};

const YOUNG: f64 = 100e3;
/// Strain of the central differences.
const STRAIN: f64 = 1e-3;
const TOLERANCE: f64 = 5e-4;
const LAWS: [(Law, f64, f64); 3] = [
    (Law::Isotropic, 0.8, 0.3),
    (Law::Axial, 0.816_496_580_927_726, 0.25),
    (Law::Paper, 0.45, 0.25),
];

/// Stress on the upper face across `axis` per strain, with u_`along` = strain · x_`by`: component `along` or `axis` of it [Pa].
fn modulus(block: &mut Block, [along, by]: [usize; 2], [axis, component]: [usize; 2]) -> f64 {
    let area: f64 = (0..3)
        .filter(|a| *a != axis)
        .map(|a| f64::from(block.lattice.nodes[a] - 1) * f64::from(PITCH))
        .product();
    let [plus, minus] = [STRAIN, -STRAIN].map(|strain| {
        block.impose(|place| {
            let mut u = [0.0; 3];
            u[along] = strain * place[by];
            u
        });
        block.pull(axis)[component]
    });
    (plus - minus) / (2.0 * STRAIN * area)
}

/// C11 along each axis, C12 of each pair of axes, C44 in each plane.
fn moduli(block: &mut Block) -> [[f64; 3]; 3] {
    let axes = [0, 1, 2];
    [
        axes.map(|a| modulus(block, [a, a], [a, a])),
        axes.map(|a| modulus(block, [a, a], [(a + 1) % 3, (a + 1) % 3])),
        axes.map(|a| modulus(block, [a, (a + 1) % 3], [(a + 1) % 3, a])),
    ]
}

#[test]
fn a_block_of_any_size_has_the_moduli_of_its_law() {
    for (law, edge, diagonal) in LAWS {
        let expected = [edge + 4.0 * diagonal / 3.0, 4.0 * diagonal / 3.0, 4.0 * diagonal / 3.0].map(|c| c * YOUNG);
        for cells in [[1, 1, 1], [2, 3, 4], [6, 5, 4]] {
            let mut block = Block::filled(&scene(cells, law, &[linear(YOUNG as f32)], &[]));
            let measured = moduli(&mut block);
            for (kind, (measured, expected)) in measured.iter().zip(expected).enumerate() {
                for m in measured {
                    let error = apart(*m, expected);
                    assert!(
                        error < TOLERANCE,
                        "{law:?} {cells:?} C{kind}: {m} for {expected}, {error:e}"
                    );
                }
            }
        }
    }
}

/// Of a cubic material E = (C11 − C12)(C11 + 2 C12)/(C11 + C12), ν = C12/(C11 + C12), G = C44. The axial law's ν is
/// (4k_d/3)/(k_n + 8k_d/3); the paper's constants give 0.584 E.
#[test]
fn the_laws_have_the_young_poisson_and_shear_moduli_they_promise() {
    let promised = [
        (1.0, 0.25, 0.4),
        (1.0, 0.224_745, 1.0 / 3.0),
        (0.584_302, 0.298_507, 1.0 / 3.0),
    ];
    for ((law, ..), (young, poisson, shear)) in LAWS.into_iter().zip(promised) {
        let mut block = Block::filled(&scene([6, 5, 4], law, &[linear(YOUNG as f32)], &[]));
        let [[c11, ..], [c12, ..], [c44, ..]] = moduli(&mut block);
        let measured = [
            (c11 - c12) * (c11 + 2.0 * c12) / (c11 + c12) / YOUNG,
            c12 / (c11 + c12),
            c44 / YOUNG,
        ];
        eprintln!("{law:?}: E/E0, nu, G/E0 = {measured:?}");
        for (measured, promised) in measured.into_iter().zip([young, poisson, shear]) {
            assert!(
                apart(measured, promised) < TOLERANCE,
                "{law:?}: {measured} for {promised}"
            );
        }
    }
}

/// Two tissues side by side, stretched along their common face: stresses add by area. The same with stiffening curves, where each
/// tissue's springs lie in an array of their own, below the first break.
#[test]
fn tissues_side_by_side_add_by_area() {
    let [soft, hard] = [YOUNG, 7.0 * YOUNG];
    let cells = [5, 4, 3];
    let filling: Vec<u8> = (0..60).map(|n| if n % 5 < 2 { 1 } else { 2 }).collect();
    let share = 0.4 * soft + 0.6 * hard;
    let curve = |young: f64| stiffening(&[(0.0, young as f32), (0.3, 5.0 * young as f32)]);
    let straight = [linear(soft as f32), linear(hard as f32)];
    let bent = [curve(soft), curve(hard)];
    for (tissues, effects) in [(straight, vec![]), (bent, vec![Effect::Stiffening])] {
        for (law, edge, diagonal) in LAWS {
            let mut block = Block::new(&scene(cells, law, &tissues, &effects), &filling);
            let (c11, c44) = ((edge + 4.0 * diagonal / 3.0) * share, 4.0 * diagonal / 3.0 * share);
            for axis in [1, 2] {
                let stretch = modulus(&mut block, [axis, axis], [axis, axis]);
                assert!(apart(stretch, c11) < TOLERANCE, "{law:?} {axis}: {stretch} for {c11}");
            }
            for [along, by] in [[1, 2], [2, 1], [0, 1], [0, 2]] {
                let shear = modulus(&mut block, [along, by], [by, along]);
                assert!(apart(shear, c44) < TOLERANCE, "{law:?} {along}{by}: {shear} for {c44}");
            }
        }
    }
}

fn every_edge(scene: Scene) -> Scene {
    let assembly = Assembly::EveryEdge;
    let lattice = scene::Lattice {
        assembly,
        ..scene.lattice
    };
    Scene { lattice, ..scene }
}

/// n voxels side by side have n + 1 edges, and each is a whole spring: C11 = k_n (1 + 1/n_y)(1 + 1/n_z)/a + 4k_d/(3a). Diagonals are not shared.
#[test]
fn whole_edges_make_a_block_too_stiff_by_its_rim() {
    for (law, edge, diagonal) in LAWS {
        for cells in [[1, 1, 1], [4, 3, 2], [11, 11, 5]] {
            let mut block = Block::filled(&every_edge(scene(cells, law, &[linear(YOUNG as f32)], &[])));
            let [_, y, z] = cells.map(|n| 1.0 + 1.0 / f64::from(n));
            let expected = [edge * y * z + 4.0 * diagonal / 3.0, 4.0 * diagonal / 3.0].map(|c| c * YOUNG);
            let [[c11, ..], _, [c44, ..]] = moduli(&mut block);
            for (measured, expected) in [c11, c44].into_iter().zip(expected) {
                assert!(
                    apart(measured, expected) < TOLERANCE,
                    "{law:?} {cells:?}: {measured} for {expected}"
                );
            }
        }
    }
}

/// Two voxels of one face: four edges along x are one tissue's, the two between them the mean of both.
#[test]
fn a_whole_edge_between_two_tissues_is_their_mean() {
    let tissues = [linear(YOUNG as f32), linear(3.0 * YOUNG as f32)];
    let mut block = Block::new(&every_edge(scene([1, 2, 1], Law::Isotropic, &tissues, &[])), &[1, 2]);
    let mean = 2.0 * YOUNG;
    let expected = 3.0 * 0.8 * mean + 4.0 / 3.0 * 0.3 * mean;
    let measured = modulus(&mut block, [0, 0], [0, 0]);
    assert!(apart(measured, expected) < TOLERANCE, "{measured} for {expected}");
}

/// Λ = G(4ν − 1)/(1 − 2ν) of the voxel's own tissue at its lowest corner, nothing elsewhere: 2.76 E at ν = 0.45.
#[test]
fn each_voxel_has_its_own_volume_stiffness() {
    let law = Law::Volume { poisson: 0.45 };
    let tissues = [linear(YOUNG as f32), linear(3.0 * YOUNG as f32)];
    let block = Block::new(&scene([2, 2, 1], law, &tissues, &[]), &[1, 2, 0, 1]);
    let lambda = 0.8 / (2.0 * 1.45) / 0.1;
    let expected = [1.0, 3.0, 0.0, 0.0, 1.0, 0.0].map(|share| share * lambda * YOUNG);
    for (measured, expected) in block.lattice.volume.iter().zip(expected) {
        assert!(
            (f64::from(*measured) - expected).abs() <= 1e-5 * YOUNG,
            "{measured} for {expected}"
        );
    }
    assert!(block.lattice.volume.iter().skip(6).all(|volume| *volume <= 0.0));
}

/// Lian & Chen Eq. 1: the shear force of one voxel's four diagonals.
#[test]
fn the_diagonals_of_a_voxel_follow_eq_1() {
    let diagonal = 0.3 * YOUNG * f64::from(PITCH);
    let mut block = Block::filled(&scene([1, 1, 1], Law::Isotropic, &[linear(YOUNG as f32)], &[]));
    let edges = block.lattice.stiffness[0].iter_mut().take(3);
    edges.for_each(|k| k.fill(0.0));
    for gamma in (1..=10).map(|n| 0.05 * f64::from(n)) {
        let t = gamma.tan();
        let leg = |x: f64| 3.0_f64.sqrt() * x / (2.0 + x * x).sqrt();
        let expected = 2.0 * diagonal * f64::from(PITCH) * (2.0 * t - leg(1.0 + t) + leg(1.0 - t));
        block.impose(|[_, _, z]| [z * t, 0.0, 0.0]);
        let [force, ..] = block.pull(2);
        assert!(apart(force, expected) < 1e-6, "{gamma}: {force} for {expected}");
    }
}

fn sheet(thickness: f32) -> Scene {
    let Body::Soft { curve, .. } = linear(YOUNG as f32).body else {
        panic!("a soft tissue");
    };
    let tissue = scene::Tissue {
        density_kg_m3: DENSITY,
        body: Body::Soft {
            curve,
            sheet: thickness,
            strength_n: 0.0,
        },
    };
    scene([4, 3, 1], Law::Isotropic, &[tissue], &[])
}

/// A sheet of thickness t in voxels of edge a carries t/a of the force in its plane; its upright edges keep all of theirs.
#[test]
fn a_sheet_carries_its_share_in_its_plane() {
    let (edge, diagonal) = (0.8 * YOUNG, 0.3 * YOUNG);
    for share in [0.25, 0.6, 1.0] {
        let mut block = Block::filled(&sheet(share as f32));
        let in_plane = share * (edge + 4.0 * diagonal / 3.0);
        let upright = edge + share * 4.0 * diagonal / 3.0;
        for (axis, expected) in [(0, in_plane), (1, in_plane), (2, upright)] {
            let measured = modulus(&mut block, [axis, axis], [axis, axis]);
            assert!(
                apart(measured, expected) < TOLERANCE,
                "{share} {axis}: {measured} for {expected}"
            );
        }
        let shear = modulus(&mut block, [0, 1], [1, 0]);
        assert!(
            apart(shear, share * 4.0 * diagonal / 3.0) < TOLERANCE,
            "{share}: {shear}"
        );
    }
}

/// Every voxel's ρa³, shared by its corners, whatever is missing and whether it is bone.
#[test]
fn the_nodes_carry_the_mass_of_the_voxels() {
    let bone = scene::Tissue {
        density_kg_m3: 1900.0,
        body: Body::Fixed,
    };
    let scene = scene([5, 4, 3], Law::Isotropic, &[linear(YOUNG as f32), bone], &[]);
    let cells: Vec<u8> = (0..60).map(|n| [1, 1, 0, 2][n % 4]).collect();
    let block = Block::new(&scene, &cells);
    let sum: f64 = block.lattice.mass.iter().map(|m| f64::from(*m)).sum();
    let expected = (30.0 * f64::from(DENSITY) + 15.0 * 1900.0) * f64::from(PITCH).powi(3);
    assert!(apart(sum, expected) < 1e-6, "{sum} for {expected}");
}
