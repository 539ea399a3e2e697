//! Sums of a tile with AVX2 of x86-64, 32 pixels per instruction.
//!
//! AVX2 multiplies bytes and adds adjacent products to 16 bits, and those to 32 bits. Rows are first summed in 16 bits,
//! where twice as many numbers fit into a vector. With `p` the outer and `q` the inner pixel of each half of a strip,
//! the sums are
//!
//! ```text
//! S = p + q        E = 3 p + q
//! ```
//!
//! They give all four powers across the strip (`tile`), with `'` for its right half:
//!
//! ```text
//! k^0: S + S'      k^1: E' - E      k^2: E + E' - 2 (S + S')      k^3: 2 (E' - E) - 5 (S' - S)
//! ```

use super::{
    ElementMoments, MomentsKernel,
    sum::{TileRows, Totals, all_elements},
    tile::{STRIPS, SUMS, TileWeights},
};
use std::arch::x86_64::*;

/// Number of strips in a vector: half a tile.
const LANES: usize = 8;

/// Offset of the sum of two 16-bit accumulators, which start at the minimum of their type so that the sum of 64 rows of
/// up to 1020 does not overflow.
const TOO_FEW: i32 = 1 << 16;

/// Computes the moments of all elements.
#[target_feature(enable = "avx2")]
pub(super) fn all_moments(
    kernel: &MomentsKernel,
    pixels: &[u8],
    next: &[u8],
    moments: &mut [ElementMoments],
) {
    all_elements(kernel, pixels, next, moments, |tile, weights, totals| {
        for half in 0..STRIPS / LANES {
            let [left, right] = tile.first_rows.as_chunks::<2>().0[half];
            let first = left.min(right);
            if first < tile.count() {
                let sums = match tile.bands {
                    1 | 2 => half_sums::<1, 32>(tile, half, first),
                    _ => half_sums::<2, 16>(tile, half, first),
                };
                add_half(sums, half, weights, totals);
            }
        }
    });
}

/// Sums of the strips in one half of the tile, stored in `N` bands, over the rows from `first` on.
#[inline]
#[target_feature(enable = "avx2")]
fn half_sums<const N: usize, const WIDE: usize>(
    tile: &TileRows,
    half: usize,
    first: usize,
) -> [__m256i; SUMS] {
    let both = _mm256_set1_epi8(1);
    let edge = _mm256_set1_epi32(i32::from_le_bytes([3, 1, 1, 3]));
    let sum = _mm256_set1_epi16(1);
    // The right half is in the upper bits.
    let difference = _mm256_set1_epi32((1 << 16) | 0xffff);
    let zero = _mm256_setzero_si256();
    let mut s0 = zero;
    let mut e0 = _mm256_set1_epi16(i16::MIN);
    let [mut a1, mut a2, mut a3, mut b1, mut b2, mut e1] = [zero; 6];
    for (parts, ground) in tile.with_background::<N, WIDE>(32 * half, first) {
        let ground = &ground.0.as_chunks::<32>().0[half];
        let gray = side_by_side(parts);
        // SAFETY: `ground` points to 32 initialised bytes; no alignment is required.
        let ground = unsafe { _mm256_loadu_si256(ground.as_ptr().cast()) };
        let bright = if tile.dark {
            _mm256_subs_epu8(ground, gray)
        } else {
            _mm256_subs_epu8(gray, ground)
        };
        s0 = _mm256_add_epi16(s0, _mm256_maddubs_epi16(bright, both));
        e0 = _mm256_add_epi16(e0, _mm256_maddubs_epi16(bright, edge));
        a1 = _mm256_add_epi32(a1, _mm256_madd_epi16(s0, sum));
        a2 = _mm256_add_epi32(a2, a1);
        a3 = _mm256_add_epi32(a3, a2);
        b1 = _mm256_add_epi32(b1, _mm256_madd_epi16(e0, difference));
        b2 = _mm256_add_epi32(b2, b1);
        e1 = _mm256_add_epi32(e1, _mm256_madd_epi16(e0, sum));
    }
    let rows = (tile.count() - first) as i32;
    let twice = |a| _mm256_add_epi32(a, a);
    let squares = |e, too_few: i32, a| {
        let e = _mm256_add_epi32(e, _mm256_set1_epi32(too_few));
        _mm256_sub_epi32(e, twice(a))
    };
    let a0 = _mm256_madd_epi16(s0, sum);
    let b0 = _mm256_madd_epi16(e0, difference);
    let c0 = squares(_mm256_madd_epi16(e0, sum), TOO_FEW, a0);
    let c1 = squares(e1, rows * TOO_FEW, a1);
    let minus_five = _mm256_set1_epi32((-5 << 16) | 5);
    let d0 = _mm256_add_epi32(twice(b0), _mm256_madd_epi16(s0, minus_five));
    [a0, a1, a2, a3, b0, b1, b2, c0, c1, d0]
}

/// Loads the 32 pixels of a row, which are stored in one or two parts.
#[inline]
#[target_feature(enable = "avx2")]
fn side_by_side<const N: usize, const WIDE: usize>(parts: [&[u8; WIDE]; N]) -> __m256i {
    const { assert!(N * WIDE == 32 && N <= 2) };
    let part = |part: usize| parts[part].as_ptr();
    // SAFETY: each part points to `WIDE` initialised bytes; no alignment is required.
    unsafe {
        match N {
            1 => _mm256_loadu_si256(part(0).cast()),
            _ => _mm256_loadu2_m128i(part(1).cast(), part(0).cast()),
        }
    }
}

/// Adds the weighted sums of the strips of one half to the totals.
#[inline]
#[target_feature(enable = "avx2")]
fn add_half(sums: [__m256i; SUMS], half: usize, weights: &TileWeights, totals: &mut Totals) {
    let sums = sums.map(|sums| _mm256_cvtepi32_ps(sums));
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        let total = &mut total.as_chunks_mut::<LANES>().0[half];
        // SAFETY: `total` is 8 `f32`, the 32 bytes read; no alignment is required.
        let mut strips = unsafe { _mm256_loadu_ps(total.as_ptr()) };
        for (weights, sums) in weights.iter().zip(sums) {
            let weights = &weights.as_chunks::<LANES>().0[half];
            // SAFETY: `weights` is 8 `f32`, the 32 bytes read; no alignment is required.
            let weights = unsafe { _mm256_loadu_ps(weights.as_ptr()) };
            strips = _mm256_add_ps(strips, _mm256_mul_ps(weights, sums));
        }
        // SAFETY: `total` is 8 `f32`, the 32 bytes written; no alignment is required.
        unsafe { _mm256_storeu_ps(total.as_mut_ptr(), strips) };
    }
}
