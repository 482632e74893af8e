//! A scene as it is uploaded, in a file: for a child process that is to tick it and nothing else.
//!
//! Four bytes with the length of `postcard(Scene)`, little-endian, that, and one byte a cell.

use std::path::Path;

use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::link::Plant;
use sutura_controller::tick::Memory;
use sutura_shared::codec;
use sutura_shared::limits::SCENE_MAX;
use sutura_shared::scene::Scene;

use super::Error;
use crate::run;
use crate::run::embedded::PcRig;

/// Writes a scene and its cells.
///
/// # Errors
/// The scene is too long for an upload, or the file system refuses.
pub fn write(path: &Path, scene: &Scene, cells: &[u8]) -> Result<(), Error> {
    let mut buffer = [0; SCENE_MAX];
    let scene = codec::encode(scene, &mut buffer).ok_or(Error::TooLong { most: SCENE_MAX })?;
    let bytes = [&(scene.len() as u32).to_le_bytes(), scene, cells].concat();
    std::fs::write(path, bytes).map_err(|cause| file(path, cause))
}

/// Ticks the scene of a file some times; gives the hash of all that happened.
///
/// # Errors
/// There is no such scene, or the controller refuses it.
pub fn ticks(path: &Path, count: u32, level: Level) -> Result<u64, Error> {
    let bytes = std::fs::read(path).map_err(|cause| file(path, cause))?;
    let (scene, cells) = read(path, &bytes)?;
    let mut memory: Box<Memory<PC_NODES>> = bytemuck::zeroed_box();
    let mut rig = PcRig::new(&mut memory, level);
    rig.load(&scene, cells).map_err(|error| Error::Refused(error.0))?;
    for _ in 0..count {
        rig.tick();
    }
    Ok(rig.state_hash())
}

fn read<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Scene, &'a [u8]), Error> {
    let none = |what: String| Error::Upload {
        path: path.to_owned(),
        what,
    };
    let parts = bytes.split_first_chunk().and_then(|(length, rest)| {
        let length = u32::from_le_bytes(*length) as usize;
        rest.split_at_checked(length)
    });
    let (scene, cells) = parts.ok_or_else(|| none("it ends too early".to_owned()))?;
    let scene: Scene = codec::decode(scene).map_err(|error| none(format!("{error:?}")))?;
    scene
        .validate_cells(cells)
        .map_err(|error| none(format!("{}: {} is needed", error.field, error.expected)))?;
    Ok((scene, cells))
}

fn file(path: &Path, cause: std::io::Error) -> Error {
    let path = path.to_owned();
    run::files::Error::File { path, cause }.into()
}
