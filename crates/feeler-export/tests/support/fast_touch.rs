//! Recordings of a sensor that is faster than the control loop, whose forces and images contain the time at which they
//! were measured.

use super::{BAR, MadeUp, facts, move_finger};
use feeler::control::Phase;
use feeler::sensor::image::Frame;
use feeler_record::{
    Flags, Image, MessageSink, NO_ELEMENT, RecordOptions, Recorder, Tactile, TactileSample, Task,
    topics,
};
use glam::DVec3;
use std::path::Path;

/// Nominal rate of the sensor (Hz), no multiple of the control rate (100 Hz) or of a video's rate.
pub const TOUCH_RATE: f64 = 437.0;
/// Elements of the sensor.
pub const ELEMENTS: usize = 3;
/// Width and height of the images (px).
pub const SIZE: (usize, usize) = (96, 64);
/// Number of distinct images: the bar moves by half its width from one sample to the next.
pub const IMAGES: usize = (SIZE.0 - BAR) / (BAR / 2);

/// A recording of one finger.
pub struct FastTouch {
    pub steps: usize,
    /// Error of the recorded stamps (s).
    pub shift: f64,
    /// `true` if some samples are missing.
    pub drops: bool,
}

/// A sample of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub sequence: u64,
    /// True time of measurement (s).
    pub time: f64,
}

impl FastTouch {
    /// Recorded samples until a time (s), with jitter of up to 30 % of the period.
    pub fn samples(&self, end: f64) -> Vec<Sample> {
        let jitter = |n: u64| 0.3 * (12.9898 * n as f64).sin();
        let sample = |sequence: u64| Sample {
            sequence,
            time: (sequence as f64 + 0.5 + jitter(sequence)) / TOUCH_RATE,
        };
        // Every 13th is lost, and once for 60 ms all are.
        let is_kept = |n: &u64| !self.drops || (n % 13 != 5 && !(200..226).contains(n));
        let all = (0..).filter(is_kept).map(sample);
        all.take_while(|sample| sample.time <= end).collect()
    }

    /// Writes the recording to a file.
    pub fn write(&self, path: &Path) {
        let made_up = MadeUp {
            elements: ELEMENTS,
            steps: self.steps,
            ..MadeUp::default()
        };
        let options = RecordOptions {
            pictures: true,
            samples: true,
            ..RecordOptions::default()
        };
        let facts = facts(&made_up);
        let mut recorder = Recorder::create_with(path, &facts, "", &options).unwrap();
        let samples = self.samples(self.steps as f64 * made_up.period);
        let mut next = 0;
        for step in 0..self.steps {
            let stamp = (step + 1) as f64 * made_up.period;
            let before = next;
            while samples.get(next).is_some_and(|sample| sample.time <= stamp) {
                next += 1;
            }
            for sample in &samples[before..next.saturating_sub(1).max(before)] {
                let sample = TactileSample {
                    sequence: sample.sequence,
                    stamp: sample.time + self.shift,
                    forces: forces(sample),
                };
                recorder.write(topics::samples(0), &sample).unwrap();
            }
            if let Some(latest) = next.checked_sub(1).and_then(|last| samples.get(last)) {
                self.write_latest(&mut recorder, latest, next > before);
            }
            move_finger(&mut recorder, (step, 0), stamp);
            let task = Task {
                stamp,
                phase: Phase::Move,
                stroke: 1,
                reason: String::new(),
            };
            recorder.write(topics::TASK, &task).unwrap();
        }
        recorder.finish(None).unwrap();
    }

    /// Writes the latest sample of a step, and its image if it is new.
    fn write_latest(&self, recorder: &mut Recorder, latest: &Sample, is_new: bool) {
        let stamp = latest.time + self.shift;
        if is_new {
            let mut frame = Frame::black(SIZE.0, SIZE.1);
            (frame.sequence, frame.stamp) = (latest.sequence, stamp);
            let first = bar(latest.sequence);
            for row in frame.picture.pixels.chunks_mut(SIZE.0) {
                row[first..first + BAR].fill(255);
            }
            let mut image = Image::of_finger(0);
            image.fill(&frame).unwrap();
            recorder.write(topics::image(0), &image).unwrap();
        }
        let tactile = Tactile {
            sequence: latest.sequence,
            stamp,
            forces: forces(latest),
        };
        let flags = Flags {
            stamp,
            largest_element: NO_ELEMENT,
            shear_rate: vec![0.0; ELEMENTS],
            ..Flags::default()
        };
        recorder.write(topics::tactile(0), &tactile).unwrap();
        recorder.write(topics::flags(0), &flags).unwrap();
    }
}

/// First column (px) of the bar in the image of a sample.
pub fn bar(sequence: u64) -> usize {
    BAR / 2 * (sequence as usize % IMAGES)
}

/// Forces (N) of a sample: x is its number, z its true time of measurement in seconds.
fn forces(sample: &Sample) -> Vec<feeler_record::wire::Vector3> {
    vec![DVec3::new(sample.sequence as f64, 0.0, sample.time).into(); ELEMENTS]
}
