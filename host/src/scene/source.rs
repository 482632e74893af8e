//! The text of a scene file, and errors that point into it.

use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use toml::Spanned;

impl Source {
    /// Reads a scene file.
    ///
    /// # Errors
    /// There is no such file, or it is no UTF-8 text.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|cause| Error::Read {
            path: path.to_owned(),
            cause,
        })?;
        Ok(Self {
            name: path.display().to_string(),
            text,
        })
    }

    /// The text as a value.
    ///
    /// # Errors
    /// No TOML, an unknown or a missing key, a value of another type: with line and key.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, Error> {
        toml::from_str(&self.text).map_err(|error| {
            let at = error.span().unwrap_or(0..0);
            let what = error.message().replace('\n', "; ");
            match self.key_before(&at) {
                Some(key) => self.fault(at, format!("{key}: {what}")),
                None => self.fault(at, what),
            }
        })
    }

    /// A number of `key`, if it lies in `allowed`, ends included.
    ///
    /// # Errors
    /// It does not: with line, key, value and allowed range.
    pub fn number(&self, key: &str, value: &Spanned<f64>, allowed: [f64; 2]) -> Result<f64, Error> {
        let [low, high] = allowed;
        let number = *value.get_ref();
        if (low..=high).contains(&number) {
            Ok(number)
        } else {
            Err(self.fault(
                value.span(),
                format!("{key} = {number} is out of range: {low} to {high}"),
            ))
        }
    }

    /// The error `what` about the text at `at`.
    pub fn fault(&self, at: Range<usize>, what: impl Display) -> Error {
        Error::Line {
            file: self.name.clone(),
            line: self.line(at.start),
            what: what.to_string(),
        }
    }

    /// Number of the line of a byte, from 1.
    fn line(&self, at: usize) -> usize {
        self.text.bytes().take(at).filter(|&byte| byte == b'\n').count() + 1
    }

    /// The key in front of a value, where the value stands on the key's line.
    fn key_before(&self, at: &Range<usize>) -> Option<&str> {
        let before = self.text.get(..at.start)?;
        let line = before.rsplit('\n').next()?;
        let (key, _) = line.split_once('=')?;
        Some(key.trim())
    }
}

/// A scene file.
#[derive(Clone, Debug)]
pub struct Source {
    /// What errors call it: the path as the user gave it.
    pub name: String,
    /// What it says.
    pub text: String,
}

/// What is wrong with a scene; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be read.
    #[error("{}: {cause}; a scene file is needed, and `sutura scene --print-default` prints one to start from", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// Something in the file is wrong.
    #[error("{file}:{line}: {what}")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// Key, value and what would be right.
        what: String,
    },
    /// `--operator` where there is nothing to sew.
    #[error(
        "--operator {skill}: {file} has no stitch to sew; a scene with effect puncture and [operator.sew] is right"
    )]
    NoStitch {
        /// The skill given.
        skill: &'static str,
        /// The scene.
        file: String,
    },
    /// `--mesh` names a tissue that the scene has not.
    #[error("--mesh {tissue}={}: the scene has no tissue `{tissue}`, it has {known}", path.display())]
    NoTissue {
        /// The name given.
        tissue: String,
        /// The file given.
        path: PathBuf,
        /// The scene's tissues.
        known: String,
    },
}
