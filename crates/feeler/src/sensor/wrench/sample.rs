//! Measurements of a sensor and simultaneously measured wrenches, from which a calibration is fitted.

use super::MeasuredWrench;
use super::basis::Basis;
use super::moments::MomentBasis;

/// One image and the wrench measured at the same time.
pub type WrenchSample = SampleOf<MomentBasis>;

/// Measurement of a sensor with features `B`, and the wrench measured at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleOf<B: Basis> {
    /// Index of the recording.
    pub recording: usize,
    /// Measurement of all elements; for an image the moments of each element, `None` if it is dark or saturated.
    pub seen: B::Input,
    /// Measured wrench.
    pub wrench: MeasuredWrench,
}

/// Index of the recording of each sample.
pub(super) fn recording_of<B: Basis>(samples: &[&SampleOf<B>]) -> Vec<usize> {
    samples.iter().map(|sample| sample.recording).collect()
}
