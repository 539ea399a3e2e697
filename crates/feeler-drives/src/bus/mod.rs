//! The master of a bus of servos: one question, and the answers to it.

use crate::clock::RigClock;
use crate::packet::instruction::{
    FAST_SYNC_READ, PING, READ, REBOOT, STATUS, SYNC_READ, SYNC_WRITE, WRITE,
};
use crate::packet::{
    BROADCAST, Decoder, LONGEST, PacketError, Protocol, Sender, TooLong, complete_blocks, encode,
    fast_blocks,
};
use crate::port::SerialPort;
use crate::registers::Register;
use std::io;
use std::time::{Duration, Instant};

/// Bits on the wire of a byte: start, 8 data, stop.
pub(crate) const BITS_PER_BYTE: f64 = 10.0;
/// The first bit of a Dynamixel's error byte: it has a hardware fault.
pub const ALERT: u8 = 0x80;

/// Why servos were not asked, or did not answer as they should.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The port cannot be opened.
    #[error("{path}: {source}; expected a serial port that no other program uses")]
    Open {
        /// The port.
        path: String,
        /// What the system said.
        source: io::Error,
    },
    /// The port fails: a cable was pulled, say.
    #[error("the serial port fails: {0}; is its cable plugged in?")]
    Port(#[from] io::Error),
    /// A packet cannot be made.
    #[error(transparent)]
    TooLong(#[from] TooLong),
    /// A servo says nothing.
    #[error("servo {id} did not answer within {waited:.4} s")]
    NoReply {
        /// The servo.
        id: u8,
        /// How long it had, s.
        waited: f64,
    },
    /// An answer ended early.
    #[error("the answer of servo {id} broke off after {received} bytes")]
    CutShort {
        /// The servo.
        id: u8,
        /// Bytes that arrived.
        received: usize,
    },
    /// What arrived is no packet.
    #[error("the answer of servo {id} arrived damaged: {source}")]
    Damaged {
        /// The servo whose answer was expected.
        id: u8,
        /// What is wrong with it.
        source: PacketError,
    },
    /// Another answer than was asked for.
    #[error(
        "servo {id} was to answer with {expected} bytes of data, and servo {actual_id} answered with {actual}"
    )]
    Unexpected {
        /// The servo.
        id: u8,
        /// Bytes of data.
        expected: usize,
        /// Who answered.
        actual_id: u8,
        /// Bytes of data that it answered with.
        actual: usize,
    },
    /// What was sent came back.
    #[error(
        "the adapter sends back what it is sent: expected one without echo (switch it off, or the jumper that does it)"
    )]
    Echo,
    /// A servo did not do what it was told.
    #[error("servo {id} refused {what}: error {error:#04x}{}", in_words(*.error))]
    Refused {
        /// The servo.
        id: u8,
        /// What it was told.
        what: &'static str,
        /// Its error byte.
        error: u8,
    },
}

impl BusError {
    /// The servo that it is laid to, if it is to one.
    pub fn servo(&self) -> Option<u8> {
        match *self {
            Self::NoReply { id, .. }
            | Self::CutShort { id, .. }
            | Self::Damaged { id, .. }
            | Self::Unexpected { id, .. }
            | Self::Refused { id, .. } => Some(id),
            Self::Open { .. } | Self::Port(_) | Self::TooLong(_) | Self::Echo => None,
        }
    }
}

/// The error numbers of Dynamixel protocol 2.0.
fn in_words(error: u8) -> &'static str {
    match error & !ALERT {
        1 => " (it could not process the instruction)",
        2 => " (it does not know the instruction)",
        3 => " (the instruction reached it damaged)",
        4 => " (the value is out of its range)",
        5 => " (the value is too short)",
        6 => " (the value is beyond its limit)",
        7 => " (that cannot be read or written, or not while the torque is on)",
        _ => "",
    }
}

/// A bus of servos and the port to it. Each question waits for its answers for a bounded time; none allocates.
#[derive(Debug)]
pub struct Bus {
    port: SerialPort,
    protocol: Protocol,
    baud_rate: u32,
    clock: RigClock,
    timeout: f64,
    parameters: Vec<u8>,
    sent: Vec<u8>,
    decoder: Decoder,
}

impl Bus {
    /// Opens the port at `path`. Servos may take `timeout` (s of `clock`'s time) for an answer, beside what its bytes take.
    ///
    /// # Errors
    /// When the port cannot be opened.
    pub fn open(
        path: &str,
        (protocol, baud_rate): (Protocol, u32),
        timeout: f64,
        clock: RigClock,
    ) -> Result<Self, BusError> {
        let port = SerialPort::open(path, baud_rate).map_err(|source| BusError::Open {
            path: path.into(),
            source,
        })?;
        Ok(Self {
            port,
            protocol,
            baud_rate,
            clock,
            timeout,
            parameters: Vec::with_capacity(LONGEST),
            sent: Vec::with_capacity(2 * LONGEST),
            decoder: Decoder::new(protocol, Sender::Servo),
        })
    }

