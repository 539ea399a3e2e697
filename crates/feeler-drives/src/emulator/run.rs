//! The pseudo-terminal of an emulated bus, and the thread that serves it.

use super::fault::{BusFault, Wire};
use super::plant::Plant;
use super::servos::{EmulatorConfig, Servos};
use crate::bus::BITS_PER_BYTE;
use crate::clock::RigClock;
use crate::packet::{Decoder, Packet, Sender};
use feeler::pace::real_time::{MODERATE, fine_timer, raise_priority};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often the mechanism goes on where nothing is said, s.
const IDLE: f64 = 0.0005;
/// A servo forgets the begin of an instruction whose rest does not come, s.
const FORGETS: f64 = 0.02;

/// Why there is no emulated bus.
#[derive(Debug, thiserror::Error)]
#[error("no pseudo-terminal: {0}")]
pub struct EmulatorError(#[from] io::Error);

impl From<rustix::io::Errno> for EmulatorError {
    fn from(error: rustix::io::Errno) -> Self {
        Self(error.into())
    }
}

/// An emulated bus of servos. It ends when it is dropped.
pub struct Emulator {
    path: String,
    servos: Arc<Mutex<Servos>>,
    faults: Arc<Mutex<Vec<BusFault>>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Emulator {
    /// Starts the bus of `config`, whose servos move `plant`, in the time of `clock`.
    ///
    /// # Errors
    /// When the system has no pseudo-terminal.
    pub fn start(
        config: &EmulatorConfig,
        plant: Box<dyn Plant>,
        clock: RigClock,
    ) -> Result<Self, EmulatorError> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let master = openpt(flags)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let path = ptsname(&master, Vec::new())?;
        // Held open, so that the bus goes on from one master to the next; and raw, as a serial port is.
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let held = rustix::fs::open(path.as_c_str(), flags, Mode::empty())?;
        let mut settings = tcgetattr(&held)?;
        settings.make_raw();
        tcsetattr(&held, OptionalActions::Now, &settings)?;
        fcntl_setfl(&master, OFlags::NONBLOCK)?;

        let servos = Arc::new(Mutex::new(Servos::new(config, plant)));
        let faults = Arc::new(Mutex::new(Vec::new()));
        let ended = Arc::new(AtomicBool::new(false));
        let mut server = Server {
            port: Some((File::from(master), held)),
            servos: servos.clone(),
            injected: faults.clone(),
            decoder: Decoder::new(config.protocol, Sender::Master),
            clock,
            byte: BITS_PER_BYTE / f64::from(config.baud_rate),
            sent: 0.0,
            answered: 0.0,
            received: 0.0,
            arriving: VecDeque::new(),
            leaving: VecDeque::new(),
            wire: Wire {
                flipped: 0.0,
                lost: 0.0,
                random: Pcg64::seed_from_u64(config.seed ^ 0xB05),
            },
            late: 0.0,
            echo: false,
        };
        let flag = ended.clone();
        let thread = std::thread::Builder::new()
            .name("servos".into())
            .spawn(move || server.serve(&flag))?;
        Ok(Self {
            path: path.to_string_lossy().into_owned(),
            servos,
            faults,
            ended,
            thread: Some(thread),
        })
    }

    /// The port, for whoever is the master of the bus.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The servos; the bus waits while the guard lives.
    pub fn servos(&self) -> MutexGuard<'_, Servos> {
        lock(&self.servos)
    }

    /// Injects a fault from now on.
    pub fn inject(&self, fault: BusFault) {
        lock(&self.faults).push(fault);
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic there has been printed.
            let _ = thread.join();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An instruction, as it will have arrived at a time.
struct Instruction {
    due: f64,
    id: u8,
    code: u8,
    parameters: Vec<u8>,
}

/// Bytes that will have left at a time, and who answered with them.
struct Leaving {
    due: f64,
    bytes: Vec<u8>,
    id: u8,
}

struct Server {
    /// The pseudo-terminal, and its other end, held open.
    port: Option<(File, OwnedFd)>,
    servos: Arc<Mutex<Servos>>,
    injected: Arc<Mutex<Vec<BusFault>>>,
    decoder: Decoder,
    clock: RigClock,
    /// Time of a byte on the wire, s.
    byte: f64,
    /// When the last byte of the master, and of the servos, is over, s.
    sent: f64,
    answered: f64,
    /// When bytes last came from the master, s.
    received: f64,
    arriving: VecDeque<Instruction>,
    leaving: VecDeque<Leaving>,
    wire: Wire,
    late: f64,
    echo: bool,
}

impl Server {
    fn serve(&mut self, ended: &AtomicBool) {
        // Servos wait for no computer: where the system allows it, what plays them goes first. Without, it is late now and then.
        let _ = raise_priority(MODERATE);
        let _ = fine_timer();
        while !ended.load(Ordering::Relaxed) {
            self.inject();
            self.obey();
            self.leave();
            let now = self.clock.now();
            lock(&self.servos).advance(now);
            let due = [
                self.arriving.front().map(|arriving| arriving.due),
                self.leaving.front().map(|leaving| leaving.due),
            ];
            let next = due.into_iter().flatten().fold(now + IDLE, f64::min);
            self.receive(self.clock.real_time(next - now));
        }
    }

    /// Injects what was asked for.
    fn inject(&mut self) {
        let now = self.clock.now();
        for fault in lock(&self.injected).drain(..) {
            match fault {
                BusFault::FlipBytes(share) => self.wire.flipped = share,
                BusFault::LoseBytes(share) => self.wire.lost = share,
                BusFault::Late(late) => self.late = late,
                BusFault::Echo => self.echo = true,
                BusFault::CablePulled => self.port = None,
                of_a_servo => lock(&self.servos).inject(of_a_servo, now),
            }
        }
    }

    /// Waits for bytes of the master for at most `time`, and takes in those that are there.
    fn receive(&mut self, time: Duration) {
        let Some((port, _)) = &mut self.port else {
            std::thread::sleep(time);
            return;
        };
        let timeout = Timespec {
            tv_sec: time.as_secs() as i64,
            tv_nsec: time.subsec_nanos().into(),
        };
        let ready = poll(&mut [PollFd::new(&*port, PollFlags::IN)], Some(&timeout));
        if !ready.is_ok_and(|ready| ready > 0) {
            return;
        }
        let mut buffer = [0; 1024];
        let Ok(count) = port.read(&mut buffer) else {
            return;
        };
        let now = self.clock.now();
        if now - self.received > FORGETS {
            self.decoder.clear();
        }
        self.received = now;
        let mut bytes = buffer[..count].to_vec();
        let end = self.sent.max(now) + count as f64 * self.byte;
        self.sent = end;
        if self.echo {
            self.leaving.push_back(Leaving {
                due: end,
                bytes: bytes.clone(),
                id: crate::packet::BROADCAST,
            });
        }
        self.wire.carry(&mut bytes);
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let taken = self.decoder.feed(rest);
            rest = &rest[taken..];
            while let Some(found) = self.decoder.next() {
                // A servo passes over what is no packet.
                let Ok(packet) = found else { continue };
                self.arriving.push_back(Instruction {
                    due: end,
                    id: packet.id,
                    code: packet.code,
                    parameters: packet.parameters.to_vec(),
                });
            }
        }
    }

    /// Has the servos obey what has arrived by now.
    fn obey(&mut self) {
        let now = self.clock.now();
        while let Some(next) = take_due(&mut self.arriving, |next| next.due <= now) {
            let packet = Packet {
                id: next.id,
                code: next.code,
                parameters: &next.parameters,
            };
            let answers = lock(&self.servos).obey(packet, next.due);
            for answer in answers {
                let begin = self.answered.max(next.due) + answer.delay + self.late;
                self.answered = begin + answer.bytes.len() as f64 * self.byte;
                self.leaving.push_back(Leaving {
                    due: self.answered,
                    bytes: answer.bytes,
                    id: answer.id,
                });
            }
        }
    }

    /// Gives the master what has left the servos by now.
    fn leave(&mut self) {
        let now = self.clock.now();
        while let Some(mut next) = take_due(&mut self.leaving, |next| next.due <= now) {
            lock(&self.servos)
                .log
                .answer(next.due, next.id, &next.bytes);
            self.wire.carry(&mut next.bytes);
            if let Some((port, _)) = &mut self.port {
                // A master that does not read loses what does not fit, as with any port.
                let _ = port.write(&next.bytes);
            }
        }
    }
}

/// The first of `queue`, if it is due.
fn take_due<T>(queue: &mut VecDeque<T>, is_due: impl Fn(&T) -> bool) -> Option<T> {
    queue
        .front()
        .is_some_and(is_due)
        .then(|| queue.pop_front())?
}
