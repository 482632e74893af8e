//! The soft tissue: from voxels to springs, and its outer surface.

mod assembly;
mod surface;
mod wound;

pub use assembly::{Error, Material, assemble, springs};
pub use surface::{height, kernel_at, lifted, surface};
pub use wound::{Faces, Gap, PAIRS_MAX, faces, gap};
