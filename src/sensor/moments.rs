//! Integrated gray value and centroid of every element's sub-region, straight from the picture.
//!
//! For each element, over the pixels nearer to it than to any other element and within
//! `subregion_radius` of its axis (paper, section II):
//!
//! ```text
//! g = max(pixel - dark_level, 0)      G = sum g w      c = sum g w p / G
//! ```
//!
//! with `p` the pixel in the element's tangent plane and `w` the area it covers there. Both are
//! computed once, so that dewarping costs nothing per frame. A symmetric linear smoothing filter
//! would change neither `G` nor `c`, which is why there is none.

use super::{
    dome::DomeProjection,
    frame::Picture,
    layout::ElementLayout,
    subregion::{bounding_box, own_pixel},
};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// How the moments of a sub-region are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MomentsConfig {
    /// Grey level up to which a pixel counts as dark; a little above the background, so that its
    /// noise does not reach the sums (assumed).
    pub dark_level: u8,
    /// Radius of an element's sub-region about the element's axis, m (assumed: half the pitch of
    /// the outermost ring, so that sub-regions just do not overlap).
    pub subregion_radius: f64,
}

impl Default for MomentsConfig {
    fn default() -> Self {
        Self {
            dark_level: 24,
            subregion_radius: 2.6e-3,
        }
    }
}

/// What the picture says about one element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementMoments {
    /// Integrated gray value G, grey levels times m².
    pub integrated_gray: f64,
    /// Centroid of the gray values in x, y of the element's frame `E_i`, m; zero in the dark.
    pub centroid: DVec2,
}

/// Why moments cannot be taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MomentsError {
    /// The sub-region's radius is useless.
    #[error(
        "subregion_radius must lie between 0 and the dome's radius {dome_radius} m, got {radius} m"
    )]
    Radius {
        /// What it was, m.
        radius: f64,
        /// Radius of the dome, m.
        dome_radius: f64,
    },
    /// An element's sub-region reaches beyond the picture.
    #[error(
        "the sub-region of element {element} reaches {seen_at}, beyond the {width}x{height} px of the picture"
    )]
    OutOfPicture {
        /// Index of the element.
        element: usize,
        /// Column and row, px, or that it is not seen at all.
        seen_at: String,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
    },
    /// The picture is too small to hold anything.
    #[error("the picture must have at least {LANES} px, got {pixels} px")]
    TooFewPixels {
        /// Pixels of the picture.
        pixels: usize,
    },
    /// A picture has another size than the kernel was built for.
    #[error(
        "moments are taken of {expected_width}x{expected_height} px, the picture has {width}x{height} px in {pixels} values"
    )]
    PictureSize {
        /// Columns that the kernel was built for, px.
        expected_width: usize,
        /// Rows that the kernel was built for, px.
        expected_height: usize,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
        /// Gray values in the picture.
        pixels: usize,
    },
    /// The place for the moments is for another number of elements.
    #[error("the kernel has {expected} elements, the moments to fill have {actual}")]
    ElementCount {
        /// Elements of the kernel.
        expected: usize,
        /// Elements of the moments to fill.
        actual: usize,
    },
}

/// Pixels that are summed side by side. It is part of the result: sums are taken lane by lane, in
/// the same order on every machine.
const LANES: usize = 8;

/// [`LANES`] neighbouring pixels of one sub-region and their weights.
#[derive(Debug, Clone, PartialEq)]
struct PixelGroup {
    /// Where in the picture the first one is.
    offset: usize,
    /// Area `w`, m²; zero for a pixel outside the sub-region.
    area: [f32; LANES],
    /// `w` times x of the pixel in `E_i`, m³.
    area_x: [f32; LANES],
    /// `w` times y of the pixel in `E_i`, m³.
    area_y: [f32; LANES],
}

/// Everything about taking moments that does not change from frame to frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MomentsKernel {
    width: usize,
    height: usize,
    dark_level: f32,
    groups: Vec<PixelGroup>,
    /// The groups of each element.
    elements: Vec<Range<usize>>,
}

