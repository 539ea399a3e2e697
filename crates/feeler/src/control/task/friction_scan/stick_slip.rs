//! Friction from the angle of one element's force while it sticks and slips.
//!
//! The angle is that of the force on the feeler against the pressing direction, in the plane of pressing and
//! sliding, positive where friction acts. While the feeler sticks it rises; when it slips it falls. On a surface that is
//! tilted by `t` in that plane it is `atan(mu) + t` one way and `atan(mu) - t` the other way, so that
//! half their sum is the angle of friction, whatever the tilt.

use super::angle_sum::AngleSum;

/// A fall is taken for a slip if noise alone would make it once in some millions of frames: 5 standard
/// deviations of a difference of two frames.
const FALL: f64 = 5.0 * std::f64::consts::SQRT_2;
/// Slips are looked at one by one if they stand out twice as far as what counts as a fall: hardly one is
/// then missed, and noise does not choose which.
const CLEAR: f64 = 2.0 * FALL;
/// A feeler slides if its angle has not been higher for so many frames.
const NO_HIGHER: u32 = 20;

/// What the angle did while a finger slid one way, in one stroke or several.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slips {
    /// The angle at the last frame before each fall, rad.
    before: AngleSum,
    /// The angle at the first frame after it, rad.
    after: AngleSum,
    /// What the angle rose by from frame to frame between falls, rad.
    rise: AngleSum,
    /// The angle at all frames since the feeler began to slide, rad.
    sliding: AngleSum,
}

/// Follows the angle through one stroke.
#[derive(Debug, Clone, Copy)]
pub struct StickSlip {
    /// Variance of the angle at rest, rad².
    noise: f64,
    previous: Option<f64>,
    highest: f64,
    frames_since_highest: u32,
    slides: bool,
}

impl StickSlip {
    /// For a stroke of an element whose angle has this variance at rest, rad².
    pub fn new(noise: f64) -> Self {
        Self {
            noise,
            previous: None,
            highest: f64::NEG_INFINITY,
            frames_since_highest: 0,
            slides: false,
        }
    }

    /// Whether the feeler has slipped at least once.
    pub fn slides(&self) -> bool {
        self.slides
    }

    /// Takes in the angle at the next frame, rad, and adds what it shows to `slips`.
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

/// The highest angle at which the feeler sticks and the one that it slips back to, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limits {
    highest: f64,
    lowest: f64,
}

impl Slips {
    /// Falls of the angle that stood out of its noise.
    pub fn falls(&self) -> u64 {
        self.before.count()
    }

    /// Both limits from the falls, if they stand out clearly of noise of this variance, rad².
    ///
    /// A fall is anywhere between two frames, so the angle rises by half a frame's share before it on average, and by
    /// the other half after it.
    fn limits_by_falls(&self, noise: f64) -> Option<Limits> {
        let half = 0.5 * self.rise.mean()?;
        let limits = Limits {
            highest: self.before.mean()? + half,
            lowest: self.after.mean()? - half,
        };
        (limits.highest - limits.lowest > CLEAR * noise.sqrt()).then_some(limits)
    }

    /// Both limits from the spread of the angle: between them it rises evenly, whenever frames are taken.
    /// Where it only slides, without sticking, both are its mean.
    fn limits_by_spread(&self, noise: f64) -> Option<Limits> {
        let mean = self.sliding.mean()?;
        let half = (3.0 * (self.sliding.variance()? - noise).max(0.0)).sqrt();
        Some(Limits {
            highest: mean + half,
            lowest: mean - half,
        })
    }
}

/// What sliding both ways over a surface tells of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionEstimate {
    /// Coefficient while it sticks.
    pub static_friction: f64,
    /// Coefficient while it slips.
    pub kinetic_friction: f64,
    /// How much the surface is tilted in the plane of pressing and sliding, rad; positive where it rises against a
    /// finger that slides forward.
    pub tilt: f64,
}

impl FrictionEstimate {
    /// From what the angle did forward and backward, with noise of this variance, rad²; none unless the
    /// feeler slid both ways.
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
        let coefficient = |one: f64, other: f64| (0.5 * (one + other)).tan();
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

    /// A surface, and how a feeler is drawn over it.
    #[derive(Clone, Copy)]
    struct Drawn {
        static_friction: f64,
        kinetic_friction: f64,
        tilt: f64,
        /// What shear by compression grows by from frame to frame.
        rise: f64,
        /// Standard deviation of the angle, rad.
        noise: f64,
    }

    const FRAMES: usize = 1000;

    /// What is seen of one way: shear by compression in closed form, a line that falls from one limit to
    /// the other wherever it meets it.
    fn slips(drawn: &Drawn, tilt: f64, random: &mut Pcg64) -> Slips {
        let (mut slips, mut stick_slip) = (Slips::default(), StickSlip::new(drawn.noise.powi(2)));
        let (highest, drop) = (
            drawn.static_friction,
            drawn.static_friction - drawn.kinetic_friction,
        );
        // The way before left it at the other limit.
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
                // A fall is at any time between two frames: its place has this standard deviation in friction, and
                // the noise adds to it; four of the mean's.
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
        // The spread of 0.02 has variance 0.02² / 12 = 3.3e-5 beside the noise's 2.5e-5; of 2000 frames, theirs is known
        // to 5.8e-5 sqrt(2 / 2000) = 1.8e-6, so half the spread, 0.01, to 3 %, and the mean to 2e-4.
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
        // The frames until it is known to slide belong to the slide; rounding is all that is left.
        assert!((found.static_friction - 0.6).abs() < 1e-9, "{found:?}");
        assert!((found.kinetic_friction - 0.6).abs() < 1e-9, "{found:?}");
        assert!((found.tilt + 0.03).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn what_only_rises_does_not_slide_and_one_way_is_not_enough() {
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
