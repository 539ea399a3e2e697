//! Vectorised sine and cosine of joint angles, with identical results on every processor.
//!
//! The system's math library handles one angle at a time, and its last digits differ between processors. No
//! maintained crate vectorises these functions without fixing the processor at compile time. This module uses plain
//! arithmetic, which compilers vectorise, with the same result everywhere.

use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// Maximum angle (rad) for which the range reduction is accurate to 1e-16 rad, because its first product is exact.
const MOST: f64 = 1e5;

/// Quarter turns per radian.
const QUARTERS: f64 = std::f64::consts::FRAC_2_PI;
/// Constant for rounding: if it is added to a number of up to 2^51, the sum is rounded to an integer, whose low bits
/// are the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// The first 33 bits of a quarter turn, and the remainder (fdlibm, `e_rem_pio2.c`).
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// Minimax polynomial S for angles up to an eighth of a turn in magnitude: `sin x = x + x^3 S(x^2)` (fdlibm,
/// `k_sin.c`).
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// Minimax polynomial C for angles up to an eighth of a turn in magnitude: `cos x = 1 - x^2 / 2 + x^4 C(x^2)` (fdlibm,
/// `k_cos.c`).
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Returns the sines and cosines of three `angles` (rad), with an absolute error of at most one unit in the last place
/// of 1.
#[inline(always)]
pub fn sin_cos(angles: DVec3) -> (DVec3, DVec3) {
    if angles.abs().max_element() > MOST {
        let each = angles.to_array().map(libm::sincos);
        return (
            each.map(|(sine, _)| sine).into(),
            each.map(|(_, cosine)| cosine).into(),
        );
    }
    let [x, y, z] = angles.to_array();
    let (sines, cosines) = lanes([x, y, z, 0.0]);
    (
        DVec3::new(sines[0], sines[1], sines[2]),
        DVec3::new(cosines[0], cosines[1], cosines[2]),
    )
}

/// Returns the sine and cosine of one `angle` (rad), bit-identical to those of `sin_cos`.
#[inline(always)]
pub fn sin_cos_of(angle: f64) -> (f64, f64) {
    if angle.abs() > MOST {
        return libm::sincos(angle);
    }
    // Fast path: most angles are small and need no range reduction.
    if angle.abs() < FRAC_PI_4 {
        return (sine_of(angle, 0.0), cosine_of(angle, 0.0));
    }
    let ([sine], [cosine]) = lanes([angle]);
    (sine, cosine)
}

#[inline(always)]
fn lanes<const LANES: usize>(angles: [f64; LANES]) -> ([f64; LANES], [f64; LANES]) {
    let (mut sines, mut cosines) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        let rounded = angles[lane] * QUARTERS + ROUNDER;
        let quarters = rounded - ROUNDER;
        let quadrant = rounded.to_bits();
        let first = angles[lane] - quarters * QUARTER[0];
        let missing = quarters * QUARTER[1];
        let x = first - missing;
        // Rounding error of `x`.
        let rest = (first - x) - missing;
        let (sine, cosine) = (sine_of(x, rest).to_bits(), cosine_of(x, rest).to_bits());
        // Each quarter turn turns the cosine into the sine, and the sine into the negative cosine.
        let odd = 0_u64.wrapping_sub(quadrant & 1);
        let (to_sine, to_cosine) = (sine & !odd | cosine & odd, cosine & !odd | sine & odd);
        sines[lane] = f64::from_bits(to_sine ^ ((quadrant & 2) << 62));
        cosines[lane] = f64::from_bits(to_cosine ^ ((quadrant.wrapping_add(1) & 2) << 62));
    }
    (sines, cosines)
}

/// Sine of `x + rest`, where `rest` is the rounding error of `x`.
#[inline(always)]
fn sine_of(x: f64, rest: f64) -> f64 {
    let [s1, s2, s3, s4, s5, s6] = SINE;
    let z = x * x;
    let w = z * z;
    let r = s2 + z * (s3 + z * s4) + z * w * (s5 + z * s6);
    let v = z * x;
    x - ((z * (0.5 * rest - v * r) - rest) - v * s1)
}

/// Cosine of `x + rest`, where `rest` is the rounding error of `x`.
#[inline(always)]
fn cosine_of(x: f64, rest: f64) -> f64 {
    let [c1, c2, c3, c4, c5, c6] = COSINE;
    let z = x * x;
    let w = z * z;
    let r = z * (c1 + z * (c2 + z * c3)) + w * w * (c4 + z * (c5 + z * c6));
    let half = 0.5 * z;
    let about = 1.0 - half;
    about + (((1.0 - about) - half) + (z * r - x * rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The system's functions are correct to one unit in the last place; these add at most one unit in the last place
    /// of 1.
    const TOLERANCE: f64 = 2.0 * f64::EPSILON;

    fn compare(angle: f64) {
        let (sines, cosines) = sin_cos(DVec3::new(angle, -angle, angle + 1.0));
        for (angle, (sine, cosine)) in [angle, -angle, angle + 1.0]
            .into_iter()
            .zip(sines.to_array().into_iter().zip(cosines.to_array()))
        {
            assert_eq!(sin_cos_of(angle), (sine, cosine));
            let (true_sine, true_cosine) = angle.sin_cos();
            assert!((sine - true_sine).abs() <= TOLERANCE, "sin {angle}: {sine}");
            assert!(
                (cosine - true_cosine).abs() <= TOLERANCE,
                "cos {angle}: {cosine}"
            );
        }
    }

    #[test]
    fn results_match_the_system_library() {
        for step in 0..200_000 {
            compare(f64::from(step) * 1e-4);
            compare(f64::from(step) * 0.499_999);
        }
        // Angles near quadrant boundaries, and beyond the range reduction.
        for quarter in 0..1_000 {
            let angle = f64::from(quarter) * std::f64::consts::FRAC_PI_4;
            for off in [0.0, 1e-16, 1e-12, 1e-8] {
                compare(angle + off);
                compare(angle - off);
            }
        }
        for angle in [MOST, 1.01 * MOST, 1e12, 1e300, f64::MIN_POSITIVE, 0.0] {
            compare(angle);
        }
    }

    #[test]
    fn small_angles_keep_all_their_digits() {
        for exponent in 1..300 {
            let angle = 10_f64.powi(-exponent);
            let (sine, _) = sin_cos(DVec3::splat(angle));
            assert!(
                (sine.x / angle.sin() - 1.0).abs() <= f64::EPSILON,
                "sin {angle}: {sine}"
            );
        }
    }

    #[test]
    fn non_finite_angles_give_nan() {
        for angle in [f64::NAN, f64::INFINITY] {
            let (sine, cosine) = sin_cos(DVec3::new(0.0, angle, 0.0));
            assert!(sine.y.is_nan() && cosine.y.is_nan());
        }
    }
}
