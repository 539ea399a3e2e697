//! The paper's claims that depend on the hand only: its rubber, law and path, for any cap that turns at first and is
//! closed at the end.

use super::measured::{CLOSED, Measured, change, each_finger, greatest, least, ratio};
use super::parts::{curvature, grip_variation, radius_to_line};
use crate::measures::claim::{Claim, part};
use crate::measures::measure_stroke::{over_fraction, slip_fraction, slip_precision, slip_skill};
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
            part("change of peak torque from stroke 3 to 4").within(peak_torque, ALIKE),
            part("change of peak grasp force from stroke 3 to 4").within(peak_grasp, ALIKE),
            part("cap rotation, stroke 4 relative to stroke 1").at_most(cap_turn, CLOSED_TURN),
        ],
    )
}

pub(super) fn shear_rate_marks_closing(measured: &Measured) -> Claim {
    let marked = measured.compare(1, 4, |m| m.peak_shear_rate, |a, b| ratio(b, a));
    Claim::new(
        "shear-rate-marks-closing",
        "The shear rate is pronounced in stroke 4, not in stroke 1.",
        vec![
            part("99th percentile of the largest element's shear rate over MOVE, stroke 4 relative to stroke 1")
                .at_least(marked, 2.0),
        ],
    )
}

/// Claim that SLIP is raised while a feeler truly slips, and not all the time.
pub(super) fn slip_means_slip(data: &RunData) -> Claim {
    let precision = each_finger(data, &CLOSED, slip_precision);
    // If feelers slip most of the time, even a constant flag is precise; the skill accounts for that.
    let skill = each_finger(data, &CLOSED, slip_skill);
    let raised = each_finger(data, &CLOSED, slip_fraction);
    Claim::new(
        "slip-means-slip",
        "SLIP is raised where a feeler slips (MOVE of strokes 3 and 4; each finger).",
        vec![
            part("minimum precision of SLIP against true slip").at_least(least(&precision), 0.9),
            part("minimum gain in precision over a random flag, relative to the possible gain")
                .at_least(least(&skill), 0.5),
            part("minimum fraction of MOVE with SLIP").at_least(least(&raised), 0.10),
            part("maximum fraction of MOVE with SLIP").at_most(greatest(&raised), 0.60),
        ],
    )
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
            part("maximum std of R relative to stroke 1").at_most(greatest(&to_first), 0.5),
        ],
    )
}

/// Claim that the path is curved like the arc about the cap's axis, unlike any straight line, however tilted. See
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
            part("maximum curvature relative to the arc, stroke 1").at_most(greatest(&first), 0.4),
        ],
    )
}

/// Claim that the grasp force levels off with the cap closed, because OVER limits its increase in response to slip.
/// Evaluated within the window of [`PathFit`](crate::measures::path_fit::PathFit).
pub(super) fn grip_levels_off(data: &RunData) -> Claim {
    let over = each_finger(data, &CLOSED, over_fraction);
    Claim::new(
        "grip-levels-off",
        "With the cap closed, the grasp force levels off, limited by OVER (strokes 3 and 4; each finger).",
        vec![
            grip_variation(data),
            part("minimum fraction of the window with OVER").at_least(least(&over), 0.03),
            part("maximum fraction of the window with OVER").at_most(greatest(&over), 0.50),
        ],
    )
}

pub(super) fn path_saturates(measured: &Measured) -> Claim {
    let data = measured.data;
    let paths = |index, finger| data.path(data.whole_stroke(index)?, finger);
    let distances: Option<Vec<f64>> = (0..data.fingers.len())
        .map(|finger| distance_between_paths(paths(3, finger)?, paths(4, finger)?))
        .collect();
    let distance = distances.and_then(mean);
    let bend = measured.measures(4).and_then(|m| m.path_inward_bend);
    let share = distance.zip(bend).and_then(|(d, bend)| ratio(d, bend));
    Claim::new(
        "path-saturates",
        "The path stops changing after the cap is closed.",
        vec![
            part("RMS distance between the paths of strokes 3 and 4, relative to the bend of stroke 4")
                .at_most(share, 0.15),
        ],
    )
}

pub(crate) fn no_damage(data: &RunData) -> Claim {
    let limit = damage_limit(&data.facts);
    let longest = longest_above(data, limit);
    Claim::new(
        NO_DAMAGE,
        "OVER protects the elements from overload.",
        vec![
            part("longest time of an element above 1.25 F2")
                .in_unit("s")
                .at_most(longest, DAMAGE_TIME),
        ],
    )
}
