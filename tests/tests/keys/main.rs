//! Every key of a scene file changes what is simulated, and a key of an effect that is off is refused.
//!
//! The scenes' own documents are walked: each leaf in turn gets another value, and both scenes tick until their outputs differ.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

mod effects;

use sutura::run::embedded::{NODES_MAX, PcRig};
use sutura::scene::build::{Built, build};
use sutura::scene::check::check;
use sutura::scene::{BUILT_IN, Source};

use sutura_controller::lanes::Level;
use sutura_controller::link::Plant;
use sutura_controller::record::Output;
use sutura_shared::scene::{Effect, Stage};
use sutura_tests::scenario::memory;
use toml::{Table, Value};

const TOUCH: &str = include_str!("../../../host/scenes/touch.toml");
/// Longest run [ticks].
const TICKS_MAX: usize = 13_000;
/// Ticks after the stitch is done.
const AFTER: usize = 200;

fn built(scene: &Table) -> Result<Built, String> {
    let source = Source {
        name: "scene".to_owned(),
        text: scene.to_string(),
    };
    let plan = source
        .parse()
        .and_then(|file| check(&source, &file))
        .map_err(|error| error.to_string())?;
    build(&plan, NODES_MAX).map_err(|error| error.to_string())
}

/// The built-in scene with the effects of the thread that it leaves off: their keys stand in comments.
fn with_all_of_the_thread() -> Table {
    let keys = ["friction", "bending_nn_m2", "strength_n"];
    let named = |text: String, key: &str| text.replace(&format!("\n# {key} = "), &format!("\n{key} = "));
    let mut scene: Table = keys.into_iter().fold(BUILT_IN.to_owned(), named).parse().unwrap();
    let effects = scene.get_mut("effects").unwrap().as_array_mut().unwrap();
    effects.extend([Effect::ThreadFriction, Effect::ThreadBending, Effect::Tearing].map(|effect| effect.name().into()));
    scene
}

/// The value at a path such as `tissue.0.slopes_kpa.1`.
fn at<'a>(scene: &'a mut Table, path: &str) -> &'a mut Value {
    let mut parts = path.split('.');
    let first = scene.get_mut(parts.next().unwrap()).unwrap();
    parts.fold(first, |value, part| match part.parse::<usize>() {
        Ok(index) => &mut value.as_array_mut().unwrap()[index],
        Err(_) => value.as_table_mut().unwrap().get_mut(part).unwrap(),
    })
}

/// The path of every leaf. Directions and matrices are one leaf each, for it takes more than one number to change them.
fn leaves(scene: &Table) -> Vec<String> {
    fn walk(path: &str, value: &Value, found: &mut Vec<String>) {
        let whole = ["along", "normal", "site_mm", "transform", "effects"];
        let last = path.rsplit('.').next().unwrap();
        match value {
            Value::Table(table) => table
                .iter()
                .for_each(|(key, value)| walk(&format!("{path}.{key}"), value, found)),
            Value::Array(array) if !whole.contains(&last) => {
                for (index, value) in array.iter().enumerate() {
                    walk(&format!("{path}.{index}"), value, found);
                }
            }
            _ => found.push(path.to_owned()),
        }
    }
    let mut found = Vec::new();
    scene.iter().for_each(|(key, value)| walk(key, value, &mut found));
    found
}

/// Other values for a key, from the nearest on; none for what names or lists a thing.
fn others(path: &str, value: &Value) -> Vec<Value> {
    let last = path.rsplit('.').next().unwrap();
    let text = |others: &[&str]| others.iter().map(|other| Value::from(*other)).collect();
    match (path, last) {
        // Names and paths; the effects have tests of their own.
        ("effects" | "phantom", _) | (_, "name" | "path") => Vec::new(),
        (_, "solver") => text(&["be-pcg:9:1"]),
        (_, "law") => text(&["axial"]),
        (_, "assembly") => text(&["per-voxel"]),
        (_, "profile") => text(&["touch"]),
        (_, "units") => text(&["mm", "cm"]),
        (_, "along") => vec![vec![0.5, 1.0, 0.0].into()],
        (_, "normal") => vec![vec![0.1, 0.1, 1.0].into()],
        (_, "site_mm" | "transform") => vec![moved(value)],
        // A whole number of voxels.
        ("wound.gap_mm" | "wound.length_mm" | "wound.depth_mm", _) => vec![(number(value) - 2.0).into()],
        _ if path.starts_with("patch.size_mm") => vec![(number(value) + 4.0).into()],
        _ => [1.05, 0.95, 1.3, 0.7]
            .map(|factor| Value::from(number(value) * factor))
            .to_vec(),
    }
}

