//! A custom task, explained in docs/write-a-task.md: two fingers close on an object, squeeze it, report its stiffness,
//! and release it.
//!
//! ```text
//! cargo run --release --example own_task
//! ```

use feeler::control::task::{Finding, Task};
use feeler::control::{HandReadings, Phase, Plan, StopReason};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use glam::DVec3;

/// Closes on an object until it resists with a given force, and reports the object's stiffness.
#[derive(Debug, Clone)]
struct Squeeze {
    /// Direction in which each finger presses, in W.
    approach: [DVec3; 2],
    /// Speed of the fingertips (m/s).
    speed: f64,
    /// Grasp force at which the squeeze ends (N).
    force: f64,
    phase: Phase,
    /// Distance between the domes' centres at first contact (m).
    gap: Option<f64>,
    findings: [Finding; 1],
}

impl Task for Squeeze {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let (Some(one), Some(other)) = (hand.finger(0), hand.finger(1)) else {
            return Ok(());
        };
        let gap = one.pose.position.distance(other.pose.position);
        let force = 0.5 * (one.flags().grasp_force + other.flags().grasp_force);
        match self.phase {
            Phase::Search if one.flags().touch && other.flags().touch => {
                self.gap = Some(gap);
                self.phase = Phase::Move;
            }
            Phase::Move if force >= self.force => {
                let yielded = self.gap.unwrap_or(gap) - gap;
                self.findings[0].value = force / yielded;
                self.phase = Phase::Release;
            }
            Phase::Release if !one.flags().touch && !other.flags().touch => {
                self.phase = Phase::Done;
            }
            _ => {}
        }
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let approach = self.approach[finger];
        let touches = hand.finger(finger).is_some_and(|f| f.flags().touch);
        let velocity = match self.phase {
            // The first finger to touch waits for the other.
            Phase::Search if touches => DVec3::ZERO,
            Phase::Search | Phase::Move => self.speed * approach,
            Phase::Release => -self.speed * approach,
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: approach,
            reflex: false,
            keep_grasp: false,
        }
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn findings(&self) -> &[Finding] {
        &self.findings
    }
}

pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let experiment = Experiment::load("cap-closing", &["sensing=direct".into()])?;
    let task = Box::new(Squeeze {
        approach: [DVec3::X, DVec3::NEG_X],
        speed: 0.004,
        force: 2.0,
        phase: Phase::Search,
        gap: None,
        findings: [Finding {
            name: "stiffness_n_per_m",
            value: f64::NAN,
        }],
    });
    let homes = [[-0.038, 0.0, 0.1], [0.038, 0.0, 0.1]]; // m, in W
    let mut session = Session::with_task(&experiment, task, &homes)?;
    while !session.finished() {
        session.step()?;
    }
    let controller = session.control_loop().controller();
    if let Some(reason) = controller.stop_reason() {
        return Err(reason.to_string().into());
    }
    let found = controller.task().findings()[0];
    println!("{} = {:.0}", found.name, found.value);
    Ok(())
}
