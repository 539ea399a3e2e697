//! Takes a sensor's records on a thread of its own.

use super::address::{Counts, NetFtAddress};
use super::counts::{CountsError, read_counts};
use super::rdt::{Command, Record, Request};
use std::io::{self, ErrorKind};
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// After so long without a record the sensor is silent.
const SILENCE: Duration = Duration::from_millis(500);
/// How often the thread looks whether to end.
const LOOK: Duration = Duration::from_millis(100);
/// Samples that may wait: a second of the fastest sensor.
const WAITING: usize = 8192;

/// One reading, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSample {
    /// When it came in.
    pub at: Instant,
    /// Force on the sensor's tool side by what touches it, N, and torque, N m, in the sensor's frame.
    pub wrench: [f64; 6],
    /// Records that were lost on the way before it.
    pub lost: u32,
}

/// Why there are no readings.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ForceError {
    /// The sensor cannot be reached.
    #[error("{address}: {reason}; expected a sensor that streams RDT")]
    Unreachable {
        /// Its address.
        address: String,
        /// What the system said.
        reason: String,
    },
    /// What its counts mean is not known.
    #[error(transparent)]
    Counts(#[from] CountsError),
    /// Nothing came for a time.
    #[error("{address}: no record for {} ms; expected one every few", SILENCE.as_millis())]
    Silent {
        /// Its address.
        address: String,
    },
    /// The sensor says that something is wrong with it.
    #[error(
        "{address}: the sensor reports status {status:#010x}: it is saturated, or broken (see its web page, System Status)"
    )]
    Faulty {
        /// Its address.
        address: String,
        /// Its status word.
        status: u32,
    },
}

/// A sensor that streams. Stops it when dropped.
#[derive(Debug)]
pub struct NetFt {
    samples: Receiver<Result<ForceSample, ForceError>>,
    stop: Arc<AtomicBool>,
}

impl NetFt {
    /// Asks the sensor at `address` to stream; before that its web page, where the address does not say what its counts mean.
    ///
    /// # Errors
    /// When it cannot be asked, or its page does not answer. A sensor that sends nothing is found by [`Self::next_sample`].
    pub fn connect(address: &NetFtAddress) -> Result<Self, ForceError> {
        let counts = match address.counts {
            Some(counts) => counts,
            None => read_counts(address)?,
        };
        let stream = Stream::open(address, counts).map_err(|e| ForceError::Unreachable {
            address: address.to_string(),
            reason: e.to_string(),
        })?;
        let (sender, samples) = sync_channel(WAITING);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let spawned = thread::Builder::new()
            .name("force sensor".into())
            .spawn(move || stream.run(&sender, &stopped));
        spawned.map_err(|e| ForceError::Unreachable {
            address: address.to_string(),
            reason: e.to_string(),
        })?;
        Ok(Self { samples, stop })
    }

    /// The next sample that has come in, if there is one. Does not wait.
    ///
    /// # Errors
    /// When the sensor is silent or says that it is faulty; it may go on after that.
    pub fn next_sample(&self) -> Result<Option<ForceSample>, ForceError> {
        match self.samples.try_recv() {
            Ok(sample) => sample.map(Some),
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => Ok(None),
        }
    }
}

impl Drop for NetFt {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

struct Stream {
    socket: UdpSocket,
    address: NetFtAddress,
    counts: Counts,
    /// Number of the newest record.
    newest: Option<u32>,
}

impl Stream {
    fn open(address: &NetFtAddress, counts: Counts) -> io::Result<Self> {
        // Of the family that the sensor's address has.
        let socket = match UdpSocket::bind("0.0.0.0:0").and_then(|socket| {
            socket.connect(&address.host)?;
            Ok(socket)
        }) {
            Ok(socket) => socket,
            Err(_) => {
                let socket = UdpSocket::bind("[::]:0")?;
                socket.connect(&address.host)?;
                socket
            }
        };
        socket.set_read_timeout(Some(LOOK))?;
        let stream = Self {
            socket,
            address: address.clone(),
            counts,
            newest: None,
        };
        stream.ask(Command::Stream)?;
        Ok(stream)
    }

    fn ask(&self, command: Command) -> io::Result<()> {
        let request = Request { command, count: 0 };
        self.socket.send(&request.to_bytes()).map(drop)
    }

    fn run(mut self, samples: &SyncSender<Result<ForceSample, ForceError>>, stop: &AtomicBool) {
        let mut heard = Instant::now();
        while !stop.load(Ordering::Relaxed) {
            let sample = match self.receive() {
                Some(sample) => {
                    heard = Instant::now();
                    sample
                }
                None if heard.elapsed() > SILENCE => {
                    heard = Instant::now();
                    // The request may have been lost, or the sensor started again.
                    let _ = self.ask(Command::Stream);
                    self.newest = None;
                    Err(ForceError::Silent {
                        address: self.address.to_string(),
                    })
                }
                None => continue,
            };
            // Where nobody takes samples for a second, newer ones are lost.
            if let Err(TrySendError::Disconnected(_)) = samples.try_send(sample) {
                break;
            }
        }
        let _ = self.ask(Command::Stop);
    }

    /// The next record; none where nothing, or no record, came in time.
    fn receive(&mut self) -> Option<Result<ForceSample, ForceError>> {
        let mut bytes = [0; 64];
        let length = match self.socket.recv(&mut bytes) {
            Ok(length) => length,
            Err(error) => {
                // Refused by a host on which no sensor runs (yet): as silent as no host.
                if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) {
                    thread::sleep(LOOK);
                }
                return None;
            }
        };
        let at = Instant::now();
        let record = Record::from_bytes(&bytes[..length]).ok()?;
        let gap = self
            .newest
            .map(|newest| record.rdt_sequence.wrapping_sub(newest));
        // A record that came twice, or after a later one.
        if gap.is_some_and(|gap| gap == 0 || gap > u32::MAX / 2) {
            return None;
        }
        self.newest = Some(record.rdt_sequence);
        if record.is_faulty() {
            return Some(Err(ForceError::Faulty {
                address: self.address.to_string(),
                status: record.status,
            }));
        }
        let (force, torque) = (self.counts.per_newton, self.counts.per_newton_metre);
        let scales = [force, force, force, torque, torque, torque];
        let mut wrench = record.counts.map(f64::from);
        wrench
            .iter_mut()
            .zip(scales)
            .for_each(|(value, scale)| *value /= scale);
        Some(Ok(ForceSample {
            at,
            wrench,
            lost: gap.map_or(0, |gap| gap - 1),
        }))
    }
}
