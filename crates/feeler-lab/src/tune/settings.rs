//! Tuned settings: their computation by the rules, and their application to an experiment.

use super::hand::Hand;
use super::rules::{RULES, SETTINGS, groups};
use crate::config::ExperimentConfig;
use feeler::control::task::TaskConfig;
use glam::DVec2;

/// Maximum travel of a stroke (m): "within 10 mm" (paper, section V.B).
const MAX_TRAVEL: f64 = 0.010;
/// Maximum tuned speed as a fraction of `control.limits.fingertip_speed`.
const MAX_SPEED_SHARE: f64 = 0.9;
/// F1 relative to F2, as in the reference experiment.
const TOUCH: f64 = 0.2;
/// Significant digits of a setting.
const DIGITS: usize = 4;

/// Settings of `[control]` and `[task.screw]`, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// F2: compression above which an element raises OVER (N).
    pub over_force: f64,
    /// v_m: speed of the stroke (m/s).
    pub move_speed: f64,
    /// dr: shear rate above which an element raises SLIP (N/s).
    pub slip_threshold: f64,
    /// v_r: re-compressive speed (m/s).
    pub recompression_speed: f64,
    /// Grasp force below which a moving finger is re-compressed (N).
    pub minimum_grasp_force: f64,
    /// Grasp force at which a searching finger stops (N).
    pub grasp_force: f64,
    /// v_0: speed of the approach (m/s).
    pub search_speed: f64,
    /// Length of the stroke (m).
    pub travel: f64,
    /// Distance from the beginning of the stroke to the point where it is tangent to the object (m).
    pub start: f64,
    /// F1: compression above which an element raises TOUCH (N).
    pub touch_force: f64,
}

impl Settings {
    /// Computes the settings for `hand`, with the coefficient of each rule multiplied by the exponential of its entry
    /// in `offsets`; zeros give the rules themselves. `fingertip_speed` is the limit of commanded speeds (m/s).
    pub fn new(hand: &Hand, offsets: &[f64; SETTINGS], fingertip_speed: f64) -> Self {
        let groups = groups(hand);
        let mut ratios = [0.0; SETTINGS];
        for ((ratio, rule), offset) in ratios.iter_mut().zip(&RULES).zip(offsets) {
            *ratio = rule.value(&groups) * offset.exp();
        }
        let [
            over,
            speed,
            slip,
            recompression,
            weak,
            grasp,
            search,
            travel,
            start,
        ] = ratios;
        let most = MAX_SPEED_SHARE * fingertip_speed;
        let over_force = hand.rated_force * over.min(1.0);
        let move_speed = (speed * hand.contact_radius / hand.period).min(most);
        Self {
            over_force: rounded(over_force),
            move_speed: rounded(move_speed),
            slip_threshold: rounded(slip * hand.shear_stiffness * move_speed),
            recompression_speed: rounded((recompression * move_speed).min(most)),
            minimum_grasp_force: rounded(weak * over_force),
            grasp_force: rounded(grasp * over_force),
            search_speed: rounded((search * move_speed).min(most)),
            travel: rounded((travel * hand.contact_radius).min(MAX_TRAVEL)),
            start: rounded(start * hand.contact_radius),
            touch_force: rounded(TOUCH * over_force),
        }
    }

    /// Applies the settings to `config`, a screw task for an object that turns about `pivot` (x and y in W, m).
    pub fn apply(&self, config: &mut ExperimentConfig, pivot: [f64; 2]) {
        let control = &mut config.control;
        control.over_force = self.over_force;
        control.touch_force = self.touch_force;
        control.slip_threshold = self.slip_threshold;
        control.recompression_speed = self.recompression_speed;
        control.minimum_grasp_force = self.minimum_grasp_force;
        let TaskConfig::Screw(screw) = &mut config.task else {
            return;
        };
        screw.grasp_force = self.grasp_force;
        screw.search_speed = self.search_speed;
        screw.move_speed = self.move_speed;
        screw.travel = self.travel;
        for finger in &mut screw.finger {
            finger.home = home(finger.home, finger.stroke, pivot, self.start);
        }
    }
}

