//! Contact stiffness of a fingertip's feelers, measured while the finger closes on the object.

use crate::control::feeler_shape::Stiffness;
use glam::{DMat3, DVec3};

/// Minimum sum of squared motion for computing a slope (m²).
const MIN_MOTION: f64 = 1e-8;
/// Ratio of shear to normal stiffness if the closing motion has too little shear to measure it; typical of
/// incompressible rubber.
const USUAL_RATIO: f64 = 0.5;
/// Valid range of the ratio of shear to normal stiffness.
const RATIO: (f64, f64) = (0.1, 1.0);

/// Fits the slope of force over motion, with data from all elements and closing motions.
///
/// A feeler that sticks to an object at rest acts as a spring: its force changes in proportion to the motion of its
/// undeformed tip. The offset differs between elements, because they make contact at different times.
#[derive(Debug, Clone)]
pub(super) struct StiffnessFit {
    elements: Vec<Touched>,
    /// Slope of normal force over motion, from all contacts that have ended.
    normal: Slope,
    /// Slope of tangential force over motion, from all contacts that have ended.
    shear: Slope,
}

/// Data of the current contact of one element.
#[derive(Debug, Clone, Copy, Default)]
struct Touched {
    /// Position of the undeformed tip at first contact (m, in W).
    first: DVec3,
    /// Number of frames in contact.
    frames: f64,
    /// Mean motion over these frames, in the element's frame (m).
    motion: DVec3,
    /// Mean force over these frames, in the element's frame (N).
    force: DVec3,
    normal: Slope,
    shear: Slope,
}

/// Sums for a least-squares slope through centred data.
#[derive(Debug, Clone, Copy, Default)]
struct Slope {
    /// Sum of motion² (m²).
    motion: f64,
    /// Sum of motion times force (N·m).
    product: f64,
}

impl StiffnessFit {
    /// Creates a fit for a fingertip of `elements` elements.
    pub fn new(elements: usize) -> Self {
        Self {
            elements: vec![Touched::default(); elements],
            normal: Slope::default(),
            shear: Slope::default(),
        }
    }

    /// Starts a closing motion; no element is in contact.
    pub fn start(&mut self) {
        for element in 0..self.elements.len() {
            self.release(element);
        }
    }

    /// Ends the contact of an element. The next contact gets a separate offset, so that a single noisy frame does not
    /// count as a contact during all the motion after it.
    pub fn release(&mut self, element: usize) {
        if let Some(touched) = self.elements.get_mut(element)
            && touched.frames > 0.0
        {
            let ended = std::mem::take(touched);
            self.normal.add(ended.normal);
            self.shear.add(ended.shear);
        }
    }

    /// Adds a frame of an element in contact: its undeformed `tip` (m, in W), the `rotation` from its frame to W, and
    /// the `force` on it (N, in its frame, positive in z when pressed).
    pub fn add(&mut self, element: usize, tip: DVec3, rotation: DMat3, force: DVec3) {
        let Some(touched) = self.elements.get_mut(element) else {
            return;
        };
        if touched.frames == 0.0 {
            touched.first = tip;
        }
        // Relative to the first contact, so that a rotation of the frame does not count as motion.
        let motion = rotation.transpose() * (tip - touched.first);
        touched.frames += 1.0;
        // Centred sums by Welford's update.
        let (motion_off, force_off) = (motion - touched.motion, force - touched.force);
        touched.motion += motion_off / touched.frames;
        touched.force += force_off / touched.frames;
        let left = motion - touched.motion;
        touched.normal.motion += motion_off.z * left.z;
        touched.normal.product += force_off.z * left.z;
        touched.shear.motion += motion_off.truncate().dot(left.truncate());
        // Shear is the force on the feeler, opposite to its motion.
        touched.shear.product -= force_off.truncate().dot(left.truncate());
    }

    /// Stiffness estimated from all closing motions so far; `None` if none of them was long enough.
    pub fn stiffness(&self) -> Option<Stiffness> {
        let (mut normal, mut shear) = (self.normal, self.shear);
        for touched in &self.elements {
            normal.add(touched.normal);
            shear.add(touched.shear);
        }
        let normal = normal.slope()?;
        let shear = shear.slope().unwrap_or(USUAL_RATIO * normal);
        Some(Stiffness {
            normal,
            shear: shear.clamp(RATIO.0 * normal, RATIO.1 * normal),
        })
    }
}

impl Slope {
    fn add(&mut self, other: Self) {
        self.motion += other.motion;
        self.product += other.product;
    }

    /// Slope (N/m); `None` if there was too little motion, or if force does not increase with motion.
    fn slope(self) -> Option<f64> {
        let slope = self.product / self.motion;
        (self.motion > MIN_MOTION && slope > 0.0).then_some(slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two elements that touch at different depths and move obliquely, in frames that rotate by 0.1 rad, far from W's
    /// origin.
    #[test]
    fn springs_have_their_stiffness() {
        let (normal, shear) = (300.0, 120.0);
        let mut fit = StiffnessFit::new(2);
        assert_eq!(fit.stiffness(), None);
        fit.start();
        for step in 0..100 {
            let way = 1e-5 * f64::from(step);
            let rotation = DMat3::from_rotation_z(1e-3 * f64::from(step));
            for (element, touches_at) in [(0, 0.0), (1, 3e-4)] {
                let start = DVec3::new(0.2, -0.1, 0.1) + touches_at * DVec3::new(0.5, 0.0, 1.0);
                let moved = way - touches_at;
                if moved >= 0.0 {
                    let motion = moved * DVec3::new(0.5, 0.0, 1.0);
                    let own = rotation.transpose() * motion;
                    let force = DVec3::new(-shear * own.x, -shear * own.y, normal * own.z);
                    fit.add(element, start + motion, rotation, force);
                }
            }
        }
        let found = fit.stiffness().expect("a stiffness");
        assert!((found.normal / normal - 1.0).abs() < 1e-9, "{found:?}");
        assert!((found.shear / shear - 1.0).abs() < 1e-9, "{found:?}");
        fit.start();
        assert_eq!(fit.stiffness(), Some(found));
    }
}
