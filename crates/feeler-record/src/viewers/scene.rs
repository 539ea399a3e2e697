//! Markers of the hand and the solids around it: solids once, forces repeatedly.

use crate::messages::facts::RunFacts;
use crate::messages::model::{FingerModel, Solid, SolidShape, WORLD_FRAME, frame};
use crate::ros::{ColorRGBA, Marker, MarkerArray, MarkerType};
use crate::sensed::taxels::Elements;
use crate::wire::Vector3;
use feeler::control::TactileReading;
use glam::DVec3;

/// Time between two updates of the scene (s).
pub const FRAME_TIME: f64 = 1.0 / 30.0;
/// Length of a force arrow (m/N).
const ARROW_LENGTH: f64 = 0.01;
/// Line width of an arrow (m).
const ARROW_WIDTH: f64 = 0.0006;
/// Ratio of the length of an arrow's barbs to the length of the arrow.
const BARB: f64 = 0.25;
/// Ratio of an element's dot diameter to the dome's radius.
const DOT: f64 = 0.09;

/// Diameter of a taxel's dot if there is no dome (m).
const TAXEL: f64 = 0.002;

/// Colours that colour-blind readers can distinguish (Okabe and Ito).
const DOME: ColorRGBA = colour(0.80, 0.80, 0.80, 0.45);
const ELEMENT: ColorRGBA = colour(0.25, 0.25, 0.25, 1.0);
const MOVED: ColorRGBA = colour(0.90, 0.62, 0.00, 0.9);
const FIXED: ColorRGBA = colour(0.60, 0.60, 0.60, 0.5);
const TOUCHES: ColorRGBA = colour(0.00, 0.45, 0.70, 1.0);
const SLIPS: ColorRGBA = colour(0.84, 0.37, 0.00, 1.0);

const fn colour(r: f32, g: f32, b: f32, a: f32) -> ColorRGBA {
    ColorRGBA { r, g, b, a }
}

/// Creates markers for domes, their elements, and solids.
pub fn scene(hand: &[FingerModel], solids: &[Solid]) -> MarkerArray {
    let fingers = hand.iter().enumerate();
    let mut markers: Vec<_> = fingers
        .flat_map(|(finger, model)| dome(finger, model))
        .collect();
    markers.extend((0..).zip(solids).map(|(id, solid)| marker(id, solid)));
    MarkerArray { markers }
}

fn dome(finger: usize, model: &FingerModel) -> [Marker; 2] {
    let name = frame(finger, "dome");
    let all = |length: f64| DVec3::splat(length).into();
    let mut dome = Marker::new(name.as_str(), name.as_str(), MarkerType::Sphere);
    (dome.scale, dome.color) = (all(2.0 * model.dome_radius), DOME);
    let mut elements = Marker::new(
        name.as_str(),
        frame(finger, "elements"),
        MarkerType::SphereList,
    );
    (elements.scale, elements.color) = (all(DOT * model.dome_radius), ELEMENT);
    let tips = model.element_tips.iter().map(|&tip| DVec3::from_array(tip));
    elements.points = tips.map(Vector3::from).collect();
    [dome, elements]
}

/// Creates dots for the taxels of an array without a dome, at `tips` (m, in the frame of finger 0's dome).
pub fn element_dots(tips: impl Iterator<Item = DVec3>) -> Marker {
    let (dome, elements) = (frame(0, "dome"), frame(0, "elements"));
    let mut marker = Marker::new(dome, elements, MarkerType::SphereList);
    marker.color = ELEMENT;
    marker.scale = DVec3::splat(TAXEL).into();
    marker.points = tips.map(Vector3::from).collect();
    marker
}

fn marker(id: i32, solid: &Solid) -> Marker {
    let kind = match solid.shape {
        SolidShape::Box { .. } => MarkerType::Cube,
        SolidShape::Sphere { .. } => MarkerType::Sphere,
        SolidShape::Cylinder { .. } => MarkerType::Cylinder,
        SolidShape::Prism { .. } => MarkerType::TriangleList,
    };
    let frame = solid.frame.name();
    let mut marker = Marker::new(frame, solid.name.as_str(), kind);
    marker.id = id;
    marker.color = if frame == WORLD_FRAME { FIXED } else { MOVED };
    marker.pose.position = DVec3::from_array(solid.position).into();
    marker.pose.orientation = glam::DQuat::from_array(solid.orientation).into();
    marker.scale = DVec3::from_array(solid.shape.size()).into();
    if let SolidShape::Prism { outline, length } = &solid.shape {
        marker.scale = DVec3::ONE.into();
        marker.points = triangles(outline, *length);
    }
    marker
}

/// Surface of an outline extruded to `length`, as triangles of three points each.
fn triangles(outline: &[[f64; 2]], length: f64) -> Vec<Vector3> {
    let half = 0.5 * length;
    let corners = outline.iter().zip(outline.iter().cycle().skip(1));
    let sides = corners.flat_map(|(&[x, y], &[next_x, next_y])| {
        let at = DVec3::new;
        let (low, high) = (at(x, y, -half), at(x, y, half));
        let (next_low, next_high) = (at(next_x, next_y, -half), at(next_x, next_y, half));
        let side = [low, next_low, next_high, low, next_high, high];
        let (top, bottom) = (at(0.0, 0.0, half), at(0.0, 0.0, -half));
        side.into_iter()
            .chain([top, high, next_high, bottom, next_low, low])
    });
    sides.map(Vector3::from).collect()
}

/// Arrows for the forces on the touching elements of a finger.
pub struct ForceArrows {
    finger: usize,
    touch_force: f64,
    slip_rate: f64,
}

impl ForceArrows {
    /// Creates the arrows for `finger` in the run described by `facts`.
    pub fn new(finger: usize, facts: &RunFacts) -> Self {
        Self {
            finger,
            touch_force: facts.touch_force_threshold,
            slip_rate: facts.slip_threshold,
        }
    }

    /// Returns `true` if an element slips, that is, its shear rate exceeds the threshold.
    pub fn slips(&self, touch: &TactileReading, element: usize) -> bool {
        (touch.shear_rate.get(element)).is_some_and(|rate| *rate > self.slip_rate)
    }

    /// Creates an empty marker.
    pub fn marker(&self) -> Marker {
        let (dome, forces) = (frame(self.finger, "dome"), frame(self.finger, "forces"));
        let mut marker = Marker::new(dome, forces, MarkerType::LineList);
        marker.scale.x = ARROW_WIDTH;
        marker.color = TOUCHES;
        marker
    }

    /// Fills `marker` with one arrow per touching element: a line from its tip along the force, and two barbs at the
    /// end.
    pub fn fill(&self, marker: &mut Marker, elements: &Elements, touch: &TactileReading) {
        marker.points.clear();
        marker.colors.clear();
        let felt = elements
            .tips()
            .zip(&elements.forces)
            .zip(&touch.frame.forces);
        for (element, ((tip, force), own)) in felt.enumerate() {
            // Unknown forces (NaN) do not touch.
            let touches = own.z > self.touch_force;
            if !touches {
                continue;
            }
            let arrow = ARROW_LENGTH * *force;
            let end = tip + arrow;
            let aside =
                0.5 * BARB * arrow.any_orthogonal_vector().normalize_or_zero() * arrow.length();
            let back = end - BARB * arrow;
            let lines = [tip, end, end, back + aside, end, back - aside];
            marker.points.extend(lines.map(Vector3::from));
            let colour = if self.slips(touch, element) {
                SLIPS
            } else {
                TOUCHES
            };
            marker.colors.extend([colour; 6]);
        }
    }
}
