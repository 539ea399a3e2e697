//! Configuration of a finger with any kinematics, as in the experiment file.

use super::chain::{ChainConfig, DhRow, FrameRow, JointConfig};
use super::finger::FingerConfig;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Configuration of a finger: the three joints of the reference finger (paper, section III), or a chain of one to seven
/// joints. A table with the key `joints` describes a chain.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FingerDescription {
    /// The three joints of the reference finger.
    ThreeJoints(FingerConfig),
    /// One to seven joints of any arrangement.
    Chain(ChainConfig),
}

impl FingerDescription {
    /// Configuration of the three joints of the reference finger; `None` for a chain.
    pub fn three_joints(&self) -> Option<&FingerConfig> {
        match self {
            Self::ThreeJoints(config) => Some(config),
            Self::Chain(_) => None,
        }
    }

    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        match self {
            Self::ThreeJoints(config) => config.joint_lower_deg.len(),
            Self::Chain(config) => config.joints.len(),
        }
    }

    /// `true` for each joint whose position is a displacement (m), `false` for an angle (rad).
    pub fn is_prismatic(&self) -> Vec<bool> {
        match self {
            Self::ThreeJoints(_) => vec![false; self.joint_count()],
            Self::Chain(config) => config.is_prismatic(),
        }
    }
}

impl From<FingerConfig> for FingerDescription {
    fn from(config: FingerConfig) -> Self {
        Self::ThreeJoints(config)
    }
}

impl From<ChainConfig> for FingerDescription {
    fn from(config: ChainConfig) -> Self {
        Self::Chain(config)
    }
}

/// Keys of both kinds of tables.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    base_position: Option<[f64; 3]>,
    phi1_deg: Option<f64>,
    phi2_deg: Option<f64>,
    links: Option<[f64; 3]>,
    joint_lower_deg: Option<[f64; 3]>,
    joint_upper_deg: Option<[f64; 3]>,
    joint_speed_limit: Option<[f64; 3]>,
    base_rpy: Option<[f64; 3]>,
    joints: Option<Vec<JointConfig>>,
    dh: Option<Vec<DhRow>>,
    frames: Option<Vec<FrameRow>>,
    tip_position: Option<[f64; 3]>,
    tip_rpy: Option<[f64; 3]>,
    damping_threshold: Option<f64>,
}

const KEYS: &[&str] = &[
    "base_position",
    "phi1_deg",
    "phi2_deg",
    "links",
    "joint_lower_deg",
    "joint_upper_deg",
    "joint_speed_limit",
    "base_rpy",
    "joints",
    "dh",
    "frames",
    "tip_position",
    "tip_rpy",
    "damping_threshold",
];

impl Keys {
    fn chain<E: Error>(self, joints: Vec<JointConfig>) -> Result<ChainConfig, E> {
        let foreign = [
            ("phi1_deg", self.phi1_deg.is_some()),
            ("phi2_deg", self.phi2_deg.is_some()),
            ("links", self.links.is_some()),
            ("joint_lower_deg", self.joint_lower_deg.is_some()),
            ("joint_upper_deg", self.joint_upper_deg.is_some()),
            ("joint_speed_limit", self.joint_speed_limit.is_some()),
        ];
        only(&foreign, "without the key `joints`")?;
        Ok(ChainConfig {
            base_position: required(self.base_position, "base_position")?,
            base_rpy: self.base_rpy.unwrap_or_default(),
            joints,
            dh: self.dh.unwrap_or_default(),
            frames: self.frames.unwrap_or_default(),
            tip_position: self.tip_position.unwrap_or_default(),
            tip_rpy: self.tip_rpy.unwrap_or_default(),
            damping_threshold: self.damping_threshold,
        })
    }

    fn three_joints<E: Error>(self) -> Result<FingerConfig, E> {
        let foreign = [
            ("base_rpy", self.base_rpy.is_some()),
            ("dh", self.dh.is_some()),
            ("frames", self.frames.is_some()),
            ("tip_position", self.tip_position.is_some()),
            ("tip_rpy", self.tip_rpy.is_some()),
            ("damping_threshold", self.damping_threshold.is_some()),
        ];
        only(&foreign, "with the key `joints`")?;
        Ok(FingerConfig {
            base_position: required(self.base_position, "base_position")?,
            phi1_deg: required(self.phi1_deg, "phi1_deg")?,
            phi2_deg: required(self.phi2_deg, "phi2_deg")?,
            links: required(self.links, "links")?,
            joint_lower_deg: required(self.joint_lower_deg, "joint_lower_deg")?,
            joint_upper_deg: required(self.joint_upper_deg, "joint_upper_deg")?,
            joint_speed_limit: required(self.joint_speed_limit, "joint_speed_limit")?,
        })
    }
}

fn required<T, E: Error>(value: Option<T>, key: &'static str) -> Result<T, E> {
    value.ok_or_else(|| E::missing_field(key))
}

/// Rejects keys that belong to the other kind of table.
fn only<E: Error>(foreign: &[(&str, bool)], place: &str) -> Result<(), E> {
    match foreign.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(E::custom(format!("`{key}`: expected only {place}"))),
        None => Ok(()),
    }
}

/// Visitor that reports missing keys at the position of the table, as derived implementations do.
struct Table;

impl<'de> Visitor<'de> for Table {
    type Value = FingerDescription;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("struct FingerConfig")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let mut keys = Keys::deserialize(MapAccessDeserializer::new(map))?;
        match keys.joints.take() {
            Some(joints) => keys.chain(joints).map(FingerDescription::Chain),
            None => keys.three_joints().map(FingerDescription::ThreeJoints),
        }
    }
}

impl<'de> Deserialize<'de> for FingerDescription {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_struct("FingerConfig", KEYS, Table)
    }
}
