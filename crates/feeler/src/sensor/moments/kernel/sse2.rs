//! Sums of a tile with SSE2, which every x86-64 processor has, 16 pixels per instruction.
//!
//! SSE2 cannot multiply bytes. The even and the odd pixels of each strip are therefore summed over the rows in 16 bits
//! each, and multiplied by their factors (`tile`) when added to 32 bits.

use super::{
    ElementMoments, MomentsKernel,
    sum::{TileRows, Totals, all_elements},
    tile::{ACROSS, SUMS, TileWeights},
};
use std::arch::x86_64::*;

/// Number of strips in a vector: a quarter of a tile.
const LANES: usize = 4;

/// Factors of the pixels `first` and `first + 2` of a strip, packed as two 16-bit numbers.
const fn factors(power: usize, first: usize) -> i32 {
    let [left, right] = [ACROSS[power][first] as i32, ACROSS[power][first + 2] as i32];
    (right << 16) | (left & 0xffff)
}

/// Computes the moments of all elements.
#[target_feature(enable = "sse2")]
pub(super) fn all_moments(
    kernel: &MomentsKernel,
    pixels: &[u8],
    next: &[u8],
    moments: &mut [ElementMoments],
) {
    all_elements(kernel, pixels, next, moments, |tile, weights, totals| {
        for (quarter, &first) in tile.first_rows.iter().enumerate() {
            if first < tile.count() {
                let sums = quarter_sums(tile, quarter, first);
                add_quarter(sums, quarter, weights, totals);
            }
        }
    });
}

/// Sums of the strips in one quarter of the tile, over the rows from `first` on.
#[inline]
#[target_feature(enable = "sse2")]
fn quarter_sums(tile: &TileRows, quarter: usize, first: usize) -> [__m128i; SUMS] {
    let low_byte = _mm_set1_epi16(0xff);
    let [a, b_even, b_odd] =
        [factors(0, 0), factors(1, 0), factors(1, 1)].map(|f| _mm_set1_epi32(f));
    // The odd pixels have the opposite factors.
    let c = _mm_set1_epi32(factors(2, 0));
    let zero = _mm_setzero_si128();
    let [mut even, mut odd] = [zero; 2];
    let [mut a1, mut a2, mut a3, mut b1, mut b2, mut c1] = [zero; 6];
    let products = |even, odd| {
        (
            _mm_madd_epi16(_mm_add_epi16(even, odd), a),
            _mm_add_epi32(_mm_madd_epi16(even, b_even), _mm_madd_epi16(odd, b_odd)),
            _mm_madd_epi16(_mm_sub_epi16(even, odd), c),
        )
    };
    for ([pixels], ground) in tile.with_background::<1, 16>(16 * quarter, first) {
        let ground = &ground.0.as_chunks::<16>().0[quarter];
        // SAFETY: `pixels` points to 16 initialised bytes; no alignment is required.
        let gray = unsafe { _mm_loadu_si128(pixels.as_ptr().cast()) };
        // SAFETY: `ground` points to 16 initialised bytes; no alignment is required.
        let ground = unsafe { _mm_loadu_si128(ground.as_ptr().cast()) };
        let bright = if tile.dark {
            _mm_subs_epu8(ground, gray)
        } else {
            _mm_subs_epu8(gray, ground)
        };
        // 64 rows of 255, and two such sums, fit into 16 bits.
        even = _mm_add_epi16(even, _mm_and_si128(bright, low_byte));
        odd = _mm_add_epi16(odd, _mm_srli_epi16::<8>(bright));
        let (a0, b0, c0) = products(even, odd);
        a1 = _mm_add_epi32(a1, a0);
        a2 = _mm_add_epi32(a2, a1);
        a3 = _mm_add_epi32(a3, a2);
        b1 = _mm_add_epi32(b1, b0);
        b2 = _mm_add_epi32(b2, b1);
        c1 = _mm_add_epi32(c1, c0);
    }
    let (a0, b0, c0) = products(even, odd);
    let [d_even, d_odd] = [factors(3, 0), factors(3, 1)].map(|f| _mm_set1_epi32(f));
    let d0 = _mm_add_epi32(_mm_madd_epi16(even, d_even), _mm_madd_epi16(odd, d_odd));
    [a0, a1, a2, a3, b0, b1, b2, c0, c1, d0]
}

/// Adds the weighted sums of the strips of one quarter to the totals.
#[inline]
#[target_feature(enable = "sse2")]
fn add_quarter(sums: [__m128i; SUMS], quarter: usize, weights: &TileWeights, totals: &mut Totals) {
    let sums = sums.map(|sums| _mm_cvtepi32_ps(sums));
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        let total = &mut total.as_chunks_mut::<LANES>().0[quarter];
        // SAFETY: `total` is 4 `f32`, the 16 bytes read; no alignment is required.
        let mut strips = unsafe { _mm_loadu_ps(total.as_ptr()) };
        for (weights, sums) in weights.iter().zip(sums) {
            let weights = &weights.as_chunks::<LANES>().0[quarter];
            // SAFETY: `weights` is 4 `f32`, the 16 bytes read; no alignment is required.
            let weights = unsafe { _mm_loadu_ps(weights.as_ptr()) };
            strips = _mm_add_ps(strips, _mm_mul_ps(weights, sums));
        }
        // SAFETY: `total` is 4 `f32`, the 16 bytes written; no alignment is required.
        unsafe { _mm_storeu_ps(total.as_mut_ptr(), strips) };
    }
}
