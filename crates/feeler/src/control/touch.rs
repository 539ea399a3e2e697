//! What a finger felt since the last control step, and where that comes from.

use super::flags::{FingerFlags, FlagAnalyzer, FlagThresholds};
use crate::sensor::frame::Frame;
use crate::sensor::reading::{SensorError, TactileFrame, TactileSensor};

/// What one finger felt: its newest forces, and the flags of all frames since the last control step.
///
/// Allocated once with [`FingerTouch::none`] and filled again and again.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerTouch {
    /// The newest forces.
    pub frame: TactileFrame,
    /// Time of the newest picture (s), not of its newest copy: a camera that is stuck goes stale. Not a
    /// number before the first.
    pub stamp: f64,
    /// The flags, each up if it was up in any of the frames.
    pub flags: FingerFlags,
    /// The shear rate |d(F_x, F_y)/dt| of each element at the newest frame, N/s.
    pub shear_rate: Vec<f64>,
}

impl FingerTouch {
    /// A finger of `elements` elements that has felt nothing yet.
    pub fn none(elements: usize) -> Self {
        Self {
            frame: TactileFrame::unloaded(elements),
            stamp: f64::NAN,
            flags: FingerFlags::default(),
            shear_rate: vec![0.0; elements],
        }
    }

    /// Takes the flags and shear rates that `analyzer` makes of the frame.
    pub fn analyze(&mut self, analyzer: &mut FlagAnalyzer) {
        self.flags = analyzer.analyze(&self.frame);
        self.stamp = analyzer.stamp();
        self.shear_rate.clear();
        self.shear_rate.extend_from_slice(analyzer.shear_rate());
    }

    /// Becomes what `other` is, without taking memory where both are of as many elements.
    pub fn copy_from(&mut self, other: &Self) {
        self.frame.sequence = other.frame.sequence;
        self.frame.stamp = other.frame.stamp;
        self.frame.forces.clone_from(&other.frame.forces);
        self.shear_rate.clone_from(&other.shear_rate);
        (self.stamp, self.flags) = (other.stamp, other.flags);
    }
}

/// Something that says what one finger felt since it was asked last.
pub trait TouchSource {
    /// Number of sensing elements.
    fn element_count(&self) -> usize;

    /// Tells that [`touch`](Self::touch) is called next: a source that works on a thread of its own begins now, so that those of several
    /// fingers work side by side. Others have nothing to do.
    fn begin(&mut self) {}

    /// Fills `touch` with what was felt since the last call; where nothing new was, with the same again.
    ///
    /// # Errors
    /// When `touch` is for another number of elements, or nothing could be measured.
    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError>;

    /// The picture that the newest forces come from, where there is one at hand.
    fn frame(&self) -> Option<&Frame> {
        None
    }
}

/// A tactile sensor with its flag analyzer: the whole sensor program of one finger.
#[derive(Debug, Clone)]
pub struct AnalyzedSensor<S> {
    sensor: S,
    analyzer: FlagAnalyzer,
}

impl<S: TactileSensor> AnalyzedSensor<S> {
    /// Raises flags by `thresholds` on what `sensor` measures.
    pub fn new(sensor: S, thresholds: FlagThresholds) -> Self {
        let analyzer = FlagAnalyzer::new(thresholds, sensor.element_count());
        Self { sensor, analyzer }
    }
}

impl<S: TactileSensor> TouchSource for AnalyzedSensor<S> {
    fn element_count(&self) -> usize {
        self.sensor.element_count()
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
        self.sensor.read(&mut touch.frame)?;
        touch.analyze(&mut self.analyzer);
        Ok(())
    }

    fn frame(&self) -> Option<&Frame> {
        self.sensor.frame()
    }
}

impl<T: TouchSource + ?Sized> TouchSource for Box<T> {
    fn element_count(&self) -> usize {
        (**self).element_count()
    }

    fn begin(&mut self) {
        (**self).begin();
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
        (**self).touch(touch)
    }

    fn frame(&self) -> Option<&Frame> {
        (**self).frame()
    }
}
