//! Combines the sums of tiles to the moments of all elements.
//!
//! The sums of a tile are integers, equal for all implementations. From there on, all implementations add the same
//! products strip by strip in the same order, without fused multiply-add, so the moments are bit-identical.

use super::{
    ElementMoments, MomentsKernel, Polarity,
    tile::{
        QUARTER_WIDTH, QUARTERS, Row, STRIPS, TILE_ROWS, TILE_WIDTH, Tile, TileWeights, WEIGHTS,
    },
};
use glam::DVec2;

/// Column at which each quarter of a tile's row starts, if the row is contiguous.
const SIDE_BY_SIDE: [usize; QUARTERS] = [0, QUARTER_WIDTH, 2 * QUARTER_WIDTH, 3 * QUARTER_WIDTH];

/// Rows of one tile, as views into an image.
// Implementations with narrow vectors need neither `bands` nor `level`.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRows<'a> {
    /// Slice of the image that contains all rows.
    pixels: &'a [u8],
    /// Number of pixels from the start of a row to that of the next.
    stride: usize,
    /// Offset in `pixels` of the first pixel of each quarter of the columns.
    quarters: [usize; QUARTERS],
    /// Number of bands side by side.
    pub bands: usize,
    /// Bit mask of the pixels in each row that belong to the sub-region; the first pixel is the lowest bit.
    masks: &'a [u64],
    /// Background level of each pixel. Pixels outside the sub-region have a level at which they contribute zero.
    backgrounds: &'a [Row],
    /// First row with pixels of the sub-region, for each quarter of the columns.
    pub first_rows: [usize; QUARTERS],
    /// Background gray level of the pixels in the sub-region.
    pub level: u8,
    /// `true` if pixels darker than the background contribute, `false` if brighter ones do.
    pub dark: bool,
}

impl<'a> TileRows<'a> {
    /// Number of rows.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.masks.len()
    }

    /// Iterates over the rows from `first` on. Each row is given as `N` parts of `WIDE` pixels, with its item of
    /// `of_rows`. Each part lies within one band; the parts are adjacent and start at `column`, which must be the start
    /// of a quarter.
    #[inline(always)]
    fn rows_with<const N: usize, const WIDE: usize, R>(
        &self,
        column: usize,
        first: usize,
        of_rows: &'a [R],
    ) -> impl Iterator<Item = ([&'a [u8; WIDE]; N], &'a R)> {
        let of_rows = of_rows.get(first..).unwrap_or(&[]);
        let parts: [usize; N] = std::array::from_fn(|part| {
            self.quarters[(column + part * WIDE) / QUARTER_WIDTH] + first * self.stride
        });
        let to_last = of_rows.len().saturating_sub(1) * self.stride + WIDE;
        let whole = |&part: &usize| part + to_last <= self.pixels.len();
        let of_rows = if parts.iter().all(whole) {
            of_rows
        } else {
            &[]
        };
        let (pixels, stride) = (self.pixels.as_ptr(), self.stride);
        // One check for all rows: a check per row would take a fifth of the time.
        of_rows.iter().enumerate().map(move |(row, of_row)| {
            // SAFETY: the last row has `WIDE` pixels from the start of each part, and so have all rows before.
            let part = |part| unsafe { &*pixels.add(part + row * stride).cast() };
            (parts.map(part), of_row)
        })
    }

    /// Like [`Self::rows_with`], with the background of each row.
    #[inline(always)]
    pub(super) fn with_background<const N: usize, const WIDE: usize>(
        &self,
        column: usize,
        first: usize,
    ) -> impl Iterator<Item = ([&'a [u8; WIDE]; N], &'a Row)> {
        self.rows_with(column, first, self.backgrounds)
    }

    /// Iterates over all rows, each with the bit mask of the pixels in the sub-region.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn with_masks<const N: usize, const WIDE: usize>(
        &self,
    ) -> impl Iterator<Item = ([&'a [u8; WIDE]; N], &'a u64)> {
        self.rows_with(0, 0, self.masks)
    }
}

/// Copies the rows of a tile that is partly outside the image or in an image narrower than a tile. The rows of the copy
/// are contiguous, with bands side by side. Only pixels excluded by the masks are missing.
#[cold]
#[inline(never)]
fn copied<'a>(
    pixels: &[u8],
    tile: &Tile,
    width: usize,
    copy: &'a mut [[u8; TILE_WIDTH]; TILE_ROWS],
) -> &'a [u8] {
    for (row, copy) in copy.iter_mut().enumerate().take(tile.rows) {
        let quarters = copy.as_chunks_mut::<QUARTER_WIDTH>().0;
        for (quarter, copy) in quarters.iter_mut().enumerate() {
            let first = tile.pixel(row, quarter * QUARTER_WIDTH, width);
            let rest = pixels.get(first..).unwrap_or(&[]);
            for (copy, &pixel) in copy.iter_mut().zip(rest) {
                *copy = pixel;
            }
        }
    }
    copy.as_flattened()
}

