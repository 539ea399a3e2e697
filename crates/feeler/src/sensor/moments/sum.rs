//! From the sums of tiles to the moments of all elements.
//!
//! The sums of a tile are integers, the same however they are taken. From there on all paths add the
//! same products, strip by strip in the same order, and never fuse a product with a sum: every path
//! gives the same moments bit for bit.

use super::{
    ElementMoments, MomentsKernel, Polarity,
    tile::{
        QUARTER_WIDTH, QUARTERS, Row, STRIPS, TILE_ROWS, TILE_WIDTH, Tile, TileWeights, WEIGHTS,
    },
};
use glam::DVec2;

/// Where the quarters of a row begin that is in one piece.
const SIDE_BY_SIDE: [usize; QUARTERS] = [0, QUARTER_WIDTH, 2 * QUARTER_WIDTH, 3 * QUARTER_WIDTH];

/// The rows of one tile in a picture.
// Narrow vectors need neither its bands nor its level.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRows<'a> {
    /// The pixels from the first row's first one to the last row's last one at least.
    pixels: &'a [u8],
    /// From where one row begins to where the next one does.
    stride: usize,
    /// Where each quarter of the columns begins.
    quarters: [usize; QUARTERS],
    /// How many bands there are.
    pub bands: usize,
    /// Which pixels of each row count, the first lowest.
    masks: &'a [u64],
    /// Ground of each pixel, such that what does not count is on it.
    grounds: &'a [Row],
    /// For each quarter of the columns, the first row with pixels that count.
    pub first_rows: [usize; QUARTERS],
    /// Grey level of the ground of those that do.
    pub level: u8,
    /// Whether what is darker than the ground counts, not what is brighter.
    pub dark: bool,
}

impl<'a> TileRows<'a> {
    /// How many there are.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.masks.len()
    }

    /// `N` parts of each row from the `first` on, each `WIDE` pixels of one band, side by side from the `column` on where a quarter begins,
    /// with what there is `of_rows`.
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
        // One check for all rows: one for each takes a fifth of the time.
        of_rows.iter().enumerate().map(move |(row, of_row)| {
            // SAFETY: the last row has `WIDE` pixels from the start of each part, and so have those before.
            let part = |part| unsafe { &*pixels.add(part + row * stride).cast() };
            (parts.map(part), of_row)
        })
    }

    /// Parts of each row as of [`Self::rows_with`], with the ground of the row's pixels.
    #[inline(always)]
    pub(super) fn with_ground<const N: usize, const WIDE: usize>(
        &self,
        column: usize,
        first: usize,
    ) -> impl Iterator<Item = ([&'a [u8; WIDE]; N], &'a Row)> {
        self.rows_with(column, first, self.grounds)
    }

    /// All parts of each row, with a bit for each of its pixels that counts.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn with_masks<const N: usize, const WIDE: usize>(
        &self,
    ) -> impl Iterator<Item = ([&'a [u8; WIDE]; N], &'a u64)> {
        self.rows_with(0, 0, self.masks)
    }
}

/// The rows of a tile that is not wholly in the picture, or in one that is narrower than a tile, one right after the other, bands side by
/// side. No more than what the masks leave out is missing.
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

/// Strip by strip, the sums that moments are made of.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Totals(pub [[f32; STRIPS]; WEIGHTS]);

/// Takes the moments of all elements, with `add_tile` to add each tile's share to the totals. Tile by tile, the same pixels of `next`
/// come into the cache.
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
                grounds: kernel.grounds.get(masks).unwrap_or(&[]),
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

/// Lets the processor bring a tile's pixels of the `next` picture into its cache, as far as there is one. It does so while it works on
/// this picture; the rows of a tile are too far apart for it to foresee them. Into the cache of the second level, which takes many more
/// requests at once than that of the first.
#[inline(always)]
fn fetch(next: &[u8], tile: &Tile, width: usize) {
    // A control loop has no next picture, and nothing to lose.
    if next.is_empty() {
        return;
    }
    let across = TILE_WIDTH / tile.bands;
    for row in 0..tile.rows * tile.bands {
        let first = tile.offset + row * width;
        // A row may lie in two cache lines.
        for pixel in [first, first + across - 1] {
            if let Some(pixel) = next.get(pixel) {
                prefetch(pixel);
            }
        }
    }
}

/// Lets the processor bring the cache line of `byte` into its cache, where there is an instruction for that.
#[inline(always)]
fn prefetch(byte: &u8) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch reads nothing, and `byte` is a valid address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T1>(std::ptr::from_ref(byte).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = byte;
}

/// All strips together, half onto half.
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
