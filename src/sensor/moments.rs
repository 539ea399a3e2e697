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
    moments_config::{MomentsConfig, MomentsError},
    subregion::{WeightedPixel, subregion},
};
use glam::DVec2;
use std::ops::Range;

/// What the picture says about one element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementMoments {
    /// Integrated gray value G, grey levels times m².
    pub integrated_gray: f64,
    /// Centroid of the gray values in x, y of the element's frame `E_i`, m; zero in the dark.
    pub centroid: DVec2,
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
    /// The kernel of the elements of `layout` as `projection` sees them, dewarped.
    ///
    /// # Errors
    /// When a sub-region is not wholly in the picture, or its radius makes no sense.
    pub fn new(
        layout: &ElementLayout,
        projection: &DomeProjection,
        config: &MomentsConfig,
    ) -> Result<Self, MomentsError> {
        let radius = config.subregion_radius;
        if !(radius > 0.0 && radius < layout.dome_radius) {
            return Err(MomentsError::Radius {
                radius,
                dome_radius: layout.dome_radius,
            });
        }
        let regions = (0..layout.elements.len())
            .map(|element| subregion(layout, projection, element, radius))
            .collect::<Result<Vec<_>, _>>()?;
        let size = (projection.width(), projection.height());
        Self::from_subregions(size, config.dark_level, &regions)
    }

    /// The kernel of sub-regions given pixel by pixel, one list for each element, each sorted by
    /// row and then by column, for pictures of `(width, height)` px.
    ///
    /// # Errors
    /// When the picture is too small to hold anything, or a pixel lies outside of it.
    pub fn from_subregions(
        (width, height): (usize, usize),
        dark_level: u8,
        regions: &[Vec<WeightedPixel>],
    ) -> Result<Self, MomentsError> {
        if width * height < LANES {
            return Err(MomentsError::TooFewPixels {
                pixels: width * height,
            });
        }
        let mut kernel = Self {
            width,
            height,
            dark_level: f32::from(dark_level),
            groups: Vec::new(),
            elements: Vec::with_capacity(regions.len()),
        };
        for (element, region) in regions.iter().enumerate() {
            let first = kernel.groups.len();
            for pixel in region {
                let (column, row) = (pixel.column, pixel.row);
                if column >= width || row >= height {
                    let seen_at = format!("column {column}, row {row}");
                    return Err(MomentsError::OutOfPicture {
                        element,
                        seen_at,
                        width,
                        height,
                    });
                }
                kernel.add(first, pixel);
            }
            kernel.elements.push(first..kernel.groups.len());
        }
        Ok(kernel)
    }

    /// Adds a pixel to the last group, or to a new one if that does not reach to it or belongs to
    /// an element before, whose groups end at `first`.
    fn add(&mut self, first: usize, pixel: &WeightedPixel) {
        let offset = pixel.row * self.width + pixel.column;
        let reached = self.groups[first..]
            .last()
            .is_some_and(|group| (group.offset..group.offset + LANES).contains(&offset));
        if !reached {
            self.groups.push(PixelGroup {
                offset: offset.min(self.width * self.height - LANES),
                area: [0.0; LANES],
                area_x: [0.0; LANES],
                area_y: [0.0; LANES],
            });
        }
        if let Some(group) = self.groups.last_mut() {
            let lane = offset - group.offset;
            group.area[lane] = pixel.area as f32;
            group.area_x[lane] = (pixel.area * pixel.point.x) as f32;
            group.area_y[lane] = (pixel.area * pixel.point.y) as f32;
        }
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
