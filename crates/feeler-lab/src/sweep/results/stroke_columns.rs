//! Columns of each stroke in the table of trials.

use feeler_report::{StrokeMeasures, StrokePattern};

/// A measure of a stroke: column name, and the function that extracts the value.
pub type Measure = (&'static str, fn(&StrokeMeasures) -> Option<f64>);

/// Measures of each stroke in SI units; see [`StrokeMeasures`].
pub const MEASURES: [Measure; 15] = [
    ("peak_torque", |m| m.peak_torque),
    ("mean_grasp_force", |m| m.mean_grasp_force),
    ("peak_grasp_force", |m| m.peak_grasp_force),
    ("cap_turn", |m| m.cap_turn),
    ("peak_shear_rate", |m| m.peak_shear_rate),
    ("slip_fraction", |m| m.slip_fraction),
    ("path_inward_bend", |m| m.path_inward_bend),
    ("slip_precision", |m| m.slip_precision),
    ("true_slip_fraction", |m| m.true_slip_fraction),
    ("grasp_force_variation", |m| m.grasp_force_variation),
    ("over_fraction", |m| m.over_fraction),
    ("path_radius_std", |m| m.path_radius_std),
    ("line_radius_std", |m| m.line_radius_std),
    ("path_curvature", |m| m.path_curvature),
    ("peak_element_force", |m| m.peak_element_force),
];

/// A criterion of the stroke pattern: column name, and the function that extracts the result.
pub type Part = (&'static str, fn(&StrokePattern) -> bool);

/// Criteria of agreement with the pattern of strokes in the paper's Fig. 8; see [`StrokePattern`].
pub const PATTERN: [Part; 10] = [
    ("fig8.grasp.second_below_first", |p| {
        p.grasp_force.second_below_first
    }),
    ("fig8.grasp.last_above_first", |p| {
        p.grasp_force.last_above_first
    }),
    ("fig8.grasp.last_alike", |p| p.grasp_force.last_alike),
    ("fig8.grasp", |p| p.grasp_force.whole()),
    ("fig8.torque.second_below_first", |p| {
        p.torque.second_below_first
    }),
    ("fig8.torque.last_above_first", |p| {
        p.torque.last_above_first
    }),
    ("fig8.torque.last_alike", |p| p.torque.last_alike),
    ("fig8.torque", |p| p.torque.whole()),
    ("fig8.second_below_first", StrokePattern::second_below_first),
    ("fig8", StrokePattern::whole),
];
/// Number of strokes in the pattern.
pub const PATTERN_STROKES: u32 = 4;
