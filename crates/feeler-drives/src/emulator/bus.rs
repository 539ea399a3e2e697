//! Timing of an emulated bus: when bytes arrive at the servos, and their responses at the master.

use super::fault::{BusFault, Wire};
use super::log::{LogEntry, PacketLog};
use super::plant::Plant;
use super::servo::EmulatedServo;
use super::servos::{EmulatorConfig, Servos};
use crate::bus::BITS_PER_BYTE;
use crate::packet::{BROADCAST, Decoder, Packet, Sender};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Maximum time step of the mechanism and the servos' firmware, s.
const STEP: f64 = 0.0005;
/// Time after which servos discard an incomplete instruction, s.
const FORGETS: f64 = 0.02;

/// Servos on a bus. Contains no clock; callers pass the time.
pub struct EmulatedBus {
    servos: Servos,
    decoder: Decoder,
    /// Transmission time of a byte, s.
    byte: f64,
    time: f64,
    /// Time of the end of the last byte from the master, s.
    sent: f64,
    /// Time of the end of the last byte from the servos, s.
    answered: f64,
    /// Time at which the latest bytes from the master were received, s.
    received: f64,
    arriving: VecDeque<Instruction>,
    leaving: VecDeque<Leaving>,
    /// Bytes that have arrived at the master but have not been read.
    output: Vec<u8>,
    wire: Wire,
    late: f64,
    /// Interval at which the adapter delivers responses, s; 0 if it delivers them at once.
    latency: f64,
    echo: bool,
    connected: bool,
}

/// An instruction in transit, which arrives at `due`.
struct Instruction {
    due: f64,
    id: u8,
    code: u8,
    parameters: Vec<u8>,
}

/// A response in transit, which arrives at `due`, and the id of its sender.
struct Leaving {
    due: f64,
    bytes: Vec<u8>,
    id: u8,
}

impl EmulatedBus {
    /// Creates the bus of `config` at time 0, whose servos move `plant`.
    pub(super) fn new(config: &EmulatorConfig, plant: Box<dyn Plant>) -> Self {
        Self {
            servos: Servos::new(config, plant),
            decoder: Decoder::new(config.protocol, Sender::Master),
            byte: BITS_PER_BYTE / f64::from(config.baud_rate),
            time: 0.0,
            sent: 0.0,
            answered: 0.0,
            received: 0.0,
            arriving: VecDeque::new(),
            leaving: VecDeque::new(),
            output: Vec::new(),
            wire: Wire {
                flipped: 0.0,
                lost: 0.0,
                random: Pcg64::seed_from_u64(config.seed ^ 0xB05),
            },
            late: 0.0,
            latency: 0.0,
            echo: false,
            connected: true,
        }
    }

    /// The servos at the current time.
    pub fn servos(&self) -> &[EmulatedServo] {
        &self.servos.servos
    }

    /// Log of all packets.
    pub fn log(&self) -> &PacketLog {
        &self.servos.log
    }

    /// Removes and returns the log entries, oldest first.
    pub fn take_log(&mut self) -> Vec<LogEntry> {
        self.servos.log.take()
    }

    /// Injects a fault, starting now.
    pub(super) fn inject(&mut self, fault: BusFault) {
        match fault {
            BusFault::FlipBytes(share) => self.wire.flipped = share,
            BusFault::LoseBytes(share) => self.wire.lost = share,
            BusFault::Late(late) => self.late = late,
            BusFault::Latency(latency) => self.latency = latency,
            BusFault::Echo => self.echo = true,
            BusFault::CablePulled => self.connected = false,
            of_a_servo => self.servos.inject(of_a_servo, self.time),
        }
    }

    /// Returns `true` if the master's cable is connected.
    pub(super) fn is_connected(&self) -> bool {
        self.connected
    }

    /// Bytes that have arrived at the master. The master removes the bytes that it reads.
    pub(super) fn output(&mut self) -> &mut Vec<u8> {
        &mut self.output
    }

    /// Time of the next event on the wire, s, or `None` if the bus is idle.
    pub(super) fn next_due(&self) -> Option<f64> {
        let arriving = self.arriving.front().map(|arriving| arriving.due);
        let leaving = self.leaving.front().map(|leaving| leaving.due);
        arriving.into_iter().chain(leaving).reduce(f64::min)
    }

    /// Receives bytes from the master, whose transmission starts at `now`, s.
    pub(super) fn hear(&mut self, bytes: &[u8], now: f64) {
        if now - self.received > FORGETS {
            self.decoder.clear();
        }
        self.received = now;
        let end = self.sent.max(now) + bytes.len() as f64 * self.byte;
        self.sent = end;
        let mut bytes = bytes.to_vec();
        if self.echo {
            self.leaving.push_back(Leaving {
                due: end,
                bytes: bytes.clone(),
                id: BROADCAST,
            });
        }
        self.wire.carry(&mut bytes);
        let mut rest = &bytes[..];
        while !rest.is_empty() {
            let taken = self.decoder.feed(rest);
            rest = &rest[taken..];
            while let Some(found) = self.decoder.next() {
                // Servos ignore invalid packets.
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

    /// Advances to `now` (s) and processes all events until then in order.
    pub(super) fn advance(&mut self, now: f64) {
        while let Some(due) = self.next_due().filter(|&due| due <= now) {
            self.go_on(due);
            // An instruction comes before a response due at the same time, because its own response is due later.
            match take_due(&mut self.arriving, |next| next.due <= due) {
                Some(instruction) => self.execute(&instruction),
                None => self.leave(due),
            }
        }
        self.go_on(now);
    }

    /// Advances the emulated mechanism to the time `now` (s). No byte is transferred in the meantime.
    fn go_on(&mut self, now: f64) {
        while self.time + STEP < now {
            self.time += STEP;
            self.servos.advance(self.time);
        }
        if self.time < now {
            self.time = now;
            self.servos.advance(now);
        }
    }

    /// Executes an instruction and enqueues the responses.
    fn execute(&mut self, instruction: &Instruction) {
        let due = instruction.due;
        let packet = Packet {
            id: instruction.id,
            code: instruction.code,
            parameters: &instruction.parameters,
        };
        for answer in self.servos.execute(packet, due) {
            let begin = self.answered.max(due) + answer.delay + self.late;
            self.answered = begin + answer.bytes.len() as f64 * self.byte;
            // The adapter sends the bytes that it has collected when its timer expires.
            let due = match self.latency {
                0.0 => self.answered,
                latency => (self.answered / latency).ceil() * latency,
            };
            self.leaving.push_back(Leaving {
                due,
                bytes: answer.bytes,
                id: answer.id,
            });
        }
    }

    /// Delivers the next response due by `now`, s.
    fn leave(&mut self, now: f64) {
        let Some(mut next) = take_due(&mut self.leaving, |next| next.due <= now) else {
            return;
        };
        self.servos.log.answer(next.due, next.id, &next.bytes);
        self.wire.carry(&mut next.bytes);
        self.output.append(&mut next.bytes);
    }
}

/// Removes the first item of `queue` if it is due.
fn take_due<T>(queue: &mut VecDeque<T>, is_due: impl Fn(&T) -> bool) -> Option<T> {
    queue
        .front()
        .is_some_and(is_due)
        .then(|| queue.pop_front())?
}

/// Locks the bus, even if another thread panicked with the lock.
pub(super) fn lock(bus: &Mutex<EmulatedBus>) -> MutexGuard<'_, EmulatedBus> {
    bus.lock().unwrap_or_else(PoisonError::into_inner)
}
