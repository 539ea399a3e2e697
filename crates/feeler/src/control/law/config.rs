//! Selection and parameters of the control law.

use super::best::{Best, BestConfig};
use super::missing_shear::{MissingShear, MissingShearConfig};
use super::normal_only::{NormalOnly, NormalOnlyConfig};
use super::open_loop::{OpenLoop, OpenLoopConfig};
use super::pivot::{Pivot, PivotConfig};
use super::policy::{Policy, PolicyConfig};
use super::tri_axial::{Reflex, TriAxialLaw};
use super::{FingerLaws, HandLaw, Law};
use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use crate::hand::FingerGeometry;
use crate::sensor::fingertip::layout::ElementLayout;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Error of creating a control law.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LawError {
    /// The policy's file has not been loaded.
    #[error("the policy {file:?} has not been loaded")]
    NotRead {
        /// Path of the file.
        file: String,
    },
    /// The policy was made for other fingertips.
    #[error("expected a policy for fingertips of {expected} elements, got {file:?} for {actual}")]
    Elements {
        /// Path of the policy's file.
        file: String,
        /// Number of elements of the finger.
        expected: usize,
        /// Number of elements that the policy requires.
        actual: usize,
    },
    /// The policy was made for fingers with another number of joints.
    #[error("expected a policy for fingers of {expected} joints, got {file:?} for {actual}")]
    Joints {
        /// Path of the policy's file.
        file: String,
        /// Number of joints of the finger.
        expected: usize,
        /// Number of joints that the policy requires.
        actual: usize,
    },
}

/// Control law. An experiment file contains either its name, as in `law = "best"`, or its name with parameters, as in
/// `law.best = { margin = 1.5 }`.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawConfig {
    /// The paper's law (Fig. 5): re-compression after slip, which is detected from the shear rate.
    #[default]
    TriAxial,
    /// The paper's re-compression, with slip detected from missing shear.
    TriAxialMissingShear(MissingShearConfig),
    /// Grasp force control that uses compression only, with an assumed friction and load.
    NormalOnly(NormalOnlyConfig),
    /// Follows the plan without tactile feedback.
    OpenLoop(OpenLoopConfig),
    /// Increases the grip before slip, with friction estimated during contact.
    Best(BestConfig),
    /// Turns the object with all fingers about a pivot that is estimated from contact points.
    Pivot(PivotConfig),
    /// Neural network, loaded from a file.
    Policy(PolicyConfig),
}

impl LawConfig {
    /// Names of the laws that require no file.
    pub const NAMES: [&str; 6] = [
        "tri-axial",
        "tri-axial-missing-shear",
        "normal-only",
        "open-loop",
        "best",
        "pivot",
    ];

