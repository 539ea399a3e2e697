//! Torque-angle curve of a cap, from which a seated cap is identified.

/// Torque of the first point of the curve (N·m).
const LOWEST: f64 = 1e-3;
/// Ratio of the torques of consecutive points.
const RATIO: f64 = 1.03;
/// Number of points, up to a torque of 0.4 N·m.
const POINTS: usize = 204;
/// Upper end of the stiffness measurement, as a fraction of the largest torque. It is below the friction limit, where
/// fingers slip and measure spurious rotations.
const HIGHEST: f64 = 0.9;
/// Lower end of the stiffness measurement, as a multiple of the torque limit of gentle strokes, in which the fingers
/// slipped too.
const ABOVE_GENTLE: f64 = 1.2;
/// Minimum span of the stiffness measurement, as a fraction of the largest torque.
const SPAN: f64 = 0.2;

/// Curve of torque over angle: the rotation of the cap at which the torque first exceeded each of a series of values.
///
/// A cap rotates only while the torque equals its resistance, and the resistance of a seat only increases. So whenever
/// the torque exceeds all earlier values, it equals the resistance at that angle.
#[derive(Debug, Clone)]
pub struct ResistanceCurve {
    turn: [f64; POINTS],
    reached: usize,
    /// Largest torque so far (N·m).
    pub largest: f64,
}

impl Default for ResistanceCurve {
    fn default() -> Self {
        Self {
            turn: [0.0; POINTS],
            reached: 0,
            largest: 0.0,
        }
    }
}

impl ResistanceCurve {
    /// Adds a torque (N·m) at a rotation of the cap (rad).
    pub fn push(&mut self, torque: f64, turn: f64) {
        self.largest = self.largest.max(torque);
        while let Some(point) = self.turn.get_mut(self.reached) {
            if torque < LOWEST * RATIO.powi(self.reached as i32) {
                break;
            }
            *point = turn;
            self.reached += 1;
        }
    }

    /// Torsional stiffness of the resistance (N·m/rad); infinite if the cap did not rotate, `None` if the torque was
    /// too low to measure it. `gentle` is the ratio of the grip forces of gentle and firm strokes.
    pub fn stiffness(&self, gentle: f64) -> Option<f64> {
        let lowest = (ABOVE_GENTLE * gentle).min(HIGHEST - SPAN);
        let (low, high) = (self.point(lowest)?, self.point(HIGHEST)?);
        let torque = self.torque(high) - self.torque(low);
        let turn = self.turn.get(high)? - self.turn.get(low)?;
        (high > low).then(|| match turn > 0.0 {
            true => torque / turn,
            false => f64::INFINITY,
        })
    }

    fn torque(&self, point: usize) -> f64 {
        LOWEST * RATIO.powi(point as i32)
    }

    /// Index of the last point below the fraction `share` of the largest torque.
    fn point(&self, share: f64) -> Option<usize> {
        let steps = libm::log(share * self.largest / LOWEST) / libm::log(RATIO);
        let last = self.reached.checked_sub(1)?;
        (steps >= 0.0).then(|| (steps as usize).min(last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stiffness_of_a_seat_is_that_of_its_line_whatever_comes_before() {
        let mut curve = ResistanceCurve::default();
        assert_eq!(curve.stiffness(0.5), None);
        // Runs down at 3 mN·m for 2 rad, then with 0.3 N·m/rad; every stroke begins at zero torque.
        for stroke in 0..4 {
            for step in 0..100 {
                let turn = 0.55 * (f64::from(stroke) + f64::from(step) / 100.0);
                let resistance = 3e-3 + 0.3 * (turn - 2.0).max(0.0);
                let built_up = 1e-3 * f64::from(step);
                curve.push(resistance.min(built_up), turn);
            }
        }
        let stiffness = curve.stiffness(0.5).expect("a stiffness");
        // The span is 0.3 of 62 mN·m; points are 3 % apart, steps 1 mN·m.
        assert!((stiffness / 0.3 - 1.0).abs() < 0.1, "{stiffness}");
    }

    #[test]
    fn a_cap_that_does_not_turn_is_infinitely_stiff() {
        let mut curve = ResistanceCurve::default();
        for step in 0..60 {
            curve.push(1e-3 * f64::from(step), 0.0);
        }
        assert_eq!(curve.stiffness(0.5), Some(f64::INFINITY));
        assert_eq!(curve.largest, 1e-3 * 59.0);
    }

    /// Curve with a stiffness of 0.1 N·m/rad up to 42 mN·m, then 0.5 N·m/rad up to 50 mN·m, in steps of 10 µN·m.
    fn bent() -> ResistanceCurve {
        let mut curve = ResistanceCurve::default();
        for step in 0..=5000 {
            let torque = 1e-5 * f64::from(step);
            curve.push(
                torque,
                torque.min(0.042) / 0.1 + (torque - 0.042).max(0.0) / 0.5,
            );
        }
        curve
    }

    #[test]
    fn gentle_strokes_that_grip_as_hard_as_firm_ones_leave_a_fifth_of_the_torque_to_judge_by() {
        // From 35 to 45 mN·m it yields by 70 and by 6 mrad.
        let expected = 0.010 / 0.076;
        for gentle in [0.6, 0.7, 0.74, 1.0, 3.0] {
            let stiffness = bent().stiffness(gentle).expect("a stiffness");
            // Points are 3 % apart, and each end may be off by one: 1.4 of 10 mN·m, which also affects the turn.
            let error = (stiffness / expected - 1.0).abs();
            assert!(error < 0.15, "{stiffness} N m/rad with {gentle}");
        }
    }
}
