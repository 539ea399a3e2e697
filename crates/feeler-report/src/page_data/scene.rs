//! 3-D scene of a run.

use super::live::LiveRig;
use crate::run::data::RunData;
use feeler::sensor::fingertip::SensingElement;
use feeler_record::messages::{FingerPart, Frame as ModelFrame, WORLD_FRAME, frame};
use feeler_record::{FingerModel, Recording, RunFacts, Solid, SolidFrame, SolidShape};
use glam::{DAffine3, DQuat, DVec3};
use serde::Serialize;

/// Margin of the home view relative to the dome radius.
const MARGIN: f64 = 1.2;

type Vector = [f64; 3];
type Quaternion = [f64; 4];

/// Coordinate frames, solids and fingertips.
#[derive(Debug, Clone, Serialize)]
pub struct Scene {
    frames: Vec<Frame>,
    shapes: Vec<Shape>,
    fingers: Vec<Finger>,
    home: Home,
}

#[derive(Debug, Clone, Serialize)]
struct Frame {
    name: String,
    parent: String,
    position: Vector,
    rotation: Quaternion,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<Joint>,
}

#[derive(Debug, Clone, Serialize)]
struct Joint {
    finger: usize,
    joint: usize,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    prismatic: bool,
}

#[derive(Debug, Clone, Serialize)]
struct Shape {
    frame: String,
    position: Vector,
    rotation: Quaternion,
    role: Role,
    solid: SolidShape,
}

#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "snake_case")]
enum Role {
    Link,
    Dome,
    Object,
    Fixture,
}

#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
struct Finger {
    name: String,
    frame: String,
    elements: Vec<Element>,
    touch_force: f64,
    over_force: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Element {
    tip: Vector,
    rotation: Quaternion,
}

#[derive(Debug, Clone, Serialize)]
struct Home {
    centre: Vector,
    radius: f64,
}

impl Scene {
    /// Scene of a run; `None` if the hand's geometry is unknown.
    pub fn new(recording: &Recording, data: &RunData) -> Option<Self> {
        let is_known = |frame| match frame {
            SolidFrame::World => true,
            SolidFrame::Cap => data.cap.is_some(),
            SolidFrame::Object => !recording.object.is_empty(),
        };
        Self::around(&recording.facts, is_known, home(recording, data)?)
    }

    /// Scene of a running rig; `None` if the hand's geometry is unknown.
    pub fn of_rig(rig: &LiveRig<'_>) -> Option<Self> {
        let homes = rig.homes.iter().map(|&home| DVec3::from_array(home));
        // The object of a hand is on the axis of `W`.
        let points = homes.flat_map(|home| [home, home * DVec3::Z]);
        let is_known = |frame| match frame {
            SolidFrame::World => true,
            SolidFrame::Cap => rig.cap,
            SolidFrame::Object => rig.object,
        };
        Self::around(rig.facts, is_known, home_of(&rig.facts.hand, points)?)
    }

    /// Scene with the solids in frames whose pose is known according to `is_known`.
    fn around(facts: &RunFacts, is_known: impl Fn(SolidFrame) -> bool, home: Home) -> Option<Self> {
        let mut scene = Self {
            frames: Vec::new(),
            shapes: Vec::new(),
            fingers: Vec::new(),
            home,
        };
        for (number, model) in facts.hand.iter().enumerate() {
            let frames = model.frames(number).ok()?;
            let parts = frames.iter().filter_map(Shape::of_frame);
            scene.shapes.extend(parts);
            let frames = frames.iter().map(|frame| Frame::of_finger(number, frame));
            scene.frames.extend(frames);
            scene.fingers.push(Finger {
                name: format!("finger {number}"),
                frame: frame(number, "dome"),
                elements: model.elements().map(element).collect(),
                touch_force: facts.touch_force_threshold,
                over_force: facts.over_force_threshold,
            });
        }
        let moving = SolidFrame::MOVING.into_iter().filter(|&f| is_known(f));
        scene.frames.extend(moving.map(Frame::of_solids));
        let solids = facts.solids.iter().filter(|s| is_known(s.frame));
        scene.shapes.extend(solids.map(Shape::of_solid));
        Some(scene)
    }
}

impl Frame {
    fn of_solids(frame: SolidFrame) -> Self {
        Self {
            name: frame.name().into(),
            parent: WORLD_FRAME.into(),
            position: [0.0; 3],
            rotation: DQuat::IDENTITY.to_array(),
            joint: None,
        }
    }

