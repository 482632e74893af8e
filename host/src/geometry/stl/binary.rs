//! The binary form.

use std::path::Path;
use std::{fs, iter};

use super::{Fault, Place, Soup, StlError, Warning};
use crate::geometry::Vec3;
use crate::geometry::mesh::Mesh;

const HEADER: usize = 84;
const COUNT_AT: usize = 80;
const TRIANGLE: usize = 50;

/// Whether the length is exactly that of a binary file with the triangles its header counts.
pub(super) fn has_counted_length(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|n| n > 0 && bytes.len() as u64 == length(n))
}

/// Reads triangles as far as the count goes; never allocates more than the bytes at hand justify.
pub(super) fn parse(bytes: &[u8]) -> Result<Soup, Fault> {
    let len = bytes.len();
    if len == 0 {
        return Err(Fault::Empty);
    }
    let Some(counted) = count(bytes) else {
        return Err(Fault::Header { len });
    };
    let body = &bytes[HEADER..];
    let found = body.len() / TRIANGLE;
    let mut warnings = Vec::new();
    // Writers that stream leave 0 or -1 in the count when they are never told to go back and fill it in.
    let filled_in = counted != 0 && counted != u32::MAX;
    let take = if !filled_in && found > 0 && body.len().is_multiple_of(TRIANGLE) {
        warnings.push(Warning::CountNotFilledIn { counted, found });
        found
    } else if counted as usize > found {
        return Err(Fault::CutShort {
            len,
            found,
            counted,
            whole: length(counted),
        });
    } else {
        counted as usize
    };
    let end = HEADER + take * TRIANGLE;
    if len > end {
        warnings.push(Warning::Trailing {
            offset: end,
            bytes: len - end,
        });
    }
    let (mut corners, mut bad, mut first) = (Vec::with_capacity(take), 0, 0);
    for (index, triangle) in body.chunks_exact(TRIANGLE).take(take).enumerate() {
        let points = triangle_corners(triangle);
        if points.iter().flatten().all(|c| c.is_finite()) {
            corners.push(points);
        } else {
            first = if bad == 0 { HEADER + index * TRIANGLE } else { first };
            bad += 1;
        }
    }
    if bad > 0 {
        warnings.push(Warning::NonFinite {
            count: bad,
            first: Place::Byte(first),
        });
    }
    Ok(Soup {
        corners,
        solids: 1,
        warnings,
        end: Place::Byte(len),
    })
}

/// The bytes of a binary STL file of a surface, rounded to single precision.
///
/// The header does not begin with `solid`, which some programs take for text.
#[must_use]
pub fn encode(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = b"Sutura binary STL".to_vec();
    bytes.resize(COUNT_AT, 0);
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for [a, b, c] in mesh.corners() {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        for component in [normal, a, b, c].iter().flatten() {
            bytes.extend((*component as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

/// Writes a surface as a binary STL file.
///
/// # Errors
/// The file system refuses.
pub fn write(path: &Path, mesh: &Mesh) -> Result<(), StlError> {
    fs::write(path, encode(mesh)).map_err(|source| StlError::Io {
        path: path.into(),
        source,
    })
}

fn count(bytes: &[u8]) -> Option<u32> {
    bytes
        .get(COUNT_AT..)?
        .first_chunk()
        .map(|&four| u32::from_le_bytes(four))
}

fn length(count: u32) -> u64 {
    HEADER as u64 + u64::from(count) * TRIANGLE as u64
}

/// The corners of a triangle's 50 bytes; the normal before and the two bytes behind them are ignored.
fn triangle_corners(bytes: &[u8]) -> [Vec3; 3] {
    let mut numbers = bytes
        .chunks_exact(4)
        .skip(3)
        .filter_map(|b| b.first_chunk())
        .map(|&b| f64::from(f32::from_le_bytes(b)));
    let mut next = || numbers.next().unwrap_or(f64::NAN);
    [(); 3].map(|()| Vec3::from_iterator(iter::repeat_with(&mut next).take(3)))
}
