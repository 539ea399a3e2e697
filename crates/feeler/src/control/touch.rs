//! Tactile readings of a finger, and the sources that provide them.

use super::flags::{FingerFlags, FlagAnalyzer, FlagThresholds};
use crate::sensor::forces::reading::{SensorError, TactileFrame, TactileSensor};
use crate::sensor::image::frame::Frame;

/// Tactile reading of one finger: its latest forces, and the combined flags of all frames since the last control step.
///
/// Allocate it once with [`TactileReading::none`] and reuse it.
#[derive(Debug, Clone, PartialEq)]
pub struct TactileReading {
    /// The latest forces.
    pub frame: TactileFrame,
    /// Time of the latest distinct image (s); NaN before the first one. It is not updated when an image is repeated, so
    /// that the readings of a stuck camera become stale.
    pub stamp: f64,
    /// Flags, each raised if it was raised in any of the frames.
    pub flags: FingerFlags,
    /// Shear rate |d(F_x, F_y)/dt| of each element at the latest frame (N/s).
    pub shear_rate: Vec<f64>,
}

impl TactileReading {
    /// Creates an empty reading for a finger of `elements` elements.
    pub fn none(elements: usize) -> Self {
        Self {
            frame: TactileFrame::unloaded(elements),
            stamp: f64::NAN,
            flags: FingerFlags::default(),
            shear_rate: vec![0.0; elements],
        }
    }

    /// Updates flags and shear rates by analysing the frame with `analyzer`.
    pub fn analyze(&mut self, analyzer: &mut FlagAnalyzer) {
        self.flags = analyzer.analyze(&self.frame);
        self.stamp = analyzer.stamp();
        self.shear_rate.clear();
        self.shear_rate.extend_from_slice(analyzer.shear_rate());
    }

    /// Copies `other` into `self`. Does not allocate if both have the same number of elements.
    pub fn copy_from(&mut self, other: &Self) {
        self.frame.sequence = other.frame.sequence;
        self.frame.stamp = other.frame.stamp;
        self.frame.forces.clone_from(&other.frame.forces);
        self.shear_rate.clone_from(&other.shear_rate);
        (self.stamp, self.flags) = (other.stamp, other.flags);
    }
}

/// Source of tactile readings for one finger.
pub trait TactileSource {
    /// Number of sensing elements.
    fn element_count(&self) -> usize;

    /// Called right before [`touch`](Self::touch), to start sensing on a background thread, so that several fingers are
    /// sensed in parallel. The default does nothing.
    fn begin(&mut self) {}

    /// Fills `touch` with the readings since the last call, or with the previous reading if there is no new data.
    ///
    /// # Errors
    /// If `touch` has a different number of elements, or the sensor failed.
    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError>;

    /// Frames measured between those of the previous and the latest [`touch`](Self::touch), oldest first. Empty by
    /// default, for sensors that measure at most once per control step.
    fn earlier_frames(&self) -> &[TactileFrame] {
        &[]
    }

    /// Camera frame from which the latest forces were computed, if available.
    fn frame(&self) -> Option<&Frame> {
        None
    }
}

/// Tactile sensor with a [`FlagAnalyzer`] that computes its contact flags.
#[derive(Debug, Clone)]
pub struct FlaggedSensor<S> {
    sensor: S,
    analyzer: FlagAnalyzer,
}

impl<S: TactileSensor> FlaggedSensor<S> {
    /// Creates a source of readings from `sensor`, with flags computed with `thresholds`.
    pub fn new(sensor: S, thresholds: FlagThresholds) -> Self {
        let analyzer = FlagAnalyzer::new(thresholds, sensor.element_count());
        Self { sensor, analyzer }
    }
}

impl<S: TactileSensor> TactileSource for FlaggedSensor<S> {
    fn element_count(&self) -> usize {
        self.sensor.element_count()
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        self.sensor.read(&mut touch.frame)?;
        touch.analyze(&mut self.analyzer);
        Ok(())
    }

    fn frame(&self) -> Option<&Frame> {
        self.sensor.frame()
    }
}

impl<T: TactileSource + ?Sized> TactileSource for Box<T> {
    fn element_count(&self) -> usize {
        (**self).element_count()
    }

    fn begin(&mut self) {
        (**self).begin();
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        (**self).touch(touch)
    }

    fn earlier_frames(&self) -> &[TactileFrame] {
        (**self).earlier_frames()
    }

    fn frame(&self) -> Option<&Frame> {
        (**self).frame()
    }
}
