//! The sums of a tile by the vector instructions of x86-64 processors.

use super::{
    ElementMoments, MomentsKernel,
    sum::{TileRows, Totals, all_elements},
    tile::{ACROSS, STRIPS, TILE_WIDTH, TileWeights},
};
use std::arch::x86_64::*;

/// [`ACROSS`], the factors of a strip's pixels in the bytes of one integer.
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

/// Takes the moments with AVX-512: 64 pixels to an instruction.
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
pub(super) fn avx512_vnni(kernel: &MomentsKernel, pixels: &[u8], moments: &mut [ElementMoments]) {
    all_elements(kernel, pixels, moments, |rows, weights, totals| {
        avx512_add_tile(rows, weights, totals);
    });
}

/// Takes the moments with AVX2: 32 pixels to an instruction.
#[target_feature(enable = "avx2")]
pub(super) fn avx2(kernel: &MomentsKernel, pixels: &[u8], moments: &mut [ElementMoments]) {
    all_elements(kernel, pixels, moments, |rows, weights, totals| {
        avx2_add_half::<0>(rows, weights, totals);
        if rows.masks.iter().any(|mask| mask >> HALF != 0) {
            avx2_add_half::<1>(rows, weights, totals);
        }
    });
}

#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
fn avx512_add_tile(tile: &TileRows, weights: &TileWeights, totals: &mut Totals) {
    let dark = _mm512_set1_epi8(tile.dark_level.cast_signed());
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
    let mut padding = [0; TILE_WIDTH];
    for (row, &mask) in tile.masks.iter().enumerate() {
        let pixels = tile.row(row, &mut padding);
        // SAFETY: `pixels` points to 64 bytes that are initialised; any alignment will do.
        let gray = unsafe { _mm512_loadu_si512(pixels.as_ptr().cast()) };
        let bright = _mm512_maskz_subs_epu8(mask, gray, dark);
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
        // SAFETY: `total` is 16 `f32`, the 64 bytes that are read; any alignment will do.
        let mut strips = unsafe { _mm512_loadu_ps(total.as_ptr()) };
        for (weights, sums) in weights.iter().zip(sums) {
            // SAFETY: `weights` is 16 `f32`, the 64 bytes that are read; any alignment will do.
            let weights = unsafe { _mm512_loadu_ps(weights.as_ptr()) };
            strips = _mm512_add_ps(strips, _mm512_mul_ps(weights, _mm512_cvtepi32_ps(sums)));
        }
        // SAFETY: `total` is 16 `f32`, the 64 bytes that are written; any alignment will do.
        unsafe { _mm512_storeu_ps(total.as_mut_ptr(), strips) };
    }
}

/// Columns of half a tile, px.
const HALF: usize = TILE_WIDTH / 2;

/// Adds what the left (`SIDE` = 0) or right half of a tile counts for.
#[inline]
#[target_feature(enable = "avx2")]
fn avx2_add_half<const SIDE: usize>(tile: &TileRows, weights: &TileWeights, totals: &mut Totals) {
    let dark = _mm256_set1_epi8(tile.dark_level.cast_signed());
    let ones = _mm256_set1_epi16(1);
    let [k0, k1, k2, k3] = FACTORS;
    let k0 = _mm256_set1_epi32(k0);
    let k1 = _mm256_set1_epi32(k1);
    let k2 = _mm256_set1_epi32(k2);
    let k3 = _mm256_set1_epi32(k3);
    let zero = _mm256_setzero_si256();
    let [mut a0, mut a1, mut a2, mut a3] = [zero; 4];
    let [mut b0, mut b1, mut b2] = [zero; 3];
    let [mut c0, mut c1] = [zero; 2];
    let mut d0 = zero;
    let mut padding = [0; TILE_WIDTH];
    for (row, &mask) in tile.masks.iter().enumerate() {
        let pixels = &tile.row(row, &mut padding).as_chunks::<HALF>().0[SIDE];
        // SAFETY: `pixels` points to 32 bytes that are initialised; any alignment will do.
        let gray = unsafe { _mm256_loadu_si256(pixels.as_ptr().cast()) };
        let own = bytes_of_bits((mask >> (SIDE * HALF)) as u32);
        let bright = _mm256_and_si256(_mm256_subs_epu8(gray, dark), own);
        // Pairs hold 4 * 255 at most, far from where they would saturate.
        let a = _mm256_madd_epi16(_mm256_maddubs_epi16(bright, k0), ones);
        let b = _mm256_madd_epi16(_mm256_maddubs_epi16(bright, k1), ones);
        let c = _mm256_madd_epi16(_mm256_maddubs_epi16(bright, k2), ones);
        let d = _mm256_madd_epi16(_mm256_maddubs_epi16(bright, k3), ones);
        a0 = _mm256_add_epi32(a0, a);
        a1 = _mm256_add_epi32(a1, a0);
        a2 = _mm256_add_epi32(a2, a1);
        a3 = _mm256_add_epi32(a3, a2);
        b0 = _mm256_add_epi32(b0, b);
        b1 = _mm256_add_epi32(b1, b0);
        b2 = _mm256_add_epi32(b2, b1);
        c0 = _mm256_add_epi32(c0, c);
        c1 = _mm256_add_epi32(c1, c0);
        d0 = _mm256_add_epi32(d0, d);
    }
    let sums = [a0, a1, a2, a3, b0, b1, b2, c0, c1, d0];
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        let total = &mut total.as_chunks_mut::<{ STRIPS / 2 }>().0[SIDE];
        // SAFETY: `total` is 8 `f32`, the 32 bytes that are read; any alignment will do.
        let mut strips = unsafe { _mm256_loadu_ps(total.as_ptr()) };
        for (weights, sums) in weights.iter().zip(sums) {
            let weights = &weights.as_chunks::<{ STRIPS / 2 }>().0[SIDE];
            // SAFETY: `weights` is 8 `f32`, the 32 bytes that are read; any alignment will do.
            let weights = unsafe { _mm256_loadu_ps(weights.as_ptr()) };
            strips = _mm256_add_ps(strips, _mm256_mul_ps(weights, _mm256_cvtepi32_ps(sums)));
        }
        // SAFETY: `total` is 8 `f32`, the 32 bytes that are written; any alignment will do.
        unsafe { _mm256_storeu_ps(total.as_mut_ptr(), strips) };
    }
}

/// A byte of ones for every bit that is set, the lowest first.
#[inline]
#[target_feature(enable = "avx2")]
fn bytes_of_bits(bits: u32) -> __m256i {
    let which_byte = _mm256_setr_epi64x(
        0,
        0x0101_0101_0101_0101,
        0x0202_0202_0202_0202,
        0x0303_0303_0303_0303,
    );
    let which_bit = _mm256_set1_epi64x(0x8040_2010_0804_0201_u64.cast_signed());
    let spread = _mm256_shuffle_epi8(_mm256_set1_epi32(bits.cast_signed()), which_byte);
    _mm256_cmpeq_epi8(_mm256_and_si256(spread, which_bit), which_bit)
}
