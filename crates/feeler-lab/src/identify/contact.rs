//! Contacts of single elements: displacement of the tip relative to the first contact.

use super::trace::{FingerTrace, Row};
use feeler::control::task::probe::Step;
use glam::{DMat3, DVec3};

/// Half width of the window for the rate of the displacement, in control steps.
const RATE_ROWS: usize = 2;

/// One sample of a touching element.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Step of the probing routine.
    pub step: Step,
    /// Displacement of the undeformed tip since the first contact, in the element's frame (m).
    pub moved: DVec3,
    /// Rate of the displacement (m/s).
    pub rate: DVec3,
    /// Force on the element in its frame (N); see [`TactileFrame`](feeler::sensor::forces::TactileFrame).
    pub force: DVec3,
}

/// Samples of one element at one place while it sticks, until the end of [`Step::Ease`].
#[derive(Debug, Clone)]
pub struct Contact {
    /// Samples in chronological order.
    pub samples: Vec<Sample>,
}

/// Returns `true` if elements stick to the object during `step`.
fn sticks(step: Step) -> bool {
    matches!(
        step,
        Step::Press | Step::Release | Step::PressFast | Step::Shear | Step::ShearBack | Step::Ease
    )
}

/// Finds all contacts of a finger in which an element was pressed with at least `force` (N). Each contact contains the
/// samples above a third of that force. `tip_radius` (m) accounts for the rolling of the tip as the fingertip turns.
pub fn contacts(trace: &FingerTrace, force: f64, tip_radius: f64) -> Vec<Contact> {
    let mut contacts = Vec::new();
    let places = trace.rows.iter().map(|row| row.place).max().unwrap_or(0);
    for place in 0..=places {
        let in_place = |row: &Row| row.place == place && sticks(row.step);
        let Some(first) = trace.rows.iter().position(in_place) else {
            continue;
        };
        let last = trace.rows.iter().rposition(in_place).unwrap_or(first);
        for element in 0..trace.layout.elements.len() {
            let samples = samples(trace, (first, last), element, force / 3.0, tip_radius);
            if samples.iter().any(|sample| sample.force.z >= force) {
                contacts.push(Contact { samples });
            }
        }
    }
    contacts
}

fn samples(
    trace: &FingerTrace,
    (first, last): (usize, usize),
    element: usize,
    least: f64,
    tip_radius: f64,
) -> Vec<Sample> {
    let rows = &trace.rows;
    let touches = |row: &Row| row.forces[element].z >= least;
    let Some(from) = (first..=last).find(|&index| touches(&rows[index])) else {
        return Vec::new();
    };
    let reference = &rows[from];
    let displacement = |row: &Row| {
        let moved = row.tip(&trace.layout, element) - reference.tip(&trace.layout, element);
        let turn = rotation_vector(row.pose.rotation * reference.pose.rotation.transpose());
        // The object's outward normal is approximately opposite to the approach.
        let rolled = tip_radius * turn.cross(-trace.approach);
        let frame = row.pose.rotation * trace.layout.elements[element].rotation;
        frame.transpose() * (moved - rolled)
    };
    let touching = (from..=last).filter(|&index| touches(&rows[index]));
    touching
        .map(|index| {
            let before = &rows[index.saturating_sub(RATE_ROWS)];
            let after = &rows[(index + RATE_ROWS).min(rows.len() - 1)];
            let time = (after.time - before.time).max(f64::MIN_POSITIVE);
            Sample {
                step: rows[index].step,
                moved: displacement(&rows[index]),
                rate: (displacement(after) - displacement(before)) / time,
                force: rows[index].forces[element],
            }
        })
        .collect()
}

/// Rotation vector of a small rotation (rad).
fn rotation_vector(rotation: DMat3) -> DVec3 {
    let (x, y, z) = (rotation.x_axis, rotation.y_axis, rotation.z_axis);
    0.5 * DVec3::new(y.z - z.y, z.x - x.z, x.y - y.x)
}
