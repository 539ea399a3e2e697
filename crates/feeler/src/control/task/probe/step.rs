//! Steps of the probing task.

use crate::control::phase::Phase;

/// Step of the probing task. All fingers perform it together.
///
/// Recordings contain the numeric value as the measured quantity `step`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Step {
    /// Rests at home, to measure the noise of the forces.
    #[default]
    Rest = 0,
    /// Moves to a place, away from the object.
    Travel = 1,
    /// Moves towards the object until contact.
    Approach = 2,
    /// Presses slowly into the object.
    Press = 3,
    /// Releases slowly to the sliding force.
    Release = 4,
    /// Presses into the object, twice as fast.
    PressFast = 5,
    /// Shears along the object's axis while the elements stick.
    Shear = 6,
    /// Shears back to the start.
    ShearBack = 7,
    /// Releases to the sliding force, twice as fast.
    Ease = 8,
    /// Slides along the object's axis.
    Slide = 9,
    /// Retracts from the object.
    Retract = 10,
    /// Returns home.
    Home = 11,
    /// Rests at home; the task has ended.
    Done = 12,
}

impl Step {
    /// All steps, in the order of their numbers.
    pub const ALL: [Self; 13] = [
        Self::Rest,
        Self::Travel,
        Self::Approach,
        Self::Press,
        Self::Release,
        Self::PressFast,
        Self::Shear,
        Self::ShearBack,
        Self::Ease,
        Self::Slide,
        Self::Retract,
        Self::Home,
        Self::Done,
    ];

    /// Next step; [`Done`](Self::Done) is the last one and returns itself.
    pub(super) fn next(self) -> Self {
        let next = Self::ALL.get(self as usize + 1);
        next.copied().unwrap_or(Self::Done)
    }

    /// Phase of the task during this step.
    pub(super) fn phase(self) -> Phase {
        match self {
            Self::Rest | Self::Approach => Phase::Search,
            Self::Retract => Phase::Release,
            Self::Travel | Self::Home => Phase::Return,
            Self::Done => Phase::Done,
            _ => Phase::Move,
        }
    }
}
