//! Constants of a rig: the geometry of its fingers and the solids around them.

use crate::error::RecordError;
use feeler::hand::chain::Chain;
use feeler::hand::{FingerDescription, FingerGeometry, Kinematics, ThreeJoints};
use feeler::math::{rotation_x, rotation_y, rotation_z};
use feeler::sensor::fingertip::{MAX_ELEMENTS, SensingElement};
use glam::{DAffine3, DMat3, DVec3, EulerRot};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Name of the root frame, `W`.
pub const WORLD_FRAME: &str = "world";

/// Ratio of a drawn link's radius to the dome's.
const LINK_OVER_DOME: f64 = 0.3;

/// Maximum number of solids around a hand. Guards against damaged files.
const MAX_SOLIDS: usize = 64;
/// Maximum number of corners of an outline. Guards against damaged files.
const MAX_CORNERS: usize = 20_000;

/// Geometry of a finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FingerModel {
    /// Kinematics and limits.
    pub geometry: FingerDescription,
    /// Radius of the sphere through the unloaded tips of the elements (m).
    pub dome_radius: f64,
    /// Undeformed tip of each element's feeler, in the fingertip frame `T` (m).
    pub element_tips: Vec<[f64; 3]>,
}

/// A frame of a finger, given by its pose in the parent frame: a rotation by `rpy` (rad) about the parent's x, y and z
/// axes, then a translation by `xyz` (m). A moving frame also turns about or moves along its z axis by its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Name of the frame.
    pub name: String,
    /// Name of the parent frame.
    pub parent: String,
    /// Origin in the parent frame (m).
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw (rad).
    pub rpy: [f64; 3],
    /// Index among the finger's moving frames, whose positions are
    /// [`FingerGeometry::frame_positions`], or `None` if the frame is fixed in its parent.
    pub moving: Option<usize>,
    /// `true` if it moves along its z axis (m), `false` if it turns about it (rad).
    pub prismatic: bool,
    /// Part drawn in this frame, if any.
    pub part: Option<FingerPart>,
}

/// A drawn part of a finger, in its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FingerPart {
    /// A rod from the origin to a point.
    Link {
        /// Radius (m).
        radius: f64,
        /// The point (m), not the origin.
        end: [f64; 3],
    },
    /// A sphere centred at the origin.
    Dome {
        /// Radius (m).
        radius: f64,
    },
}

impl Frame {
    /// Pose in the parent frame at its `position` (rad or m).
    pub fn in_parent(&self, position: f64) -> DAffine3 {
        let [roll, pitch, yaw] = self.rpy;
        let rest = rotation_z(yaw) * rotation_y(pitch) * rotation_x(roll);
        let origin = DVec3::from_array(self.xyz);
        if self.prismatic {
            return DAffine3::from_mat3_translation(rest, origin + rest.z_axis * position);
        }
        DAffine3::from_mat3_translation(rest * rotation_z(position), origin)
    }
}

/// Name of the frame of a `part` of `finger`, which is numbered from 0. Parts are `base`, `link_1` and so on, one per
/// moving frame, and `dome`.
pub fn frame(finger: usize, part: &str) -> String {
    format!("finger_{finger}_{part}")
}

/// Names of the joints of the `count` moving frames of `finger`; fingers count from 0, joints from 1.
pub fn joint_names(finger: usize, count: usize) -> impl Iterator<Item = String> {
    (1..=count).map(move |joint| format!("finger_{finger}_joint_{joint}"))
}

impl FingerModel {
    /// Returns the checked geometry with precomputed transforms.
    ///
    /// # Errors
    /// If a value is out of range.
    pub fn geometry(&self) -> Result<FingerGeometry, RecordError> {
        let geometry = FingerGeometry::of(&self.geometry);
        geometry.map_err(|error| RecordError::Facts {
            field: "hand",
            expected: "fingers with valid geometry".into(),
            actual: error.to_string(),
        })
    }

    /// The frames of this finger from its base to its dome (the fingertip frame `T`), in the conventions of
    /// [`feeler::hand`]. `finger` is the number used in their names.
    ///
    /// # Errors
    /// If a value of its geometry is out of range.
    pub fn frames(&self, finger: usize) -> Result<Vec<Frame>, RecordError> {
        let geometry = self.geometry()?;
        let places = match geometry.kinematics() {
            Kinematics::ThreeJoints(own) => self.three_joint_places(own),
            Kinematics::Chain(chain) => self.chain_places(chain),
        };
        let mut parent = WORLD_FRAME.to_string();
        let frames = places.into_iter().map(|place| {
            let name = frame(finger, &place.name);
            let parent = std::mem::replace(&mut parent, name.clone());
            Frame {
                name,
                parent,
                ..place
            }
        });
        Ok(frames.collect())
    }

