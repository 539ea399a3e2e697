//! Friction coefficients from the force angle of one element that sticks and slips.
//!
//! The angle is measured between the force on the feeler and the pressing direction, in the plane of pressing and
//! sliding, positive in the direction of friction. It rises while the feeler sticks and falls when it slips. On a
//! surface tilted by `t` in that plane it is `atan(mu) + t` in one direction and `atan(mu) - t` in the other, so half
//! their sum is the friction angle, independent of the tilt.

use super::angle_sum::AngleSum;

/// Drop of the angle between two frames that counts as a slip, in standard deviations of the noise: 5 standard
/// deviations of the difference of two frames, which noise alone exceeds once in some millions of frames.
const FALL: f64 = 5.0 * std::f64::consts::SQRT_2;
/// Minimum mean drop of the angle for evaluating individual slips, in standard deviations of the noise, twice [`FALL`]:
/// few slips are then missed, and noise does not bias the selection.
const CLEAR: f64 = 2.0 * FALL;
/// Number of frames without a new maximum of the angle after which a feeler counts as sliding.
const NO_HIGHER: u32 = 20;

/// Statistics of the force angle while a finger slides in one direction, over one or more strokes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slips {
    /// Angle at the last frame before each slip (rad).
    before: AngleSum,
    /// Angle at the first frame after each slip (rad).
    after: AngleSum,
    /// Increase of the angle per frame between slips (rad).
    rise: AngleSum,
    /// Angle at all frames since the feeler began to slide (rad).
    sliding: AngleSum,
}

/// Detects slips from the force angle during one stroke.
#[derive(Debug, Clone, Copy)]
pub struct StickSlip {
    /// Variance of the angle at rest (rad²).
    noise: f64,
    previous: Option<f64>,
    highest: f64,
    frames_since_highest: u32,
    slides: bool,
}

impl StickSlip {
    /// Creates a tracker for a stroke of an element whose angle has the variance `noise` at rest (rad²).
    pub fn new(noise: f64) -> Self {
        Self {
            noise,
            previous: None,
            highest: f64::NEG_INFINITY,
            frames_since_highest: 0,
            slides: false,
        }
    }

    /// Returns whether the feeler has started to slide.
    pub fn slides(&self) -> bool {
        self.slides
    }

    /// Processes the angle at the next frame (rad) and updates `slips`.
    pub fn see(&mut self, angle: f64, slips: &mut Slips) {
        let before = self.previous.replace(angle);
        if angle > self.highest {
            (self.highest, self.frames_since_highest) = (angle, 0);
        } else {
            self.frames_since_highest += 1;
        }
        let Some(before) = before else { return };
        if before - angle > FALL * self.noise.sqrt() {
            slips.before.add(before);
            slips.after.add(angle);
            self.slides = true;
        } else if self.slides {
            slips.rise.add(angle - before);
        }
        self.slides |= self.frames_since_highest >= NO_HIGHER;
        if self.slides {
            slips.sliding.add(angle);
        }
    }
}

/// Angle at which the feeler starts to slip, and angle right after the slip (rad).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limits {
    highest: f64,
    lowest: f64,
}

impl Slips {
    /// Number of slips: drops of the angle that exceed its noise.
    pub fn falls(&self) -> u64 {
        self.before.count()
    }

    /// Computes both limits from the slips; `None` unless the drops clearly exceed noise of variance `noise` (rad²).
    ///
    /// A slip happens at a random time between two frames, so on average the angle rises by half of its increase per
    /// frame before it and by the other half after it.
    fn limits_by_falls(&self, noise: f64) -> Option<Limits> {
        let half = 0.5 * self.rise.mean()?;
        let limits = Limits {
            highest: self.before.mean()? + half,
            lowest: self.after.mean()? - half,
        };
        (limits.highest - limits.lowest > CLEAR * noise.sqrt()).then_some(limits)
    }

    /// Computes both limits from the spread of the angle, which rises uniformly between them. If the element slides
    /// without sticking, both are the mean.
    fn limits_by_spread(&self, noise: f64) -> Option<Limits> {
        let mean = self.sliding.mean()?;
        let half = (3.0 * (self.sliding.variance()? - noise).max(0.0)).sqrt();
        Some(Limits {
            highest: mean + half,
            lowest: mean - half,
        })
    }
}

/// Friction coefficients and tilt of a surface, from sliding over it in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionEstimate {
    /// Static friction coefficient.
    pub static_friction: f64,
    /// Kinetic friction coefficient.
    pub kinetic_friction: f64,
    /// Tilt of the surface in the plane of pressing and sliding (rad), positive if it rises in the forward sliding
    /// direction.
    pub tilt: f64,
}

