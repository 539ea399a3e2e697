//! Quality of service, and its encoding in liveliness tokens.

/// Default depth of `rmw_zenoh`; tokens omit it.
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

    /// Encodes the quality of service in the format of liveliness tokens. Default values are omitted.
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_values_are_omitted() {
        assert_eq!(Qos::DEFAULT.encode(), "::,10:,:,:,,");
        assert_eq!(Qos::LATCHED.encode(), ":1:,1:,:,:,,");
        assert_eq!(Qos::SENSOR_DATA.encode(), "2::,5:,:,:,,");
        let of_history = |history| Qos {
            history,
            ..Qos::DEFAULT
        };
        assert_eq!(of_history(History::KeepAll).encode(), "::2,:,:,:,,");
        let usual = of_history(History::KeepLast(DEFAULT_DEPTH));
        assert_eq!(usual.encode(), "::,:,:,:,,");
    }
}
