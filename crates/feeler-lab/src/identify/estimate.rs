//! Estimates of all quantities with intervals, from the trace of a probing run.

use super::contact::{Contact, contacts};
use super::friction::{Friction, Slide, friction, slides};
use super::identified::{Estimate, FingerEstimates, Identified, ObjectEstimates};
use super::lag::drive_lag;
use super::noise::{Measured, force_noise};
use super::pivot::{Circle, circle};
use super::stiffness::{ContactFit, contact_fit};
use super::trace::{FingerTrace, Trace};
use super::warnings::warnings;
use feeler::control::Stiffness;

/// Half width of a 95 % interval in standard deviations.
const NORMAL: f64 = 1.96;
/// Minimum force on a touching element, in standard deviations of the noise.
const TOUCHES: f64 = 6.0;
/// Lower limit of the minimum force on a touching element (N).
const MIN_TOUCH: f64 = 0.06;

/// Number of times that the forces are aligned with the poses. The alignment is iterated because each fit is accurate
/// only to first order in the delay.
const ALIGNMENTS: usize = 3;

// Model errors, calibrated on plausible simulated hands: factors on standard deviations, and systematic deviations that
// averaging does not reduce.
const NORMAL_STIFFNESS: f64 = 0.006;
const SHEAR_STIFFNESS: f64 = 0.0085;
const HYSTERESIS: (f64, f64) = (1.0, 0.0003);
const DELAY: (f64, f64) = (1.15, 8e-5);
const LAG: f64 = 7e-5;
const FRICTION: (f64, f64) = (1.0, 0.0018);
const PIVOT: (f64, f64) = (0.21, 4e-7);
const RADIUS: f64 = 1.0;

/// A quantity that the run does not determine.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what} cannot be estimated: {reason}")]
pub struct EstimateError {
    /// The quantity and the finger.
    pub what: String,
    /// The missing data and advice.
    pub reason: &'static str,
}

/// Fits to a trace, for plots.
#[derive(Debug, Clone)]
pub struct Fits {
    /// Circle through the tips.
    pub(super) circle: Circle,
    /// Fits of each finger.
    pub(super) fingers: Vec<FingerFits>,
}

/// Fits to the trace of one finger.
#[derive(Debug, Clone)]
pub(super) struct FingerFits {
    /// Periods in which an element sticks to the object.
    pub contacts: Vec<Contact>,
    /// Slides, one per place.
    pub slides: Vec<Slide>,
}

/// Estimates all quantities from the probing run `trace` of `experiment` with `seed`.
///
/// # Errors
/// If the run does not determine a quantity.
pub fn estimate(
    trace: &Trace,
    experiment: &str,
    seed: u64,
) -> Result<(Identified, Fits), EstimateError> {
    let mut pressed = Vec::new();
    for (finger, own) in trace.fingers.iter().enumerate() {
        pressed.push(Pressed::of(own, finger, trace)?);
    }
    let touching: Vec<_> = pressed
        .iter()
        .map(|own| (&own.aligned, own.stiffness(), least_touch(own.noise.value)))
        .collect();
    let circle = circle(&touching).ok_or(EstimateError {
        what: "the pivot".to_string(),
        reason: "too few elements touched; expected a round object between the fingers that is at least as wide as the probe's spacing",
    })?;
    let (mut finger, mut fingers) = (Vec::new(), Vec::new());
    for (index, pressed) in pressed.iter().enumerate() {
        let noise = pressed.noise.value;
        let slides = slides(&pressed.aligned, &circle, pressed.stiffness(), noise);
        let friction = friction(&slides).ok_or_else(|| EstimateError {
            what: format!("the friction of finger {index}"),
            reason: "no element slid; raise task.probe.slide_travel or lower task.probe.slide_depth",
        })?;
        finger.push(pressed.estimates(&friction));
        fingers.push(FingerFits {
            contacts: pressed.contacts.clone(),
            slides,
        });
    }
    let mut identified = Identified {
        experiment: experiment.to_string(),
        seed,
        warnings: Vec::new(),
        object: object(&circle, trace.probe.tip_radius),
        finger,
    };
    identified.warnings = warnings(&identified, trace);
    let fits = Fits { circle, fingers };
    Ok((identified, fits))
}

/// Force above which an element counts as touching (N), from the standard deviation of the `noise` (N).
pub fn least_touch(noise: f64) -> f64 {
    (TOUCHES * noise).max(MIN_TOUCH)
}

/// Results of one finger that do not depend on the others.
struct Pressed {
    /// Periods in which an element sticks to the object.
    contacts: Vec<Contact>,
    /// The trace with forces aligned to the poses at which they were measured.
    aligned: FingerTrace,
    noise: Measured,
    contact: ContactFit,
    lag: Measured,
    delay: Measured,
}

