//! A recording as time-aligned columns with one row per control step, split into strokes.

use super::finger_columns::{FingerColumns, FingerNewest, fingers, keep};
use super::stroke::{Stroke, split_strokes};
use super::thinned::DecimatedRun;
use crate::measures::contact::Contact;
use feeler_record::{
    Cap, FindingName, LatestAt, ObjectPose, Phase, Recording, RunFacts, TorqueSensor, TrueSlip,
};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;

/// Motion of the cap. Each column has as many rows as [`RunData::time`]; rows before the first measurement are NaN.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CapColumns {
    /// Rotation of the cap since the start of the run (rad), positive = closing.
    pub angle: Vec<f64>,
    /// Centre of the cap in `W` (m).
    pub centre: Vec<DVec3>,
}

/// A run as columns, with one row per control step at which all fingers have readings. Columns of missing instruments
/// are `None`.
#[derive(Debug, Clone, PartialEq)]
pub struct RunData {
    /// Constants of the run.
    pub facts: RunFacts,
    /// Time of each row (s).
    pub time: Vec<f64>,
    /// Phase of the task at each row.
    pub phase: Vec<Phase>,
    /// Measured torque (N·m), positive when the cap is turned in the closing direction; NaN before the first sample.
    pub torque: Option<Vec<f64>>,
    /// Motion of the cap.
    pub cap: Option<CapColumns>,
    /// Columns of each finger.
    pub fingers: Vec<FingerColumns>,
    /// Strokes in chronological order.
    pub strokes: Vec<Stroke>,
    /// Final findings of the task, by name.
    pub findings: BTreeMap<FindingName, f64>,
    /// Pose of the carried object in `W`: x, y, z (m) and quaternion x, y, z, w; NaN before the first measurement.
    /// `None` if there is no free object.
    pub object: Option<Vec<[f64; 7]>>,
    /// Longest stretch without touch in the tactile frames of the first finger within MOVE, in frames; `None` if there
    /// are no such frames.
    pub longest_loss: Option<usize>,
    /// Measures of all rows, if only some rows were kept (`super::long_run`).
    pub thinned: Option<Box<DecimatedRun>>,
}

impl RunData {
    /// Aligns a recording: each control step gets the latest message of every channel up to its time.
    pub fn new(recording: &Recording) -> Self {
        let mut data = Self::empty(recording);
        let mut numbers = Vec::new();
        data.append(recording, 0..recording.task.len(), &mut numbers);
        data.strokes = split_strokes(&numbers, &data.phase);
        data.findings = findings(recording);
        let mut contact = Contact::default();
        contact.take(recording, f64::INFINITY);
        data.longest_loss = contact.longest_loss();
        data
    }

    /// Columns of a recording, without rows.
    pub(crate) fn empty(recording: &Recording) -> Self {
        Self {
            facts: recording.facts.clone(),
            time: Vec::new(),
            phase: Vec::new(),
            torque: None,
            cap: None,
            fingers: fingers(recording),
            strokes: Vec::new(),
            findings: BTreeMap::new(),
            object: None,
            longest_loss: None,
            thinned: None,
        }
    }

    /// Appends a row for each of these control steps and the number of its stroke to `numbers`. Steps without readings
    /// of all fingers are skipped.
    pub(crate) fn append(
        &mut self,
        recording: &Recording,
        steps: Range<usize>,
        numbers: &mut Vec<u32>,
    ) {
        self.begin_columns(recording);
        if self.time.is_empty() {
            self.fingers.iter_mut().for_each(FingerColumns::reserve);
        }
        let mut torque = LatestAt::new(&recording.torque_sensor);
        let mut cap = LatestAt::new(&recording.cap);
        let mut slip = LatestAt::new(&recording.true_slip);
        let mut object = LatestAt::new(&recording.object);
        let mut fingers: Vec<_> = recording.fingers.iter().map(FingerNewest::new).collect();
        for task in recording.task.get(steps).into_iter().flatten() {
            let at = task.stamp;
            if !fingers.iter_mut().all(|finger| finger.at(at).is_some()) {
                continue;
            }
            self.time.push(at);
            self.phase.push(task.phase);
            for (columns, newest) in self.fingers.iter_mut().zip(&mut fingers) {
                if let Some(newest) = newest.at(at) {
                    columns.push(&newest);
                }
            }
            self.push_instruments(torque.at(at), cap.at(at));
            self.push_slip(slip.at(at));
            self.push_object(object.at(at));
            numbers.push(task.stroke);
        }
    }

