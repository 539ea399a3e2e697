//! Sums of a tile with NEON, which every 64-bit ARM processor has, 16 pixels per instruction.
//!
//! NEON adds adjacent values, or values shifted to the right, to a sum of twice the width in one instruction, but
//! without factors. For each strip `p q r s` these values are summed:
//!
//! ```text
//! a = p + q + r + s      t = r + s      h = q + s      s
//! ```
//!
//! They give all four powers across the strip (`tile`):
//!
//! ```text
//! k^0: a      k^1: 4 t - 3 a + 2 h      k^2: a - 2 t - 2 h + 4 s      k^3: 4 h - 2 t - a
//! ```

use super::{
    ElementMoments, MomentsKernel,
    sum::{TileRows, Totals, all_elements},
    tile::{SUMS, TileWeights},
};
use std::arch::aarch64::*;

/// Number of strips in a vector: a quarter of a tile.
const LANES: usize = 4;

/// Computes the moments of all elements.
#[target_feature(enable = "neon")]
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
#[target_feature(enable = "neon")]
fn quarter_sums(tile: &TileRows, quarter: usize, first: usize) -> [int32x4_t; SUMS] {
    // For the left and the right half of each strip, in 16 bits: the sum of both pixels, and the right pixel.
    let [mut both, mut right] = [vdupq_n_u16(0); 2];
    let zero = vdupq_n_u32(0);
    let [mut a1, mut a2, mut a3] = [zero; 3];
    let [mut t1, mut t2, mut h1, mut h2, mut s1] = [zero; 5];
    for ([pixels], ground) in tile.with_background::<1, 16>(16 * quarter, first) {
        let ground = &ground.0.as_chunks::<16>().0[quarter];
        // SAFETY: `pixels` points to 16 initialised bytes; no alignment is required.
        let gray = unsafe { vld1q_u8(pixels.as_ptr()) };
        // SAFETY: `ground` points to 16 initialised bytes; no alignment is required.
        let ground = unsafe { vld1q_u8(ground.as_ptr()) };
        let bright = if tile.dark {
            vqsubq_u8(ground, gray)
        } else {
            vqsubq_u8(gray, ground)
        };
        // 64 rows of twice 255 fit into 16 bits.
        both = vpadalq_u8(both, bright);
        right = vsraq_n_u16::<8>(right, vreinterpretq_u16_u8(bright));
        a1 = vpadalq_u16(a1, both);
        a2 = vaddq_u32(a2, a1);
        a3 = vaddq_u32(a3, a2);
        t1 = vsraq_n_u32::<16>(t1, vreinterpretq_u32_u16(both));
        t2 = vaddq_u32(t2, t1);
        h1 = vpadalq_u16(h1, right);
        h2 = vaddq_u32(h2, h1);
        s1 = vsraq_n_u32::<16>(s1, vreinterpretq_u32_u16(right));
    }
    let a0 = vpaddlq_u16(both);
    let t0 = vshrq_n_u32::<16>(vreinterpretq_u32_u16(both));
    let h0 = vpaddlq_u16(right);
    let s0 = vshrq_n_u32::<16>(vreinterpretq_u32_u16(right));
    let [a0, a1, a2, a3] = [a0, a1, a2, a3].map(|sum| vreinterpretq_s32_u32(sum));
    let [t0, t1, t2] = [t0, t1, t2].map(|sum| vreinterpretq_s32_u32(sum));
    let [h0, h1, h2] = [h0, h1, h2].map(|sum| vreinterpretq_s32_u32(sum));
    let [s0, s1] = [s0, s1].map(|sum| vreinterpretq_s32_u32(sum));
    let first = |a, t, h| {
        let b = vmlsq_n_s32(vshlq_n_s32::<2>(t), a, 3);
        vaddq_s32(b, vshlq_n_s32::<1>(h))
    };
    let second = |a, t, h, s| {
        let inner = vsubq_s32(vaddq_s32(t, h), vshlq_n_s32::<1>(s));
        vsubq_s32(a, vshlq_n_s32::<1>(inner))
    };
    let d0 = vsubq_s32(vshlq_n_s32::<2>(h0), vaddq_s32(vshlq_n_s32::<1>(t0), a0));
    [
        a0,
        a1,
        a2,
        a3,
        first(a0, t0, h0),
        first(a1, t1, h1),
        first(a2, t2, h2),
        second(a0, t0, h0, s0),
        second(a1, t1, h1, s1),
        d0,
    ]
}

/// Adds the weighted sums of the strips of one quarter to the totals.
#[inline]
#[target_feature(enable = "neon")]
fn add_quarter(
    sums: [int32x4_t; SUMS],
    quarter: usize,
    weights: &TileWeights,
    totals: &mut Totals,
) {
    let sums = sums.map(|sums| vcvtq_f32_s32(sums));
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        let total = &mut total.as_chunks_mut::<LANES>().0[quarter];
        // SAFETY: `total` is 4 `f32`, the 16 bytes read; no alignment is required.
        let mut strips = unsafe { vld1q_f32(total.as_ptr()) };
        for (weights, sums) in weights.iter().zip(sums) {
            let weights = &weights.as_chunks::<LANES>().0[quarter];
            // SAFETY: `weights` is 4 `f32`, the 16 bytes read; no alignment is required.
            let weights = unsafe { vld1q_f32(weights.as_ptr()) };
            strips = vaddq_f32(strips, vmulq_f32(weights, sums));
        }
        // SAFETY: `total` is 4 `f32`, the 16 bytes written; no alignment is required.
        unsafe { vst1q_f32(total.as_mut_ptr(), strips) };
    }
}
