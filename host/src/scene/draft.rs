//! The text of a scene with what was asked for beside it: read once, and written anew with some of its values changed.
//!
//! A run leaves a copy of its scene as it ran, and a refusal suggests values only after a scene with them has been tried. Both change single
//! values in the text and leave the rest, comments included, as the user wrote it.

use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use sutura_shared::scene::{Effect, Solver};
use toml::Spanned;

use super::file::File;
use super::skill::Person;
use super::source::{Error, Source};
use super::{BUILT_IN, Plan, check, replace_meshes};

/// A scene file, or the built-in scene, and other meshes for its tissues.
#[derive(Clone, Debug)]
pub struct Draft {
    source: Source,
    /// What mesh paths in the text are relative to.
    folder: PathBuf,
    meshes: Vec<(String, PathBuf)>,
}

/// Another value for a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// `solver`
    Solver(Solver),
    /// `patch.size_mm` [mm]
    Size([f64; 3]),
    /// `patch.pitch_mm` [mm]
    Pitch(f64),
    /// `contact.kernel_mm` [mm]
    Kernel(f64),
    /// `[skill]`
    Person(Person),
}

/// A key that the scene as a whole may be refused for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// `solver`
    Solver,
    /// `patch.pitch_mm`
    Pitch,
}

impl Draft {
    /// Reads a scene file, or takes the built-in scene; `meshes` are `--mesh TISSUE=PATH`.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub fn open(path: Option<&Path>, meshes: &[(String, PathBuf)]) -> Result<Self, Error> {
        let source = match path {
            Some(path) => Source::read(path)?,
            None => Source {
                name: "built-in scene".to_owned(),
                text: BUILT_IN.to_owned(),
            },
        };
        Ok(Self {
            source,
            folder: path.and_then(Path::parent).unwrap_or(Path::new("")).to_owned(),
            meshes: meshes.to_vec(),
        })
    }

    /// The checked scene; its mesh paths are relative to the working directory, or absolute.
    ///
    /// # Errors
    /// Something in the file is wrong, or it has no such tissue: one line with file, line, key, value and what would be right.
    pub fn plan(&self) -> Result<Plan, Error> {
        self.plan_with(&[])
    }

    /// The same with some effects more, their keys at their defaults.
    ///
    /// # Errors
    /// Likewise, and the rest of the scene may not allow these effects.
    pub fn plan_with(&self, more: &[Effect]) -> Result<Plan, Error> {
        let mut file: File = self.source.parse()?;
        for name in more.iter().map(|effect| effect.name()) {
            if file.effects.iter().all(|known| known.get_ref() != name) {
                file.effects.push(Spanned::new(0..0, name.to_owned()));
            }
        }
        let mut plan = check::check(&self.source, &file)?;
        for mesh in plan.tissues.iter_mut().filter_map(|tissue| tissue.mesh.as_mut()) {
            mesh.path = self.folder.join(&mesh.path);
        }
        replace_meshes(&mut plan, &self.meshes)?;
        Ok(plan)
    }

    /// The error `what` about a key, with its line.
    pub fn fault(&self, key: Key, what: impl Display) -> Error {
        let at = self.source.parse().map(|keys: Keys| match key {
            Key::Solver => keys.solver.span(),
            Key::Pitch => keys.patch.pitch_mm.span(),
        });
        self.source.fault(at.unwrap_or(0..0), what)
    }

    /// The draft sewn by this person.
    ///
    /// # Errors
    /// [`Error::NoStitch`], or something in the file is wrong.
    pub fn sewn_by(&self, person: Person) -> Result<Self, Error> {
        if self.plan()?.stitch.is_none() {
            return Err(Error::NoStitch {
                skill: person.skill.name,
                file: self.source.name.clone(),
            });
        }
        self.with(&[Change::Person(person)])
    }

    /// The draft with other values.
    ///
    /// # Errors
    /// The text is no scene.
    pub fn with(&self, changes: &[Change]) -> Result<Self, Error> {
        let keys: Keys = self.source.parse()?;
        let end = self.source.text.len()..self.source.text.len();
        let edits = changes.iter().flat_map(|change| match *change {
            Change::Solver(solver) => vec![(keys.solver.span(), string(&solver.to_string()))],
            Change::Size(size) => vec![(keys.patch.size_mm.span(), format!("{size:?}"))],
            Change::Pitch(pitch) => vec![(keys.patch.pitch_mm.span(), format!("{pitch:?}"))],
            Change::Kernel(kernel) => vec![(keys.contact.kernel_mm.span(), format!("{kernel:?}"))],
            Change::Person(Person { skill, seed }) => match &keys.skill {
                Some(keys) => vec![
                    (keys.name.span(), string(skill.name)),
                    (keys.seed.span(), seed.to_string()),
                ],
                None => vec![(
                    end.clone(),
                    format!("\n[skill]\nname = {}\nseed = {seed}\n", string(skill.name)),
                )],
            },
        });
        let mut draft = self.clone();
        draft.source.text = edited(&self.source.text, edits.collect());
        Ok(draft)
    }

    /// The text of the scene as it runs with `solver`, the same from any folder: mesh paths are absolute. `notes` become comments on its top,
    /// and so does a mesh that the scene has no key for. A copy's copy is that copy.
    ///
    /// # Errors
    /// The text is no scene.
    pub fn copy(&self, solver: Solver, notes: &[String]) -> Result<String, Error> {
        let draft = self.with(&[Change::Solver(solver)])?;
        let keys: Keys = draft.source.parse()?;
        let mut edits = Vec::new();
        let mut notes = notes.to_vec();
        for tissue in &keys.tissue {
            let other = self.meshes.iter().rev().find(|(name, _)| *name == tissue.name);
            match (&tissue.mesh, other) {
                (Some(mesh), Some((_, path))) => edits.push((mesh.path.span(), string(&absolute(path)))),
                (Some(mesh), None) => {
                    let path = self.folder.join(mesh.path.get_ref());
                    edits.push((mesh.path.span(), string(&absolute(&path))));
                }
                (None, Some((name, path))) => {
                    notes.push(format!("Run with --mesh {name}={}", absolute(path)));
                }
                (None, None) => {}
            }
        }
        let text = edited(&draft.source.text, edits);
        let lines = notes.iter().map(|note| format!("# {note}\n"));
        let new: String = lines.filter(|line| !text.contains(line)).collect();
        Ok(new + &text)
    }
}

