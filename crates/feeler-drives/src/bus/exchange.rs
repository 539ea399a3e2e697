//! Exchange of one instruction packet and its response packets.

use super::{ALERT, BITS_PER_BYTE, Bus, BusError};
use crate::packet::instruction::STATUS;
use crate::packet::{BROADCAST, Decoder, Protocol, encode};

/// Deadline of a response.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deadline {
    /// Time of the deadline on the rig's clock, s.
    at: f64,
    /// Timeout when the request was sent, s.
    time: f64,
}

impl Bus {
    /// Waits for the response of servo `id` with `length` bytes of data. Returns its error byte and data. Skips other
    /// responses, which may be late answers to earlier requests on a busy computer.
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
            // Also ends the wait on a bus that is never silent.
            if self.clock.now() >= deadline.at {
                return Err(unexpected(passed_over));
            }
        };
        let waited = self.clock.now() - (deadline.at - self.timeout);
        self.latency.add(waited.max(0.0));
        if is_refused {
            let what = "a reading";
            return Err(BusError::Refused { id, what, error });
        }
        let (_, data) = error_and_data(protocol, error, self.decoder.parameters());
        Ok((error, data))
    }

    /// Waits for the next packet and returns its id and code; the decoder contains its parameters. Errors are
    /// attributed to the servo returned by `blamed`.
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

    /// Returns `true` if the received bytes begin with the sent bytes, which never happens without an echo.
    fn is_echo(&self) -> bool {
        let (sent, arrived) = (&self.sent, self.decoder.pending());
        !sent.is_empty() && arrived.len() >= sent.len() && arrived.starts_with(sent)
    }

    /// Sends instruction `code` with the buffered parameters to servo `id`. Discards responses to earlier requests.
    pub(super) fn send(&mut self, id: u8, code: u8) -> Result<(), BusError> {
        encode(self.protocol, (id, code), &self.parameters, &mut self.sent)?;
        self.port.discard_input()?;
        self.decoder.clear();
        self.port.send(&self.sent)?;
        Ok(())
    }

    /// Returns the deadline for a response of `bytes` bytes to the packet just sent.
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
            Protocol::Feetech | Protocol::FeetechScs => self.parameters.push(length as u8),
        }
    }

    pub(super) fn push_address(&mut self, address: u16) {
        match self.protocol {
            Protocol::Dynamixel => self.parameters.extend(address.to_le_bytes()),
            Protocol::Feetech | Protocol::FeetechScs => self.parameters.push(address as u8),
        }
    }
}

/// Splits a response into error byte and data.
fn error_and_data(protocol: Protocol, code: u8, parameters: &[u8]) -> (u8, &[u8]) {
    match (protocol, parameters) {
        (Protocol::Dynamixel, [error, data @ ..]) => (*error, data),
        _ => (code, parameters),
    }
}

/// Returns `true` if a packet with this id and code can only come from a master.
fn is_instruction(protocol: Protocol, (id, code): (u8, u8)) -> bool {
    match protocol {
        Protocol::Dynamixel => code != STATUS,
        Protocol::Feetech | Protocol::FeetechScs => id == BROADCAST,
    }
}
