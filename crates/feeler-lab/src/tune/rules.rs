//! Rules that compute the settings of a hand from dimensionless groups.
//!
//! Each setting is a physical quantity times a coefficient times a power of each [group](groups). The coefficients and
//! exponents were fitted with CMA-ES over 512 plausible hands (seeds 400 to 403 of the group `apparatus`);
//! `docs/tuning.md` reports the success rate on other hands.

use super::hand::Hand;

/// Number of independently tuned settings.
pub const SETTINGS: usize = 9;
/// Number of dimensionless groups.
pub const GROUPS: usize = 6;
/// Reference value of each dimensionless group. If all groups of a hand have these values, a rule evaluates to its
/// coefficient.
const REFERENCE: [f64; GROUPS] = [0.5, 1.0, 0.78, 16.6, 1.0, 0.003];

/// Computes the dimensionless groups of a hand: k_t / k_n, mu_s, mu_k / mu_s, contact radius over an element's
/// deflection at its rated force, drive lag over control period, force noise over rated force.
pub fn groups(hand: &Hand) -> [f64; GROUPS] {
    let deflection = hand.rated_force / hand.normal_stiffness;
    [
        hand.shear_stiffness / hand.normal_stiffness,
        hand.static_friction,
        hand.kinetic_friction / hand.static_friction,
        hand.contact_radius / deflection,
        hand.servo_lag / hand.period,
        hand.force_noise / hand.rated_force,
    ]
}

/// A rule for one ratio: a coefficient times a power of each dimensionless group.
#[derive(Debug, Clone, Copy)]
pub struct Rule {
    /// The computed ratio, such as `v_r / v_m`.
    pub name: &'static str,
    /// Physical reason for the ratio.
    pub reason: &'static str,
    coefficient: f64,
    exponents: [f64; GROUPS],
}

impl Rule {
    /// Evaluates the rule for a hand with these `groups`.
    pub fn value(&self, groups: &[f64; GROUPS]) -> f64 {
        let powers = groups.iter().zip(REFERENCE).zip(self.exponents);
        // The lower limit avoids infinite powers of zero lag or noise.
        let powers = powers.map(|((g, reference), e)| (g / reference).max(0.05).powf(e));
        self.coefficient * powers.product::<f64>()
    }
}

const fn rule(
    name: &'static str,
    reason: &'static str,
    coefficient: f64,
    exponents: [f64; GROUPS],
) -> Rule {
    Rule {
        name,
        reason,
        coefficient,
        exponents,
    }
}

/// The rules, in the order of the fields of [`Settings`](super::settings::Settings).
pub const RULES: [Rule; SETTINGS] = [
    rule(
        "F2 / rated force",
        "no element is loaded beyond its rating",
        1.0,
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ),
    rule(
        "v_m T / contact radius",
        "the drives' lag and one control period must not carry the finger off the arc",
        0.00147,
        [-0.02, 0.0, -0.34, -0.83, -0.22, 0.21],
    ),
    rule(
        "dr / (k_t v_m)",
        "sticking contacts are loaded at k_t v_m, so only slips exceed dr",
        3.48,
        [0.0, 0.19, -0.15, -0.08, 0.22, 0.07],
    ),
    rule(
        "v_r / v_m",
        "slips press the finger inward as fast as the arc recedes",
        0.521,
        [-0.36, 0.0, -0.11, 0.44, 0.24, 0.03],
    ),
    rule(
        "minimum grasp force / F2",
        "a weak grasp is restored before it slips away",
        0.273,
        [0.0, 0.21, 0.0, 0.84, 0.03, -0.24],
    ),
    rule(
        "grasp force / F2",
        "the stroke begins near the grip at which OVER levels off",
        1.423,
        [0.0, 0.01, 0.0, 0.13, 0.06, 0.0],
    ),
    rule(
        "v_0 / v_m",
        "the drives' lag must not press the finger far beyond the grasp",
        0.202,
        [0.0, 0.0, 0.0, 0.12, 0.0, 0.0],
    ),
    rule(
        "travel / contact radius",
        "the stroke stays on the part of the arc that slips can follow",
        0.248,
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ),
    rule(
        "start / contact radius",
        "slips only press inward, so the stroke begins before its tangent point",
        0.0216,
        [0.0, 0.0, 0.0, -0.3, -0.65, 0.0],
    ),
];