    /// What is spoken on it.
    pub fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// Asks whether servo `id` is there.
    ///
    /// # Errors
    /// When it does not answer, or the port fails.
    pub fn ping(&mut self, id: u8) -> Result<(), BusError> {
        self.parameters.clear();
        self.send(id, PING)?;
        let data = match self.protocol {
            Protocol::Dynamixel => 3,
            Protocol::Feetech => 0,
        };
        self.answer(id, data, "to say who it is").map(|_| ())
    }

    /// Reads `register` of servo `id`.
    ///
    /// # Errors
    /// When it does not answer as it should.
    pub fn read(&mut self, id: u8, register: Register) -> Result<i64, BusError> {
        let bytes = self.read_bytes(id, (register.address, register.length))?;
        Ok(register.decode(bytes))
    }

    /// Reads `length` bytes from `address` on of servo `id`.
    ///
    /// # Errors
    /// When it does not answer as it should.
    pub fn read_bytes(&mut self, id: u8, part: (u16, usize)) -> Result<&[u8], BusError> {
        self.name_part(part);
        self.send(id, READ)?;
        self.answer(id, part.1, "a reading")
    }

    /// Writes `value` to `register` of servo `id`.
    ///
    /// # Errors
    /// When it does not take it.
    pub fn write(&mut self, id: u8, register: Register, value: i64) -> Result<(), BusError> {
        self.parameters.clear();
        self.push_address(register.address);
        register.encode(value, &mut self.parameters);
        self.send(id, WRITE)?;
        self.answer(id, 0, "a value").map(|_| ())
    }

