//! Scenes: from a TOML file to what the controller takes.
//!
//! | module | what it gives |
//! |---|---|
//! | [`source`] | the text, and errors with file and line |
//! | [`file`] | the keys, typed |
//! | [`check`] | allowed ranges, effects and their keys |
//! | [`plan`] | the checked scene |
//! | [`needle`] | needles by name, and what one can sew |
//! | [`suture`] | threads by name |
//! | [`operator`] | the hand's script |
//! | [`skill`] | whose hand it is: how far what it does lies from the script |
//! | [`reach`] | whether the simulated arm can follow it |
//! | [`build`] | the patch and the record for the controller |
//! | [`setting`] | a solver by name, or by the time it may take |
//! | [`draft`] | the text with other values: a run's copy, a suggestion |

pub mod build;
pub mod check;
pub mod draft;
pub mod file;
pub mod needle;
pub mod operator;
pub mod plan;
pub mod reach;
pub mod setting;
pub mod skill;
pub mod source;
pub mod suture;

use std::path::{Path, PathBuf};

pub use draft::Draft;
pub use plan::Plan;
pub use source::{Error, Source};

/// The scene that `sutura run` takes where none is named: one stitch in a generated forearm.
pub const BUILT_IN: &str = include_str!("../../scenes/stitch.toml");

/// A scene file, or the built-in scene, checked; its mesh paths are made relative to its folder.
///
/// # Errors
/// The file cannot be read, or something in it is wrong: one line with file, line, key, value and what would be right.
pub fn load(path: Option<&Path>) -> Result<Plan, Error> {
    Draft::open(path, &[])?.plan()
}

/// Gives tissues other meshes: `--mesh TISSUE=PATH`. Units and transform stay as the scene has them.
///
/// # Errors
/// The scene has no such tissue.
pub fn replace_meshes(plan: &mut Plan, meshes: &[(String, PathBuf)]) -> Result<(), Error> {
    let known = plan
        .tissues
        .iter()
        .map(|tissue| tissue.name.as_str())
        .collect::<Vec<_>>()
        .join(", ");
    for (name, path) in meshes {
        let Some(tissue) = plan.tissues.iter_mut().find(|tissue| tissue.name == *name) else {
            return Err(Error::NoTissue {
                tissue: name.clone(),
                path: path.clone(),
                known,
            });
        };
        match &mut tissue.mesh {
            Some(mesh) => mesh.path.clone_from(path),
            None => {
                tissue.mesh = Some(file::Mesh {
                    path: path.clone(),
                    units: Default::default(),
                    transform: None,
                })
            }
        }
    }
    Ok(())
}
