//! Rejection of uniform fields by the mean over all taxels.

use feeler::sensor::taxel::{BuiltInTaxels, TaxelChain, TaxelLayout};
use glam::{DMat2, DVec2, DVec3};

/// A uniform field, µT, in the frame of the skin: x and y tangential, z outward. Its magnitude is 50 µT, that of the
/// earth.
const FIELD: DVec3 = DVec3::new(30.0, 0.0, 40.0);

fn anyskin(common_mode: bool) -> TaxelLayout {
    let mut layout = BuiltInTaxels::named("anyskin").unwrap().layout().unwrap();
    layout.common_mode = common_mode;
    layout
}

/// Readings of the chips in a uniform `field`, with rotations written out here.
fn readings(layout: &TaxelLayout, field: DVec3) -> Vec<DVec3> {
    let taxels = layout.taxels.iter().enumerate();
    let reading = |(index, taxel): (usize, &feeler::sensor::taxel::Taxel)| {
        let turned = DMat2::from_angle(-taxel.turn_deg.to_radians()) * field.truncate();
        let magnets = DVec3::new(100.0, -250.0, 900.0) * (1.0 + index as f64);
        magnets + turned.extend(field.z)
    };
    taxels.map(reading).collect()
}

/// Forces after the zero was measured without a field, and `values` follow.
fn forces(layout: &TaxelLayout, values: &[DVec3]) -> Vec<DVec3> {
    let mut chain = TaxelChain::new(layout).unwrap();
    let mut forces = vec![DVec3::NAN; layout.taxels.len()];
    for row in 0..layout.zero.rows {
        chain.sense(f64::from(row), &readings(layout, DVec3::ZERO), &mut forces);
    }
    assert!(chain.has_zeros());
    chain.sense(100.0, values, &mut forces);
    forces
}

fn largest(forces: &[DVec3]) -> f64 {
    forces
        .iter()
        .map(|force| force.length())
        .fold(0.0, f64::max)
}

#[test]
fn a_uniform_field_is_rejected() {
    let (with, without) = (anyskin(true), anyskin(false));
    let values = readings(&with, FIELD);
    let before = largest(&forces(&without, &values));
    let after = largest(&forces(&with, &values));
    println!("error of 50 uT: {before} counts without, {after} counts with common mode");
    assert!((before - 50.0).abs() < 1e-9, "{before}");
    assert!(after < 1e-9, "{after}");
}

/// A reading on one of five taxels loses a fifth, which appears on the others.
#[test]
fn a_press_on_one_taxel_is_reduced_by_its_share() {
    let layout = anyskin(true);
    let mut values = readings(&layout, FIELD);
    values[2] += layout.in_columns(2, DVec3::new(0.0, 10.0, 100.0));
    let forces = forces(&layout, &values);
    for (taxel, force) in forces.iter().enumerate() {
        let part = if taxel == 2 { 0.8 } else { -0.2 };
        let expected = part * DVec3::new(0.0, 10.0, 100.0);
        assert!((force - expected).length() < 1e-9, "{taxel}: {force}");
    }
}

#[test]
fn missing_taxels_are_left_out_of_the_mean() {
    let layout = anyskin(true);
    let mut values = readings(&layout, FIELD);
    values[0] = DVec3::NAN;
    let forces = forces(&layout, &values);
    assert!(forces[0].is_nan());
    assert!(largest(&forces[1..]) < 1e-9, "{forces:?}");
    // Two taxels are too few.
    values[1..3].fill(DVec3::NAN);
    assert!(
        self::forces(&layout, &values)
            .iter()
            .all(|force| force.is_nan())
    );
}

/// Counts per newton apply to the remaining reading, and signed, permuted axes are inverted exactly.
#[test]
fn scales_and_axes_are_taken_into_account() {
    let text = BuiltInTaxels::named("anyskin").unwrap().text;
    let text = text.replace(
        r#"axes = { x = "x", y = "y", z = "z" }"#,
        "axes = { x = \"-y\", y = \"x\", z = \"-z\" }\ncounts_per_newton = [10, 20, 40]\ncommon_mode = true",
    );
    let layout = TaxelLayout::from_toml(&text).unwrap();
    let zero = vec![DVec3::ZERO; 5];
    let mut chain = TaxelChain::new(&layout).unwrap();
    let mut forces = zero.clone();
    for row in 0..10 {
        chain.sense(f64::from(row), &zero, &mut forces);
    }
    let field: Vec<_> = (0..5)
        .map(|taxel| layout.in_columns(taxel, FIELD))
        .collect();
    // The columns of taxel 4, which is not turned, are those of its axes.
    assert!((field[4] - DVec3::new(FIELD.y, -FIELD.x, -FIELD.z)).length() < 1e-12);
    assert!((field[0].truncate().length() - FIELD.truncate().length()).abs() < 1e-12);
    chain.sense(10.0, &field, &mut forces);
    assert!(largest(&forces) < 1e-9, "{forces:?}");
    let mut pressed = field.clone();
    pressed[4] += DVec3::new(0.0, 0.0, -100.0);
    chain.sense(11.0, &pressed, &mut forces);
    // 80 counts remain, at 40 counts per newton.
    assert!(
        (forces[4] - DVec3::new(0.0, 0.0, 2.0)).length() < 1e-9,
        "{}",
        forces[4]
    );
    let turned = DVec2::new(1.0, 0.0);
    assert!(layout.in_columns(9, turned.extend(0.0)).is_nan());
}

#[test]
fn layouts_that_cannot_reject_a_field_are_refused() {
    let mut layout = anyskin(true);
    layout.taxels[1].normal = [0.8, 0.6, 0.0];
    let error = TaxelChain::new(&layout).unwrap_err().to_string();
    assert!(
        error.contains("common_mode") && error.contains("same normal"),
        "{error}"
    );
    let mut layout = anyskin(true);
    layout.taxels.truncate(2);
    assert!(TaxelChain::new(&layout).is_err());
}

/// A calibration for readings with the common mode does not fit readings without it; old calibrations remain valid.
#[test]
fn calibrations_depend_on_the_common_mode() {
    let target = |layout: &TaxelLayout| layout.calibration_target().unwrap().sha256;
    assert_ne!(target(&anyskin(true)), target(&anyskin(false)));
    let mut moved = anyskin(false);
    moved.serial = None;
    assert_eq!(target(&moved), target(&anyskin(false)));
}
