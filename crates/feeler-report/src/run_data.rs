//! A recording as time-aligned columns: one row per control step, split into strokes.

use super::contact::Contact;
use super::rows::Rows;
use super::series::maximum;
use super::strokes::StrokeMeasures;
use super::thinned::Thinned;
use feeler::sensor::layout::SensingElement;
use feeler_record::{
    Cap, FindingName, FingerRecord, Fingertip, Flags, Joints, NO_ELEMENT, Newest, ObjectPose,
    Phase, Recording, RunFacts, Tactile, TorqueSensor, TrueSlip,
};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;

/// Rows that there is room for at first, so that a run of ordinary length (20 s at 100 Hz) does not copy them as it grows.
const ROWS: usize = 2048;

/// One finger's columns; all have as many rows as [`RunData::time`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FingerColumns {
    /// Sum of the positive F_z, N.
    pub grasp_force: Vec<f64>,
    /// TOUCH.
    pub touch: Vec<bool>,
    /// SLIP.
    pub slip: Vec<bool>,
    /// OVER.
    pub over: Vec<bool>,
    /// Longest way that the anchor of one of its feelers slid since the row before, m, where a simulated world told.
    pub slipped: Vec<Option<f64>>,
    /// The touching element of largest F_z.
    pub largest_element: Vec<Option<usize>>,
    /// Shear rate of that element, N/s; 0 when none touches.
    pub shear_rate: Vec<f64>,
    /// Force on every element in its frame, N; z is compression.
    pub forces: Rows<DVec3>,
    /// The largest F_z of them, N; not a number where one of them is none, and -∞ where there are no elements.
    pub largest_force: Vec<f64>,
    /// Centre of the dome, m in `W`.
    pub position: Vec<DVec3>,
    /// From the fingertip frame `T` to `W`.
    pub rotation: Vec<DQuat>,
    /// Joint angles, rad; not numbers before they were first read.
    pub joints: Vec<[f64; 3]>,
    /// Undeformed tip of every element's feeler, m in `T`.
    pub tips: Vec<DVec3>,
}

impl FingerColumns {
    /// Path over MOVE of the undeformed tip of the element that leads the stroke, m in `W`: the
    /// touching element of largest F_z when MOVE begins.
    pub fn leading_path(&self, stroke: &Stroke) -> Option<Vec<DVec3>> {
        let moving = stroke.moving.clone();
        let leading = moving.clone().find_map(|row| self.largest_element[row])?;
        moving.map(|row| self.tip(row, leading)).collect()
    }

    /// Undeformed tip of the feeler of `element` at a row, m in `W`.
    pub fn tip(&self, row: usize, element: usize) -> Option<DVec3> {
        let (centre, rotation) = (self.position.get(row)?, self.rotation.get(row)?);
        Some(*centre + *rotation * *self.tips.get(element)?)
    }

    /// Force on the feeler of `element` by what it touches at a row, N, in `W`.
    pub fn force_in_world(&self, row: usize, element: usize) -> Option<DVec3> {
        let force = self.forces.get(row)?.get(element)?;
        let outward = self.tips.get(element)?.normalize_or_zero();
        let force = SensingElement::facing(outward).force_on_fingertip(*force);
        Some(*self.rotation.get(row)? * force)
    }

    /// Makes room for the first rows.
    fn reserve(&mut self) {
        self.grasp_force.reserve(ROWS);
        self.touch.reserve(ROWS);
        self.slip.reserve(ROWS);
        self.over.reserve(ROWS);
        self.slipped.reserve(ROWS);
        self.largest_element.reserve(ROWS);
        self.shear_rate.reserve(ROWS);
        self.forces.reserve(ROWS, ROWS * self.tips.len());
        self.largest_force.reserve(ROWS);
        self.position.reserve(ROWS);
        self.rotation.reserve(ROWS);
        self.joints.reserve(ROWS);
    }

    fn push(&mut self, newest: &FingerRow<'_>) {
        let FingerRow {
            tactile,
            flags,
            fingertip,
            joints,
        } = newest;
        let largest = (flags.largest_element != NO_ELEMENT)
            .then_some(flags.largest_element as usize)
            .filter(|&element| element < flags.shear_rate.len());
        self.grasp_force.push(flags.grasp_force);
        self.touch.push(flags.touch);
        self.slip.push(flags.slip);
        self.over.push(flags.over);
        self.largest_element.push(largest);
        let shear_rate = largest.map_or(0.0, |element| flags.shear_rate[element]);
        self.shear_rate.push(shear_rate);
        self.forces
            .push(tactile.forces.iter().map(|&force| force.into()));
        let largest = match tactile.forces.as_slice() {
            [] => f64::NEG_INFINITY,
            forces => maximum(forces.iter().map(|force| force.z)).unwrap_or(f64::NAN),
        };
        self.largest_force.push(largest);
        self.position.push(fingertip.position.into());
        self.rotation.push(fingertip.orientation.into());
        let angles = joints.map_or([f64::NAN; 3], |joints| joints.position);
        self.joints.push(angles);
    }

