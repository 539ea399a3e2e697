//! One packet out, and the packets that answer it.

use super::{ALERT, BITS_PER_BYTE, Bus, BusError};
use crate::packet::instruction::STATUS;
use crate::packet::{BROADCAST, Decoder, Protocol, encode};

/// Until when an answer must be there, and how long that was when it was asked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deadline {
    /// s of the rig's time.
    at: f64,
    /// s
    time: f64,
}

impl Bus {
    /// Error byte and data, `length` bytes, of the answer of servo `id`. Other answers are passed over: a busy computer may have been told
    /// of them too late for the question that they are to.
    pub(super) fn status(
        &mut self,
        id: u8,
        length: usize,
        deadline: Deadline,
    ) -> Result<(u8, &[u8]), BusError> {
        let protocol = self.protocol;
        let unexpected = |(actual_id, actual)| BusError::Unexpected {
            id,
            expected: length,
            actual_id,
            actual,
        };
        let mut other = None;
        let (error, is_refused) = loop {
            let (actual_id, code) = match (self.packet(|_| id, deadline), other) {
                (Ok(packet), _) => packet,
                (Err(BusError::NoReply { .. }), Some(other)) => return Err(unexpected(other)),
                (Err(error), _) => return Err(error),
            };
            let (error, data) = error_and_data(protocol, code, self.decoder.parameters());
            let refused = data.is_empty() && error & !ALERT != 0 && protocol == Protocol::Dynamixel;
            if actual_id == id && (data.len() == length || refused) {
                break (error, refused && length > 0);
            }
            let passed_over = *other.get_or_insert((actual_id, data.len()));
            // Of a bus that is never silent, too, nobody waits for longer.
            if self.clock.now() >= deadline.at {
                return Err(unexpected(passed_over));
            }
        };
        if is_refused {
            let what = "a reading";
            return Err(BusError::Refused { id, what, error });
        }
        let (_, data) = error_and_data(protocol, error, self.decoder.parameters());
        Ok((error, data))
    }

    /// Id and code of the next packet, whose parameters the decoder has. What is wrong is laid to whom `blamed` says.
    pub(super) fn packet(
        &mut self,
        blamed: impl Fn(&Decoder) -> u8,
        deadline: Deadline,
    ) -> Result<(u8, u8), BusError> {
        let mut buffer = [0; 256];
        while !self.decoder.has_packet() {
            let received = self.port.receive(&mut buffer, deadline.at)?;
            if received == 0 {
                let (id, pending) = (blamed(&self.decoder), self.decoder.pending().len());
                let waited = deadline.time;
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
            Some(Ok(packet)) => Ok((packet.id, packet.code)),
            Some(Err(source)) => Err(BusError::Damaged { id, source }),
            None => Err(BusError::NoReply {
                id,
                waited: deadline.time,
            }),
        }
    }

    /// Whether what arrived begins with what was sent: no answer does.
    fn is_echo(&self) -> bool {
        let (sent, arrived) = (&self.sent, self.decoder.pending());
        !sent.is_empty() && arrived.len() >= sent.len() && arrived.starts_with(sent)
    }

    /// Sends what is in `parameters`; answers to older questions do not count any more.
    pub(super) fn send(&mut self, id: u8, code: u8) -> Result<(), BusError> {
        encode(self.protocol, (id, code), &self.parameters, &mut self.sent)?;
        self.port.discard_input()?;
        self.decoder.clear();
        self.port.send(&self.sent)?;
        Ok(())
    }

    /// The deadline of an answer of so many bytes to what was just sent.
    pub(super) fn deadline(&self, bytes: usize) -> Deadline {
        let on_wire = (self.sent.len() + bytes) as f64 * BITS_PER_BYTE / f64::from(self.baud_rate);
        let time = self.timeout + on_wire;
        let at = self.clock.now() + time;
        Deadline { at, time }
    }

    pub(super) fn name_part(&mut self, (address, length): (u16, usize)) {
        self.parameters.clear();
        self.push_address(address);
        match self.protocol {
            Protocol::Dynamixel => self.parameters.extend((length as u16).to_le_bytes()),
            Protocol::Feetech => self.parameters.push(length as u8),
        }
    }

    pub(super) fn push_address(&mut self, address: u16) {
        match self.protocol {
            Protocol::Dynamixel => self.parameters.extend(address.to_le_bytes()),
            Protocol::Feetech => self.parameters.push(address as u8),
        }
    }
}

/// Error byte and data of an answer with these parameters.
fn error_and_data(protocol: Protocol, code: u8, parameters: &[u8]) -> (u8, &[u8]) {
    match (protocol, parameters) {
        (Protocol::Dynamixel, [error, data @ ..]) => (*error, data),
        _ => (code, parameters),
    }
}

/// Whether a packet with this id and code can only have come from a master.
fn is_instruction(protocol: Protocol, (id, code): (u8, u8)) -> bool {
    match protocol {
        Protocol::Dynamixel => code != STATUS,
        Protocol::Feetech => id == BROADCAST,
    }
}
