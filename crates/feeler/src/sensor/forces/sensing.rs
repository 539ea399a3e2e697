//! Sensing chain: computes integrated gray values, displacements of centroids and, with a calibration, forces from
//! images, with their validity.

use super::drift::{DriftConfig, DriftCorrection};
use super::mismatch::{Mismatch, MountingCheck};
use super::reading::NO_FORCE;
use crate::sensor::calibration::element::ForceValidity;
use crate::sensor::calibration::error::CalibrationError;
use crate::sensor::calibration::model::Calibration;
use crate::sensor::fingertip::model::{Fingertip, FingertipConfig, FingertipError};
use crate::sensor::image::exposure::{DEFAULT_MAX_SATURATED, Exposure, SaturationCheck};
use crate::sensor::image::frame::Picture;
use crate::sensor::image::polarity::Polarity;
use crate::sensor::image::subregion::WeightedPixel;
use crate::sensor::moments::config::MomentsError;
use crate::sensor::moments::kernel::{ElementMoments, MomentsKernel};
use crate::sensor::track::{MarkerTracker, TrackError, TrackedMarker};
use glam::{DVec2, DVec3};

/// Error of a sensing chain.
#[derive(Debug, thiserror::Error)]
pub enum SensingError {
    /// The fingertip is invalid.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// The moments cannot be computed.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The markers cannot be tracked.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// The calibration cannot be used with this sensor.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The number of elements in an argument does not match the sensor.
    #[error("expected {what} for {expected} elements, got {actual}")]
    ElementCount {
        /// Name of the counted items.
        what: &'static str,
        /// Number of elements of the sensor.
        expected: usize,
        /// Number of items found.
        actual: usize,
    },
}

/// Measurements of one element in one image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementReading {
    /// Integrated gray value G, gray levels times m² (px² for a layout in the image plane).
    pub integrated_gray: f64,
    /// Centroid c of the gray values in the element's plane, m (px); `None` if the element is dark.
    pub centroid: Option<DVec2>,
    /// Displacement `u = c - c_0` of the centroid from its unloaded position, m (px) in x, y of `E_i` (of the image);
    /// `None` if the element is dark or there is no [`Reference`].
    pub displacement: Option<DVec2>,
    /// Force in the element's frame `E_i`, N (sign: see [`TactileFrame`](super::reading::TactileFrame)); `None`
    /// without a calibration, or if the [`exposure`](Self::exposure) makes it invalid.
    pub force: Option<DVec3>,
    /// Exposure of the sub-region.
    pub exposure: Exposure,
}

impl From<&TrackedMarker> for ElementReading {
    /// Converts a marker to a reading; a lost marker becomes a dark element.
    fn from(marker: &TrackedMarker) -> Self {
        match marker.confidence > 0.0 {
            true => Self::of_marker(marker),
            false => Self {
                integrated_gray: marker.integrated_gray,
                exposure: Exposure::Dark,
                ..Self::default()
            },
        }
    }
}

impl ElementReading {
    /// Converts a marker to a reading at its measured or, if it is lost, predicted position.
    fn of_marker(marker: &TrackedMarker) -> Self {
        Self {
            integrated_gray: marker.integrated_gray,
            centroid: Some(marker.place),
            displacement: Some(marker.displacement),
            force: None,
            exposure: Exposure::Good,
        }
    }
}

/// Unloaded centroids, from which displacements are measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Unloaded centroid c_0 of each element, m (px) in its plane; `None` if the element was dark in all readings.
    pub centroids: Vec<Option<DVec2>>,
}

