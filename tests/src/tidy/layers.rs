//! The floors inside the controller: data at the bottom, behaviour above it, the sequence on top.
//!
//! A module imports from floors below its own only; those of one floor are peers and never import each other.

use super::{Source, Violation, text};

/// Where the floors are.
const FOLDER: &str = "controller/src/";

/// The floors, from the bottom. Every module below [`FOLDER`] stands on one.
const FLOORS: [&[&str]; 16] = [
    // Plain arithmetic.
    &["math"],
    &["hash", "lanes"],
    // Immutable parameters and everything that changes: plain data.
    &["lattice", "event"],
    // What holds the tissue: weighted points of the lattice.
    &["coupling"],
    // Where the lattice ends: its skin, and the faces of its wound.
    &["surface", "wound"],
    // What a spring is.
    &["law"],
    // How a stiff spring system is advanced.
    &["solver"],
    // Behaviour: free functions (params, state, inputs) → record.
    &["needle", "thread", "tissue", "contact", "force", "safety"],
    // What a thread does to tissue that its punctures lie in.
    &["tear"],
    // What a scene may call for of all that, and what it takes.
    &["effects"],
    // Read off all of them: where a stitch is.
    &["stage"],
    // What crosses the tick's edges, a limited force among it.
    &["record"],
    // The hand's side of that edge.
    &["device"],
    // One millisecond on one page.
    &["tick"],
    // Whatever ticks, behind frames.
    &["link"],
    // The controller and a simulated device there.
    &["rig"],
];

/// Imports of a peer or of a floor above, modules without a floor, and names whose module cannot be seen.
#[must_use]
pub fn imports(sources: &[Source]) -> Vec<Violation> {
    let modules = sources.iter().filter_map(|source| Some((source, module_path(source)?)));
    modules
        .filter(|(_, path)| !path.is_empty())
        .flat_map(|(source, path)| imports_of(source, &path))
        .collect()
}

fn imports_of(source: &Source, path: &[&str]) -> Vec<Violation> {
    let Some((module, floor)) = path.first().and_then(|module| Some((*module, floor_of(module)?))) else {
        return vec![Violation::new(
            source,
            0,
            "this module has no floor in the table of tests/src/tidy/layers.rs",
        )];
    };
    let code = text::code(source.shipped());
    let judge = |(at, name): (usize, &str)| {
        let what = match floor_of(name) {
            _ if name == module => return None,
            Some(below) if below < floor => return None,
            Some(beside) if beside == floor => {
                format!("`{module}` and `{name}` are peers: what couples them happens above")
            }
            Some(_) => format!("`{name}` is above `{module}`"),
            None => {
                format!("`{name}` is no module of the table of tests/src/tidy/layers.rs: import from the module itself")
            }
        };
        Some(Violation::new(source, text::line_of(&code, at), what))
    };
    root_names(&code, path.len()).into_iter().filter_map(judge).collect()
}

fn floor_of(module: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&module))
}

/// `["solver", "pcg"]` for `controller/src/solver/pcg.rs`, `[]` for the library's root; `None` outside the controller.
fn module_path(source: &Source) -> Option<Vec<&str>> {
    let path = source.path.strip_prefix(FOLDER)?.strip_suffix(".rs")?;
    let path = path.strip_suffix("/mod").unwrap_or(path);
    Some(if path == "lib" {
        Vec::new()
    } else {
        path.split('/').collect()
    })
}

/// Names that the code takes from the library's root, through `crate::` or through as many `super::` as its `depth`, and where.
fn root_names(code: &str, depth: usize) -> Vec<(usize, &str)> {
    let climb = "super::".repeat(depth);
    let climbs = text::words(code, &climb)
        .filter(|&at| !code[..at].ends_with("super::"))
        .map(|at| (at, climb.len()));
    let roots = text::words(code, "crate::").map(|at| (at, "crate::".len()));
    let names = roots
        .chain(climbs)
        .flat_map(|(at, len)| first_names(&code[at + len..]).into_iter().map(move |name| (at, name)));
    names.filter(|(_, name)| !name.is_empty() && *name != "super").collect()
}

/// The first name of the path, or of each path of the group, that `rest` begins with.
fn first_names(rest: &str) -> Vec<&str> {
    let Some(group) = rest.strip_prefix('{') else {
        return vec![first_name(rest)];
    };
    let mut depth = 0_i32;
    let mut names = Vec::new();
    let mut from = 0;
    for (at, c) in group.char_indices() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if depth < 0 || (depth == 0 && c == ',') {
            names.push(first_name(&group[from..at]));
            from = at + 1;
        }
        if depth < 0 {
            break;
        }
    }
    names
}

fn first_name(path: &str) -> &str {
    path.trim_start()
        .split(|c| !text::is_word(c))
        .next()
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> usize {
        imports(&[Source {
            path: format!("{FOLDER}{path}"),
            text: text.into(),
        }])
        .len()
    }

    #[test]
    fn a_module_may_use_what_is_below() {
        assert_eq!(
            found(
                "law/mod.rs",
                "use crate::math::Vec3;\nuse crate::{hash, lattice::{Params, State}};"
            ),
            0
        );
        assert_eq!(
            found(
                "solver/pcg.rs",
                "use super::Solver;\nuse super::super::law;\nuse crate::solver::Solver;"
            ),
            0
        );
        assert_eq!(found("lib.rs", "pub mod tick;\nuse crate::tick::Controller;"), 0);
    }

    #[test]
    fn a_peer_is_found() {
        assert_eq!(found("needle.rs", "use crate::thread::Tension;"), 1);
        assert_eq!(found("needle.rs", "fn a() -> crate::thread::Tension { b() }"), 1);
        assert_eq!(found("needle.rs", "use super::thread;"), 1);
    }

    #[test]
    fn a_floor_above_is_found() {
        assert_eq!(found("math.rs", "use crate::law::Law;"), 1);
        assert_eq!(found("law/paper.rs", "use super::super::solver::Solver;"), 1);
        assert_eq!(
            found(
                "lattice.rs",
                "use crate::{\n    law::{A, B},\n    math::C,\n    tick,\n};\nuse other::{link, needle};"
            ),
            2
        );
    }

    #[test]
    fn a_name_that_hides_its_module_is_found() {
        assert_eq!(found("tick.rs", "use crate::Controller;"), 1);
        assert_eq!(found("helpers.rs", ""), 1);
    }

    #[test]
    fn comments_and_tests_do_not_count() {
        assert_eq!(
            found(
                "math.rs",
                "// crate::law::Law\n#[cfg(test)]\nmod tests { use crate::law::Law; }"
            ),
            0
        );
    }
}
