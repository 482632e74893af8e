//! The VTK files of a run, read back: by the crate that wrote them, and by meshio where Python has it.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::Vector3;
use sutura::run::embedded::{NODES_MAX, PcRig};
use sutura::run::vtk::Frames;
use sutura::run::{self, Error, Request};
use sutura::scene::{self, build};
use sutura_controller::lanes::Level;
use sutura_controller::lattice;
use sutura_controller::link::Plant as _;
use vtkio::model::{Attribute, Attributes, DataSet, Piece, PolyDataPiece, UnstructuredGridPiece, VertexNumbers};
use vtkio::{IOBuffer, Vtk};

/// Ticks of the run: a little longer than to the first puncture.
const TICKS: u32 = 2_600;
/// Ticks from frame to frame.
const EVERY: u32 = 200;

fn sutura(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sutura"));
    command.args(arguments).current_dir(folder).output().unwrap()
}

fn data(path: &Path) -> DataSet {
    Vtk::import(path).unwrap().data
}

fn grid(path: &Path) -> UnstructuredGridPiece {
    match data(path) {
        DataSet::UnstructuredGrid { mut pieces, .. } => match pieces.remove(0) {
            Piece::Inline(piece) => *piece,
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
}

fn poly(path: &Path) -> PolyDataPiece {
    match data(path) {
        DataSet::PolyData { mut pieces, .. } => match pieces.remove(0) {
            Piece::Inline(piece) => *piece,
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
}

fn vectors(buffer: &IOBuffer) -> Vec<Vector3<f64>> {
    let numbers: Vec<f64> = buffer.cast_into().unwrap();
    numbers.chunks(3).map(Vector3::from_row_slice).collect()
}

fn field<'a>(attributes: &'a [Attribute], name: &str) -> &'a IOBuffer {
    let mut found = attributes.iter().filter_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(&array.data),
        _ => None,
    });
    found.next().unwrap()
}

fn cells(numbers: VertexNumbers) -> Vec<Vec<usize>> {
    let (connectivity, offsets) = numbers.into_xml();
    let mut from = 0;
    let cell = |to: u64| {
        let cell = connectivity[from..to as usize]
            .iter()
            .map(|point| *point as usize)
            .collect();
        from = to as usize;
        cell
    };
    offsets.into_iter().map(cell).collect()
}

/// Six times the volume between a face and the origin: the mean over both ways of cutting a quad into triangles, so that two cells that share
/// a face agree on it.
fn under(face: [Vector3<f64>; 4]) -> f64 {
    let [a, b, c, d] = face;
    let det = |p: Vector3<f64>, q: Vector3<f64>, r: Vector3<f64>| p.dot(&q.cross(&r));
    (det(a, b, c) + det(a, c, d) + det(a, b, d) + det(b, c, d)) / 2.0
}

/// Faces of VTK's hexahedron, counter-clockwise seen from outside.
const FACES: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// The built-in scene's patch, node by node: place at rest, and displacement after each of these ticks [m].
fn patch_itself(ticks: &[u32]) -> (Vec<Vector3<f32>>, Vec<Vec<Vector3<f32>>>) {
    let built = build::build(&scene::load(None).unwrap(), NODES_MAX).unwrap();
    let mut memory = bytemuck::zeroed_box();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    let mut all = Vec::new();
    for tick in 1..=*ticks.last().unwrap() {
        rig.tick();
        if ticks.contains(&tick) {
            all.push(
                exist(&rig)
                    .map(|n| lattice::at(&rig.controller().tissue().displacement, n))
                    .collect(),
            );
        }
    }
    let rest = exist(&rig).map(|n| rig.controller().lattice().rest_place(n)).collect();
    (rest, all)
}

fn exist<'a>(rig: &'a PcRig<'_>) -> impl Iterator<Item = usize> + 'a {
    let patch = rig.controller().lattice();
    patch
        .nodes()
        .map(|(_, node)| node)
        .filter(|node| patch.mass[*node] > 0.0)
}

