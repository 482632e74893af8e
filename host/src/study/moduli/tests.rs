//! Blocks against the formulas of their laws, and against a dense solve of their own.

use super::*;
use nalgebra::{DMatrix, DVector};
use sutura_shared::scene::{Body, TISSUES_MAX, Tissue};

const YOUNG: f64 = 100e3;
const PITCH: f64 = 2e-3;

fn request(voxels: [u32; 3], law: Law) -> Request {
    Request {
        voxels,
        pitch_m: PITCH,
        young_pa: YOUNG,
        density_kg_m3: 1000.0,
        law,
        assembly: Assembly::PerVoxel,
        curve: None,
    }
}

fn apart(value: f64, expected: f64) -> f64 {
    (value / expected - 1.0).abs()
}

/// Isotropic and volume: E, ν and G = E/(2(1 + ν)); axial: E along the axes, G = E/3 and ν = 0.2247, C12/(C11 + C12) with
/// C11 = √(2/3) + 1/3, C12 = 1/3.
#[test]
fn blocks_of_any_size_have_the_moduli_of_their_law() {
    let laws = [
        (Law::Isotropic, 0.25, 0.4),
        (Law::Axial, 0.224_745, 1.0 / 3.0),
        (Law::Volume { poisson: 0.25 }, 0.25, 0.4),
        (Law::Volume { poisson: 0.3 }, 0.3, 0.5 / 1.3),
        (Law::Volume { poisson: 0.45 }, 0.45, 0.5 / 1.45),
        (Law::Volume { poisson: 0.49 }, 0.49, 0.5 / 1.49),
    ];
    for (law, poisson, shear) in laws {
        for voxels in [[1, 1, 1], [2, 3, 4], [12, 12, 6]] {
            let report = run(&request(voxels, law)).unwrap();
            let Triple { x, y, z } = report.measured.young_kpa;
            let pairs = [(x, 100.0), (y, 100.0), (z, 100.0)];
            let rest = [
                (report.measured.poisson, poisson),
                (report.measured.shear_kpa, 100.0 * shear),
            ];
            for (measured, expected) in pairs.into_iter().chain(rest) {
                assert!(
                    apart(measured, expected) < 1e-3,
                    "{law:?} {voxels:?}: {measured} for {expected}"
                );
            }
            for (asked, expected) in [(report.asked.poisson, poisson), (report.asked.shear_kpa, 100.0 * shear)] {
                assert!(apart(asked, expected) < 1e-5, "{law:?}: {asked}");
            }
        }
    }
}

/// Of a cubic material E = (C11 − C12)(C11 + 2 C12)/(C11 + C12) with C11 = k_n + 4k_d/3, C12 = 4k_d/3: 0.584 E for the constants as
/// printed. One voxel with whole edges has 4 k_n.
#[test]
fn the_paper_s_constants_miss_young_s_modulus() {
    let young = |edge: f64| {
        let c12 = 1.0 / 3.0;
        let c11 = edge + c12;
        100.0 * (c11 - c12) * (c11 + 2.0 * c12) / (c11 + c12)
    };
    let mut last = young(4.0 * 0.45);
    for n in [1, 2, 4, 8] {
        let whole = Request {
            assembly: Assembly::EveryEdge,
            ..request([n; 3], Law::Paper)
        };
        let (whole, shared) = (run(&whole).unwrap(), run(&request([n; 3], Law::Paper)).unwrap());
        assert!(apart(shared.measured.young_kpa.x, young(0.45)) < 1e-3);
        for report in [&whole, &shared] {
            assert!(apart(report.measured.shear_kpa, report.asked.shear_kpa) < 1e-3);
        }
        let measured = whole.measured.young_kpa.x;
        if n == 1 {
            assert!(apart(measured, last) < 1e-3, "{measured} for {last}");
        } else {
            assert!(young(0.45) < measured && measured < last, "{n}: {measured}");
        }
        last = measured;
    }
}

/// √(C11/ρ) with C11 = 1.2 E. A mode of the bulk has ω² = 4.8 E/(ρa²) at most (Λ adds nothing to modes that keep the volume); free faces,
/// edges and corners only lower the limit of 0.913 a √(ρ/E), and by Irons' theorem not below that of one voxel.
#[test]
fn waves_and_steps_are_those_of_the_material() {
    let steps = [[1, 1, 1], [4, 3, 2], [12, 12, 6]].map(|voxels| {
        let report = run(&request(voxels, Law::Isotropic)).unwrap();
        assert!(apart(report.wave_m_per_s, (1.2 * YOUNG / 1000.0).sqrt()) < 1e-3);
        report.explicit_dt_max_us
    });
    let bulk = 2.0 / 4.8_f64.sqrt() * PITCH * (1000.0 / YOUNG).sqrt() * 1e6;
    let [one, few, many] = steps;
    assert!(one < few && few < many && many < bulk, "{steps:?}, {bulk}");
    assert!(apart(many, bulk) < 0.05, "{many} for {bulk}");
}