    /// Creates columns for data that has first appeared in `recording`, with NaN in earlier rows.
    fn begin_columns(&mut self, recording: &Recording) {
        let rows = self.time.len();
        if !recording.torque_sensor.is_empty() {
            self.torque.get_or_insert_with(|| vec![f64::NAN; rows]);
        }
        if !recording.cap.is_empty() {
            self.cap.get_or_insert_with(|| CapColumns {
                angle: vec![f64::NAN; rows],
                centre: vec![DVec3::NAN; rows],
            });
        }
        if !recording.object.is_empty() {
            (self.object).get_or_insert_with(|| vec![[f64::NAN; 7]; rows]);
        }
    }

    /// Retains only the rows with these ascending indices. Does not update the strokes.
    pub(crate) fn keep(&mut self, rows: &[usize]) {
        keep(&mut self.time, rows);
        keep(&mut self.phase, rows);
        if let Some(torque) = &mut self.torque {
            keep(torque, rows);
        }
        if let Some(cap) = &mut self.cap {
            keep(&mut cap.angle, rows);
            keep(&mut cap.centre, rows);
        }
        if let Some(object) = &mut self.object {
            keep(object, rows);
        }
        for finger in &mut self.fingers {
            finger.keep(rows);
        }
    }

    /// Stroke with this number, if it was made and its MOVE is complete.
    pub fn whole_stroke(&self, index: u32) -> Option<&Stroke> {
        let mut strokes = self.strokes.iter();
        strokes.find(|s| s.index == index && s.whole && !s.moving.is_empty())
    }

    /// Direction of a finger's planned strokes.
    pub(crate) fn direction(&self, finger: usize) -> Option<DVec3> {
        let direction = self.facts.stroke_direction.get(finger)?;
        Some(DVec3::from(*direction))
    }

    /// Direction from which a finger approaches the object.
    pub(crate) fn approach(&self, finger: usize) -> Option<DVec3> {
        let approach = self.facts.approach.get(finger)?;
        Some(DVec3::from(*approach))
    }

    /// Path of a dome's centre over the MOVE of `stroke` (m).
    pub(crate) fn path(&self, stroke: &Stroke, finger: usize) -> Option<&[DVec3]> {
        let finger = self.fingers.get(finger)?;
        finger.position.get(stroke.moving.clone())
    }

    /// Grasp force at a row, averaged over fingers (N).
    pub fn grasp_force(&self, row: usize) -> f64 {
        self.mean_over_fingers(|finger| finger.grasp_force[row])
    }

    /// Shear rate of the element with the largest F_z at a row, averaged over fingers (N/s).
    pub fn shear_rate(&self, row: usize) -> f64 {
        self.mean_over_fingers(|finger| finger.shear_rate[row])
    }

    /// Mean of a quantity over fingers.
    pub fn mean_over_fingers(&self, quantity: impl Fn(&FingerColumns) -> f64) -> f64 {
        self.fingers.iter().map(quantity).sum::<f64>() / self.fingers.len().max(1) as f64
    }

    /// Known torque values over these rows (N·m).
    pub fn known_torque(&self, rows: Range<usize>) -> impl Iterator<Item = f64> + '_ {
        let torque = self.torque.as_ref().and_then(|torque| torque.get(rows));
        let torque = torque.into_iter().flatten().copied();
        torque.filter(|torque| torque.is_finite())
    }

    /// `true` if torque is known at each of these rows.
    pub fn has_torque(&self, rows: Range<usize>) -> bool {
        self.torque.is_some() && self.known_torque(rows.clone()).count() == rows.len()
    }

    fn push_instruments(&mut self, torque: Option<&TorqueSensor>, cap: Option<&Cap>) {
        if let Some(column) = &mut self.torque {
            column.push(torque.map_or(f64::NAN, |sample| sample.torque));
        }
        if let Some(columns) = &mut self.cap {
            columns.angle.push(cap.map_or(f64::NAN, |cap| cap.angle));
            let centre = cap.map_or(DVec3::NAN, |cap| cap.centre.into());
            columns.centre.push(centre);
        }
    }

    fn push_slip(&mut self, slip: Option<&TrueSlip>) {
        for (finger, columns) in self.fingers.iter_mut().enumerate() {
            let distance = slip.and_then(|slip| slip.distance.get(finger).copied());
            columns.slipped.push(distance);
        }
    }

    fn push_object(&mut self, pose: Option<&ObjectPose>) {
        let Some(column) = &mut self.object else {
            return;
        };
        column.push(pose.map_or([f64::NAN; 7], |pose| {
            let turned = DQuat::from(pose.orientation).to_array();
            let DVec3 { x, y, z } = pose.position.into();
            [x, y, z, turned[0], turned[1], turned[2], turned[3]]
        }));
    }
}

/// Final findings of the task with known values.
pub(crate) fn findings(recording: &Recording) -> BTreeMap<FindingName, f64> {
    let last = recording.findings.last().into_iter();
    last.flat_map(|found| {
        found
            .names
            .iter()
            .cloned()
            .zip(found.values.iter().copied())
    })
    .filter(|(_, value)| value.is_finite())
    .collect()
}
