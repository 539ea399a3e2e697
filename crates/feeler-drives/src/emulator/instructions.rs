//! Execution of instructions by emulated servos.

use super::servo::{EmulatedServo, error};
use super::servos::Servos;
use crate::packet::instruction::{
    FAST_SYNC_READ, PING, READ, REBOOT, STATUS, SYNC_READ, SYNC_WRITE, WRITE,
};
use crate::packet::{BROADCAST, FastBlock, Packet, Protocol, encode, fast_status};

/// A response, with its delay after the instruction, s.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Answer {
    pub delay: f64,
    pub bytes: Vec<u8>,
    /// Id of the sender.
    pub id: u8,
}

impl Servos {
    /// Executes an instruction that arrived at `now`, s. Returns the responses in order.
    pub(super) fn execute(&mut self, packet: Packet<'_>, now: f64) -> Vec<Answer> {
        self.advance(now);
        self.log.instruction(now, packet);
        let broadcast = packet.id == BROADCAST;
        for servo in &mut self.servos {
            if (broadcast || servo.id == packet.id) && servo.is_there(now) {
                servo.hear(now);
            }
        }
        match (packet.code, self.part(packet.parameters)) {
            (SYNC_WRITE, Some((address, length, rest))) => {
                self.sync_write((address, length), rest, now);
                Vec::new()
            }
            (SYNC_READ, Some((address, length, ids))) if self.protocol.has_sync_read() => {
                self.sync_read((address, length), ids, now)
            }
            (FAST_SYNC_READ, Some((address, length, ids)))
                if self.protocol == Protocol::Dynamixel =>
            {
                self.fast_sync_read((address, length), ids, now)
            }
            (SYNC_WRITE | SYNC_READ | FAST_SYNC_READ, _) => Vec::new(),
            _ => self.obey_singly(packet, now),
        }
    }

