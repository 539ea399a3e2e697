//! Export of a hand as URDF, the robot description format of viewers and planners.
//!
//! Links and joints of finger N are named `finger_N_...`; these are also the frames of a recording's transforms.
//! Lengths are in metres and angles in radians, in the conventions of [`feeler::hand::kinematics`]: `finger_N_dome` is
//! the fingertip frame `T`.

use crate::error::RecordError;
use crate::messages::model::{
    FingerModel, FingerPart, Frame, Solid, SolidFrame, SolidShape, WORLD_FRAME, joint_names,
};
use glam::{DQuat, EulerRot};
use serde::Serialize;

/// Describes the hand `name` and the `solids` around it as URDF.
///
/// Moving solids are attached to the world by floating joints. Prisms are drawn as their bounding boxes, or as
/// cylinders if they are round. `effort` is 0, because the drives' torque limits are not known.
///
/// # Errors
/// If a finger is out of range, or `name` is not valid in XML.
pub fn urdf(name: &str, hand: &[FingerModel], solids: &[Solid]) -> Result<String, RecordError> {
    let mut robot = Robot {
        name: name.into(),
        link: vec![Link::of(WORLD_FRAME, solids, SolidFrame::World)],
        joint: Vec::new(),
    };
    for (finger, model) in hand.iter().enumerate() {
        robot.add(finger, model)?;
    }
    for frame in SolidFrame::MOVING {
        robot.add_moving(frame, solids);
    }
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    let written = robot.serialize(serializer);
    written.map_err(|error| RecordError::Facts {
        field: "experiment",
        expected: "a name that is valid in XML".into(),
        actual: error.to_string(),
    })?;
    text.push('\n');
    Ok(text)
}

#[derive(Serialize)]
#[serde(rename = "robot")]
struct Robot {
    #[serde(rename = "@name")]
    name: String,
    link: Vec<Link>,
    joint: Vec<Joint>,
}

#[derive(Serialize)]
struct Link {
    #[serde(rename = "@name")]
    name: String,
    visual: Vec<Visual>,
}

#[derive(Serialize)]
struct Visual {
    origin: Pose,
    geometry: Geometry,
    material: Material,
}

#[derive(Serialize)]
struct Material {
    #[serde(rename = "@name")]
    name: &'static str,
    color: Rgba,
}

#[derive(Serialize)]
struct Rgba {
    #[serde(rename = "@rgba")]
    rgba: &'static str,
}

/// Colours by name, as in the scene's markers. Domes are translucent.
const LINK: (&str, &str) = ("link", "0.55 0.6 0.65 1");
const DOME: (&str, &str) = ("dome", "0.8 0.8 0.8 0.45");
const MOVED: (&str, &str) = ("moved", "0.9 0.62 0 0.9");
const FIXED: (&str, &str) = ("fixed", "0.6 0.6 0.6 0.5");

#[derive(Serialize)]
struct Geometry {
    #[serde(rename = "$value")]
    shape: Shape,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Shape {
    Box {
        #[serde(rename = "@size")]
        size: String,
    },
    Cylinder {
        #[serde(rename = "@radius")]
        radius: f64,
        #[serde(rename = "@length")]
        length: f64,
    },
    Sphere {
        #[serde(rename = "@radius")]
        radius: f64,
    },
}

/// Pose of a frame in its parent: a rotation by `rpy` (rad) about the parent's x, y and z axes, then a translation by
/// `xyz` (m).
#[derive(Serialize)]
struct Pose {
    #[serde(rename = "@xyz")]
    xyz: String,
    #[serde(rename = "@rpy")]
    rpy: String,
}

#[derive(Serialize)]
struct Joint {
    #[serde(rename = "@name")]
    name: String,
    #[serde(rename = "@type")]
    kind: &'static str,
    parent: Of,
    child: Of,
    origin: Pose,
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<Axis>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<Limit>,
}

#[derive(Serialize)]
struct Of {
    #[serde(rename = "@link")]
    link: String,
}

#[derive(Serialize)]
struct Axis {
    #[serde(rename = "@xyz")]
    xyz: &'static str,
}

#[derive(Serialize)]
struct Limit {
    #[serde(rename = "@lower")]
    lower: f64,
    #[serde(rename = "@upper")]
    upper: f64,
    #[serde(rename = "@velocity")]
    velocity: f64,
    #[serde(rename = "@effort")]
    effort: f64,
}

impl Robot {
    /// Adds a finger. Each joint rotates about the z axis of its child link, whose x axis points to the next joint.
    fn add(&mut self, finger: usize, model: &FingerModel) -> Result<(), RecordError> {
        let frames = model.frames(finger)?;
        let geometry = model.geometry()?;
        let names: Vec<_> = joint_names(finger, geometry.frame_count()).collect();
        let limits = geometry.frame_limits();
        for Frame {
            name,
            parent,
            xyz,
            rpy,
            moving,
            prismatic,
            part,
        } in frames
        {
            let origin = Pose::new(xyz, rpy);
            let fixed = || format!("{name}_mount");
            self.joint.push(Joint {
                name: moving.map_or_else(fixed, |index| names[index].clone()),
                kind: match (moving, prismatic) {
                    (None, _) => "fixed",
                    (Some(_), false) => "revolute",
                    (Some(_), true) => "prismatic",
                },
                parent: Of::link(&parent),
                child: Of::link(&name),
                origin,
                axis: moving.map(|_| Axis { xyz: "0 0 1" }),
                limit: moving.map(|index| Limit {
                    lower: limits[index].lower,
                    upper: limits[index].upper,
                    velocity: limits[index].speed,
                    effort: 0.0,
                }),
            });
            let visual = part.map(Visual::part).into_iter().collect();
            self.link.push(Link { name, visual });
        }
        Ok(())
    }