impl Reference {
    /// Averages the centroids of several readings of an unloaded sensor. Each reading contains all elements.
    pub fn from_readings<'a>(readings: impl IntoIterator<Item = &'a [ElementReading]>) -> Self {
        let mut sums: Vec<(DVec2, f64)> = Vec::new();
        for readings in readings {
            sums.resize(sums.len().max(readings.len()), (DVec2::ZERO, 0.0));
            for ((sum, count), reading) in sums.iter_mut().zip(readings) {
                if let Some(centroid) = reading.centroid {
                    *sum += centroid;
                    *count += 1.0;
                }
            }
        }
        let mean = |(sum, count)| (count > 0.0).then(|| sum / count);
        Self {
            centroids: sums.into_iter().map(mean).collect(),
        }
    }

    /// Computes the displacements in `readings` from their centroids.
    pub fn apply(&self, readings: &mut [ElementReading]) {
        for (reading, unloaded) in readings.iter_mut().zip(&self.centroids) {
            reading.displacement = match (reading.centroid, unloaded) {
                (Some(centroid), Some(unloaded)) => Some(centroid - unloaded),
                _ => None,
            };
        }
    }
}

/// Converts images to [`ElementReading`]s. All memory is allocated on construction.
#[derive(Debug, Clone)]
pub struct SensingChain {
    size: (usize, usize),
    kernel: MomentsKernel,
    saturation: SaturationCheck,
    moments: Vec<ElementMoments>,
    reference: Option<Reference>,
    calibration: Option<Calibration>,
    drift: Option<DriftCorrection>,
    first_picture: MountingCheck,
    /// Marker tracker, or `None` to compute moments of sub-regions.
    tracker: Option<MarkerTracker>,
}

impl SensingChain {
    /// Creates a chain from `kernel`, which must have been built from `regions`, for images of `size` (columns, rows)
    /// px.
    ///
    /// A fraction `max_saturated` (0 to 1) of a sub-region's pixels may be saturated, see [`DEFAULT_MAX_SATURATED`].
    ///
    /// # Errors
    /// If the number of `regions` differs from the kernel's number of elements.
    pub fn new(
        size: (usize, usize),
        kernel: MomentsKernel,
        regions: &[Vec<WeightedPixel>],
        max_saturated: f64,
    ) -> Result<Self, SensingError> {
        check_count("sub-regions", kernel.element_count(), regions.len())?;
        let saturation = SaturationCheck::new(size.0, regions, max_saturated);
        Ok(Self {
            size,
            saturation: match kernel.polarity() {
                Polarity::Bright => saturation,
                Polarity::Dark => saturation.of_dark_elements(),
            },
            moments: vec![ElementMoments::default(); kernel.element_count()],
            kernel,
            reference: None,
            calibration: None,
            drift: None,
            first_picture: MountingCheck::default(),
            tracker: None,
        })
    }

    /// Creates a chain for the fingertip described by `config`; lengths are in metres.
    ///
    /// # Errors
    /// If the fingertip is invalid.
    pub fn of_fingertip(config: &FingertipConfig) -> Result<Self, SensingError> {
        let (kernel, regions) = Fingertip::kernel_and_subregions(config)?;
        let size = (config.camera.width, config.camera.height);
        Self::new(size, kernel, &regions, DEFAULT_MAX_SATURATED)
    }

    /// Enables forces, computed with `calibration`, and displacements, relative to its unloaded centroids. The caller
    /// must check that the calibration was made for this sensor ([`Calibration::verify_target`]).
    ///
    /// # Errors
    /// If the calibration has another number of elements.
    pub fn with_calibration(mut self, calibration: Calibration) -> Result<Self, SensingError> {
        let elements = &calibration.elements;
        check_count("calibrations", self.element_count(), elements.len())?;
        let centroids = elements.iter().map(|e| Some(e.unloaded_centroid));
        self.reference = Some(Reference {
            centroids: centroids.collect(),
        });
        self.calibration = Some(calibration);
        Ok(self)
    }

    /// Enables drift correction of all readings, relative to the calibration. Has no effect without a calibration.
    /// See `drift`.
    #[must_use]
    pub fn with_drift_correction(mut self, config: DriftConfig) -> Self {
        let calibration = self.calibration.as_ref();
        self.drift = calibration.map(|calibration| DriftCorrection::new(config, calibration));
        self
    }

