//! What only the simulator knows of a run: for whoever judges it, never for the hand.

use super::Session;
use super::held_touch::{FrameTimes, FramesTaken};
use feeler::hand::MAX_FINGERS;
use feeler_sim::object::Motion;
use feeler_sim::state::State;
use feeler_sim::world::World;
use std::sync::atomic::Ordering;

/// What came of a run so far, in truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Torque that the cap is tightened to, N·m: what its thread now holds against being turned on. None
    /// without a cap.
    pub cap_torque: Option<f64>,
    /// How far the cap is turned on, rad. None without a cap.
    pub cap_angle: Option<f64>,
    /// Work that friction took from feelers that slipped, J.
    pub slip_work: f64,
}

impl Truth {
    /// What came of `session` so far.
    pub fn of(session: &Session) -> Self {
        Self::in_world(&session.rig().world(), session.cap())
    }

    /// What came of a run in `world` so far, whose object `cap` is on a thread.
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

/// Measures how far feelers slip from one time to the next.
#[derive(Debug, Clone)]
pub(super) struct SlipMeter {
    /// Way that each feeler of each finger had slipped when it was last looked at, m.
    ways: Vec<Vec<f64>>,
    /// Steps of the world by then, and what it said.
    newest: Option<(u64, [f64; MAX_FINGERS])>,
    /// When there are pictures, where there is not one in every control period.
    frames: Option<FrameTimes>,
    /// Where time does not wait for steps, pictures are counted instead: as many as when it was last looked, and the count.
    taken: Option<(u64, FramesTaken)>,
}

impl SlipMeter {
    /// For the fingers of `state`, as far as they have slipped by then; with a `frame_period` (s), from one picture to the next.
    pub fn new(state: &State, frame_period: Option<f64>) -> Self {
        let ways = state.fingers.iter().map(|finger| finger.slipped.clone());
        Self {
            ways: ways.collect(),
            newest: None,
            frames: frame_period.map(FrameTimes::new),
            taken: None,
        }
    }

    /// The same, from one picture that is `taken` to the next, where there is not one in every control period.
    #[cfg(target_os = "linux")]
    pub fn by_count(self, taken: FramesTaken) -> Self {
        let taken = self.frames.is_some().then_some((0, taken));
        Self { taken, ..self }
    }

    /// Whether there is a new picture at `time`, s.
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

    /// Of each finger's feelers, the longest way that one slipped since the time before, m. At the same time it
    /// says the same again; and until the next picture, so that it is of the time that the newest flags are of.
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
