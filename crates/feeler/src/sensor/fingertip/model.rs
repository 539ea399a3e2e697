//! Configuration of one optical fingertip. It determines the gray values and the fingertip for which a calibration is
//! valid.

use super::dome::{CameraConfig, DomeError, DomeProjection};
use super::layout::{ElementLayout, LayoutConfig, MAX_ELEMENTS};
use crate::check::Checker;
use crate::sensor::image::seen::ProjectedElement;
use crate::sensor::image::subregion::{WeightedPixel, subregions};
use crate::sensor::moments::config::{MomentsConfig, MomentsError};
use crate::sensor::moments::kernel::MomentsKernel;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, PoisonError};

/// One optical fingertip: its elements, its camera, and the configuration of the moments.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FingertipConfig {
    /// Arrangement of the sensing elements.
    pub layout: LayoutConfig,
    /// Camera inside the dome.
    pub camera: CameraConfig,
    /// Configuration of the moments.
    pub moments: MomentsConfig,
}

impl FingertipConfig {
    /// Checks that every value of the table `key` is in its range. The field of view is checked by
    /// [`Fingertip::new`].
    pub fn check(&self, key: &str, checker: &mut Checker) {
        self.layout.check(&format!("{key}.layout"), checker);
        let dome_radius = self.layout.dome_radius;
        self.moments
            .check(&format!("{key}.moments"), dome_radius, checker);
    }
}

/// Error of building a fingertip.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FingertipError {
    /// There are no elements, or too many.
    #[error("a fingertip must have 1 to {MAX_ELEMENTS} elements, got {actual}")]
    ElementCount {
        /// Number of elements.
        actual: usize,
    },
    /// The camera is invalid.
    #[error(transparent)]
    Dome(#[from] DomeError),
    /// The configuration of the moments is invalid.
    #[error(transparent)]
    Moments(#[from] MomentsError),
}

/// Number of kernels in the cache, of about 5 MB each.
const KEPT: usize = 2;

/// Kernel of a fingertip, and the pixels of each element from which it was built.
type Sensed = (MomentsKernel, Vec<Vec<WeightedPixel>>);

/// Immutable sensing data built from a [`FingertipConfig`].
#[derive(Debug, Clone, PartialEq)]
pub struct Fingertip {
    /// Sensing elements.
    pub layout: ElementLayout,
    /// Projection from the dome to the image.
    pub projection: DomeProjection,
    /// Kernel that computes the moments of an image.
    pub kernel: MomentsKernel,
}

impl Fingertip {
    /// Builds the fingertip described by `config`.
    ///
    /// # Errors
    /// If a sub-region is not completely visible, or a value is invalid.
    pub fn new(config: &FingertipConfig) -> Result<Self, FingertipError> {
        let (layout, projection) = Self::layout_and_projection(config)?;
        Ok(Self {
            layout,
            projection,
            kernel: Self::sensed(config)?.0.clone(),
        })
    }

    /// Returns the kernel of the fingertip, and the pixels of each element from which it was built.
    ///
    /// # Errors
    /// Like [`Self::new`].
    pub fn kernel_and_subregions(config: &FingertipConfig) -> Result<Sensed, FingertipError> {
        Ok(Self::sensed(config)?.as_ref().clone())
    }

    /// Returns a kernel and its pixels from the cache, or builds them, which takes about 60 ms. The latest ones are
    /// cached, because the fingertips of a rig are mostly identical, and the trials of a sweep request the same one
    /// repeatedly.
    fn sensed(config: &FingertipConfig) -> Result<Arc<Sensed>, FingertipError> {
        static NEWEST: Mutex<Vec<(FingertipConfig, Arc<Sensed>)>> = Mutex::new(Vec::new());
        // Entries are complete even if a thread panicked while holding the lock.
        let newest = || NEWEST.lock().unwrap_or_else(PoisonError::into_inner);
        let known = |kept: &[(FingertipConfig, Arc<Sensed>)]| {
            let known = kept.iter().find(|(own, _)| own == config);
            known.map(|(_, sensed)| sensed.clone())
        };
        if let Some(sensed) = known(&newest()) {
            return Ok(sensed);
        }
        let sensed = Arc::new(Self::make_sensed(config)?);
        let mut newest = newest();
        // Another thread may have built the same entry meanwhile.
        if known(&newest).is_none() {
            newest.truncate(KEPT - 1);
            newest.insert(0, (config.clone(), sensed.clone()));
        }
        Ok(sensed)
    }

    fn make_sensed(config: &FingertipConfig) -> Result<Sensed, FingertipError> {
        let (layout, projection) = Self::layout_and_projection(config)?;
        let regions = subregions(&layout, &projection, &config.moments)?;
        let size = (projection.width(), projection.height());
        let kernel = MomentsKernel::of_regions(size, &config.moments, &regions)?;
        Ok((kernel, regions))
    }

    /// Position of each element in the camera's image.
    ///
    /// # Errors
    /// If an element is not visible, or a value is invalid.
    pub fn seen_elements(
        config: &FingertipConfig,
    ) -> Result<Vec<ProjectedElement>, FingertipError> {
        let (layout, projection) = Self::layout_and_projection(config)?;
        let seen = |(element, place)| {
            let seen = ProjectedElement::on_dome(&projection, place);
            seen.ok_or_else(|| {
                FingertipError::Moments(MomentsError::OutOfPicture {
                    element,
                    seen_at: "points outside the camera's field of view".into(),
                    width: config.camera.width,
                    height: config.camera.height,
                })
            })
        };
        layout.elements.iter().enumerate().map(seen).collect()
    }

    /// Builds the elements and the projection, without the kernel, which is expensive.
    ///
    /// # Errors
    /// Like [`Self::new`], except for errors of the kernel.
    pub fn layout_and_projection(
        config: &FingertipConfig,
    ) -> Result<(ElementLayout, DomeProjection), FingertipError> {
        let actual = config.layout.element_count();
        if !(1..=MAX_ELEMENTS).contains(&actual) {
            return Err(FingertipError::ElementCount { actual });
        }
        let layout = ElementLayout::new(&config.layout);
        let projection = DomeProjection::new(&config.camera, config.layout.dome_radius)?;
        Ok((layout, projection))
    }
}