    /// Adds a link for the `solids` that move with `frame`, if any.
    fn add_moving(&mut self, frame: SolidFrame, solids: &[Solid]) {
        let link = Link::of(frame.name(), solids, frame);
        if link.visual.is_empty() {
            return;
        }
        self.link.push(link);
        self.joint.push(Joint {
            name: format!("{}_motion", frame.name()),
            kind: "floating",
            parent: Of::link(WORLD_FRAME),
            child: Of::link(frame.name()),
            origin: Pose::new([0.0; 3], [0.0; 3]),
            axis: None,
            limit: None,
        });
    }
}

impl Link {
    /// Creates the link `name` from the `solids` that are fixed to `frame`.
    fn of(name: &str, solids: &[Solid], frame: SolidFrame) -> Self {
        let solids = solids.iter().filter(|solid| solid.frame == frame);
        Self {
            name: name.into(),
            visual: solids.map(Visual::solid).collect(),
        }
    }
}

impl Visual {
    fn part(part: FingerPart) -> Self {
        match part {
            FingerPart::Link { radius, end } => {
                let [x, y, z] = end;
                let across = libm::hypot(x, y);
                // Turns the cylinder's z axis to the end.
                let lying = [0.0, libm::atan2(across, z), libm::atan2(y, x)];
                let lying = Pose::new(end.map(|part| part / 2.0), lying);
                let length = libm::hypot(across, z);
                Self::new(lying, Shape::Cylinder { radius, length }, LINK)
            }
            FingerPart::Dome { radius } => {
                let centre = Pose::new([0.0; 3], [0.0; 3]);
                Self::new(centre, Shape::Sphere { radius }, DOME)
            }
        }
    }

    fn solid(solid: &Solid) -> Self {
        let turned = DQuat::from_array(solid.orientation);
        let (yaw, pitch, roll) = turned.to_euler(EulerRot::ZYX);
        let [x, y, z] = solid.shape.size();
        let shape = match &solid.shape {
            SolidShape::Sphere { radius } => Shape::Sphere { radius: *radius },
            SolidShape::Prism { outline, .. } if !is_round(outline) => Shape::box_of([x, y, z]),
            SolidShape::Box { size } => Shape::box_of(*size),
            SolidShape::Cylinder { .. } | SolidShape::Prism { .. } => Shape::Cylinder {
                radius: 0.5 * x,
                length: z,
            },
        };
        let colour = match solid.frame {
            SolidFrame::World => FIXED,
            SolidFrame::Cap | SolidFrame::Object => MOVED,
        };
        // Avoid negative zeros.
        let turned = [roll, pitch, yaw].map(|angle| angle + 0.0);
        Self::new(Pose::new(solid.position, turned), shape, colour)
    }

    fn new(origin: Pose, shape: Shape, (name, rgba): (&'static str, &'static str)) -> Self {
        Self {
            origin,
            geometry: Geometry { shape },
            material: Material {
                name,
                color: Rgba { rgba },
            },
        }
    }
}

impl Shape {
    fn box_of([x, y, z]: [f64; 3]) -> Self {
        let size = format!("{x} {y} {z}");
        Self::Box { size }
    }
}

/// Returns `true` if all corners have about the same distance from the origin.
fn is_round(outline: &[[f64; 2]]) -> bool {
    let radii = outline.iter().map(|[x, y]| libm::hypot(*x, *y));
    let (low, high) = radii.fold((f64::MAX, 0.0), |(low, high): (f64, f64), radius| {
        (low.min(radius), high.max(radius))
    });
    low > 0.8 * high
}

impl Pose {
    fn new(xyz: [f64; 3], rpy: [f64; 3]) -> Self {
        let text = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
        let (xyz, rpy) = (text(xyz), text(rpy));
        Self { xyz, rpy }
    }
}

impl Of {
    fn link(link: &str) -> Self {
        let link = link.into();
        Self { link }
    }
}