/// Edges carry k_n/E = 0.8 of a stretch and are lumped on the layers of nodes, 2/h² too stiff; diagonals run through the voxels.
#[test]
fn bending_is_too_stiff_by_about_two_over_the_square_of_the_layers() {
    for layers in [2, 4, 6] {
        let Bending { error, formula, .. } = run(&request([6, 4, layers], Law::Isotropic)).unwrap().bending;
        assert!(
            (0.7..0.85).contains(&(error / formula)),
            "{layers}: {error} for {formula}"
        );
    }
}

/// A block of tissues of moduli 1, 3, … times E by the cells' bytes.
fn mixed(voxels: [u32; 3], law: Law, cells: &[u8]) -> Probe {
    let spec = Spec {
        nodes: voxels.map(|n| n + 1),
        pitch_m: PITCH,
        young_pa: YOUNG,
        density_kg_m3: 1000.0,
        law,
        assembly: Assembly::PerVoxel,
        stiffening: false,
        damping_per_s: 0.0,
    };
    let mut scene = block::scene(&spec);
    let slopes = (0..TISSUES_MAX as u8).map(young);
    scene.tissues = slopes
        .map(|slope_pa| Tissue {
            density_kg_m3: 1000.0,
            body: Body::Soft {
                curve: std::iter::once(Segment {
                    from_strain: 0.0,
                    slope_pa: slope_pa as f32,
                })
                .collect(),
                sheet: 1.0,
                strength_n: 0.0,
            },
        })
        .collect();
    Probe::new(&Block::of(&scene, cells).unwrap())
}

/// Young's modulus of a tissue [Pa].
fn young(tissue: u8) -> f64 {
    YOUNG * f64::from(1 + 2 * tissue)
}

/// Stretched along their common face, tissues of one ν stay in it, and their stresses add by area.
#[test]
fn tissues_side_by_side_add_by_area() {
    for law in [Law::Isotropic, Law::Volume { poisson: 0.45 }] {
        let cells: Vec<u8> = (0..60).map(|n| if n % 5 < 2 { 1 } else { 2 }).collect();
        let is = mixed([5, 4, 3], law, &cells).measure().unwrap();
        let expected = 0.4 * young(0) + 0.6 * young(1);
        for measured in [is.young.y, is.young.z] {
            assert!(apart(measured, expected) < 1e-3, "{law:?}: {measured} for {expected}");
        }
    }
}

/// Layers on top of each other hold each other's sides: no closed form, but a dense matrix from the laws' own numbers.
#[test]
fn layers_are_as_stiff_as_a_dense_solve_says() {
    let voxels = [3, 2, 4];
    let cells: Vec<u8> = (0..24).map(|n| [1, 1, 2, 4][n / 6]).collect();
    for (law, edge, diagonal, volume) in [
        (Law::Isotropic, 0.8, 0.3, 0.0),
        // 2G, 0.75 G and G(4ν − 1)/(1 − 2ν) with G = 1/2.9.
        (Law::Volume { poisson: 0.45 }, 2.0 / 2.9, 0.75 / 2.9, 8.0 / 2.9),
    ] {
        let is = mixed(voxels, law, &cells).measure().unwrap();
        let expected = dense(voxels, &cells, [edge, diagonal, volume]);
        eprintln!("{law:?}: {} Pa for {expected}", is.young.z);
        assert!(
            apart(is.young.z, expected) < 1e-4,
            "{law:?}: {} for {expected}",
            is.young.z
        );
    }
}

