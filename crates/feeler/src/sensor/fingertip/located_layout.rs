//! The layout file: sensing elements located in an image.

mod check;
mod error;
mod rings;

pub use error::LayoutError;

use super::dome::{CameraConfig, DomeProjection};
use super::layout::SensingElement;
use super::made_for::sha256;
use crate::sensor::image::exposure::DEFAULT_MAX_SATURATED;
use crate::sensor::image::polarity::Polarity;
use crate::sensor::image::seen::ProjectedElement;
use crate::sensor::image::subregion::WeightedPixel;
use crate::sensor::locate::{Located, LocatedElement, sub_regions};
use crate::sensor::moments::kernel::MomentsKernel;
use glam::{DMat3, DVec2, DVec3};
use rings::sort_into_rings;
use serde::{Deserialize, Serialize};

/// Version of the layout file format.
pub const LAYOUT_VERSION: u32 = 1;

/// Maximum number of elements of a located layout.
pub const MAX_LOCATED_ELEMENTS: usize = 4096;

/// The dome and the camera in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DomeGeometry {
    /// Radius of the sphere on which the tips of the unloaded elements lie, m.
    pub radius: f64,
    /// Camera inside the dome.
    pub camera: CameraConfig,
}

/// One sensing element of a layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementPlace {
    /// Column and row of the centre, px.
    pub centre_px: DVec2,
    /// Radius of the sub-region, px; where two overlap, a pixel belongs to the nearer centre.
    pub radius_px: f64,
    /// Direction of the element from the dome's centre, a unit vector in the fingertip frame `T`; `None` if the dome
    /// is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<DVec3>,
    /// Ring, 0 innermost; `None` if the dome is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ring: Option<usize>,
    /// Gray level that separates the element from the background; `None` if it is the common
    /// [`LocatedLayout::dark_level`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_level: Option<u8>,
}

/// Sensing elements of a fingertip as located in an image of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LocatedLayout {
    /// Version of the file format, [`LAYOUT_VERSION`].
    pub version: u32,
    /// Columns of the image, px.
    pub width: usize,
    /// Rows of the image, px.
    pub height: usize,
    /// Polarity of the elements: bright on dark or dark on bright.
    #[serde(default, skip_serializing_if = "Polarity::is_bright")]
    pub polarity: Polarity,
    /// `true` if the camera's images have only two levels, black and white. Moments then count pixels, and saturation
    /// cannot be detected.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub two_level: bool,
    /// Gray level that separates elements from the background, for elements without [`ElementPlace::ground_level`].
    /// Pixels at or below it (for dark elements: at or above it) belong to the background.
    pub dark_level: u8,
    /// Diameter of a spot, px, if each element consists of one spot; used for tracking markers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spot_diameter_px: Option<f64>,
    /// The dome and its camera, if known. Moments are then computed in m, in each element's tangent plane, otherwise
    /// in px.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dome: Option<DomeGeometry>,
    /// The sensing elements.
    #[serde(rename = "element")]
    pub elements: Vec<ElementPlace>,
}

/// Fields needed to read only the version, to distinguish a file of another version from an invalid file.
#[derive(Deserialize)]
struct VersionOnly {
    version: u32,
}

impl LocatedLayout {
    /// Creates a layout in the image plane from located elements.
    pub fn new(located: &Located) -> Self {
        let place = |element: &LocatedElement| ElementPlace {
            centre_px: rounded(element.centre_px),
            radius_px: round(element.radius_px),
            direction: None,
            ring: None,
            ground_level: Some(element.ground_level).filter(|&l| l != located.dark_level),
        };
        Self {
            version: LAYOUT_VERSION,
            width: located.size.0,
            height: located.size.1,
            polarity: located.polarity,
            two_level: located.two_level,
            dark_level: located.dark_level,
            spot_diameter_px: (located.spots_per_element == 1)
                .then(|| round(located.spot_area_diameter_px)),
            dome: None,
            elements: located.elements.iter().map(place).collect(),
        }
    }

    /// Creates a layout on a dome from located elements. The direction of an element is the mean of its spots'
    /// positions on the sphere. Elements are sorted by ring and by azimuth about the dome's axis, from y of `T`
    /// towards z of `T`.
    ///
    /// # Errors
    /// If the dome is invalid, its camera has another image size, or an element lies outside the dome.
    pub fn on_dome(located: &Located, dome: DomeGeometry) -> Result<Self, LayoutError> {
        let projection = DomeProjection::new(&dome.camera, dome.radius)?;
        let mut layout = Self::new(located);
        layout.check_camera(&dome)?;
        for (element, (place, seen)) in layout
            .elements
            .iter_mut()
            .zip(&located.elements)
            .enumerate()
        {
            let on_dome = || {
                let points = seen.spots_px.iter().map(|&spot| projection.point_at(spot));
                let sum = points.sum::<Option<DVec3>>()?;
                let direction = sum.try_normalize()?;
                Some((direction, projection.project(dome.radius * direction)?))
            };
            let (direction, centre) = on_dome().ok_or(LayoutError::OffDome {
                element,
                column: seen.centre_px.x,
                row: seen.centre_px.y,
            })?;
            place.direction = Some(direction);
            place.centre_px = rounded(centre);
        }
        sort_into_rings(&mut layout.elements);
        layout.dome = Some(dome);
        layout.check()?;
        Ok(layout)
    }

