//! Fault injection: kinds of faults and their times. The same seed and faults give the same run.

use serde::{Deserialize, Serialize};

/// Tolerance of time comparisons (s): far shorter than a step, far longer than rounding errors.
pub(crate) const SAME_TIME: f64 = 1e-9;

/// A fault in an experiment file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultConfig {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Start of the fault (s).
    #[serde(default)]
    pub from: f64,
    /// End of the fault (s). Default: it does not end.
    #[serde(default)]
    pub until: Option<f64>,
}

impl FaultConfig {
    /// Returns `true` if the fault is active at `time` (s).
    pub fn active(&self, time: f64) -> bool {
        let time = time + SAME_TIME;
        time >= self.from && self.until.is_none_or(|until| time < until)
    }
}

/// Kind of a fault. Indices of fingers, elements and joints start at 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FaultKind {
    /// An element without signal: its cones show no load, or its directly sensed force is zero plus noise. The feeler's
    /// contact is unchanged.
    DeadElement {
        /// Index of the finger.
        finger: usize,
        /// Index of the element.
        element: usize,
    },
    /// Camera rows that are stuck at a gray level. No effect with direct sensing.
    StuckRows {
        /// Index of the finger.
        finger: usize,
        /// First row, from the top (px).
        first: usize,
        /// Number of rows (px).
        count: usize,
        /// Gray level of the rows.
        gray: u8,
    },
    /// The last image, including noise, is repeated with new stamps and sequence numbers. This is the worst case: only
    /// the image itself reveals the fault.
    FrozenFrame {
        /// Index of the finger.
        finger: usize,
    },
    /// Images are lost. Until the next one arrives, the last reading remains with its stamp and sequence number. The
    /// first image of a run is never lost.
    DroppedFrames {
        /// Index of the finger.
        finger: usize,
        /// Probability of losing each image, 0 to 1.
        probability: f64,
    },
    /// Images arrive late, with the stamp of their exposure. An image is taken in every control period and read in the
    /// first period after its arrival. The first image of a run is not late.
    CameraLatency {
        /// Index of the finger.
        finger: usize,
        /// Time from exposure to arrival (s).
        delay: f64,
    },
    /// A joint that stops instantly and ignores commands.
    ServoStall {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint: theta1 is joint 0.
        joint: usize,
    },
    /// Play between a joint's motor, which the encoder measures, and its link, in addition to
    /// [`ServoConfig::backlash`](super::servo::ServoConfig::backlash).
    ///
    /// The link rests until the motor reaches an end of the dead band, and then follows it: the play operator
    /// `link = clamp(link, motor - angle / 2, motor + angle / 2)`. Forces do not move the link within the band. The
    /// joint starts in the middle of the band.
    Backlash {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint: theta1 is joint 0.
        joint: usize,
        /// Width of the dead band (rad): on reversal, the motor turns by this angle before the link follows.
        angle: f64,
    },
    /// A joint's encoder that is stuck at an angle. The joint moves normally.
    JointFreeze {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint: theta1 is joint 0.
        joint: usize,
    },
    /// A joint's encoder with a wrong gain, from the angle at the start of the fault.
    JointGain {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint: theta1 is joint 0.
        joint: usize,
        /// Ratio of the measured to the actual rotation; negative if reversed.
        gain: f64,
    },
    /// A joint's encoder whose angle jumps by an offset.
    JointJump {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint: theta1 is joint 0.
        joint: usize,
        /// Offset of the measured angle (rad).
        angle: f64,
    },
    /// A tactile sensor with a wrong gain, by which all its forces are scaled; with gain 0 it measures no force.
    SensorGain {
        /// Index of the finger.
        finger: usize,
        /// Ratio of the measured to the actual forces.
        gain: f64,
    },
    /// Swapped connections of two fingers' sensors, during the whole run.
    SwappedSensors {
        /// Index of the finger.
        finger: usize,
        /// Index of the other finger.
        other: usize,
    },
    /// Reduced friction, as on a wet cap.
    FrictionDrop {
        /// Name of the object. Default: all objects.
        #[serde(default)]
        object: Option<String>,
        /// Factor on the friction coefficients of feelers on the object.
        factor: f64,
    },
    /// A free object whose mass changes, such as a vessel that is filled with water. Moments of inertia change in
    /// proportion, and the centre of mass does not move.
    MassChange {
        /// Name of the object.
        object: String,
        /// Final mass (kg).
        mass: f64,
        /// Duration of the change (s); the mass changes linearly.
        #[serde(default)]
        over: f64,
    },
    /// An external force at the origin of a free object.
    Pull {
        /// Name of the object.
        object: String,
        /// Force on the object (N, in W).
        force: [f64; 3],
        /// Duration of the rise (s); the force rises linearly.
        #[serde(default)]
        over: f64,
    },
}

impl FaultKind {
    /// Index of the affected finger, if any.
    pub fn finger(&self) -> Option<usize> {
        match *self {
            Self::DeadElement { finger, .. }
            | Self::StuckRows { finger, .. }
            | Self::FrozenFrame { finger }
            | Self::DroppedFrames { finger, .. }
            | Self::CameraLatency { finger, .. }
            | Self::ServoStall { finger, .. }
            | Self::Backlash { finger, .. }
            | Self::JointFreeze { finger, .. }
            | Self::JointGain { finger, .. }
            | Self::JointJump { finger, .. }
            | Self::SensorGain { finger, .. }
            | Self::SwappedSensors { finger, .. } => Some(finger),
            Self::FrictionDrop { .. } | Self::MassChange { .. } | Self::Pull { .. } => None,
        }
    }
}
