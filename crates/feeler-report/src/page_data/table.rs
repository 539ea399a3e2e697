//! Rows of a run as binary columns.

use crate::measures::strokes::TRUE_SLIP;
use crate::run::data::RunData;
use crate::run::finger_columns::FingerColumns;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler_record::{FingerModel, Phase, SolidFrame};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use glam::{DQuat, DVec3};
use serde::Serialize;
use std::io::Write;

/// Maximum number of rows per second in a page.
const RATE: f64 = 100.0;
/// Maximum number of rows in a page, which a browser draws within two seconds.
const MAX_ROWS: usize = 30_000;
/// Minimum step between stored force values (N): a quarter of a sensor's noise.
const FORCE_STEP: f64 = 5e-4;
/// Unknown value in 16-bit columns.
const UNKNOWN: i16 = i16::MIN;

/// Rows of a run.
#[derive(Debug, Clone, Serialize)]
pub struct RunTable {
    rows: usize,
    columns: Vec<Column>,
    data: String,
    phases: Vec<String>,
    strokes: Vec<Stroke>,
}

#[derive(Debug, Clone, Serialize)]
struct Column {
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    width: usize,
    scale: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Stroke {
    index: u32,
    start: usize,
    end: usize,
    #[serde(rename = "move")]
    moving: (usize, usize),
}

/// Rows of a run that are in its page: every n-th row.
pub struct Rows {
    every: usize,
    count: usize,
}

impl Rows {
    fn new(data: &RunData) -> Self {
        let count = data.time.len();
        let every = match data.thinned {
            Some(_) => 1, // already decimated to significant rows
            None => (1.0 / (RATE * data.facts.control_period)).round() as usize,
        };
        Self {
            every: every.max(count.div_ceil(MAX_ROWS)).max(1),
            count,
        }
    }

    /// Indices of the rows in the page.
    fn kept(&self) -> impl Iterator<Item = usize> + Clone + use<> {
        (0..self.count).step_by(self.every)
    }

    /// Row of the page that corresponds to a row of the run.
    pub fn of(&self, row: usize) -> usize {
        row / self.every
    }
}

/// Columns being encoded.
#[derive(Default)]
struct Columns {
    columns: Vec<Column>,
    bytes: Vec<u8>,
}

impl Columns {
    fn add<const N: usize>(
        &mut self,
        name: String,
        kind: &'static str,
        width: usize,
        scale: f64,
        numbers: impl Iterator<Item = [u8; N]>,
    ) {
        // Append whole numbers: appending single bytes took as long as compressing them.
        for number in numbers {
            self.bytes.extend_from_slice(&number);
        }
        self.columns.push(Column {
            name,
            kind,
            width,
            scale,
        });
    }

    fn bytes(&mut self, name: String, numbers: impl Iterator<Item = u8>) {
        self.add(name, "u8", 1, 1.0, numbers.map(|number| [number]));
    }

    fn f32(&mut self, name: String, width: usize, numbers: impl Iterator<Item = f64>) {
        let numbers = numbers.map(|number| (number as f32).to_le_bytes());
        self.add(name, "f32", width, 1.0, numbers);
    }
}

impl RunTable {
    /// Columns of a live page, whose rows are sent later.
    pub fn to_come(columns: impl IntoIterator<Item = (String, usize)>) -> Self {
        let column = |(name, width): (String, usize)| Column {
            kind: match name.as_str() {
                "time" => "f64",
                _ => "f32",
            },
            name,
            width,
            scale: 1.0,
        };
        Self {
            rows: 0,
            columns: columns.into_iter().map(column).collect(),
            data: String::new(),
            phases: phase_names(),
            strokes: Vec::new(),
        }
    }

