//! Integrated gray value and centroid of every element's sub-region, computed directly from the image.
//!
//! For each element, over the pixels nearer to it than to any other element and within `subregion_radius` of its axis
//! (paper, section II):
//!
//! ```text
//! g = max(pixel - dark_level, 0)      G = sum g w      c = sum g w p / G
//! ```
//!
//! For dark elements on a bright background, `g = max(level - pixel, 0)`. `p` is the position of the pixel in the
//! element's tangent plane and `w` the area that it covers there (dewarping). A symmetric linear smoothing filter
//! would change neither `G` nor `c` and is omitted.
//!
//! `w` and `w p` are smooth, so no weights are stored per pixel. A sub-region is divided into tiles (`tile`). In each
//! tile, integer sums of gray values are computed with the best available instructions (`avx512`, `avx2`, `sse2`,
//! `neon`, `portable`). Polynomials fitted once (`fit`) are the weights of these sums in the moments (`sum`).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod fit;
mod instructions;
#[cfg(all(target_arch = "aarch64", target_endian = "little"))]
mod neon;
mod portable;
#[cfg(target_arch = "x86_64")]
mod sse2;
mod sum;
mod tile;

pub use instructions::Instructions;

use self::{
    fit::Tiling,
    tile::{Row, TILE_WIDTH, Tile},
};
use super::config::{MomentsConfig, MomentsError};
use crate::sensor::image::frame::Picture;
use crate::sensor::image::polarity::Polarity;
use crate::sensor::image::subregion::WeightedPixel;
use glam::DVec2;
use std::ops::Range;

/// Moments of one element in an image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementMoments {
    /// Integrated gray value G, gray levels times m².
    pub integrated_gray: f64,
    /// Centroid of the gray values in x, y of the element's frame `E_i`, m; zero if the element is dark.
    pub centroid: DVec2,
}

/// Precomputed data for computing moments.
#[derive(Debug, Clone, PartialEq)]
pub struct MomentsKernel {
    width: usize,
    height: usize,
    polarity: Polarity,
    /// Background gray level of each element.
    levels: Vec<u8>,
    tiles: Vec<Tile>,
    /// Bit mask of the pixels that belong to the sub-region, for each row of each tile.
    masks: Vec<u64>,
    /// Background level of each pixel of each row. Pixels outside the sub-region have a level at which they contribute
    /// zero.
    backgrounds: Vec<Row>,
    /// Range of tiles of each element.
    elements: Vec<Range<usize>>,
    instructions: Instructions,
}

impl MomentsKernel {
    /// Creates a kernel like [`Self::from_subregions`], with the polarity and background level of `config`.
    ///
    /// # Errors
    /// If a pixel lies outside the image.
    pub fn of_regions(
        size: (usize, usize),
        config: &MomentsConfig,
        regions: &[Vec<WeightedPixel>],
    ) -> Result<Self, MomentsError> {
        let kernel = Self::from_subregions(size, config.dark_level, regions)?;
        let levels = kernel.levels.clone();
        kernel.with_background(config.polarity, &levels)
    }

    /// Creates a kernel of sub-regions, given as one list of pixels per element, for images of `(width, height)` px.
    ///
    /// Any weights are allowed; the kernel is fastest if they vary slowly from pixel to pixel. The relative error of
    /// every pixel's area is at most 3e-5. The error of its area times position is at most 3e-5 of the area times the
    /// distance of the sub-region's farthest pixel.
    ///
    /// # Errors
    /// If a pixel lies outside the image.
    pub fn from_subregions(
        (width, height): (usize, usize),
        dark_level: u8,
        regions: &[Vec<WeightedPixel>],
    ) -> Result<Self, MomentsError> {
        let mut tiling = Tiling::default();
        let mut elements = Vec::with_capacity(regions.len());
        for (element, region) in regions.iter().enumerate() {
            let inside = |pixel: &&WeightedPixel| pixel.column < width && pixel.row < height;
            if let Some(pixel) = region.iter().find(|pixel| !inside(pixel)) {
                return Err(MomentsError::OutOfPicture {
                    element,
                    seen_at: format!("column {}, row {}", pixel.column, pixel.row),
                    width,
                    height,
                });
            }
            let first = tiling.tiles.len();
            tiling.add(region, width);
            elements.push(first..tiling.tiles.len());
        }
        let levels = vec![dark_level; elements.len()];
        let kernel = Self {
            width,
            height,
            polarity: Polarity::Bright,
            levels: Vec::new(),
            tiles: tiling.tiles,
            masks: tiling.masks,
            backgrounds: Vec::new(),
            elements,
            instructions: Instructions::fastest(),
        };
        kernel.with_background(Polarity::Bright, &levels)
    }