impl MomentsKernel {
    /// Finds each element's pixels and their weights.
    ///
    /// # Errors
    /// When a sub-region is not wholly in the picture, or its radius makes no sense.
    pub fn new(
        layout: &ElementLayout,
        projection: &DomeProjection,
        config: &MomentsConfig,
    ) -> Result<Self, MomentsError> {
        let (width, height) = (projection.width(), projection.height());
        let radius = config.subregion_radius;
        if !(radius > 0.0 && radius < layout.dome_radius) {
            return Err(MomentsError::Radius {
                radius,
                dome_radius: layout.dome_radius,
            });
        }
        if width * height < LANES {
            return Err(MomentsError::TooFewPixels {
                pixels: width * height,
            });
        }
        let mut kernel = Self {
            width,
            height,
            dark_level: f32::from(config.dark_level),
            groups: Vec::new(),
            elements: Vec::with_capacity(layout.elements.len()),
        };
        for element in 0..layout.elements.len() {
            let first = kernel.groups.len();
            let (columns, rows) = bounding_box(layout, projection, element, radius)?;
            for row in rows {
                kernel.add_row(layout, projection, element, radius, columns.clone(), row);
            }
            kernel.elements.push(first..kernel.groups.len());
        }
        Ok(kernel)
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.elements.len()
    }

    /// Takes the moments of all elements in `picture`. Neither allocates nor panics.
    ///
    /// # Errors
    /// When the picture or `moments` has another size than the kernel.
    pub fn measure(
        &self,
        picture: &Picture,
        moments: &mut [ElementMoments],
    ) -> Result<(), MomentsError> {
        if moments.len() != self.elements.len() {
            return Err(MomentsError::ElementCount {
                expected: self.elements.len(),
                actual: moments.len(),
            });
        }
        let (width, height) = (picture.width, picture.height);
        let pixels = picture.pixels.len();
        if (width, height, pixels) != (self.width, self.height, self.width * self.height) {
            return Err(MomentsError::PictureSize {
                expected_width: self.width,
                expected_height: self.height,
                width,
                height,
                pixels,
            });
        }
        for (moments, range) in moments.iter_mut().zip(&self.elements) {
            let groups = self.groups.get(range.clone()).unwrap_or(&[]);
            *moments = element_moments(groups, &picture.pixels, self.dark_level);
        }
        Ok(())
    }

    /// Adds the pixels of one row that belong to `element`.
    fn add_row(
        &mut self,
        layout: &ElementLayout,
        projection: &DomeProjection,
        element: usize,
        radius: f64,
        columns: Range<usize>,
        row: usize,
    ) {
        let last_offset = self.width * self.height - LANES;
        let mut next_column = columns.start;
        for column in columns {
            let pixel = DVec2::new(column as f64, row as f64);
            let Some((area, point)) = own_pixel(layout, projection, element, radius, pixel) else {
                continue;
            };
            let offset = row * self.width + column;
            if column >= next_column {
                self.groups.push(PixelGroup {
                    offset: offset.min(last_offset),
                    area: [0.0; LANES],
                    area_x: [0.0; LANES],
                    area_y: [0.0; LANES],
                });
                next_column = column + LANES;
            }
            if let Some(group) = self.groups.last_mut() {
                let lane = offset - group.offset;
                group.area[lane] = area as f32;
                group.area_x[lane] = (area * point.x) as f32;
                group.area_y[lane] = (area * point.y) as f32;
            }
        }
    }
}

/// Sums one element's groups lane by lane: gray, gray times x, gray times y.
///
/// Kept apart from what is made of the sums, which would tempt the compiler to pair x with y instead
/// of lane with lane.
#[inline(never)]
fn sum_groups(groups: &[PixelGroup], pixels: &[u8], dark_level: f32) -> [[f32; LANES]; 3] {
    let mut gray = [0.0; LANES];
    let mut gray_x = [0.0; LANES];
    let mut gray_y = [0.0; LANES];
    for group in groups {
        let Some(pixels) = pixels
            .get(group.offset..)
            .and_then(|p| p.first_chunk::<LANES>())
        else {
            continue;
        };
        let bright = pixels.map(|pixel| {
            let above = f32::from(pixel) - dark_level;
            if above > 0.0 { above } else { 0.0 }
        });
        add_products(&mut gray, &bright, &group.area);
        add_products(&mut gray_x, &bright, &group.area_x);
        add_products(&mut gray_y, &bright, &group.area_y);
    }
    [gray, gray_x, gray_y]
}

#[inline(always)]
fn add_products(sums: &mut [f32; LANES], a: &[f32; LANES], b: &[f32; LANES]) {
    for lane in 0..LANES {
        sums[lane] += a[lane] * b[lane];
    }
}

/// Moments of one element's groups; the lanes are added up in `f64`.
fn element_moments(groups: &[PixelGroup], pixels: &[u8], dark_level: f32) -> ElementMoments {
    let lanes = sum_groups(groups, pixels, dark_level);
    let [integrated_gray, x, y] =
        lanes.map(|lanes| lanes.iter().map(|&v| f64::from(v)).sum::<f64>());
    ElementMoments {
        integrated_gray,
        centroid: if integrated_gray > 0.0 {
            DVec2::new(x, y) / integrated_gray
        } else {
            DVec2::ZERO
        },
    }
}
