//! Surfaces from STL files, binary or text, and back.
//!
//! An own reader, because a user must learn what a file lost on the way in. The `stl_io` crate reads only the first solid of a file and says nothing,
//! hands NaN corners and the empty mesh of a zero count through, and refuses a byte order mark, upper-case keywords, leading blank lines and a missing
//! `endsolid`. This one reads every solid as one surface, leaves out what cannot be a triangle and says so, and refuses in one line, with byte offset or
//! line number, a file that is cut short or no STL at all.
//!
//! Binary: 80 bytes of anything, a little-endian `u32` count, then 50 bytes a triangle (normal, three corners as `f32`, two spare bytes).
//! Stated normals are ignored; the order of the corners says what is outside.

mod ascii;
mod binary;

use std::path::{Path, PathBuf};
use std::{fmt, fs, io};

use super::Vec3;
use super::mesh::{Flaw, Mesh};

pub use binary::{encode, write};

/// A surface from a file, and what the file made us say about it.
#[derive(Clone, Debug)]
pub struct Reading {
    /// All solids of the file as one surface [file units].
    pub mesh: Mesh,
    /// How many solids the file had; a binary file has one.
    pub solids: usize,
    /// What was wrong and what was left out.
    pub warnings: Vec<Warning>,
}

/// Something wrong with a file that could be read all the same.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// Triangles with a coordinate that is no finite number, left out.
    NonFinite {
        /// How many.
        count: usize,
        /// Where the first stands.
        first: Place,
    },
    /// The count of a binary file was never filled in, though triangles follow.
    CountNotFilledIn {
        /// What stands in the header.
        counted: u32,
        /// Whole triangles that follow, all of them read.
        found: usize,
    },
    /// Bytes behind the last counted triangle, left out.
    Trailing {
        /// Where they begin.
        offset: usize,
        /// How many.
        bytes: usize,
    },
    /// A byte order mark before a text file, left out.
    ByteOrderMark,
    /// Facets of a text file with another number of corners than three: the first three were kept, facets with fewer left out.
    Corners {
        /// How many facets.
        count: usize,
        /// Line of the first `endfacet`.
        line: usize,
    },
    /// Lines that begin with no keyword of the format, left out.
    UnknownLines {
        /// How many.
        count: usize,
        /// Number of the first.
        line: usize,
        /// What the first begins with.
        word: String,
    },
    /// Solids that the next solid or the end of the file closes; the file may be cut short.
    NoEndsolid {
        /// How many.
        count: usize,
        /// Line where the first missing `endsolid` should stand.
        line: usize,
    },
    /// What is wrong with the surface itself.
    Surface(Flaw),
}

/// Where in a file something stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Bytes from the beginning of a binary file.
    Byte(usize),
    /// Line of a text file, from 1.
    Line(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Line(line) => write!(f, "line {line}"),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite { count, first } => {
                write!(
                    f,
                    "{first}: triangle with a coordinate that is not finite, left out ({count} such)"
                )
            }
            Self::CountNotFilledIn { counted, found } => {
                write!(
                    f,
                    "byte 80: the header counts {counted} triangles, {found} whole ones follow and were taken"
                )
            }
            Self::Trailing { offset, bytes } => {
                write!(
                    f,
                    "byte {offset}: {bytes} bytes behind the last counted triangle, left out"
                )
            }
            Self::ByteOrderMark => write!(f, "byte 0: byte order mark, left out"),
            Self::Corners { count, line } => {
                write!(
                    f,
                    "line {line}: facet of more or fewer than three corners, cut to three or left out ({count} such)"
                )
            }
            Self::UnknownLines { count, line, word } => {
                write!(
                    f,
                    "line {line}: `{word}` is no STL keyword, line left out ({count} such)"
                )
            }
            Self::NoEndsolid { count, line } => {
                write!(
                    f,
                    "line {line}: solid without `endsolid`, the file may be cut short ({count} such)"
                )
            }
            Self::Surface(flaw) => flaw.fmt(f),
        }
    }
}