fn number(value: &Value) -> f64 {
    let whole = value.as_integer().map(|whole| whole as f64);
    value.as_float().or(whole).unwrap()
}

/// A point, or the translation of a matrix, moved by 3 mm along x and y and as much down.
fn moved(value: &Value) -> Value {
    let rows = value.as_array().unwrap().iter().zip([3.0, 3.0, -3.0]);
    let moved = rows.map(|(row, by)| match row {
        Value::Array(row) => {
            let mut row = row.clone();
            row[3] = (number(&row[3]) + by).into();
            Value::Array(row)
        }
        part => (number(part) + by).into(),
    });
    moved.collect::<Vec<Value>>().into()
}

/// All outputs of a scene.
fn outputs(built: &Built) -> Vec<Output> {
    let mut memory = memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    let mut all: Vec<Output> = Vec::new();
    let mut done = 0;
    while all.len() < TICKS_MAX && done < AFTER {
        let output = rig.tick();
        done = if output.stage == Stage::Done { done + 1 } else { 0 };
        all.push(output);
    }
    all
}

/// The first tick at which the scene's output is another one.
fn differs(built: &Built, base: &[Output]) -> Option<u32> {
    let mut memory = memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    base.iter()
        .find(|output| rig.tick() != **output)
        .map(|output| output.tick)
}

/// Changes each of a scene's keys that `chosen` names; says which of them change nothing.
fn walk(name: &str, scene: &Table, chosen: impl Fn(&str) -> bool) {
    let base = outputs(&built(scene).unwrap());
    let mut silent = Vec::new();
    for path in leaves(scene).into_iter().filter(|path| chosen(path)) {
        let mut changed = scene.clone();
        let before = at(&mut changed, &path).clone();
        let candidates = others(&path, &before);
        let mut tick = None;
        let mut refused = String::new();
        for other in candidates.iter().filter(|other| **other != before) {
            *at(&mut changed, &path) = other.clone();
            match built(&changed) {
                Ok(built) => tick = differs(&built, &base),
                Err(error) => refused = error,
            }
            if tick.is_some() {
                break;
            }
        }
        match tick {
            Some(tick) => eprintln!("{name}: {path} acts at tick {tick} of {}", base.len()),
            None if candidates.is_empty() => {}
            // A mesh in another unit is nowhere near the site.
            None if path.ends_with("units") && !refused.is_empty() => {}
            None => silent.push(format!("{path} {refused}")),
        }
    }
    assert!(silent.is_empty(), "{name}: these keys change nothing: {silent:#?}");
}

#[test]
fn every_key_of_the_built_in_scene_acts() {
    let scene: Table = BUILT_IN.parse().unwrap();
    // These have tests below: no other pitch fits, the phantom is the same all along, its force and energy stay far from their limits, and
    // so does the knot.
    let elsewhere = [
        "patch.pitch_mm",
        "patch.along",
        "device.profile",
        "output.passivity_n_s_per_m",
        "thread.knot_hold_n",
    ];
    walk("stitch", &scene, |path| {
        !elsewhere.contains(&path) && !path.ends_with("body")
    });
}

/// The stitch pulls with 1.3 N.
#[test]
fn the_knots_limit_acts_where_it_slips() {
    let mut scene: Table = BUILT_IN.parse().unwrap();
    *at(&mut scene, "thread.knot_hold_n") = 0.5.into();
    walk("slipping knot", &scene, |path| path == "thread.knot_hold_n");
}

#[test]
fn the_threads_friction_and_stiffness_act() {
    walk("rubbing stiff thread", &with_all_of_the_thread(), |path| {
        matches!(path, "thread.friction" | "thread.bending_nn_m2")
    });
}

