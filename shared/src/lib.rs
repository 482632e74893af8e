//! The wire between Sutura's host and its controller.
//!
//! - [`scene`]: what the host uploads: everything the controller needs to know of a scene.
#![no_std]
#![forbid(unsafe_code)]

pub mod scene;
