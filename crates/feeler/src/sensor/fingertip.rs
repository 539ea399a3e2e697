//! All that makes one fingertip's gray values what they are: what a calibration belongs to.

use super::{
    dome::{CameraConfig, DomeError, DomeProjection},
    layout::{ElementLayout, LayoutConfig, MAX_ELEMENTS},
    moments::MomentsKernel,
    moments_config::{MomentsConfig, MomentsError},
    seen::SeenElement,
    subregion::{WeightedPixel, subregions},
};
use crate::check::Checker;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, PoisonError};

/// One optical fingertip: its elements, its camera, and how moments are taken of the picture.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FingertipConfig {
    /// Where the sensing elements sit.
    pub layout: LayoutConfig,
    /// The camera inside the dome.
    pub camera: CameraConfig,
    /// How moments are taken.
    pub moments: MomentsConfig,
}

impl FingertipConfig {
    /// Requires every value of the table `key` to be in its range. What the camera sees is found out where it is built.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        self.layout.check(&format!("{key}.layout"), checker);
        let dome_radius = self.layout.dome_radius;
        self.moments
            .check(&format!("{key}.moments"), dome_radius, checker);
    }
}

/// Why a fingertip cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FingertipError {
    /// There are no elements, or more than fit on a fingertip.
    #[error("a fingertip must have 1 to {MAX_ELEMENTS} elements, got {actual}")]
    ElementCount {
        /// How many the rings have.
        actual: usize,
    },
    /// The camera cannot look at the dome.
    #[error(transparent)]
    Dome(#[from] DomeError),
    /// Moments cannot be taken.
    #[error(transparent)]
    Moments(#[from] MomentsError),
}

/// Kernels that are kept, of some 5 MB each.
const KEPT: usize = 2;

/// A kernel, and the pixels of each element.
type Sensed = (MomentsKernel, Vec<Vec<WeightedPixel>>);

/// A [`FingertipConfig`] turned into what sensing needs; it never changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Fingertip {
    /// The sensing elements.
    pub layout: ElementLayout,
    /// Between the dome and the picture.
    pub projection: DomeProjection,
    /// From a picture to moments.
    pub kernel: MomentsKernel,
}

impl Fingertip {
    /// Builds the fingertip that `config` describes.
    ///
    /// # Errors
    /// When the camera does not see all sub-regions, or a value makes no sense.
    pub fn new(config: &FingertipConfig) -> Result<Self, FingertipError> {
        let (layout, projection) = Self::layout_and_projection(config)?;
        Ok(Self {
            layout,
            projection,
            kernel: Self::sensed(config)?.0.clone(),
        })
    }

    /// The kernel of the fingertip, and the pixels of each element that it was made of.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn kernel_and_subregions(config: &FingertipConfig) -> Result<Sensed, FingertipError> {
        Ok(Self::sensed(config)?.as_ref().clone())
    }

    /// The same. It takes some 60 ms to make, so that the newest ones are kept: a rig's fingertips are mostly alike, and a sweep's trials
    /// ask for the same again and again.
    fn sensed(config: &FingertipConfig) -> Result<Arc<Sensed>, FingertipError> {
        static NEWEST: Mutex<Vec<(FingertipConfig, Arc<Sensed>)>> = Mutex::new(Vec::new());
        // What is kept is whole, whatever a thread did that had it.
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
        // Another thread may have made it, too.
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

    /// Where the camera sees each element.
    ///
    /// # Errors
    /// When it does not see one, or a value makes no sense.
    pub fn seen_elements(config: &FingertipConfig) -> Result<Vec<SeenElement>, FingertipError> {
        let (layout, projection) = Self::layout_and_projection(config)?;
        let seen = |(element, place)| {
            let seen = SeenElement::on_dome(&projection, layout.dome_radius, place);
            seen.ok_or_else(|| {
                FingertipError::Moments(MomentsError::OutOfPicture {
                    element,
                    seen_at: "where the camera sees nothing".into(),
                    width: config.camera.width,
                    height: config.camera.height,
                })
            })
        };
        layout.elements.iter().enumerate().map(seen).collect()
    }

    /// The part of the fingertip that takes no time to build: all but the kernel.
    ///
    /// # Errors
    /// As [`Self::new`], but for what the kernel finds.
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
