//! Force control of a gripper: computes the closing speed from the force error and the estimated contact
//! stiffness.

/// Sum of squared changes of the closing distance (m²) above which the weight of all earlier measurements is halved.
const MEMORY: f64 = 4e-8;
/// Valid range of the stiffness (N/m).
const PLAUSIBLE: (f64, f64) = (100.0, 1e5);

/// Force controller with an estimate of the contact stiffness.
#[derive(Debug, Clone, Copy)]
pub(super) struct ForceControl {
    /// Sum of squared changes of the closing distance (m²).
    squares: f64,
    /// Sum of the products of changes of closing distance and grip force (N·m).
    products: f64,
    /// Previous closing distance (m) and grip force (N).
    previous: Option<(f64, f64)>,
}

impl ForceControl {
    /// Creates the controller with an assumed `stiffness` (N/m): change of the grip force per closing distance of each
    /// finger.
    pub fn new(stiffness: f64) -> Self {
        Self {
            squares: 0.1 * MEMORY,
            products: 0.1 * MEMORY * stiffness,
            previous: None,
        }
    }

    /// Updates the stiffness estimate with the mean closing distance of the fingers (m) and the grip force (N): a
    /// least-squares slope in which earlier measurements lose weight with the distance.
    pub fn update(&mut self, closed: f64, grip: f64) {
        if let Some((from, force)) = self.previous.replace((closed, grip)) {
            let change = closed - from;
            self.squares += change * change;
            self.products += change * (grip - force);
            if self.squares > MEMORY {
                self.squares *= 0.5;
                self.products *= 0.5;
            }
        }
    }

    /// Closing speed of each finger (m/s) at which the grip force changes at the rate `bandwidth` (1/s) times the
    /// force `error` (N): required minus present grip.
    pub fn speed(&self, error: f64, bandwidth: f64) -> f64 {
        let stiffness = (self.products / self.squares).clamp(PLAUSIBLE.0, PLAUSIBLE.1);
        bandwidth * error / stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_the_stiffness_of_a_spring() {
        let mut control = ForceControl::new(2000.0);
        assert!((control.speed(1.0, 20.0) - 0.01).abs() < 1e-15);
        for step in 0..2000 {
            let closed = 1e-5 * f64::from(step);
            // Noise of alternating sign does not bias a slope.
            let noise = if step % 2 == 0 { 0.01 } else { -0.01 };
            control.update(closed, 5000.0 * closed + noise);
        }
        // The assumed stiffness has lost its weight, and the noise adds a percent at most.
        assert!((control.speed(1.0, 20.0) / (20.0 / 5000.0) - 1.0).abs() < 0.02);
    }

    #[test]
    fn stays_plausible_when_the_force_falls_while_the_fingers_close() {
        let mut control = ForceControl::new(2000.0);
        for step in 0..200 {
            control.update(1e-4 * f64::from(step), -f64::from(step));
        }
        assert_eq!(control.speed(1.0, 20.0), 20.0 / PLAUSIBLE.0);
    }
}
