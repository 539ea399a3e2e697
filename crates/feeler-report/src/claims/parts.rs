//! Parts shared by the paper's claims and the claims about any hand.

use super::measured::{CLOSED, Measured, each_finger, greatest, least, ratio};
use crate::measures::claim::{ClaimPart, part};
use crate::measures::measure_stroke::grasp_force_variation;
use crate::run::data::RunData;

/// Deviation of the distance R from the cap's axis relative to the planned line, strokes 3 and 4. See
/// [`PathFit`](crate::measures::path_fit::PathFit).
pub(super) fn radius_to_line(measured: &Measured) -> ClaimPart {
    let to_line = measured.each_fit(&CLOSED, |fit, _| ratio(fit.radius_std, fit.line_radius_std));
    part("maximum std of R relative to the planned line").at_most(greatest(&to_line), 0.35)
}

/// Curvature of the path relative to the arc, strokes 3 and 4: lower and upper bound.
pub(super) fn curvature(measured: &Measured) -> [ClaimPart; 2] {
    let closed = measured.each_fit(&CLOSED, |fit, _| Some(fit.curvature));
    [
        part("minimum curvature relative to the arc, strokes 3 and 4")
            .at_least(least(&closed), 0.5),
        part("maximum curvature relative to the arc, strokes 3 and 4")
            .at_most(greatest(&closed), 1.5),
    ]
}

/// Variation of the grasp force in the evaluated window of strokes 3 and 4.
pub(super) fn grip_variation(data: &RunData) -> ClaimPart {
    let variation = each_finger(data, &CLOSED, grasp_force_variation);
    part("maximum std of the grasp force relative to its mean").at_most(greatest(&variation), 0.2)
}
