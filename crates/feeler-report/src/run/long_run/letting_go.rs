//! Decimation of long runs.

use crate::run::data::RunData;
use crate::run::finger_columns::keep;
use crate::run::stroke::Stroke;
use crate::run::thinned::{Quantity, rows_that_stay};
use crate::tasks::carry::tip;
use feeler_record::{FindingName, Phase, Recording, Stamped};
use glam::DVec3;
use std::ops::Range;

/// Maximum number of findings and object poses kept before decimation.
const MESSAGES: usize = 20_000;
/// Maximum number of rows that a cell keeps, for two fingers.
const OF_CELL: usize = 10;

/// Approximate memory size of the latest row (bytes).
pub fn row_size(data: &RunData) -> usize {
    /// Size of the values other than forces, per finger and for the rig.
    const OTHERS: usize = 25 * size_of::<f64>();
    let fingers = data.fingers.iter().map(|finger| {
        let elements = finger.forces.last().map_or(0, <[_]>::len);
        elements * size_of::<DVec3>() + size_of::<usize>() + OTHERS
    });
    fingers.sum::<usize>() + OTHERS
}

/// Indices of the rows of `data` to keep, and the cell length (s). Keeps all `pinned` rows and at most `most` others.
/// Cells are at least `cell` long. MOVE and other phases have separate cells if `most` is large enough for this number
/// of `strokes`.
pub fn rows_of_cells(
    data: &RunData,
    pinned: &[Range<usize>],
    strokes: usize,
    most: usize,
    cell: Option<f64>,
) -> (Vec<usize>, f64) {
    let quantities = quantities(data);
    let pinned_rows = pinned.iter().map(ExactSizeIterator::len).sum::<usize>();
    let span = data.time.last().zip(data.time.first());
    let span = span.map_or(0.0, |(last, first)| last - first);
    let shortest = cell.unwrap_or(4.0 * data.facts.control_period);
    let mut by_phase = strokes * 2 * OF_CELL <= most;
    let mut cell = shortest;
    loop {
        let of_row = |row: usize| {
            let free = !pinned.iter().any(|rows| rows.contains(&row));
            free.then(|| {
                let moving = by_phase && data.phase[row] == Phase::Move;
                ((data.time[row] / cell) as i64, moving)
            })
        };
        let stay = rows_that_stay(data.time.len(), of_row, &quantities);
        if stay.len() <= most + pinned_rows || (cell > span && !by_phase) {
            return (stay, cell);
        }
        (cell, by_phase) = match cell > span {
            true => (shortest, false),
            false => (2.0 * cell, by_phase),
        };
    }
}

/// Quantities whose peaks are shown in figures or measured.
fn quantities(data: &RunData) -> Vec<Box<Quantity<'_>>> {
    let peak_force = |row: usize| {
        let fingers = data.fingers.iter();
        let forces = fingers.flat_map(|finger| finger.forces[row].iter());
        forces.map(|force| force.z).fold(f64::MIN, f64::max)
    };
    let peak_forces: Vec<f64> = (0..data.time.len()).map(peak_force).collect();
    let mut quantities: Vec<Box<Quantity<'_>>> = vec![
        Box::new(move |row| peak_forces[row]),
        Box::new(|row| data.grasp_force(row)),
    ];
    for finger in &data.fingers {
        quantities.push(Box::new(|row| finger.grasp_force[row]));
        quantities.push(Box::new(|row| finger.shear_rate[row]));
    }
    if let Some(torque) = &data.torque {
        // Rows without a torque must not count as maximum.
        let known = |torque: f64| if torque.is_nan() { f64::MIN } else { torque };
        quantities.push(Box::new(move |row| known(torque[row])));
        quantities.push(Box::new(move |row| known(-torque[row])));
    }
    quantities
}

/// The stroke with its row ranges mapped by `rows`.
pub fn moved(stroke: &Stroke, rows: impl Fn(&Range<usize>) -> Range<usize>) -> Stroke {
    Stroke {
        rows: rows(&stroke.rows),
        moving: rows(&stroke.moving),
        ..*stroke
    }
}

/// The range shifted by `by` rows.
pub fn shifted(rows: &Range<usize>, by: usize) -> Range<usize> {
    rows.start + by..rows.end + by
}

/// Converts a range of all rows to the range of the retained rows among them. `places` contains the index of each
/// retained row among all rows.
pub fn kept_rows(places: &[usize], rows: &Range<usize>) -> Range<usize> {
    let first_from = |row: usize| places.partition_point(|&place| place < row);
    first_from(rows.start)..first_from(rows.end)
}

/// `true` if there are too many findings or object poses.
pub fn has_many_messages(recording: &Recording) -> bool {
    recording.findings.len().max(recording.object.len()) > MESSAGES
}

/// Decimates findings and object poses if there are too many. Keeps all messages from `open` (s) on, unless these alone
/// are too many.
pub fn thin_messages(recording: &mut Recording, open: f64) {
    let findings = &recording.findings;
    if findings.len() > MESSAGES {
        let torque = |row: usize| {
            let torque = findings[row].value(&FindingName::Torque);
            torque.unwrap_or(f64::MIN)
        };
        let stay = messages_that_stay(findings, open, &[Box::new(torque)]);
        keep(&mut recording.findings, &stay);
    }
    let object = &recording.object;
    if object.len() > MESSAGES {
        let first = object[0].clone();
        let height = |row: usize| object[row].position.z;
        let tip = |row: usize| tip(&first, &object[row]);
        let stay = messages_that_stay(object, open, &[Box::new(height), Box::new(tip)]);
        keep(&mut recording.object, &stay);
    }
}

fn messages_that_stay<M: Stamped>(
    messages: &[M],
    open: f64,
    quantities: &[Box<Quantity<'_>>],
) -> Vec<usize> {
    let since = messages.iter().filter(|m| m.stamp() >= open).count();
    let open = if since > MESSAGES / 4 {
        f64::INFINITY
    } else {
        open
    };
    let ends = messages.first().zip(messages.last());
    let span = ends.map_or(0.0, |(first, last)| last.stamp() - first.stamp());
    let mut cell = 4.0 * span / MESSAGES as f64;
    loop {
        let of_message = |row: usize| {
            let stamp = messages[row].stamp();
            (stamp < open).then(|| (stamp / cell) as i64)
        };
        let stay = rows_that_stay(messages.len(), of_message, quantities);
        if stay.len() <= MESSAGES / 2 || cell >= span {
            return stay;
        }
        cell *= 2.0;
    }
}
