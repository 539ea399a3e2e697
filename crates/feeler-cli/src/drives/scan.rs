//! The `feeler drives scan` subcommand.

use super::ScanArguments;
use crate::{CommandError, Outcome};
use feeler_console::Steps;
use feeler_drives::RigClock;
use feeler_drives::bus::{Bus, BusError};
use feeler_drives::packet::Protocol;
use feeler_drives::registers::{Model, Registers};
use std::io::Write;
use std::ops::RangeInclusive;

/// Part (address, length) of a Feetech servo's control table with the flag of big-endian values and the major version of
/// the model.
const BYTE_ORDER_AND_VERSION: (u16, usize) = (2, 2);
/// Major version of models of the SCS series.
const SCS_VERSION: u8 = 5;
/// Baud rates that servos commonly use.
const USUAL: [u32; 5] = [1_000_000, 57_600, 4_000_000, 2_000_000, 115_200];

pub fn scan(arguments: &ScanArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let protocols = match arguments.protocol.as_deref() {
        Some("feetech") => vec![Protocol::Feetech],
        Some(_) => vec![Protocol::Dynamixel],
        None => vec![Protocol::Dynamixel, Protocol::Feetech],
    };
    let rates = arguments
        .baud_rate
        .map_or(USUAL.to_vec(), |rate| vec![rate]);
    let combinations = rates
        .iter()
        .flat_map(|&rate| protocols.iter().map(move |&protocol| (protocol, rate)));
    if arguments.dry_run {
        for (protocol, rate) in combinations {
            let (port, most) = (&arguments.port, arguments.largest_id);
            writeln!(
                out,
                "would ping {} servos 0 to {most} on {port} at {rate} Bd; writes nothing",
                protocol.name()
            )?;
        }
        return Ok(Outcome::Done);
    }
    let pings = combinations
        .clone()
        .map(|(protocol, _)| ids(arguments, protocol).count());
    let progress = Steps::new(pings.sum());
    let mut found = 0;
    for how in combinations {
        found += scan_at(arguments, how, &progress, out)?;
    }
    drop(progress);
    if found == 0 {
        let advice = "check the power supply, the cable and the port";
        writeln!(out, "no servo found; {advice}")?;
        return Ok(Outcome::GivenUp);
    }
    Ok(Outcome::Done)
}

/// Ids to ping.
fn ids(arguments: &ScanArguments, protocol: Protocol) -> RangeInclusive<u8> {
    0..=arguments.largest_id.min(protocol.largest_id())
}

/// Pings all ids with this protocol and baud rate; returns the number of servos that reply.
fn scan_at(
    arguments: &ScanArguments,
    how: (Protocol, u32),
    progress: &Steps,
    out: &mut dyn Write,
) -> Result<usize, CommandError> {
    let (protocol, rate) = how;
    let mut bus = Bus::open(&arguments.port, how, arguments.timeout, RigClock::real())?;
    let mut found = 0;
    for id in ids(arguments, protocol) {
        let answer = bus.ping(id);
        progress.advance();
        let said = match answer {
            Err(BusError::NoReply { .. }) => continue,
            Err(error) => Err(error),
            Ok(()) => {
                found += 1;
                describe(&mut bus, id)
            }
        };
        let line = match said {
            Ok((protocol, said)) => format!("{}: servo {id}, {said}", protocol.name()),
            Err(error @ (BusError::Port(_) | BusError::Echo)) => return Err(error.into()),
            // Something is connected: two servos with one id, another baud rate or a loose cable.
            Err(error) => format!("{}: {error}", protocol.name()),
        };
        progress.suspend(|| writeln!(out, "{rate} Bd, {line}"))?;
    }
    Ok(found)
}

/// Describes a servo by its registers. Also returns its protocol, because both Feetech series use the same packets.
fn describe(bus: &mut Bus, id: u8) -> Result<(Protocol, String), BusError> {
    let protocol = match bus.protocol() {
        Protocol::Feetech if is_scs(bus, id)? => Protocol::FeetechScs,
        protocol => protocol,
    };
    let registers = Registers::of(protocol);
    let number = bus.read(id, registers.model)?;
    let model = Model::numbered(protocol, number);
    let name = model.map_or("unknown model", |model| model.name);
    let volts = bus.read(id, registers.voltage)? as f64 / 10.0;
    let degrees = bus.read(id, registers.temperature)?;
    let position = bus.read(id, registers.position)?;
    let said = format!(
        "{name} (model {number}), {volts:.1} V, {degrees} degrees Celsius, at {position} counts"
    );
    Ok((protocol, said))
}

/// Returns `true` if a Feetech servo is of the SCS series, by its flag of big-endian values, or, as older ones have none,
/// by the major version of its model.
fn is_scs(bus: &mut Bus, id: u8) -> Result<bool, BusError> {
    let bytes = bus.read_bytes(id, BYTE_ORDER_AND_VERSION)?;
    Ok(matches!(bytes, [1, ..] | [_, SCS_VERSION]))
}
