//! The faces of a wound that is pressed shut: they meet, and pass each other by no more than the penalty asks for.

use super::block::{Block, linear, scene};
use sutura_controller::coupling::{A, Coupling, D, Kernel};
use sutura_controller::math::Vec3;
use sutura_controller::wound::{self, Faces};
use sutura_shared::scene::{Effect, Law, Wound};

const CELLS: [u16; 3] = [9, 4, 4];
/// The column of cells that is missing.
const GAP: u16 = 4;
const PENALTY: f32 = 2000.0;
/// Solvers and the force that they press the rims with [N]. From 1 N on only two Newton steps a tick are known to find the contact: Chebyshev
/// iteration and vertex block descent, which linearise once, end with too much force there.
const PRESSED: [(&str, f32); 5] = [
    ("be-pcg:20:2", 0.3),
    ("be-pcg:20:2", 1.0),
    ("be-pcg:20:2", 3.0),
    ("be-chebyshev:20", 0.3),
    ("vbd:20:1.5", 0.3),
];
/// Solvers of an open wound.
const SOLVERS: [&str; 4] = ["be-pcg:20:2", "be-chebyshev:20", "vbd:20:1.5", "explicit"];

/// A block cut through its upper three layers and most of its length.
fn cut() -> (Block, Faces) {
    let mut scene = scene(CELLS, Law::Isotropic, &[linear(20e3)], &[Effect::WoundContact]);
    scene.lattice.damping_per_s = 50.0;
    scene.wound = Some(Wound {
        faces: [GAP, GAP + 1],
        rows: [1, 3],
        floor: 2,
        penalty_n_per_m: PENALTY,
    });
    let [nx, ny, _] = CELLS.map(usize::from);
    let missing = |n: usize| n % nx == usize::from(GAP) && (1..3).contains(&(n / nx % ny)) && n / nx / ny >= 2;
    let cells: Vec<u8> = (0..scene.lattice.count()).map(|n| u8::from(!missing(n))).collect();
    let block = Block::new(&scene, &cells);
    let faces = wound::faces(scene.wound.as_ref().unwrap(), None, &block.lattice).unwrap();
    (block, faces)
}

/// Presses both rims at the middle row with `force` [N] until the block rests.
fn press(block: &mut Block, name: &str, force: f32, faces: Option<&Faces>) {
    let solver = block.solver(name);
    let mut coupling = Coupling::default();
    for (slot, column, sign) in [(A, GAP, 1.0), (D, GAP + 1, -1.0)] {
        let mut kernel = Kernel::default();
        for k in [3, 4] {
            kernel.push(block.lattice.index([u32::from(column), 2, k]) as u32, 0.5);
        }
        coupling.kernels[slot] = kernel;
        coupling.force[slot] = Vec3::x() * (sign * force);
    }
    for _ in 0..1500 {
        block.tick(solver, &coupling, faces);
    }
}

/// Width of every pair [m].
fn widths(block: &Block, faces: &Faces) -> Vec<f32> {
    let x = &block.tissue.displacement[0];
    faces
        .pairs()
        .map(|(left, right)| faces.width(x[left], x[right]))
        .collect()
}

#[test]
fn faces_pressed_together_stop_each_other() {
    for (name, force) in PRESSED {
        let (mut block, faces) = cut();
        press(&mut block, name, force, Some(&faces));
        let overlap = widths(&block, &faces).into_iter().map(|w| (-w).max(0.0));
        let (deepest, sum) = overlap.fold((0.0, 0.0), |(max, sum): (f32, f32), w| (max.max(w), sum + w));
        // At rest contact and tissue carry the force on the left half together.
        let elastic = block.elastic(Some(&faces));
        let left = block
            .nodes()
            .filter(|(n, [i, ..])| *i <= u32::from(GAP) && block.lattice.free[*n] > 0.0);
        let tissue: f32 = left.map(|(n, _)| elastic[0][n]).sum();
        let contact = PENALTY * sum;
        eprintln!(
            "{name}, {force} N: contact {contact:.3} N, tissue {:.3} N, deepest {deepest:.2e} m",
            -tissue
        );
        assert!(
            contact > 0.0 && contact < force,
            "{name}, {force} N: contact {contact} N"
        );
        assert!(deepest <= force / PENALTY, "{name}, {force} N: deepest {deepest} m");
        assert!(
            (force + tissue - contact).abs() < 2e-3 * force,
            "{name}, {force} N: {tissue} N, {contact} N"
        );
    }
}

/// Little force leaves the wound open: contact or not, the bits are the same.
#[test]
fn an_open_wound_has_no_contact() {
    for name in SOLVERS {
        let [with, without] = [true, false].map(|meet| {
            let (mut block, faces) = cut();
            press(&mut block, name, 0.005, Some(&faces).filter(|_| meet));
            assert!(widths(&block, &faces).iter().all(|w| *w > 0.0));
            block.tissue
        });
        assert!(with == without, "{name}");
    }
}

#[test]
fn faces_without_the_effect_pass_through_each_other() {
    let (mut block, faces) = cut();
    press(&mut block, SOLVERS[0], 1.0, None);
    let deepest = widths(&block, &faces).into_iter().fold(0.0, f32::min);
    eprintln!("without contact: {deepest:.2e} m");
    assert!(deepest < -4.0 / PENALTY, "{deepest} m");
}
