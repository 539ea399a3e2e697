//! The sums of all elements, by whichever instructions the processor has.
//!
//! The sums of a tile are integers, the same however they are taken. From there on all paths run the
//! same code, strip by strip in the same order, and never fuse a product with a sum: every path
//! gives the same moments bit for bit.

use super::{
    ElementMoments, MomentsKernel, Polarity,
    tile::{Row, STRIP, STRIPS, SUMS, TILE_ROWS, TILE_WIDTH, Tile, TileWeights, WEIGHTS},
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
    /// The same, a byte for each pixel.
    byte_masks: &'a [Row],
    /// How many strips have pixels, up to the last that has.
    strips: usize,
    /// Grey level of the ground.
    pub level: u8,
    /// Whether what is darker than the ground counts, not what is brighter.
    pub dark: bool,
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
    let elements = kernel.elements.iter().zip(&kernel.levels);
    for (moments, (range, &level)) in moments.iter_mut().zip(elements) {
        let mut totals = Totals([[0.0; STRIPS]; WEIGHTS]);
        for tile in kernel.tiles.get(range.clone()).unwrap_or(&[]) {
            let masks = tile.first_mask..tile.first_mask + tile.rows;
            let rows = TileRows {
                pixels,
                offset: tile.offset,
                width: kernel.width,
                masks: kernel.masks.get(masks.clone()).unwrap_or(&[]),
                byte_masks: kernel.byte_masks.get(masks).unwrap_or(&[]),
                strips: tile.strips,
                level,
                dark,
            };
            fetch(next, tile, kernel.width);
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
    for row in 0..tile.rows {
        let first = tile.offset + row * width;
        // A row of 64 pixels lies in two cache lines.
        for pixel in [first, first + TILE_WIDTH - 1] {
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

/// Takes the moments with `LANES` strips side by side, in plain loops that the compiler turns into
/// whichever vector instructions it may use.
///
/// The rows of a tile are made bright first and summed then. In one loop, the compiler would take
/// the pixels one by one.
#[inline(always)]
pub(super) fn plain<const LANES: usize>(
    kernel: &MomentsKernel,
    pixels: &[u8],
    next: &[u8],
    moments: &mut [ElementMoments],
) {
    let mut bright = [Row([0; TILE_WIDTH]); TILE_ROWS];
    all_elements(kernel, pixels, next, moments, |tile, weights, totals| {
        brighten(tile, &mut bright);
        let rows = bright.get(..tile.byte_masks.len()).unwrap_or(&[]);
        for group in (0..STRIPS / LANES).take_while(|group| group * LANES < tile.strips) {
            add_group::<LANES>(rows, group, weights, totals);
        }
    });
}

/// How far the pixels of a tile are off the ground, 0 where they do not belong to the sub-region.
#[inline(always)]
fn brighten(tile: &TileRows, bright: &mut [Row; TILE_ROWS]) {
    let level = tile.level;
    let mut padding = [0; TILE_WIDTH];
    for (row, (bright, mask)) in bright.iter_mut().zip(tile.byte_masks).enumerate() {
        let pixels = tile.row(row, &mut padding);
        for ((bright, &pixel), &own) in bright.0.iter_mut().zip(pixels).zip(&mask.0) {
            let above = if tile.dark {
                level.saturating_sub(pixel)
            } else {
                pixel.saturating_sub(level)
            };
            *bright = above & own;
        }
    }
}

/// Adds what the sums of the `group`-th `LANES` strips of a tile count for.
#[inline(always)]
fn add_group<const LANES: usize>(
    rows: &[Row],
    group: usize,
    weights: &TileWeights,
    totals: &mut Totals,
) {
    let sums = group_sums::<LANES>(rows, group);
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        let total = &mut total.as_chunks_mut::<LANES>().0[group];
        for (sums, weights) in sums.iter().zip(weights) {
            let weights = &weights.as_chunks::<LANES>().0[group];
            for lane in 0..LANES {
                total[lane] += weights[lane] * sums[lane] as f32;
            }
        }
    }
}

/// The sums of the `group`-th `LANES` strips of a tile.
#[inline(always)]
fn group_sums<const LANES: usize>(rows: &[Row], group: usize) -> [[i32; LANES]; SUMS] {
    let zero = [0; LANES];
    let [mut a0, mut a1, mut a2, mut a3] = [zero; 4];
    let [mut b0, mut b1, mut b2] = [zero; 3];
    let [mut c0, mut c1] = [zero; 2];
    let mut d0 = zero;
    for row in rows {
        let strips = row.0.as_chunks::<STRIP>().0;
        let strips = &strips.as_chunks::<LANES>().0[group];
        for lane in 0..LANES {
            // As one integer, so that it stays in its lane.
            let strip = u32::from_le_bytes(strips[lane]);
            let pixel = |place: usize| (strip >> (8 * place) & 0xff) as i32;
            let (outer, inner) = (pixel(0) + pixel(3), pixel(1) + pixel(2));
            let (across, between) = (pixel(3) - pixel(0), pixel(2) - pixel(1));
            // What the rows of `ACROSS` give, one after the other.
            a0[lane] += outer + inner;
            a1[lane] += a0[lane];
            a2[lane] += a1[lane];
            a3[lane] += a2[lane];
            b0[lane] += 3 * across + between;
            b1[lane] += b0[lane];
            b2[lane] += b1[lane];
            c0[lane] += outer - inner;
            c1[lane] += c0[lane];
            d0[lane] += across - 3 * between;
        }
    }
    [a0, a1, a2, a3, b0, b1, b2, c0, c1, d0]
}
