//! Rows of a live page: the numbers of one control step.

mod row;

pub use row::{FingerRow, Row};

use super::{ExperimentError, Instruments, SimulatedLoop, geometries, run_facts};
use crate::config::ExperimentConfig;
use feeler::control::{Controller, Phase};
use feeler::hand::FingerGeometry;
use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler_record::{RunFacts, SolidFrame};
use feeler_report::measures::TRUE_SLIP;
use feeler_report::pages::LiveRig;
use glam::{DQuat, DVec3};
use std::{fmt, iter};

/// Writes the phase of a hand that is not stopped as a sentence, such as "MOVE of stroke 2 of 4.". `stroke` is 0 before
/// the first stroke; `strokes` is 0 if their number is not known in advance.
///
/// # Errors
/// If writing to `text` fails.
pub fn write_phase(
    text: &mut impl fmt::Write,
    phase: Phase,
    stroke: u32,
    strokes: u32,
) -> fmt::Result {
    match (stroke, strokes) {
        (0, _) => write!(text, "{phase}."),
        (stroke, 0) => write!(text, "{phase} of stroke {stroke}."),
        (stroke, strokes) => write!(text, "{phase} of stroke {stroke} of {strokes}."),
    }
}

/// Writes the phase of `controller`'s hand, or the reason why it is stopped, as a sentence. `strokes` is the number of
/// strokes of its task (0 if not known in advance).
///
/// # Errors
/// If writing to `text` fails.
pub fn write_state(
    text: &mut impl fmt::Write,
    controller: &Controller,
    strokes: u32,
) -> fmt::Result {
    match controller.stop_reason() {
        Some(reason) => write!(text, "The hand is stopped: {reason}."),
        None => write_phase(
            text,
            controller.phase(),
            controller.task().stroke(),
            strokes,
        ),
    }
}

/// Constants of a rig that determine the rows of its live page.
pub struct LiveRows {
    facts: RunFacts,
    homes: Vec<[f64; 3]>,
    /// Geometry of each finger.
    geometries: Vec<FingerGeometry>,
    /// Estimates the contact of each fingertip.
    estimators: Vec<ContactEstimator>,
    /// `true` if rows contain the pose of a cap.
    pub cap: bool,
    /// `true` if rows contain the pose of a carried object.
    pub object: bool,
}

impl LiveRows {
    /// Reads the constants of the rig of `config`.
    ///
    /// # Errors
    /// If a fingertip is invalid.
    pub fn new(config: &ExperimentConfig) -> Result<Self, ExperimentError> {
        let facts = run_facts(config)?;
        let touch = facts.touch_force_threshold;
        let fingers = facts.hand.iter();
        let estimators = fingers.map(|model| ContactEstimator::new(model.elements(), touch));
        let mut solids = facts.solids.iter();
        Ok(Self {
            homes: config.task.homes(),
            geometries: geometries(config)?,
            estimators: estimators.collect(),
            cap: config.cap().is_some(),
            object: solids.any(|solid| solid.frame == SolidFrame::Object),
            facts,
        })
    }

    /// Returns the description of the rig for a live page.
    pub fn rig(&self) -> LiveRig<'_> {
        LiveRig {
            facts: &self.facts,
            homes: &self.homes,
            cap: self.cap,
            object: self.object,
        }
    }

    /// Number of values in a row, without the time.
    pub fn width(&self) -> usize {
        let columns = self.rig().columns();
        columns.iter().map(|(_, width)| width).sum::<usize>() - 1
    }

    /// Estimates the contact in the next frame of `finger` from the forces on its elements (N, in their frames), or
    /// returns `None` if no element touches. Updates the friction estimate. Does not allocate.
    pub fn contact(&mut self, finger: usize, forces: &[DVec3]) -> Option<Contact> {
        self.estimators.get_mut(finger)?.estimate(forces)
    }

    /// Geometry of `finger`.
    pub fn geometry(&self, finger: usize) -> &FingerGeometry {
        &self.geometries[finger]
    }

    /// Writes the row of the latest step of `control_loop`, with the instrument readings `at` its beginning, to
    /// `numbers`. Numbers beyond the capacity of `numbers` are omitted.
    pub fn write(
        &mut self,
        numbers: &mut Vec<f32>,
        control_loop: &SimulatedLoop,
        at: &Instruments,
    ) {
        let state = control_loop.state();
        let mut row = Row::begin(numbers);
        row.push(f64::from(u8::from(control_loop.controller().phase())));
        let fingers = control_loop.touches().iter().zip(&state.joints);
        let slipped = at.slipped.iter().chain(iter::repeat(&0.0));
        for (finger, ((touch, joints), slipped)) in fingers.zip(slipped).enumerate() {
            let contact = self.contact(finger, &touch.frame.forces);
            row.finger(FingerRow {
                geometry: &self.geometries[finger],
                joints: joints.position,
                elements: self.estimators[finger].element_count(),
                forces: touch.frame.forces.iter().copied(),
                flags: &touch.flags,
                slips: *slipped > TRUE_SLIP,
                shear_rates: &touch.shear_rate,
                contact,
            });
        }
        row.push(at.torque.torque);
        if self.cap {
            row.cap(at.cap_centre, at.cap.angle);
        }
        if self.object
            && let Some(pose) = at.object
        {
            row.pose(pose.position, DQuat::from_mat3(&pose.rotation));
        }
    }
}
