//! The scenarios of Sutura's integration tests against a controller on a real serial port.
#![forbid(unsafe_code)]
