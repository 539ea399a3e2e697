//! Renders the scene from outside for human viewers: links, domes with elements coloured by force, and objects.
//!
//! A minimal ray caster: one ray per pixel, the nearest surface, and diffuse light from the camera's upper left.

use crate::objects::free_bodies::{collider, to_library};
use crate::objects::object::Motion;
use crate::world::model::Finger;
use crate::world::simulation::World;
use crate::world::state::FingerState;
use glam::{DMat3, DVec3};
use parry3d_f64::math::Pose as LibraryPose;
use parry3d_f64::query::Ray;
use parry3d_f64::shape::SharedShape;

/// Radius of a rendered link (m).
const LINK_RADIUS: f64 = 0.005;
/// Maximum distance of visible surfaces (m).
const FARTHEST: f64 = 10.0;
/// Fraction of ambient light.
const AMBIENT: f64 = 0.35;
/// Red, green and blue, from 0 to 1.
type Colour = DVec3;

const LINK: Colour = DVec3::new(0.45, 0.48, 0.55);
const DOME: Colour = DVec3::new(0.20, 0.22, 0.26);
const FREE: Colour = DVec3::new(0.85, 0.60, 0.30);
const TURNS: Colour = DVec3::new(0.30, 0.55, 0.80);
const FIXED: Colour = DVec3::new(0.70, 0.70, 0.68);
/// Background at the lower and upper edge of the image.
const BACKGROUND: [Colour; 2] = [DVec3::new(0.80, 0.82, 0.85), DVec3::new(0.96, 0.97, 0.98)];
/// Colours of an unloaded element, at half of `most_force`, and at `most_force`.
const FORCES: [Colour; 3] = [
    DVec3::new(0.55, 0.60, 0.68),
    DVec3::new(0.98, 0.80, 0.25),
    DVec3::new(0.85, 0.12, 0.10),
];

/// Error when rendering an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// The buffer has the wrong length.
    #[error("an image of {width} x {height} pixels needs {expected} bytes, got {actual}")]
    Room {
        /// Width of the image (px).
        width: usize,
        /// Height of the image (px).
        height: usize,
        /// Required length: three bytes per pixel.
        expected: usize,
        /// Length of the buffer (bytes).
        actual: usize,
    },
}

/// Viewpoint and scale of a rendered scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Position of the camera in W (m).
    pub eye: DVec3,
    /// Point at the centre of the image, in W (m).
    pub at: DVec3,
    /// Vertical field of view (rad).
    pub field_of_view: f64,
    /// Compression F_z of an element that is rendered in full red (N).
    pub most_force: f64,
}

impl View {
    /// Default view of all fingertips of `world`, from the front and slightly above.
    pub fn of(world: &World) -> Self {
        let tips = || {
            world
                .state()
                .fingers
                .iter()
                .map(|finger| finger.tip.position)
        };
        let at = tips().sum::<DVec3>() / tips().count().max(1) as f64;
        let reach = tips().map(|tip| tip.distance(at)).fold(0.0, f64::max);
        Self {
            eye: at + (0.13 + 2.2 * reach) * DVec3::new(0.3, -1.0, 0.3),
            at,
            field_of_view: 0.7,
            most_force: 0.6,
        }
    }
}

/// Renders `world` from `view` into `rgb`: `width` times `height` pixels, row by row from the top, three bytes per
/// pixel (sRGB).
///
/// # Errors
/// If `rgb` has the wrong length.
pub fn draw(
    world: &World,
    view: &View,
    (width, height): (usize, usize),
    rgb: &mut [u8],
) -> Result<(), PictureError> {
    let expected = 3 * width * height;
    if rgb.len() != expected {
        return Err(PictureError::Room {
            width,
            height,
            expected,
            actual: rgb.len(),
        });
    }
    let bodies = bodies(world);
    let camera = camera(view);
    let half = libm::tan(view.field_of_view / 2.0);
    let light = (camera.y_axis + 0.8 * camera.z_axis - 0.6 * camera.x_axis).normalize_or_zero();
    for (index, pixel) in rgb.chunks_exact_mut(3).enumerate() {
        let (column, row) = (index % width, index / width);
        // Distance from the centre of the image, in halves of its height.
        let place = |at: usize, of: usize| (2 * at + 1) as f64 - of as f64;
        let right = half * place(column, width) / height as f64;
        let up = -half * place(row, height) / height as f64;
        let ray = Ray::new(
            view.eye,
            (camera * DVec3::new(right, up, -1.0)).normalize_or_zero(),
        );
        let colour = match nearest(&bodies, &ray) {
            Some((body, normal, point)) => {
                let lit = AMBIENT + (1.0 - AMBIENT) * normal.dot(light).max(0.0);
                lit * body.colour_at(point, view.most_force)
            }
            None => BACKGROUND[0].lerp(BACKGROUND[1], 1.0 - row as f64 / height as f64),
        };
        let bytes = (255.0 * colour.clamp(DVec3::ZERO, DVec3::ONE)).to_array();
        pixel.copy_from_slice(&bytes.map(|value| value.round() as u8));
    }
    Ok(())
}