#[test]
fn the_files_hold_what_the_run_was() {
    let folder = tempfile::tempdir().unwrap();
    let seconds = (f64::from(TICKS) * 1e-3).to_string();
    let output = sutura(
        folder.path(),
        &[
            "run",
            "--headless",
            "--json",
            "--seconds",
            &seconds,
            "--vtu",
            "v",
            "--fps",
            "5",
        ],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let counts = ["nodes", "voxels"].map(|name| report[name].as_u64().unwrap());
    let place = folder.path().join("v");
    every_file_is_listed(&place);
    let ticks = [2_400, 2_600];
    let (rest, moved) = patch_itself(&ticks);
    for (tick, moved) in ticks.into_iter().zip(moved) {
        let file = |part: &str| place.join(format!("{part}_{tick:05}.vtp"));
        let volumes = patch_is(&place.join(format!("patch_{tick:05}.vtu")), (&rest, &moved), counts);
        surface_closes(poly(&file("surface")), volumes.iter().sum());
        needle_is_an_arc(&poly(&file("tool")));
    }
    let punctures = poly(&place.join("punctures_02600.vtp"));
    let force: Vec<f64> = field(&punctures.data.point, "force_n").cast_into().unwrap();
    assert_eq!(force.len(), 1);
    assert!((force[0] - report["punctures"][0]["force_n"].as_f64().unwrap()).abs() < 1e-6);
    read_by_meshio(&place, counts);
}

/// Every file that is there stands in the list, with its time.
fn every_file_is_listed(place: &Path) {
    let list = std::fs::read_to_string(place.join("run.pvd")).unwrap();
    let mut listed: Vec<_> = list
        .split("file=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap().to_owned())
        .collect();
    let names = std::fs::read_dir(place)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut there: Vec<_> = names.filter(|name| name != "run.pvd").collect();
    listed.sort();
    there.sort();
    assert_eq!(listed, there);
    // Patch, surface, tool and thread in every frame, punctures in the last one alone.
    assert_eq!(there.len() as u32, 4 * (TICKS / EVERY) + 1);
    assert!(list.contains("timestep=\"2.6\""));
}

/// The patch has as many nodes and voxels as the run says, its nodes are where they were, and no voxel is inside out. Gives their volumes.
fn patch_is(path: &Path, (rest, moved): (&[Vector3<f32>], &[Vector3<f32>]), [nodes, voxels]: [u64; 2]) -> Vec<f64> {
    let patch = grid(path);
    assert_eq!(
        (patch.points.len() as u64, patch.cells.types.len() as u64),
        (3 * nodes, voxels)
    );
    let Attributes { point, cell } = &patch.data;
    let double = |by: &Vector3<f32>| by.map(f64::from);
    assert_eq!(
        vectors(field(point, "displacement_m")),
        moved.iter().map(double).collect::<Vec<_>>()
    );
    let places = vectors(&patch.points);
    let expected: Vec<_> = rest.iter().zip(moved).map(|(rest, by)| double(&(rest + by))).collect();
    assert_eq!(places, expected);
    assert!(moved.iter().map(Vector3::norm).fold(0.0, f32::max) > 5e-4);
    let volumes = volumes(cells(patch.cells.cell_verts), &places);
    assert!(volumes.iter().all(|volume| *volume > 0.0));
    let [strains, ratios] = ["strain", "volume_ratio"].map(|name| field(cell, name).cast_into::<f64>().unwrap());
    // J of the mean edges and the volume differ by the part of the motion that no gradient has; a voxel at rest has 8 mm³.
    for (ratio, volume) in ratios.iter().zip(&volumes) {
        assert!((ratio - volume / 8e-9).abs() < 0.1, "{ratio} {}", volume / 8e-9);
    }
    assert!(strains.iter().all(|strain| (-0.5..1.0).contains(strain)) && strains.iter().any(|strain| *strain > 0.01));
    volumes
}

fn volumes(voxels: Vec<Vec<usize>>, places: &[Vector3<f64>]) -> Vec<f64> {
    let one = |voxel: Vec<usize>| {
        FACES
            .iter()
            .map(|face| under(face.map(|corner| places[voxel[corner]])))
            .sum::<f64>()
            / 6.0
    };
    voxels.into_iter().map(one).collect()
}

/// By the divergence theorem a closed surface that is outward everywhere holds as much as its voxels.
fn surface_closes(surface: PolyDataPiece, volume: f64) {
    let places = vectors(&surface.points);
    let faces = cells(surface.polys.unwrap());
    let held: f64 = faces
        .iter()
        .map(|face| under([0, 1, 2, 3].map(|corner| places[face[corner]])))
        .sum();
    assert!((held / 6.0 / volume - 1.0).abs() < 1e-6, "{} {volume}", held / 6.0);
}

/// The built-in needle: half a circle 26 mm long, whose ends are a diameter apart.
fn needle_is_an_arc(needle: &PolyDataPiece) {
    let places = vectors(&needle.points);
    let from_tip: Vec<f64> = field(&needle.data.point, "from_tip_m").cast_into().unwrap();
    let diameter = 2.0 * 0.026 / std::f64::consts::PI;
    let (tip, swage) = (places[0], places[places.len() - 1]);
    assert!(((tip - swage).norm() - diameter).abs() < 1e-6 && (from_tip.last().unwrap() - 0.026).abs() < 1e-8);
    let centre = (tip + swage) / 2.0;
    for place in &places {
        assert!(((place - centre).norm() - diameter / 2.0).abs() < 1e-6);
    }
}

/// What somebody else's reader finds in the patch.
const SCRIPT: &str = "
import glob, meshio, numpy, sys
for path in glob.glob(sys.argv[1] + '/patch_*.vtu'):
    mesh = meshio.read(path)
    (block,) = mesh.cells
    assert block.type == 'hexahedron', block.type
    assert (len(mesh.points), len(block.data)) == (int(sys.argv[2]), int(sys.argv[3])), path
    corner = mesh.points[block.data.astype(int)].astype(float)
    edges = corner[:, [1, 3, 4]] - corner[:, [0]]
    assert (numpy.linalg.det(edges) > 0).all(), path
    rest = mesh.points - mesh.point_data['displacement_m']
    grid = (rest - rest.min(axis=0)) / 2e-3
    assert abs(grid - grid.round()).max() < 1e-3, path
    assert set(mesh.cell_data) == {'tissue', 'strain', 'volume_ratio'}
print('read')
";

/// Whether meshio reads the patch as it was written; says so where there is no meshio.
fn read_by_meshio(folder: &Path, [nodes, voxels]: [u64; 2]) {
    let python = |program: &&str| {
        let tried = Command::new(program).args(["-c", "import meshio"]).output();
        tried.is_ok_and(|output| output.status.success())
    };
    // The second is the system's own, for which packages of the distribution are.
    let Some(program) = ["python3", "/usr/bin/python3"].into_iter().find(python) else {
        eprintln!("skipped: reading VTK files back needs Python with meshio");
        return;
    };
    let mut command = Command::new(program);
    command
        .args(["-c", SCRIPT])
        .arg(folder)
        .args([nodes, voxels].map(|n| n.to_string()));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("read"));
}

#[test]
fn an_interrupted_run_leaves_no_frame() {
    let folder = tempfile::tempdir().unwrap();
    let [out, frames] = ["o", "v"].map(|name| folder.path().join(name));
    let request = Request {
        scene: None,
        meshes: Vec::new(),
        seconds: Some(1.0),
        realtime: false,
        level: Level::best(),
        out,
        frames: Some(Frames {
            folder: frames.clone(),
            every: 10,
        }),
    };
    let interrupted = AtomicBool::new(false);
    let result = run::run(&request, &interrupted, |tick| {
        if tick.tick == 300 {
            interrupted.store(true, Ordering::Relaxed);
        }
    });
    assert!(matches!(result, Err(Error::Interrupted)));
    assert_eq!(std::fs::read_dir(frames).unwrap().count(), 0);
}

#[test]
fn frames_that_cannot_be_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    for (arguments, what) in [
        (&["--vtu", "v", "--fps", "0"][..], "a divisor of 1000 is needed"),
        (&["--vtu", "v", "--fps", "2000"], "a divisor of 1000 is needed"),
        (&["--vtu", "v", "--fps", "30"], "a divisor of 1000 is needed"),
        (&["--vtu", "v", "--fps", "ten"], "a divisor of 1000 is needed"),
        (&["--fps", "10"], "--vtu"),
        (&["--vtu", "file", "--seconds", "0.01"], "file"),
    ] {
        let output = sutura(folder.path(), &[&["run"], arguments].concat());
        let line = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(line.contains(what) && line.lines().count() == 1, "{line}");
    }
    assert!(!PathBuf::from(folder.path()).join("v").exists());
}
