//! Recorded data of a probing run, limited to signals that a real hand provides.

use feeler::control::task::probe::{ProbeConfig, Step};
use feeler::control::{ControlConfig, ControlLoop, FingertipPose, TactileSource};
use feeler::hand::{Hand, JointVector};
use feeler::sensor::fingertip::ElementLayout;
use glam::DVec3;

/// Trace of a probing run.
#[derive(Debug, Clone)]
pub struct Trace {
    /// Configuration of the routine.
    pub probe: ProbeConfig,
    /// Control period (s).
    pub period: f64,
    /// Force F1 above which an element is in contact (N).
    pub touch_force: f64,
    /// Traces of the fingers, in the order of the hand.
    pub fingers: Vec<FingerTrace>,
}

/// Trace of one finger.
#[derive(Debug, Clone)]
pub struct FingerTrace {
    /// Layout of its elements.
    pub layout: ElementLayout,
    /// Unit vector towards the object, in W.
    pub approach: DVec3,
    /// Unit vector along the object's axis, in W.
    pub axis: DVec3,
    /// Rows of all control steps.
    pub rows: Vec<Row>,
}

/// State of one finger at one control step.
#[derive(Debug, Clone)]
pub struct Row {
    /// Time (s).
    pub time: f64,
    /// Step of the probing routine.
    pub step: Step,
    /// Index of the probed place, starting at 0.
    pub place: u32,
    /// Joint velocities commanded in this step (rad/s).
    pub command: JointVector,
    /// Joint angles (rad).
    pub joints: JointVector,
    /// Pose of the fingertip, from the joint angles.
    pub pose: FingertipPose,
    /// Latest force on each element in its frame (N); see [`TactileFrame`](feeler::sensor::forces::TactileFrame).
    pub forces: Vec<DVec3>,
}

impl Row {
    /// Tip of the undeformed `element` in W (m).
    pub fn tip(&self, layout: &ElementLayout, element: usize) -> DVec3 {
        self.pose.position + self.pose.rotation * layout.tip(element)
    }

    /// Largest force `F_z` on any element (N).
    pub fn greatest(&self) -> f64 {
        self.forces
            .iter()
            .fold(0.0, |most, force| most.max(force.z))
    }
}

impl FingerTrace {
    /// Returns a trace in which each force is paired with the pose and step of `delay` seconds earlier.
    #[must_use]
    pub fn aligned(&self, delay: f64) -> Self {
        let shifted = |(index, row): (usize, &Row)| {
            let time = row.time - delay;
            let after = self.rows[..=index].partition_point(|row| row.time < time);
            let (before, after) = (
                &self.rows[after.saturating_sub(1)],
                &self.rows[after.min(index)],
            );
            let period = after.time - before.time;
            let part = if period > 0.0 {
                (time - before.time) / period
            } else {
                1.0
            };
            let part = part.clamp(0.0, 1.0);
            let nearest = if part < 0.5 { before } else { after };
            let (from, to) = (before.pose, after.pose);
            Row {
                step: nearest.step,
                place: nearest.place,
                pose: FingertipPose {
                    position: from.position.lerp(to.position, part),
                    // The rotations differ by milliradians only.
                    rotation: from.rotation * (1.0 - part) + to.rotation * part,
                },
                ..row.clone()
            }
        };
        Self {
            rows: self.rows.iter().enumerate().map(shifted).collect(),
            ..self.clone()
        }
    }
}

impl Trace {
    /// Creates an empty trace of a hand whose fingers have the elements of `layouts`.
    pub fn new(probe: &ProbeConfig, control: &ControlConfig, layouts: &[ElementLayout]) -> Self {
        let fingers = probe.finger.iter().zip(layouts).map(|(path, layout)| {
            let approach = DVec3::from_array(path.approach).normalize_or_zero();
            let stroke = DVec3::from_array(path.stroke).reject_from_normalized(approach);
            FingerTrace {
                layout: layout.clone(),
                approach,
                axis: approach.cross(stroke).normalize_or_zero(),
                rows: Vec::new(),
            }
        });
        Self {
            probe: probe.clone(),
            period: control.period,
            touch_force: control.touch_force,
            fingers: fingers.collect(),
        }
    }

    /// Appends the latest control step of `control_loop`.
    pub fn push<S: TactileSource, H: Hand>(&mut self, control_loop: &ControlLoop<S, H>) {
        let controller = control_loop.controller();
        let task = controller.task();
        let number = task.findings().first().map_or(0.0, |step| step.value);
        let step = Step::ALL.get(number as usize).copied().unwrap_or_default();
        let state = control_loop.state();
        let command = control_loop.command().joint_velocity();
        let hand = controller.poses().iter().zip(&state.joints).zip(command);
        let sensed = hand.zip(control_loop.touches());
        for (finger, (((&pose, joints), &command), touch)) in self.fingers.iter_mut().zip(sensed) {
            finger.rows.push(Row {
                time: state.stamp,
                step,
                place: task.stroke() - 1,
                command,
                joints: joints.position,
                pose,
                forces: touch.frame.forces.clone(),
            });
        }
    }
}
