//! The paper's claims that depend on the hand only: its rubber, law and path, for any cap that turns at first and is
//! closed at the end.

use super::measured::{CLOSED, Measured, change, each_finger, greatest, least, ratio};
use super::parts::{curvature, grip_variation, radius_to_line};
use crate::measures::claim::{Claim, ClaimPart, DecidedBy, Relation};
use crate::measures::measure_stroke::{over_fraction, share, slip_precision, slip_skill};
use crate::measures::overload::{DAMAGE_TIME, damage_limit, longest_above};
use crate::measures::paths::distance_between_paths;
use crate::measures::series::mean;
use crate::measures::stroke_pattern::ALIKE;
use crate::measures::strokes::CLOSED_TURN;
use crate::run::data::RunData;

/// Id of the claim that no element is damaged.
pub const NO_DAMAGE: &str = "no-damage";

pub(super) fn closed_after_third(measured: &Measured) -> Claim {
    let peak_torque = measured.compare(3, 4, |m| m.peak_torque, change);
    let peak_grasp = measured.compare(3, 4, |m| m.peak_grasp_force, change);
    let cap_turn = measured.compare(1, 4, |m| m.cap_turn, |first, fourth| ratio(fourth, first));
    Claim::new(
        "closed-after-third",
        "Strokes 3 and 4 are alike: the cap is closed after stroke 3.",
        vec![
            ClaimPart::new(
                "change of peak torque from stroke 3 to 4",
                peak_torque,
                Relation::Within,
                ALIKE,
            ),
            ClaimPart::new(
                "change of peak grasp force from stroke 3 to 4",
                peak_grasp,
                Relation::Within,
                ALIKE,
            ),
            ClaimPart::new(
                "cap rotation, stroke 4 relative to stroke 1",
                cap_turn,
                Relation::AtMost,
                CLOSED_TURN,
            ),
        ],
    )
    .decided_by(DecidedBy::Hand)
}

pub(super) fn shear_rate_marks_closing(measured: &Measured) -> Claim {
    let marked = measured.compare(1, 4, |m| m.peak_shear_rate, |a, b| ratio(b, a));
    Claim::new(
        "shear-rate-marks-closing",
        "The shear rate is pronounced in stroke 4, not in stroke 1.",
        vec![ClaimPart::new(
            "99th percentile of the largest element's shear rate over MOVE, stroke 4 relative to stroke 1",
            marked,
            Relation::AtLeast,
            2.0,
        )],
    )
    .decided_by(DecidedBy::Hand)
}

/// SLIP against ground truth: raised while a feeler slips, and not all the time.
pub(super) fn slip_means_slip(data: &RunData) -> Claim {
    let precision = each_finger(data, &CLOSED, |stroke, finger| {
        slip_precision(&data.fingers[finger], stroke)
    });
    // If feelers slip most of the time, even a constant flag is precise; the skill accounts for that.
    let skill = each_finger(data, &CLOSED, |stroke, finger| {
        slip_skill(&data.fingers[finger], stroke)
    });
    let raised = each_finger(data, &CLOSED, |stroke, finger| {
        share(
            stroke
                .moving
                .clone()
                .map(|row| data.fingers[finger].slip[row]),
        )
    });
    Claim::new(
        "slip-means-slip",
        "SLIP is raised where a feeler slips (MOVE of strokes 3 and 4; each finger).",
        vec![
            ClaimPart::new(
                "minimum precision of SLIP against true slip",
                least(&precision),
                Relation::AtLeast,
                0.9,
            ),
            ClaimPart::new(
                "minimum gain in precision over a random flag, relative to the possible gain",
                least(&skill),
                Relation::AtLeast,
                0.5,
            ),
            ClaimPart::new(
                "minimum fraction of MOVE with SLIP",
                least(&raised),
                Relation::AtLeast,
                0.10,
            ),
            ClaimPart::new(
                "maximum fraction of MOVE with SLIP",
                greatest(&raised),
                Relation::AtMost,
                0.60,
            ),
        ],
    )
    .decided_by(DecidedBy::Hand)
}

