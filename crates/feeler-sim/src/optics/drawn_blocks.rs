//! Selection of the pixels of a simulated image that are rendered.

use super::camera_noise::NOISE_LANES;
use std::ops::Range;

/// For each row of an image, its rendered blocks of [`NOISE_LANES`] pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DrawnBlocks {
    /// Contiguous runs of blocks, row by row.
    runs: Vec<Range<usize>>,
    /// Index in `runs` of the first run of each row, followed by the total number of runs.
    rows: Vec<usize>,
}

impl DrawnBlocks {
    /// Selects all blocks of an image with `height` rows of `width` pixels.
    pub fn all(width: usize, height: usize) -> Self {
        Self {
            runs: vec![0..width.div_ceil(NOISE_LANES); height],
            rows: (0..=height).collect(),
        }
    }

    /// Selects the blocks of an image with `height` rows of `width` pixels that contain one of `pixels` (column, row).
    pub fn with_pixels(
        width: usize,
        height: usize,
        pixels: impl Iterator<Item = (usize, usize)>,
    ) -> Self {
        let blocks = width.div_ceil(NOISE_LANES);
        let mut drawn = vec![false; blocks * height];
        for (column, row) in pixels {
            if let Some(drawn) = drawn.get_mut(row * blocks + column / NOISE_LANES) {
                *drawn = true;
            }
        }
        let mut new = Self {
            runs: Vec::new(),
            rows: vec![0],
        };
        for row in drawn.chunks(blocks) {
            let mut start = 0;
            for run in row.chunk_by(|one, next| one == next) {
                if run[0] {
                    new.runs.push(start..start + run.len());
                }
                start += run.len();
            }
            new.rows.push(new.runs.len());
        }
        new
    }

    /// Rendered runs of `row`, from left to right.
    #[inline(always)]
    pub fn in_row(&self, row: usize) -> impl Iterator<Item = Range<usize>> {
        let own = match self.rows.get(row..row + 2) {
            Some(&[start, end]) => self.runs.get(start..end),
            _ => None,
        };
        own.unwrap_or(&[]).iter().cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_blocks_of_a_row_are_one_run() {
        let all = DrawnBlocks::all(40, 2);
        assert!(all.in_row(1).eq(std::iter::once(0..3)));
        assert_eq!(all.in_row(2).count(), 0);
        let pixels = (0..2).flat_map(|row| (0..40).map(move |column| (column, row)));
        assert_eq!(all, DrawnBlocks::with_pixels(40, 2, pixels));
    }

    #[test]
    fn blocks_without_a_pixel_are_not_selected() {
        let pixels = [(0, 0), (15, 0), (33, 0), (47, 0), (48, 0), (16, 2)];
        let some = DrawnBlocks::with_pixels(64, 3, pixels.into_iter());
        assert_eq!(some.in_row(0).collect::<Vec<_>>(), [0..1, 2..4]);
        assert_eq!(some.in_row(1).count(), 0);
        assert!(some.in_row(2).eq(std::iter::once(1..2)));
    }
}
