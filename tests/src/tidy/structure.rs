//! Packages and who may depend on whom, manifests, library roots, the top level.

use super::{Source, Violation};
use std::collections::BTreeSet;
use toml::{Table, Value};

/// One package of the picture.
struct Package {
    folder: &'static str,
    name: &'static str,
    /// Our own packages it may depend on.
    ours: &'static [&'static str],
    /// Other people's crates it may depend on; `None`: any.
    theirs: Option<&'static [&'static str]>,
}

/// The dependency picture.
const PICTURE: [Package; 7] = [
    Package {
        folder: "shared",
        name: "sutura-shared",
        ours: &[],
        theirs: Some(&["serde", "postcard", "crc", "cobs", "heapless"]),
    },
    Package {
        folder: "controller",
        name: "sutura-controller",
        ours: &["sutura-shared"],
        theirs: Some(&["nalgebra", "heapless", "libm", "bytemuck", "fearless_simd"]),
    },
    Package {
        folder: "controller/rt",
        name: "sutura-rt",
        ours: &["sutura-controller", "sutura-shared"],
        theirs: None,
    },
    Package {
        folder: "controller/firmware",
        name: "sutura-firmware",
        ours: &["sutura-controller", "sutura-shared"],
        theirs: Some(&["bytemuck", "cortex-m-rt", "static_cell"]),
    },
    Package {
        folder: "host",
        name: "sutura",
        ours: &["sutura-controller", "sutura-rt", "sutura-shared"],
        theirs: None,
    },
    Package {
        folder: "tests",
        name: "sutura-tests",
        ours: &["sutura", "sutura-controller", "sutura-rt", "sutura-shared"],
        theirs: None,
    },
    Package {
        folder: "hil",
        name: "sutura-hil",
        ours: &["sutura-tests"],
        theirs: None,
    },
];

/// The package with a workspace, and so versions, of its own.
const OWN_WORKSPACE: &str = "controller/firmware";

/// All that may stand at the top beside dotfiles.
const TOP: [&str; 9] = [
    "Cargo.toml",
    "Cargo.lock",
    "LICENSE",
    "README.md",
    "controller",
    "host",
    "shared",
    "tests",
    "hil",
];

/// Dependencies that the picture does not have.
#[must_use]
pub fn dependencies(sources: &[Source]) -> Vec<Violation> {
    manifests(sources)
        .flat_map(|(source, manifest)| dependencies_of(source, &manifest))
        .collect()
}

fn dependencies_of(source: &Source, manifest: &Table) -> Vec<Violation> {
    let Some(name) = manifest
        .get("package")
        .and_then(|package| package.get("name"))
        .and_then(Value::as_str)
    else {
        return Vec::new();
    };
    let folder = folder_of(source);
    let Some(package) = PICTURE
        .iter()
        .find(|package| package.name == name && package.folder == folder)
    else {
        return vec![Violation::new(
            source,
            0,
            format!("no package `{name}` in `{folder}` stands in the dependency picture"),
        )];
    };
    let allowed = |kind: &str, dependency: &str| {
        if dependency.starts_with("sutura") {
            return package.ours.contains(&dependency);
        }
        kind == "dev-dependencies" || package.theirs.is_none_or(|theirs| theirs.contains(&dependency))
    };
    let strangers = dependency_tables(manifest)
        .flat_map(|(kind, table)| table.keys().filter(move |dependency| !allowed(kind, dependency)));
    strangers
        .map(|dependency| Violation::new(source, 0, format!("{name} may not depend on {dependency}")))
        .collect()
}

/// Versions that stand in a member's manifest rather than in the workspace's.
#[must_use]
pub fn versions(sources: &[Source]) -> Vec<Violation> {
    let members = manifests(sources).filter(|(source, _)| folder_of(source) != OWN_WORKSPACE);
    members
        .flat_map(|(source, manifest)| {
            let inherited = |spec: &Value| spec.get("workspace").and_then(Value::as_bool) == Some(true);
            let own: Vec<_> = dependency_tables(&manifest)
                .flat_map(|(_, table)| {
                    table
                        .iter()
                        .filter(|(_, spec)| !inherited(spec))
                        .map(|(name, _)| name.clone())
                })
                .collect();
            let what = |name| format!("the version of {name} belongs in the root's [workspace.dependencies]");
            own.into_iter().map(move |name| Violation::new(source, 0, what(name)))
        })
        .collect()
}

/// Library roots that do not forbid `unsafe`.
#[must_use]
pub fn library_roots(sources: &[Source]) -> Vec<Violation> {
    let roots = sources.iter().filter(|source| source.path.ends_with("/src/lib.rs"));
    roots
        .filter(|source| !source.text.lines().any(|line| line == "#![forbid(unsafe_code)]"))
        .map(|source| Violation::new(source, 0, "a library root has the line `#![forbid(unsafe_code)]`"))
        .collect()
}