/// Claim that the distance R of the dome's centre from the cap's axis stays constant, more so than on the planned line and
/// in stroke 1, in which the cap turns with the finger. See [`PathFit`](crate::measures::path_fit::PathFit).
pub(super) fn path_follows_contour(measured: &Measured) -> Claim {
    let to_first = measured.each_fit(&CLOSED, |fit, finger| {
        ratio(fit.radius_std, measured.fit(1, finger)?.radius_std)
    });
    Claim::new(
        "path-follows-contour",
        "With the cap closed, the fingertips circle its axis at a constant distance R (strokes 3 and 4; each finger).",
        vec![
            radius_to_line(measured),
            ClaimPart::new(
                "maximum std of R relative to stroke 1",
                greatest(&to_first),
                Relation::AtMost,
                0.5,
            ),
        ],
    )
    .decided_by(DecidedBy::Hand)
}

/// The path is curved like the arc about the cap's axis, unlike any straight line, however tilted. See
/// [`PathFit::curvature`](crate::measures::path_fit::PathFit::curvature).
pub(super) fn path_is_curved(measured: &Measured) -> Claim {
    let [at_least, at_most] = curvature(measured);
    let first = measured.each_fit(&[1], |fit, _| Some(fit.curvature));
    Claim::new(
        "path-is-curved",
        "The straight path becomes a curve that fits the cap (each finger).",
        vec![
            at_least,
            at_most,
            ClaimPart::new(
                "maximum curvature relative to the arc, stroke 1",
                greatest(&first),
                Relation::AtMost,
                0.4,
            ),
        ],
    )
    .decided_by(DecidedBy::Hand)
}

/// The grasp force that slips have built up is limited by OVER, within the window of
/// [`PathFit`](crate::measures::path_fit::PathFit).
pub(super) fn grip_levels_off(data: &RunData) -> Claim {
    let over = each_finger(data, &CLOSED, |stroke, finger| {
        over_fraction(data, stroke, finger)
    });
    Claim::new(
        "grip-levels-off",
        "With the cap closed, the grasp force levels off, limited by OVER (strokes 3 and 4; each finger).",
        vec![
            grip_variation(data),
            ClaimPart::new(
                "minimum fraction of the window with OVER",
                least(&over),
                Relation::AtLeast,
                0.03,
            ),
            ClaimPart::new(
                "maximum fraction of the window with OVER",
                greatest(&over),
                Relation::AtMost,
                0.50,
            ),
        ],
    )
    .decided_by(DecidedBy::Hand)
}

pub(super) fn path_saturates(measured: &Measured) -> Claim {
    let data = measured.data;
    let paths = |index, finger: usize| {
        let stroke = data.whole_stroke(index)?;
        Some(&data.fingers[finger].position[stroke.moving.clone()])
    };
    let distances: Option<Vec<f64>> = (0..data.fingers.len())
        .map(|finger| distance_between_paths(paths(3, finger)?, paths(4, finger)?))
        .collect();
    let distance = distances.and_then(mean);
    let bend = measured.measures(4).and_then(|m| m.path_inward_bend);
    let share = distance.zip(bend).and_then(|(d, bend)| ratio(d, bend));
    Claim::new(
        "path-saturates",
        "The path stops changing after the cap is closed.",
        vec![ClaimPart::new(
            "RMS distance between the paths of strokes 3 and 4, relative to the bend of stroke 4",
            share,
            Relation::AtMost,
            0.15,
        )],
    )
    .decided_by(DecidedBy::Hand)
}

pub(crate) fn no_damage(data: &RunData) -> Claim {
    let limit = damage_limit(&data.facts);
    let longest = longest_above(data, limit);
    Claim::new(
        NO_DAMAGE,
        "OVER protects the elements from overload.",
        vec![
            ClaimPart::new(
                "longest time of an element above 1.25 F2",
                longest,
                Relation::AtMost,
                DAMAGE_TIME,
            )
            .in_unit("s"),
        ],
    )
}
