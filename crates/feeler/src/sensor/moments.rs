//! Integrated gray value and centroid of every element's sub-region, straight from the picture.
//!
//! For each element, over the pixels nearer to it than to any other element and within
//! `subregion_radius` of its axis (paper, section II):
//!
//! ```text
//! g = max(pixel - dark_level, 0)      G = sum g w      c = sum g w p / G
//! ```
//!
//! and `g = max(level - pixel, 0)` of dark elements on bright ground,
//! with `p` the pixel in the element's tangent plane and `w` the area it covers there: the dewarp. A
//! symmetric linear smoothing filter would change neither `G` nor `c`, which is why there is none.
//!
//! `w` and `w p` are smooth, so no weight is kept for any pixel. A sub-region is cut into tiles
//! (`tile`), in which integer sums of gray values are taken by whichever instructions the
//! processor has (`avx512`, `avx2`, `sse2`, `neon`, `portable`), and polynomials fitted once (`fit`)
//! say what the sums count for (`sum`).

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
use super::{
    frame::Picture,
    moments_config::{MomentsConfig, MomentsError},
    polarity::Polarity,
    subregion::WeightedPixel,
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

/// Everything about taking moments that does not change from frame to frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MomentsKernel {
    width: usize,
    height: usize,
    polarity: Polarity,
    /// Grey level of the ground of each element.
    levels: Vec<u8>,
    tiles: Vec<Tile>,
    /// For each row of each tile, which of its pixels belong to the sub-region.
    masks: Vec<u64>,
    /// The same, as the grey level that a pixel's is taken off, or of dark elements is taken off: one from where no pixel counts for
    /// each that does not belong.
    grounds: Vec<Row>,
    /// The tiles of each element.
    elements: Vec<Range<usize>>,
    instructions: Instructions,
}

impl MomentsKernel {
    /// The kernel of sub-regions given pixel by pixel, as [`Self::from_subregions`], for elements and ground as `config` has them.
    ///
    /// # Errors
    /// When a pixel lies outside of the picture.
    pub fn of_regions(
        size: (usize, usize),
        config: &MomentsConfig,
        regions: &[Vec<WeightedPixel>],
    ) -> Result<Self, MomentsError> {
        let kernel = Self::from_subregions(size, config.dark_level, regions)?;
        let levels = kernel.levels.clone();
        kernel.with_ground(config.polarity, &levels)
    }

    /// The kernel of sub-regions given pixel by pixel, one list for each element, for pictures of
    /// `(width, height)` px.
    ///
    /// Any weights will do; it is fast for those that change little from pixel to pixel. Every area
    /// is met to 3e-5 of itself, every area times place to 3e-5 of the area times the distance of
    /// the sub-region's farthest pixel.
    ///
    /// # Errors
    /// When a pixel lies outside of the picture.
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
            grounds: Vec::new(),
            elements,
            instructions: Instructions::fastest(),
        };
        kernel.with_ground(Polarity::Bright, &levels)
    }

    /// The same kernel for elements of this `polarity`, on ground of a grey level for each: up to it (of dark elements: from it on) a
    /// pixel does not count.
    ///
    /// # Errors
    /// When there are more or fewer levels than elements.
    pub fn with_ground(self, polarity: Polarity, levels: &[u8]) -> Result<Self, MomentsError> {
        let (expected, actual) = (self.element_count(), levels.len());
        if actual != expected {
            return Err(MomentsError::ElementCount { expected, actual });
        }
        let nothing = match polarity {
            Polarity::Bright => u8::MAX,
            Polarity::Dark => 0,
        };
        let mut grounds = Vec::with_capacity(self.masks.len());
        for (element, &level) in self.elements.iter().zip(levels) {
            for tile in &self.tiles[element.clone()] {
                let masks = &self.masks[tile.first_mask..][..tile.rows];
                grounds.extend(masks.iter().map(|mask| {
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
            grounds,
            ..self
        })
    }

    /// Whether it takes the moments of bright or of dark elements.
    pub fn polarity(&self) -> Polarity {
        self.polarity
    }

    /// The same kernel with other instructions, which give the same moments; for tests and benches.
    ///
    /// Where the processor lacks them, moments are taken in the portable way.
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

    /// Column and row of each pixel that counts for an element, one element after the other.
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

    /// Takes the moments of all elements in `picture`. Neither allocates nor panics.
    ///
    /// # Errors
    /// When the picture or `moments` has another size than the kernel.
    pub fn measure<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
        moments: &mut [ElementMoments],
    ) -> Result<(), MomentsError> {
        self.measure_ahead(picture, &[], moments)
    }

    /// As [`Self::measure`], while the pixels of the `next` picture come into the cache: worth it where pictures wait in memory one after
    /// the other. Which `next` is given changes no result.
    ///
    /// # Errors
    /// As [`Self::measure`].
    pub fn measure_ahead<P: AsRef<[u8]>>(
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
