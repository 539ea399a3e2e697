//! Emulated bus on a pseudo-terminal, served by a thread in real time.

use super::bus::{EmulatedBus, lock};
use super::fault::BusFault;
use super::plant::Plant;
use super::servos::EmulatorConfig;
use crate::clock::RigClock;
use feeler::pace::real_time::{MODERATE, fine_timer, raise_priority};
use feeler_serial::PseudoTerminal;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::JoinHandle;
use std::time::Duration;

/// Maximum time step of the bus while it is idle, s. Bytes from the master advance the bus first, so this only limits
/// the age of values read from [`Emulator::servos`].
const IDLE: f64 = 0.002;

/// Error of starting an emulated bus.
#[derive(Debug, thiserror::Error)]
#[error("failed to start the emulated bus: {0}")]
pub struct EmulatorError(#[from] io::Error);

/// An emulated servo bus on a pseudo-terminal, in real time. Stops when dropped.
pub struct Emulator {
    path: String,
    bus: Arc<Mutex<EmulatedBus>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Emulator {
    /// Starts the bus of `config`, whose servos move `plant`, on the time of `clock`.
    ///
    /// # Errors
    /// If no pseudo-terminal can be opened.
    pub fn start(
        config: &EmulatorConfig,
        plant: Box<dyn Plant>,
        clock: RigClock,
    ) -> Result<Self, EmulatorError> {
        let port = PseudoTerminal::open()?;
        let path = port.path().to_string();
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

    /// Path of the port for the master.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Locks the bus; it is blocked while the guard exists.
    pub fn servos(&self) -> MutexGuard<'_, EmulatedBus> {
        lock(&self.bus)
    }

    /// Injects a fault, starting now.
    pub fn inject(&self, fault: BusFault) {
        self.servos().inject(fault);
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has already been printed.
            let _ = thread.join();
        }
    }
}

struct Server {
    /// `None` after the cable was unplugged.
    port: Option<PseudoTerminal>,
    bus: Arc<Mutex<EmulatedBus>>,
    clock: RigClock,
}

impl Server {
    fn serve(mut self, ended: &AtomicBool) {
        // Real servos do not wait for a busy computer. Without this priority, responses may be late.
        let _ = raise_priority(MODERATE);
        let _ = fine_timer();
        while !ended.load(Ordering::Relaxed) {
            let next = self.go_on();
            self.receive(self.clock.real_time(next - self.clock.now()));
        }
    }

    /// Advances the bus to the present and sends its output to the master. Returns the time at which it must be called
    /// next, s.
    fn go_on(&mut self) -> f64 {
        let mut bus = lock(&self.bus);
        let now = self.clock.now();
        bus.advance(now);
        if !bus.is_connected() {
            self.port = None;
        }
        if let Some(port) = &mut self.port {
            port.send(bus.output());
        }
        bus.output().clear();
        bus.next_due().unwrap_or(now + IDLE).min(now + IDLE)
    }

    /// Waits at most `time` for bytes from the master and passes them to the bus.
    fn receive(&mut self, time: Duration) {
        let Some(port) = &mut self.port else {
            std::thread::sleep(time);
            return;
        };
        let mut buffer = [0; 1024];
        let count = port.receive(&mut buffer, time);
        if count > 0 {
            lock(&self.bus).hear(&buffer[..count], self.clock.now());
        }
    }
}
