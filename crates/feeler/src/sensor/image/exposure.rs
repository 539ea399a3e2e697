//! Detection of sub-regions that are too dark or saturated for valid moments.

use super::{frame::Picture, subregion::WeightedPixel};
use multiversion::multiversion;

/// Gray value of a saturated pixel, which only means "at least this bright".
pub const SATURATED: u8 = 255;

/// Default maximum fraction of saturated pixels in a sub-region with valid moments. A few hot pixels are harmless. The
/// bright spots of an unloaded element fill several percent of its sub-region.
pub const DEFAULT_MAX_SATURATED: f64 = 0.01;

/// Exposure of a sub-region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Exposure {
    /// The moments are valid.
    #[default]
    Good,
    /// No pixel is above the dark level, so there is no centroid.
    Dark,
    /// Too many pixels are saturated, so the integrated gray value is too small. For dark elements: too many pixels
    /// are black.
    Saturated,
}

/// Counts the saturated pixels of each element.
#[derive(Debug, Clone, PartialEq)]
pub struct SaturationCheck {
    elements: Vec<Region>,
    /// Gray value that counts as saturated.
    limit: u8,
}

#[derive(Debug, Clone, PartialEq)]
struct Region {
    /// First pixel and length of each contiguous span of a row.
    spans: Vec<(usize, usize)>,
    /// Start of each block of pixels. The blocks cover all spans, may overlap, and may include pixels outside the
    /// region.
    blocks: Vec<usize>,
    /// Maximum number of saturated pixels allowed.
    allowed: usize,
}

/// Number of pixels compared at once.
const BLOCK: usize = 32;

impl Region {
    fn new(width: usize, pixels: &[WeightedPixel], max_saturated: f64) -> Self {
        let spans = spans(width, pixels);
        let blocks_of = |&(start, length): &(usize, usize)| {
            let last = (start + length).saturating_sub(BLOCK);
            let starts = (start..start + length).step_by(BLOCK);
            starts.map(move |start| start.min(last))
        };
        Self {
            blocks: spans.iter().flat_map(blocks_of).collect(),
            spans,
            allowed: (max_saturated.clamp(0.0, 1.0) * pixels.len() as f64) as usize,
        }
    }

    /// Exact number of saturated pixels.
    fn count(&self, pixels: &[u8], limit: u8) -> usize {
        let of_span = |&(start, length): &(usize, usize)| {
            let pixels = pixels.get(start..start + length).unwrap_or(&[]);
            pixels.iter().filter(|&&pixel| pixel == limit).count()
        };
        self.spans.iter().map(of_span).sum()
    }
}

/// Upper bound of the number of saturated pixels in `blocks`. Faster than the exact count; uses the widest available
/// vector instructions.
#[multiversion(targets("x86_64+avx2"))]
fn at_most(blocks: &[usize], pixels: &[u8], limit: u8) -> usize {
    let mut count = 0;
    // Each lane is a byte: at most 255 blocks do not overflow it.
    for blocks in blocks.chunks(255) {
        let mut lanes = [0_u8; BLOCK];
        for &start in blocks {
            let Some(block) = pixels.get(start..).and_then(|p| p.first_chunk::<BLOCK>()) else {
                return usize::MAX;
            };
            for lane in 0..BLOCK {
                lanes[lane] += u8::from(block[lane] == limit);
            }
        }
        for lane in lanes {
            count += usize::from(lane);
        }
    }
    count
}

impl SaturationCheck {
    /// Creates a check for sub-regions in images of `width` columns. The pixels of each region must be sorted by row
    /// and then by column. A fraction `max_saturated` (0 to 1) of them may be saturated.
    pub fn new(width: usize, regions: &[Vec<WeightedPixel>], max_saturated: f64) -> Self {
        let elements = regions
            .iter()
            .map(|pixels| Region::new(width, pixels, max_saturated));
        Self {
            elements: elements.collect(),
            limit: SATURATED,
        }
    }

    /// Returns a check that counts black pixels instead, which only mean "at least this dark" in dark elements.
    #[must_use]
    pub fn of_dark_elements(self) -> Self {
        Self { limit: 0, ..self }
    }

    /// Returns whether `element` has more saturated pixels than allowed. Neither allocates nor panics; pixels beyond
    /// the image count as unsaturated.
    pub fn saturated<P: AsRef<[u8]>>(&self, picture: &Picture<P>, element: usize) -> bool {
        let Some(region) = self.elements.get(element) else {
            return false;
        };
        let pixels = picture.pixels.as_ref();
        at_most(&region.blocks, pixels, self.limit) > region.allowed
            && region.count(pixels, self.limit) > region.allowed
    }
}

fn spans(width: usize, pixels: &[WeightedPixel]) -> Vec<(usize, usize)> {
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for pixel in pixels {
        let offset = pixel.row * width + pixel.column;
        match spans.last_mut() {
            Some((start, length)) if *start + *length == offset => *length += 1,
            _ => spans.push((offset, 1)),
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn only_pixels_of_the_element_above_the_limit_count() {
        let pixel = |column, row| WeightedPixel {
            column,
            row,
            area: 1.0,
            point: DVec2::ZERO,
        };
        let region: Vec<_> = (0..2)
            .flat_map(|row| (0..50).map(move |column| pixel(column, row)))
            .collect();
        let check = SaturationCheck::new(100, &[region], 0.02);
        let mut picture = Picture::black(100, 2);
        picture.pixels[50..100].fill(255);
        assert!(
            !check.saturated(&picture, 0),
            "none of these belongs to the element"
        );
        picture.pixels[0] = 255;
        picture.pixels[149] = 255;
        assert!(!check.saturated(&picture, 0), "2 of 100 are allowed");
        picture.pixels[100] = 255;
        assert!(check.saturated(&picture, 0), "3 of 100 are not");
        assert!(!check.saturated(&picture, 1), "unknown element");
    }

    /// Regions of every width at several positions, including the image's corners.
    #[test]
    fn the_fast_count_is_an_upper_bound() {
        for columns in 1..40 {
            for first in [0, 3, 40 - columns] {
                let first = first.min(40 - columns);
                let region: Vec<_> = (0..3)
                    .flat_map(|row| (first..first + columns).map(move |column| (column, row)))
                    .map(|(column, row)| WeightedPixel {
                        column,
                        row,
                        area: 1.0,
                        point: DVec2::ZERO,
                    })
                    .collect();
                let region = Region::new(40, &region, 0.0);
                let mut pixels = vec![0; 120];
                assert_eq!(at_most(&region.blocks, &pixels, SATURATED), 0);
                for pixel in (0..120).step_by(7) {
                    pixels[pixel] = SATURATED;
                    assert!(
                        at_most(&region.blocks, &pixels, SATURATED)
                            >= region.count(&pixels, SATURATED)
                    );
                }
                pixels.fill(SATURATED);
                assert_eq!(region.count(&pixels, SATURATED), 3 * columns);
                assert!(
                    at_most(&region.blocks, &pixels[..10], SATURATED)
                        >= region.count(&pixels[..10], SATURATED)
                );
            }
        }
    }
}
