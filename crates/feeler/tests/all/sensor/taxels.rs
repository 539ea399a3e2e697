//! Conversion of a taxel array's columns to forces.

use feeler::control::{FlagAnalyzer, FlagThresholds};
use feeler::sensor::forces::{TactileFrame, TactileSensor};
use feeler::sensor::taxel::{TaxelChain, TaxelLayout, TaxelSensor, TaxelUnit};
use glam::DVec3;

/// Layout of two taxels, with `keys` before the columns.
pub fn layout(keys: &str, taxel: &str) -> TaxelLayout {
    let text = format!(
        "version = 1\nname = 'two'\n{keys}\ncolumns = {{ x = '{{prefix}}t{{n}}_x', y = '{{prefix}}t{{n}}_y', \
         z = '{{prefix}}t{{n}}_z' }}\ntaxel = [{{ place = [0.0, -0.002, 0.0]{taxel} }}, \
         {{ place = [0.0, 0.002, 0.0]{taxel} }}]\n"
    );
    TaxelLayout::from_toml(&text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Forces on both taxels for each row with these columns of the first taxel; the columns of the second are 0.
fn sense(layout: &TaxelLayout, rate: f64, rows: &[DVec3]) -> Vec<[DVec3; 2]> {
    let mut chain = TaxelChain::new(layout).unwrap();
    let mut forces = [DVec3::ZERO; 2];
    let sensed = rows.iter().enumerate().map(|(number, &row)| {
        chain.sense(number as f64 / rate, &[row, DVec3::ZERO], &mut forces);
        forces
    });
    sensed.collect()
}

fn close(actual: DVec3, expected: DVec3) {
    // Rounding of numbers up to 40,000.
    assert!((actual - expected).length() < 1e-9, "{actual} {expected}");
}

/// Calculated by hand: 40 counts above the zero on y are 2 N along -y of the chip, which is turned by 90 degrees.
#[test]
fn columns_are_converted_to_forces_in_the_elements_frame() {
    let keys = "unit = 'counts'\ncounts_per_newton = [10.0, 20.0, 40.0]\nrate = 10.0\n\
                axes = { x = 'z', y = '-y', z = '-x' }";
    let layout = layout(keys, ", turn_deg = 90.0, zero = [100.0, 200.0, 300.0]");
    assert_eq!(layout.force_unit(), TaxelUnit::Newton);
    let row = DVec3::new(70.0, 240.0, 340.0);
    let [force, other] = sense(&layout, 10.0, &[row])[0];
    // The force on the chip is (1, -2, 3) N; a quarter turn maps its x to y and its y to -x.
    close(force, DVec3::new(2.0, 1.0, 3.0));
    close(other, DVec3::new(-10.0, -7.5, 10.0));
    // Pressed and dragged along the pad's z: the pad faces x, so the object presses along -x of T.
    let (element, _) = layout.elements().next().unwrap();
    close(
        element.force_on_fingertip(force),
        DVec3::new(-3.0, 2.0, 1.0),
    );
}

#[test]
fn the_zero_is_the_mean_of_the_first_valid_rows() {
    let layout = layout("unit = 'counts'\nrate = 10.0\nzero = { rows = 3 }", "");
    let rows = [1.0, f64::NAN, 4.0, 10.0].map(DVec3::splat);
    let forces = sense(&layout, 10.0, &rows);
    assert_eq!(layout.force_unit(), TaxelUnit::Counts);
    close(forces[0][0], DVec3::ZERO);
    assert!(forces[1][0].is_nan() && !forces[1][1].is_nan());
    close(forces[2][0], DVec3::splat(1.5));
    close(forces[3][0], DVec3::splat(7.5));
    // A taxel without valid rows has no zero.
    let silent = [f64::NAN, f64::NAN, f64::NAN, 10.0].map(DVec3::splat);
    assert!(sense(&layout, 10.0, &silent)[3][0].is_nan());
}

/// A zero that drifts by 5 counts in 100 s, followed with a time constant of 2 s, lags by rate times time constant:
/// 0.1 count.
#[test]
fn drift_is_followed_without_contact() {
    let drift = "unit = 'counts'\nrate = 50.0\nzero = { rows = 1 }\n\
                 drift = { untouched = 1.0, time_constant = 2.0, most = 8.0 }";
    let layout = layout(drift, "");
    let ramp = |number: usize| DVec3::splat(0.05 * number as f64 / 50.0);
    let mut rows: Vec<_> = (0..5000).map(ramp).collect();
    let forces = sense(&layout, 50.0, &rows);
    let (_, lag) = (forces[0][0], forces[4999][0]);
    assert!((lag - DVec3::splat(0.1)).length() < 0.01, "{lag}");
    // While pressed, the zero is kept indefinitely.
    rows.extend((0..5000).map(|_| DVec3::splat(50.0)));
    let forces = sense(&layout, 50.0, &rows);
    let pressed = forces[9999][0] - forces[5001][0];
    assert!(pressed.length() < 1e-9, "{pressed}");
}

#[test]
fn drift_is_corrected_up_to_its_bound() {
    let drift = "unit = 'counts'\nrate = 50.0\nzero = { rows = 1 }\n\
                 drift = { untouched = 100.0, time_constant = 0.5, most = 8.0 }";
    let layout = layout(drift, "");
    let rows: Vec<_> = (0..5000).map(|n| DVec3::X * (n as f64 * 0.002)).collect();
    let force = sense(&layout, 50.0, &rows)[4999][0];
    close(force, DVec3::X * (9.998 - 8.0));
}

const SEQUENCES: &str = "s,t0_x,t0_y,t0_z,t1_x,t1_y,t1_z\n\
                         a,5,5,5,1,1,1\na,6,5,5,1,1,1\n,7,5,5,1,1,1\nb,100,0,0,0,0,0\nb,101,0,0,0,0,0\n";

#[test]
fn each_sequence_starts_without_load() {
    let mut layout = layout("unit = 'counts'\nrate = 10.0\nzero = { rows = 1 }", "");
    layout.columns.sequence = Some("s".into());
    let mut sensor = TaxelSensor::open(SEQUENCES.as_bytes(), &layout, None).unwrap();
    let mut frame = TactileFrame::unloaded(2);
    let mut felt = Vec::new();
    while sensor.read(&mut frame).is_ok() {
        let name = String::from_utf8(sensor.sequence().to_vec()).unwrap();
        felt.push((name, sensor.starts_sequence(), frame.forces[0].x));
    }
    let expected = [("a", true, 0.0), ("a", false, 1.0), ("a", false, 2.0)];
    let expected = expected
        .into_iter()
        .chain([("b", true, 0.0), ("b", false, 1.0)]);
    let expected: Vec<_> = expected.map(|(n, s, f)| (n.to_string(), s, f)).collect();
    assert_eq!(felt, expected);
}

/// The flag analyzer processes taxel frames like any others.
#[test]
fn flags_are_computed_for_taxels() {
    let mut layout = layout("unit = 'N'\nrate = 100.0", "");
    layout.columns.prefix = "l_".into();
    let table = "l_t0_x,l_t0_y,l_t0_z,l_t1_x,l_t1_y,l_t1_z\n0,0,0,0,0,0\n0,0,0.5,0,0,0.1\n\
                 0,0.1,0.5,0,0,0.1\n0,0.1,,0,0,3\n";
    let mut sensor = TaxelSensor::open(table.as_bytes(), &layout, None).unwrap();
    let mut analyzer = FlagAnalyzer::new(
        FlagThresholds {
            touch_force: 0.3,
            over_force: 2.0,
            slip_threshold: 5.0,
        },
        2,
    );
    let mut frame = TactileFrame::unloaded(2);
    let mut flags = Vec::new();
    while sensor.read(&mut frame).is_ok() {
        let raised = analyzer.analyze(&frame);
        flags.push((
            raised.touch,
            raised.slip,
            raised.over,
            raised.largest_element,
        ));
    }
    let expected = [
        (false, false, false, None),
        (true, false, false, Some(0)),
        // 0.1 N in 0.01 s.
        (true, true, false, Some(0)),
        (true, false, true, Some(1)),
    ];
    assert_eq!(flags, expected);
}