/// The stitch pulls with 1.3 N, and more where its thread turns.
#[test]
fn the_tissues_strength_acts_where_it_yields() {
    let mut scene = with_all_of_the_thread();
    *at(&mut scene, "tissue.0.strength_n") = 1.0.into();
    walk("yielding tissue", &scene, |path| path == "tissue.0.strength_n");
}

#[test]
fn the_devices_limits_act_on_a_force_larger_than_life() {
    let mut scene: Table = BUILT_IN.parse().unwrap();
    *at(&mut scene, "output.scale") = 3.3.into(); // The most that friction and encoders bear of 800 N/m.
    walk("large", &scene, |path| path == "device.profile");
}

#[test]
fn every_key_of_touching_acts() {
    let mut scene: Table = TOUCH.parse().unwrap();
    *at(&mut scene, "output.slew_n_per_tick") = 0.002.into(); // A force that lags gives out energy as the ball is lifted off.
    *at(&mut scene, "patch.law") = "volume".into();
    let patch = scene.get_mut("patch").unwrap().as_table_mut().unwrap();
    patch.insert("poisson".to_owned(), 0.4.into());
    patch.insert("assembly".to_owned(), "every-edge".into());
    // The others are those of the built-in scene.
    let own = [
        "patch.poisson",
        "patch.assembly",
        "patch.pitch_mm",
        "output.passivity_n_s_per_m",
    ];
    walk("touch", &scene, |path| {
        own.contains(&path) || path.starts_with("ball") || path.starts_with("operator")
    });
}

/// The phantom's meshes as files of a user's own.
#[test]
fn every_key_of_a_mesh_acts() {
    let folder = tempfile::tempdir().unwrap();
    let files = sutura::geometry::phantom::write(folder.path()).unwrap();
    let mut scene: Table = TOUCH.parse().unwrap();
    scene.remove("phantom");
    *at(&mut scene, "patch.size_mm.2") = 24.into();
    *at(&mut scene, "patch.pitch_mm") = 4.into();
    *at(&mut scene, "contact.kernel_mm") = 7.into();
    let patch = scene.get_mut("patch").unwrap().as_table_mut().unwrap();
    let vector = |v: [f64; 3]| Value::from(v.to_vec());
    patch.insert("site_mm".to_owned(), vector(sutura::geometry::phantom::SITE));
    patch.insert("normal".to_owned(), vector(sutura::geometry::phantom::NORMAL));
    for tissue in scene.get_mut("tissue").unwrap().as_array_mut().unwrap() {
        let tissue = tissue.as_table_mut().unwrap();
        let name = tissue["name"].as_str().unwrap().to_owned();
        let path = files
            .iter()
            .find(|path| path.file_stem().unwrap() == name.as_str())
            .unwrap();
        // Skin is what muscle leaves of it: as a layer of its own it would have muscle below it whatever the meshes say.
        tissue.remove("thickness_mm");
        // Millimetres, taken for metres and made a thousandth of that.
        let mut mesh = Table::new();
        mesh.insert("path".to_owned(), path.to_str().unwrap().into());
        mesh.insert("units".to_owned(), "m".into());
        let rows = (0..3).map(|i| {
            (0..4)
                .map(|j| if i == j { 1e-3 } else { 0.0 })
                .collect::<Vec<f64>>()
                .into()
        });
        mesh.insert("transform".to_owned(), Value::Array(rows.collect()));
        tissue.insert("mesh".to_owned(), mesh.into());
    }
    let named = ["site_mm", "normal", "along", "units", "transform"];
    walk("meshes", &scene, |path| {
        named.contains(&path.rsplit('.').next().unwrap())
    });
    // Bone that gives way.
    let base = outputs(&built(&scene).unwrap());
    let soft = [
        ("body", "soft".into()),
        ("density_kg_m3", 1900.into()),
        ("slopes_kpa", vec![1000].into()),
    ];
    at(&mut scene, "tissue.2")
        .as_table_mut()
        .unwrap()
        .extend(soft.map(|(key, value)| (key.to_owned(), value)));
    assert!(differs(&built(&scene).unwrap(), &base).is_some(), "tissue.2.body");
}
