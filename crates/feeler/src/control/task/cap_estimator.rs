//! Estimates torque, rotation, radius and grip force of a cap from forces and encoders.
//!
//! A feeler deflects under its force according to its stiffness, so force and encoders give the point at which its tip
//! touches the cap: the *anchor*. While the tip sticks, the anchor moves with the cap. When the tip slips, the shear
//! force drops within a frame, and the motion of the anchor is not that of the cap.

use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::{FingerReadings, HandReadings};
use glam::{DVec2, DVec3};

/// Compression below which an element is ignored (N).
const TOUCH: f64 = 0.1;
/// Drop of the shear force between frames that indicates a slip, as a fraction of the normal force.
const SLIP_SHARE: f64 = 0.05;
/// Constant part of the drop that indicates a slip (N), far above the noise of a frame.
const SLIP_DROP: f64 = 0.01;
/// Number of frames without a detected slip after which a sliding finger counts as sticking, because small slips
/// between large ones are hidden by noise.
const SLIDING: u32 = 5;

/// Estimates from one finger, and the state that they require.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FingerEstimate {
    /// Force on the cap towards the axis (N).
    pub grip: f64,
    /// Force on the cap along the stroke (N).
    pub shear: f64,
    /// Torque on the cap about the axis, positive in the direction of the stroke (N·m).
    pub torque: f64,
    /// Distance from the axis to the contact of the most loaded element (m).
    pub radius: f64,
    /// F_z of the most loaded element (N).
    pub largest: f64,
    /// Number of frames since the most loaded element last slipped.
    sticking: u32,
    /// `true` if the most loaded element has slipped since the stroke began.
    pub slid: bool,
    /// Motion along the stroke of the anchor of the most loaded element since the previous frame (m); `None` while the
    /// element slides, or if another element was the most loaded one.
    advance: Option<f64>,
    leading: Option<Leading>,
}

/// State of the most loaded element at one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leading {
    element: usize,
    anchor: DVec2,
    shear: f64,
    sequence: u64,
}

/// Estimates torque, radius and rotation of a cap from the readings of all fingers. The position of the cap's axis is
/// known only approximately.
#[derive(Debug, Clone)]
pub struct CapEstimator {
    /// Assumed position of the axis (m, in W).
    axis: DVec2,
    feeler: FeelerShape,
    /// 1 if the strokes turn counterclockwise seen from above, otherwise -1.
    sense: f64,
    /// Estimates from each finger.
    pub fingers: Vec<FingerEstimate>,
}

impl CapEstimator {
    /// Creates the estimator for `fingers` fingers with strokes about `axis` (m, in W) in the direction given by the
    /// sign of `sense`.
    pub fn new(axis: DVec2, feeler: FeelerShape, sense: f64, fingers: usize) -> Self {
        Self {
            axis,
            feeler,
            sense: sense.signum(),
            fingers: vec![FingerEstimate::default(); fingers],
        }
    }

    /// Updates the estimates with the latest readings.
    pub fn feel(&mut self, hand: &HandReadings<'_>) {
        let (axis, feeler, sense) = (self.axis, self.feeler, self.sense);
        for (own, finger) in self.fingers.iter_mut().zip(hand.fingers()) {
            own.feel(&finger, axis, &feeler, sense);
        }
    }

    /// Starts a stroke: resets the slip state of all fingers.
    pub fn begin_stroke(&mut self) {
        for finger in &mut self.fingers {
            finger.slid = false;
            finger.sticking = SLIDING;
            finger.leading = None;
        }
    }

    /// Total torque on the cap about the axis, positive in the direction of the stroke (N·m). Opposing fingers exert a
    /// couple, whose torque is the same about any axis, so a small error of the axis has no effect.
    pub fn torque(&self) -> f64 {
        self.fingers.iter().map(|finger| finger.torque).sum()
    }

    /// Radius of the cap (m), averaged over the fingers in contact. If the assumed axis is wrong, one finger is nearer
    /// and another one farther.
    pub fn radius(&self) -> Option<f64> {
        mean(self.touching().map(|finger| finger.radius))
    }

    /// Rotation of the cap since the previous frame (rad), from the fingers that stick to it.
    pub fn turned(&self) -> f64 {
        let advance = mean(self.fingers.iter().filter_map(|finger| finger.advance));
        match (advance, self.radius()) {
            (Some(advance), Some(radius)) if radius > 0.0 => advance / radius,
            _ => 0.0,
        }
    }

    /// Unit vectors at `position` (m, in W): outward from the axis, and along the stroke.
    pub fn directions(&self, position: DVec3) -> (DVec3, DVec3) {
        let away = (position.truncate() - self.axis).normalize_or_zero();
        (away.extend(0.0), (self.sense * away.perp()).extend(0.0))
    }

    fn touching(&self) -> impl Iterator<Item = &FingerEstimate> {
        self.fingers.iter().filter(|finger| finger.largest > TOUCH)
    }
}

impl FingerEstimate {
    fn feel(&mut self, finger: &FingerReadings<'_>, axis: DVec2, feeler: &FeelerShape, sense: f64) {
        (self.grip, self.shear, self.torque, self.largest) = (0.0, 0.0, 0.0, 0.0);
        let mut leading = None;
        for (element, felt) in finger.touch.frame.forces.iter().enumerate() {
            if felt.z <= TOUCH {
                continue;
            }
            let on_feeler = finger.force(element);
            let Some(anchor) = feeler.tip(finger, element, on_feeler) else {
                continue;
            };
            let (force, anchor) = (-on_feeler, anchor.truncate());
            let (away, distance) = (anchor - axis).normalize_and_length();
            let along = sense * away.perp();
            let (grip, shear) = (-force.truncate().dot(away), force.truncate().dot(along));
            let radius = distance - feeler.tip_radius;
            self.grip += grip;
            self.shear += shear;
            self.torque += shear * radius;
            if felt.z > self.largest {
                self.largest = felt.z;
                self.radius = radius;
                let sequence = finger.touch.frame.sequence;
                leading = Some((
                    Leading {
                        element,
                        anchor,
                        shear,
                        sequence,
                    },
                    along,
                    grip,
                ));
            }
        }
        self.follow(leading);
    }

    /// Updates the motion of the anchor of the most loaded element, and detects slip.
    fn follow(&mut self, leading: Option<(Leading, DVec2, f64)>) {
        let before = self.leading;
        self.leading = leading.map(|(now, ..)| now);
        self.advance = None;
        self.sticking = self.sticking.saturating_add(1);
        let (Some((now, along, grip)), Some(before)) = (leading, before) else {
            return;
        };
        if now.element != before.element || now.sequence == before.sequence {
            return;
        }
        if before.shear - now.shear > (SLIP_SHARE * grip).max(0.0) + SLIP_DROP {
            self.sticking = 0;
            self.slid = true;
        }
        if self.sticking >= SLIDING {
            self.advance = Some((now.anchor - before.anchor).dot(along));
        }
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
