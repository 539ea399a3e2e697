//! An emulated bus behind a pseudo-terminal, served by a thread in real time.

use super::bus::EmulatedBus;
use super::fault::BusFault;
use super::plant::Plant;
use super::servos::EmulatorConfig;
use crate::clock::RigClock;
use feeler::pace::real_time::{MODERATE, fine_timer, raise_priority};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often the bus goes on where nothing is said, s. What is said makes it catch up first, so that this only bounds how old the
/// mechanism is for who looks at it past the bus.
const IDLE: f64 = 0.002;

/// Why there is no emulated bus.
#[derive(Debug, thiserror::Error)]
#[error("no pseudo-terminal: {0}")]
pub struct EmulatorError(#[from] io::Error);

impl From<rustix::io::Errno> for EmulatorError {
    fn from(error: rustix::io::Errno) -> Self {
        Self(error.into())
    }
}

/// An emulated bus of servos on a pseudo-terminal, in real time. It ends when it is dropped.
pub struct Emulator {
    path: String,
    bus: Arc<Mutex<EmulatedBus>>,
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
        let (port, path) = Terminal::open()?;
        let bus = Arc::new(Mutex::new(EmulatedBus::new(config, plant)));
        let ended = Arc::new(AtomicBool::new(false));
        let server = Server {
            port: Some(port),
            bus: bus.clone(),
            clock,
        };
        let flag = ended.clone();
        let thread = std::thread::Builder::new()
            .name("servos".into())
            .spawn(move || server.serve(&flag))?;
        Ok(Self {
            path,
            bus,
            ended,
            thread: Some(thread),
        })
    }

    /// The port, for whoever is the master of the bus.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The bus, which waits while the guard lives.
    pub fn servos(&self) -> MutexGuard<'_, EmulatedBus> {
        lock(&self.bus)
    }

    /// Injects a fault from now on.
    pub fn inject(&self, fault: BusFault) {
        self.servos().inject(fault);
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

/// The bus, for as long as the guard lives. A panic elsewhere does not lock it for good.
pub(super) fn lock(bus: &Mutex<EmulatedBus>) -> MutexGuard<'_, EmulatedBus> {
    bus.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A pseudo-terminal.
struct Terminal {
    ours: File,
    /// The master's end, held open, so that the bus goes on from one master to the next.
    _theirs: OwnedFd,
}

impl Terminal {
    /// A new one, raw as a serial port is, and the path of the master's end.
    fn open() -> Result<(Self, String), EmulatorError> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let ours = openpt(flags)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let path = ptsname(&ours, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let theirs = rustix::fs::open(path.as_c_str(), flags, Mode::empty())?;
        let mut settings = tcgetattr(&theirs)?;
        settings.make_raw();
        tcsetattr(&theirs, OptionalActions::Now, &settings)?;
        fcntl_setfl(&ours, OFlags::NONBLOCK)?;
        let terminal = Self {
            ours: File::from(ours),
            _theirs: theirs,
        };
        Ok((terminal, path.to_string_lossy().into_owned()))
    }
}

struct Server {
    /// None once its cable is pulled.
    port: Option<Terminal>,
    bus: Arc<Mutex<EmulatedBus>>,
    clock: RigClock,
}

impl Server {
    fn serve(mut self, ended: &AtomicBool) {
        // Servos wait for no computer: where the system allows it, what plays them goes first. Without, it is late now and then.
        let _ = raise_priority(MODERATE);
        let _ = fine_timer();
        while !ended.load(Ordering::Relaxed) {
            let next = self.go_on();
            self.receive(self.clock.real_time(next - self.clock.now()));
        }
    }

    /// Lets the bus go on until now, and gives the master what has left the servos; when to do so again, s.
    fn go_on(&mut self) -> f64 {
        let mut bus = lock(&self.bus);
        let now = self.clock.now();
        bus.advance(now);
        if !bus.is_connected() {
            self.port = None;
        }
        if let Some(port) = &mut self.port {
            // A master that does not read loses what does not fit, as with any port.
            let _ = port.ours.write(bus.output());
        }
        bus.output().clear();
        bus.next_due().unwrap_or(now + IDLE).min(now + IDLE)
    }

    /// Waits for bytes of the master for at most `time`, and takes in those that are there.
    fn receive(&mut self, time: Duration) {
        let Some(Terminal { ours, .. }) = &mut self.port else {
            std::thread::sleep(time);
            return;
        };
        let timeout = Timespec {
            tv_sec: time.as_secs() as i64,
            tv_nsec: time.subsec_nanos().into(),
        };
        let ready = poll(&mut [PollFd::new(&*ours, PollFlags::IN)], Some(&timeout));
        if !ready.is_ok_and(|ready| ready > 0) {
            return;
        }
        let mut buffer = [0; 1024];
        if let Ok(count) = ours.read(&mut buffer) {
            lock(&self.bus).hear(&buffer[..count], self.clock.now());
        }
    }
}
