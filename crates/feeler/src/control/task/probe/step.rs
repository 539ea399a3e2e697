//! Steps of the probing routine.

use crate::control::phase::Phase;

/// A step of the probing routine, which all fingers perform together.
///
/// Recordings store the numeric value as the finding `step`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Step {
    /// Rests at home, to measure the noise of the forces.
    #[default]
    Rest = 0,
    /// Moves to a place, off the object.
    Travel = 1,
    /// Moves towards the object until it touches.
    Approach = 2,
    /// Presses slowly.
    Press = 3,
    /// Releases slowly.
    Release = 4,
    /// Presses twice as fast.
    PressFast = 5,
    /// Shears along the object's axis while the elements stick.
    Shear = 6,
    /// Shears back.
    ShearBack = 7,
    /// Releases twice as fast, to the sliding force.
    Ease = 8,
    /// Slides along the object's axis.
    Slide = 9,
    /// Leaves the object.
    Retract = 10,
    /// Returns home.
    Home = 11,
    /// Rests at home; the routine is over.
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

    /// Phase of the task in this step.
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
