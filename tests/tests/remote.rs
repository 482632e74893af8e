//! The scenario for a real port, over a stand-in for one: the host's own controller behind a stream of bytes.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use sutura::link::{ChannelTransport, Pace, Transport as _};
use sutura::run::embedded;
use sutura_controller::lanes::Level;
use sutura_tests::remote;

/// A line that is read as a serial port is: what has come, or after some milliseconds a timeout.
struct Line {
    transport: ChannelTransport,
    came: Vec<u8>,
}

impl Read for Line {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.came.is_empty() {
            self.transport.receive(Duration::from_millis(5), &mut self.came)?;
        }
        if self.came.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        let length = self.came.len().min(into.len());
        let read = self.came.drain(..length);
        into.iter_mut().zip(read).for_each(|(to, byte)| *to = byte);
        Ok(length)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.transport.send(bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn the_touch_scenario_passes_over_a_stream() {
    let embedded::Embedded { line, thread, .. } = embedded::start(Pace::Free, Level::best(), None).unwrap();
    let line = Line {
        transport: line,
        came: Vec::new(),
    };
    let timing = remote::touch(line).unwrap();
    println!("{timing}");
    assert_eq!(timing.ticks, remote::TICKS);
    assert_eq!(thread.join().unwrap().received.errors, 0);
}