    /// Rows of a run, and their selection.
    pub fn new(data: &RunData) -> (Self, Rows) {
        let rows = Rows::new(data);
        let kept = rows.kept();
        let mut columns = Columns::default();
        let times = kept.clone().map(|row| data.time[row].to_le_bytes());
        columns.add("time".into(), "f64", 1, 1.0, times);
        let phases = kept.clone().map(|row| data.phase[row] as u8);
        columns.bytes("phase".into(), phases);
        for (number, finger) in data.fingers.iter().enumerate() {
            let frames = kept
                .clone()
                .flat_map(|row| finger.frames[row].iter().copied());
            columns.f32(of_finger(number, "joints"), finger.frame_count(), frames);
            add_felt(&mut columns, number, finger, kept.clone());
            let elements = data.facts.hand.get(number).into_iter();
            let elements = elements.flat_map(FingerModel::elements);
            let estimator = ContactEstimator::new(elements, data.facts.touch_force_threshold);
            add_contact(&mut columns, number, finger, estimator, kept.clone());
        }
        if let Some(torque) = &data.torque {
            let torque = kept.clone().map(|row| torque[row]);
            columns.f32("torque".into(), 1, torque);
        }
        add_moving(&mut columns, data, &kept);
        let strokes = data.strokes.iter().map(|stroke| Stroke {
            index: stroke.index,
            start: rows.of(stroke.rows.start),
            end: rows.of(stroke.rows.end),
            moving: (rows.of(stroke.moving.start), rows.of(stroke.moving.end)),
        });
        let table = Self {
            rows: kept.count(),
            columns: columns.columns,
            data: compressed(&columns.bytes),
            phases: phase_names(),
            strokes: strokes.collect(),
        };
        (table, rows)
    }
}

/// Names of the phases, indexed by number.
fn phase_names() -> Vec<String> {
    Phase::ALL.map(|phase| phase.to_string()).to_vec()
}

/// Name of a finger's column.
pub fn of_finger(finger: usize, name: &str) -> String {
    format!("finger/{finger}/{name}")
}

/// Value of a finger's column `flags`, from TOUCH, SLIP, OVER and true slip.
pub fn flag_bits(flags: [bool; 4]) -> u8 {
    let bits = flags.into_iter().enumerate();
    bits.fold(0, |bits, (bit, up)| bits | u8::from(up) << bit)
}

/// Adds the tactile columns of a finger.
fn add_felt(
    columns: &mut Columns,
    number: usize,
    finger: &FingerColumns,
    kept: impl Iterator<Item = usize> + Clone,
) {
    let forces = |row: usize| finger.forces[row].iter().flat_map(|force| force.to_array());
    let width = kept.clone().map(|row| 3 * finger.forces[row].len()).max();
    let width = width.unwrap_or_default();
    let largest = kept.clone().flat_map(forces).map(f64::abs);
    let largest = largest
        .filter(|force| force.is_finite())
        .fold(0.0, f64::max);
    let scale = FORCE_STEP.max(largest / f64::from(i16::MAX));
    // Round half away from zero like `round`, which would be a C library call per value.
    let stored = |force: f64| match force.is_nan() {
        true => UNKNOWN,
        false => (force / scale + 0.5_f64.copysign(force)) as i16,
    };
    let padded = kept.clone().flat_map(|row| {
        let forces = forces(row).chain(std::iter::repeat(f64::NAN));
        forces.take(width).map(|force| stored(force).to_le_bytes())
    });
    let name = of_finger(number, "forces");
    columns.add(name, "i16", width, scale, padded);
    let flags = kept.clone().map(|row| {
        let slips = finger.slipped[row].is_some_and(|slipped| slipped > TRUE_SLIP);
        flag_bits([finger.touch[row], finger.slip[row], finger.over[row], slips])
    });
    columns.bytes(of_finger(number, "flags"), flags);
    let grasp = kept.clone().map(|row| finger.grasp_force[row]);
    columns.f32(of_finger(number, "grasp_force"), 1, grasp);
    let rate = kept.map(|row| finger.shear_rate[row]);
    columns.f32(of_finger(number, "shear_rate"), 1, rate);
}

/// Adds the columns with the contact of a finger.
fn add_contact(
    columns: &mut Columns,
    number: usize,
    finger: &FingerColumns,
    mut estimator: ContactEstimator,
    kept: impl Iterator<Item = usize>,
) {
    let contacts = kept.flat_map(|row| contact_values(estimator.estimate(&finger.forces[row])));
    columns.f32(of_finger(number, "contact"), CONTACT_WIDTH, contacts);
}

/// Number of values of a contact.
pub const CONTACT_WIDTH: usize = 11;

/// Values of a contact: centre, both semi-axes as vectors (m in `T`), torsion (N m), and the fraction that slide among
/// the elements pressed with at least three times the threshold; NaN if unknown.
pub fn contact_values(contact: Option<Contact>) -> [f64; CONTACT_WIDTH] {
    let vector = |of: Option<DVec3>| of.unwrap_or(DVec3::NAN).to_array();
    let ellipse = contact.and_then(|contact| Some((contact.ellipse?, contact.normal)));
    let [x, y, z] = vector(contact.map(|contact| contact.centre));
    let [long_x, long_y, long_z] = vector(ellipse.map(|(e, _)| e.semi_axes[0] * e.direction));
    let [short_x, short_y, short_z] =
        vector(ellipse.map(|(e, normal)| e.semi_axes[1] * normal.cross(e.direction)));
    let torsion = contact.map_or(f64::NAN, |contact| contact.torsion);
    let sliding = contact.and_then(|contact| contact.sliding);
    let sliding = sliding.unwrap_or(f64::NAN);
    [
        x, y, z, long_x, long_y, long_z, short_x, short_y, short_z, torsion, sliding,
    ]
}

/// Adds the columns with the motion of the cap and of the object.
fn add_moving(columns: &mut Columns, data: &RunData, kept: &(impl Iterator<Item = usize> + Clone)) {
    let place = |position: DVec3, turned: DQuat| {
        let numbers = position.to_array().into_iter().chain(turned.to_array());
        numbers.collect::<Vec<_>>()
    };
    if let Some(cap) = &data.cap {
        let places = kept.clone().flat_map(|row| {
            let turned = DQuat::from_rotation_z(cap.angle[row]);
            place(cap.centre[row], turned)
        });
        columns.f32(frame_column(SolidFrame::Cap), 7, places);
        let angles = kept.clone().map(|row| cap.angle[row]);
        columns.f32("cap_angle".into(), 1, angles);
    }
    if let Some(object) = &data.object {
        let poses = kept.clone().flat_map(|row| object[row]);
        columns.f32(frame_column(SolidFrame::Object), 7, poses);
    }
}

/// Name of the column with a frame's pose.
pub fn frame_column(frame: SolidFrame) -> String {
    format!("frame/{}", frame.name())
}

/// Compresses with raw deflate and encodes in base64.
fn compressed(bytes: &[u8]) -> String {
    // Level 1 makes pages a seventh larger. Higher levels save one percent and take longer; the highest takes longer
    // than the run itself.
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::new(2));
    // Writing to memory cannot fail.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    STANDARD.encode(written.unwrap_or_default())
}
