//! Standard messages from which viewers draw a run.
//!
//! They are derived from the rest of the recording. Joints and wrenches are written at every control step, for plots;
//! the scene is written at 30 Hz.

use crate::error::RecordError;
use crate::messages::facts::RunFacts;
use crate::messages::model::{SolidFrame, WORLD_FRAME};
use crate::messages::topic::topics;
use crate::ros::{
    Header, MarkerArray, PointCloud2, TFMessage, Time, TransformStamped, WrenchStamped,
};
use crate::sensed::taxels::{Elements, taxels};
use crate::viewers::kinematic_messages::KinematicMessages;
use crate::viewers::scene::{FRAME_TIME, ForceArrows, scene};
use crate::writing::instruments::InstrumentRecord;
use crate::writing::memory::MessageSink;
use feeler::control::{ControlLoop, TactileReading, TactileSource};
use feeler::hand::Hand;

/// Writes messages for viewers. The messages' memory is reused.
pub struct ViewerLog {
    fingers: Vec<Finger>,
    kinematics: KinematicMessages,
    /// Markers of the solids.
    scene: MarkerArray,
    /// Transforms of the solids that move around the hand. Each is a separate message, because its pose may be unknown.
    moving: Vec<(SolidFrame, TFMessage)>,
    arrows: MarkerArray,
    /// Time of the latest scene update (s), or `None` before the first.
    drawn: Option<f64>,
}

struct Finger {
    elements: Elements,
    wrench: WrenchStamped,
    taxels: PointCloud2,
    arrows: ForceArrows,
}

impl ViewerLog {
    /// Creates a log for the run described by `facts`, or returns `None` if the geometry of its fingers is unknown.
    ///
    /// # Errors
    /// If the constants are invalid.
    pub fn new(facts: &RunFacts) -> Result<Option<Self>, RecordError> {
        if facts.hand.is_empty() {
            return Ok(None);
        }
        let kinematics = KinematicMessages::new(facts)?;
        let mut arrows = MarkerArray::default();
        let mut fingers = Vec::new();
        for (number, model) in facts.hand.iter().enumerate() {
            let elements = Elements::of(model);
            let (taxels, arrow) = (taxels(number, &elements), ForceArrows::new(number, facts));
            arrows.markers.push(arrow.marker());
            fingers.push(Finger {
                wrench: WrenchStamped {
                    header: taxels.header.clone(),
                    ..WrenchStamped::default()
                },
                elements,
                taxels,
                arrows: arrow,
            });
        }
        let is_there = |frame: &SolidFrame| facts.solids.iter().any(|s| s.frame == *frame);
        let moving = SolidFrame::MOVING.into_iter().filter(is_there);
        let place = |frame: SolidFrame| {
            let place = TransformStamped {
                header: Header::of(WORLD_FRAME),
                child_frame_id: frame.name().into(),
                ..TransformStamped::default()
            };
            let transforms = vec![place];
            (frame, TFMessage { transforms })
        };
        let moving = moving.map(place).collect();
        Ok(Some(Self {
            fingers,
            kinematics,
            scene: scene(&facts.hand, &facts.solids),
            moving,
            arrows,
            drawn: None,
        }))
    }

    /// Requests that the static messages are written again, because they may have been dropped.
    pub fn forget_written(&mut self) {
        self.drawn = None;
    }

    /// Writes the latest step of `control_loop`, and the poses of the moving solids from `instruments`.
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub fn write<R: MessageSink, S: TactileSource, H: Hand>(
        &mut self,
        recorder: &mut R,
        control_loop: &ControlLoop<S, H>,
        instruments: InstrumentRecord<'_>,
    ) -> Result<(), RecordError> {
        let state = control_loop.state();
        // An invalid time is reported when the other messages are written.
        let Some(now) = Time::of(state.stamp) else {
            return Ok(());
        };
        if self.drawn.is_none() {
            self.write_still(recorder, now, state.stamp)?;
        }
        let joints = state.joints.iter().map(|at| (at.position, at.velocity));
        self.kinematics.set_joints(now, joints);
        recorder.write(topics::JOINT_STATES, &self.kinematics.joints)?;
        let due = self
            .drawn
            .is_none_or(|drawn| state.stamp - drawn >= FRAME_TIME);
        for (index, touch) in control_loop.touches().iter().enumerate() {
            self.write_felt(recorder, index, touch, due)?;
        }
        if due {
            self.drawn = Some(state.stamp);
            let angles = |finger: usize| Some(state.joints.get(finger)?.position);
            self.kinematics.set_moving(now, angles);
            self.write_transforms(recorder, now, instruments)?;
            for marker in &mut self.arrows.markers {
                marker.header.stamp = now;
            }
            recorder.write(topics::SCENE, &self.arrows)?;
        }
        Ok(())
    }

    fn write_still<R: MessageSink>(
        &mut self,
        recorder: &mut R,
        now: Time,
        stamp: f64,
    ) -> Result<(), RecordError> {
        self.kinematics.description.stamp = stamp;
        recorder.write(topics::ROBOT_DESCRIPTION, &self.kinematics.description)?;
        self.kinematics.set_still(now);
        recorder.write(topics::TF_STATIC, &self.kinematics.still)?;
        for marker in &mut self.scene.markers {
            marker.header.stamp = now;
        }
        recorder.write(topics::SCENE, &self.scene)
    }

    /// Writes the wrench on a finger and, if a scene update is `due`, its elements.
    fn write_felt<R: MessageSink>(
        &mut self,
        recorder: &mut R,
        index: usize,
        touch: &TactileReading,
        due: bool,
    ) -> Result<(), RecordError> {
        let Some(finger) = self.fingers.get_mut(index) else {
            return Ok(());
        };
        let Some(stamp) = Time::of(touch.frame.stamp) else {
            return Ok(());
        };
        finger.elements.take_forces(&touch.frame.forces);
        finger.wrench.header.stamp = stamp;
        finger.wrench.wrench = finger.elements.wrench();
        recorder.write(topics::wrench(index), &finger.wrench)?;
        if due {
            finger.taxels.header.stamp = stamp;
            let slips = |element: usize| finger.arrows.slips(touch, element);
            finger.elements.fill(&mut finger.taxels, slips);
            recorder.write(topics::taxels(index), &finger.taxels)?;
            if let Some(marker) = self.arrows.markers.get_mut(index) {
                finger.arrows.fill(marker, &finger.elements, touch);
            }
        }
        Ok(())
    }

    fn write_transforms<R: MessageSink>(
        &mut self,
        recorder: &mut R,
        now: Time,
        instruments: InstrumentRecord<'_>,
    ) -> Result<(), RecordError> {
        recorder.write(topics::TF, &self.kinematics.moving)?;
        for (frame, message) in &mut self.moving {
            let Some(pose) = instruments.pose(*frame) else {
                continue;
            };
            for transform in &mut message.transforms {
                transform.header.stamp = now;
                transform.transform = pose.into();
            }
            recorder.write(topics::TF, message)?;
        }
        Ok(())
    }
}