    /// Keeps these rows only, which are in their order.
    fn keep(&mut self, rows: &[usize]) {
        keep(&mut self.grasp_force, rows);
        keep(&mut self.touch, rows);
        keep(&mut self.slip, rows);
        keep(&mut self.over, rows);
        keep(&mut self.slipped, rows);
        keep(&mut self.largest_element, rows);
        keep(&mut self.shear_rate, rows);
        self.forces.keep(rows);
        keep(&mut self.largest_force, rows);
        keep(&mut self.position, rows);
        keep(&mut self.rotation, rows);
        keep(&mut self.joints, rows);
    }
}

/// Keeps the entries of these rows, which are in their order.
pub(crate) fn keep<T>(column: &mut Vec<T>, rows: &[usize]) {
    for (place, &row) in rows.iter().enumerate() {
        column.swap(place, row);
    }
    column.truncate(rows.len());
}

/// What is known of the cap; both have as many rows as [`RunData::time`], and are not numbers before the cap was first
/// seen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CapColumns {
    /// Angle the cap has turned since the run's start, rad, positive = closing.
    pub angle: Vec<f64>,
    /// The cap's centre, m in `W`.
    pub centre: Vec<DVec3>,
}

/// One touch-and-release stroke, as ranges of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stroke {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// All rows of the stroke.
    pub rows: Range<usize>,
    /// Rows of its MOVE phase; empty if it has none.
    pub moving: Range<usize>,
    /// Whether the recording goes on after MOVE, so that MOVE is known to be over; false, too, where not all rows of a stroke
    /// that claims are about could be kept.
    pub whole: bool,
}

/// A run as columns, one row per control step at which every finger had been felt. A rig need not have instruments: what
/// it has none for is none.
#[derive(Debug, Clone, PartialEq)]
pub struct RunData {
    /// The run's constants.
    pub facts: RunFacts,
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// Phase of the task.
    pub phase: Vec<Phase>,
    /// Measured torque, N·m, positive when the cap is turned in the closing direction; not a number before the torque
    /// sensor's first sample.
    pub torque: Option<Vec<f64>>,
    /// How the cap stands.
    pub cap: Option<CapColumns>,
    /// One entry per finger.
    pub fingers: Vec<FingerColumns>,
    /// The strokes, in the order of time.
    pub strokes: Vec<Stroke>,
    /// What the task found out in the end, by name.
    pub findings: BTreeMap<FindingName, f64>,
    /// Where the carried object is: x, y and z, m in `W`, and its rotation as a quaternion x, y, z, w; not numbers before
    /// that was known. None where no object is free.
    pub object: Option<Vec<[f64; 7]>>,
    /// Longest stretch of tactile frames of the first finger without touch within MOVE, in frames; none if there are no
    /// such frames.
    pub longest_loss: Option<usize>,
    /// What was measured of all rows, where those here are only some of them ([`super::long_run`]).
    pub thinned: Option<Box<Thinned>>,
}

impl RunData {
    /// Aligns a recording: each control step takes the newest message of every channel that is
    /// not younger than the step.
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

    /// The columns of a recording, still without rows.
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

    /// Appends a row for each of these control steps, and the number of its stroke to `numbers`.
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
        let mut torque = Newest::new(&recording.torque_sensor);
        let mut cap = Newest::new(&recording.cap);
        let mut slip = Newest::new(&recording.true_slip);
        let mut object = Newest::new(&recording.object);
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

    /// Makes the columns of what `recording` turns out to know; not numbers in the rows before.
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

    /// Keeps these rows only, which are in their order. The strokes' rows are not mended.
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

    /// What each of the strokes measures.
    pub fn stroke_measures(&self) -> Vec<StrokeMeasures> {
        match &self.thinned {
            Some(thinned) => thinned.strokes.clone(),
            None => {
                let strokes = self.strokes.iter();
                strokes.map(|s| StrokeMeasures::new(self, s)).collect()
            }
        }
    }

    /// The stroke of this number, if it was made and its MOVE is over.
    pub fn whole_stroke(&self, index: u32) -> Option<&Stroke> {
        let mut strokes = self.strokes.iter();
        strokes.find(|s| s.index == index && s.whole && !s.moving.is_empty())
    }

    /// Grasp force at a row, mean over fingers, N.
    pub fn grasp_force(&self, row: usize) -> f64 {
        self.mean_over_fingers(|finger| finger.grasp_force[row])
    }

    /// Shear rate of the element of largest F_z at a row, mean over fingers, N/s.
    pub fn shear_rate(&self, row: usize) -> f64 {
        self.mean_over_fingers(|finger| finger.shear_rate[row])
    }

    /// Mean of a quantity over fingers.
    pub fn mean_over_fingers(&self, quantity: impl Fn(&FingerColumns) -> f64) -> f64 {
        self.fingers.iter().map(quantity).sum::<f64>() / self.fingers.len().max(1) as f64
    }