impl Pressed {
    fn of(own: &FingerTrace, finger: usize, trace: &Trace) -> Result<Self, EstimateError> {
        let missing = |what: &str, reason| EstimateError {
            what: format!("{what} of finger {finger}"),
            reason,
        };
        let noise = force_noise(own).ok_or_else(|| {
            missing(
                "the force noise",
                "fewer than ten frames at rest; raise the rate of the sensor",
            )
        })?;
        let drive =
            drive_lag(own).ok_or_else(|| missing("the lag", "the drives received no commands"))?;
        let [smallest, largest] = trace.probe.tip_radius;
        let force = (3.0 * least_touch(noise.value)).min(0.5 * trace.probe.press_force);
        let mut aligned = own.clone();
        let (mut delay, mut fitted) = (0.0, None);
        for _ in 0..ALIGNMENTS {
            let contacts = contacts(&aligned, force, 0.5 * (smallest + largest));
            let mut fit = contact_fit(&contacts).ok_or_else(|| {
                missing(
                    "the contact stiffness",
                    "no element was pressed and sheared without slipping; raise task.probe.press_force",
                )
            })?;
            fit.delay.value += delay;
            delay = fit.delay.value.max(0.0);
            aligned = own.aligned(delay);
            fitted = Some((fit, contacts));
        }
        let (contact, contacts) =
            fitted.ok_or_else(|| missing("the contact stiffness", "no fit was made"))?;
        Ok(Self {
            noise,
            contact,
            lag: drive.lag,
            delay: drive.delay,
            aligned,
            contacts,
        })
    }

    fn stiffness(&self) -> Stiffness {
        Stiffness {
            normal: self.contact.normal.value,
            shear: self.contact.shear.value,
        }
    }

    fn estimates(&self, friction: &Friction) -> FingerEstimates {
        let contact = &self.contact;
        let delay = Measured {
            value: self.delay.value + contact.delay.value,
            deviation: self.delay.deviation.hypot(contact.delay.deviation),
        };
        let relative = |measured: Measured, floor: f64| (measured, (1.0, floor * measured.value));
        let (normal, normal_error) = relative(contact.normal, NORMAL_STIFFNESS);
        let (shear, shear_error) = relative(contact.shear, SHEAR_STIFFNESS);
        let ratio = "ratio of shear to normal force while sliding";
        FingerEstimates {
            force_noise: interval(self.noise, (1.0, 0.0), "variance at rest"),
            normal_stiffness: interval(normal, normal_error, "slope of force over depth"),
            shear_stiffness: interval(shear, shear_error, "slope of force over shear"),
            hysteresis: from_zero(interval(
                contact.hysteresis,
                HYSTERESIS,
                "loop of press and release",
            )),
            static_friction: interval(friction.static_friction, FRICTION, ratio),
            kinetic_friction: interval(friction.kinetic_friction, FRICTION, ratio),
            servo_lag: from_zero(interval(self.lag, (1.0, LAG), "joint angles over commands")),
            dead_time: from_zero(interval(
                delay,
                DELAY,
                "joint angles over commands, forces over depth",
            )),
        }
    }
}

/// Pivot and radius from the circle through the centres of the rounded tips. The radius of the tips is between two
/// bounds (m).
fn object(circle: &Circle, [smallest, largest]: [f64; 2]) -> ObjectEstimates {
    let method = "circle through pressed tips";
    let tip = 0.5 * (smallest + largest);
    let mut radius = circle.radius;
    radius.value -= tip;
    let mut radius = interval(
        radius,
        (RADIUS, 0.0),
        "circle through pressed tips minus the tip radius",
    );
    // The tip radius is uniformly distributed between its bounds.
    let half = (0.5 * 0.95 * (largest - smallest)).hypot(0.5 * (radius.high - radius.low));
    (radius.low, radius.high) = (radius.value - half, radius.value + half);
    ObjectEstimates {
        pivot_x: interval(circle.x, PIVOT, method),
        pivot_y: interval(circle.y, PIVOT, method),
        radius,
    }
}

/// Returns the estimate of a quantity with its 95 % interval. Its standard deviation is the root sum square of `floor`
/// and `factor` times the measured standard deviation.
fn interval(measured: Measured, (factor, floor): (f64, f64), method: &str) -> Estimate {
    let half = NORMAL * (factor * measured.deviation).hypot(floor);
    Estimate {
        value: measured.value,
        low: measured.value - half,
        high: measured.value + half,
        method: method.to_string(),
    }
}

/// Restricts the estimate of a non-negative quantity. If noise makes the value negative, the interval begins at 0 and
/// keeps half its width.
fn from_zero(estimate: Estimate) -> Estimate {
    let half = estimate.high - estimate.value;
    let value = estimate.value.max(0.0);
    Estimate {
        value,
        low: estimate.low.max(0.0),
        high: value + half,
        ..estimate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_combines_both_deviations() {
        let measured = Measured {
            value: 5.0,
            deviation: 0.3,
        };
        let estimate = interval(measured, (1.0, 0.4), "method");
        assert!((estimate.high - 5.0 - 1.96 * 0.5).abs() < 1e-12);
        assert!((5.0 - estimate.low - 1.96 * 0.5).abs() < 1e-12);
        let clipped = from_zero(Estimate {
            value: -0.1,
            low: -0.5,
            ..estimate
        });
        assert_eq!((clipped.value, clipped.low), (0.0, 0.0));
        assert!(clipped.high > 0.0, "{clipped:?}");
    }

    #[test]
    fn the_tip_radius_is_subtracted_from_the_object_radius() {
        let exact = |value| Measured {
            value,
            deviation: 0.0,
        };
        let circle = Circle {
            x: exact(0.001),
            y: exact(0.0),
            radius: exact(0.016),
            points: Vec::new(),
        };
        let known = object(&circle, [0.002, 0.002]).radius;
        assert!((known.value - 0.014).abs() < 1e-12 && (known.high - known.low).abs() < 1e-12);
        let unknown = object(&circle, [0.001, 0.003]).radius;
        assert!((unknown.value - 0.014).abs() < 1e-12);
        assert!((unknown.high - 0.01495).abs() < 1e-12, "{unknown:?}");
    }
}
