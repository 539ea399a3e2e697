//! Contact stiffness, hysteresis and delay of the forces, from force over displacement while elements stick.

use super::contact::{Contact, Sample};
use super::fit::{Fit, Stretch};
use super::noise::Measured;
use feeler::control::task::probe::Step;
use glam::DVec3;

/// Contact properties of one finger's elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactFit {
    /// Stiffness along the element's axis (N/m).
    pub normal: Measured,
    /// Stiffness across the element's axis (N/m).
    pub shear: Measured,
    /// Work lost in a cycle, relative to the work of pressing.
    pub hysteresis: Measured,
    /// Delay of the forces relative to the joint angles (s).
    pub delay: Measured,
}

/// Fits the contacts of one finger. Returns `None` if they do not determine the stiffness.
///
/// The model is `F_z = k_n (z - d dz/dt) + h s` plus a constant per contact, where `s` is the direction of motion. A
/// delay `d` shifts the force in proportion to the speed; friction in the rubber shifts it by a constant `h`. Pressing
/// at two speeds separates the two.
pub fn contact_fit(contacts: &[Contact]) -> Option<ContactFit> {
    let normal = contacts.iter().map(normal_stretch).collect();
    let shear = contacts.iter().flat_map(shear_stretches).collect();
    let (along, normal) = Fit::of_consistent(normal, 3)?;
    let (across, shear) = Fit::of_consistent(shear, 2)?;
    let [stiffness, lagging, friction] = along.coefficients.to_array();
    if !(stiffness > 0.0 && across.coefficients.x > 0.0) {
        return None;
    }
    let load = mean_load(contacts);
    Some(ContactFit {
        normal: Measured {
            value: stiffness,
            deviation: along.deviations.x.hypot(spread(&normal, 3, stiffness)),
        },
        shear: Measured {
            value: across.coefficients.x,
            deviation: (across.deviations.x).hypot(spread(&shear, 2, across.coefficients.x)),
        },
        // The loop is 2 h high, and the work of pressing is the mean load times the travel.
        hysteresis: Measured {
            value: 2.0 * friction / load,
            deviation: 2.0 * along.deviations.z / load,
        },
        delay: Measured {
            value: -lagging / stiffness,
            deviation: along.deviations.y / stiffness,
        },
    })
}

fn direction(step: Step) -> f64 {
    match step {
        Step::Press | Step::PressFast => 1.0,
        Step::Release | Step::Ease => -1.0,
        _ => 0.0,
    }
}

fn is_pressed_or_released(sample: &&Sample) -> bool {
    direction(sample.step) != 0.0
}

fn normal_stretch(contact: &Contact) -> Stretch {
    let mut stretch = Stretch::default();
    for sample in contact.samples.iter().filter(is_pressed_or_released) {
        let row = DVec3::new(sample.moved.z, sample.rate.z, direction(sample.step));
        stretch.add(row, sample.force.z);
    }
    stretch
}

/// Returns both shear components of a contact. They have the same stiffness but different offsets.
fn shear_stretches(contact: &Contact) -> [Stretch; 2] {
    let mut stretches = [Stretch::default(), Stretch::default()];
    let sheared = |sample: &&Sample| matches!(sample.step, Step::Shear | Step::ShearBack);
    for sample in contact.samples.iter().filter(sheared) {
        for (axis, stretch) in stretches.iter_mut().enumerate() {
            let row = DVec3::new(sample.moved[axis], sample.rate[axis], 0.0);
            stretch.add(row, -sample.force[axis]);
        }
    }
    stretches
}

/// Mean `F_z` of the elements while they are pressed (N).
fn mean_load(contacts: &[Contact]) -> f64 {
    let samples = contacts.iter().flat_map(|contact| &contact.samples);
    let pressed = samples.filter(|sample| direction(sample.step) > 0.0);
    let (sum, count) = pressed.fold((0.0, 0.0), |(sum, count), sample| {
        (sum + sample.force.z, count + 1.0)
    });
    sum / f64::max(count, 1.0)
}

/// Standard error of the first coefficient, from its scatter over the contacts about the `pooled` value.
fn spread(stretches: &[Stretch], used: usize, pooled: f64) -> f64 {
    let fits = stretches
        .iter()
        .filter_map(|stretch| Fit::of(std::slice::from_ref(stretch), used));
    let (mut weights, mut squares, mut count) = (0.0, 0.0, 0.0);
    for fit in fits.filter(|fit| fit.deviations.x < pooled) {
        let weight = fit.deviations.x.max(1e-3 * pooled).powi(-2);
        weights += weight;
        squares += weight * (fit.coefficients.x - pooled).powi(2);
        count += 1.0;
    }
    if count < 2.0 {
        return 0.0;
    }
    (squares / weights / (count - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact with stiffnesses of 200 and 100 N/m that is pressed, released, pressed at twice the speed, sheared
    /// and eased. Its forces are delayed by `delay` and differ by `2 friction` between pressing and releasing.
    fn contact(delay: f64, friction: f64) -> Contact {
        let steps = [
            (Step::Press, DVec3::new(0.0, 0.0, 0.0015), 100),
            (Step::Release, DVec3::new(0.0, 0.0, -0.0015), 80),
            (Step::PressFast, DVec3::new(0.0, 0.0, 0.003), 40),
            (Step::Shear, DVec3::new(0.002, 0.001, 0.0), 20),
            (Step::ShearBack, DVec3::new(-0.002, -0.001, 0.0), 20),
            (Step::Ease, DVec3::new(0.0, 0.0, -0.003), 40),
        ];
        let mut moved = DVec3::new(0.0, 0.0, 0.0003);
        let mut samples = Vec::new();
        for (step, rate, count) in steps {
            for _ in 0..count {
                moved += 0.01 * rate;
                let behind = moved - delay * rate;
                let force = DVec3::new(-100.0 * behind.x, -100.0 * behind.y, 200.0 * behind.z);
                samples.push(Sample {
                    step,
                    moved,
                    rate,
                    force: force + DVec3::Z * friction * direction(step),
                });
            }
        }
        Contact { samples }
    }

    #[test]
    fn stiffness_delay_and_hysteresis_of_exact_forces_are_exact() {
        for (delay, friction) in [(0.0, 0.0), (0.012, 0.0), (0.004, 0.01)] {
            let contacts = [contact(delay, friction)];
            let fit = contact_fit(&contacts).expect("a fit");
            assert!((fit.normal.value - 200.0).abs() < 1e-6, "{fit:?}");
            assert!((fit.shear.value - 100.0).abs() < 1e-6, "{fit:?}");
            assert!((fit.delay.value - delay).abs() < 1e-9, "{fit:?}");
            let lost = 2.0 * friction / mean_load(&contacts);
            assert!((fit.hysteresis.value - lost).abs() < 1e-9, "{fit:?}");
        }
    }

    #[test]
    fn no_stiffness_without_pressed_elements() {
        assert_eq!(contact_fit(&[]), None);
    }
}