    /// Frames with the names of their parts and without parents.
    fn three_joint_places(&self, finger: &ThreeJoints) -> Vec<Frame> {
        let (phi1, phi2) = finger.base_angles();
        let links = finger.links();
        let along_x = |length| [length, 0.0, 0.0];
        // Joint 1 rotates the plane of joints 2 and 3: their axes are perpendicular to its axis.
        let across = [FRAC_PI_2, 0.0, 0.0];
        let base = (finger.base_position().to_array(), [phi2, phi1, 0.0]);
        let link = |joint: usize| self.link(along_x(links[joint]));
        let places = [
            ("base", base, None, None),
            ("link_1", ([0.0; 3], [0.0; 3]), Some(0), link(0)),
            ("link_2", (along_x(links[0]), across), Some(1), link(1)),
            ("link_3", (along_x(links[1]), [0.0; 3]), Some(2), link(2)),
            ("dome", (along_x(links[2]), [0.0; 3]), None, self.dome()),
        ];
        let place = |(name, (xyz, rpy), moving, part): (&str, _, _, _)| Frame {
            name: name.into(),
            parent: String::new(),
            xyz,
            rpy,
            moving,
            prismatic: false,
            part,
        };
        places.map(place).into()
    }

    /// Frames with the names of their parts and without parents: the base, which is not turned, the moving frames and
    /// the dome.
    fn chain_places(&self, chain: &Chain) -> Vec<Frame> {
        let base = Frame {
            name: "base".into(),
            parent: String::new(),
            xyz: chain.base_position().to_array(),
            rpy: [0.0; 3],
            moving: None,
            prismatic: false,
            part: None,
        };
        let (tip, tip_rotation) = chain.tip();
        let frames: Vec<_> = chain.frames().collect();
        let ends = frames
            .iter()
            .skip(1)
            .map(|next| next.translation)
            .chain([tip]);
        let moving = frames
            .iter()
            .zip(ends)
            .enumerate()
            .map(|(index, (frame, end))| {
                let from = if index == 0 {
                    chain.base_position()
                } else {
                    DVec3::ZERO
                };
                Frame {
                    name: format!("link_{}", index + 1),
                    xyz: (frame.translation - from).to_array(),
                    rpy: rpy_of(&frame.rotation),
                    moving: Some(index),
                    prismatic: frame.prismatic,
                    part: self.link(end.to_array()),
                    ..base.clone()
                }
            });
        let dome = Frame {
            name: "dome".into(),
            xyz: tip.to_array(),
            rpy: rpy_of(&tip_rotation),
            part: self.dome(),
            ..base.clone()
        };
        let moving: Vec<_> = moving.collect();
        [vec![base], moving, vec![dome]].concat()
    }

    fn link(&self, end: [f64; 3]) -> Option<FingerPart> {
        let radius = LINK_OVER_DOME * self.dome_radius;
        (end != [0.0; 3]).then_some(FingerPart::Link { radius, end })
    }

    fn dome(&self) -> Option<FingerPart> {
        Some(FingerPart::Dome {
            radius: self.dome_radius,
        })
    }

    /// The elements, each with its undeformed tip in `T` (m).
    pub fn elements(&self) -> impl Iterator<Item = (SensingElement, DVec3)> + '_ {
        let tips = self.element_tips.iter().map(|&tip| DVec3::from_array(tip));
        tips.map(|tip| (SensingElement::facing(tip.normalize_or_zero()), tip))
    }

    /// Checks the invariants that readers rely on.
    pub(crate) fn validate(&self) -> Result<(), RecordError> {
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
            expected: format!("domes with at most {MAX_ELEMENTS} elements and finite sizes"),
            actual: format!(
                "{} elements, {} m",
                self.element_tips.len(),
                self.dome_radius
            ),
        })
    }
}

/// The frame to which a solid is fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidFrame {
    /// `W`: the solid does not move.
    World,
    /// The cap.
    Cap,
    /// The carried object.
    Object,
}

impl SolidFrame {
    /// Frames whose pose changes during a run.
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

/// A solid near a hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// Name in the experiment.
    pub name: String,
    /// Frame to which it is fixed.
    pub frame: SolidFrame,
    /// Centre in that frame (m).
    pub position: [f64; 3],
    /// Rotation in that frame, as a quaternion x, y, z, w.
    pub orientation: [f64; 4],
    /// Shape of the solid.
    pub shape: SolidShape,
}

/// Shape of a solid, centred at the origin; lengths in m.
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
    /// An outline in x and y, extruded along z.
    Prism {
        /// The outline, counterclockwise.
        outline: Vec<[f64; 2]>,
        /// Length.
        length: f64,
    },
}

impl SolidShape {
    /// Size of the bounding box along x, y and z (m), assuming that the outline is centred at the origin.
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

/// Checks the invariants that readers rely on.
pub(crate) fn validate_solids(solids: &[Solid]) -> Result<(), RecordError> {
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
        expected: format!("at most {MAX_SOLIDS} solids with finite sizes"),
        actual: format!("{} solids", solids.len()),
    })
}

/// Roll, pitch and yaw of a rotation (rad).
fn rpy_of(rotation: &DMat3) -> [f64; 3] {
    let (yaw, pitch, roll) = rotation.to_euler(EulerRot::ZYX);
    [roll, pitch, yaw]
}
