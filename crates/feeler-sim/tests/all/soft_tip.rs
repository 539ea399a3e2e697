//! A soft tip pressed on a plate, sheared and twisted, compared with an elastic foundation: a bed of independent springs
//! (K. L. Johnson, Contact Mechanics, section 4.3), the limit of many columnar feelers.
//!
//! Springs of equal normal and shear stiffness act like `K d` in any direction, so formulas hold for inclined ones too. On
//! a sphere, equal areas have equal ranges of compression, which is therefore uniform between 0 and the depth.

use crate::soft_tip_scene::{DEPTH, FRICTION, RADIUS, SoftTip, dense_layout, reference_layout};
use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use std::f64::consts::TAU;

const STIFFNESS: f64 = 5.0;
const STEP: f64 = 1e-3;
/// Distance of neighbouring elements (m).
const APART: f64 = 4.05e-4;

/// Relative error of a sum over elements in place of an integral over the contact: by the Euler-Maclaurin formula, the
/// square of their distance over the radius.
fn discretization(depth: f64) -> f64 {
    APART * APART / (2.0 * RADIUS * depth)
}

fn even_tip() -> SoftTip {
    let layout = ElementLayout::new(&dense_layout());
    SoftTip::with_stiffness(layout, [STIFFNESS; 2], STEP)
}

/// Presses in `steps` steps to `depth`.
fn press(tip: &mut SoftTip, depth: f64, steps: u32) {
    for step in 1..=steps {
        tip.advance(depth * f64::from(step) / f64::from(steps), 0.0, 0.0);
    }
}

/// Number of elements per area (1/m²).
fn density() -> f64 {
    1.0 / (APART * APART)
}

#[test]
fn the_load_is_that_of_an_elastic_foundation() {
    for depth in [0.25e-3, 0.5e-3, 1e-3] {
        let mut tip = even_tip();
        press(&mut tip, depth, 100);
        let expected = STIFFNESS * density() * TAU * RADIUS * depth * depth / 2.0;
        let reading = tip.read();
        let error = -reading.force.z / expected - 1.0;
        assert!(error.abs() < discretization(depth), "{depth} m: {error}");
        let inside = (2.0 * RADIUS * depth).sqrt() - reading.radius;
        assert!((0.0..APART).contains(&inside), "{depth} m: {inside} m");
    }
}

/// Elements slip from the rim inward, each at its own limit: Q = mu N (1 - (1 - x / x_s)^2) with x_s = mu times the
/// depth.
#[test]
fn shear_rises_and_breaks_as_on_an_elastic_foundation() {
    let mut tip = even_tip();
    press(&mut tip, DEPTH, 100);
    let load = -tip.read().force.z;
    for step in 1..=150 {
        let travel = 1e-5 * f64::from(step);
        tip.advance(DEPTH, travel, 0.0);
        let reading = tip.read();
        let left = (1.0 - travel / (FRICTION * DEPTH)).max(0.0);
        let expected = FRICTION * load * (1.0 - left * left);
        let error = (reading.force.x - expected) / (FRICTION * load);
        assert!(error.abs() < discretization(DEPTH), "{travel} m: {error}");
        // The slip ends within 1e-9 of each element's normal force.
        assert!(reading.force.x <= FRICTION * load * (1.0 + 1e-9));
    }
    let broken = tip.read().force.x / (FRICTION * load);
    assert!((broken - 1.0).abs() < 1e-8, "{broken}");
}

/// An element dragged around a circle of radius r with a displacement d of its tip ends on a circle of radius sqrt(r² -
/// d²), along which its friction acts. Without this lag the moment would be 8/15 mu N a.
#[test]
fn torsion_breaks_at_the_moment_of_sliding_elements() {
    let mut tip = even_tip();
    press(&mut tip, DEPTH, 100);
    let load = -tip.read().force.z;
    for step in 1..=2000 {
        tip.advance(DEPTH, 0.0, 3.0 * TAU * f64::from(step) / 2000.0);
    }
    // Midpoint rule over the uniform compression.
    let parts = 10_000;
    let arms = (0..parts).map(|part| {
        let pressed = DEPTH * (f64::from(part) + 0.5) / f64::from(parts);
        let height = RADIUS - DEPTH + pressed;
        let lag = FRICTION * pressed;
        let arm = (RADIUS * RADIUS - height * height - lag * lag).max(0.0);
        2.0 * pressed / DEPTH * arm.sqrt()
    });
    let expected = FRICTION * load * arms.sum::<f64>() / f64::from(parts);
    let error = tip.read().moment / expected - 1.0;
    assert!(error.abs() < discretization(DEPTH), "{error}");
    let ideal = 8.0 / 15.0 * FRICTION * load * (2.0 * RADIUS * DEPTH).sqrt();
    assert!((0.9..1.0).contains(&(expected / ideal)));
}

