//! A needle by its name, and where its driver holds it.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used, clippy::panic)]

use sutura::scene::BUILT_IN;
use sutura_shared::scene::Tool;
use sutura_tests::scenario;

/// Radius, length and grasp [mm] of the built-in scene's needle with one piece of text replaced.
fn needle(from: &str, to: &str) -> [f32; 3] {
    assert!(BUILT_IN.contains(from), "{from}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, BUILT_IN.replace(from, to)).unwrap();
    match scenario::built(Some(&path)).unwrap().scene.tool {
        Tool::Needle {
            radius_m,
            length_m,
            grasp_m,
        } => [radius_m, length_m, grasp_m].map(|m| m * 1e3),
        Tool::Ball { .. } => panic!("a needle"),
    }
}

/// R = L/θ: 36 mm on half a circle, 24 mm on three eighths; a third of the length from the swage, or what the scene says.
#[test]
fn names_and_grasps_reach_the_controller() {
    let shape = "arc_of_circle = 0.5\nlength_mm = 26 ";
    let cases = [
        ("kind = \"CT-1\" ", [11.459, 36.0, 12.0]),
        ("kind = \"FS-1\" ", [10.186, 24.0, 8.0]),
        ("kind = \"SH\"\ngrasp = 0.3 ", [8.276, 26.0, 7.8]),
    ];
    for (text, expected) in cases {
        let found = needle(shape, text);
        assert!(
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3),
            "{text}: {found:?}"
        );
    }
}
