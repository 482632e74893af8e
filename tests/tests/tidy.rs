//! The repository keeps to its own rules.

use sutura_tests::tidy::{self, Source, Violation, layers, size, structure, words};

/// Fails with one line for each violation of `rule` in the repository.
fn keeps(rule: fn(&[Source]) -> Vec<Violation>) {
    let Some(sources) = tidy::sources(&sutura_tests::root()) else {
        return sutura_tests::skipped("tidy", "a git checkout");
    };
    assert!(sources.iter().any(Source::is_rust), "no Rust file found");
    let violations = rule(&sources);
    let lines: Vec<_> = violations.iter().map(Violation::to_string).collect();
    assert!(lines.is_empty(), "{} violations:\n{}", lines.len(), lines.join("\n"));
}

#[test]
fn packages_depend_as_the_picture_says() {
    keeps(structure::dependencies);
}

#[test]
fn versions_stand_in_one_place() {
    keeps(structure::versions);
}

#[test]
fn libraries_forbid_unsafe() {
    keeps(structure::library_roots);
}

#[test]
fn the_top_level_is_fixed() {
    keeps(structure::top_level);
}

#[test]
fn the_controller_imports_downwards() {
    keeps(layers::imports);
}

#[test]
fn files_are_short() {
    keeps(size::files);
}

#[test]
fn functions_are_short() {
    keeps(size::functions);
}

#[test]
fn nothing_is_left_as_a_stub() {
    keeps(words::stubs);
}

#[test]
fn bits_do_not_depend_on_the_platform() {
    keeps(words::float_methods);
}

#[test]
fn no_path_of_one_machine_is_named() {
    keeps(words::machine_paths);
}
