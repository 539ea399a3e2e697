//! Quality of service, and its short form in a liveliness token.

/// Messages that are kept where nobody says how many: `rmw_zenoh` leaves this number out of tokens.
const DEFAULT_DEPTH: usize = 42;

/// What a publisher promises and a subscriber asks for. Deadline, lifespan and liveliness are without limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// Whether messages may be lost.
    pub reliability: Reliability,
    /// Whether who comes late gets what was said before.
    pub durability: Durability,
    /// How many messages are kept.
    pub history: History,
}

/// Whether messages may be lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reliability {
    /// They are sent again.
    Reliable,
    /// They may be lost.
    BestEffort,
}

/// Whether who comes late gets what was said before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Durability {
    /// He gets the newest messages.
    TransientLocal,
    /// He gets nothing.
    Volatile,
}

/// How many messages are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum History {
    /// So many.
    KeepLast(usize),
    /// All.
    KeepAll,
}

/// Why a token's quality of service could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QosError {
    /// It has another number of parts.
    #[error("quality of service: 6 parts between colons expected, found {0}")]
    Parts(usize),
    /// A part is none of what it can be.
    #[error("quality of service, {part}: {expected} expected, found {actual:?}")]
    Part {
        /// Which one.
        part: &'static str,
        /// What it can be.
        expected: &'static str,
        /// What it is.
        actual: String,
    },
}

impl Qos {
    /// What topics have unless said otherwise: reliable, nothing for who comes late, the last 10.
    pub const DEFAULT: Self = Self {
        reliability: Reliability::Reliable,
        durability: Durability::Volatile,
        history: History::KeepLast(10),
    };

    /// Reliable, and who comes late gets the newest message.
    pub const LATCHED: Self = Self {
        durability: Durability::TransientLocal,
        history: History::KeepLast(1),
        ..Self::DEFAULT
    };

    /// As tools publish `/clock`, and sensors their data: only the newest count.
    pub const SENSOR_DATA: Self = Self {
        reliability: Reliability::BestEffort,
        history: History::KeepLast(5),
        ..Self::DEFAULT
    };

    /// The short form: what is as usual is left out.
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

    /// Reads the short form. Deadline, lifespan and liveliness are checked to be numbers, and left.
    ///
    /// # Errors
    /// What is wrong with `text`.
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
            false => Err(wrong(part, "numbers between commas", text)),
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

/// Whether `text` is a number or nothing.
fn is_number(text: &str) -> bool {
    text.is_empty() || text.parse::<u64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_usual_is_left_out() {
        assert_eq!(Qos::DEFAULT.encode(), "::,10:,:,:,,");
        assert_eq!(Qos::LATCHED.encode(), ":1:,1:,:,:,,");
        assert_eq!(Qos::SENSOR_DATA.encode(), "2::,5:,:,:,,");
    }

    #[test]
    fn what_is_written_is_read_and_nonsense_refused() {
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
