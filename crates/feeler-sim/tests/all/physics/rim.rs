//! A feeler on the rim of a cylinder, where side and top meet.

use super::columnar_feeler::{FEELER, cylinder, hold, settle};
use feeler_sim::contact::{FeelerConfig, Overload, Tip};
use glam::DVec3;

const RADIUS: f64 = 0.014;
const HALF_HEIGHT: f64 = 0.010;
const DEPTH: f64 = 0.0005;

/// A feeler that points at the cylinder's axis at height `z` above its centre (m).
fn tip(feeler: &FeelerConfig, z: f64) -> Tip {
    Tip {
        position: DVec3::new(RADIUS + feeler.tip_radius - DEPTH, 0.0, z),
        axis: DVec3::NEG_X,
        set: DVec3::ZERO,
    }
}

/// Height (m) and force on the object (N) while the feeler moves up the side, over the rim and away, from `z` = 8 mm in
/// steps of 1 um.
fn over_the_rim(feeler: &FeelerConfig) -> Vec<(f64, DVec3)> {
    let object = cylinder(RADIUS, 2.0 * HALF_HEIGHT);
    let mut anchor = None;
    (0..4000)
        .map(|n| {
            let z = 0.008 + 1e-6 * f64::from(n);
            let tip = tip(feeler, z);
            let held = anchor.or_else(|| hold(feeler, &object, &tip));
            let settled =
                held.and_then(|anchor| settle(feeler, &object, &tip, anchor, Overload::Sudden));
            anchor = settled.map(|(anchor, _)| anchor);
            (z, settled.map_or(DVec3::ZERO, |(_, force)| force))
        })
        .collect()
}

#[test]
fn without_friction_the_force_is_a_spring_force_from_the_rims_circle() {
    let feeler = FeelerConfig {
        shear_stiffness: FEELER.normal_stiffness,
        static_friction: 0.0,
        kinetic_friction: 0.0,
        ..FEELER
    };
    for (z, force) in over_the_rim(&feeler) {
        // The tip's sphere rolls over side and rim: its centre is displaced along the line from the nearest point of
        // the cylinder.
        let nearest = DVec3::new(RADIUS, 0.0, z.min(HALF_HEIGHT));
        let offset = tip(&feeler, z).position - nearest;
        let inside = z <= HALF_HEIGHT;
        let depth = if inside {
            DEPTH
        } else {
            feeler.tip_radius - offset.length()
        };
        let normal = if inside { DVec3::X } else { offset.normalize() };
        let expected = -feeler.normal_stiffness * depth.max(0.0) * normal;
        // The contact law resolves a slip to 1e-9 of the normal force, which is at most 0.6 N.
        assert!(
            (force - expected).length() < 1e-8,
            "at {z} m: expected {expected}, got {force}"
        );
    }
}

#[test]
fn with_friction_the_force_obeys_the_cone_and_vanishes_past_the_rim() {
    let forces = over_the_rim(&FEELER);
    let touching = forces.iter().filter(|(_, f)| *f != DVec3::ZERO);
    assert!(touching.count() > 2000);
    for &(z, force) in &forces {
        assert!(force.is_finite());
        // The rim's normal has no component towards the axis, so no force pulls the cylinder outward.
        assert!(force.x <= 0.0, "{force} at {z} m");
        assert!(force.length() < 2.0 * FEELER.normal_stiffness * DEPTH);
    }
    let last = forces.iter().rev().take_while(|(_, f)| *f == DVec3::ZERO);
    assert!(last.count() > 100, "the feeler is still in contact");
}