    /// Tracks the elements as markers, which may leave their sub-regions, instead of computing moments. `tracker` must have
    /// the same layout. Readings are in px and have no forces, even with a calibration; [`moments`](Self::moments) and
    /// [`sense_forces`](Self::sense_forces) ignore the tracker. Each image is matched independently of earlier ones
    /// ([`MarkerTracker::match_picture`]), which allocates.
    #[must_use]
    pub fn with_tracker(self, tracker: MarkerTracker) -> Self {
        Self {
            tracker: Some(tracker),
            ..self
        }
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.kernel.element_count()
    }

    /// Columns and rows of the images, px.
    pub fn picture_size(&self) -> (usize, usize) {
        self.size
    }

    /// Returns whether readings contain forces.
    pub fn is_calibrated(&self) -> bool {
        self.calibration.is_some()
    }

    /// Reference of the displacements, if set.
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.as_ref()
    }

    /// Sets the reference of displacements. Forces remain relative to the calibration's unloaded centroids.
    ///
    /// # Errors
    /// If the reference has another number of elements.
    pub fn set_reference(&mut self, reference: Reference) -> Result<(), SensingError> {
        let actual = reference.centroids.len();
        check_count("reference centroids", self.element_count(), actual)?;
        self.reference = Some(reference);
        Ok(())
    }

    /// Fills `readings` with the measurements of all elements in `picture`. Does not panic, and allocates only
    /// [with a tracker](Self::with_tracker). In an image without markers, all elements are dark.
    ///
    /// # Errors
    /// If the size of the image or the length of `readings` does not match the sensor.
    pub fn sense<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
        readings: &mut [ElementReading],
    ) -> Result<(), SensingError> {
        self.sense_with_prefetch(picture, &[], readings)
    }

    /// Like [`Self::sense`], but prefetches the pixels of the `next` image into the cache. This is faster if images
    /// are processed one after the other from memory ([`MomentsKernel::measure_with_prefetch`]).
    ///
    /// # Errors
    /// Like [`Self::sense`].
    pub fn sense_with_prefetch<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
        next: &[u8],
        readings: &mut [ElementReading],
    ) -> Result<(), SensingError> {
        check_count("readings", self.element_count(), readings.len())?;
        if let Some(tracker) = &self.tracker {
            // A copy, because a tracker remembers earlier images.
            match_markers(&mut tracker.clone(), picture, readings)?;
            self.apply_reference(readings);
            return Ok(());
        }
        self.measure(picture, next)?;
        for (element, (reading, moments)) in readings.iter_mut().zip(&self.moments).enumerate() {
            let exposure = self.exposure(picture, element, moments);
            let lit = moments.integrated_gray > 0.0;
            *reading = ElementReading {
                integrated_gray: moments.integrated_gray,
                centroid: lit.then_some(moments.centroid),
                displacement: None,
                force: self.force(element, moments, exposure),
                exposure,
            };
        }
        self.apply_reference(readings);
        Ok(())
    }

    /// Computes the displacements in `readings` if there is a reference.
    fn apply_reference(&self, readings: &mut [ElementReading]) {
        if let Some(reference) = &self.reference {
            reference.apply(readings);
        }
    }

    /// Fills `forces` with the force at each element, N in `E_i`: the same as [`sense`](Self::sense), and
    /// [`NO_FORCE`] if there is no valid force. Neither allocates nor panics.
    ///
    /// # Errors
    /// If the size of the image or the length of `forces` does not match the sensor.
    pub fn sense_forces<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
        forces: &mut [DVec3],
    ) -> Result<(), MomentsError> {
        let (expected, actual) = (self.element_count(), forces.len());
        if actual != expected {
            return Err(MomentsError::ElementCount { expected, actual });
        }
        self.measure(picture, &[])?;
        for (element, (force, moments)) in forces.iter_mut().zip(&self.moments).enumerate() {
            let exposure = self.exposure(picture, element, moments);
            *force = self.force(element, moments, exposure).unwrap_or(NO_FORCE);
        }
        Ok(())
    }

    /// Checks that `picture`, the last image sensed, matches the calibrated fingertip. Returns `Ok` without a check
    /// after the first conclusive image, or if there is no calibration. Neither allocates nor panics.
    ///
    /// # Errors
    /// If more than half of the elements differ from their unloaded state.
    pub fn check_first<P: AsRef<[u8]>>(&mut self, picture: &Picture<P>) -> Result<(), Mismatch> {
        let mut first_picture = self.first_picture;
        let calibration = self.calibration.iter();
        let elements = calibration.flat_map(|calibration| &calibration.elements);
        let lit = elements.zip(&self.moments).enumerate();
        let lit = lit.filter(|&(element, (_, moments))| {
            self.exposure(picture, element, moments) == Exposure::Good
        });
        let checked = first_picture.check(self.element_count(), lit.map(|(_, pair)| pair));
        self.first_picture = first_picture;
        checked
    }

    /// Moments of the latest image, one per element, after drift correction if enabled.
    pub fn moments(&self) -> &[ElementMoments] {
        &self.moments
    }

    /// Validity of the force at each element in the latest image; empty without a calibration. Does not allocate.
    pub fn validity(&self) -> impl Iterator<Item = ForceValidity> {
        let calibration = self.calibration.iter();
        let elements = calibration.flat_map(|calibration| &calibration.elements);
        let elements = elements.zip(&self.moments);
        elements.map(|(element, moments)| element.validity(moments))
    }

    fn measure<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
        next: &[u8],
    ) -> Result<(), MomentsError> {
        self.kernel
            .measure_with_prefetch(picture, next, &mut self.moments)?;
        if let Some(drift) = &mut self.drift {
            drift.correct(&mut self.moments);
        }
        Ok(())
    }

    fn exposure<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
        element: usize,
        moments: &ElementMoments,
    ) -> Exposure {
        if moments.integrated_gray <= 0.0 {
            Exposure::Dark
        } else if self.saturation.saturated(picture, element) {
            Exposure::Saturated
        } else {
            Exposure::Good
        }
    }

    /// Force at `element`, N; `None` if it is invalid. This is the only place where validity is decided.
    fn force(&self, element: usize, moments: &ElementMoments, exposure: Exposure) -> Option<DVec3> {
        let calibration = self.calibration.as_ref()?.elements.get(element)?;
        (exposure == Exposure::Good).then(|| calibration.force(moments))
    }
}

