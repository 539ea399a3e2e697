//! Trials of a gripper with unknown objects: drops, excess force, and reaction time to slip.

mod meter;
mod object;
mod score;

pub use meter::GripMeter;
pub use object::GripObject;
pub use score::{GripDifference, GripRow, GripScore, grip_over_load};

use crate::config::{Experiment, ExperimentConfig};
#[cfg(target_os = "linux")]
use crate::experiment::rigs::driven::{self, DrivenError};
use crate::experiment::{ExperimentError, Pictures, Session};
use feeler::control::task::TaskConfig;
use feeler::control::task::grip::GripLaw;
#[cfg(target_os = "linux")]
use std::convert::Infallible;
#[cfg(target_os = "linux")]
use std::ops::ControlFlow;
#[cfg(target_os = "linux")]
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Height above the table that an object must have reached to count as lifted (m).
const LIFTED: f64 = 0.08;
/// Ratios of the load to the limit of kinetic friction that are tried in the search for the least grip. Above 1, only
/// static friction holds the object.
const UTILISATIONS: [f64; 6] = [0.7, 0.8, 0.9, 1.0, 1.1, 1.2];

/// Adds the random object of `seed` to the experiment `config` of a gripper, and returns it. The law `known-friction`
/// receives its coefficient of kinetic friction.
pub fn place_random_object(config: &mut ExperimentConfig, seed: u64) -> GripObject {
    let object = GripObject::draw(seed);
    object.place(config);
    // TOML integers are signed.
    config.seed = seed >> 1;
    if let TaskConfig::Grip(grip) = &mut config.task {
        grip.known_friction = object.friction * object.kinetic;
    }
    object
}

/// Result of a trial.
#[derive(Debug, Clone)]
pub struct GripTrial {
    /// The object.
    pub object: GripObject,
    /// Ground truth of the grasp.
    pub meter: GripMeter,
    /// Outcome of the task, or `None` if it did not end.
    pub outcome: Option<&'static str>,
}

impl GripTrial {
    /// Runs the gripper of `experiment` with the random object of `seed`.
    ///
    /// # Errors
    /// If the experiment cannot be set up, or a step fails.
    pub fn run(experiment: &Experiment, seed: u64) -> Result<Self, ExperimentError> {
        let mut experiment = experiment.clone();
        let object = place_random_object(&mut experiment.config, seed);
        let mut session = Session::rendering(&experiment, Pictures::Sensed)?;
        let meter = watch(&session, &object);
        while !session.finished() {
            session.step()?;
        }
        Ok(Self::ended(&session, object, &meter))
    }

    /// Like [`run`](Self::run), but the fingers are moved by the servos of `experiment` on an emulated bus, in simulated
    /// time.
    ///
    /// # Errors
    /// Like [`run`](Self::run), or if the servos cannot be used.
    #[cfg(target_os = "linux")]
    pub fn run_on_bus(experiment: &Experiment, seed: u64) -> Result<Self, DrivenError> {
        let mut experiment = experiment.clone();
        let object = place_random_object(&mut experiment.config, seed);
        let (mut session, bus) = driven::session(&experiment, f64::INFINITY)?;
        let meter = watch(&session, &object);
        let mut schedule = bus.schedule(experiment.config.control.period)?;
        let never = AtomicBool::new(false);
        session.run(&mut schedule, &never, |_, _, _| {
            ControlFlow::<Infallible>::Continue(())
        })?;
        Ok(Self::ended(&session, object, &meter))
    }

    /// Smallest mean grip with which the law `known-friction` holds the random object of `seed` (N), over a range of margins
    /// below the friction limit. `None` if it always drops the object.
    ///
    /// # Errors
    /// Like [`run`](Self::run).
    pub fn least_grip(experiment: &Experiment, seed: u64) -> Result<Option<f64>, ExperimentError> {
        let mut experiment = experiment.clone();
        let mut least: Option<f64> = None;
        for utilisation in UTILISATIONS {
            if let TaskConfig::Grip(grip) = &mut experiment.config.task {
                grip.law = GripLaw::KnownFriction;
                grip.known_utilisation = utilisation;
            }
            let trial = Self::run(&experiment, seed)?;
            let [grip, _] = trial.meter.mean_grips();
            if !trial.dropped() {
                least = Some(least.map_or(grip, |other| other.min(grip)));
            }
        }
        Ok(least)
    }

    /// Result of a finished `session`.
    fn ended(session: &Session, object: GripObject, meter: &Mutex<GripMeter>) -> Self {
        let controller = session.control_loop().controller();
        Self {
            object,
            meter: locked(meter).clone(),
            outcome: controller.task().outcome(),
        }
    }

    /// `true` if the object was not lifted, slid out of the grip, or was released in the air.
    pub fn dropped(&self) -> bool {
        self.meter.dropped || self.meter.highest < LIFTED
    }

    /// `true` if a finger pressed harder than the object withstands.
    pub fn crushed(&self) -> bool {
        self.meter.peak > self.object.crush_force(self.meter.peak_required)
    }
}

/// Measures the ground truth of `session` from now on.
fn watch(session: &Session, object: &GripObject) -> Arc<Mutex<GripMeter>> {
    let meter = Arc::new(Mutex::new(GripMeter::new(object, session.layouts().len())));
    let own = meter.clone();
    let mut world = session.rig().world();
    world.observe(move |model, state| locked(&own).observe(model, state));
    drop(world);
    meter
}

fn locked(meter: &Mutex<GripMeter>) -> MutexGuard<'_, GripMeter> {
    meter.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Start of the shake (s).
    const SHAKE_START: f64 = 4.0;
    /// Time at which the object has been tugged and filled (s).
    const FILLED: f64 = 7.5;

    #[test]
    fn a_gripper_that_is_stopped_does_not_react_to_slip() {
        let mut slips = 0;
        for seed in 0..6 {
            let mut experiment = Experiment::load("grip", &[]).expect("an experiment");
            let object = place_random_object(&mut experiment.config, seed);
            let mut session = Session::rendering(&experiment, Pictures::Sensed).expect("a session");
            let meter = watch(&session, &object);
            let mut before = None;
            while session.control_loop().state().stamp < FILLED {
                session.step().expect("a step");
                if before.is_none() && session.control_loop().state().stamp > SHAKE_START {
                    session.stop("the test");
                    before = Some(locked(&meter).reactions.len());
                }
            }
            let reactions = &locked(&meter).reactions[before.expect("a stop")..];
            assert!(reactions.iter().all(Option::is_none), "{reactions:?}");
            slips += reactions.len();
        }
        assert!(slips > 0, "no object has slipped");
    }
}
