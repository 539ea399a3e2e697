//! Pressing force and shear of the fingers on the object.

use crate::control::sense::FingerReadings;
use glam::DVec3;

/// Force of one element on the object, relative to the closing direction.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ElementLoad {
    /// Pressing force (N), along the closing direction.
    pub pressing: f64,
    /// Shear force that holds the object (N, in W), across the closing direction.
    pub shear: DVec3,
}

/// Total load on one finger.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FingerLoad {
    /// Pressing force (N), along the closing direction.
    pub pressing: f64,
    /// Shear force of the object on the finger (N, in W), across the closing direction.
    pub shear: DVec3,
    /// Shear force that is as close to slipping as the shear and the torsion about the closing direction together (N).
    pub equivalent: f64,
    /// `true` if an element touches.
    pub touches: bool,
}

/// Splits the force of the object on `element` of `finger`, which closes along `approach`.
pub(super) fn element_load(
    finger: &FingerReadings<'_>,
    element: usize,
    approach: DVec3,
) -> ElementLoad {
    let force = finger.force(element);
    ElementLoad {
        pressing: -force.dot(approach),
        shear: force.reject_from_normalized(approach),
    }
}

impl FingerLoad {
    /// Sums the forces of the object on all elements of `finger`, which closes along `approach`. Elements touch above
    /// `touch_force` (N). Weaker forces are included in the sums, because they add up.
    ///
    /// Shear and torsion limit each other like the axes of an ellipsoid (Howe and Cutkosky, Int. J. Robotics Research 15,
    /// 1996): the contact slips at `(T / μN)² + (M / μ Σ n ρ)² = 1`, where `n` presses at the distance `ρ` from the centre of
    /// pressure.
    pub fn new(finger: &FingerReadings<'_>, approach: DVec3, touch_force: f64) -> Self {
        let mut load = Self::default();
        let (mut centre, mut pressed) = (DVec3::ZERO, 0.0);
        for element in 0..finger.touch.frame.forces.len() {
            let own = element_load(finger, element, approach);
            load.pressing += own.pressing;
            load.shear += own.shear;
            if own.pressing > touch_force {
                load.touches = true;
                pressed += own.pressing;
                centre += own.pressing * finger.layout.tip(element);
            }
        }
        load.equivalent = load.shear.length();
        if pressed > 0.0 {
            let ratio = torsion_per_lever(finger, approach, touch_force, centre / pressed);
            load.equivalent = libm::hypot(load.equivalent, ratio);
        }
        load
    }
}

/// Torsion about `approach` through the `centre` of pressure (m, in the fingertip frame), divided by the mean distance of
/// the pressing force from it (N).
fn torsion_per_lever(
    finger: &FingerReadings<'_>,
    approach: DVec3,
    touch_force: f64,
    centre: DVec3,
) -> f64 {
    let (mut torsion, mut lever, mut pressed) = (0.0, 0.0, 0.0);
    for element in 0..finger.touch.frame.forces.len() {
        let own = element_load(finger, element, approach);
        if own.pressing > touch_force {
            let arm = finger.pose.rotation * (finger.layout.tip(element) - centre);
            torsion += arm.cross(own.shear).dot(approach);
            lever += own.pressing * arm.reject_from_normalized(approach).length();
            pressed += own.pressing;
        }
    }
    match lever > 0.0 {
        true => (torsion * pressed / lever).abs(),
        false => 0.0,
    }
}
