//! Windows of tactile samples at the sensor's rate, stored with the frames of an episode.

use super::feature::{Feature, Values};
use super::frames::{Frames, Sampling};
use super::tactile::{about_forces, tactile_key};
use crate::error::ExportError;
use feeler_record::wire::Vector3;
use feeler_record::{FingerRecord, Recording, SAME_TIME};
use serde_json::{Map, Value, json};

/// A tactile sample: forces on all elements at one time.
#[derive(Clone, Copy)]
struct Sample<'a> {
    sequence: u64,
    /// Time of measurement (s).
    stamp: f64,
    forces: &'a [Vector3],
}

/// Samples of a finger, sorted by time, each once. Samples with unknown forces are left out.
fn samples(record: &FingerRecord) -> Vec<Sample<'_>> {
    let at_steps = record.tactile.iter();
    let at_steps = at_steps.map(|frame| (frame.sequence, frame.stamp, &frame.forces));
    let between = record.samples.iter();
    let between = between.map(|frame| (frame.sequence, frame.stamp, &frame.forces));
    let is_known =
        |force: &Vector3| force.x.is_finite() && force.y.is_finite() && force.z.is_finite();
    let all = at_steps.chain(between);
    let known = all.filter(|(.., forces)| forces.iter().all(is_known));
    let mut samples: Vec<_> = known
        .map(|(sequence, stamp, forces)| Sample {
            sequence,
            stamp,
            forces,
        })
        .collect();
    samples.sort_by(|a, b| a.stamp.total_cmp(&b.stamp));
    // A step without a new sample repeats the previous one.
    samples.dedup_by_key(|sample| sample.sequence);
    samples
}

/// Number of samples up to `time` (s).
fn count_until(samples: &[Sample<'_>], time: f64) -> usize {
    samples.partition_point(|sample| sample.stamp <= time + SAME_TIME)
}

/// Time after which the samples of a frame are new (s): that of the previous frame.
fn new_after(frames: &Frames<'_>, frame: usize) -> f64 {
    match frame.checked_sub(1) {
        Some(before) => frames.step_time(before),
        None => frames.step_time(0) - 1.0 / f64::from(frames.rate),
    }
}

/// Largest number of tactile samples of a finger between two frames of the run, at `fps` frames per second (`None`: the
/// control rate); at least 1. The longest window of all runs of a data set is its [`Sampling::window`].
///
/// # Errors
/// As [`DataSet::add`](super::DataSet::add).
pub fn longest_window(
    run: &str,
    recording: &Recording,
    fps: Option<u32>,
) -> Result<usize, ExportError> {
    let window = Some(1);
    let frames = Frames::of(run, recording, Sampling { fps, window })?;
    let mut longest = 1;
    for record in &recording.fingers {
        let samples = samples(record);
        for frame in 0..frames.steps.len() {
            let end = count_until(&samples, frames.step_time(frame));
            let new = end - count_until(&samples, new_after(&frames, frame)).min(end);
            longest = longest.max(new);
        }
    }
    Ok(longest)
}

/// Windows of a finger: the latest `length` samples at each frame, oldest first.
///
/// # Errors
/// If a frame has more than `length` new samples, or the number of elements differs between samples.
pub(crate) fn windows(
    run: &str,
    recording: &Recording,
    finger: usize,
    frames: &Frames<'_>,
    length: usize,
) -> Result<[Feature; 3], ExportError> {
    let samples = recording.fingers.get(finger).map_or(Vec::new(), samples);
    let key = |what: &str| tactile_key(finger, &format!("window.{what}"));
    let elements = samples.first().map_or(0, |sample| sample.forces.len());
    let refuse = |expected: String, actual: usize, time: f64| {
        let actual = format!("{actual} at {time} s");
        Err(ExportError::of_run(run, key("force"), expected, actual))
    };
    let (mut forces, mut times, mut is_new) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..frames.steps.len() {
        let end = count_until(&samples, frames.step_time(frame));
        let old = count_until(&samples, new_after(frames, frame)).min(end);
        if end == 0 || end - old > length {
            let expected = format!("1 to {length} samples since the previous frame");
            return refuse(expected, end - old, frames.step_time(frame));
        }
        for place in end as isize - length as isize..end as isize {
            // Before the first sample, it is repeated.
            let sample = samples[usize::try_from(place).unwrap_or(0)];
            if sample.forces.len() != elements {
                let expected = format!("forces on {elements} elements");
                return refuse(expected, sample.forces.len(), sample.stamp);
            }
            let numbers = sample.forces.iter().flat_map(|f| [f.x, f.y, f.z]);
            forces.extend(numbers.map(|number| number as f32));
            times.push((sample.stamp - frames.time(frame)) as f32);
            is_new.push(place >= old as isize);
        }
    }
    let mut about = about_forces(recording, finger);
    about.insert("units".into(), json!("N"));
    let feature = |what: &str, shape: Vec<usize>, names: Value, about, values| Feature {
        key: key(what),
        shape,
        names,
        about,
        values,
    };
    let of_times = [
        ("units".into(), json!("s")),
        ("reference".into(), json!("timestamp of the frame")),
    ];
    let names = json!(["sample", "element", "axis"]);
    Ok([
        feature(
            "force",
            vec![length, elements, 3],
            names,
            about,
            Values::Float(forces),
        ),
        feature(
            "time",
            vec![length],
            Value::Null,
            Map::from_iter(of_times),
            Values::Float(times),
        ),
        feature(
            "is_new",
            vec![length],
            Value::Null,
            Map::new(),
            Values::Bool(is_new),
        ),
    ])
}
