//! The wire between Sutura's host and its controller.
//!
//! - [`effect`]: the table of what a scene may call for.
//! - [`scene`]: what the host uploads: everything the controller needs to know of a scene.
#![no_std]
#![forbid(unsafe_code)]

pub mod effect;
pub mod scene;