/// Strangers at the top level.
#[must_use]
pub fn top_level(sources: &[Source]) -> Vec<Violation> {
    let tops: BTreeSet<_> = sources
        .iter()
        .filter_map(|source| source.path.split('/').next())
        .collect();
    let strangers = tops
        .into_iter()
        .filter(|top| !top.starts_with('.') && !TOP.contains(top));
    strangers
        .map(|top| Violation {
            path: top.into(),
            line: 0,
            what: format!("the top level holds {} and dotfiles", TOP.join(", ")),
        })
        .collect()
}

fn folder_of(source: &Source) -> &str {
    source.path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Every package's manifest that can be read; cargo itself speaks up about the others.
fn manifests(sources: &[Source]) -> impl Iterator<Item = (&Source, Table)> {
    let files = sources.iter().filter(|source| source.path.ends_with("/Cargo.toml"));
    files.filter_map(|source| Some((source, source.text.parse().ok()?)))
}

/// Every dependency table of a manifest with its kind, those for one target too.
fn dependency_tables(manifest: &Table) -> impl Iterator<Item = (&'static str, &Table)> {
    const KINDS: [&str; 3] = ["dependencies", "dev-dependencies", "build-dependencies"];
    let targets = manifest
        .get("target")
        .and_then(Value::as_table)
        .into_iter()
        .flat_map(Table::values);
    let places = std::iter::once(manifest).chain(targets.filter_map(Value::as_table));
    places.flat_map(|place| {
        KINDS
            .into_iter()
            .filter_map(|kind| Some((kind, place.get(kind)?.as_table()?)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(path: &str, text: &str) -> Source {
        Source {
            path: path.into(),
            text: text.into(),
        }
    }

    fn found(rule: fn(&[Source]) -> Vec<Violation>, path: &str, text: &str) -> usize {
        rule(&[source(path, text)]).len()
    }

    #[test]
    fn a_dependency_outside_the_picture_is_found() {
        let shared = "[package]\nname = \"sutura-shared\"\n";
        for stranger in [
            "[dependencies]\nsutura-controller.workspace = true",
            "[dependencies]\nrand.workspace = true",
            "[build-dependencies]\ncc = \"1\"",
            "[dev-dependencies]\nsutura.workspace = true",
            "[target.'cfg(unix)'.dependencies]\nlibc.workspace = true",
        ] {
            assert_eq!(
                found(dependencies, "shared/Cargo.toml", &format!("{shared}{stranger}")),
                1,
                "{stranger}"
            );
        }
        let fine =
            format!("{shared}[dependencies]\nserde.workspace = true\n[dev-dependencies]\nserde_json.workspace = true");
        assert_eq!(found(dependencies, "shared/Cargo.toml", &fine), 0);
        assert_eq!(
            found(dependencies, "extra/Cargo.toml", "[package]\nname = \"sutura-extra\""),
            1
        );
    }

    #[test]
    fn a_version_outside_the_root_is_found() {
        let with = |spec| format!("[package]\nname = \"sutura\"\n[dependencies]\n{spec}");
        assert_eq!(found(versions, "host/Cargo.toml", &with("serde = \"1\"")), 1);
        assert_eq!(
            found(
                versions,
                "host/Cargo.toml",
                &with("serde = { version = \"1\", features = [\"std\"] }")
            ),
            1
        );
        assert_eq!(
            found(
                versions,
                "host/Cargo.toml",
                &with("serde = { workspace = true, features = [\"std\"] }")
            ),
            0
        );
        assert_eq!(
            found(
                versions,
                "controller/firmware/Cargo.toml",
                &with("cortex-m-rt = \"0.7\"")
            ),
            0
        );
    }

    #[test]
    fn a_library_root_that_allows_unsafe_is_found() {
        assert_eq!(
            found(library_roots, "host/src/lib.rs", "//! A.\n// #![forbid(unsafe_code)]\n"),
            1
        );
        assert_eq!(
            found(library_roots, "host/src/lib.rs", "//! A.\n#![forbid(unsafe_code)]\n"),
            0
        );
    }

    #[test]
    fn a_stranger_at_the_top_is_found() {
        assert_eq!(found(top_level, "clippy.toml", ""), 1);
        assert_eq!(found(top_level, "docs/a.md", ""), 1);
        assert_eq!(
            found(top_level, ".ci/run", "") + found(top_level, "host/src/lib.rs", ""),
            0
        );
    }
}