/// Weighted sums of each strip; their total over all strips gives the moments.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Totals(pub [[f32; STRIPS]; WEIGHTS]);

/// Computes the moments of all elements, using `add_tile` to add each tile's contribution to the totals. Prefetches the
/// same pixels of the image `next`, tile by tile.
#[inline(always)]
pub(super) fn all_elements(
    kernel: &MomentsKernel,
    pixels: &[u8],
    next: &[u8],
    moments: &mut [ElementMoments],
    mut add_tile: impl FnMut(&TileRows, &TileWeights, &mut Totals),
) {
    let dark = kernel.polarity == Polarity::Dark;
    let width = kernel.width;
    let mut copy = [[0; TILE_WIDTH]; TILE_ROWS];
    let elements = kernel.elements.iter().zip(&kernel.levels);
    for (moments, (range, &level)) in moments.iter_mut().zip(elements) {
        let mut totals = Totals([[0.0; STRIPS]; WEIGHTS]);
        for tile in kernel.tiles.get(range.clone()).unwrap_or(&[]) {
            let masks = tile.first_mask..tile.first_mask + tile.rows;
            let end = tile.pixel(tile.rows - 1, TILE_WIDTH - 1, width) + 1;
            let (own, stride, quarters) = match pixels.get(tile.offset..end) {
                Some(own) if width >= TILE_WIDTH => (own, width, tile.quarters),
                _ => (
                    copied(pixels, tile, width, &mut copy),
                    TILE_WIDTH,
                    SIDE_BY_SIDE,
                ),
            };
            let rows = TileRows {
                pixels: own,
                stride,
                quarters,
                bands: tile.bands,
                masks: kernel.masks.get(masks.clone()).unwrap_or(&[]),
                backgrounds: kernel.backgrounds.get(masks).unwrap_or(&[]),
                first_rows: tile.first_rows,
                level,
                dark,
            };
            fetch(next, tile, width);
            add_tile(&rows, &tile.weights, &mut totals);
        }
        let [gray, x, y] = &totals.0;
        *moments = element_moments([total(gray), total(x), total(y)]);
    }
}

/// Prefetches a tile's pixels in the image `next`, if any, while the current image is processed. The hardware
/// prefetcher cannot predict the distant rows of a tile. The second-level cache is used because it accepts many more
/// pending requests than the first-level cache.
#[inline(always)]
fn fetch(next: &[u8], tile: &Tile, width: usize) {
    // A control loop has no next image and must not be slowed down.
    if next.is_empty() {
        return;
    }
    let across = TILE_WIDTH / tile.bands;
    for row in 0..tile.rows * tile.bands {
        let first = tile.offset + row * width;
        // A row may span two cache lines.
        for pixel in [first, first + across - 1] {
            if let Some(pixel) = next.get(pixel) {
                prefetch(pixel);
            }
        }
    }
}

/// Prefetches the cache line that contains `byte`, if the processor supports it.
#[inline(always)]
fn prefetch(byte: &u8) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch has no side effects, and `byte` is a valid address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T1>(std::ptr::from_ref(byte).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = byte;
}

/// Sum over all strips, by pairwise addition of halves.
#[inline(always)]
fn total(strips: &[f32; STRIPS]) -> f64 {
    let mut sums = [0.0; STRIPS];
    for strip in 0..STRIPS {
        sums[strip] = f64::from(strips[strip]);
    }
    for half in [8, 4, 2, 1] {
        for strip in 0..half {
            sums[strip] += sums[strip + half];
        }
    }
    sums[0]
}

#[inline(always)]
fn element_moments([integrated_gray, x, y]: [f64; WEIGHTS]) -> ElementMoments {
    ElementMoments {
        integrated_gray,
        centroid: if integrated_gray > 0.0 {
            DVec2::new(x, y) / integrated_gray
        } else {
            DVec2::ZERO
        },
    }
}
