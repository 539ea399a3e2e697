//! What can happen in a control period.

use super::rig::Rig;

/// A control period: what happens in it, and what becomes of the messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    pub happening: Happening,
    pub fate: Fate,
}

/// Something that programs or people do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Happening {
    Nothing,
    /// The rig's program is killed.
    KillRig,
    /// It starts again.
    StartRig,
    KillSensor,
    StartSensor,
    /// The first hand is killed.
    KillHand,
    /// It hangs, and goes on later: its clock goes on meanwhile.
    FreezeHand,
    ThawHand,
    /// The second hand starts.
    StartSecondHand,
    /// Somebody stops the hand.
    Stop,
    /// Somebody resumes the oldest stop.
    Resume,
    /// Somebody resumes a number that is not in force.
    ResumeAnother,
    /// Everything that was ever said to the hands, as far as it is kept, is said again.
    Replay,
}

impl Happening {
    /// What can happen to `rig`.
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

/// A way that messages take.
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

/// What becomes of the messages of a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// All come within it.
    Calm,
    /// Those of a channel are held back, to come with those of a later period.
    Held(Channel),
    /// Those of a channel are lost.
    Lost(Channel),
    /// Those of a channel come twice, the newest first.
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