    /// Parses a layout file.
    ///
    /// # Errors
    /// If the text is not a layout of this version, or contains an invalid value.
    pub fn from_toml(text: &str) -> Result<Self, LayoutError> {
        let VersionOnly { version } = toml::from_str(text)?;
        if version != LAYOUT_VERSION {
            return Err(LayoutError::Version { actual: version });
        }
        let layout: Self = toml::from_str(text)?;
        layout.check()?;
        Ok(layout)
    }

    /// Formats the layout as a file.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn to_toml(&self) -> Result<String, LayoutError> {
        Ok(toml::to_string(self)?)
    }

    /// Identifies the layout in calibrations: SHA-256 of all values that affect moments, as 64 hexadecimal digits.
    /// Comments and the order of keys in the file do not matter.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn hash(&self) -> Result<String, LayoutError> {
        Ok(sha256(&self.to_toml()?))
    }

    /// Kernel of the layout's moments. Lengths are in m in the tangent plane of each element if the dome is known,
    /// otherwise in px from each element's centre, with an area of 1 px² per pixel.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn kernel(&self) -> Result<MomentsKernel, LayoutError> {
        self.check()?;
        let size = (self.width, self.height);
        let regions = self.weighted_pixels()?;
        let kernel = MomentsKernel::from_subregions(size, self.dark_level, &regions)?;
        let level = |element: &ElementPlace| element.ground_level.unwrap_or(self.dark_level);
        let levels: Vec<u8> = self.elements.iter().map(level).collect();
        Ok(kernel.with_background(self.polarity, &levels)?)
    }

    /// Projection of the dome's camera; `None` if the dome is unknown.
    fn projection(&self) -> Result<Option<DomeProjection>, LayoutError> {
        let dome = self.dome.as_ref();
        let projection = dome.map(|dome| DomeProjection::new(&dome.camera, dome.radius));
        Ok(projection.transpose()?)
    }

    /// Position of each element in the image, and orientation of its frame there (along the image's axes if the dome
    /// is unknown).
    ///
    /// # Errors
    /// If the dome is invalid, or an element is outside the camera's view.
    pub fn seen_elements(&self) -> Result<Vec<ProjectedElement>, LayoutError> {
        let projection = self.projection()?;
        let seen = |(element, place): (usize, &ElementPlace)| {
            let centre_px = place.centre_px;
            let Some((projection, direction)) = projection.as_ref().zip(place.direction) else {
                let x_angle = 0.0;
                return Ok(ProjectedElement { centre_px, x_angle });
            };
            let frame = SensingElement::facing(direction);
            let seen = ProjectedElement::on_dome(projection, &frame);
            let (column, row) = (centre_px.x, centre_px.y);
            seen.map(|seen| ProjectedElement { centre_px, ..seen })
                .ok_or(LayoutError::OffDome {
                    element,
                    column,
                    row,
                })
        };
        self.elements.iter().enumerate().map(seen).collect()
    }

    /// Rotation of each element's frame `E_i` relative to the fingertip frame `T` if the dome is known. Otherwise the
    /// identity, because element frames are then parallel to the image (x to the right, y down, z away from the
    /// camera).
    pub fn element_frames(&self) -> Vec<DMat3> {
        let frame = |place: &ElementPlace| match (&self.dome, place.direction) {
            (Some(_), Some(direction)) => SensingElement::facing(direction).rotation,
            _ => DMat3::IDENTITY,
        };
        self.elements.iter().map(frame).collect()
    }

    /// Default maximum fraction of saturated pixels in a sub-region with valid moments.
    pub fn max_saturated(&self) -> f64 {
        match self.polarity {
            // White pins are saturated in a two-level image; only an entirely white region is invalid.
            Polarity::Bright if self.two_level => 0.98,
            Polarity::Bright => DEFAULT_MAX_SATURATED,
            // Markers may be black; only an entirely black region is invalid.
            Polarity::Dark => 0.9,
        }
    }

    /// Pixels of each element's sub-region with their weights.
    ///
    /// # Errors
    /// If the dome is invalid.
    pub fn weighted_pixels(&self) -> Result<Vec<Vec<WeightedPixel>>, LayoutError> {
        let discs: Vec<(DVec2, f64)> = self
            .elements
            .iter()
            .map(|e| (e.centre_px, e.radius_px))
            .collect();
        let projection = self.projection()?;
        let regions = sub_regions((self.width, self.height), &discs);
        let weighted = |(place, region): (&ElementPlace, Vec<(usize, usize)>)| {
            let frame = place.direction.map(SensingElement::facing);
            let dome = projection.as_ref().zip(frame.as_ref());
            let pixels = region.into_iter();
            pixels
                .filter_map(|pixel| weighted_pixel(place, dome, pixel))
                .collect()
        };
        Ok(self.elements.iter().zip(regions).map(weighted).collect())
    }
}

/// Rounds to a ten-thousandth of a pixel, finer than the accuracy of located centres.
fn round(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

fn rounded(place: DVec2) -> DVec2 {
    DVec2::new(round(place.x), round(place.y)).max(DVec2::ZERO)
}

fn weighted_pixel(
    place: &ElementPlace,
    dome: Option<(&DomeProjection, &SensingElement)>,
    (column, row): (usize, usize),
) -> Option<WeightedPixel> {
    let pixel = DVec2::new(column as f64, row as f64);
    let (area, point) = match dome {
        None => (1.0, pixel - place.centre_px),
        Some((projection, element)) => {
            let dewarped = projection.dewarp(pixel, element)?;
            (dewarped.area, dewarped.point)
        }
    };
    Some(WeightedPixel {
        column,
        row,
        area,
        point,
    })
}
