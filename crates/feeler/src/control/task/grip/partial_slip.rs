//! Friction from partial slip: the edge of a contact slips before its middle.
//!
//! On a convex fingertip, elements at the edge of the contact are pressed less than those in its middle, but sheared by
//! the same displacement. As the load rises, elements slip one after the other, from the edge inwards, and the object
//! moves only when the last one slips. The ratio of shear to pressing force of a slipping element equals the friction
//! coefficient; that of a sticking element is lower. So the friction is known while the object is still held, without a
//! model of the fingertip.

use super::config::PartialSlipConfig;
use super::contact_load::{ElementLoad, FingerLoad};
use crate::control::grasp_slip::part;
use crate::sensor::fingertip::MAX_ELEMENTS;
use glam::{DVec3, DVec4};

/// Load below which its direction is considered unknown (N).
const LEAST_LOAD: f64 = 0.05;
/// Minimum grip force by which a load is divided (N).
const LEAST_GRIP: f64 = 0.03;
/// Averaging time of the load (s). Without averaging, the largest recent load would grow with the sensor's rate, because
/// of noise.
const AVERAGING_TIME: f64 = 0.005;

/// Maximum factor by which the inclination of the surface increases the load. The inclination is uncertain if few tips
/// are in contact.
const MOST_INCLINED: f64 = 1.3;

/// Estimates friction and load of a grasp, and the grip force that they require.
#[derive(Debug, Clone)]
pub struct PartialSlip {
    config: PartialSlipConfig,
    /// Low-pass filtered load of each element of each finger.
    means: Vec<Vec<ElementLoad>>,
    /// Buffer for the pressed elements of one finger: pressing force, and shear along the load (N).
    pressed: Vec<(f64, f64)>,
    /// Filtered friction coefficient: rises with `friction_time` and falls with `forget_time` towards the ratio at the
    /// edge.
    friction: f64,
    /// The larger of the friction estimate and the present ratio at the edge.
    edge: f64,
    /// Sums of the present and of the filtered ratios at the edges of the fingers added in this step.
    edges: [f64; 2],
    /// Number of fingers added in this step.
    felt: usize,
    /// Sums of shear (N, in W) and pressing force (N) over all elements of the fingers added in this step.
    total: DVec4,
    /// Ratio of total shear to total pressing force in the latest step.
    ratio: f64,
    /// Load of a finger, averaged over [`AVERAGING_TIME`] (N).
    mean_load: f64,
    /// Largest recent mean load of a finger (N).
    load: f64,
}

impl PartialSlip {
    /// Creates the estimator for the given number of `fingers`.
    pub fn new(config: PartialSlipConfig, fingers: usize) -> Self {
        Self {
            config,
            means: vec![vec![ElementLoad::default(); MAX_ELEMENTS]; fingers],
            pressed: vec![(0.0, 0.0); MAX_ELEMENTS],
            friction: config.least_friction,
            edge: config.least_friction,
            edges: [0.0; 2],
            felt: 0,
            total: DVec4::ZERO,
            ratio: 0.0,
            mean_load: 0.0,
            load: 0.0,
        }
    }

    /// Estimated friction coefficient; a lower bound until an element has slipped.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Adds the loads on the `elements` of finger `index`, relative to the surface of the object, `interval` (s) after
    /// the previous ones. `load` is the finger's total load relative to the closing direction, which defines the
    /// direction of shear.
    pub fn add_finger(
        &mut self,
        index: usize,
        elements: &[ElementLoad],
        load: &FingerLoad,
        interval: f64,
    ) {
        let Some(means) = self.means.get_mut(index) else {
            return;
        };
        let new = part(interval, self.config.filter_time);
        for (now, mean) in elements.iter().zip(&mut *means) {
            mean.pressing += new * (now.pressing - mean.pressing);
            mean.shear += new * (now.shear - mean.shear);
        }
        if load.shear.length() < LEAST_LOAD {
            return;
        }
        let along = load.shear.normalize();
        let (mut shear, mut pressing) = (DVec3::ZERO, 0.0);
        for own in elements {
            shear += own.shear;
            pressing += own.pressing;
        }
        self.total += shear.extend(pressing);
        let means = &means[..elements.len().min(MAX_ELEMENTS)];
        for (sum, loads) in self.edges.iter_mut().zip([elements, means]) {
            let mut count = 0;
            let pressed = loads
                .iter()
                .filter(|own| own.pressing > self.config.least_pressing);
            for (place, own) in self.pressed.iter_mut().zip(pressed) {
                *place = (own.pressing, own.shear.dot(along));
                count += 1;
            }
            let edge = edge_ratio(&mut self.pressed[..count], self.config.group_share);
            *sum += edge.unwrap_or(f64::NAN);
        }
        self.felt += 1;
    }

    /// Updates the friction after all fingers have been added, `interval` (s) after the previous update. Uses the mean
    /// over the fingers, because on a tilted object the ratios of opposing fingers deviate in opposite directions.
    pub fn update_friction(&mut self, interval: f64) {
        let felt = std::mem::take(&mut self.felt);
        let [now, mean] = std::mem::take(&mut self.edges).map(|sum| sum / felt.max(1) as f64);
        let sum = std::mem::take(&mut self.total);
        self.ratio = sum.truncate().length() / sum.w.max(LEAST_GRIP);
        let known = felt == self.means.len();
        if known && mean > self.friction {
            self.friction += part(interval, self.config.friction_time) * (mean - self.friction);
        } else if known {
            self.friction += part(interval, self.config.forget_time) * (mean - self.friction);
        }
        self.edge = if known {
            self.friction.max(now)
        } else {
            self.friction
        };
    }