/// Rotation of the camera's frame in W: x right, y up, z backwards.
fn camera(view: &View) -> DMat3 {
    let backwards = (view.eye - view.at).try_normalize().unwrap_or(DVec3::Z);
    let right = DVec3::Z
        .cross(backwards)
        .try_normalize()
        .unwrap_or(DVec3::X);
    DMat3::from_cols(right, backwards.cross(right), backwards)
}

/// A visible body.
struct Body<'a> {
    shape: SharedShape,
    pose: LibraryPose,
    surface: Surface<'a>,
}

enum Surface<'a> {
    Plain(Colour),
    /// A dome with its elements.
    Dome(&'a Finger, &'a FingerState),
}

fn bodies(world: &World) -> Vec<Body<'_>> {
    let (model, state) = (world.model(), world.state());
    let fingers = model.fingers.iter().zip(&state.fingers);
    let mut bodies: Vec<_> = fingers
        .flat_map(|(finger, now)| of_finger(finger, now))
        .collect();
    for (object, now) in model.objects.iter().zip(&state.objects) {
        let (shape, within) = collider(object);
        let offset = LibraryPose::from_translation(object.offset);
        bodies.push(Body {
            shape,
            pose: to_library(&now.pose) * offset * within,
            surface: Surface::Plain(match object.motion {
                Motion::Free(_) => FREE,
                Motion::Turns(_) => TURNS,
                Motion::Fixed => FIXED,
            }),
        });
    }
    bodies
}

/// Links of a finger, from its base to its tip, and its dome.
fn of_finger<'a>(finger: &'a Finger, now: &'a FingerState) -> Vec<Body<'a>> {
    let (geometry, tip) = (&finger.geometry, &now.tip);
    let joints = geometry.skeleton(now.joints.link, (tip.position, tip.rotation));
    let link = |ends: &[DVec3]| Body {
        shape: SharedShape::capsule(ends[0], ends[1], LINK_RADIUS),
        pose: LibraryPose::IDENTITY,
        surface: Surface::Plain(LINK),
    };
    let mut bodies: Vec<_> = joints.windows(2).map(link).collect();
    bodies.push(Body {
        shape: SharedShape::ball(finger.dome_radius),
        pose: LibraryPose::from_translation(tip.position),
        surface: Surface::Dome(finger, now),
    });
    bodies
}

/// First body that `ray` hits, with the normal and the point in W.
fn nearest<'a>(bodies: &'a [Body<'a>], ray: &Ray) -> Option<(&'a Body<'a>, DVec3, DVec3)> {
    let mut found = None;
    let mut farthest = FARTHEST;
    for body in bodies {
        let hit = body
            .shape
            .cast_ray_and_get_normal(&body.pose, ray, farthest, true);
        if let Some(hit) = hit {
            farthest = hit.time_of_impact;
            found = Some((body, hit.normal, ray.point_at(farthest)));
        }
    }
    found
}

impl Body<'_> {
    fn colour_at(&self, point: DVec3, most_force: f64) -> Colour {
        let (finger, now) = match &self.surface {
            Surface::Plain(colour) => return *colour,
            Surface::Dome(finger, now) => (finger, now),
        };
        let to_fingertip = now.tip.rotation.transpose();
        let direction = (to_fingertip * (point - now.tip.position)) / finger.dome_radius;
        let elements = finger.normals.iter().zip(&finger.feelers).enumerate();
        let closest = elements
            .max_by(|(_, (a, _)), (_, (b, _))| a.dot(direction).total_cmp(&b.dot(direction)));
        match closest {
            Some((element, (normal, feeler)))
                if normal.distance(direction) * finger.dome_radius < feeler.tip_radius =>
            {
                let pressed = (to_fingertip * now.forces[element]).dot(*normal);
                of_force((pressed / most_force).clamp(0.0, 1.0))
            }
            _ => DOME,
        }
    }
}

/// Colour for a `share` of the maximum force.
fn of_force(share: f64) -> Colour {
    let [none, half, most] = FORCES;
    match share < 0.5 {
        true => none.lerp(half, 2.0 * share),
        false => half.lerp(most, 2.0 * share - 1.0),
    }
}