    fn of_finger(finger: usize, frame: &ModelFrame) -> Self {
        let place = frame.in_parent(0.0);
        Self {
            name: frame.name.clone(),
            parent: frame.parent.clone(),
            position: place.translation.to_array(),
            rotation: DQuat::from_mat3(&place.matrix3).to_array(),
            joint: frame.moving.map(|joint| Joint {
                finger,
                joint,
                prismatic: frame.prismatic,
            }),
        }
    }
}

fn element((element, tip): (SensingElement, DVec3)) -> Element {
    Element {
        tip: tip.to_array(),
        rotation: DQuat::from_mat3(&element.rotation).to_array(),
    }
}

impl Shape {
    /// Shape in a frame of a finger, if any.
    fn of_frame(frame: &ModelFrame) -> Option<Self> {
        // A cylinder extends along its own z axis.
        let (role, solid, end) = match frame.part? {
            FingerPart::Link { radius, end } => {
                let end = DVec3::from_array(end);
                let length = end.length();
                (Role::Link, SolidShape::Cylinder { radius, length }, end)
            }
            FingerPart::Dome { radius } => (Role::Dome, SolidShape::Sphere { radius }, DVec3::ZERO),
        };
        let along = DQuat::from_rotation_arc(DVec3::Z, end.normalize_or(DVec3::X));
        Some(Self {
            frame: frame.name.clone(),
            position: (0.5 * end).to_array(),
            rotation: along.to_array(),
            role,
            solid,
        })
    }

    fn of_solid(solid: &Solid) -> Self {
        Self {
            frame: solid.frame.name().into(),
            position: solid.position,
            rotation: solid.orientation,
            role: match solid.frame {
                SolidFrame::World => Role::Fixture,
                SolidFrame::Cap | SolidFrame::Object => Role::Object,
            },
            solid: solid.shape.clone(),
        }
    }
}

/// Home view: contains all dome positions and moving objects; `None` without a hand.
fn home(recording: &Recording, data: &RunData) -> Option<Home> {
    let domes = data.fingers.iter().flat_map(|finger| &finger.position);
    let cap = data.cap.iter().flat_map(|cap| &cap.centre);
    home_of(&recording.facts.hand, domes.chain(cap).copied())
}

/// View that contains these points, with a margin for the domes of `hand`.
fn home_of(hand: &[FingerModel], points: impl Iterator<Item = DVec3> + Clone) -> Option<Home> {
    let dome = hand
        .iter()
        .map(|model| model.dome_radius)
        .reduce(f64::max)?;
    let points = points.filter(|point| point.is_finite());
    let low = points.clone().reduce(DVec3::min);
    let high = points.reduce(DVec3::max);
    let (low, high) = low.zip(high).unwrap_or_else(|| {
        let at_rest = at_rest(hand);
        (at_rest, at_rest)
    });
    Some(Home {
        centre: low.midpoint(high).to_array(),
        radius: 0.5 * (high - low).length() + MARGIN * dome,
    })
}

/// Position of the first dome with all joint angles at 0.
fn at_rest(hand: &[FingerModel]) -> DVec3 {
    let frames = hand.first().and_then(|model| model.frames(0).ok());
    let places = frames.iter().flatten().map(|frame| frame.in_parent(0.0));
    places
        .fold(DAffine3::IDENTITY, |place, next| place * next)
        .translation
}