/// Readings of a tip that is pressed, then sheared and twisted at once.
fn sheared_and_twisted(layout: &LayoutConfig, step: f64) -> Vec<[f64; 3]> {
    let mut tip = SoftTip::new(layout, step);
    let steps = (1.0 / step).round() as u32;
    press(&mut tip, DEPTH, steps);
    let mut readings = Vec::new();
    for number in 1..=steps {
        let share = f64::from(number) / f64::from(steps);
        tip.advance(DEPTH, 2e-3 * share, 0.2 * share);
        let reading = tip.read();
        let sum = reading.elements - reading.force;
        // Rounding of a few hundred forces of a few millinewtons.
        assert!(sum.length() < 1e-12, "{sum}");
        if number % (steps / 10) == 0 {
            readings.push([reading.force.z, reading.force.x, 1e3 * reading.moment]);
        }
    }
    readings
}

/// The elements' forces sum to the load in every step. Loads (N) and moments (N·mm) depend on the step because sliding
/// elements follow their curved path by backward Euler, with an error of first order: at most 4 um of travel per step, of
/// about 1 mm over which the direction of friction changes. Elements that stick have none, which leaves a quarter.
#[test]
fn elements_sum_to_the_load_and_do_not_depend_on_the_step() {
    for layout in [dense_layout(), reference_layout()] {
        let fine = sheared_and_twisted(&layout, 5e-4);
        let coarse = sheared_and_twisted(&layout, 2e-3);
        for (fine, coarse) in fine.iter().zip(&coarse) {
            for (fine, coarse) in fine.iter().zip(coarse) {
                assert!((fine - coarse).abs() < 1e-3, "{fine} and {coarse}");
            }
        }
    }
}

/// Contact of a tip that is pressed to [`DEPTH`], then sheared by `travel` in steps, or turned by `turn`.
fn contact(estimator: &mut ContactEstimator, travel: f64, turn: f64) -> (Contact, SoftTip) {
    let mut tip = even_tip();
    press(&mut tip, DEPTH, 100);
    let mut contact = None;
    for step in 1..=100 {
        let share = f64::from(step) / 100.0;
        tip.advance(DEPTH, travel * share, turn * share);
        contact = estimator.estimate(&tip.forces());
    }
    (contact.expect("a contact"), tip)
}

/// Equal areas have equal ranges of compression; elements with less than the travel over mu slide. The coefficient is
/// found from the elements that slide first.
#[test]
fn estimated_contact_slides_and_measures_as_on_an_elastic_foundation() {
    let layout = ElementLayout::new(&dense_layout());
    let radius = (2.0 * RADIUS * DEPTH).sqrt();
    for part in [0.3, 0.6, 0.9] {
        let mut estimator = ContactEstimator::new(layout.places(), 1e-6);
        let (contact, tip) = contact(&mut estimator, part * FRICTION * DEPTH, 0.0);
        let friction = contact.friction.expect("the rim slides");
        // The median includes elements that began to slide since the last evaluation.
        assert!((friction / FRICTION - 1.0).abs() < 0.02, "{friction}");
        let sliding = contact.sliding.expect("friction is known");
        // One ring of elements of 12 within the contact, at most a twelfth of the area times 2.
        assert!((sliding - part).abs() < 0.1, "{part}: {sliding}");
        let force = tip.read().force;
        // x of `T` points down, y along x of the plate.
        assert!(
            (contact.force.x + force.z.abs()).abs() < 1e-9,
            "{} {force}",
            contact.force
        );
        assert!(
            (contact.force.y + force.x).abs() < 1e-9,
            "{} {force}",
            contact.force
        );
        // The pressure is parabolic, for which the semi-axes are sqrt(5/6) too short.
        let ellipse = contact.ellipse.expect("the elements resolve the extent");
        for semi_axis in ellipse.semi_axes {
            let error = semi_axis / (radius * (5.0_f64 / 6.0).sqrt()) - 1.0;
            assert!(error.abs() < 0.05, "{error}");
        }
        assert!((contact.centre - RADIUS * contact.normal).length() < 1e-3 * RADIUS);
    }
}

#[test]
fn estimated_torsion_is_that_of_the_plate() {
    let layout = ElementLayout::new(&dense_layout());
    let mut estimator = ContactEstimator::new(layout.places(), 1e-6);
    let (contact, tip) = contact(&mut estimator, 0.0, 0.3);
    let moment = tip.read().moment;
    // The elements' forces act on their deflected tips, at most mu times the depth from the undeflected ones.
    let tolerance = FRICTION * DEPTH / (2.0 * RADIUS * DEPTH).sqrt();
    // The plate's moment about z is opposite to that on the tip; the normal is -z.
    assert!(
        (contact.torsion / moment - 1.0).abs() < tolerance,
        "{} {moment}",
        contact.torsion
    );
}
