//! Faults of an emulated bus.

use rand::RngExt;
use rand_pcg::Pcg64;
use std::str::FromStr;

/// A fault to inject into an emulated bus, effective from then on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BusFault {
    /// Corrupts this fraction of all bytes, in both directions.
    FlipBytes(f64),
    /// Drops this fraction of all bytes.
    LoseBytes(f64),
    /// The adapter echoes sent bytes.
    Echo,
    /// The servo with this id no longer answers.
    Silent(u8),
    /// The servo with this id restarts: it is silent for a while, then has default values and no torque.
    Reboot(u8),
    /// The master is disconnected; the servos keep running.
    CablePulled,
    /// Delays responses by this duration, s.
    Late(f64),
    /// The adapter delivers responses only at multiples of this duration, s, like a USB adapter with this latency
    /// timer.
    Latency(f64),
    /// The servo with this id overheats.
    Overheat(u8),
    /// The supply voltage of the servo with this id drops.
    Undervoltage(u8),
    /// The servo with this id reports these fault bits and switches its torque off.
    Hardware(u8, u8),
    /// An external torque (N m) acts on the horn of the servo with this id, against positive motion.
    Load(u8, f64),
    /// The encoder of the servo with this id jumps by two turns.
    Jump(u8),
}

/// All kinds of faults, in the syntax of the command line.
const KINDS: &str = "flip-bytes=SHARE, lose-bytes=SHARE, echo, silent=ID, reboot=ID, cable-pulled, late=SECONDS, \
                     latency=SECONDS, overheat=ID, undervoltage=ID, hardware=ID[:BITS], jump=ID, load=ID:TORQUE";
/// Fault bits of an overload, the default of `hardware=ID`.
const OVERLOAD: u8 = 0x20;
/// Maximum external torque, N m.
const MOST_LOAD: f64 = 100.0;

impl BusFault {
    /// Id of the servo that the fault affects, or `None` if it affects the bus.
    pub fn servo(&self) -> Option<u8> {
        match *self {
            Self::Silent(id)
            | Self::Reboot(id)
            | Self::Overheat(id)
            | Self::Undervoltage(id)
            | Self::Hardware(id, _)
            | Self::Load(id, _)
            | Self::Jump(id) => Some(id),
            Self::FlipBytes(_)
            | Self::LoseBytes(_)
            | Self::Echo
            | Self::CablePulled
            | Self::Late(_)
            | Self::Latency(_) => None,
        }
    }
}

impl FromStr for BusFault {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, value) = text.split_once('=').unwrap_or((text, ""));
        let up_to = |most: f64, expected: &str| {
            let number = value.parse::<f64>().ok();
            let number = number.filter(|number| (0.0..=most).contains(number));
            number.ok_or_else(|| format!("{text:?}: expected {expected}"))
        };
        let share = || up_to(1.0, "a share from 0 to 1");
        let id_in = |value: &str| {
            let id = value.parse::<u8>().ok();
            id.ok_or_else(|| format!("{text:?}: expected the id of a servo, 0 to 252"))
        };
        let id = || id_in(value);
        let (first, second) = value.split_once(':').unwrap_or((value, ""));
        match kind {
            "flip-bytes" => share().map(Self::FlipBytes),
            "lose-bytes" => share().map(Self::LoseBytes),
            "late" => up_to(60.0, "a time from 0 to 60 s").map(Self::Late),
            "latency" => up_to(1.0, "a time from 0 to 1 s").map(Self::Latency),
            "silent" => id().map(Self::Silent),
            "reboot" => id().map(Self::Reboot),
            "overheat" => id().map(Self::Overheat),
            "undervoltage" => id().map(Self::Undervoltage),
            "hardware" if first == value => id().map(|id| Self::Hardware(id, OVERLOAD)),
            "hardware" => {
                let bits = second.parse::<u8>().ok().filter(|&bits| bits != 0);
                let bits =
                    bits.ok_or_else(|| format!("{text:?}: expected fault bits, 1 to 255"))?;
                Ok(Self::Hardware(id_in(first)?, bits))
            }
            "load" => {
                let torque = second.parse::<f64>().ok();
                let torque = torque.filter(|torque| torque.abs() <= MOST_LOAD);
                let expected = || format!("{text:?}: expected a torque from -100 to 100 N m");
                Ok(Self::Load(id_in(first)?, torque.ok_or_else(expected)?))
            }
            "jump" => id().map(Self::Jump),
            "echo" if value.is_empty() => Ok(Self::Echo),
            "cable-pulled" if value.is_empty() => Ok(Self::CablePulled),
            _ => Err(format!("{text:?}: expected one of {KINDS}")),
        }
    }
}

/// Random byte errors on the wire.
#[derive(Debug, Clone)]
pub(super) struct Wire {
    pub flipped: f64,
    pub lost: f64,
    pub random: Pcg64,
}

impl Wire {
    /// Corrupts and drops `bytes` at random.
    pub fn carry(&mut self, bytes: &mut Vec<u8>) {
        let (lost, flipped, random) = (self.lost, self.flipped, &mut self.random);
        if lost > 0.0 {
            bytes.retain(|_| !random.random_bool(lost));
        }
        if flipped > 0.0 {
            for byte in bytes {
                if random.random_bool(flipped) {
                    *byte ^= 1 << random.random_range(0..8);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_faults() {
        assert_eq!("flip-bytes=0.01".parse(), Ok(BusFault::FlipBytes(0.01)));
        assert_eq!("silent=3".parse(), Ok(BusFault::Silent(3)));
        assert_eq!("cable-pulled".parse(), Ok(BusFault::CablePulled));
        assert_eq!("hardware=3".parse(), Ok(BusFault::Hardware(3, 0x20)));
        assert_eq!("hardware=3:4".parse(), Ok(BusFault::Hardware(3, 4)));
        assert_eq!("load=2:-0.1".parse(), Ok(BusFault::Load(2, -0.1)));
        assert_eq!("latency=0.016".parse(), Ok(BusFault::Latency(0.016)));
        for wrong in [
            "",
            "silent",
            "silent=300",
            "echo=1",
            "flip-bytes=2",
            "late=-1",
            "latency=2",
            "hardware=3:0",
            "hardware=3:",
            "hardware=:1",
            "load=3",
            "load=3:NaN",
            "load=:0.1",
            "fire",
        ] {
            let said = wrong.parse::<BusFault>().unwrap_err();
            assert!(said.contains("expected"), "{said}");
        }
    }
}
