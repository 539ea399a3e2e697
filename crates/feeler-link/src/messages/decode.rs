//! Decoding of received messages.

use super::message::{Heartbeat, NO_FINGER, PROTOCOL};
use super::printable;
use super::rejection::Rejection;
use feeler_record::wire::{Message, cdr};

/// Decodes a message.
///
/// # Errors
/// Returns [`Rejection::Malformed`] if `bytes` is not a valid message of type `M`.
pub fn read<M: Message>(bytes: &[u8]) -> Result<M, Rejection> {
    cdr::decode(bytes).map_err(|_| Rejection::Malformed)
}

/// Decodes and validates a heartbeat. For another protocol version, only the fields common to all versions are read.
pub(crate) fn read_heartbeat(bytes: &[u8]) -> Result<Heartbeat, Rejection> {
    if !bytes.starts_with(&cdr::ENCAPSULATION) {
        return Err(Rejection::Malformed);
    }
    let field = |at: usize, length: usize| bytes.get(at..at + length);
    let protocol = field(4, 4).and_then(|b| Some(u32::from_le_bytes(b.try_into().ok()?)));
    let protocol = protocol.ok_or(Rejection::Malformed)?;
    if protocol == PROTOCOL {
        let mut heartbeat: Heartbeat = read(bytes)?;
        let finite = [heartbeat.rate, heartbeat.speed];
        if !finite.iter().all(|n| n.is_finite()) {
            return Err(Rejection::NotFinite);
        }
        if heartbeat.speed < 0.0 {
            return Err(Rejection::Implausible);
        }
        let Heartbeat {
            version,
            experiment,
            fingertip,
            fault,
            ..
        } = &heartbeat;
        let texts = [
            heartbeat.program.as_str(),
            version,
            experiment,
            fingertip,
            fault,
        ];
        if texts.iter().any(|text| text.len() > printable::MAX_BYTES) {
            return Err(Rejection::Oversized);
        }
        for shown in [&mut heartbeat.version, &mut heartbeat.fault] {
            *shown = printable::printable(shown);
        }
        return Ok(heartbeat);
    }
    let instance = field(12, 8).and_then(|b| Some(u64::from_le_bytes(b.try_into().ok()?)));
    Ok(Heartbeat {
        protocol,
        instance: instance.ok_or(Rejection::Malformed)?,
        program: "a program".into(),
        version: "of another version".into(),
        finger: NO_FINGER,
        sequence: 1,
        ..Heartbeat::default()
    })
}
