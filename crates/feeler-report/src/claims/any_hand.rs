//! Claims that apply to any hand that screws a cap, independent of its control law.

use super::measured::{Measured, ratio};
use super::parts::{curvature, grip_variation, radius_to_line};
use crate::measures::claim::{Claim, ClaimPart, DecidedBy, part};
use crate::measures::overload::DAMAGE_FORCE;
use crate::measures::series::maximum;
use crate::measures::strokes::{CLOSED_TURN, StrokeMeasures};
use crate::run::data::RunData;

/// Id of the claim that no element is overloaded.
pub const OVERLOADS_NOTHING: &str = "hand-overloads-nothing";
/// Id of the claim that the cap is closed at the end.
pub const CLOSES_CAP: &str = "hand-closes-cap";

/// Claims about any hand, for a run of at least four strokes with these measures.
///
/// Bounds shared with the paper's claims are equal. Comparisons with stroke 1 and parts about SLIP or OVER are omitted,
/// because a law may follow the cap from the first stroke and needs neither flag.
pub fn of_any_hand(data: &RunData, strokes: &[StrokeMeasures]) -> Vec<Claim> {
    let measured = Measured::new(data, strokes);
    let claims = [
        Claim::new(
            "hand-follows-cap",
            "With the cap closed, the fingertips follow it at a constant distance R from its axis (strokes 3 and 4; each finger).",
            vec![radius_to_line(&measured)],
        ),
        Claim::new(
            "hand-path-is-curved",
            "With the cap closed, the paths have the cap's curvature (strokes 3 and 4; each finger).",
            curvature(&measured).into(),
        ),
        Claim::new(
            "hand-grip-is-steady",
            "With the cap closed, the grasp force is steady (window of strokes 3 and 4; each finger).",
            vec![grip_variation(data)],
        ),
        Claim::new(
            OVERLOADS_NOTHING,
            "No element is ever overloaded.",
            vec![peak_to_rating(data, strokes)],
        ),
        Claim::new(
            CLOSES_CAP,
            "The cap is closed at the last stroke.",
            vec![last_turn(data, strokes)],
        ),
    ];
    claims.map(|claim| claim.decided_by(DecidedBy::Hand)).into()
}

/// Largest force on an element in any stroke, relative to F2.
fn peak_to_rating(data: &RunData, strokes: &[StrokeMeasures]) -> ClaimPart {
    let peak = maximum(strokes.iter().filter_map(|s| s.peak_element_force));
    part("maximum force on an element relative to F2, whole run").at_most(
        peak.and_then(|peak| ratio(peak, data.facts.over_force_threshold)),
        DAMAGE_FORCE,
    )
}

/// Cap rotation in the last planned stroke relative to stroke 1.
fn last_turn(data: &RunData, strokes: &[StrokeMeasures]) -> ClaimPart {
    let turn = |index| strokes.iter().find(|s| s.index == index)?.cap_turn;
    let turns = turn(1).zip(turn(data.facts.stroke_count));
    part("cap rotation, last stroke relative to stroke 1").within(
        turns.and_then(|(first, last)| ratio(last, first)),
        CLOSED_TURN,
    )
}