    /// Updates the `load` of a finger (N), `interval` (s) after the previous one.
    pub fn update_load(&mut self, load: f64, interval: f64) {
        let kept = (1.0 - interval / AVERAGING_TIME).max(0.0);
        let load = load + kept * (self.mean_load - load);
        self.mean_load = load;
        let forgotten = part(interval, self.config.load_time);
        self.load = load.max(self.load + forgotten * (load - self.load));
    }

    /// Corrects the `load` (N) for an inclined surface, at this `grip` force (N): returns the load that would be as
    /// close to slipping on a surface perpendicular to the closing direction. Beside the axis of a cylinder, for
    /// example, pressing pushes the object out.
    pub fn on_surface(&self, load: f64, grip: f64) -> f64 {
        load.max((self.ratio * grip).min(MOST_INCLINED * load))
    }

    /// Grip force required for the load (N). `grip` and `shear` are the present pressing force and shear of a finger
    /// (N).
    pub fn required(&self, grip: f64, shear: f64) -> f64 {
        self.required_at(
            self.config.utilisation,
            [self.friction, self.edge],
            grip,
            shear,
        )
    }

    /// Like [`required`](Self::required), but for a given `friction` coefficient and fraction `utilisation` of the
    /// friction limit that the load may use. Gross slip begins when the shear reaches the limit for the
    /// friction coefficient `edge`.
    ///
    /// During gross slip, friction limits the shear, so the load is unknown. The grip force is then multiplied by a
    /// factor.
    pub fn required_at(
        &self,
        utilisation: f64,
        [friction, edge]: [f64; 2],
        grip: f64,
        shear: f64,
    ) -> f64 {
        let config = &self.config;
        let required = self.load / (utilisation * friction);
        let used = shear / (edge * grip.max(LEAST_GRIP));
        let slip = ((used - config.slip_from) / (1.0 - config.slip_from)).clamp(0.0, 1.0);
        match slip > 0.0 {
            true => required.max((1.0 + slip * (config.slip_gain - 1.0)) * grip),
            false => required,
        }
    }
}

/// Largest ratio of shear to pressing force among groups of elements with similar pressing forces. Each group carries
/// the fraction `group_share` of the pressing force. Sorts `pressed`.
///
/// Single elements are unsuitable: noise and the curvature of the object raise the ratio of some of them and lower that
/// of others with similar pressing forces. The least pressed group is unsuitable, too: elements that have just
/// come into contact carry no shear.
fn edge_ratio(pressed: &mut [(f64, f64)], group_share: f64) -> Option<f64> {
    pressed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let enough = group_share * pressed.iter().map(|element| element.0).sum::<f64>();
    let (mut pressing, mut shear) = (0.0, 0.0);
    let mut largest = None;
    for own in pressed {
        pressing += own.0;
        shear += own.1;
        if pressing >= enough {
            let ratio = shear / pressing;
            largest = Some(largest.map_or(ratio, |other: f64| other.max(ratio)));
            (pressing, shear) = (0.0, 0.0);
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact of 30 elements that are pressed with 0.1 to 1 N and sheared by the same displacement, which would shear
    /// each by `stuck` (N) if it stuck, at a friction of 0.5.
    fn contact(stuck: f64) -> Vec<(f64, f64)> {
        let pressing = (1..=30).map(|n| 0.1 + 0.03 * f64::from(n));
        pressing.map(|n| (n, stuck.min(0.5 * n))).collect()
    }

    #[test]
    fn the_edge_shows_the_friction_as_soon_as_it_slips() {
        // All stick: the ratio is below the friction.
        let sticks = edge_ratio(&mut contact(0.05), 0.2).expect("a ratio");
        assert!(sticks < 0.2, "{sticks}");
        // The least pressed fifth slips, and the total shear is below the limit.
        let mut pressed = contact(0.28);
        let (total, limit): (f64, f64) = pressed
            .iter()
            .fold((0.0, 0.0), |(t, l), own| (t + own.1, l + 0.5 * own.0));
        assert!(total < 0.85 * limit);
        let slips = edge_ratio(&mut pressed, 0.2).expect("a ratio");
        assert!((slips - 0.5).abs() < 1e-12, "{slips}");
    }

    #[test]
    fn a_whole_slip_multiplies_the_grip_and_a_load_is_held() {
        let config = PartialSlipConfig::default();
        let mut estimate = PartialSlip::new(config, 2);
        estimate.update_load(1.0, 0.01);
        let required = estimate.required_at(0.8, [0.5, 0.5], 4.0, 1.0);
        assert!((required - 1.0 / (0.8 * 0.5)).abs() < 1e-12);
        // All of the friction is used: the load is unknown.
        let slipping = estimate.required_at(0.8, [0.5, 0.5], 2.0, 1.0);
        assert!((slipping - config.slip_gain * 2.0).abs() < 1e-12);
    }
}
