//! Measures of strokes, as stored in `summary.json`. Values are never NaN.

use serde::Serialize;

/// Estimated and true values of one stroke.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeltStroke {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// Estimated rotation of the cap (rad), positive in the direction of the stroke.
    pub felt_turn: Option<f64>,
    /// True rotation of the cap (rad), positive with the stroke.
    pub turn: Option<f64>,
    /// Largest estimated torque (N·m), positive with the stroke.
    pub felt_torque: Option<f64>,
    /// Largest torque measured by the torque sensor (N·m), positive with the stroke.
    pub torque: Option<f64>,
}

/// Anchor displacement per control step above which a feeler counts as slipping (m).
pub const TRUE_SLIP: f64 = 20e-6;

/// Cap rotation relative to the first stroke up to which the cap counts as closed.
pub const CLOSED_TURN: f64 = 0.05;

/// `true` if the last stroke found the cap closed ([`CLOSED_TURN`]), `false` otherwise or if the cap never turned.
/// `turns` are the cap rotations of all strokes (rad).
pub fn found_closed(turns: &[Option<f64>]) -> bool {
    let [first, .., last] = turns else {
        return false;
    };
    first
        .zip(*last)
        .is_some_and(|(first, last)| first > 0.0 && last <= CLOSED_TURN * first)
}

/// `true` if every stroke turned the cap by more than [`CLOSED_TURN`]. `turns` are the cap rotations of all strokes
/// (rad).
pub fn turned(turns: &[Option<f64>]) -> bool {
    let Some(&Some(first)) = turns.first() else {
        return false;
    };
    let least = CLOSED_TURN * first;
    first > 0.0
        && turns
            .iter()
            .all(|turn| turn.is_some_and(|turn| turn > least))
}

/// Measures of one stroke; `None` (JSON null) if the recording does not define them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StrokeMeasures {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// Largest measured torque during the stroke (N·m); `None` unless torque is known throughout MOVE.
    pub peak_torque: Option<f64>,
    /// Grasp force averaged over MOVE and over fingers (N).
    pub mean_grasp_force: Option<f64>,
    /// Maximum over the stroke of the grasp force averaged over fingers (N).
    pub peak_grasp_force: Option<f64>,
    /// Rotation of the cap during the stroke (rad), positive = closing.
    pub cap_turn: Option<f64>,
    /// 99th percentile over MOVE of the shear rate of the element with the largest F_z, averaged over fingers (N/s).
    pub peak_shear_rate: Option<f64>,
    /// Fraction of MOVE with SLIP, averaged over fingers (0 to 1).
    pub slip_fraction: Option<f64>,
    /// Fraction of the control steps of MOVE with SLIP in which a feeler of the finger truly slipped ([`TRUE_SLIP`]),
    /// averaged over fingers (0 to 1); known for simulated runs only.
    pub slip_precision: Option<f64>,
    /// Fraction of MOVE in which a feeler of the finger truly slipped, averaged over fingers (0 to 1). Equals the
    /// precision of a random flag.
    pub true_slip_fraction: Option<f64>,
    /// Standard deviation of the grasp force relative to its mean, within the window of `window_rows`, averaged over
    /// fingers.
    pub grasp_force_variation: Option<f64>,
    /// Fraction of the same window with OVER, averaged over fingers (0 to 1).
    pub over_fraction: Option<f64>,
    /// Largest inward deviation of the fingertip's path over MOVE from the planned straight line, averaged over fingers
    /// (m). See `inward_bend`.
    pub path_inward_bend: Option<f64>,
    /// `PathFit::radius_std`, averaged over fingers (m).
    pub path_radius_std: Option<f64>,
    /// `PathFit::line_radius_std`, averaged over fingers (m).
    pub line_radius_std: Option<f64>,
    /// `PathFit::curvature`, averaged over fingers.
    pub path_curvature: Option<f64>,
    /// Largest F_z of any element during the stroke (N).
    pub peak_element_force: Option<f64>,
}

impl StrokeMeasures {
    /// Removes all measures except the maxima, for a stroke that has kept only its rows with extreme values.
    pub(crate) fn of_extremes(self) -> Self {
        Self {
            mean_grasp_force: None,
            peak_shear_rate: None,
            slip_fraction: None,
            slip_precision: None,
            true_slip_fraction: None,
            grasp_force_variation: None,
            over_fraction: None,
            path_inward_bend: None,
            path_radius_std: None,
            line_radius_std: None,
            path_curvature: None,
            ..self
        }
    }
}