impl FrictionEstimate {
    /// Estimates friction and tilt from the statistics of both directions, with noise of variance `noise` (rad²).
    /// Returns `None` unless the feeler slid in both directions.
    pub fn estimate(forward: &Slips, backward: &Slips, noise: f64) -> Option<Self> {
        let falls = forward
            .limits_by_falls(noise)
            .zip(backward.limits_by_falls(noise));
        let spread = || {
            forward
                .limits_by_spread(noise)
                .zip(backward.limits_by_spread(noise))
        };
        let (forward, backward) = falls.or_else(spread)?;
        let coefficient = |one: f64, other: f64| libm::tan(0.5 * (one + other));
        Some(Self {
            static_friction: coefficient(forward.highest, backward.highest),
            kinetic_friction: coefficient(forward.lowest, backward.lowest),
            tilt: 0.25 * (forward.highest + forward.lowest - backward.highest - backward.lowest),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64;

    /// A surface, and the motion of a feeler over it.
    #[derive(Clone, Copy)]
    struct Drawn {
        static_friction: f64,
        kinetic_friction: f64,
        tilt: f64,
        /// Growth of the ratio of shear to compression per frame.
        rise: f64,
        /// Standard deviation of the angle (rad).
        noise: f64,
    }

    const FRAMES: usize = 1000;

    /// Simulates one direction: the ratio of shear to compression rises linearly and falls from the static to the
    /// kinetic limit whenever it reaches it.
    fn slips(drawn: &Drawn, tilt: f64, random: &mut Pcg64) -> Slips {
        let (mut slips, mut stick_slip) = (Slips::default(), StickSlip::new(drawn.noise.powi(2)));
        let (highest, drop) = (
            drawn.static_friction,
            drawn.static_friction - drawn.kinetic_friction,
        );
        // The previous stroke left it at the opposite limit.
        let mut built_up = -highest + drawn.rise * random.random::<f64>();
        for _ in 0..FRAMES + (2.0 * highest / drawn.rise) as usize {
            built_up += drawn.rise;
            let beyond = built_up - drawn.kinetic_friction;
            let ratio = match built_up < highest {
                true => built_up,
                false if drop > 0.0 => drawn.kinetic_friction + beyond.rem_euclid(drop),
                false => highest,
            };
            let noise = drawn.noise * random.sample::<f64, _>(StandardNormal);
            stick_slip.see(ratio.atan() + tilt + noise, &mut slips);
        }
        assert!(stick_slip.slides());
        slips
    }

    fn estimate(drawn: &Drawn, random: &mut Pcg64) -> (FrictionEstimate, u64) {
        let forward = slips(drawn, drawn.tilt, random);
        let backward = slips(drawn, -drawn.tilt, random);
        let found = FrictionEstimate::estimate(&forward, &backward, drawn.noise.powi(2));
        (
            found.expect("it slid both ways"),
            forward.falls() + backward.falls(),
        )
    }

    #[test]
    fn clear_slips_give_both_coefficients_on_any_tilt() {
        let mut random = Pcg64::seed_from_u64(1);
        for static_friction in [0.2, 0.5, 1.2] {
            for tilt in [-0.12, 0.0, 0.09] {
                let drawn = Drawn {
                    static_friction,
                    kinetic_friction: 0.7 * static_friction,
                    tilt,
                    rise: 0.007,
                    noise: 0.001,
                };
                let (found, falls) = estimate(&drawn, &mut random);
                // A fall happens at a random time between two frames. The tolerance is four standard deviations of
                // the mean, including the noise.
                let each =
                    drawn.rise / 12_f64.sqrt() + (1.0 + static_friction.powi(2)) * drawn.noise;
                let tolerance = 4.0 * each / (falls as f64).sqrt();
                assert!(falls > 10);
                assert!(
                    (found.static_friction - static_friction).abs() < tolerance,
                    "{found:?}"
                );
                let kinetic = drawn.kinetic_friction;
                assert!(
                    (found.kinetic_friction - kinetic).abs() < tolerance,
                    "{found:?}"
                );
                assert!((found.tilt - tilt).abs() < tolerance, "{found:?}");
                assert!(tolerance < 0.03 * static_friction);
            }
        }
    }

    #[test]
    fn slips_below_the_noise_show_in_the_spread() {
        let drawn = Drawn {
            static_friction: 0.21,
            kinetic_friction: 0.19,
            tilt: 0.05,
            rise: 0.0037,
            noise: 0.005,
        };
        let (found, _) = estimate(&drawn, &mut Pcg64::seed_from_u64(2));
        // The spread of 0.02 has the variance 0.02² / 12 = 3.3e-5, in addition to the noise's 2.5e-5. With 2000
        // frames, the total is known to 5.8e-5 sqrt(2 / 2000) = 1.8e-6, so half the spread, 0.01, to 3 %, and the
        // mean to 2e-4.
        assert!(
            (found.static_friction - 0.21).abs() < 4.0 * 5e-4,
            "{found:?}"
        );
        assert!(
            (found.kinetic_friction - 0.19).abs() < 4.0 * 5e-4,
            "{found:?}"
        );
    }

    #[test]
    fn without_sticking_both_coefficients_are_one() {
        let drawn = Drawn {
            static_friction: 0.6,
            kinetic_friction: 0.6,
            tilt: -0.03,
            rise: 0.004,
            noise: 0.0,
        };
        let (found, falls) = estimate(&drawn, &mut Pcg64::seed_from_u64(3));
        assert_eq!(falls, 0);
        // The frames until sliding is detected belong to the slide; only rounding errors remain.
        assert!((found.static_friction - 0.6).abs() < 1e-9, "{found:?}");
        assert!((found.kinetic_friction - 0.6).abs() < 1e-9, "{found:?}");
        assert!((found.tilt + 0.03).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_rising_angle_is_not_sliding_and_one_direction_is_not_enough() {
        let (mut slips, mut stick_slip) = (Slips::default(), StickSlip::new(1e-6));
        for frame in 0..500 {
            stick_slip.see(-0.5 + 0.002 * f64::from(frame), &mut slips);
        }
        assert!(!stick_slip.slides());
        assert_eq!(slips, Slips::default());
        let drawn = Drawn {
            static_friction: 0.6,
            kinetic_friction: 0.4,
            tilt: 0.0,
            rise: 0.01,
            noise: 0.001,
        };
        let one_way = super::tests::slips(&drawn, 0.0, &mut Pcg64::seed_from_u64(4));
        assert_eq!(FrictionEstimate::estimate(&one_way, &slips, 1e-6), None);
    }
}