    /// Returns the kernel with another `polarity` and a background level for each element. Pixels at or below the
    /// level (for dark elements: at or above) are ignored.
    ///
    /// # Errors
    /// If the number of levels differs from the number of elements.
    pub fn with_background(self, polarity: Polarity, levels: &[u8]) -> Result<Self, MomentsError> {
        let (expected, actual) = (self.element_count(), levels.len());
        if actual != expected {
            return Err(MomentsError::ElementCount { expected, actual });
        }
        let nothing = match polarity {
            Polarity::Bright => u8::MAX,
            Polarity::Dark => 0,
        };
        let mut backgrounds = Vec::with_capacity(self.masks.len());
        for (element, &level) in self.elements.iter().zip(levels) {
            for tile in &self.tiles[element.clone()] {
                let masks = &self.masks[tile.first_mask..][..tile.rows];
                backgrounds.extend(masks.iter().map(|mask| {
                    let own = |column| mask >> column & 1 == 1;
                    Row(std::array::from_fn(|column| {
                        if own(column) { level } else { nothing }
                    }))
                }));
            }
        }
        Ok(Self {
            polarity,
            levels: levels.to_vec(),
            backgrounds,
            ..self
        })
    }

    /// Polarity of the elements.
    pub fn polarity(&self) -> Polarity {
        self.polarity
    }

    /// Returns the kernel with other instructions, which give bit-identical moments; for tests and benchmarks.
    ///
    /// If the processor lacks them, the portable implementation is used.
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self {
            instructions,
            ..self
        }
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.elements.len()
    }

    /// Column and row of every pixel that belongs to a sub-region, element by element.
    pub fn pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        let width = self.width;
        let rows = self.tiles.iter().flat_map(move |tile| {
            let masks = self.masks[tile.first_mask..].iter().take(tile.rows);
            masks.enumerate().map(move |(row, mask)| (tile, row, mask))
        });
        rows.flat_map(move |(tile, row, mask)| {
            let own = (0..TILE_WIDTH).filter(move |column| mask >> column & 1 == 1);
            let pixels = own.map(move |column| tile.pixel(row, column, width));
            pixels.map(move |pixel| (pixel % width, pixel / width))
        })
    }

    /// Computes the moments of all elements in `picture`. Neither allocates nor panics.
    ///
    /// # Errors
    /// If the size of the image or the length of `moments` does not match the kernel.
    pub fn measure<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
        moments: &mut [ElementMoments],
    ) -> Result<(), MomentsError> {
        self.measure_with_prefetch(picture, &[], moments)
    }

    /// Like [`Self::measure`], but prefetches the pixels of the `next` image into the cache. This is faster if images
    /// are processed one after the other from memory. `next` does not affect the results.
    ///
    /// # Errors
    /// Like [`Self::measure`].
    pub fn measure_with_prefetch<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
        next: &[u8],
        moments: &mut [ElementMoments],
    ) -> Result<(), MomentsError> {
        if moments.len() != self.elements.len() {
            return Err(MomentsError::ElementCount {
                expected: self.elements.len(),
                actual: moments.len(),
            });
        }
        let (width, height) = (picture.width, picture.height);
        let gray = picture.pixels.as_ref();
        let pixels = gray.len();
        if (width, height, pixels) != (self.width, self.height, self.width * self.height) {
            return Err(MomentsError::PictureSize {
                expected_width: self.width,
                expected_height: self.height,
                width,
                height,
                pixels,
            });
        }
        self.instructions.measure(self, gray, next, moments);
        Ok(())
    }
}
