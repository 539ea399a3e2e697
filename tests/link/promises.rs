//! What the hand promises, held against what it recorded.

use feeler::control::phase::Phase;
use feeler::record::Recording;
use std::fs;
use std::path::Path;

/// The control period and the age from which data are stale in the built-in experiment, s.
pub const PERIOD: f64 = 0.01;
pub const LIMIT: f64 = 3.5 * PERIOD;

/// Stamps differ by rounding.
const ROUNDING: f64 = 1e-9;

pub struct Recorded {
    recording: Recording,
    /// Of `summary.json`.
    pub summary: serde_json::Value,
}

/// A time that the hand stood still.
#[derive(Debug)]
pub struct Stop {
    pub reason: String,
    /// First and last recorded step of it.
    pub steps: (usize, usize),
}

impl Recorded {
    pub fn of(run: &Path) -> Self {
        let summary = fs::read_to_string(run.join("summary.json")).expect("a summary");
        Self {
            recording: Recording::read(run.join("recording.mcap")).expect("a recording"),
            summary: serde_json::from_str(&summary).expect("a summary"),
        }
    }

    /// How many of the claims hold.
    pub fn claims(&self) -> usize {
        let claims = self.summary["claims"].as_array().expect("claims");
        claims.iter().filter(|claim| claim["holds"] == true).count()
    }

    fn steps(&self) -> usize {
        self.recording.task.len()
    }

    fn stamp(&self, step: usize) -> f64 {
        self.recording.task[step].stamp
    }

    /// Joint velocities of all fingers as sent in `step`, rad/s.
    fn commanded(&self, step: usize) -> Vec<f64> {
        let fingers = self.recording.fingers.iter();
        fingers
            .flat_map(|finger| finger.command[step].joint_velocity)
            .collect()
    }

    fn moves(&self, step: usize) -> bool {
        self.commanded(step).iter().any(|&velocity| velocity != 0.0)
    }

    /// Age of the oldest forces in `step`, against the joint angles, s.
    fn age_of_forces(&self, step: usize) -> f64 {
        let fingers = self.recording.fingers.iter();
        let ages =
            fingers.map(|finger| (finger.joints[step].stamp - finger.tactile[step].stamp).abs());
        ages.fold(0.0, f64::max)
    }

    /// How many control steps before `step` had the same joint angles.
    fn repeats(&self, step: usize) -> usize {
        let before = (0..step).rev();
        before
            .take_while(|&s| self.stamp(s) == self.stamp(step))
            .count()
    }

    /// Every time that the hand stood still, and why.
    pub fn stops(&self) -> Vec<Stop> {
        let mut stops: Vec<Stop> = Vec::new();
        for (step, task) in self.recording.task.iter().enumerate() {
            if task.phase != Phase::Stopped {
                continue;
            }
            match stops.last_mut().filter(|_| task.reason.is_empty()) {
                Some(stop) => stop.steps.1 = step,
                None => stops.push(Stop {
                    reason: task.reason.clone(),
                    steps: (step, step),
                }),
            }
        }
        stops
    }

    /// Asserts that no command to move was made from stale data, that the hand stopped in time, and that all
    /// fingers stood still while it was stopped. Its stops.
    pub fn keeps_its_promises(&self) -> Vec<Stop> {
        assert!(self.recording.complete, "{:?}", self.recording.problem);
        for step in (0..self.steps()).filter(|&step| self.moves(step)) {
            let at = self.stamp(step);
            let age = self.age_of_forces(step);
            assert!(
                age <= LIMIT + PERIOD + ROUNDING,
                "{at} s: forces {age} s old"
            );
            // The hand takes a step each period, whether the joint angles are new or not.
            let age = PERIOD * self.repeats(step) as f64;
            assert!(age <= LIMIT + PERIOD, "{at} s: joint angles {age} s old");
        }
        let stops = self.stops();
        for stop in &stops {
            self.came_in_time(stop);
            self.stood_still(stop);
        }
        stops
    }

    /// A stop for want of data comes in the first step in which they are older than the limit: no later
    /// than a period after it, but where the processor came late to that step itself.
    fn came_in_time(&self, stop: &Stop) {
        let first = stop.steps.0;
        let (now, before) = (self.stamp(first), self.stamp(first.saturating_sub(1)));
        let late = PERIOD.max(now - before);
        let (forces, joints) = (
            self.age_of_forces(first),
            PERIOD * self.repeats(first) as f64,
        );
        println!(
            "{now:.2} s: {}; in the record: forces {forces:.3} s, joint angles {joints:.3} s",
            stop.reason
        );
        assert!(!stop.reason.is_empty(), "{now} s: no reason");
        assert!(
            forces <= LIMIT + late + ROUNDING,
            "{now} s: {stop:?} by forces {forces} s old"
        );
        assert!(
            joints <= LIMIT + late + ROUNDING,
            "{now} s: {stop:?} by joints {joints} s old"
        );
    }

    /// While the hand is stopped nothing is commanded, and nothing moves once the drives stand.
    fn stood_still(&self, stop: &Stop) {
        let (first, last) = stop.steps;
        for step in first..=last {
            let commanded = self.commanded(step);
            assert!(
                commanded.iter().all(|&v| v == 0.0),
                "{stop:?}: {commanded:?}"
            );
        }
        // What a command takes on its way, and the watchdog.
        let stands = self.stamp(first) + 2.0 * (LIMIT + PERIOD);
        let standing: Vec<_> = (first..=last).filter(|&s| self.stamp(s) > stands).collect();
        for finger in &self.recording.fingers {
            let at = |step: &usize| finger.joints[*step].position;
            for (a, b) in standing.first().map(at).iter().zip(standing.last().map(at)) {
                let moved = a
                    .iter()
                    .zip(b)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max);
                assert!(moved < 1e-3, "{stop:?}: a joint moved by {moved} rad");
            }
        }
    }

    /// Joint velocities that the encoders said in the first recorded step, rad/s.
    pub fn first_velocities(&self) -> Vec<f64> {
        let fingers = self.recording.fingers.iter();
        fingers
            .flat_map(|finger| finger.joints[0].velocity)
            .collect()
    }
}