/// Why bytes are no usable STL file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// Nothing there.
    #[error("byte 0: the file is empty; an STL file begins with `solid` or has at least 84 bytes")]
    Empty,
    /// Ends inside the header of a binary file.
    #[error(
        "byte {len}: the file ends inside the 84-byte header of a binary STL file, and does not begin with `solid`"
    )]
    Header {
        /// Bytes of the file.
        len: usize,
    },
    /// Fewer bytes than the header counts triangles.
    #[error(
        "byte {len}: the file ends after {found} of the {counted} triangles that its header counts at byte 80: cut short ({whole} bytes would be whole), or no STL file"
    )]
    CutShort {
        /// Bytes of the file.
        len: usize,
        /// Whole triangles in the file.
        found: usize,
        /// Triangles that the header counts.
        counted: u32,
        /// Bytes of a file of that count.
        whole: u64,
    },
    /// The end of a text file inside a facet.
    #[error("line {line}: the file ends inside a facet: cut short")]
    EndInFacet {
        /// The last line.
        line: usize,
    },
    /// A line of a text file that has no sense where it stands.
    #[error("line {line}: `{word}` {expected}")]
    Misplaced {
        /// Its number.
        line: usize,
        /// What it begins with.
        word: String,
        /// What would be right.
        expected: &'static str,
    },
    /// Nothing to build a surface from.
    #[error("{place}: the file ends without one usable triangle")]
    NoTriangle {
        /// Where the file ends.
        place: Place,
    },
}

/// Why an STL file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum StlError {
    /// The file system refused.
    #[error("{}: {source}; the path of an STL file is needed here", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The content is no usable STL.
    #[error("{}: {fault}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: Fault,
    },
}

/// Loose triangles as a format's reader hands them over.
struct Soup {
    corners: Vec<[Vec3; 3]>,
    solids: usize,
    warnings: Vec<Warning>,
    end: Place,
}

/// Reads an STL file.
///
/// # Errors
/// The file cannot be read, or its content is no usable STL ([`Fault`]).
pub fn read(path: &Path) -> Result<Reading, StlError> {
    let bytes = fs::read(path).map_err(|source| StlError::Io {
        path: path.into(),
        source,
    })?;
    parse(&bytes).map_err(|fault| StlError::Content {
        path: path.into(),
        fault,
    })
}

/// Reads the bytes of an STL file.
///
/// # Errors
/// The bytes are cut short, hold no triangle, or are no STL.
pub fn parse(bytes: &[u8]) -> Result<Reading, Fault> {
    let soup = if is_text(bytes) {
        ascii::parse(bytes)?
    } else {
        binary::parse(bytes)?
    };
    let (mesh, flaws) = Mesh::from_corners(&soup.corners);
    if mesh.triangles.is_empty() {
        return Err(Fault::NoTriangle { place: soup.end });
    }
    let flaws = flaws.into_iter().chain(mesh.survey()).map(Warning::Surface);
    let warnings = soup.warnings.into_iter().chain(flaws).collect();
    Ok(Reading {
        mesh,
        solids: soup.solids,
        warnings,
    })
}

/// Binary headers may begin with `solid` as well: a file whose length fits its count is binary, and so is one with bytes that no text has.
fn is_text(bytes: &[u8]) -> bool {
    const LOOK: usize = 1024;
    let head = &bytes[..bytes.len().min(LOOK)];
    let word = head
        .strip_prefix(ascii::BYTE_ORDER_MARK)
        .unwrap_or(head)
        .trim_ascii_start();
    let says_solid = word.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    let control = |&b: &u8| b < b' ' && !b.is_ascii_whitespace();
    says_solid && !binary::has_counted_length(bytes) && !head.iter().any(control)
}

#[cfg(test)]
mod tests {
    use super::super::mesh::tests::cube;
    use super::*;

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

