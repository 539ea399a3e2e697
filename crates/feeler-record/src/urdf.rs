//! A hand as URDF, the description of robots that viewers and planners read.
//!
//! Links and joints of finger N are called `finger_N_...`; those are also the frames of a recording's transforms. All is
//! in metres and radians, by the conventions of [`feeler::hand::kinematics`]: `finger_N_dome` is the fingertip frame `T`.

use feeler::hand::finger::FingerGeometry;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Radius of a drawn link over that of the dome.
const LINK_OVER_DOME: f64 = 0.3;

/// The frame that all others hang from.
pub const WORLD_FRAME: &str = "world";

/// A finger as it is described.
#[derive(Debug, Clone, Copy)]
pub struct FingerModel<'a> {
    /// Its base, links and limits.
    pub geometry: &'a FingerGeometry,
    /// Radius of its dome, m.
    pub dome_radius: f64,
}

/// The hand called `name` as URDF. What drives can exert is not known: `effort` is 0.
///
/// # Errors
/// When `name` cannot stand in XML.
pub fn urdf(name: &str, fingers: &[FingerModel<'_>]) -> Result<String, quick_xml::SeError> {
    let mut robot = Robot {
        name: name.into(),
        link: vec![Link::named(WORLD_FRAME)],
        joint: Vec::new(),
    };
    for (finger, model) in fingers.iter().enumerate() {
        robot.add(finger, model);
    }
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    robot.serialize(serializer)?;
    text.push('\n');
    Ok(text)
}

/// Name of the frame `part` of `finger`, from 0: `base`, `link_1` to `link_3`, `dome`.
pub fn frame(finger: usize, part: &str) -> String {
    format!("finger_{finger}_{part}")
}

/// Names of the joints of `finger`, from 0: theta1 to theta3.
pub fn joint_names(finger: usize) -> [String; 3] {
    [1, 2, 3].map(|joint| format!("finger_{finger}_joint_{joint}"))
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
}

#[derive(Serialize)]
struct Geometry {
    #[serde(rename = "$value")]
    shape: Shape,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Shape {
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

/// Of a frame in the one before: first turned about x, y and z of that by `rpy`, rad, then moved by `xyz`, m.
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
    /// Adds a finger: each joint turns about z of the link that it carries, whose x points to the next joint.
    fn add(&mut self, finger: usize, model: &FingerModel<'_>) {
        let geometry = model.geometry;
        let base = frame(finger, "base");
        let (phi1, phi2) = geometry.base_angles();
        let place = Pose::new(geometry.base_position().to_array(), [phi2, phi1, 0.0]);
        self.fix(frame(finger, "mount"), WORLD_FRAME, &base, place);
        self.link.push(Link::named(&base));
        let links = geometry.links();
        // Joint 1 turns the plane in which joints 2 and 3 turn: their axes lie across.
        let places = [
            Pose::new([0.0; 3], [0.0; 3]),
            Pose::new([links[0], 0.0, 0.0], [FRAC_PI_2, 0.0, 0.0]),
            Pose::new([links[1], 0.0, 0.0], [0.0; 3]),
        ];
        let mut parent = base;
        for (index, (name, place)) in joint_names(finger).into_iter().zip(places).enumerate() {
            let child = frame(finger, &format!("link_{}", index + 1));
            self.joint.push(Joint {
                name,
                kind: "revolute",
                parent: Of::link(&parent),
                child: Of::link(&child),
                origin: place,
                axis: Some(Axis { xyz: "0 0 1" }),
                limit: Some(Limit {
                    lower: geometry.joint_lower()[index],
                    upper: geometry.joint_upper()[index],
                    velocity: geometry.joint_speed_limit()[index],
                    effort: 0.0,
                }),
            });
            let rod = Visual::rod(LINK_OVER_DOME * model.dome_radius, links[index]);
            self.link.push(Link {
                name: child.clone(),
                visual: rod.into_iter().collect(),
            });
            parent = child;
        }
        let dome = frame(finger, "dome");
        let place = Pose::new([links[2], 0.0, 0.0], [0.0; 3]);
        self.fix(frame(finger, "tip"), &parent, &dome, place);
        self.link.push(Link {
            name: dome,
            visual: vec![Visual::sphere(model.dome_radius)],
        });
    }

    fn fix(&mut self, name: String, parent: &str, child: &str, origin: Pose) {
        self.joint.push(Joint {
            name,
            kind: "fixed",
            parent: Of::link(parent),
            child: Of::link(child),
            origin,
            axis: None,
            limit: None,
        });
    }
}

impl Link {
    fn named(name: &str) -> Self {
        let (name, visual) = (name.into(), Vec::new());
        Self { name, visual }
    }
}

impl Visual {
    /// A rod along x from the origin; none of no length.
    fn rod(radius: f64, length: f64) -> Option<Self> {
        let lying = Pose::new([length / 2.0, 0.0, 0.0], [0.0, FRAC_PI_2, 0.0]);
        let shape = Shape::Cylinder { radius, length };
        (length > 0.0).then_some(Self::new(lying, shape))
    }

    fn sphere(radius: f64) -> Self {
        Self::new(Pose::new([0.0; 3], [0.0; 3]), Shape::Sphere { radius })
    }

    fn new(origin: Pose, shape: Shape) -> Self {
        let geometry = Geometry { shape };
        Self { origin, geometry }
    }
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
