//! The wire between Sutura's host and its controller.
//!
//! - [`effect`]: the table of what a scene may call for.
//! - [`scene`]: what the host uploads: everything the controller needs to know of a scene.
//! - [`message`]: what the two sides say to each other, and the version of it.
//! - [`frame`]: how a message's bytes travel on a line that may lose or change some.
//! - [`codec`]: exact decoding; [`check`]: what a decoded value must hold to.
//! - [`limits`]: every size; [`hash`]: the one hash of uploads, states and the schema.
#![no_std]
#![forbid(unsafe_code)]

pub mod check;
pub mod codec;
pub mod effect;
pub mod frame;
pub mod hash;
pub mod limits;
pub mod message;
pub mod scene;
