//! What a user wants of any hand that screws a cap, whatever its control law.

use super::DAMAGE_FORCE;
use super::measured::{Measured, ratio};
use super::parts::{curvature, grip_variation, radius_to_line};
use crate::claim::{Claim, ClaimPart, DecidedBy, Relation};
use crate::run_data::RunData;
use crate::series::maximum;
use crate::strokes::{CLOSED_TURN, StrokeMeasures};

/// Id of the claim that no element is overloaded.
pub const OVERLOADS_NOTHING: &str = "hand-overloads-nothing";
/// Id of the claim that the cap is closed at last.
pub const CLOSES_CAP: &str = "hand-closes-cap";

/// The claims about any hand, for a run of at least four strokes that measure `strokes`.
///
/// Bounds that the paper's claims also have are the same. What compares with stroke 1, or asks for SLIP or OVER, is left
/// out, because a law may follow the cap from the first stroke on and needs neither flag.
pub fn of_any_hand(data: &RunData, strokes: &[StrokeMeasures]) -> Vec<Claim> {
    let measured = Measured::new(data, strokes);
    let claims = [
        Claim::new(
            "hand-follows-cap",
            "Once closed, the fingertips follow the cap at a constant distance R from its axis (strokes 3 and 4; each finger).",
            vec![radius_to_line(&measured)],
        ),
        Claim::new(
            "hand-path-is-curved",
            "Once closed, the paths are curved as the cap is (strokes 3 and 4; each finger).",
            curvature(&measured).into(),
        ),
        Claim::new(
            "hand-grip-is-steady",
            "Once closed, the grasp force is steady (window of strokes 3 and 4; each finger).",
            vec![grip_variation(data)],
        ),
        Claim::new(
            OVERLOADS_NOTHING,
            "No element is ever overloaded.",
            vec![peak_to_rating(data, strokes)],
        ),
        Claim::new(
            CLOSES_CAP,
            "The last stroke finds the cap closed.",
            vec![last_turn(data, strokes)],
        ),
    ];
    claims.map(|claim| claim.decided_by(DecidedBy::Hand)).into()
}

/// Largest force on an element in any stroke, relative to F2.
fn peak_to_rating(data: &RunData, strokes: &[StrokeMeasures]) -> ClaimPart {
    let peak = maximum(strokes.iter().filter_map(|s| s.peak_element_force));
    ClaimPart::new(
        "largest force on an element relative to F2, whole run",
        peak.and_then(|peak| ratio(peak, data.facts.over_force_threshold)),
        Relation::AtMost,
        DAMAGE_FORCE,
    )
}

/// Turn of the cap in the last stroke that was asked for, relative to the first one's.
fn last_turn(data: &RunData, strokes: &[StrokeMeasures]) -> ClaimPart {
    let turn = |index| strokes.iter().find(|s| s.index == index)?.cap_turn;
    let turns = turn(1).zip(turn(data.facts.stroke_count));
    ClaimPart::new(
        "cap turn, last stroke to stroke 1",
        turns.and_then(|(first, last)| ratio(last, first)),
        Relation::Within,
        CLOSED_TURN,
    )
}
