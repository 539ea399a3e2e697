//! Bus master for servos.

mod error;
mod exchange;
mod latency;
mod read_all;

pub use error::BusError;

use crate::clock::RigClock;
use crate::packet::instruction::{PING, READ, REBOOT, SYNC_WRITE, WRITE};
use crate::packet::{BROADCAST, Decoder, LONGEST, Protocol, Sender};
use crate::port::Port;
use crate::registers::Register;
use crate::serial::SerialPort;
use latency::Latency;

/// Bits per byte on the wire: start, 8 data, stop.
pub(crate) const BITS_PER_BYTE: f64 = 10.0;
/// Most significant bit of a Dynamixel's error byte, set on a hardware fault.
pub const ALERT: u8 = 0x80;

/// A servo bus with its port. Each request has a timeout and does not allocate.
pub struct Bus {
    port: Box<dyn Port>,
    protocol: Protocol,
    baud_rate: u32,
    clock: RigClock,
    timeout: f64,
    parameters: Vec<u8>,
    sent: Vec<u8>,
    decoder: Decoder,
    latency: Latency,
}

impl Bus {
    /// Opens the port at `path`. `timeout` is the time allowed for a response in addition to its transmission time, in
    /// s of `clock`'s time.
    ///
    /// # Errors
    /// Returns [`BusError::Open`] if the port cannot be opened.
    pub fn open(
        path: &str,
        (protocol, baud_rate): (Protocol, u32),
        timeout: f64,
        clock: RigClock,
    ) -> Result<Self, BusError> {
        let port = SerialPort::open(path, baud_rate, clock.clone());
        let port = port.map_err(|source| BusError::Open {
            path: path.into(),
            source,
        })?;
        let port = Box::new(port);
        Ok(Self::on(port, (protocol, baud_rate), timeout, clock))
    }

    /// Like [`open`](Self::open), but on an existing `port` with the given `baud_rate`.
    pub fn on(
        port: Box<dyn Port>,
        (protocol, baud_rate): (Protocol, u32),
        timeout: f64,
        clock: RigClock,
    ) -> Self {
        Self {
            port,
            protocol,
            baud_rate,
            clock,
            timeout,
            parameters: Vec::with_capacity(LONGEST),
            sent: Vec::with_capacity(2 * LONGEST),
            decoder: Decoder::new(protocol, Sender::Servo),
            latency: Latency::default(),
        }
    }

    /// Sets the time allowed for a response in addition to its transmission time, s. Returns the previous one.
    pub(crate) fn set_timeout(&mut self, timeout: f64) -> f64 {
        std::mem::replace(&mut self.timeout, timeout)
    }

    /// Median delay of recent responses in addition to their transmission, s; 0 before the first.
    pub(crate) fn usual_latency(&self) -> f64 {
        self.latency.median()
    }

    /// Discards the delays measured so far.
    pub(crate) fn forget_latency(&mut self) {
        self.latency = Latency::default();
    }

    /// Waits for `time` (s of the clock) and discards received bytes.
    pub(crate) fn wait(&mut self, time: f64) -> Result<(), BusError> {
        let until = self.clock.now() + time;
        let mut discarded = [0; 64];
        while self.clock.now() < until {
            self.port.receive(&mut discarded, until)?;
        }
        Ok(())
    }

    /// Clock of the rig.
    pub fn clock(&self) -> &RigClock {
        &self.clock
    }

    /// Protocol of the bus.
    pub fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// Checks that servo `id` answers.
    ///
    /// # Errors
    /// If the servo does not answer or the port fails.
    pub fn ping(&mut self, id: u8) -> Result<(), BusError> {
        self.parameters.clear();
        self.send(id, PING)?;
        let data = match self.protocol {
            Protocol::Dynamixel => 3,
            Protocol::Feetech | Protocol::FeetechScs => 0,
        };
        self.answer(id, data, "a ping").map(|_| ())
    }

    /// Reads `register` of servo `id`.
    ///
    /// # Errors
    /// If the servo does not answer correctly.
    pub fn read(&mut self, id: u8, register: Register) -> Result<i64, BusError> {
        let bytes = self.read_bytes(id, (register.address, register.length))?;
        Ok(register.decode(bytes))
    }

    /// Reads a `part` (address, length) of the control table of servo `id`.
    ///
    /// # Errors
    /// If the servo does not answer correctly.
    pub fn read_bytes(&mut self, id: u8, part: (u16, usize)) -> Result<&[u8], BusError> {
        self.name_part(part);
        self.send(id, READ)?;
        self.answer(id, part.1, "a read")
    }

    /// Writes `value` to `register` of servo `id`.
    ///
    /// # Errors
    /// If the servo rejects the value or does not answer.
    pub fn write(&mut self, id: u8, register: Register, value: i64) -> Result<(), BusError> {
        self.parameters.clear();
        self.push_address(register.address);
        register.encode(value, &mut self.parameters);
        self.send(id, WRITE)?;
        self.answer(id, 0, "a write").map(|_| ())
    }

    /// Restarts servo `id`.
    ///
    /// # Errors
    /// If the servo does not answer.
    pub fn reboot(&mut self, id: u8) -> Result<(), BusError> {
        self.parameters.clear();
        self.send(id, REBOOT)?;
        self.answer(id, 0, "a reboot").map(|_| ())
    }

    /// Writes values (id, value) to `register` of several servos, which do not answer.
    ///
    /// # Errors
    /// If the port fails.
    pub fn sync_write(
        &mut self,
        register: Register,
        values: impl Iterator<Item = (u8, i64)>,
    ) -> Result<(), BusError> {
        self.name_part((register.address, register.length));
        for (id, value) in values {
            self.parameters.push(id);
            register.encode(value, &mut self.parameters);
        }
        self.send(BROADCAST, SYNC_WRITE)
    }

    /// Waits for the response of servo `id` to the instruction `what`, and returns its data.
    fn answer(&mut self, id: u8, length: usize, what: &'static str) -> Result<&[u8], BusError> {
        let deadline = self.deadline(self.protocol.status_length(length));
        let protocol = self.protocol;
        let (error, bytes) = self.status(id, length, deadline)?;
        // A Dynamixel with a hardware fault, and a Feetech servo with any fault, still executes instructions.
        let number = match protocol {
            Protocol::Dynamixel => error & !ALERT,
            Protocol::Feetech | Protocol::FeetechScs => 0,
        };
        match number {
            0 => Ok(bytes),
            _ => Err(BusError::Refused { id, what, error }),
        }
    }
}
