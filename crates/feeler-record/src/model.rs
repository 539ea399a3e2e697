//! What never changes of a rig: how its fingers are built, and what stands around them.

use super::error::RecordError;
use feeler::hand::finger::{FingerConfig, FingerGeometry};
use feeler::sensor::layout::{MAX_ELEMENTS, SensingElement};
use glam::{DAffine3, DMat3, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// The frame that all others hang from: `W`.
pub const WORLD_FRAME: &str = "world";

/// Radius of a drawn link over that of the dome.
const LINK_OVER_DOME: f64 = 0.3;

/// Most solids around a hand, and most corners of an outline; guards against damaged files.
const MAX_SOLIDS: usize = 64;
const MAX_CORNERS: usize = 20_000;

/// How a finger is built.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FingerModel {
    /// Its base, links and limits.
    pub geometry: FingerConfig,
    /// Radius of the sphere on which the unloaded elements' tips lie, m.
    pub dome_radius: f64,
    /// Undeformed tip of each element's feeler, m in the fingertip frame `T`.
    pub element_tips: Vec<[f64; 3]>,
}

/// A frame of a finger in the one before it: turned about x, y and z of that by `rpy`, rad, then moved by `xyz`, m. What
/// hangs from a joint is turned about its own z by the joint's angle.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Name of the frame.
    pub name: String,
    /// The frame before it.
    pub parent: String,
    /// Its origin, m.
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw, rad.
    pub rpy: [f64; 3],
    /// The joint from which it hangs, 0 to 2, if it is not fixed.
    pub joint: Option<usize>,
    /// What is drawn in it, if anything is.
    pub part: Option<FingerPart>,
}

/// A part of a finger in its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FingerPart {
    /// A rod along x from the origin.
    Link {
        /// Radius, m.
        radius: f64,
        /// Length, m, more than 0.
        length: f64,
    },
    /// A sphere about the origin.
    Dome {
        /// Radius, m.
        radius: f64,
    },
}

impl Frame {
    /// Where it is in its parent while its joint, if it has one, stands at `angle`, rad.
    pub fn in_parent(&self, angle: f64) -> DAffine3 {
        let [roll, pitch, yaw] = self.rpy;
        let turned = DMat3::from_rotation_z(yaw)
            * DMat3::from_rotation_y(pitch)
            * DMat3::from_rotation_x(roll)
            * DMat3::from_rotation_z(angle);
        DAffine3::from_mat3_translation(turned, DVec3::from_array(self.xyz))
    }
}

/// Name of the frame `part` of `finger`, from 0: `base`, `link_1` to `link_3`, `dome`.
pub fn frame(finger: usize, part: &str) -> String {
    format!("finger_{finger}_{part}")
}

/// Names of the joints of `finger`, from 0: theta1 to theta3.
pub fn joint_names(finger: usize) -> [String; 3] {
    [1, 2, 3].map(|joint| format!("finger_{finger}_joint_{joint}"))
}

impl FingerModel {
    /// The frames of this finger, which is the one of this number, from its base to its dome (the fingertip frame `T`), by
    /// the conventions of [`feeler::hand::kinematics`].
    ///
    /// # Errors
    /// When a value of its geometry is out of range.
    pub fn frames(&self, finger: usize) -> Result<[Frame; 5], RecordError> {
        let geometry = FingerGeometry::new(&self.geometry);
        let geometry = geometry.map_err(|error| RecordError::Facts {
            field: "hand",
            expected: "fingers within their ranges".into(),
            actual: error.to_string(),
        })?;
        let (phi1, phi2) = geometry.base_angles();
        let links = geometry.links();
        let along_x = |length| [length, 0.0, 0.0];
        // Joint 1 turns the plane in which joints 2 and 3 turn: their axes lie across.
        let across = [FRAC_PI_2, 0.0, 0.0];
        let base = (geometry.base_position().to_array(), [phi2, phi1, 0.0]);
        let radius = LINK_OVER_DOME * self.dome_radius;
        let link = |joint: usize| {
            let length = links[joint];
            (length > 0.0).then_some(FingerPart::Link { radius, length })
        };
        let dome = FingerPart::Dome {
            radius: self.dome_radius,
        };
        let places = [
            ("base", base, None, None),
            ("link_1", ([0.0; 3], [0.0; 3]), Some(0), link(0)),
            ("link_2", (along_x(links[0]), across), Some(1), link(1)),
            ("link_3", (along_x(links[1]), [0.0; 3]), Some(2), link(2)),
            ("dome", (along_x(links[2]), [0.0; 3]), None, Some(dome)),
        ];
        let mut parent = WORLD_FRAME.to_string();
        Ok(places.map(|(name, (xyz, rpy), joint, part)| {
            let name = frame(finger, name);
            let parent = std::mem::replace(&mut parent, name.clone());
            Frame {
                name,
                parent,
                xyz,
                rpy,
                joint,
                part,
            }
        }))
    }

