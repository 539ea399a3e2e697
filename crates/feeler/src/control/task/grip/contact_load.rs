//! Pressing force and shear of the fingers on the object.

use super::surface::Surface;
use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::FingerReadings;
use glam::DVec3;

/// Force on one element by the object, split along a direction: the closing direction, or the normal of the object's surface.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ElementLoad {
    /// Pressing force (N), positive in compression.
    pub pressing: f64,
    /// Shear force (N, in W), across that direction.
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

impl ElementLoad {
    /// Writes the load on each element of `finger`, which closes along `approach`, to `loads`. Returns those written.
    pub fn of_finger<'a>(
        finger: &FingerReadings<'_>,
        approach: DVec3,
        loads: &'a mut [Self],
    ) -> &'a mut [Self] {
        let count = finger.touch.frame.forces.len().min(loads.len());
        let loads = &mut loads[..count];
        for (element, load) in loads.iter_mut().enumerate() {
            let force = finger.force(element);
            *load = Self {
                pressing: -force.dot(approach),
                shear: force.reject_from_normalized(approach),
            };
        }
        loads
    }

    /// Relates the `loads` of `finger` to the normal of the object's surface at each tip instead of the closing direction.
    /// `feeler` is the shape of the feelers in series with the object.
    pub fn relate_to(
        surface: &Surface,
        finger: &FingerReadings<'_>,
        feeler: &FeelerShape,
        loads: &mut [Self],
    ) {
        for (element, load) in loads.iter_mut().enumerate() {
            let force = finger.force(element);
            let Some(tip) = feeler.tip(finger, element, force) else {
                return;
            };
            let normal = surface.normal(tip);
            *load = Self {
                pressing: -force.dot(normal),
                shear: force.reject_from_normalized(normal),
            };
        }
    }
}

impl FingerLoad {
    /// Sums the loads on the `elements` of `finger`, which closes along `approach`. Elements touch above `touch_force` (N).
    /// Weaker forces are included in the sums, because they add up.
    ///
    /// Shear and torsion limit each other like the axes of an ellipsoid (Howe and Cutkosky, Int. J. Robotics Research 15,
    /// 1996): with shear `S` (N) and torsion `M` (N m), the contact slips at `(S / μN)² + (M / μ Σ n ρ)² = 1`, where `μ` is the
    /// friction coefficient, `N` the pressing force (N), and its part `n` presses at the distance `ρ` (m) from the centre of
    /// pressure.
    pub fn new(
        finger: &FingerReadings<'_>,
        elements: &[ElementLoad],
        approach: DVec3,
        touch_force: f64,
    ) -> Self {
        let mut load = Self::default();
        for own in elements {
            load.pressing += own.pressing;
            load.shear += own.shear;
        }
        load.equivalent = load.shear.length();
        let touching = || {
            let elements = elements.iter().enumerate();
            elements.filter(|(_, own)| own.pressing > touch_force)
        };
        let (mut centre, mut pressed) = (DVec3::ZERO, 0.0);
        for (element, own) in touching() {
            pressed += own.pressing;
            centre += own.pressing * finger.layout.tip(element);
        }
        load.touches = pressed > 0.0;
        if !load.touches {
            return load;
        }
        let centre = centre / pressed;
        let (mut torsion, mut lever) = (0.0, 0.0);
        for (element, own) in touching() {
            let arm = finger.pose.rotation * (finger.layout.tip(element) - centre);
            torsion += arm.cross(own.shear).dot(approach);
            lever += own.pressing * arm.reject_from_normalized(approach).length();
        }
        if lever > 0.0 {
            load.equivalent = libm::hypot(load.equivalent, torsion * pressed / lever);
        }
        load
    }
}