    /// Splits the parameters of an instruction to several servos into address, length and the remaining bytes.
    fn part<'a>(&self, parameters: &'a [u8]) -> Option<(usize, usize, &'a [u8])> {
        match (self.protocol, parameters) {
            (Protocol::Dynamixel, [a, b, c, d, rest @ ..]) => {
                let word = |low: u8, high: u8| usize::from(u16::from_le_bytes([low, high]));
                Some((word(*a, *b), word(*c, *d), rest))
            }
            (Protocol::Feetech | Protocol::FeetechScs, [address, length, rest @ ..]) => {
                Some((usize::from(*address), usize::from(*length), rest))
            }
            _ => None,
        }
    }

    /// Servo `id`, or `None` if it does not answer at `now`, s.
    fn servo_there(&self, id: u8, now: f64) -> Option<&EmulatedServo> {
        let mut servos = self.servos.iter();
        servos.find(|servo| servo.id == id && servo.is_there(now))
    }

    fn sync_write(&mut self, (address, length): (usize, usize), rest: &[u8], now: f64) {
        for values in rest.chunks_exact(length + 1) {
            for servo in &mut self.servos {
                if servo.id == values[0] && servo.is_there(now) {
                    servo.write(address, &values[1..]);
                }
            }
        }
    }

    /// Sync read: servos answer one after the other. Servos after a silent one wait for it and do not answer.
    fn sync_read(&mut self, part: (usize, usize), ids: &[u8], now: f64) -> Vec<Answer> {
        let mut answers = Vec::new();
        for &id in ids {
            let servo = self.servo_there(id, now);
            let Some(data) = servo.and_then(|servo| servo.read(part.0, part.1)) else {
                break;
            };
            let data = data.to_vec();
            answers.extend(self.answer(id, 0, &data));
        }
        answers
    }

    /// Fast sync read: servos answer in a single packet, which ends at the first silent servo.
    fn fast_sync_read(&mut self, part: (usize, usize), ids: &[u8], now: f64) -> Vec<Answer> {
        let mut delay = 0.0;
        let blocks = ids.iter().map_while(|&id| {
            let servo = self.servo_there(id, now)?;
            let data = servo.read(part.0, part.1)?;
            delay = servo.return_delay().max(delay);
            let error = servo.status(0);
            Some(FastBlock { error, id, data })
        });
        let mut blocks: Vec<_> = blocks.collect();
        let there = blocks.len();
        // The length field counts all addressed servos.
        let nothing = vec![0; part.1];
        let missing = ids[there..].iter().map(|&id| FastBlock {
            error: 0,
            id,
            data: &nothing,
        });
        blocks.extend(missing);
        let mut bytes = Vec::new();
        fast_status(blocks.into_iter(), &mut bytes);
        bytes.truncate(if there == 0 {
            0
        } else {
            8 + there * (part.1 + 4)
        });
        vec![Answer {
            delay,
            bytes,
            id: BROADCAST,
        }]
    }

    /// Executes an instruction to a single servo, or to all. All but SCS servos answer a ping to all.
    fn obey_singly(&mut self, packet: Packet<'_>, now: f64) -> Vec<Answer> {
        let asked = self.servos.iter().filter(|servo| servo.is_there(now));
        let to_all = packet.id == BROADCAST;
        let answers_all = packet.code == PING && self.protocol.has_sync_read();
        let asked = asked.filter(|servo| to_all || servo.id == packet.id);
        let ids: Vec<u8> = asked.map(|servo| servo.id).collect();
        let mut answers = Vec::new();
        for id in ids {
            let Some(servo) = self.servos.iter_mut().find(|servo| servo.id == id) else {
                continue;
            };
            let (error, data) = match self.protocol {
                Protocol::Dynamixel => dynamixel(servo, packet, now),
                Protocol::Feetech | Protocol::FeetechScs => feetech(servo, packet),
            };
            if !to_all || answers_all {
                answers.extend(self.answer(id, error, &data));
            }
        }
        answers
    }

    /// Encodes the response of servo `id`.
    fn answer(&self, id: u8, error: u8, data: &[u8]) -> Option<Answer> {
        let servo = self.servos.iter().find(|servo| servo.id == id)?;
        let status = servo.status(error);
        let mut bytes = Vec::new();
        let made = match self.protocol {
            Protocol::Dynamixel => {
                let parameters: Vec<u8> = [status].iter().chain(data).copied().collect();
                encode(self.protocol, (id, STATUS), &parameters, &mut bytes)
            }
            Protocol::Feetech | Protocol::FeetechScs => {
                encode(self.protocol, (id, status), data, &mut bytes)
            }
        };
        made.ok()?;
        let delay = servo.return_delay();
        Some(Answer { delay, bytes, id })
    }
}

/// Executes an instruction on a Dynamixel. Returns error number and data of its response.
fn dynamixel(servo: &mut EmulatedServo, packet: Packet<'_>, now: f64) -> (u8, Vec<u8>) {
    let word = |low: u8, high: u8| usize::from(u16::from_le_bytes([low, high]));
    match (packet.code, packet.parameters) {
        (PING, _) => {
            let [low, high] = (servo.model.number as u16).to_le_bytes();
            (0, vec![low, high, 46])
        }
        (READ, &[a, b, c, d]) => match servo.read(word(a, b), word(c, d)) {
            Some(data) => (0, data.to_vec()),
            None => (error::ACCESS, Vec::new()),
        },
        (WRITE, &[low, high, ref data @ ..]) => (servo.write(word(low, high), data), Vec::new()),
        (REBOOT, _) => {
            servo.reboot(now);
            (0, Vec::new())
        }
        _ => (error::INSTRUCTION, Vec::new()),
    }
}

/// Executes an instruction on a Feetech servo. Returns error number (always 0) and data of its response.
fn feetech(servo: &mut EmulatedServo, packet: Packet<'_>) -> (u8, Vec<u8>) {
    let data = match (packet.code, packet.parameters) {
        (READ, &[address, length]) => servo.read(address.into(), length.into()),
        (WRITE, &[address, ref data @ ..]) => {
            servo.write(address.into(), data);
            None
        }
        _ => None,
    };
    (0, data.unwrap_or_default().to_vec())
}
