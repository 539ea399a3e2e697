//! What each picture says about each element: integrated gray value, displacement of the centroid
//! and, with a calibration, the force; and whether it can be believed.

use super::{
    calibration::{Calibration, CalibrationError, ElementCalibration, ForceValidity},
    drift::{DriftConfig, DriftCorrection},
    exposure::{DEFAULT_MAX_SATURATED, Exposure, SaturationCheck},
    fingertip::{Fingertip, FingertipConfig, FingertipError},
    frame::Picture,
    mismatch::{FirstPicture, Mismatch},
    moments::{ElementMoments, MomentsKernel},
    moments_config::MomentsError,
    polarity::Polarity,
    reading::NO_FORCE,
    subregion::WeightedPixel,
};
use glam::{DVec2, DVec3};

/// Why pictures cannot be sensed.
#[derive(Debug, thiserror::Error)]
pub enum SensingError {
    /// The fingertip makes no sense.
    #[error(transparent)]
    Fingertip(#[from] FingertipError),
    /// Moments cannot be taken.
    #[error(transparent)]
    Moments(#[from] MomentsError),
    /// The calibration cannot be used with it.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// Something is for another number of elements.
    #[error("{what} for {expected} elements expected, got {actual}")]
    ElementCount {
        /// What was counted.
        what: &'static str,
        /// Elements of the sensor.
        expected: usize,
        /// How many arrived.
        actual: usize,
    },
}

/// What one picture says about one element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementReading {
    /// Integrated gray value G, grey levels times m² (px² in a layout in the picture's plane).
    pub integrated_gray: f64,
    /// Centroid c of the gray values in the element's plane, m (px); none in the dark.
    pub centroid: Option<DVec2>,
    /// Displacement `u = c - c_0` from the unloaded place, m (px) in x, y of `E_i` (of the picture);
    /// none in the dark, and without a [`Reference`].
    pub displacement: Option<DVec2>,
    /// Force in the element's frame `E_i`, N (sign: see
    /// [`TactileFrame`](super::reading::TactileFrame)); none without a calibration, and where
    /// [`exposure`](Self::exposure) says that it would be wrong.
    pub force: Option<DVec3>,
    /// How the sub-region is lit.
    pub exposure: Exposure,
}

/// Where the centroids are without load: what a displacement counts from.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// c_0 of each element, m (px) in its plane; none for an element that was always dark.
    pub centroids: Vec<Option<DVec2>>,
}

impl Reference {
    /// The mean centroids of some readings of an unloaded sensor, each of all elements.
    pub fn mean<'a>(readings: impl IntoIterator<Item = &'a [ElementReading]>) -> Self {
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

    /// Sets the displacements of `readings` by their centroids.
    pub fn apply(&self, readings: &mut [ElementReading]) {
        for (reading, unloaded) in readings.iter_mut().zip(&self.centroids) {
            reading.displacement = match (reading.centroid, unloaded) {
                (Some(centroid), Some(unloaded)) => Some(centroid - unloaded),
                _ => None,
            };
        }
    }
}

/// From pictures to [`ElementReading`]s. Everything is allocated when it is built.
#[derive(Debug, Clone)]
pub struct SensingChain {
    size: (usize, usize),
    kernel: MomentsKernel,
    saturation: SaturationCheck,
    moments: Vec<ElementMoments>,
    reference: Option<Reference>,
    calibration: Option<Calibration>,
    drift: Option<DriftCorrection>,
    first_picture: FirstPicture,
}

