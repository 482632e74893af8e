//! The files of a run, each written whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::log::{Log, Puncture, length};
use super::watch::Motion;
use crate::plot;

/// The copy of the scene as it ran.
pub(crate) const SCENE: &str = "scene.toml";
/// Force and place of the hand by tick.
pub(crate) const FORCE: &str = "force.csv";
/// The tool's orientation and the thread by tick.
pub(crate) const MOTION: &str = "motion.csv";
/// The wound along its length by time.
pub(crate) const WOUND: &str = "wound.csv";
/// One line a puncture.
pub(crate) const PUNCTURES: &str = "punctures.csv";

/// Makes the folder of a run, so that a run does not end in vain.
///
/// # Errors
/// The file system refuses.
pub fn folder(out: &Path) -> Result<(), Error> {
    let path = out.to_owned();
    std::fs::create_dir_all(out).map_err(|cause| match out.exists() {
        true => Error::NotFolder { path },
        false => Error::File { path, cause },
    })
}

/// Refuses a folder in which the run's `copy` of its scene would replace that scene by something else.
///
/// # Errors
/// [`Error::Scene`].
pub fn spare(out: &Path, scene: Option<&Path>, copy: &str) -> Result<(), Error> {
    let place = out.join(SCENE);
    let is_scene = |scene: &Path| matches!((scene.canonicalize(), place.canonicalize()), (Ok(a), Ok(b)) if a == b);
    let same = || std::fs::read_to_string(&place).is_ok_and(|text| text == copy);
    if scene.is_some_and(is_scene) && !same() {
        return Err(Error::Scene { path: place });
    }
    Ok(())
}

/// Writes `scene.toml`, `force.csv`, `motion.csv`, `wound.csv`, `punctures.csv` and `force.png`; with a wound `wound.png`.
///
/// # Errors
/// The file system refuses, or the picture cannot be drawn.
pub fn write(out: &Path, copy: &str, title: &str, log: &Log) -> Result<(), Error> {
    let file = |path: &Path, done: io::Result<()>| {
        done.map_err(|cause| Error::File {
            path: path.to_owned(),
            cause,
        })
    };
    whole(&out.join(SCENE), |path| file(path, std::fs::write(path, copy)))?;
    for (name, table) in [
        (FORCE, force as Table),
        (MOTION, motion),
        (WOUND, wound),
        (PUNCTURES, punctures),
    ] {
        whole(&out.join(name), |path| {
            let filled = std::fs::File::create(path).map(BufWriter::new).and_then(|mut file| {
                table(&mut file, log)?;
                file.flush()
            });
            file(path, filled)
        })?;
    }
    whole(&out.join("force.png"), |path| {
        plot::force(path, title, log).map_err(Error::Plot)
    })?;
    if log.wound.all().iter().all(|profile| profile.rows.is_empty()) {
        return Ok(());
    }
    whole(&out.join("wound.png"), |path| {
        plot::wound::draw(path, log).map_err(Error::Plot)
    })
}

type Table = fn(&mut BufWriter<std::fs::File>, &Log) -> io::Result<()>;

fn force(file: &mut BufWriter<std::fs::File>, log: &Log) -> io::Result<()> {
    writeln!(file, "tick,stage,x_m,y_m,z_m,simulated_n,rendered_n,thread_n,gap_mm")?;
    for tick in &log.ticks {
        let [x, y, z] = tick.position_m;
        let (simulated, rendered) = (length(tick.simulated_n), length(tick.rendered_n));
        let (stage, thread, gap) = (tick.stage.name(), tick.thread_n, tick.gap_m[0] * 1e3);
        writeln!(
            file,
            "{},{stage},{x},{y},{z},{simulated},{rendered},{thread},{gap}",
            tick.tick
        )?;
    }
    Ok(())
}

