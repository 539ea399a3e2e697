//! Configuration of a finger with the three joints of the paper's reference finger.

use super::chain::ChainError;
use serde::{Deserialize, Serialize};

/// Valid range of link lengths (m). The first link may also be 0.
const LINK_RANGE: std::ops::RangeInclusive<f64> = 1e-3..=1.0;

/// Maximum absolute value of a base coordinate (m).
const BASE_RANGE: f64 = 100.0;

/// Maximum absolute value of an angle in a configuration (degrees).
const ANGLE_RANGE_DEG: f64 = 360.0;

/// Configuration of a finger with three joints, as in the experiment file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerConfig {
    /// Origin of the finger base `B`, on the axis of joint 1, in the world `W` (m). Each coordinate is within
    /// -100..100.
    pub base_position: [f64; 3],
    /// Rotation phi1 of the base about its y axis (degrees). The orientation of the base is `Ry(phi1) Rx(phi2)`.
    pub phi1_deg: f64,
    /// Rotation phi2 of the base about its x axis (degrees).
    pub phi2_deg: f64,
    /// Link lengths (m): l2 from the axis of joint 1 to the axis of joint 2 (may be 0), l3 from joint 2 to joint 3,
    /// and l4 from joint 3 to the dome's centre. Each is 0.001..1.
    pub links: [f64; 3],
    /// Lower limits of the joint angles theta1..theta3 (degrees).
    pub joint_lower_deg: [f64; 3],
    /// Upper limits of the joint angles theta1..theta3 (degrees), each above its `joint_lower_deg`.
    pub joint_upper_deg: [f64; 3],
    /// Maximum joint speeds of theta1..theta3 in either direction (rad/s), above 0.
    pub joint_speed_limit: [f64; 3],
}

/// Error returned for an invalid [`FingerConfig`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FingerError {
    /// A value is not finite or out of its range.
    #[error("{field} = {value}: expected {expected}")]
    OutOfRange {
        /// Field of the configuration.
        field: String,
        /// The rejected value.
        value: f64,
        /// Description of the valid values.
        expected: &'static str,
    },
    /// The upper limit of a joint is not above its lower limit.
    #[error(
        "joint_upper_deg[{index}] = {upper_deg}: expected more than joint_lower_deg[{index}] = {lower_deg}"
    )]
    JointLimits {
        /// Index of the joint, from 0.
        index: usize,
        /// Lower limit of the joint (degrees).
        lower_deg: f64,
        /// Upper limit of the joint (degrees).
        upper_deg: f64,
    },
    /// The chain is invalid.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Checks that every value of `config` is finite and within the range documented for its field.
pub(super) fn check(config: &FingerConfig) -> Result<(), FingerError> {
    let in_range = |field: &str, value, good: bool, expected| {
        if good {
            return Ok(());
        }
        Err(FingerError::OutOfRange {
            field: field.to_string(),
            value,
            expected,
        })
    };
    let angle = |field: &str, value: f64| {
        let good = value.abs() <= ANGLE_RANGE_DEG;
        in_range(field, value, good, "-360..360 deg")
    };

    for (index, value) in config.base_position.into_iter().enumerate() {
        let good = value.abs() <= BASE_RANGE;
        in_range(
            &format!("base_position[{index}]"),
            value,
            good,
            "-100..100 m",
        )?;
    }
    angle("phi1_deg", config.phi1_deg)?;
    angle("phi2_deg", config.phi2_deg)?;
    let [l2, l3, l4] = config.links;
    let good = l2 == 0.0 || LINK_RANGE.contains(&l2);
    in_range("links[0]", l2, good, "0 or 0.001..1 m")?;
    let good = LINK_RANGE.contains(&l3);
    in_range("links[1]", l3, good, "0.001..1 m")?;
    let good = LINK_RANGE.contains(&l4);
    in_range("links[2]", l4, good, "0.001..1 m")?;

    for joint in 0..config.joint_lower_deg.len() {
        let lower_deg = config.joint_lower_deg[joint];
        let upper_deg = config.joint_upper_deg[joint];
        angle(&format!("joint_lower_deg[{joint}]"), lower_deg)?;
        angle(&format!("joint_upper_deg[{joint}]"), upper_deg)?;
        if lower_deg >= upper_deg {
            return Err(FingerError::JointLimits {
                index: joint,
                lower_deg,
                upper_deg,
            });
        }
        let speed = config.joint_speed_limit[joint];
        let good = speed > 0.0 && speed.is_finite();
        let field = format!("joint_speed_limit[{joint}]");
        in_range(&field, speed, good, "above 0 rad/s")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config() -> FingerConfig {
        FingerConfig {
            base_position: [-0.144, 0.0, 0.06],
            phi1_deg: 0.0,
            phi2_deg: 0.0,
            links: [0.025, 0.05, 0.055],
            joint_lower_deg: [-45.0, -30.0, -120.0],
            joint_upper_deg: [45.0, 120.0, -10.0],
            joint_speed_limit: [3.0; 3],
        }
    }

    #[test]
    fn bad_values_are_named() {
        let mut bad = config();
        bad.links[2] = -0.055;
        let message = check(&bad).unwrap_err().to_string();
        assert_eq!(message, "links[2] = -0.055: expected 0.001..1 m");

        let mut bad = config();
        bad.phi1_deg = f64::NAN;
        assert!(check(&bad).is_err());

        let mut bad = config();
        bad.joint_upper_deg[1] = -30.0;
        let message = check(&bad).unwrap_err().to_string();
        assert_eq!(
            message,
            "joint_upper_deg[1] = -30: expected more than joint_lower_deg[1] = -30"
        );
    }

    #[test]
    fn unknown_keys_are_refused() {
        let mut text = toml::to_string(&config()).unwrap();
        assert_eq!(toml::from_str::<FingerConfig>(&text).unwrap(), config());
        text.push_str("phi3_deg = 1.0\n");
        assert!(toml::from_str::<FingerConfig>(&text).is_err());
    }
}