/// E along z between sliding plates, from the stiffness matrix of all voxels [Pa].
fn dense(voxels: [u32; 3], cells: &[u8], [edge, diagonal, volume]: [f64; 3]) -> f64 {
    let [cx, cy, cz] = voxels.map(|n| n as usize);
    let node = |[i, j, k]: [usize; 3]| (k * (cy + 1) + j) * (cx + 1) + i;
    let n = 3 * (cx + 1) * (cy + 1) * (cz + 1);
    let mut stiffness = DMatrix::<f64>::zeros(n, n);
    for (cell, tissue) in cells.iter().enumerate() {
        let low = [cell % cx, cell / cx % cy, cell / cx / cy];
        let bits = |c: usize| [c & 1, c >> 1 & 1, c >> 2];
        let corner = |c: usize| node(std::array::from_fn(|axis| low[axis] + bits(c)[axis]));
        let ea = young(tissue - 1) * PITCH;
        let mut add = |weights: &[(usize, f64)], k: f64| {
            for (a, wa) in weights {
                for (b, wb) in weights {
                    stiffness[(*a, *b)] += k * wa * wb;
                }
            }
        };
        for (a, b) in (0..8_usize).flat_map(|a| (a + 1..8).map(move |b| (a, b))) {
            let k = match (a ^ b).count_ones() {
                1 => edge / 4.0,
                3 => diagonal,
                _ => continue,
            };
            let along: [f64; 3] = std::array::from_fn(|axis| bits(b)[axis] as f64 - bits(a)[axis] as f64);
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            let stretch: Vec<_> = (0..3)
                .flat_map(|axis| {
                    let unit = along[axis] / length;
                    [(3 * corner(a) + axis, -unit), (3 * corner(b) + axis, unit)]
                })
                .collect();
            add(&stretch, k * ea);
        }
        // Trace of the mean gradient, times a.
        let swelling: Vec<_> = (0..8)
            .flat_map(|c| (0..3).map(move |axis| (3 * corner(c) + axis, 0.5 * bits(c)[axis] as f64 - 0.25)))
            .collect();
        add(&swelling, volume * ea);
    }
    let end = |dof: usize| dof % 3 == 2 && (dof / 3 < (cx + 1) * (cy + 1) || dof / 3 >= (cx + 1) * (cy + 1) * cz);
    let (held, free): (Vec<_>, Vec<_>) = (0..n).partition(|dof| end(*dof));
    let height = cz as f64 * PITCH;
    let moved = DVector::from_iterator(
        held.len(),
        held.iter()
            .map(|dof| if dof / 3 < (cx + 1) * (cy + 1) { 0.0 } else { height }),
    );
    let coupling = stiffness.select_rows(&free).select_columns(&held);
    let mut inner = stiffness.select_rows(&free).select_columns(&free);
    // The block may slide and turn: a trace of stiffness holds it.
    (0..free.len()).for_each(|i| inner[(i, i)] += 1e-9 * YOUNG * PITCH);
    let u = inner.cholesky().unwrap().solve(&-(&coupling * &moved));
    let outer = stiffness.select_rows(&held).select_columns(&held);
    let energy = 0.5 * (moved.dot(&(outer * &moved)) + moved.dot(&(coupling.transpose() * u)));
    2.0 * energy / (n_voxels(voxels) * PITCH.powi(3))
}

fn n_voxels(voxels: [u32; 3]) -> f64 {
    voxels.into_iter().map(f64::from).product()
}

/// Within 3 % in tension and 10 % in compression, files and all.
#[test]
fn a_block_follows_the_asked_curve() {
    let folder = tempfile::tempdir().unwrap();
    for law in [
        Law::Isotropic,
        Law::Axial,
        Law::Volume { poisson: 0.3 },
        Law::Volume { poisson: 0.45 },
    ] {
        let segments = SKIN.map(|(from_strain, slope)| Segment {
            from_strain,
            slope_pa: slope * YOUNG as f32,
        });
        let request = Request {
            curve: Some(Curve {
                segments: segments.to_vec(),
                out: folder.path().join("out"),
            }),
            ..request([4, 4, 3], law)
        };
        let report = run(&request).unwrap();
        let fit = report.curve.unwrap();
        assert!(fit.tension_error < 0.03, "{law:?}: {}", fit.tension_error);
        assert!(fit.compression_error < 0.1, "{law:?}: {}", fit.compression_error);
        // The last segment is 13 times as steep as the first, less what the springs' own turning gives; Λ does not stiffen.
        let linear = run(&Request { curve: None, ..request }).unwrap().explicit_dt_max_us;
        let steeper = (linear / report.explicit_dt_max_us).powi(2);
        let least = if let Law::Volume { .. } = law { 1.0 } else { 10.0 };
        assert!((least..13.1).contains(&steeper), "{law:?}: {steeper}");
        let csv = std::fs::read_to_string(folder.path().join("out/moduli.csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + fit.points.len());
        assert!(folder.path().join("out/moduli.png").exists());
    }
}

#[test]
fn what_is_no_block_or_no_curve_is_refused_in_a_line() {
    let segment = |from_strain, slope_pa| Segment { from_strain, slope_pa };
    let out = PathBuf::from("nowhere");
    for segments in [
        vec![],
        vec![segment(0.1, 1e5)],
        vec![segment(0.0, 1e5), segment(0.1, 5e4)],
        vec![segment(0.0, 1e5); 6],
    ] {
        let request = Request {
            curve: Some(Curve {
                segments,
                out: out.clone(),
            }),
            ..request([1, 1, 1], Law::Isotropic)
        };
        let error = run(&request).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(
            matches!(error, Error::Invalid(_)) && !error.to_string().contains('\n'),
            "{error}"
        );
    }
    let error = run(&request([0, 1, 1], Law::Isotropic)).unwrap_err();
    assert!(matches!(error, Error::Block(_)));
}
