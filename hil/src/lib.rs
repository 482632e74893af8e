//! Sutura's scenarios against a controller on a real serial port.
//!
//! The port is named by the environment: `SUTURA_HIL_PORT=/dev/ttyUSB0 cargo test -p sutura-hil -- --nocapture`, and
//! `SUTURA_HIL_BAUD` where its speed is not 921,600 baud.
#![forbid(unsafe_code)]

use std::env;
use std::time::Duration;

pub use serialport::SerialPort;
pub use sutura_tests::{remote, skipped};

/// Names the port.
pub const PORT: &str = "SUTURA_HIL_PORT";
/// Names its speed [baud].
pub const BAUD: &str = "SUTURA_HIL_BAUD";
/// Speed where none is named [baud].
const DEFAULT_BAUD: u32 = 921_600;
/// How long a read waits for the first byte.
const TIMEOUT: Duration = Duration::from_millis(5);

/// Opens the port that the environment names; `None` after saying that `name` is skipped without one.
///
/// # Errors
/// One line: the port cannot be opened, or its speed is no number.
pub fn port(name: &str) -> Result<Option<Box<dyn SerialPort>>, String> {
    let Ok(path) = env::var(PORT) else {
        skipped(name, &format!("{PORT}, the serial port of a controller"));
        return Ok(None);
    };
    let baud = env::var(BAUD).map_or(Ok(DEFAULT_BAUD), |text| {
        text.parse()
            .map_err(|_| format!("{BAUD} = {text}: a number of baud is needed"))
    })?;
    serialport::new(&path, baud)
        .timeout(TIMEOUT)
        .open()
        .map(Some)
        .map_err(|error| format!("{PORT} = {path}: {error}"))
}
