//! Ground truth of a run, for evaluation only. It never reaches the hand.

use super::sample_and_hold::{FrameCounter, FrameTimes};
use crate::experiment::Session;
use feeler::hand::MAX_FINGERS;
use feeler_sim::objects::Motion;
use feeler_sim::world::{State, World};
use std::sync::atomic::Ordering;

/// Ground truth of a run so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Tightening torque of the cap, that is, the torque that its thread resists when turned further (N·m). `None`
    /// without a cap.
    pub cap_torque: Option<f64>,
    /// Angle by which the cap has been turned in the closing direction (rad). `None` without a cap.
    pub cap_angle: Option<f64>,
    /// Work dissipated by slipping feelers (J).
    pub slip_work: f64,
}

impl Truth {
    /// Returns the ground truth of `session` so far.
    pub fn of(session: &Session) -> Self {
        Self::in_world(&session.rig().world(), session.cap())
    }

    /// Returns the ground truth of a run in `world` so far. `cap` is the index of the object with a thread.
    pub(crate) fn in_world(world: &World, cap: Option<usize>) -> Self {
        let (model, state) = (world.model(), world.state());
        let cap = cap.and_then(|cap| {
            let (object, state) = (model.objects.get(cap)?, state.objects.get(cap)?);
            match &object.motion {
                Motion::Turns(hinge) => Some((hinge, state.turn.angle)),
                Motion::Fixed | Motion::Free(_) => None,
            }
        });
        Self {
            cap_torque: cap.map(|(hinge, angle)| hinge.thread.resisting_torque(angle)),
            cap_angle: cap.map(|(_, angle)| angle),
            slip_work: state.slip_work(),
        }
    }
}

/// Measures the slip distance of feelers between readings.
#[derive(Debug, Clone)]
pub(super) struct SlipMeter {
    /// Total slip distance of each feeler of each finger at the last reading (m).
    ways: Vec<Vec<f64>>,
    /// Number of world steps and result of the last reading.
    newest: Option<(u64, [f64; MAX_FINGERS])>,
    /// Times of frames, if the frame rate is lower than the control rate.
    frames: Option<FrameTimes>,
    /// Frame count at the last reading, and the counter of taken frames. Present if the world advances independently of
    /// the control steps; new frames are then detected by the counter instead of by `frames`.
    taken: Option<(u64, FrameCounter)>,
}

impl SlipMeter {
    /// Starts measuring at `state`, between readings or, with a `frame_period` (s), between frames.
    pub fn new(state: &State, frame_period: Option<f64>) -> Self {
        let ways = state.fingers.iter().map(|finger| finger.slipped.clone());
        Self {
            ways: ways.collect(),
            newest: None,
            frames: frame_period.map(FrameTimes::new),
            taken: None,
        }
    }

    /// Detects new frames by the counter `taken` instead of by time if the frame rate is lower than the control rate.
    #[cfg(target_os = "linux")]
    pub fn by_count(self, taken: FrameCounter) -> Self {
        let taken = self.frames.is_some().then_some((0, taken));
        Self { taken, ..self }
    }

    /// Returns `true` if there is a new frame at `time` (s).
    fn is_due(&mut self, time: f64) -> bool {
        match (&mut self.taken, &mut self.frames) {
            (Some((seen, taken)), _) => {
                let now = taken.load(Ordering::Relaxed);
                std::mem::replace(seen, now) != now
            }
            (None, Some(frames)) => frames.is_due(time),
            (None, None) => true,
        }
    }

    /// Returns for each finger the longest slip distance of a feeler since the previous reading (m). Repeated readings
    /// at the same time are equal, and so are readings until the next frame, so that the result matches the time of the
    /// latest flags.
    pub fn read(&mut self, state: &State) -> [f64; MAX_FINGERS] {
        match self.newest {
            Some((steps, slipped)) if steps == state.steps => return slipped,
            _ => {}
        }
        let due = self.is_due(state.time);
        if let (false, Some((_, slipped))) = (due, self.newest) {
            return slipped;
        }
        let mut slipped = [0.0; MAX_FINGERS];
        let fingers = state.fingers.iter().zip(&mut self.ways);
        for (longest, (finger, ways)) in slipped.iter_mut().zip(fingers) {
            let mut most = 0.0;
            for (before, &now) in ways.iter_mut().zip(&finger.slipped) {
                let way = now - *before;
                most = if way > most { way } else { most };
                *before = now;
            }
            *longest = most;
        }
        self.newest = Some((state.steps, slipped));
        slipped
    }
}
