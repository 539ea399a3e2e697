//! The screw task: SEARCH, MOVE, RELEASE, RETURN, again and again (paper, section V.B).

use super::flags::FingerFlags;
use super::phase::Phase;
use super::speed::Plan;
use super::stop_reason::StopReason;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The roughly planned rectangle that each finger goes round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskConfig {
    /// How many times the fingers touch, turn and release.
    pub strokes: u32,
    /// v_0: speed of the approach, m/s.
    pub search_speed: f64,
    /// A finger that searches stops at this grasp force, N; all fingers there start to move.
    pub grasp_force: f64,
    /// A finger that has come this far from home and feels no grasp stops the task, m.
    pub search_limit: f64,
    /// v_m: speed of the stroke, m/s.
    pub move_speed: f64,
    /// Length of the stroke, m.
    pub travel: f64,
    /// Speed of release and return, m/s.
    pub return_speed: f64,
    /// A finger is home within this distance, m.
    pub home_tolerance: f64,
    /// Each finger's rectangle.
    pub finger: Vec<FingerPathConfig>,
}

/// One finger's rectangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerPathConfig {
    /// Where the dome's centre starts from, m, in W.
    pub home: [f64; 3],
    /// Direction in which the finger searches for the object, in W; its length does not matter.
    pub approach: [f64; 3],
    /// Direction of the stroke, in W; its length does not matter.
    pub stroke: [f64; 3],
}

/// What the task knows of one finger: flags from touch, position from its encoders.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FingerSense {
    /// What it feels.
    pub flags: FingerFlags,
    /// Its dome's centre, m, in W.
    pub position: DVec3,
}

/// The state machine of the task.
#[derive(Debug, Clone)]
pub struct ScrewTask {
    config: TaskConfig,
    paths: Vec<Path>,
    phase: Phase,
    /// The phase that the task was given up in.
    stopped_in: Option<Phase>,
    stroke: u32,
}

#[derive(Debug, Clone, Copy)]
struct Path {
    home: DVec3,
    approach: DVec3,
    stroke: DVec3,
    /// Where the stroke began, m, in W.
    stroke_start: DVec3,
}

impl ScrewTask {
    /// The task at its beginning, before the first stroke.
    pub fn new(config: TaskConfig) -> Self {
        let paths = config.finger.iter().map(Path::new).collect();
        Self {
            config,
            paths,
            phase: Phase::Search,
            stopped_in: None,
            stroke: 1,
        }
    }

    /// Where the task stands.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The current stroke, from 1.
    pub fn stroke(&self) -> u32 {
        self.stroke
    }

    /// What finger `finger` is to do.
    pub fn plan(&self, finger: usize, sense: &FingerSense) -> Plan {
        let Some(path) = self.paths.get(finger) else {
            return Plan::default();
        };
        let velocity = match self.phase {
            Phase::Search if sense.flags.grasp_force < self.config.grasp_force => {
                self.config.search_speed * path.approach
            }
            Phase::Move if path.travelled(sense.position) < self.config.travel => {
                self.config.move_speed * path.stroke
            }
            Phase::Release => -self.config.return_speed * path.approach,
            Phase::Return => ((path.home - sense.position) / HOMING_TIME)
                .clamp_length_max(self.config.return_speed),
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: path.approach,
            reflex: matches!(self.phase, Phase::Search | Phase::Move),
            keep_grasp: self.phase == Phase::Move,
        }
    }

    /// Goes on to the next phase once every finger is through with this one.
    ///
    /// # Errors
    /// When a finger finds nothing to grasp.
    pub fn advance(&mut self, fingers: &[FingerSense]) -> Result<(), StopReason> {
        match self.phase {
            Phase::Search => {
                self.check_search(fingers)?;
                let grasp_force = self.config.grasp_force;
                if fingers.iter().all(|f| f.flags.grasp_force >= grasp_force) {
                    for (path, finger) in self.paths.iter_mut().zip(fingers) {
                        path.stroke_start = finger.position;
                    }
                    self.phase = Phase::Move;
                }
            }
            Phase::Move => {
                if self.all(fingers, |p, f| {
                    p.travelled(f.position) >= self.config.travel
                }) {
                    self.phase = Phase::Release;
                }
            }
            Phase::Release => {
                if self.all(fingers, |p, f| p.approached(f.position) <= 0.0) {
                    self.phase = Phase::Return;
                }
            }
            Phase::Return => {
                let tolerance = self.config.home_tolerance;
                if self.all(fingers, |p, f| p.home.distance(f.position) <= tolerance) {
                    self.end_stroke();
                }
            }
            Phase::Done | Phase::Stopped => {}
        }
        Ok(())
    }

    /// Gives the task up: the fingers stay where they are.
    pub fn stop(&mut self) {
        if self.phase != Phase::Stopped {
            self.stopped_in = Some(self.phase);
            self.phase = Phase::Stopped;
        }
    }

    /// Takes the task up again in the phase that it was given up in.
    pub fn resume(&mut self) {
        if let Some(phase) = self.stopped_in.take() {
            self.phase = phase;
        }
    }

    fn end_stroke(&mut self) {
        if self.stroke < self.config.strokes {
            self.stroke += 1;
            self.phase = Phase::Search;
        } else {
            self.phase = Phase::Done;
        }
    }

    fn all(&self, fingers: &[FingerSense], through: impl Fn(&Path, &FingerSense) -> bool) -> bool {
        self.paths.iter().zip(fingers).all(|(p, f)| through(p, f))
    }

    fn check_search(&self, fingers: &[FingerSense]) -> Result<(), StopReason> {
        let limit = self.config.search_limit;
        for (finger, (path, sense)) in self.paths.iter().zip(fingers).enumerate() {
            let travel = path.approached(sense.position);
            if travel > limit && sense.flags.grasp_force < self.config.grasp_force {
                return Err(StopReason::NothingToGrasp {
                    finger,
                    travel,
                    limit,
                });
            }
        }
        Ok(())
    }
}

/// A finger that returns has a velocity of its distance from home over this time, s, and no more
/// than the return speed.
const HOMING_TIME: f64 = 0.1;

impl Path {
    fn new(config: &FingerPathConfig) -> Self {
        let home = DVec3::from_array(config.home);
        Self {
            home,
            approach: DVec3::from_array(config.approach).normalize_or_zero(),
            stroke: DVec3::from_array(config.stroke).normalize_or_zero(),
            stroke_start: home,
        }
    }

    /// How far along the stroke a finger at `position` is, m.
    fn travelled(&self, position: DVec3) -> f64 {
        (position - self.stroke_start).dot(self.stroke)
    }

    /// How far from home towards the object a finger at `position` is, m.
    fn approached(&self, position: DVec3) -> f64 {
        (position - self.home).dot(self.approach)
    }
}
