//! Path of a finger in the phase MOVE, and deviation of the planned straight line from a circle.

use super::circle::Circle;
use glam::DVec2;

/// Start and end of the compared part of a path, as fractions of the travel.
const WINDOW: (f64, f64) = (0.25, 0.98);

/// Start and end (m, x and y in W) and planned direction of a finger's path in the phase MOVE.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MovePath {
    pub start: DVec2,
    pub end: DVec2,
    pub direction: DVec2,
}

impl MovePath {
    /// Standard deviation of the distance between the planned straight line and the pivot (m), using `R ≈ R_0 +
    /// u²/2R` at the distance u along the line from the foot of the perpendicular through the pivot.
    pub fn line_deviation(&self, circle: &Circle) -> f64 {
        let along = |point: DVec2| (point - circle.centre).dot(self.direction);
        let (first, last) = (along(self.start), along(self.end));
        let [a, b] = [WINDOW.0, WINDOW.1].map(|part| first + part * (last - first));
        let mean_power = |n: i32| (b.powi(n + 1) - a.powi(n + 1)) / (f64::from(n + 1) * (b - a));
        let variance = mean_power(4) - mean_power(2).powi(2);
        let deviation = variance.max(0.0).sqrt() / (2.0 * self.start.distance(circle.centre));
        if deviation.is_finite() {
            deviation
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the standard deviation over sampled points.
    #[test]
    fn the_planned_line_has_the_deviation_of_its_points() {
        let circle = Circle {
            centre: DVec2::new(0.001, 0.002),
            radius: 0.016,
        };
        let course = MovePath {
            start: DVec2::new(-0.033, 0.004),
            end: DVec2::new(-0.0325, -0.0045),
            direction: DVec2::NEG_Y,
        };
        // Points on the planned line within the window.
        let radii: Vec<f64> = (0..=1000)
            .map(|k| {
                let part = WINDOW.0 + (WINDOW.1 - WINDOW.0) * f64::from(k) / 1000.0;
                let point = course.start + 0.0085 * part * course.direction;
                point.distance(circle.centre)
            })
            .collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        let variance = radii.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / radii.len() as f64;
        // The next term of the expansion is (u/2R)² of the first: 1 %.
        let found = course.line_deviation(&circle);
        assert!(
            (found / variance.sqrt() - 1.0).abs() < 0.01,
            "{found} {}",
            variance.sqrt()
        );
    }
}