/// Moves the `home` of a finger (m, in W) along its `stroke` such that the stroke begins `start` before the point where
/// it is tangent to an object about `pivot`.
fn home(home: [f64; 3], stroke: [f64; 3], pivot: [f64; 2], start: f64) -> [f64; 3] {
    let along = DVec2::new(stroke[0], stroke[1]).normalize_or_zero();
    let from_pivot = DVec2::new(home[0] - pivot[0], home[1] - pivot[1]);
    let moved = from_pivot - (from_pivot.dot(along) + start) * along;
    let place = |x: f64| (x * 1e6).round() / 1e6;
    [
        place(pivot[0] + moved.x),
        place(pivot[1] + moved.y),
        home[2],
    ]
}

/// Rounds `value` to [`DIGITS`] significant digits.
fn rounded(value: f64) -> f64 {
    let text = format!("{value:.*e}", DIGITS - 1);
    text.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HAND: Hand = Hand {
        normal_stiffness: 205.0,
        shear_stiffness: 127.0,
        static_friction: 1.14,
        kinetic_friction: 0.78,
        servo_lag: 0.0125,
        force_noise: 0.002,
        contact_radius: 0.032,
        rated_force: 0.505,
        period: 0.01,
        pivot: [0.0, 0.0],
    };

    /// A change of the units of length, force and time does not change the groups, and scales settings only by their
    /// own units.
    #[test]
    fn rules_are_dimensionally_consistent() {
        let (metre, newton, second) = (0.7, 3.0, 1.25);
        let scaled = Hand {
            normal_stiffness: HAND.normal_stiffness * newton / metre,
            shear_stiffness: HAND.shear_stiffness * newton / metre,
            servo_lag: HAND.servo_lag * second,
            force_noise: HAND.force_noise * newton,
            contact_radius: HAND.contact_radius * metre,
            rated_force: HAND.rated_force * newton,
            period: HAND.period * second,
            ..HAND
        };
        for (a, b) in groups(&HAND).into_iter().zip(groups(&scaled)) {
            assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        }
        let (a, b) = (
            Settings::new(&HAND, &[0.0; SETTINGS], 1e3),
            Settings::new(&scaled, &[0.0; SETTINGS], 1e3),
        );
        let pairs = [
            (a.over_force * newton, b.over_force),
            (a.move_speed * metre / second, b.move_speed),
            (a.slip_threshold * newton / second, b.slip_threshold),
            (
                a.recompression_speed * metre / second,
                b.recompression_speed,
            ),
            (a.minimum_grasp_force * newton, b.minimum_grasp_force),
            (a.grasp_force * newton, b.grasp_force),
            (a.search_speed * metre / second, b.search_speed),
            (a.travel * metre, b.travel),
            (a.start * metre, b.start),
            (a.touch_force * newton, b.touch_force),
        ];
        for (expected, scaled) in pairs {
            // Each is rounded to four significant digits.
            assert!(
                (scaled / expected - 1.0).abs() < 2e-3,
                "{expected} {scaled}"
            );
        }
    }

    #[test]
    fn a_stroke_begins_before_the_tangent_point_of_a_displaced_object() {
        let moved = home(
            [-0.038, 0.00195, 0.1],
            [0.0, -2.0, 0.0],
            [0.001, 0.002],
            0.003,
        );
        assert_eq!(moved, [-0.038, 0.005, 0.1]);
    }

    #[test]
    fn settings_respect_rating_paper_and_limits() {
        let settings = Settings::new(&HAND, &[3.0; SETTINGS], 0.05);
        assert_eq!(settings.over_force, HAND.rated_force);
        assert_eq!(settings.travel, 0.010);
        assert_eq!(settings.move_speed, 0.045);
    }
}