    /// Starts servo `id` afresh.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn reboot(&mut self, id: u8) -> Result<(), BusError> {
        self.parameters.clear();
        self.send(id, REBOOT)?;
        self.answer(id, 0, "a reboot").map(|_| ())
    }

    /// Writes each of these values to `register` of a servo: ids and values. Nobody answers.
    ///
    /// # Errors
    /// When the port fails.
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

    /// Reads the same `part` (address, length) of the servos `ids`, in one packet of all where `fast`. `each` gets a servo's place
    /// in `ids`, its error byte and its bytes.
    ///
    /// # Errors
    /// When one of them does not answer as it should.
    pub fn sync_read(
        &mut self,
        part: (u16, usize),
        ids: &[u8],
        fast: bool,
        mut each: impl FnMut(usize, u8, &[u8]),
    ) -> Result<(), BusError> {
        self.name_part(part);
        self.parameters.extend(ids);
        let length = part.1;
        if !fast {
            self.send(BROADCAST, SYNC_READ)?;
            let whole = self.protocol.status_length(length) * ids.len();
            let deadline = self.deadline(whole);
            for (index, &id) in ids.iter().enumerate() {
                let (error, bytes) = self.status(id, length, deadline)?;
                each(index, error, bytes);
            }
            return Ok(());
        }
        self.send(BROADCAST, FAST_SYNC_READ)?;
        let whole = 8 + ids.len() * (length + 4);
        let deadline = self.deadline(whole);
        let blamed = |decoder: &Decoder| {
            let arrived = complete_blocks(decoder.pending(), length);
            ids.get(arrived)
                .or(ids.last())
                .copied()
                .unwrap_or(BROADCAST)
        };
        let parameters = self.packet(blamed, deadline)?.2;
        let mut count = 0;
        for (index, (block, &id)) in fast_blocks(parameters, length).zip(ids).enumerate() {
            if block.id != id {
                return Err(BusError::Unexpected {
                    id,
                    expected: length,
                    actual_id: block.id,
                    actual: block.data.len(),
                });
            }
            each(index, block.error, block.data);
            count += 1;
        }
        match ids.get(count) {
            Some(&id) => Err(BusError::CutShort {
                id,
                received: parameters.len(),
            }),
            None => Ok(()),
        }
    }

    /// The data of the answer of servo `id`, who was told `what`.
    fn answer(&mut self, id: u8, length: usize, what: &'static str) -> Result<&[u8], BusError> {
        let deadline = self.deadline(self.protocol.status_length(length));
        let protocol = self.protocol;
        let (error, bytes) = self.status(id, length, deadline)?;
        // A servo with a hardware fault, and a Feetech servo with any, still does what it is told.
        let number = match protocol {
            Protocol::Dynamixel => error & !ALERT,
            Protocol::Feetech => 0,
        };
        match number {
            0 => Ok(bytes),
            _ => Err(BusError::Refused { id, what, error }),
        }
    }

    /// Error byte and data, `length` bytes, of the answer of servo `id`.
    fn status(
        &mut self,
        id: u8,
        length: usize,
        deadline: (Instant, f64),
    ) -> Result<(u8, &[u8]), BusError> {
        let protocol = self.protocol;
        let (actual_id, code, parameters) = self.packet(|_| id, deadline)?;
        let (error, data) = match (protocol, parameters) {
            (Protocol::Dynamixel, [error, data @ ..]) => (*error, data),
            _ => (code, parameters),
        };
        let refused = data.is_empty() && error & !ALERT != 0 && protocol == Protocol::Dynamixel;
        if actual_id == id && (data.len() == length || refused) {
            return match refused && length > 0 {
                true => Err(BusError::Refused {
                    id,
                    what: "a reading",
                    error,
                }),
                false => Ok((error, data)),
            };
        }
        Err(BusError::Unexpected {
            id,
            expected: length,
            actual_id,
            actual: data.len(),
        })
    }

    /// Id, code and parameters of the next packet. What is wrong is laid to whom `blamed` says.
    fn packet(
        &mut self,
        blamed: impl Fn(&Decoder) -> u8,
        (deadline, waited): (Instant, f64),
    ) -> Result<(u8, u8, &[u8]), BusError> {
        let mut buffer = [0; 256];
        // The borrow checker does not see that a packet that is found ends the loop.
        while !self.decoder.has_packet() {
            let received = self.port.receive(&mut buffer, deadline)?;
            if received == 0 {
                let (id, pending) = (blamed(&self.decoder), self.decoder.pending().len());
                return Err(match pending {
                    0 => BusError::NoReply { id, waited },
                    received => BusError::CutShort { id, received },
                });
            }
            self.decoder.feed(&buffer[..received]);
            if self.is_echo() {
                return Err(BusError::Echo);
            }
        }
        let (id, protocol) = (blamed(&self.decoder), self.protocol);
        match self.decoder.next() {
            Some(Ok(packet)) if is_instruction(protocol, (packet.id, packet.code)) => {
                Err(BusError::Echo)
            }
            Some(Ok(packet)) => Ok((packet.id, packet.code, packet.parameters)),
            Some(Err(source)) => Err(BusError::Damaged { id, source }),
            None => Err(BusError::NoReply { id, waited }),
        }
    }

    /// Whether what arrived begins with what was sent: no answer does.
    fn is_echo(&self) -> bool {
        let (sent, arrived) = (&self.sent, self.decoder.pending());
        !sent.is_empty() && arrived.len() >= sent.len() && arrived.starts_with(sent)
    }

    /// Sends what is in `parameters`; answers to older questions do not count any more.
    fn send(&mut self, id: u8, code: u8) -> Result<(), BusError> {
        encode(self.protocol, (id, code), &self.parameters, &mut self.sent)?;
        self.port.discard_input()?;
        self.decoder.clear();
        self.port.send(&self.sent)?;
        Ok(())
    }

    /// When an answer of so many bytes must be there, and how long that is, s.
    fn deadline(&self, bytes: usize) -> (Instant, f64) {
        let on_wire = (self.sent.len() + bytes) as f64 * BITS_PER_BYTE / f64::from(self.baud_rate);
        let time = self.timeout + on_wire;
        let real: Duration = self.clock.real_time(time);
        (Instant::now() + real, time)
    }

    fn name_part(&mut self, (address, length): (u16, usize)) {
        self.parameters.clear();
        self.push_address(address);
        match self.protocol {
            Protocol::Dynamixel => self.parameters.extend((length as u16).to_le_bytes()),
            Protocol::Feetech => self.parameters.push(length as u8),
        }
    }

    fn push_address(&mut self, address: u16) {
        match self.protocol {
            Protocol::Dynamixel => self.parameters.extend(address.to_le_bytes()),
            Protocol::Feetech => self.parameters.push(address as u8),
        }
    }

    /// How long a servo may take for an answer, beside what its bytes take, s.
    pub fn set_timeout(&mut self, timeout: f64) {
        self.timeout = timeout;
    }
}

/// Whether a packet with this id and code can only have come from a master.
fn is_instruction(protocol: Protocol, (id, code): (u8, u8)) -> bool {
    match protocol {
        Protocol::Dynamixel => code != STATUS,
        Protocol::Feetech => id == BROADCAST,
    }
}