impl SensingChain {
    /// Senses with `kernel`, which was made of `regions` for pictures of `size` (columns, rows) px.
    ///
    /// A part `max_saturated` (0 to 1) of a sub-region's pixels may be saturated, see
    /// [`DEFAULT_MAX_SATURATED`].
    ///
    /// # Errors
    /// When `regions` are not those of the kernel's elements.
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
            first_picture: FirstPicture::default(),
        })
    }

    /// Senses the fingertip that `config` describes; lengths are metres.
    ///
    /// # Errors
    /// When the fingertip makes no sense.
    pub fn of_fingertip(config: &FingertipConfig) -> Result<Self, SensingError> {
        Self::of_fingertip_saturated(config, DEFAULT_MAX_SATURATED)
    }

    /// As [`Self::of_fingertip`], with a part `max_saturated` of saturated pixels allowed.
    ///
    /// # Errors
    /// When the fingertip makes no sense.
    pub fn of_fingertip_saturated(
        config: &FingertipConfig,
        max_saturated: f64,
    ) -> Result<Self, SensingError> {
        let (kernel, regions) = Fingertip::kernel_and_subregions(config)?;
        let size = (config.camera.width, config.camera.height);
        Self::new(size, kernel, &regions, max_saturated)
    }

    /// With the forces that `calibration` gives, and displacements from its unloaded centroids. That
    /// it was made for this sensor is for the caller to check
    /// ([`Calibration::check_made_for`]).
    ///
    /// # Errors
    /// When the calibration has another number of elements.
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

    /// With drift taken out of all that is sensed, as far as the calibration knows the sensor without
    /// it; without a calibration, nothing changes. See [`drift`](super::drift).
    #[must_use]
    pub fn with_drift_correction(mut self, config: DriftConfig) -> Self {
        let calibration = self.calibration.as_ref();
        self.drift = calibration.map(|calibration| DriftCorrection::new(config, calibration));
        self
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.kernel.element_count()
    }

    /// Columns and rows of the pictures, px.
    pub fn picture_size(&self) -> (usize, usize) {
        self.size
    }

    /// Whether there are forces.
    pub fn is_calibrated(&self) -> bool {
        self.calibration.is_some()
    }

    /// What displacements count from, if that is known.
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.as_ref()
    }

    /// Lets displacements count from `reference`; forces count from the calibration's own.
    ///
    /// # Errors
    /// When the reference has another number of elements.
    pub fn set_reference(&mut self, reference: Reference) -> Result<(), SensingError> {
        let actual = reference.centroids.len();
        check_count("reference centroids", self.element_count(), actual)?;
        self.reference = Some(reference);
        Ok(())
    }

    /// Fills `readings` with what `picture` says about each element. Neither allocates nor panics.
    ///
    /// # Errors
    /// When the picture has another size than the sensor's, or `readings` is for another number of
    /// elements.
    pub fn sense<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
        readings: &mut [ElementReading],
    ) -> Result<(), SensingError> {
        self.sense_ahead(picture, &[], readings)
    }

    /// As [`Self::sense`], while the pixels of the `next` picture come into the cache: worth it where pictures wait in memory one after the
    /// other ([`MomentsKernel::measure_ahead`]).
    ///
    /// # Errors
    /// As [`Self::sense`].
    pub fn sense_ahead<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
        next: &[u8],
        readings: &mut [ElementReading],
    ) -> Result<(), SensingError> {
        check_count("readings", self.element_count(), readings.len())?;
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
        if let Some(reference) = &self.reference {
            reference.apply(readings);
        }
        Ok(())
    }

    /// Fills `forces` with the force at each element, N in `E_i`: those of [`sense`](Self::sense), and
    /// [`NO_FORCE`] where it gives none. Neither allocates nor panics.
    ///
    /// # Errors
    /// When the picture has another size than the sensor's, or `forces` is for another number of
    /// elements.
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

    /// Refuses `picture`, the newest that was sensed, if it is the first one that tells and shows another fingertip than the
    /// calibration's; all pictures pass without a calibration. Neither allocates nor panics.
    ///
    /// # Errors
    /// When more than half of the elements are not where they are without load.
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

    /// The moments of the newest picture, one for each element, without drift where it is corrected.
    pub fn moments(&self) -> &[ElementMoments] {
        &self.moments
    }

    /// How far the moments of the newest picture are within what the calibration knows, one for each
    /// element; none without a calibration. Does not allocate.
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
            .measure_ahead(picture, next, &mut self.moments)?;
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

    /// The force at `element`, N, if it is valid. This is the only place that decides so.
    fn force(&self, element: usize, moments: &ElementMoments, exposure: Exposure) -> Option<DVec3> {
        let calibration = self.calibration_of(element);
        let calibration = calibration.filter(|_| exposure == Exposure::Good);
        calibration.map(|calibration| calibration.force(moments))
    }

    fn calibration_of(&self, element: usize) -> Option<&ElementCalibration> {
        self.calibration.as_ref()?.elements.get(element)
    }
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