/// Where the values stand that may change.
#[derive(Deserialize)]
struct Keys {
    solver: Spanned<String>,
    patch: Patch,
    contact: Contact,
    tissue: Vec<Tissue>,
    skill: Option<Skill>,
}

#[derive(Deserialize)]
struct Skill {
    name: Spanned<String>,
    seed: Spanned<u32>,
}

#[derive(Deserialize)]
struct Patch {
    size_mm: Spanned<[f64; 3]>,
    pitch_mm: Spanned<f64>,
}

#[derive(Deserialize)]
struct Contact {
    kernel_mm: Spanned<f64>,
}

#[derive(Deserialize)]
struct Tissue {
    name: String,
    mesh: Option<Mesh>,
}

#[derive(Deserialize)]
struct Mesh {
    path: Spanned<PathBuf>,
}

/// The text with other values in some places, which do not overlap.
fn edited(text: &str, mut edits: Vec<(Range<usize>, String)>) -> String {
    edits.sort_by_key(|(at, _)| at.start);
    let mut text = text.to_owned();
    for (at, value) in edits.into_iter().rev() {
        text.replace_range(at, &value);
    }
    text
}

/// A value of TOML.
fn string(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A path that holds from any folder; where the system knows no working directory, as it is.
fn absolute(path: &Path) -> String {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    path.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::plan::Patch;
    use crate::scene::setting::Setting;

    const SOLVER: Solver = Solver::BePcg {
        iterations: 20,
        newton: 2,
    };

    fn built_in() -> Draft {
        Draft::open(None, &[]).unwrap()
    }

    #[test]
    fn changed_values_are_read_back_and_all_else_stays() {
        let changes = [
            Change::Pitch(4.0),
            Change::Kernel(7.0),
            Change::Size([48.0, 32.0, 12.0]),
            Change::Solver(SOLVER),
        ];
        let draft = built_in().with(&changes).unwrap();
        let plan = draft.plan().unwrap();
        let Patch { pitch_mm, size_mm, .. } = plan.patch;
        assert_eq!((size_mm, plan.solver), ([48.0, 32.0, 12.0], Setting::Fixed(SOLVER)));
        assert!((pitch_mm - 4.0).abs() < 1e-12 && (plan.contact.kernel_m - 7e-3).abs() < 1e-9);
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let (before, after) = (lines(BUILT_IN), lines(&draft.source.text));
        let changed = before.iter().zip(&after).filter(|(before, after)| before != after);
        assert_eq!((before.len(), changed.count()), (after.len(), 4));
    }

    #[test]
    fn a_person_is_added_at_the_end_or_takes_anothers_place() {
        let person = |name, seed| Person {
            skill: crate::scene::skill::Skill::named(name).unwrap(),
            seed,
        };
        let first = built_in().sewn_by(person("novice", 7)).unwrap();
        assert_eq!(first.plan().unwrap().person, Some(person("novice", 7)));
        let added = format!("{BUILT_IN}\n[skill]\nname = \"novice\"\nseed = 7\n");
        assert_eq!(first.source.text, added);
        let second = first.sewn_by(person("expert", u32::MAX)).unwrap();
        assert_eq!(second.plan().unwrap().person, Some(person("expert", u32::MAX)));
        assert_eq!(first.source.text.lines().count(), second.source.text.lines().count());
    }

    #[test]
    fn a_copys_copy_is_that_copy() {
        let meshes = [("skin".to_owned(), PathBuf::from("arm.stl"))];
        let draft = Draft::open(None, &meshes).unwrap();
        let copy = draft.copy(SOLVER, &["chosen by a clock".to_owned()]).unwrap();
        assert!(
            copy.starts_with("# chosen by a clock\n# Run with --mesh skin="),
            "{copy}"
        );
        assert!(copy.contains("\nsolver = \"be-pcg:20:2\"\n"));
        let mut again = draft.clone();
        again.source.text.clone_from(&copy);
        assert_eq!(again.copy(SOLVER, &[]).unwrap(), copy);
    }

    /// The scene of a head names its meshes relative to its folder.
    #[test]
    fn a_copy_finds_its_meshes_from_anywhere() {
        let text = BUILT_IN
            .replace("phantom = \"forearm\"\n", "")
            .replace("[patch]\n", "[patch]\nsite_mm = [0, 0, 0]\n")
            .replace(
                "name = \"skin\"\n",
                "name = \"skin\"\nmesh = { path = \"../skin.stl\" }\n",
            )
            .replace("name = \"muscle\"\n", "name = \"muscle\"\nmesh.path = 'muscle.stl'\n")
            .replace(
                "name = \"bone\"\n",
                "name = \"bone\"\nmesh = { units = \"m\", path = \"bone.stl\" }\n",
            );
        let draft = Draft {
            source: Source {
                name: "s.toml".into(),
                text,
            },
            folder: "/scenes".into(),
            meshes: vec![("bone".into(), "/b\"one.stl".into())],
        };
        let copy = Draft {
            source: Source {
                name: "copy.toml".into(),
                text: draft.copy(SOLVER, &[]).unwrap(),
            },
            folder: "/elsewhere".into(),
            meshes: Vec::new(),
        };
        let paths = |draft: &Draft| {
            let tissues = draft.plan().unwrap().tissues.into_iter();
            tissues.map(|tissue| tissue.mesh.unwrap().path).collect::<Vec<_>>()
        };
        let expected = ["/scenes/../skin.stl", "/scenes/muscle.stl", "/b\"one.stl"];
        assert_eq!(paths(&copy), expected.map(PathBuf::from));
        assert_eq!(paths(&draft), paths(&copy));
    }

    #[test]
    fn a_fault_names_its_line() {
        for (key, text) in [(Key::Solver, "solver = "), (Key::Pitch, "pitch_mm = ")] {
            let line = BUILT_IN.lines().position(|line| line.starts_with(text)).unwrap() + 1;
            let error = built_in().fault(key, "no").to_string();
            assert_eq!(error, format!("built-in scene:{line}: no"));
        }
    }
}
