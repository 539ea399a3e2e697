//! Geometry of the objects in a simulated world, for viewers.

use feeler_record::{Solid, SolidFrame, SolidShape};
use feeler_sim::objects::{MotionConfig, ObjectConfig};
use feeler_sim::shapes::ShapeConfig;
use feeler_sim::world::SimConfig;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// Minimum number of corners of a drawn outline.
const CORNERS: u32 = 120;
/// Number of corners of each knurl of an outline.
const CORNERS_PER_KNURL: u32 = 6;
/// Size of the plate that represents a half-space (m).
const PLATE: [f64; 3] = [0.12, 0.12, 0.002];

/// Returns the objects of a simulated world, each in the frame that it moves with: `Cap` for the first object with a
/// thread, `Object` for the first free object. Other moving objects are omitted because their motion is not recorded,
/// and so are objects whose shape is in a file.
pub fn solids(sim: &SimConfig) -> Vec<Solid> {
    let (cap, mut carried) = (sim.cap().map(|(name, ..)| name), None);
    let mut solids = Vec::new();
    for (name, object) in &sim.object {
        let frame = match &object.motion {
            MotionConfig::Fixed => SolidFrame::World,
            MotionConfig::Free(_) if *carried.get_or_insert(name) == name => SolidFrame::Object,
            _ if cap == Some(name) => SolidFrame::Cap,
            _ => continue,
        };
        solids.extend(of_object(name, object, frame));
    }
    solids
}

fn of_object(name: &str, object: &ObjectConfig, frame: SolidFrame) -> Vec<Solid> {
    let start = object.rotation();
    // The origin of a moving frame is the object's; the frame of a free object also has its rotation.
    let (origin, turned) = match frame {
        SolidFrame::World => (DVec3::from(object.position), start),
        SolidFrame::Cap => (DVec3::ZERO, start),
        SolidFrame::Object => (DVec3::ZERO, DMat3::IDENTITY),
    };
    let place = |(shape, centre): (SolidShape, DVec3)| Solid {
        name: name.into(),
        frame,
        position: (origin + turned * (DVec3::from(object.offset) + centre)).to_array(),
        orientation: DQuat::from_mat3(&turned).to_array(),
        shape,
    };
    shapes(&object.shape).into_iter().map(place).collect()
}

/// Parts of a shape with their centres in the frame of the shape (m).
fn shapes(shape: &ShapeConfig) -> Vec<(SolidShape, DVec3)> {
    let single = |shape| vec![(shape, DVec3::ZERO)];
    match *shape {
        ShapeConfig::Cylinder { radius, height } => single(SolidShape::Cylinder {
            radius,
            length: height,
        }),
        ShapeConfig::KnurledCylinder {
            radius,
            height,
            knurls,
            depth,
            ovality,
        } => {
            let side = |angle: f64| {
                let knurl = 0.5 * depth * (libm::cos(f64::from(knurls) * angle) - 1.0);
                let radius = radius * (1.0 + ovality * libm::cos(2.0 * angle)) + knurl;
                [radius * libm::cos(angle), radius * libm::sin(angle)]
            };
            let corners = CORNERS.max(CORNERS_PER_KNURL * knurls);
            single(prism(corners, height, side))
        }
        ShapeConfig::EllipticCylinder {
            semi_axes: [x, y],
            height,
        } => single(prism(CORNERS, height, |angle| {
            [x * libm::cos(angle), y * libm::sin(angle)]
        })),
        ShapeConfig::RoundedPrism {
            ref corners,
            rounding,
            height,
        } => single(prism(CORNERS, height, |angle| {
            rounded(corners, rounding, angle)
        })),
        ShapeConfig::Box { size } => single(SolidShape::Box { size }),
        ShapeConfig::Sphere { radius } => single(SolidShape::Sphere { radius }),
        ShapeConfig::Capsule { radius, length } => {
            let end = 0.5 * length * DVec3::Z;
            vec![
                (SolidShape::Cylinder { radius, length }, DVec3::ZERO),
                (SolidShape::Sphere { radius }, end),
                (SolidShape::Sphere { radius }, -end),
            ]
        }
        ShapeConfig::HalfSpace => {
            let below = -0.5 * PLATE[2] * DVec3::Z;
            vec![(SolidShape::Box { size: PLATE }, below)]
        }
        ShapeConfig::ConvexHull { .. } | ShapeConfig::Mesh { .. } => Vec::new(),
    }
}

/// Creates a prism of length `length` (m) whose outline has `corners` vertices. `corner` maps each of as many equally
/// spaced angles (rad) to a vertex (m).
fn prism(corners: u32, length: f64, corner: impl Fn(f64) -> [f64; 2]) -> SolidShape {
    let angles = (0..corners).map(|k| TAU * f64::from(k) / f64::from(corners));
    SolidShape::Prism {
        outline: angles.map(corner).collect(),
        length,
    }
}

/// The point farthest in direction `angle` of the convex hull of `corners`, expanded by `rounding`. `corners` must not
/// be empty.
fn rounded(corners: &[[f64; 2]], rounding: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    let reach = |[x, y]: &&[f64; 2]| x * cos + y * sin;
    let farthest = corners.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
    let [x, y] = farthest.copied().unwrap_or_default();
    [x + rounding * cos, y + rounding * sin]
}
