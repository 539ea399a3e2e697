//! Events and message faults of a control period.

use super::rig::Rig;

/// A control period, with its event and the fate of its messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    pub happening: Happening,
    pub fate: Fate,
}

/// Action of a program or an operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Happening {
    Nothing,
    /// The rig program is killed.
    KillRig,
    /// The rig program is restarted.
    StartRig,
    KillSensor,
    StartSensor,
    /// The first hand is killed.
    KillHand,
    /// The first hand hangs. Its clock continues.
    FreezeHand,
    ThawHand,
    /// The second hand starts.
    StartSecondHand,
    /// An operator stops the hand.
    Stop,
    /// An operator resumes the oldest stop.
    Resume,
    /// An operator resumes a number that is not active.
    ResumeAnother,
    /// All stored messages to the hands are sent again.
    Replay,
}

impl Happening {
    /// Events that are possible for `rig`.
    pub fn all(rig: &Rig) -> impl Iterator<Item = Self> + use<> {
        let possible = [
            (Self::Nothing, true),
            (Self::KillRig, rig.has_rig()),
            (Self::StartRig, !rig.has_rig()),
            (Self::KillSensor, rig.has_sensor()),
            (Self::StartSensor, !rig.has_sensor()),
            (Self::KillHand, rig.has_first_hand()),
            (Self::FreezeHand, rig.has_first_hand() && !rig.is_frozen()),
            (Self::ThawHand, rig.is_frozen()),
            (Self::StartSecondHand, !rig.has_second_hand()),
            (Self::Stop, rig.stops_said() < 3),
            (Self::Resume, true),
            (Self::ResumeAnother, true),
            (Self::Replay, true),
        ];
        possible
            .into_iter()
            .filter_map(|(happening, can)| can.then_some(happening))
    }
}

/// Kind of messages that a fault affects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Joint states, to the hands.
    States,
    /// Forces, to the hands.
    Forces,
    /// Commands, to the rig.
    Commands,
    /// Modes, to rig and sensor.
    Modes,
    /// Heartbeats of all programs.
    Heartbeats,
    /// Stops and resumes.
    Orders,
}

impl Channel {
    pub const ALL: [Self; 6] = [
        Self::States,
        Self::Forces,
        Self::Commands,
        Self::Modes,
        Self::Heartbeats,
        Self::Orders,
    ];
}

/// Fate of the messages in a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// All are delivered in the period.
    Calm,
    /// Messages of a channel are delayed to a later period.
    Held(Channel),
    /// Messages of a channel are lost.
    Lost(Channel),
    /// Messages of a channel are delivered twice, first in reverse order.
    Twice(Channel),
}

impl Fate {
    pub fn disturbed() -> impl Iterator<Item = Self> {
        let channels = Channel::ALL.into_iter();
        channels.flat_map(|channel| {
            [
                Self::Held(channel),
                Self::Lost(channel),
                Self::Twice(channel),
            ]
        })
    }
}
