//! Recorded tactile readings, with flags computed from the forces if possible.

use feeler::control::{FingerFlags, FlagAnalyzer, FlagThresholds, TactileReading, TactileSource};
use feeler::sensor::forces::{SensorError, TactileSensor};
use feeler_record::{FingerRecord, Flags, NO_ELEMENT, RecordedSensor, Recording};

/// Recorded readings of one finger. A hand with sensors in other programs evaluates the flags of all frames but
/// records only the latest frame of each step. If frames between two steps are missing, the recorded flags are used.
pub struct RecordedTouch {
    sensor: RecordedSensor,
    analyzer: FlagAnalyzer,
    flags: std::vec::IntoIter<Flags>,
    /// Sequence number of the latest frame passed to the analyzer.
    newest: Option<u64>,
    /// `true` if the recording contains the frame before the latest one, so that the analyzer's flags are valid.
    known: bool,
}

impl RecordedTouch {
    /// Creates the source for `finger` of `recording`. Flags are computed with `thresholds`.
    pub fn new(recording: &Recording, finger: usize, thresholds: FlagThresholds) -> Self {
        let sensor = RecordedSensor::new(recording, finger);
        let record = recording.fingers.get(finger);
        let flags = |finger: &FingerRecord| finger.flags.clone();
        Self {
            analyzer: FlagAnalyzer::new(thresholds, sensor.element_count()),
            sensor,
            flags: record.map_or(Vec::new(), flags).into_iter(),
            newest: None,
            known: false,
        }
    }
}

impl TactileSource for RecordedTouch {
    fn element_count(&self) -> usize {
        self.sensor.element_count()
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        self.sensor.read(&mut touch.frame)?;
        touch.analyze(&mut self.analyzer);
        let number = touch.frame.sequence;
        self.known = match self.newest.replace(number) {
            Some(newest) if number == newest => self.known,
            Some(newest) => number == newest.saturating_add(1),
            None => number == 0,
        };
        let recorded = self.flags.next();
        if let Some(recorded) = recorded.filter(|_| !self.known) {
            touch.flags = flags(&recorded);
            touch.shear_rate.clone_from(&recorded.shear_rate);
        }
        Ok(())
    }
}

fn flags(recorded: &Flags) -> FingerFlags {
    let element = recorded.largest_element;
    FingerFlags {
        touch: recorded.touch,
        slip: recorded.slip,
        over: recorded.over,
        largest_element: (element != NO_ELEMENT).then_some(element as usize),
        grasp_force: recorded.grasp_force,
    }
}
