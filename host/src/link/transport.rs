//! How bytes travel: channels inside this process, or any stream.

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

/// Carries bytes both ways, in order, in pieces of its own choosing.
pub trait Transport {
    /// Sends all of `bytes`; may wait for the other side to take some.
    ///
    /// # Errors
    /// Whatever ends the connection.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Appends what has come to `into`; waits up to `wait` for the first byte.
    ///
    /// # Errors
    /// Whatever ends the connection. That nothing came is no error.
    fn receive(&mut self, wait: Duration, into: &mut Vec<u8>) -> io::Result<()>;
}

/// One end of a connection inside this process.
#[derive(Debug)]
pub struct ChannelTransport {
    to: Sender<Vec<u8>>,
    from: Receiver<Vec<u8>>,
}

/// Both ends of a connection inside this process; each holds up to `pieces` for the other.
#[must_use]
pub fn channel(pieces: usize) -> (ChannelTransport, ChannelTransport) {
    let (to_b, from_a) = bounded(pieces);
    let (to_a, from_b) = bounded(pieces);
    (
        ChannelTransport { to: to_b, from: from_b },
        ChannelTransport { to: to_a, from: from_a },
    )
}

impl Transport for ChannelTransport {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.to.send(bytes.to_vec()).map_err(|_| closed())
    }

    fn receive(&mut self, wait: Duration, into: &mut Vec<u8>) -> io::Result<()> {
        match self.from.recv_timeout(wait) {
            Ok(first) => into.extend(first),
            Err(RecvTimeoutError::Timeout) => return Ok(()),
            Err(RecvTimeoutError::Disconnected) => return Err(closed()),
        }
        into.extend(self.from.try_iter().flatten());
        Ok(())
    }
}

fn closed() -> io::Error {
    io::Error::new(ErrorKind::BrokenPipe, "the other side is gone")
}

/// A serial port or another stream. It must give up reading after a time of its own, some milliseconds, for `wait` to be kept to.
#[derive(Debug)]
pub struct StreamTransport<S>(pub S);

impl<S: Read + Write> Transport for StreamTransport<S> {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)?;
        self.0.flush()
    }

    fn receive(&mut self, wait: Duration, into: &mut Vec<u8>) -> io::Result<()> {
        let until = std::time::Instant::now() + wait;
        let mut piece = [0; 4096];
        loop {
            match self.0.read(&mut piece) {
                Ok(0) => return Err(closed()),
                Ok(length) => {
                    into.extend(piece.iter().take(length));
                    return Ok(());
                }
                Err(error) => match error.kind() {
                    ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => {}
                    _ => return Err(error),
                },
            }
            if std::time::Instant::now() >= until {
                return Ok(());
            }
        }
    }
}
