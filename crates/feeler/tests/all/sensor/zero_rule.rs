//! The zero is measured again after a time without contact and motion.

use feeler::sensor::taxel::{BuiltInTaxels, TaxelChain, ZeroRule};
use glam::DVec3;

/// Rows per second.
const RATE: f64 = 100.0;

/// An AnySkin in time.
struct Skin {
    chain: TaxelChain,
    row: u32,
    forces: Vec<DVec3>,
}

impl Skin {
    fn new() -> Self {
        let mut layout = BuiltInTaxels::named("anyskin").unwrap().layout().unwrap();
        layout.rezero = Some(ZeroRule {
            after: 2.0,
            untouched: 40.0,
            still: 4.0,
        });
        let mut skin = Self {
            chain: TaxelChain::new(&layout).unwrap(),
            row: 0,
            forces: vec![DVec3::ZERO; 5],
        };
        skin.sense(0.2, |_| 0.0);
        skin
    }

    /// Senses for `seconds` with `z` on all taxels as a function of time, and returns the last compression.
    fn sense(&mut self, seconds: f64, z: impl Fn(f64) -> f64) -> f64 {
        for row in 0..(seconds * RATE) as u32 {
            let values = [DVec3::new(3.0, 4.0, 500.0 + z(f64::from(row) / RATE)); 5];
            self.chain
                .sense(f64::from(self.row) / RATE, &values, &mut self.forces);
            self.row += 1;
        }
        self.forces[0].z
    }
}

#[test]
fn a_still_offset_below_a_touch_becomes_the_zero() {
    let mut skin = Skin::new();
    assert_eq!(skin.sense(1.9, |_| 30.0), 30.0);
    assert!(skin.sense(0.3, |_| 30.0).abs() < 1e-9);
    // Again, relative to the new zero.
    assert!((skin.sense(0.1, |_| 65.0) - 35.0).abs() < 1e-9);
    assert!(skin.sense(2.2, |_| 65.0).abs() < 1e-9);
}

#[test]
fn a_held_object_is_never_taken_for_the_zero() {
    let mut skin = Skin::new();
    assert_eq!(skin.sense(60.0, |_| 41.0), 41.0);
    // Nor is its release, before the skin is still.
    assert_eq!(skin.sense(1.0, |_| 0.0), 0.0);
}

#[test]
fn moving_readings_are_not_averaged() {
    let mut skin = Skin::new();
    let swaying = |time: f64| 10.0 * (3.0 * time).sin();
    let last = skin.sense(60.0, swaying);
    assert!((last - swaying(59.99)).abs() < 1e-9, "{last}");
}
