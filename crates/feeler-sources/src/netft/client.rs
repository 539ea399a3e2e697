//! Receives a sensor's records on a background thread.

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

/// Time without a record after which the sensor is reported as silent.
const SILENCE: Duration = Duration::from_millis(500);
/// Interval at which the thread checks whether to end.
const LOOK: Duration = Duration::from_millis(100);
/// Capacity of the sample queue: one second of the fastest sensor.
const WAITING: usize = 8192;

/// One force/torque sample in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSample {
    /// Time of arrival.
    pub at: Instant,
    /// Force (N) and torque (N m) exerted on the sensor's tool side by the object in contact, in the sensor's frame.
    pub wrench: [f64; 6],
    /// Number of records lost before this one.
    pub lost: u32,
}

/// Error of a force/torque sensor.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ForceError {
    /// The sensor cannot be reached.
    #[error("{address}: {reason}; expected a sensor that streams RDT")]
    Unreachable {
        /// Address of the sensor.
        address: String,
        /// Error of the operating system.
        reason: String,
    },
    /// The scale of the counts is unknown.
    #[error(transparent)]
    Counts(#[from] CountsError),
    /// No record has arrived for some time.
    #[error("{address}: no record for {} ms; expected one every few ms", SILENCE.as_millis())]
    Silent {
        /// Address of the sensor.
        address: String,
    },
    /// The sensor reports a fault.
    #[error(
        "{address}: the sensor reports status {status:#010x}: it is saturated, or broken (see its web page, System Status)"
    )]
    Faulty {
        /// Address of the sensor.
        address: String,
        /// Status word of the record.
        status: u32,
    },
}

/// A streaming force/torque sensor. Dropping it stops the stream.
#[derive(Debug)]
pub struct NetFt {
    samples: Receiver<Result<ForceSample, ForceError>>,
    stop: Arc<AtomicBool>,
}

impl NetFt {
    /// Requests a stream from the sensor at `address`. If the address has no counts, their scale is first read from
    /// the sensor's web page.
    ///
    /// # Errors
    /// If the request cannot be sent or the web page does not respond. A sensor that sends nothing is reported by
    /// [`Self::next_sample`].
    pub fn connect(address: &NetFtAddress) -> Result<Self, ForceError> {
        let counts = match address.counts {
            Some(counts) => counts,
            None => read_counts(address)?,
        };
        let unreachable = |error: io::Error| ForceError::Unreachable {
            address: address.to_string(),
            reason: error.to_string(),
        };
        let stream = Stream::open(address, counts).map_err(unreachable)?;
        let (sender, samples) = sync_channel(WAITING);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let spawned = thread::Builder::new()
            .name("force sensor".into())
            .spawn(move || stream.run(&sender, &stopped));
        spawned.map_err(unreachable)?;
        Ok(Self { samples, stop })
    }

    /// Next sample in the queue, or `None` if it is empty. Does not wait.
    ///
    /// # Errors
    /// If the sensor is silent or reports a fault. Samples may follow later.
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
    /// Sequence number of the latest record.
    newest: Option<u32>,
}

impl Stream {
    fn open(address: &NetFtAddress, counts: Counts) -> io::Result<Self> {
        let connected = |from: &str| {
            let socket = UdpSocket::bind(from)?;
            socket.connect(&address.host)?;
            Ok::<_, io::Error>(socket)
        };
        // Binds the address family of the sensor.
        let socket = connected("0.0.0.0:0").or_else(|_| connected("[::]:0"))?;
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
                    // The request may have been lost, or the sensor restarted.
                    let _ = self.ask(Command::Stream);
                    self.newest = None;
                    Err(ForceError::Silent {
                        address: self.address.to_string(),
                    })
                }
                None => continue,
            };
            // If the queue is full, new samples are dropped.
            if let Err(TrySendError::Disconnected(_)) = samples.try_send(sample) {
                break;
            }
        }
        let _ = self.ask(Command::Stop);
    }

    /// Next sample, or `None` if no valid record arrives in time.
    fn receive(&mut self) -> Option<Result<ForceSample, ForceError>> {
        let mut bytes = [0; 64];
        let length = match self.socket.recv(&mut bytes) {
            Ok(length) => length,
            Err(error) => {
                // Connection refused: no sensor is running on that host (yet). Handled like silence.
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
        // A repeated or late record.
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
        Some(Ok(ForceSample {
            at,
            wrench: std::array::from_fn(|axis| f64::from(record.counts[axis]) / scales[axis]),
            lost: gap.map_or(0, |gap| gap - 1),
        }))
    }
}
