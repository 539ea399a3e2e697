//! The sums of all elements, by whichever instructions the processor has.
//!
//! The sums of a tile are integers, the same however they are taken. From there on all paths run the
//! same code, strip by strip in the same order, and never fuse a product with a sum: every path
//! gives the same moments bit for bit.

use super::{
    ElementMoments, MomentsKernel,
    tile::{ACROSS, ROW_POWERS, STRIP, STRIPS, SUMS, TILE_WIDTH, TileWeights, WEIGHTS},
};
use glam::DVec2;

/// The rows of one tile in a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRows<'a> {
    /// All pixels of the picture.
    pixels: &'a [u8],
    /// Where in them the first row begins.
    offset: usize,
    /// Columns of the picture.
    width: usize,
    /// Which pixels of each row count, the first lowest.
    pub masks: &'a [u64],
    /// Gray value up to which a pixel is dark.
    pub dark_level: u8,
}

impl TileRows<'_> {
    /// Row `row` from its first pixel on; where the picture ends, `padding` takes its place.
    #[inline(always)]
    pub(super) fn row<'b>(
        &'b self,
        row: usize,
        padding: &'b mut [u8; TILE_WIDTH],
    ) -> &'b [u8; TILE_WIDTH] {
        let rest = self
            .pixels
            .get(self.offset + row * self.width..)
            .unwrap_or(&[]);
        match rest.first_chunk() {
            Some(whole) => whole,
            None => pad(rest, padding),
        }
    }
}

/// Only the last rows of a picture are ever cut off.
#[cold]
#[inline(never)]
fn pad<'a>(rest: &[u8], padding: &'a mut [u8; TILE_WIDTH]) -> &'a [u8; TILE_WIDTH] {
    for (padded, &pixel) in padding.iter_mut().zip(rest) {
        *padded = pixel;
    }
    padding
}

/// Strip by strip, the sums that moments are made of.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Totals(pub [[f32; STRIPS]; WEIGHTS]);

/// Takes the moments of all elements, with `add_tile` to add each tile's share to the totals.
#[inline(always)]
pub(super) fn all_elements(
    kernel: &MomentsKernel,
    pixels: &[u8],
    moments: &mut [ElementMoments],
    add_tile: impl Fn(&TileRows, &TileWeights, &mut Totals),
) {
    for (moments, range) in moments.iter_mut().zip(&kernel.elements) {
        let mut totals = Totals([[0.0; STRIPS]; WEIGHTS]);
        for tile in kernel.tiles.get(range.clone()).unwrap_or(&[]) {
            let masks = tile.first_mask..tile.first_mask + tile.rows;
            let rows = TileRows {
                pixels,
                offset: tile.offset,
                width: kernel.width,
                masks: kernel.masks.get(masks).unwrap_or(&[]),
                dark_level: kernel.dark_level,
            };
            add_tile(&rows, &tile.weights, &mut totals);
        }
        let [gray, x, y] = &totals.0;
        *moments = element_moments([total(gray), total(x), total(y)]);
    }
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

/// Adds what a tile's sums count for, without any particular instructions.
pub(super) fn add_tile(rows: &TileRows, weights: &TileWeights, totals: &mut Totals) {
    let sums = tile_sums(rows);
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        for (sums, weights) in sums.iter().zip(weights) {
            for strip in 0..STRIPS {
                total[strip] += weights[strip] * sums[strip] as f32;
            }
        }
    }
}

/// The sums of one tile.
fn tile_sums(tile: &TileRows) -> [[i32; STRIPS]; SUMS] {
    let mut sums = [[0; STRIPS]; SUMS];
    let mut padding = [0; TILE_WIDTH];
    for (row, &mask) in tile.masks.iter().enumerate() {
        let pixels = tile.row(row, &mut padding);
        let mut bright = [0; TILE_WIDTH];
        for (index, (bright, &pixel)) in bright.iter_mut().zip(pixels).enumerate() {
            let own = ((mask >> index) & 1) as u8;
            *bright = pixel.saturating_sub(tile.dark_level) & own.wrapping_neg();
        }
        let mut first = 0;
        for (factors, powers) in ACROSS.iter().zip(ROW_POWERS) {
            for (strip, pixels) in bright.chunks_exact(STRIP).enumerate() {
                let products = pixels.iter().zip(factors);
                let mut sum: i32 = products.map(|(&g, &k)| i32::from(g) * i32::from(k)).sum();
                for power in &mut sums[first..first + powers] {
                    power[strip] += sum;
                    sum = power[strip];
                }
            }
            first += powers;
        }
    }
    sums
}
