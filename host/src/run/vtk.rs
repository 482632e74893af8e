//! A run as a time series of VTK files: patch, surface, tool, thread and punctures of every frame, and `run.pvd`, which names them all.
//!
//! Lengths are in metres and in the patch frame; points stand where they are at the frame's moment, so a point less its `displacement_m` is
//! where it was at rest. The files of single moments are vtkio's; it knows no collections, so the `.pvd`, a list of files, is written here.

mod pieces;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use sutura_controller::math::TICK_HZ;
use sutura_shared::message::PunctureEvent;
use vtkio::model::{ByteOrder, DataSet, Version, Vtk};

use super::files::{self, Error, whole};
use super::watch::Frame;
use crate::scene::build::Built;
use pieces::Topology;

/// The list of all files.
const LIST: &str = "run.pvd";

/// Where frames go, and how many a second of simulated time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames {
    /// The folder.
    pub folder: PathBuf,
    /// Ticks from frame to frame.
    pub every: u32,
}

/// A series that grows frame by frame in a folder beside its place, and comes into its place as a whole.
#[derive(Debug)]
pub(super) struct Series {
    place: PathBuf,
    /// Dropped with all that is in it, unless the series is finished.
    beside: tempfile::TempDir,
    topology: Topology,
    /// Tick and names of the files of each frame.
    frames: Vec<(u32, Vec<String>)>,
}

impl Series {
    /// An empty series.
    pub(super) fn begin(frames: &Frames, built: &Built) -> Result<Self, Error> {
        let place = frames.folder.clone();
        files::folder(&place)?;
        let beside = tempfile::Builder::new().prefix(".sutura-").tempdir_in(&place);
        Ok(Self {
            beside: beside.map_err(|cause| fault(&place, cause))?,
            place,
            topology: Topology::of(&built.scene, &built.cells),
            frames: Vec::new(),
        })
    }

    /// Adds a frame; `punctures` are all so far.
    pub(super) fn add(&mut self, frame: &Frame, punctures: &[PunctureEvent]) -> Result<(), Error> {
        let topology = &self.topology;
        let parts = [
            ("patch", "vtu", Some(topology.patch(frame))),
            ("surface", "vtp", Some(topology.surface(frame))),
            ("tool", "vtp", Some(topology.tool(frame))),
            ("thread", "vtp", pieces::thread(frame)),
            ("punctures", "vtp", pieces::punctures(frame, punctures)),
        ];
        let mut names = Vec::new();
        for (part, kind, data) in parts {
            let Some(data) = data else { continue };
            let name = format!("{part}_{:05}.{kind}", frame.tick);
            let path = self.beside.path().join(&name);
            save(data, &path).map_err(|cause| fault(&path, cause))?;
            names.push(name);
        }
        self.frames.push((frame.tick, names));
        Ok(())
    }

    /// Puts every file in its place, the list last.
    pub(super) fn finish(self) -> Result<(), Error> {
        for name in self.frames.iter().flat_map(|(_, names)| names) {
            let place = self.place.join(name);
            std::fs::rename(self.beside.path().join(name), &place).map_err(|cause| fault(&place, cause))?;
        }
        let list = self.place.join(LIST);
        whole(&list, |path| {
            std::fs::write(path, self.list()).map_err(|cause| fault(&list, cause))
        })
    }

    /// All files by time [s].
    fn list(&self) -> String {
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n");
        for (tick, names) in &self.frames {
            let time = f64::from(*tick) / f64::from(TICK_HZ);
            for (part, name) in names.iter().enumerate() {
                text += &format!("    <DataSet timestep=\"{time}\" part=\"{part}\" file=\"{name}\"/>\n");
            }
        }
        text + "  </Collection>\n</VTKFile>\n"
    }
}

/// Writes one moment of one part.
fn save(data: DataSet, path: &Path) -> std::io::Result<()> {
    let vtk = Vtk {
        version: Version::Auto,
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data,
    };
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    vtk.write_xml(&mut file).map_err(std::io::Error::other)?;
    file.flush()
}

fn fault(path: &Path, cause: std::io::Error) -> Error {
    Error::File {
        path: path.to_owned(),
        cause,
    }
}
