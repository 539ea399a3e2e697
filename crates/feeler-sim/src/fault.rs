//! Faults to inject: what breaks, and when. The same seed and faults give the same run.

use serde::{Deserialize, Serialize};

/// Times that differ by less are the same, s: far less than a step, far more than rounding.
pub(super) const SAME_TIME: f64 = 1e-9;

/// A fault, as an experiment file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultConfig {
    /// What breaks.
    pub kind: FaultKind,
    /// Time from which on it is broken, s.
    #[serde(default)]
    pub from: f64,
    /// Time from which on it works again, s; without it, never.
    #[serde(default)]
    pub until: Option<f64>,
}

impl FaultConfig {
    /// Whether it is broken at `time`, s.
    pub fn active(&self, time: f64) -> bool {
        let time = time + SAME_TIME;
        time >= self.from && self.until.is_none_or(|until| time < until)
    }
}

/// What breaks. Fingers, elements and joints are counted from 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FaultKind {
    /// A sensing element that feels nothing: its cones show no load, or its force is zero but for the
    /// noise where forces are sensed directly. The feeler itself goes on touching.
    DeadElement {
        /// The finger.
        finger: usize,
        /// The element.
        element: usize,
    },
    /// Rows of the camera's picture that are stuck. Nothing happens where forces are sensed directly.
    StuckRows {
        /// The finger.
        finger: usize,
        /// The first row, from the top, px.
        first: usize,
        /// How many rows, px.
        count: usize,
        /// The grey level that they are stuck at.
        gray: u8,
    },
    /// The last picture, noise and all, again and again with new stamps and sequence numbers: the worst
    /// case, for nothing but the picture itself tells.
    FrozenFrame {
        /// The finger.
        finger: usize,
    },
    /// Pictures that never arrive. Until the next one does, the last reading stays with its stamp and
    /// sequence number. The first picture of a run always arrives.
    DroppedFrames {
        /// The finger.
        finger: usize,
        /// Probability with which each picture is lost, 0 to 1.
        probability: f64,
    },
    /// Pictures that arrive late, with the stamp of their exposure. A picture is taken in every control
    /// period and read in the first one after its arrival. The first picture of a run is not late.
    CameraLatency {
        /// The finger.
        finger: usize,
        /// From exposure to arrival, s.
        delay: f64,
    },
    /// A joint that stops dead and ignores its commands.
    ServoStall {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
    },
    /// Play between a joint's motor, which the encoder reads, and its link, beyond that of
    /// [`ServoConfig::backlash`](super::servo::ServoConfig::backlash).
    ///
    /// The link stays where it is until the motor has come to an end of the dead band, and is then
    /// taken along: the play operator, `link = clamp(link, motor - angle / 2, motor + angle / 2)`.
    /// Forces do not move the link within the band. It begins in the middle.
    Backlash {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
        /// Width of the dead band, rad: how far the motor turns back before the link follows.
        angle: f64,
    },
    /// A joint's encoder that goes on showing the same angle; the joint turns as before.
    JointFreeze {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
    },
    /// A joint's encoder that shows only a part of each turn, or more than all of it, from where it began to.
    JointGain {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
        /// What it shows of a turn, as a factor; below 0 the reverse of it.
        gain: f64,
    },
    /// A joint's encoder that shows an angle that is off, all at once.
    JointJump {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
        /// What it shows too much, rad.
        angle: f64,
    },
    /// The sensors of two fingers that are connected in place of each other, all through a run.
    SwappedSensors {
        /// The finger.
        finger: usize,
        /// The other finger.
        other: usize,
    },
    /// Friction that is lost, as on a wet cap.
    FrictionDrop {
        /// The object's name; without it, all objects.
        #[serde(default)]
        object: Option<String>,
        /// Factor on all coefficients of feelers on it.
        factor: f64,
    },
    /// A free object that becomes heavier or lighter, as a vessel into which water is poured. Its moments of inertia go
    /// with its mass, its centre of mass stays.
    MassChange {
        /// The object's name.
        object: String,
        /// Its mass in the end, kg.
        mass: f64,
        /// How long it takes, s; the mass changes evenly.
        #[serde(default)]
        over: f64,
    },
}

impl FaultKind {
    /// The finger that it concerns, if it concerns one.
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
            | Self::SwappedSensors { finger, .. } => Some(finger),
            Self::FrictionDrop { .. } | Self::MassChange { .. } => None,
        }
    }
}
