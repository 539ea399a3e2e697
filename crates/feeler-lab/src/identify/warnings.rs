//! Warnings about the results of a probing run.

use super::identified::{Estimate, FingerEstimates, Identified};
use super::trace::Trace;
use glam::{DVec2, DVec3};

/// Maximum ratio between the properties of a hand's fingers without a warning.
const ALIKE: f64 = 1.3;
/// Minimum ratio of F1 to the force noise.
const ABOVE_NOISE: f64 = 5.0;
/// Coefficient of kinetic friction below which a fingertip hardly grips.
const LITTLE_FRICTION: f64 = 0.3;
/// Hysteresis above which control is affected, relative to the work of pressing.
const MUCH_HYSTERESIS: f64 = 0.3;
/// Maximum dead time in control periods.
const LATE_PERIODS: f64 = 3.0;
/// Maximum distance of the object's axis from the centre of the home positions (m).
const OFF_CENTRE: f64 = 0.002;

/// Returns all warnings about `identified`, which was estimated from `trace`.
pub fn warnings(identified: &Identified, trace: &Trace) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut fingers = identified.finger.iter().enumerate();
    if let Some((_, first)) = fingers.next() {
        for (index, finger) in fingers {
            warnings.extend(differences(first, (index, finger)));
        }
    }
    for (index, finger) in identified.finger.iter().enumerate() {
        warnings.extend(of_finger(index, finger, trace));
    }
    warnings.extend(off_centre(identified, trace));
    warnings
}

fn differences(first: &FingerEstimates, (index, finger): (usize, &FingerEstimates)) -> Vec<String> {
    let compared = [
        (
            "as stiff along its elements",
            &finger.normal_stiffness,
            &first.normal_stiffness,
            "check how its fingertip is mounted, and its calibration",
        ),
        (
            "as stiff across its elements",
            &finger.shear_stiffness,
            &first.shear_stiffness,
            "check its calibration",
        ),
        (
            "as rough",
            &finger.kinetic_friction,
            &first.kinetic_friction,
            "look for wear and dirt on both fingertips",
        ),
        (
            "as slow to follow commands",
            &finger.servo_lag,
            &first.servo_lag,
            "compare the settings of the drives",
        ),
    ];
    let differing = compared
        .into_iter()
        .filter_map(|(what, own, other, advice)| {
            let ratio = own.value / other.value;
            let apart = own.low > other.high || own.high < other.low;
            (apart && !(1.0 / ALIKE..=ALIKE).contains(&ratio))
                .then(|| format!("finger {index} is {ratio:.1} times {what} as finger 0: {advice}"))
        });
    differing.collect()
}

fn of_finger(index: usize, finger: &FingerEstimates, trace: &Trace) -> Vec<String> {
    let mut warnings = Vec::new();
    let (noise, touch) = (finger.force_noise.value, trace.touch_force);
    if touch < ABOVE_NOISE * noise {
        warnings.push(format!(
            "the force noise of finger {index}, {:.1} mN, is more than a fifth of control.touch_force = {touch} N: raise that to {:.2} N or more",
            1e3 * noise,
            ABOVE_NOISE * noise
        ));
    }
    let friction = finger.kinetic_friction.value;
    if friction < LITTLE_FRICTION {
        warnings.push(format!(
            "finger {index} has a kinetic friction of only {friction:.2}: clean its fingertip and the object"
        ));
    }
    if finger.hysteresis.low > MUCH_HYSTERESIS {
        warnings.push(format!(
            "finger {index} loses {:.0} % of the work of pressing: its contact stiffness depends on speed",
            1e2 * finger.hysteresis.value
        ));
    }
    let late = finger.dead_time.value;
    if late > LATE_PERIODS * trace.period {
        warnings.push(format!(
            "the forces of finger {index} follow commands after {:.0} ms, {:.1} control periods: look for delays in camera and drives",
            1e3 * late,
            late / trace.period
        ));
    }
    warnings
}

fn off_centre(identified: &Identified, trace: &Trace) -> Option<String> {
    let homes = trace
        .probe
        .finger
        .iter()
        .map(|path| DVec3::from_array(path.home));
    // The home of a single finger does not determine the expected position of the axis.
    let count = trace.probe.finger.len();
    let middle = homes.sum::<DVec3>().truncate() / count as f64;
    let at = |estimate: &Estimate| estimate.value;
    let pivot = DVec2::new(
        at(&identified.object.pivot_x),
        at(&identified.object.pivot_y),
    );
    let off = pivot.distance(middle);
    (count > 1 && off > OFF_CENTRE).then(|| {
        format!(
            "the object's axis is {:.1} mm off the middle of the fingers' homes: move the object or the homes",
            1e3 * off
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::identified::ObjectEstimates;
    use super::*;
    use feeler::control::ControlConfig;
    use feeler::control::task::probe::ProbeConfig;
    use feeler::control::task::screw::FingerPathConfig;

    fn exactly(value: f64) -> Estimate {
        Estimate {
            value,
            low: 0.99 * value,
            high: 1.01 * value,
            method: String::new(),
        }
    }

    fn finger() -> FingerEstimates {
        FingerEstimates {
            force_noise: exactly(0.002),
            normal_stiffness: exactly(205.0),
            shear_stiffness: exactly(127.0),
            hysteresis: exactly(0.0),
            static_friction: exactly(1.1),
            kinetic_friction: exactly(0.8),
            servo_lag: exactly(0.012),
            dead_time: exactly(0.0),
        }
    }

    fn warnings_of(second: FingerEstimates, pivot_x: f64) -> Vec<String> {
        let path = |x: f64| FingerPathConfig {
            home: [x, 0.0, 0.1],
            approach: [-x.signum(), 0.0, 0.0],
            stroke: [0.0, x.signum(), 0.0],
        };
        let probe = ProbeConfig::gentle(vec![path(-0.038), path(0.038)], 0.5);
        let trace = Trace::new(&probe, &ControlConfig::default(), &[]);
        let identified = Identified {
            experiment: "a-hand".to_string(),
            seed: 0,
            warnings: Vec::new(),
            object: ObjectEstimates {
                pivot_x: exactly(pivot_x),
                pivot_y: exactly(0.0),
                radius: exactly(0.014),
            },
            finger: vec![finger(), second],
        };
        warnings(&identified, &trace)
    }

    #[test]
    fn a_nominal_hand_gives_no_warning() {
        assert_eq!(warnings_of(finger(), 0.0003), Vec::<String>::new());
    }

    #[test]
    fn each_warning_contains_advice() {
        let odd = FingerEstimates {
            normal_stiffness: exactly(410.0),
            force_noise: exactly(0.05),
            dead_time: exactly(0.05),
            ..finger()
        };
        let found = warnings_of(odd, 0.003);
        assert_eq!(
            found[0],
            "finger 1 is 2.0 times as stiff along its elements as finger 0: check how its fingertip is mounted, and its calibration"
        );
        assert!(
            found[1].starts_with("the force noise of finger 1, 50.0 mN, is"),
            "{found:?}"
        );
        assert!(
            found[2].starts_with("the forces of finger 1 follow commands after 50 ms"),
            "{found:?}"
        );
        assert!(
            found[3].starts_with("the object's axis is 3.0 mm off the middle"),
            "{found:?}"
        );
        assert_eq!(found.len(), 4);
    }
}
