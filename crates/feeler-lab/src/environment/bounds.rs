//! Bounds of the numbers of an observation.
//!
//! The bounds follow from the experiment: compression of a feeler is limited by the dome's diameter and its shear
//! force by friction; joints are within their limits, and velocities within the speed limits. Values that vary between
//! episodes (stiffness, friction) may be up to [`VARIED`] times those of the experiment.

use super::Environment;
use crate::config::ExperimentConfig;
use feeler::hand::FingerGeometry;

/// Margin for varied values, as a factor of the experiment's values.
const VARIED: f64 = 2.0;
/// Margin for force noise, in standard deviations.
const NOISE: f64 = 10.0;
/// Margin for joint noise, relative to the joint ranges and speed limits.
const JOINT_NOISE: f64 = 0.1;

/// Computes the bounds for one finger.
struct Bounds<'a> {
    config: &'a ExperimentConfig,
    geometry: &'a FingerGeometry,
    finger: usize,
    elements: usize,
}

impl Environment {
    /// Returns the minimum and maximum of each number of an [`observation`](Self::observation). All are finite.
    pub fn observation_bounds(&self) -> (Vec<f32>, Vec<f32>) {
        let controller = self.session.control_loop().controller();
        let fingers = controller.fingers().iter().zip(&self.layouts).enumerate();
        let numbers = fingers.flat_map(|(finger, (control, layout))| {
            let bounds = Bounds {
                config: &self.experiment().config,
                geometry: control.geometry(),
                finger,
                elements: layout.elements,
            };
            let parts = layout.parts().into_iter();
            parts.flat_map(move |part| bounds.of_part(part.name, part.range.len()))
        });
        numbers.map(|(low, high)| (low as f32, high as f32)).unzip()
    }
}

impl Bounds<'_> {
    /// Returns the minimum and maximum of each of the `length` numbers of `part`.
    fn of_part(&self, part: &str, length: usize) -> Vec<(f64, f64)> {
        let both = |most: f64| (-most, most);
        let joint = |joint: usize| {
            let lower = self.geometry.joint_lower()[joint];
            let upper = self.geometry.joint_upper()[joint];
            let room = JOINT_NOISE * (upper - lower);
            (lower - room, upper + room)
        };
        let speeds = self.geometry.joint_speed_limit();
        let speed = |joint: usize| both((1.0 + JOINT_NOISE) * speeds[joint]);
        match part {
            "forces" => {
                let [shear, normal] = self.forces();
                let element = [both(shear), both(shear), both(normal)];
                element.into_iter().cycle().take(length).collect()
            }
            "grasp_force" => vec![both(self.elements as f64 * self.forces()[1])],
            "joint_angles" => (0..length).map(joint).collect(),
            "joint_velocities" => (0..length).map(speed).collect(),
            "last_action" | "planned_velocity" => vec![both(self.fingertip_speed()); length],
            "towards_object" => vec![both(1.0); length],
            // Flags, and the requests of a plan.
            _ => vec![(0.0, 1.0); length],
        }
    }

    /// Maximum shear force and maximum compression of an element (N).
    fn forces(&self) -> [f64; 2] {
        let sensor = &self.config.sensor;
        let diameter = 2.0 * sensor.fingertip(self.finger).layout.dome_radius;
        let sim = self.config.sim.as_ref();
        let feeler = sim.map(|sim| &sim.feeler);
        let (stiffness, friction) = feeler.map_or((0.0, 0.0), |feeler| {
            (feeler.normal_stiffness, feeler.static_friction)
        });
        let noise = sim.map_or(0.0, |sim| {
            let noise = &sim.direct_sensing;
            NOISE * noise.normal_noise.max(noise.shear_noise)
        });
        let normal = VARIED * stiffness * diameter;
        [friction.max(1.0) * normal + noise, normal + noise]
    }

    /// Maximum speed of the fingertip along an axis (m/s): the speed limit along each of three axes, or the speed that
    /// results from all joints at their speed limits at full reach, whichever is larger.
    fn fingertip_speed(&self) -> f64 {
        let limit = 3_f64.sqrt() * self.config.control.limits.fingertip_speed;
        let arms = self.geometry.lever_arms(0.0);
        let longest = arms.max_element();
        limit.max(longest * self.geometry.joint_speed_limit().iter().sum::<f64>())
    }
}
