//! What a finger felt on record, flags raised again where the record has all that they depend on.

use feeler::control::flags::{FingerFlags, FlagAnalyzer, FlagThresholds};
use feeler::control::touch::{FingerTouch, TouchSource};
use feeler::sensor::reading::{SensorError, TactileSensor};
use feeler_record::{FingerRecord, Flags, NO_ELEMENT, RecordedSensor, Recording};

/// A finger on record. A hand whose sensors are other programs sees the flags of all frames but records only
/// the newest of each step: where frames are missing between two steps, flags are those on record.
pub struct RecordedTouch {
    sensor: RecordedSensor,
    analyzer: FlagAnalyzer,
    flags: std::vec::IntoIter<Flags>,
    /// Number of the frame that the analyzer saw last.
    newest: Option<u64>,
    /// Whether the record has the frame before that one, so that its flags are the analyzer's.
    known: bool,
}

impl RecordedTouch {
    /// `finger` of `recording`, flags raised by `thresholds`.
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

impl TouchSource for RecordedTouch {
    fn element_count(&self) -> usize {
        self.sensor.element_count()
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
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
