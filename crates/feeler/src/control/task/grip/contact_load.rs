//! Pressing force and shear between fingers and object.

use super::surface::Surface;
use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::FingerReadings;
use glam::DVec3;

/// Force on one element by the object, split into components along and perpendicular to a direction: the closing
/// direction, or the normal of the object's surface.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ElementLoad {
    /// Pressing force (N), positive in compression.
    pub pressing: f64,
    /// Shear force (N, in W), perpendicular to that direction.
    pub shear: DVec3,
}

/// Total load on one finger.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FingerLoad {
    /// Pressing force (N) along the closing direction.
    pub pressing: f64,
    /// Shear force on the finger by the object (N, in W), perpendicular to the closing direction.
    pub shear: DVec3,
    /// Equivalent shear force (N): it would be as close to slipping as the actual shear together with the torsion about
    /// the closing direction.
    pub equivalent: f64,
    /// `true` if an element is in contact.
    pub touches: bool,
}

impl ElementLoad {
    /// Computes the load on each element of `finger`, which closes along `approach`, into `loads`. Returns the part of
    /// `loads` that was written.
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

    /// Converts the `loads` of `finger` from the closing direction to the normal of the object's surface at each tip.
    /// `feeler` contains the properties of the feelers in series with the object.
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
    /// Sums the loads on the `elements` of `finger`, which closes along `approach`. Elements are in contact above
    /// `touch_force` (N). Smaller forces are included in the sums, because they add up.
    ///
    /// Shear and torsion lie within an ellipsoidal limit surface (Howe and Cutkosky, Int. J. Robotics Research
    /// 15, 1996): with shear `S` (N) and torsion `M` (N·m), the contact slips at `(S / μN)² + (M / μ Σ n ρ)² = 1`,
    /// where `μ` is the friction coefficient, `N` the pressing force (N), and `n` the pressing force of an element at
    /// the distance `ρ` (m) from the centre of pressure.
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
