//! Columns of one finger.

use super::rows::Rows;
use super::stroke::Stroke;
use crate::measures::series::maximum;
use feeler::hand::{FingerGeometry, JointVector};
use feeler::sensor::fingertip::SensingElement;
use feeler_record::{
    FingerRecord, Fingertip, Flags, Joints, LatestAt, NO_ELEMENT, Recording, Tactile,
};
use glam::{DQuat, DVec3};

/// Initial capacity in rows, so that a run of ordinary length (20 s at 100 Hz) does not reallocate.
const ROWS: usize = 2048;

/// Columns of one finger, with as many rows as [`RunData::time`](crate::RunData::time).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FingerColumns {
    /// Sum of the positive F_z (N).
    pub grasp_force: Vec<f64>,
    /// TOUCH flag.
    pub touch: Vec<bool>,
    /// SLIP flag.
    pub slip: Vec<bool>,
    /// OVER flag.
    pub over: Vec<bool>,
    /// Longest distance that the anchor of a feeler slid since the previous row (m); ground truth.
    pub slipped: Vec<Option<f64>>,
    /// Touching element with the largest F_z, if any.
    pub largest_element: Vec<Option<usize>>,
    /// Shear rate of that element (N/s); 0 if no element touches.
    pub shear_rate: Vec<f64>,
    /// Force on each element in its frame (N); z is compression.
    pub forces: Rows<DVec3>,
    /// Largest F_z (N); NaN if any is not finite, -∞ if there are no elements.
    pub largest_force: Vec<f64>,
    /// Centre of the dome in `W` (m).
    pub position: Vec<DVec3>,
    /// Rotation from the fingertip frame `T` to `W`.
    pub rotation: Vec<DQuat>,
    /// Positions of the moving frames (rad or m); NaN before the first measurement.
    pub frames: Rows<f64>,
    /// Geometry, if known.
    pub geometry: Option<FingerGeometry>,
    /// Undeformed tip of each element's feeler in `T` (m).
    pub tips: Vec<DVec3>,
}

impl FingerColumns {
    /// Path of the leading element's undeformed tip over MOVE, in `W` (m). The leading element is the touching element
    /// with the largest F_z when MOVE starts.
    pub fn leading_path(&self, stroke: &Stroke) -> Option<Vec<DVec3>> {
        let moving = stroke.moving.clone();
        let leading = moving.clone().find_map(|row| self.largest_element[row])?;
        moving.map(|row| self.tip(row, leading)).collect()
    }

    /// Undeformed tip of the feeler of `element` at a row, in `W` (m).
    pub fn tip(&self, row: usize, element: usize) -> Option<DVec3> {
        let (centre, rotation) = (self.position.get(row)?, self.rotation.get(row)?);
        Some(*centre + *rotation * *self.tips.get(element)?)
    }

    /// Force on the feeler of `element` by the touched object at a row, in `W` (N).
    pub fn force_in_world(&self, row: usize, element: usize) -> Option<DVec3> {
        let force = self.forces.get(row)?.get(element)?;
        let outward = self.tips.get(element)?.normalize_or_zero();
        let force = SensingElement::facing(outward).force_on_fingertip(*force);
        Some(*self.rotation.get(row)? * force)
    }

    /// Number of moving frames; three if the geometry is unknown.
    pub fn frame_count(&self) -> usize {
        self.geometry
            .as_ref()
            .map_or(3, FingerGeometry::frame_count)
    }

    /// Reserves capacity for the first rows.
    pub(super) fn reserve(&mut self) {
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
        self.frames.reserve(ROWS, ROWS * self.frame_count());
    }

    pub(super) fn push(&mut self, newest: &FingerRow<'_>) {
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
        let count = self
            .geometry
            .as_ref()
            .map_or(3, FingerGeometry::joint_count);
        let unknown = JointVector::splat(count, f64::NAN);
        let joints = joints.map_or(unknown, |joints| joints.position);
        match &self.geometry {
            Some(geometry) => self.frames.push(geometry.frame_positions(joints)),
            None => self.frames.push(joints.padded(3).iter()),
        }
    }

    /// Retains only the rows with these ascending indices.
    pub(super) fn keep(&mut self, rows: &[usize]) {
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
        self.frames.keep(rows);
    }
}

/// Retains only the entries with these ascending indices.
pub(crate) fn keep<T>(column: &mut Vec<T>, rows: &[usize]) {
    for (place, &row) in rows.iter().enumerate() {
        column.swap(place, row);
    }
    column.truncate(rows.len());
}

/// Columns of each finger, without rows.
pub(super) fn fingers(recording: &Recording) -> Vec<FingerColumns> {
    let mut fingers = vec![FingerColumns::default(); recording.fingers.len()];
    for (columns, model) in fingers.iter_mut().zip(&recording.facts.hand) {
        let tips = model.element_tips.iter();
        columns.tips = tips.map(|&tip| DVec3::from_array(tip)).collect();
        columns.geometry = model.geometry().ok();
    }
    fingers
}

/// Channels of one finger that become columns.
pub(super) struct FingerNewest<'a> {
    tactile: LatestAt<'a, Tactile>,
    flags: LatestAt<'a, Flags>,
    fingertip: LatestAt<'a, Fingertip>,
    joints: LatestAt<'a, Joints>,
}

/// Latest messages of one finger; joint angles are optional.
pub(super) struct FingerRow<'a> {
    tactile: &'a Tactile,
    flags: &'a Flags,
    fingertip: &'a Fingertip,
    joints: Option<&'a Joints>,
}

impl<'a> FingerNewest<'a> {
    pub fn new(finger: &'a FingerRecord) -> Self {
        Self {
            tactile: LatestAt::new(&finger.tactile),
            flags: LatestAt::new(&finger.flags),
            fingertip: LatestAt::new(&finger.fingertip),
            joints: LatestAt::new(&finger.joints),
        }
    }

    pub fn at(&mut self, time: f64) -> Option<FingerRow<'a>> {
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