    /// Law with this name and default parameters; `None` if there is no such law.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "tri-axial" => Self::TriAxial,
            "tri-axial-missing-shear" => Self::TriAxialMissingShear(MissingShearConfig::default()),
            "normal-only" => Self::NormalOnly(NormalOnlyConfig::default()),
            "open-loop" => Self::OpenLoop(OpenLoopConfig::default()),
            "best" => Self::Best(BestConfig::default()),
            "pivot" => Self::Pivot(PivotConfig::default()),
            _ => return None,
        })
    }

    /// Name of the law in experiment files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::TriAxial => "tri-axial",
            Self::TriAxialMissingShear(_) => "tri-axial-missing-shear",
            Self::NormalOnly(_) => "normal-only",
            Self::OpenLoop(_) => "open-loop",
            Self::Best(_) => "best",
            Self::Pivot(_) => "pivot",
            Self::Policy(_) => "policy",
        }
    }

    /// Source code of the law, whose size is listed in reports; `None` for a law loaded from a file.
    pub fn source(&self) -> Option<&'static str> {
        Some(match self {
            Self::TriAxial => include_str!("tri_axial.rs"),
            // Includes the slip detector, which no other law uses.
            Self::TriAxialMissingShear(_) => concat!(
                include_str!("tri_axial.rs"),
                include_str!("missing_shear.rs"),
                include_str!("../slip_detector.rs"),
            ),
            Self::NormalOnly(_) => include_str!("normal_only.rs"),
            Self::OpenLoop(_) => include_str!("open_loop.rs"),
            Self::Best(_) => include_str!("best.rs"),
            Self::Pivot(_) => concat!(
                include_str!("pivot/mod.rs"),
                include_str!("pivot/circle.rs"),
                include_str!("pivot/course.rs"),
                include_str!("pivot/finger.rs"),
                include_str!("pivot/finger/closing.rs"),
                include_str!("pivot/friction.rs"),
                include_str!("pivot/needed_grip.rs"),
                include_str!("pivot/stiffness.rs"),
                include_str!("pivot/stroke.rs"),
            ),
            Self::Policy(_) => return None,
        })
    }

    /// Checks that all values are in their ranges. `key` is the table that contains the law; `thresholds` defines F1
    /// and F2.
    pub fn check(&self, key: &str, thresholds: &FlagThresholds, checker: &mut Checker) {
        let key = format!("{key}.{}", self.name());
        match self {
            Self::TriAxial => {}
            Self::TriAxialMissingShear(law) => law.check(&key, checker),
            Self::NormalOnly(law) => law.check(&key, checker),
            Self::OpenLoop(law) => law.check(&key, checker),
            Self::Best(law) => law.check(&key, thresholds, checker),
            Self::Pivot(law) => law.check(&key, checker),
            // The file is checked when it is loaded.
            Self::Policy(_) => {}
        }
    }

    /// Creates the control law for a hand whose fingers have the elements of `layouts`, in its initial state.
    /// `thresholds` defines F1 and F2.
    ///
    /// # Errors
    /// If a policy file has not been loaded, or the policy was made for other fingertips.
    pub fn hand_law(
        &self,
        reflex: Reflex,
        thresholds: &FlagThresholds,
        layouts: &[ElementLayout],
    ) -> Result<Box<dyn HandLaw>, LawError> {
        if let Self::Pivot(config) = self {
            return Ok(Box::new(Pivot::new(config, thresholds, layouts)));
        }
        let law = match self.clone() {
            Self::Best(config) => Self::Best(config.limited_to(thresholds.over_force)),
            other => other,
        };
        let finger_law = |layout: &ElementLayout| {
            law.finger_law(reflex, thresholds.touch_force, layout.elements.len())
        };
        let laws = layouts
            .iter()
            .map(finger_law)
            .collect::<Result<Option<_>, _>>()?;
        Ok(Box::new(FingerLaws::new(laws.unwrap_or_default())))
    }

    /// Checks that a policy was made for the number of joints of each of the `fingers`. Other laws work for any finger.
    ///
    /// # Errors
    /// Returns [`LawError::Joints`] if it was not.
    pub fn check_joints(&self, fingers: &[FingerGeometry]) -> Result<(), LawError> {
        let Self::Policy(PolicyConfig {
            file,
            model: Some(model),
        }) = self
        else {
            return Ok(());
        };
        let joints = fingers.iter().map(FingerGeometry::joint_count);
        match joints.into_iter().find(|&joints| joints != model.joints()) {
            None => Ok(()),
            Some(expected) => Err(LawError::Joints {
                file: file.clone(),
                expected,
                actual: model.joints(),
            }),
        }
    }

    /// Creates the law for one finger of `elements` elements, in its initial state. Elements are in contact at
    /// compressions above `touch_force` (F1, N). Returns `None` if the law moves all fingers together.
    ///
    /// # Errors
    /// If a policy file has not been loaded, or the policy was made for other fingertips.
    pub fn finger_law(
        &self,
        reflex: Reflex,
        touch_force: f64,
        elements: usize,
    ) -> Result<Option<Box<dyn Law>>, LawError> {
        Ok(Some(match self {
            Self::TriAxial => Box::new(TriAxialLaw::new(reflex)),
            Self::TriAxialMissingShear(config) => {
                Box::new(MissingShear::new(config, reflex, touch_force, elements))
            }
            Self::NormalOnly(config) => Box::new(NormalOnly::new(config.clone())),
            Self::OpenLoop(config) => Box::new(OpenLoop::new(config.clone())),
            Self::Best(config) => Box::new(Best::new(config.clone(), elements)),
            Self::Policy(config) => Box::new(policy(config, elements)?),
            Self::Pivot(_) => return Ok(None),
        }))
    }
}

fn policy(config: &PolicyConfig, elements: usize) -> Result<Policy, LawError> {
    let file = config.file.clone();
    match &config.model {
        None => Err(LawError::NotRead { file }),
        Some(model) if model.elements() == elements => Ok(Policy::new(model.clone())),
        Some(model) => Err(LawError::Elements {
            file,
            expected: elements,
            actual: model.elements(),
        }),
    }
}

impl<'de> Deserialize<'de> for LawConfig {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NameOrTable)
    }
}

/// Law as a table of an experiment file; exactly one field must be set.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Laws {
    tri_axial_missing_shear: Option<MissingShearConfig>,
    normal_only: Option<NormalOnlyConfig>,
    open_loop: Option<OpenLoopConfig>,
    best: Option<BestConfig>,
    pivot: Option<PivotConfig>,
    policy: Option<PolicyConfig>,
}

struct NameOrTable;

impl<'de> Visitor<'de> for NameOrTable {
    type Value = LawConfig;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = LawConfig::NAMES.join(", ");
        write!(
            f,
            "a control law: one of {names}, or a table as in law.best = {{ margin = 1.5 }} or law.policy = {{ file = \"my.safetensors\" }}"
        )
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<LawConfig, E> {
        LawConfig::named(name).ok_or_else(|| {
            let names = LawConfig::NAMES.join(", ");
            E::custom(format!(
                "unknown control law {name:?}: expected one of {names}, or law.policy with a file"
            ))
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<LawConfig, A::Error> {
        let laws = Laws::deserialize(MapAccessDeserializer::new(map))?;
        let found = [
            laws.tri_axial_missing_shear
                .map(LawConfig::TriAxialMissingShear),
            laws.normal_only.map(LawConfig::NormalOnly),
            laws.open_loop.map(LawConfig::OpenLoop),
            laws.best.map(LawConfig::Best),
            laws.pivot.map(LawConfig::Pivot),
            laws.policy.map(LawConfig::Policy),
        ];
        let mut found = found.into_iter().flatten();
        match (found.next(), found.next()) {
            (Some(law), None) => Ok(law),
            _ => Err(A::Error::custom(
                "expected exactly one control law, as in law.best = { margin = 1.5 }",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_of_best_is_at_most_f2() {
        let force = |over| BestConfig::default().limited_to(over).element_force;
        let own = BestConfig::default().element_force;
        assert_eq!((force(0.5 * own), force(2.0 * own)), (0.5 * own, own));
    }
}
