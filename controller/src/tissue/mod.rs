//! The soft tissue: from voxels to springs.

mod assembly;

pub use assembly::{Error, assemble, springs};