    fn said(bytes: &[u8]) -> Vec<String> {
        parse(bytes)
            .unwrap()
            .warnings
            .iter()
            .map(ToString::to_string)
            .filter(|w| !w.starts_with("not closed"))
            .collect()
    }

    fn refused(bytes: &[u8]) -> String {
        parse(bytes).unwrap_err().to_string()
    }

    #[test]
    fn binary_files_come_back_as_written() {
        let cube = cube(Vec3::new(0.5, -1.0, 2.0));
        let reading = parse(&encode(&cube)).unwrap();
        assert_eq!((reading.solids, reading.warnings.len()), (1, 0));
        assert!(reading.mesh.corners().eq(cube.corners()));
    }

    #[test]
    fn text_is_read_whatever_its_case_line_ends_and_number_of_solids() {
        let two = format!(
            "\n\n  solid one\n{FACET}endsolid one\nsolid two\n{}endsolid",
            FACET.replace("0 1 0", "0 2 0")
        );
        for text in [
            two.clone(),
            two.to_uppercase(),
            two.replace('\n', "\r\n"),
            two.replace('\n', "\r"),
        ] {
            let reading = parse(text.as_bytes()).unwrap();
            assert_eq!((reading.solids, reading.mesh.triangles.len()), (2, 2));
            assert!(said(text.as_bytes()).is_empty());
        }
    }

    #[test]
    fn a_binary_header_may_say_solid() {
        let mut bytes = encode(&cube(Vec3::zeros()));
        bytes[..6].copy_from_slice(b"solid ");
        assert_eq!(parse(&bytes).unwrap().mesh.triangles.len(), 12);
        // Also where the count does not fit: no text holds zero bytes.
        bytes.extend([0; 7]);
        assert_eq!(
            said(&bytes),
            ["byte 684: 7 bytes behind the last counted triangle, left out"]
        );
    }

    #[test]
    fn what_is_left_out_of_text_is_named_by_line() {
        let bad = "facet normal 0 0 1\nouter loop\nvertex 0 0 nan\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
        let text = format!("\u{feff}solid\n{FACET}color 1 2 3\n{bad}{bad}");
        let expected = [
            "byte 0: byte order mark, left out",
            "line 16: triangle with a coordinate that is not finite, left out (2 such)",
            "line 9: `color` is no STL keyword, line left out (1 such)",
            "line 23: solid without `endsolid`, the file may be cut short (1 such)",
        ];
        assert_eq!(said(text.as_bytes()), expected);
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_line_or_byte() {
        let solid = format!("solid\n{FACET}");
        assert_eq!(
            refused(b""),
            "byte 0: the file is empty; an STL file begins with `solid` or has at least 84 bytes"
        );
        for (text, says) in [
            (format!("{solid}facet"), "line 9: the file ends inside a facet"),
            (format!("{solid}vertex 1 2 3"), "line 9: `vertex` outside of a facet"),
            (solid.replace("1 0 0", "1 O 0"), "line 5: `vertex` needs three numbers"),
            (solid.replace("endfacet\n", "facet\n"), "line 8: `facet` inside a facet"),
            (
                "solid a story\nof no shape".into(),
                "line 2: the file ends without one usable triangle",
            ),
        ] {
            let message = refused(text.as_bytes());
            assert!(message.starts_with(says), "{message}");
        }
    }

    /// Every beginning of a file is either read or refused, never a panic, and a binary one that is cut never read.
    #[test]
    fn every_beginning_of_a_file_is_read_or_refused() {
        let binary = encode(&cube(Vec3::zeros()));
        assert!((0..binary.len()).all(|len| parse(&binary[..len]).is_err()));
        let text = format!("solid\n{FACET}endsolid");
        for len in 0..text.len() {
            // What ends behind a whole facet has lost nothing.
            assert_eq!(parse(&text.as_bytes()[..len]).is_ok(), len + 9 >= text.len(), "{len}");
        }
    }
}
