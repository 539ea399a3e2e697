//! Runs to which the paper's claims apply.

use feeler_record::{RunFacts, TaskKind};

/// Control law of the paper.
const PAPERS_LAW: &str = "tri-axial";

/// Number of strokes that the paper's claims refer to.
pub const PAPERS_STROKES: u32 = 4;

/// Number of fingers of the paper's hand (section II).
const PAPERS_FINGERS: usize = 2;
/// Number of elements per fingertip of the paper's hand (section II).
const PAPERS_ELEMENTS: usize = 41;

/// `true` if the known facts of the hand agree with the paper's hand, for which the bounds of the paper's claims were
/// chosen.
pub fn is_papers_hand(facts: &RunFacts) -> bool {
    let mut elements = facts.hand.iter().map(|finger| finger.element_tips.len());
    facts.fingers == PAPERS_FINGERS && elements.all(|count| count == PAPERS_ELEMENTS)
}

/// `true` if the claims of the task are the paper's: a cap is screwed without a touch-based outcome. Unknown tasks use
/// the paper's claims.
pub fn has_papers_claims(facts: &RunFacts) -> bool {
    let is_another = matches!(
        facts.task,
        TaskKind::Carry | TaskKind::Contour | TaskKind::FrictionScan | TaskKind::Grip
    );
    !is_another && facts.cap.is_none()
}

/// `true` if the task's claims apply to runs with these facts. No claims apply if another program moved the hand; the
/// paper's claims require the control law of the paper.
pub fn claims_apply(facts: &RunFacts) -> bool {
    if facts.followed_requests() {
        return false;
    }
    let another_law = facts.law.as_deref().is_some_and(|law| law != PAPERS_LAW);
    !(another_law && has_papers_claims(facts))
}

/// `true` if reports of runs with these facts show the task's claims. The paper's claims require enough planned
/// strokes.
pub fn claims_are_shown(facts: &RunFacts) -> bool {
    let too_few = facts.stroke_count < PAPERS_STROKES;
    claims_apply(facts) && !(too_few && has_papers_claims(facts))
}