fn motion(file: &mut BufWriter<std::fs::File>, log: &Log) -> io::Result<()> {
    write!(
        file,
        "tick,qw,qx,qy,qz,side_n,stitch_n,stitch_m,stitch,torn_mm,step_mm,closing_n"
    )?;
    for stitch in 2..=log.stitches {
        write!(file, ",gap_{stitch}_mm,step_{stitch}_mm,closing_{stitch}_n")?;
    }
    writeln!(file)?;
    for (tick, motion) in log.ticks.iter().zip(&log.motion) {
        let [w, x, y, z] = motion.quaternion;
        let Motion {
            side_n,
            stitch_n,
            stitch_m,
            step_m,
            closing_n,
            torn_m,
            ..
        } = motion;
        let (number, stitch) = (tick.tick, tick.stitch);
        write!(
            file,
            "{number},{w},{x},{y},{z},{side_n},{stitch_n},{stitch_m},{stitch},{}",
            torn_m * 1e3
        )?;
        let stitches = tick
            .gap_m
            .iter()
            .zip(step_m)
            .zip(closing_n)
            .take(log.stitches)
            .enumerate();
        for (stitch, ((gap_m, step_m), closing_n)) in stitches {
            if stitch > 0 {
                // That at the first stitch is force.csv's.
                write!(file, ",{}", gap_m * 1e3)?;
            }
            write!(file, ",{},{closing_n}", step_m * 1e3)?;
        }
        writeln!(file)?;
    }
    Ok(())
}

fn wound(file: &mut BufWriter<std::fs::File>, log: &Log) -> io::Result<()> {
    log.wound.table(file)
}

fn punctures(file: &mut BufWriter<std::fs::File>, log: &Log) -> io::Result<()> {
    writeln!(file, "tick,stitch,site,x_m,y_m,z_m,force_n,f0_n,depth_mm")?;
    for (puncture, [x, y, z]) in log.punctures().iter().zip(&log.places) {
        let Puncture {
            site,
            stitch,
            tick,
            force_n,
            f0_n,
            depth_mm,
        } = puncture;
        writeln!(file, "{tick},{stitch},{site},{x},{y},{z},{force_n},{f0_n},{depth_mm}")?;
    }
    Ok(())
}

/// Lets `write` fill a file beside `path` and then puts it in `path`'s place.
pub(crate) fn whole(path: &Path, write: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    let fault = |cause| Error::File {
        path: path.to_owned(),
        cause,
    };
    let folder = path.parent().unwrap_or(Path::new("."));
    let suffix = path
        .extension()
        .map(|extension| format!(".{}", extension.display()))
        .unwrap_or_default();
    let mut builder = tempfile::Builder::new();
    builder.prefix(".sutura-").suffix(&suffix);
    // A temporary file is its owner's alone; what stays is as readable as any file, less the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let beside = builder.tempfile_in(folder).map_err(fault)?;
    write(beside.path())?;
    beside.persist(path).map_err(|error| fault(error.error))?;
    Ok(())
}

/// Why a file of a run is not there.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file system refuses.
    #[error("{}: {cause}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// Something else than a folder is there.
    #[error("{}: a file, where a folder for the results is to be; another --out is right", path.display())]
    NotFolder {
        /// Where.
        path: PathBuf,
    },
    /// The scene lies where its copy is to be.
    #[error("{}: the scene itself lies where the copy of it as it runs is to be; another --out is right", path.display())]
    Scene {
        /// Where.
        path: PathBuf,
    },
    /// The picture cannot be drawn.
    #[error("the picture cannot be drawn: {0}")]
    Plot(plot::Error),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_finished_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("force.csv");
        let result = whole(&path, |beside| {
            std::fs::write(beside, "half").unwrap();
            Err(Error::File {
                path: beside.to_owned(),
                cause: io::Error::other("full"),
            })
        });
        assert!(result.is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_file_in_place_of_the_folder_is_said_to_be_one() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let line = folder(file.path()).unwrap_err().to_string();
        assert!(line.contains("where a folder"), "{line}");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_permissions_of_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let [ours, plain] = ["force.csv", "plain"].map(|name| folder.path().join(name));
        std::fs::write(&plain, "").unwrap();
        assert!(whole(&ours, |_| Ok(())).is_ok());
        let [ours, plain] = [ours, plain].map(|path| std::fs::metadata(path).unwrap().permissions().mode());
        assert_eq!(ours, plain);
    }
}