/// Fills `readings` with the markers in `picture`. If at most a tenth of the markers are lost, they get the positions
/// predicted from their neighbours and the mean integrated gray value; otherwise they are dark.
fn match_markers<P: AsRef<[u8]>>(
    tracker: &mut MarkerTracker,
    picture: &Picture<P>,
    readings: &mut [ElementReading],
) -> Result<(), TrackError> {
    match tracker.match_picture(picture) {
        Err(TrackError::Locate(_)) => tracker.lose(),
        Err(error) => return Err(error),
        Ok(_) => {}
    }
    let markers = tracker.markers();
    let found = markers.iter().filter(|marker| marker.confidence > 0.0);
    let count = found.clone().count();
    let few_are_lost = 10 * (markers.len() - count) <= markers.len();
    let mean_gray = found.map(|m| m.integrated_gray).sum::<f64>() / count.max(1) as f64;
    for (reading, marker) in readings.iter_mut().zip(markers) {
        *reading = match few_are_lost && marker.confidence == 0.0 {
            true => ElementReading::of_marker(&TrackedMarker {
                integrated_gray: mean_gray,
                ..*marker
            }),
            false => marker.into(),
        };
    }
    Ok(())
}

fn check_count(what: &'static str, expected: usize, actual: usize) -> Result<(), SensingError> {
    if expected == actual {
        return Ok(());
    }
    Err(SensingError::ElementCount {
        what,
        expected,
        actual,
    })
}
