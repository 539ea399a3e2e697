//! A cap as fingers feel it: the torque on it, how far it turns, its radius and the grip, from forces and encoders.
//!
//! A feeler bends under its force by what its stiffness says, so that force and encoders tell where its tip holds on to the cap: the
//! *anchor*. Where the tip sticks, the anchor goes with the cap. Where it slips, the shear force drops within a frame, and
//! what the anchor makes of way then is not the cap's.

use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::{FingerSense, HandSense};
use glam::{DVec2, DVec3};

/// Elements pressed less than this say nothing, N.
const TOUCH: f64 = 0.1;
/// A shear force that drops between frames by more than this share of the normal force has slipped…
const SLIP_SHARE: f64 = 0.05;
/// …and by more than this, N: far above the noise of a frame.
const SLIP_DROP: f64 = 0.01;
/// A finger that slipped slides on until it has not slipped for so many frames: small slips between large ones drown in noise.
const SLIDING: u32 = 5;

/// What one finger feels of the cap, and what it has to remember for that.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FingerFeel {
    /// Force towards the axis, N, on the cap.
    pub grip: f64,
    /// Force along the stroke, N, on the cap.
    pub shear: f64,
    /// Torque on the cap about the axis, positive with the stroke, N·m.
    pub torque: f64,
    /// From the axis to the contact of the element that is pressed hardest, m.
    pub radius: f64,
    /// F_z of that element, N.
    pub largest: f64,
    /// Frames for which that element has not slipped.
    sticking: u32,
    /// Whether it has slipped since the stroke began.
    pub slid: bool,
    /// How far that element's anchor went with the stroke since the frame before, m; none where it slides or is another one.
    advance: Option<f64>,
    leading: Option<Leading>,
}

/// The element that is pressed hardest, at one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leading {
    element: usize,
    anchor: DVec2,
    shear: f64,
    sequence: u64,
}

/// What all fingers feel of a cap whose axis is about where they think.
#[derive(Debug, Clone)]
pub struct CapTouch {
    /// Where the axis is thought to be, m, in W.
    axis: DVec2,
    feeler: FeelerShape,
    /// 1 where the strokes turn counter-clockwise as seen from above, else -1.
    sense: f64,
    /// Each finger.
    pub fingers: Vec<FingerFeel>,
}

impl CapTouch {
    /// Nothing felt yet by `fingers` fingers, whose strokes turn about `axis` (m, in W) in the sense of `sense`.
    pub fn new(axis: DVec2, feeler: FeelerShape, sense: f64, fingers: usize) -> Self {
        Self {
            axis,
            feeler,
            sense: sense.signum(),
            fingers: vec![FingerFeel::default(); fingers],
        }
    }

    /// Takes in what the fingers feel now.
    pub fn feel(&mut self, hand: &HandSense<'_>) {
        let (axis, feeler, sense) = (self.axis, self.feeler, self.sense);
        for (own, finger) in self.fingers.iter_mut().zip(hand.fingers()) {
            own.feel(&finger, axis, &feeler, sense);
        }
    }

    /// Forgets what slipped: a stroke begins.
    pub fn begin_stroke(&mut self) {
        for finger in &mut self.fingers {
            finger.slid = false;
            finger.sticking = SLIDING;
            finger.leading = None;
        }
    }

    /// Torque on the cap by all fingers about the axis, positive with the stroke, N·m. Opposing fingers make a couple, which is the
    /// same about any axis: that the cap stands elsewhere by a little does not matter.
    pub fn torque(&self) -> f64 {
        self.fingers.iter().map(|finger| finger.torque).sum()
    }

    /// The cap's radius, mean over the fingers that touch, m. Where it stands off its place, it is nearer to one and
    /// farther from another.
    pub fn radius(&self) -> Option<f64> {
        mean(self.touching().map(|finger| finger.radius))
    }

    /// By how much the cap turned since the frame before, by the fingers that stick to it, rad.
    pub fn turned(&self) -> f64 {
        let advance = mean(self.fingers.iter().filter_map(|finger| finger.advance));
        match (advance, self.radius()) {
            (Some(advance), Some(radius)) if radius > 0.0 => advance / radius,
            _ => 0.0,
        }
    }

    /// Unit vectors at `position` (m, in W): away from the axis, and along the stroke.
    pub fn directions(&self, position: DVec3) -> (DVec3, DVec3) {
        let away = (position.truncate() - self.axis).normalize_or_zero();
        (away.extend(0.0), (self.sense * away.perp()).extend(0.0))
    }

    fn touching(&self) -> impl Iterator<Item = &FingerFeel> {
        self.fingers.iter().filter(|finger| finger.largest > TOUCH)
    }
}

impl FingerFeel {
    fn feel(&mut self, finger: &FingerSense<'_>, axis: DVec2, feeler: &FeelerShape, sense: f64) {
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

    /// How far the leading element's anchor went since the frame before, and whether it slipped.
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
