//! The host: geometry, scenes, the link to a controller, recorder and studies.
#![forbid(unsafe_code)]

pub mod geometry;
pub mod link;
pub mod plot;
pub mod run;
pub mod scene;
pub mod score;
pub mod study;
pub mod voxelize;
