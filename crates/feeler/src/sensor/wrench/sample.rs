//! Images and simultaneously measured wrenches, from which a calibration is fitted.

use super::MeasuredWrench;
use crate::sensor::moments::kernel::ElementMoments;

/// One image and the wrench measured at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchSample {
    /// Index of the recording.
    pub recording: usize,
    /// Moments of each element; `None` if it is dark or saturated.
    pub seen: Vec<Option<ElementMoments>>,
    /// Measured wrench.
    pub wrench: MeasuredWrench,
}

/// Recording of each sample.
pub(super) fn recording_of(samples: &[&WrenchSample]) -> Vec<usize> {
    samples.iter().map(|sample| sample.recording).collect()
}
