//! Quality of service, and its encoding in liveliness tokens.

/// Default depth of `rmw_zenoh`, which is omitted from tokens.
const DEFAULT_DEPTH: usize = 42;

/// Quality of service of a publisher or subscriber. Deadline, lifespan and liveliness are unlimited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// Handling of lost messages.
    pub reliability: Reliability,
    /// Availability of earlier messages to late subscribers.
    pub durability: Durability,
    /// Number of messages that are kept.
    pub history: History,
}

/// Handling of lost messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reliability {
    /// Lost messages are retransmitted.
    Reliable,
    /// Messages may be lost.
    BestEffort,
}

/// Availability of earlier messages to late subscribers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Durability {
    /// Late subscribers receive the latest messages.
    TransientLocal,
    /// Late subscribers receive no earlier messages.
    Volatile,
}

/// Number of messages that are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum History {
    /// Up to this number of the latest messages.
    KeepLast(usize),
    /// All messages.
    KeepAll,
}

/// Error when decoding a quality of service from a token.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QosError {
    /// Wrong number of parts.
    #[error("quality of service: expected 6 parts separated by colons, got {0}")]
    Parts(usize),
    /// A part has an invalid value.
    #[error("quality of service, {part}: expected {expected}, got {actual:?}")]
    Part {
        /// Name of the part.
        part: &'static str,
        /// Valid values.
        expected: &'static str,
        /// Actual value.
        actual: String,
    },
}

impl Qos {
    /// Default of ROS 2 topics: reliable, volatile, depth 10.
    pub const DEFAULT: Self = Self {
        reliability: Reliability::Reliable,
        durability: Durability::Volatile,
        history: History::KeepLast(10),
    };

    /// Latched topic: reliable, transient local, depth 1. Late subscribers receive the latest message.
    pub const LATCHED: Self = Self {
        durability: Durability::TransientLocal,
        history: History::KeepLast(1),
        ..Self::DEFAULT
    };

    /// Sensor data and `/clock`: best effort, volatile, depth 5.
    pub const SENSOR_DATA: Self = Self {
        reliability: Reliability::BestEffort,
        history: History::KeepLast(5),
        ..Self::DEFAULT
    };

    /// Encodes the quality of service as in tokens. Default values are omitted.
    pub fn encode(&self) -> String {
        let reliability = match self.reliability {
            Reliability::Reliable => "",
            Reliability::BestEffort => "2",
        };
        let durability = match self.durability {
            Durability::TransientLocal => "1",
            Durability::Volatile => "",
        };
        let history = match self.history {
            History::KeepLast(DEFAULT_DEPTH) => ",".into(),
            History::KeepLast(depth) => format!(",{depth}"),
            History::KeepAll => "2,".into(),
        };
        format!("{reliability}:{durability}:{history}:,:,:,,")
    }

    /// Decodes a quality of service from a token. Deadline, lifespan and liveliness are validated, but ignored.
    ///
    /// # Errors
    /// If `text` is invalid.
    pub fn decode(text: &str) -> Result<Self, QosError> {
        let parts: Vec<&str> = text.split(':').collect();
        let [
            reliability,
            durability,
            history,
            deadline,
            lifespan,
            liveliness,
        ] = parts[..]
        else {
            return Err(QosError::Parts(parts.len()));
        };
        let wrong = |part, expected, actual: &str| QosError::Part {
            part,
            expected,
            actual: actual.into(),
        };
        let numbers = |part, text: &str, count| match text.split(',').count() == count
            && text.split(',').all(is_number)
        {
            true => Ok(()),
            false => Err(wrong(part, "numbers separated by commas", text)),
        };
        numbers("deadline", deadline, 2)?;
        numbers("lifespan", lifespan, 2)?;
        numbers("liveliness", liveliness, 3)?;
        let reliability = match reliability {
            "" | "0" | "1" => Reliability::Reliable,
            "2" => Reliability::BestEffort,
            other => return Err(wrong("reliability", "1 or 2", other)),
        };
        let durability = match durability {
            "1" => Durability::TransientLocal,
            "" | "0" | "2" => Durability::Volatile,
            other => return Err(wrong("durability", "1 or 2", other)),
        };
        let history = match history.split_once(',') {
            Some(("2", depth)) if is_number(depth) => History::KeepAll,
            Some(("" | "0" | "1", "" | "0")) => History::KeepLast(DEFAULT_DEPTH),
            Some(("" | "0" | "1", depth)) => {
                let depth = depth.parse();
                History::KeepLast(depth.map_err(|_| wrong("history", "a depth", history))?)
            }
            _ => return Err(wrong("history", "1 or 2, and a depth", history)),
        };
        Ok(Self {
            reliability,
            durability,
            history,
        })
    }
}

/// Returns `true` if `text` is empty or a number.
fn is_number(text: &str) -> bool {
    text.is_empty() || text.parse::<u64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_values_are_omitted() {
        assert_eq!(Qos::DEFAULT.encode(), "::,10:,:,:,,");
        assert_eq!(Qos::LATCHED.encode(), ":1:,1:,:,:,,");
        assert_eq!(Qos::SENSOR_DATA.encode(), "2::,5:,:,:,,");
    }

    #[test]
    fn encoded_texts_decode_and_invalid_ones_are_rejected() {
        let all = Qos {
            history: History::KeepAll,
            ..Qos::DEFAULT
        };
        let usual = Qos {
            history: History::KeepLast(DEFAULT_DEPTH),
            ..Qos::LATCHED
        };
        for qos in [Qos::DEFAULT, Qos::LATCHED, Qos::SENSOR_DATA, all, usual] {
            assert_eq!(Qos::decode(&qos.encode()), Ok(qos));
        }
        let explicit = Qos::decode("1:2:1,10:9223372036,854775807:,:1,2,3");
        assert_eq!(explicit, Ok(Qos::DEFAULT));
        for text in [
            "",
            "::,10",
            "3::,10:,:,:,,",
            "::x:,:,:,,",
            "::,-1:,:,:,,",
            "::,1:,x:,:,,",
            "::,1:,:,:,",
        ] {
            assert!(Qos::decode(text).is_err(), "{text}");
        }
    }
}
