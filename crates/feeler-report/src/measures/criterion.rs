//! Success criteria of runs, depending on task, hand and law.

use crate::claims::any_hand::{CLOSES_CAP, OVERLOADS_NOTHING};
use crate::claims::hand::NO_DAMAGE;
use crate::tasks::papers_setup::{PAPERS_STROKES, claims_apply, is_papers_hand};
use feeler_record::{RunFacts, TaskKind};
use serde::{Serialize, Serializer};

/// Criterion for the success of a completed run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// All claims of the task. If the paper's hand screws a cap under the paper's law, these are the paper's claims.
    Claims,
    /// All claims about any hand. Applies if a cap is screwed under another law than the paper's.
    AnyHand,
    /// The cap is closed and no element was overloaded. Applies to another hand than the paper's under the paper's law.
    Closed,
    /// Every stroke turned the cap or the cap is closed, and no element was damaged. Applies if too few strokes are
    /// planned for the claims about a closed cap.
    Turned,
    /// The cap was detected closed by touch, is tight, and no element was damaged.
    ClosedWell,
    /// The cap was detected open by touch, turned as far as measured by touch, and no element was damaged.
    OpenedWell,
    /// The task was completed. Applies to tasks without another criterion.
    Done,
}

impl Criterion {
    /// Criterion for runs with these facts. If `laws_differ`, runs under different control laws are compared by the
    /// same criterion.
    pub fn of(facts: &RunFacts, laws_differ: bool) -> Self {
        match (&facts.task, facts.cap) {
            _ if facts.followed_requests() => Self::Done,
            (TaskKind::Contour | TaskKind::Carry | TaskKind::FrictionScan | TaskKind::Grip, _) => {
                Self::Claims
            }
            (TaskKind::Screw, Some(cap)) if cap.sense > 0.0 => Self::ClosedWell,
            (TaskKind::Screw, Some(_)) => Self::OpenedWell,
            (TaskKind::Screw, None) if facts.stroke_count < PAPERS_STROKES => Self::Turned,
            (TaskKind::Screw, None) if laws_differ || !claims_apply(facts) => Self::AnyHand,
            (TaskKind::Screw, None) if is_papers_hand(facts) => Self::Claims,
            (TaskKind::Screw, None) => Self::Closed,
            (TaskKind::Probe | TaskKind::Other(_), _) => Self::Done,
        }
    }

    /// Criterion in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Claims => "the task was completed and all its claims pass",
            Self::AnyHand => "the task was completed and all five claims of any hand pass",
            Self::Closed => {
                "the task was completed, the cap was closed at the last stroke, and no element was overloaded"
            }
            Self::Turned => {
                "the task was completed, every stroke turned the cap or the cap is closed, and no element was damaged"
            }
            Self::ClosedWell => "the cap was detected closed, is tight, and no element was damaged",
            Self::OpenedWell => {
                "the cap was detected open, turned as far as measured by touch, and no element was damaged"
            }
            Self::Done => "the task was completed",
        }
    }

    /// `true` if the criterion includes the claim with this id. `of_any_hand` selects the claims about any hand instead
    /// of the task's claims.
    pub fn requires(self, id: &str, of_any_hand: bool) -> bool {
        match self {
            Self::Claims => !of_any_hand,
            Self::AnyHand => of_any_hand,
            Self::Closed => [CLOSES_CAP, OVERLOADS_NOTHING].contains(&id),
            Self::Turned => id == NO_DAMAGE,
            Self::ClosedWell | Self::OpenedWell | Self::Done => false,
        }
    }
}

impl Serialize for Criterion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.words())
    }
}

/// Result of the success criterion of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Success {
    /// `true` if the task was completed and the criterion holds.
    pub met: bool,
    /// Applied criterion.
    pub criterion: Criterion,
}

impl Success {
    /// Sentence about the criterion; `None` if the report's claims already cover it.
    pub fn beyond_claims(self) -> Option<String> {
        let words = self.criterion.words();
        match (self.criterion, self.met) {
            (Criterion::Claims | Criterion::AnyHand, _) => None,
            (_, true) => Some(format!("success: yes ({words})")),
            (_, false) => Some(format!("success: no (expected: {words})")),
        }
    }
}
