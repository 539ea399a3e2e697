//! The hyperbolic tangent in single precision: the same bits on every machine, which no C library promises, and many
//! values at a time.

/// Where the approximation reaches 1.
const SATURATED: f32 = 7.905_311;

/// Coefficients of x, x³, …, x¹³ in the numerator.
const NUMERATOR: [f32; 7] = [
    4.893_524_6e-3,
    6.372_619_3e-4,
    1.485_722_4e-5,
    5.122_297e-8,
    -8.604_672e-11,
    2.000_188e-13,
    -2.760_768_5e-16,
];

/// Coefficients of 1, x², x⁴, x⁶ in the denominator.
const DENOMINATOR: [f32; 4] = [4.893_525e-3, 2.268_434_6e-3, 1.185_347_1e-4, 1.198_258_4e-6];

/// tanh(x) to 4e-7 of itself; never beyond -1 to 1. The minimax fraction of Eigen and XLA, by which networks that are trained
/// with JAX or TensorFlow were evaluated, too.
#[inline]
pub(super) fn tanh(x: f32) -> f32 {
    let x = x.clamp(-SATURATED, SATURATED);
    let square = x * x;
    x * polynomial(&NUMERATOR, square) / polynomial(&DENOMINATOR, square)
}

/// `coefficients[0] + coefficients[1] x + …`
#[inline(always)]
fn polynomial(coefficients: &[f32], x: f32) -> f32 {
    let highest_first = coefficients.iter().rev();
    highest_first.fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::tanh;

    /// Against the C library's in double precision, over all that is not saturated and beyond.
    #[test]
    fn it_is_the_hyperbolic_tangent_to_a_few_units_of_the_last_place() {
        let (mut worst, steps) = (0.0_f64, 200_000);
        for step in -steps..=steps {
            let x = 12.0 * step as f32 / steps as f32;
            let (found, expected) = (f64::from(tanh(x)), f64::from(x).tanh());
            assert!(found.abs() <= 1.0, "{x}: {found}");
            assert_eq!(tanh(-x), -tanh(x), "{x}");
            if x != 0.0 {
                worst = worst.max(((found - expected) / expected).abs());
            }
        }
        assert!(worst < 4e-7, "{worst}");
    }

    #[test]
    fn it_ends_at_one() {
        assert_eq!(tanh(f32::MAX), 1.0);
        assert_eq!(tanh(f32::NEG_INFINITY), -1.0);
        assert_eq!(tanh(0.0), 0.0);
        assert!(tanh(1e-30) > 0.0);
    }
}
