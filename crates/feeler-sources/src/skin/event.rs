//! Events that an emulated skin simulates: loads, fields and faults.

use std::str::FromStr;

/// A load, a field or a fault of an emulated skin, effective from then on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SkinEvent {
    /// Presses the middle of the skin: reading of the nearest taxel in counts, 0 to release it.
    Press(f64),
    /// Uniform magnetic field (x, y tangential, z outward), µT. Only magnetometers measure it.
    Field([f64; 3]),
    /// Drops this fraction of all bytes.
    LoseBytes(f64),
    /// Changes a bit of this fraction of all bytes.
    FlipBytes(f64),
    /// Sends nothing for this duration, s.
    Silent(f64),
    /// Removes the port for this duration, s.
    Unplug(f64),
}

/// All kinds of events, in the syntax of the command line.
const KINDS: &str =
    "press=COUNTS, field=X,Y,Z, lose-bytes=SHARE, flip-bytes=SHARE, silent=SECONDS, unplug=SECONDS";

impl FromStr for SkinEvent {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, value) = text.split_once('=').unwrap_or((text, ""));
        let between = |text: &str, low: f64, high: f64| {
            let number = text.parse::<f64>().ok();
            number.filter(|number| (low..=high).contains(number))
        };
        let event = match kind {
            "press" => between(value, -1e6, 1e6).map(Self::Press),
            "field" => {
                let parts = value.split(',').map(|part| between(part, -1e5, 1e5));
                let parts: Option<Vec<_>> = parts.collect();
                parts.and_then(|p| p.try_into().ok()).map(Self::Field)
            }
            "lose-bytes" => between(value, 0.0, 1.0).map(Self::LoseBytes),
            "flip-bytes" => between(value, 0.0, 1.0).map(Self::FlipBytes),
            "silent" => between(value, 0.0, 3600.0).map(Self::Silent),
            "unplug" => between(value, 0.0, 3600.0).map(Self::Unplug),
            _ => None,
        };
        event.ok_or_else(|| {
            format!("{text:?}: expected one of {KINDS}, with shares from 0 to 1 and at most 3600 s")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_events() {
        assert_eq!("press=200".parse(), Ok(SkinEvent::Press(200.0)));
        let field = SkinEvent::Field([30.0, 0.0, -40.0]);
        assert_eq!("field=30,0,-40".parse(), Ok(field));
        assert_eq!("lose-bytes=0.01".parse(), Ok(SkinEvent::LoseBytes(0.01)));
        assert_eq!("unplug=1.5".parse(), Ok(SkinEvent::Unplug(1.5)));
        let wrong =
            "|press|press=x|press=nan|field=1,2|field=1,2,3,4|lose-bytes=2|silent=-1|fire=1";
        for wrong in wrong.split('|') {
            let error = wrong.parse::<SkinEvent>().unwrap_err();
            assert!(error.contains("expected one of press"), "{error}");
        }
    }
}