    /// Torque over these rows, N·m, as far as it is known.
    pub fn known_torque(&self, rows: Range<usize>) -> impl Iterator<Item = f64> + '_ {
        let torque = self.torque.as_ref().and_then(|torque| torque.get(rows));
        let torque = torque.into_iter().flatten().copied();
        torque.filter(|torque| torque.is_finite())
    }

    /// Whether torque is known at every one of these rows.
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

/// The columns of each finger, still without rows.
fn fingers(recording: &Recording) -> Vec<FingerColumns> {
    let mut fingers = vec![FingerColumns::default(); recording.fingers.len()];
    for (columns, model) in fingers.iter_mut().zip(&recording.facts.hand) {
        let tips = model.element_tips.iter();
        columns.tips = tips.map(|&tip| DVec3::from_array(tip)).collect();
    }
    fingers
}

/// What the task found out in the end, as far as it is known.
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

/// The channels of one finger that become columns.
struct FingerNewest<'a> {
    tactile: Newest<'a, Tactile>,
    flags: Newest<'a, Flags>,
    fingertip: Newest<'a, Fingertip>,
    joints: Newest<'a, Joints>,
}

/// What is newest of one finger; its joints need not be known.
struct FingerRow<'a> {
    tactile: &'a Tactile,
    flags: &'a Flags,
    fingertip: &'a Fingertip,
    joints: Option<&'a Joints>,
}

impl<'a> FingerNewest<'a> {
    fn new(finger: &'a FingerRecord) -> Self {
        Self {
            tactile: Newest::new(&finger.tactile),
            flags: Newest::new(&finger.flags),
            fingertip: Newest::new(&finger.fingertip),
            joints: Newest::new(&finger.joints),
        }
    }

    fn at(&mut self, time: f64) -> Option<FingerRow<'a>> {
        let tactile = self.tactile.at(time);
        let flags = self.flags.at(time);
        let fingertip = self.fingertip.at(time);
        let joints = self.joints.at(time);
        Some(FingerRow {
            tactile: tactile?,
            flags: flags?,
            fingertip: fingertip?,
            joints,
        })
    }
}

/// Splits rows into strokes: a stroke is a run of rows with one number above 0, without the rows
/// after the task ended; its MOVE is the longest run of MOVE rows in it.
pub(crate) fn split_strokes(numbers: &[u32], phases: &[Phase]) -> Vec<Stroke> {
    let ended = |phase| matches!(phase, Phase::Done | Phase::Stopped);
    let number = |row: usize| if ended(phases[row]) { 0 } else { numbers[row] };
    runs(numbers.len(), number)
        .filter(|(index, _)| *index > 0)
        .map(|(index, rows)| {
            let moving = runs(rows.len(), |row| phases[rows.start + row] == Phase::Move)
                .filter(|(moving, _)| *moving)
                .map(|(_, run)| rows.start + run.start..rows.start + run.end)
                .max_by_key(ExactSizeIterator::len)
                .unwrap_or(rows.start..rows.start);
            let next = phases.get(moving.end);
            let whole = next.is_some_and(|&phase| phase != Phase::Stopped);
            Stroke {
                index,
                rows,
                moving,
                whole,
            }
        })
        .collect()
}

/// The runs of equal keys in `0..length`.
fn runs<K: PartialEq + Copy>(
    length: usize,
    key: impl Fn(usize) -> K,
) -> impl Iterator<Item = (K, Range<usize>)> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let first = (start < length).then(|| key(start))?;
        let end = (start..length).find(|&i| key(i) != first).unwrap_or(length);
        let run = start..end;
        start = end;
        Some((first, run))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use Phase::{Done, Move, Release, Return, Search, Stopped};

    #[test]
    fn strokes_are_runs_of_one_number_and_end_with_the_task() {
        let numbers = [0, 1, 1, 1, 1, 1, 2, 2, 2, 2];
        let phases = [
            Search, Search, Move, Move, Release, Return, Search, Move, Return, Done,
        ];
        let strokes = split_strokes(&numbers, &phases);
        assert_eq!(strokes.len(), 2);
        assert_eq!(
            (strokes[0].rows.clone(), strokes[0].moving.clone()),
            (1..6, 2..4)
        );
        assert_eq!(
            (strokes[1].rows.clone(), strokes[1].moving.clone()),
            (6..9, 7..8)
        );
        assert!(strokes.iter().all(|s| s.whole));
    }

    #[test]
    fn a_stroke_whose_move_is_cut_off_is_not_whole() {
        assert!(!split_strokes(&[1, 1, 1], &[Search, Move, Move])[0].whole);
        assert!(!split_strokes(&[1, 1, 1], &[Search, Move, Stopped])[0].whole);
        let without_move = &split_strokes(&[1, 1], &[Search, Search])[0];
        assert!(without_move.moving.is_empty());
    }
}
