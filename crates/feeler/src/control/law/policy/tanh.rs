//! Vectorisable hyperbolic tangent in single precision, bit-identical on every machine, unlike those of C libraries.

/// Argument at which the approximation reaches 1.
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

/// Computes tanh(x) with a relative error of at most 4e-7, always within -1..1. Uses the rational minimax approximation
/// of Eigen and XLA, which is also used by JAX and TensorFlow.
#[inline]
pub(super) fn tanh(x: f32) -> f32 {
    let x = x.clamp(-SATURATED, SATURATED);
    let square = x * x;
    x * polynomial(&NUMERATOR, square) / polynomial(&DENOMINATOR, square)
}

/// Evaluates `coefficients[0] + coefficients[1] x + …`.
#[inline(always)]
fn polynomial(coefficients: &[f32], x: f32) -> f32 {
    let highest_first = coefficients.iter().rev();
    highest_first.fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::tanh;

    /// Compares with the C library's function in double precision, over the unsaturated range and beyond.
    #[test]
    fn relative_error_is_a_few_units_in_the_last_place() {
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
    fn saturates_at_one() {
        assert_eq!(tanh(f32::MAX), 1.0);
        assert_eq!(tanh(f32::NEG_INFINITY), -1.0);
        assert_eq!(tanh(0.0), 0.0);
        assert!(tanh(1e-30) > 0.0);
    }
}
