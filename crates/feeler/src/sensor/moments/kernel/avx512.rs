//! Sums of a tile with AVX-512 of x86-64, 64 pixels per instruction.

use super::{
    ElementMoments, MomentsKernel,
    sum::{TileRows, Totals, all_elements},
    tile::{ACROSS, TileWeights},
};
use std::arch::x86_64::*;

/// Rows of [`ACROSS`], with the four factors of each row packed into the bytes of an integer.
const FACTORS: [i32; 4] = {
    let mut packed = [0; 4];
    let mut power = 0;
    while power < 4 {
        let [a, b, c, d] = ACROSS[power];
        packed[power] = i32::from_le_bytes([a as u8, b as u8, c as u8, d as u8]);
        power += 1;
    }
    packed
};

/// Computes the moments of all elements.
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
pub(super) fn all_moments(
    kernel: &MomentsKernel,
    pixels: &[u8],
    next: &[u8],
    moments: &mut [ElementMoments],
) {
    all_elements(
        kernel,
        pixels,
        next,
        moments,
        |rows, weights, totals| match rows.bands {
            1 => add_tile::<1, 64>(rows, weights, totals),
            2 => add_tile::<2, 32>(rows, weights, totals),
            _ => add_tile::<4, 16>(rows, weights, totals),
        },
    );
}

/// Adds the weighted sums of a tile of `N` bands to the totals.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
fn add_tile<const N: usize, const WIDE: usize>(
    tile: &TileRows,
    weights: &TileWeights,
    totals: &mut Totals,
) {
    let level = _mm512_set1_epi8(tile.level.cast_signed());
    let [k0, k1, k2, k3] = FACTORS;
    let k0 = _mm512_set1_epi32(k0);
    let k1 = _mm512_set1_epi32(k1);
    let k2 = _mm512_set1_epi32(k2);
    let k3 = _mm512_set1_epi32(k3);
    let zero = _mm512_setzero_si512();
    let [mut a0, mut a1, mut a2, mut a3] = [zero; 4];
    let [mut b0, mut b1, mut b2] = [zero; 3];
    let [mut c0, mut c1] = [zero; 2];
    let mut d0 = zero;
    for (parts, &mask) in tile.with_masks::<N, WIDE>() {
        let gray = side_by_side(parts);
        let bright = if tile.dark {
            _mm512_maskz_subs_epu8(mask, level, gray)
        } else {
            _mm512_maskz_subs_epu8(mask, gray, level)
        };
        a0 = _mm512_dpbusd_epi32(a0, bright, k0);
        a1 = _mm512_add_epi32(a1, a0);
        a2 = _mm512_add_epi32(a2, a1);
        a3 = _mm512_add_epi32(a3, a2);
        b0 = _mm512_dpbusd_epi32(b0, bright, k1);
        b1 = _mm512_add_epi32(b1, b0);
        b2 = _mm512_add_epi32(b2, b1);
        c0 = _mm512_dpbusd_epi32(c0, bright, k2);
        c1 = _mm512_add_epi32(c1, c0);
        d0 = _mm512_dpbusd_epi32(d0, bright, k3);
    }
    let sums = [a0, a1, a2, a3, b0, b1, b2, c0, c1, d0];
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        // SAFETY: `total` is 16 `f32`, the 64 bytes read; no alignment is required.
        let mut strips = unsafe { _mm512_loadu_ps(total.as_ptr()) };
        for (weights, sums) in weights.iter().zip(sums) {
            // SAFETY: `weights` is 16 `f32`, the 64 bytes read; no alignment is required.
            let weights = unsafe { _mm512_loadu_ps(weights.as_ptr()) };
            strips = _mm512_add_ps(strips, _mm512_mul_ps(weights, _mm512_cvtepi32_ps(sums)));
        }
        // SAFETY: `total` is 16 `f32`, the 64 bytes written; no alignment is required.
        unsafe { _mm512_storeu_ps(total.as_mut_ptr(), strips) };
    }
}

/// Loads the 64 pixels of a row, which are stored in one, two or four parts.
#[inline]
#[target_feature(enable = "avx512f")]
fn side_by_side<const N: usize, const WIDE: usize>(parts: [&[u8; WIDE]; N]) -> __m512i {
    const { assert!(N * WIDE == 64 && N <= 4) };
    let part = |part: usize| parts[part].as_ptr();
    // SAFETY: each part points to `WIDE` initialised bytes; no alignment is required.
    unsafe {
        match N {
            1 => _mm512_loadu_si512(part(0).cast()),
            2 => {
                let left = _mm512_castsi256_si512(_mm256_loadu_si256(part(0).cast()));
                _mm512_inserti64x4::<1>(left, _mm256_loadu_si256(part(1).cast()))
            }
            _ => {
                let [a, b, c, d] = [0, 1, 2, 3].map(|at| _mm_loadu_si128(part(at).cast()));
                let row = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(a), b);
                _mm512_inserti32x4::<3>(_mm512_inserti32x4::<2>(row, c), d)
            }
        }
    }
}
