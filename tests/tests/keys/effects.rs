//! The keys of effects: refused where their effect is off, with defaults where it is on.

use sutura_controller::effects::{Row, TABLE, row};
use sutura_shared::scene::Effect;
use toml::{Table, Value};

use super::{TOUCH, at, built, with_all_of_the_thread};

/// Takes a name out of a scene's effects.
fn switch_off(scene: &mut Table, effect: Effect) {
    let effects = scene.get_mut("effects").unwrap().as_array_mut().unwrap();
    effects.retain(|name| name.as_str() != Some(effect.name()));
}

/// The tables that hold a key of an effect, and its name there.
fn holders<'a>(scene: &'a mut Table, key: &'static str) -> (Vec<&'a mut Table>, &'static str) {
    let (section, last) = key.rsplit_once('.').unwrap();
    let tables = match section {
        "tissue" => {
            let tissues = scene.get_mut("tissue").unwrap().as_array_mut().unwrap();
            tissues
                .iter_mut()
                .map(|tissue| tissue.as_table_mut().unwrap())
                .collect()
        }
        _ => {
            let mut parts = section.split('.');
            let first = scene.get_mut(parts.next().unwrap()).and_then(Value::as_table_mut);
            let table = parts.fold(first, |table, part| table?.get_mut(part)?.as_table_mut());
            table.into_iter().collect()
        }
    };
    (tables, last)
}

/// Takes an effect's section out of a scene where nothing stands in it.
fn drop_empty(scene: &mut Table, row: &Row) {
    if let Some(section) = row.section
        && scene
            .get(section)
            .and_then(Value::as_table)
            .is_some_and(Table::is_empty)
    {
        scene.remove(section);
    }
}

/// Takes everything of an effect out of a scene but `kept`; then the effect's empty section.
fn leave_out(scene: &mut Table, row: &Row, kept: Option<&str>) {
    switch_off(scene, row.effect);
    for key in row.keys.iter().filter(|key| Some(key.name) != kept) {
        let (tables, last) = holders(scene, key.name);
        for table in tables {
            table.remove(last);
            // Without breaks a curve is its first slope.
            if let ("breaks_percent", Some(Value::Array(slopes))) = (last, table.get_mut("slopes_kpa")) {
                slopes.truncate(1);
            }
        }
    }
    drop_empty(scene, row);
    for other in TABLE.iter().filter(|other| other.needs == Some(row.effect)) {
        leave_out(scene, other, None);
    }
    drop_empty(scene, row);
}

#[test]
fn a_key_of_an_effect_that_is_off_is_refused_with_its_name() {
    for row in &TABLE {
        for key in row.keys {
            let mut scene = with_all_of_the_thread();
            if row.effect == Effect::Puncture {
                let stitch = at(&mut scene, "stitch").as_table_mut().unwrap();
                stitch.insert("stitches".to_owned(), 3.into());
                stitch.insert("spacing_mm".to_owned(), 6.into());
            }
            leave_out(&mut scene, row, Some(key.name));
            let error = built(&scene).unwrap_err();
            let section = key.name.split('.').next().unwrap();
            let what = match row.section {
                Some(own) if own == section => format!("section [{own}]"),
                _ => format!("key {}", key.name),
            };
            let expected = format!(
                "{what} needs effect {0}: add \"{0}\" to effects or remove it",
                row.effect.name()
            );
            assert!(
                error.starts_with("scene:") && error.ends_with(&expected),
                "{}: {error}",
                key.name
            );
        }
    }
}

/// Puncture has its hand: a scene that sews cannot do without.
#[test]
fn a_scene_is_one_without_any_other_effect() {
    for row in TABLE.iter().filter(|row| row.effect != Effect::Puncture) {
        let mut scene = with_all_of_the_thread();
        leave_out(&mut scene, row, None);
        let built = built(&scene).unwrap_or_else(|error| panic!("{}: {error}", row.effect.name()));
        assert!(!built.scene.effects.has(row.effect));
        assert_eq!(built.scene.thread.is_some(), built.scene.effects.has(Effect::Thread));
    }
}

/// The built-in scene spells the defaults out, so it stays what it is where any of them is left out, and its effects' names suffice.
#[test]
fn a_key_that_is_left_out_has_its_default() {
    let whole = with_all_of_the_thread();
    let expected = built(&whole).unwrap().scene;
    let mut names = whole.clone();
    for key in TABLE
        .iter()
        .flat_map(|row| row.keys)
        .filter(|key| !key.default.is_empty())
    {
        let mut scene = whole.clone();
        for scene in [&mut scene, &mut names] {
            let (tables, last) = holders(scene, key.name);
            let removed = tables.into_iter().filter_map(|table| table.remove(last)).count();
            assert_eq!(removed, 1, "{}", key.name);
        }
        assert_eq!(built(&scene).unwrap().scene, expected, "{}", key.name);
    }
    for section in ["stitch", "thread"] {
        assert!(names.remove(section).unwrap().as_table().unwrap().is_empty());
    }
    assert_eq!(built(&names).unwrap().scene, expected);
}

#[test]
fn a_name_suffices_to_add_an_effect() {
    let mut touch: Table = TOUCH.parse().unwrap();
    for effect in [Effect::Passivity, Effect::SpringDamping, Effect::Stiffening] {
        leave_out(&mut touch, row(effect), None);
    }
    let plain = built(&touch).unwrap().scene;
    for effect in [Effect::Passivity, Effect::SpringDamping, Effect::Stiffening] {
        touch["effects"].as_array_mut().unwrap().push(effect.name().into());
        let scene = built(&touch).unwrap().scene;
        assert!(scene.effects.has(effect) && scene != plain);
    }
}
