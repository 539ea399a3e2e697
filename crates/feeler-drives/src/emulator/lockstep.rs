//! Emulated bus with simulated time: deterministic and faster than real time.

use super::bus::{EmulatedBus, lock};
use super::fault::BusFault;
use super::plant::Plant;
use super::servos::EmulatorConfig;
use crate::clock::RigClock;
use crate::port::Port;
use feeler::pace::Clock;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

/// An emulated bus without a terminal or a thread. The master's computations take no time. Time advances only while the
/// master waits for a response, or for the next step of its schedule (a [`FixedRate`](feeler::pace::FixedRate) with this bus as
/// its clock). Clones share the same bus.
#[derive(Clone)]
pub struct Lockstep {
    bus: Arc<Mutex<EmulatedBus>>,
    clock: RigClock,
}

impl Lockstep {
    /// Creates the bus of `config` at time 0, whose servos move `plant`.
    pub fn new(config: &EmulatorConfig, plant: Box<dyn Plant>) -> Self {
        Self {
            bus: Arc::new(Mutex::new(EmulatedBus::new(config, plant))),
            clock: RigClock::lockstep(),
        }
    }

    /// Locks the bus; it is blocked while the guard exists.
    pub fn servos(&self) -> MutexGuard<'_, EmulatedBus> {
        lock(&self.bus)
    }

    /// Injects a fault, starting now.
    pub fn inject(&self, fault: BusFault) {
        self.servos().inject(fault);
    }

    /// Clock of the bus.
    pub fn clock(&self) -> RigClock {
        self.clock.clone()
    }

    /// Advances time by `time`, s.
    pub fn wait(&self, time: f64) {
        self.advance(&mut self.servos(), self.clock.now() + time);
    }

    /// Advances time to `now`, s.
    fn advance(&self, bus: &mut EmulatedBus, now: f64) {
        bus.advance(now);
        self.clock.set(now);
    }
}

impl Clock for Lockstep {
    fn now(&self) -> Duration {
        Duration::try_from_secs_f64(self.clock.now()).unwrap_or_default()
    }

    fn sleep_until(&self, time: Duration) {
        // Half a nanosecond more, since converting to seconds may round down.
        let until = time.as_secs_f64() + 5e-10;
        if until > self.clock.now() {
            self.advance(&mut self.servos(), until);
        }
    }
}

/// The master's port.
impl Port for Lockstep {
    fn discard_input(&mut self) -> io::Result<()> {
        self.servos().output().clear();
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut bus = self.servos();
        if !bus.is_connected() {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        bus.hear(bytes, self.clock.now());
        Ok(())
    }

    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize> {
        let mut bus = lock(&self.bus);
        loop {
            if !bus.is_connected() {
                return Err(io::ErrorKind::BrokenPipe.into());
            }
            let arrived = bus.output();
            if !arrived.is_empty() {
                let count = arrived.len().min(bytes.len());
                bytes[..count].copy_from_slice(&arrived[..count]);
                arrived.drain(..count);
                return Ok(count);
            }
            let now = self.clock.now();
            if now >= deadline {
                return Ok(0);
            }
            let next = bus.next_due().unwrap_or(deadline).min(deadline);
            self.advance(&mut bus, next.max(now));
        }
    }
}