    /// The elements, each with its undeformed tip, m in `T`.
    pub fn elements(&self) -> impl Iterator<Item = (SensingElement, DVec3)> + '_ {
        let tips = self.element_tips.iter().map(|&tip| DVec3::from_array(tip));
        tips.map(|tip| (SensingElement::facing(tip.normalize_or_zero()), tip))
    }

    /// Checks what readers rely on.
    pub(super) fn validate(&self) -> Result<(), RecordError> {
        self.frames(0)?;
        let mut numbers = self
            .element_tips
            .iter()
            .flatten()
            .chain([&self.dome_radius]);
        let sound = self.element_tips.len() <= MAX_ELEMENTS && self.dome_radius > 0.0;
        if sound && numbers.all(|number| number.is_finite()) {
            return Ok(());
        }
        Err(RecordError::Facts {
            field: "hand",
            expected: format!("domes of at most {MAX_ELEMENTS} elements, of finite sizes"),
            actual: format!(
                "{} elements, {} m",
                self.element_tips.len(),
                self.dome_radius
            ),
        })
    }
}

/// What a solid is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidFrame {
    /// `W`: it does not move.
    World,
    /// The cap that is turned.
    Cap,
    /// The object that is carried.
    Object,
}

impl SolidFrame {
    /// The frames of what moves.
    pub const MOVING: [Self; 2] = [Self::Cap, Self::Object];

    /// Name of the frame.
    pub fn name(self) -> &'static str {
        match self {
            Self::World => WORLD_FRAME,
            Self::Cap => "cap",
            Self::Object => "object",
        }
    }
}

/// Something that stands around a hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// What it is called in the experiment.
    pub name: String,
    /// What it is fixed to.
    pub frame: SolidFrame,
    /// Its centre in that, m.
    pub position: [f64; 3],
    /// Its rotation in that: quaternion x, y, z, w.
    pub orientation: [f64; 4],
    /// Its shape.
    pub shape: SolidShape,
}

/// The shape of a solid about its centre; lengths in m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SolidShape {
    /// A box.
    Box {
        /// Lengths along x, y and z.
        size: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length.
        length: f64,
    },
    /// An outline in x and y, drawn out along z.
    Prism {
        /// The outline, counterclockwise.
        outline: Vec<[f64; 2]>,
        /// Length.
        length: f64,
    },
}

impl SolidShape {
    /// Lengths of the box about it along x, y and z, m, if its outline is about the origin.
    pub fn size(&self) -> [f64; 3] {
        match self {
            Self::Box { size } => *size,
            Self::Sphere { radius } => [2.0 * radius; 3],
            Self::Cylinder { radius, length } => [2.0 * radius, 2.0 * radius, *length],
            Self::Prism { outline, length } => {
                let reach = |axis: usize| {
                    let coordinates = outline.iter().map(|corner| corner[axis].abs());
                    2.0 * coordinates.fold(0.0, f64::max)
                };
                [reach(0), reach(1), *length]
            }
        }
    }
}

/// Checks what readers rely on.
pub(super) fn validate_solids(solids: &[Solid]) -> Result<(), RecordError> {
    let sound = |solid: &Solid| {
        let corners = match &solid.shape {
            SolidShape::Prism { outline, .. } => outline.as_slice(),
            _ => &[],
        };
        let size = solid.shape.size();
        let mut numbers = size.iter().chain(&solid.position).chain(&solid.orientation);
        let turns = solid.orientation.iter().map(|x| x * x).sum::<f64>();
        corners.len() <= MAX_CORNERS
            && corners.iter().flatten().all(|number| number.is_finite())
            && numbers.all(|number| number.is_finite())
            && (turns - 1.0).abs() < 1e-3
    };
    if solids.len() <= MAX_SOLIDS && solids.iter().all(sound) {
        return Ok(());
    }
    Err(RecordError::Facts {
        field: "solids",
        expected: format!("at most {MAX_SOLIDS} solids of finite sizes"),
        actual: format!("{} solids", solids.len()),
    })
}
