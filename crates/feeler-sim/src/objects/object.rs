//! Objects: their shape, and their motion (none, on a hinge or thread, or free).

use super::pose::Pose;
use super::thread::{Hinge, HingeConfig, ThreadConfig};
use crate::contact::feeler_config::Friction;
use crate::shapes::shape::{Shape, ShapeError};
use crate::shapes::shape_config::ShapeConfig;
use crate::shapes::surface_point::SurfacePoint;
use feeler::check::Checker;
use feeler::math::{rotation_x, rotation_y, rotation_z};
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// An object in an experiment file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectConfig {
    /// Shape.
    pub shape: ShapeConfig,
    /// Motion.
    pub motion: MotionConfig,
    /// Position of the origin in W at the start (m).
    pub position: [f64; 3],
    /// Rotation in W at the start: about W's x, then y, then z (deg).
    #[serde(default)]
    pub orientation_deg: [f64; 3],
    /// Position of the shape's centre in the object's frame (m). A hinge or thread turns about the object's z, so an
    /// offset along x or y makes a cap eccentric.
    #[serde(default)]
    pub offset: [f64; 3],
    /// Friction of feelers on this object. Default: friction of each feeler.
    #[serde(default)]
    pub friction: Option<Friction>,
}

/// Possible motion of an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MotionConfig {
    /// The object does not move.
    Fixed,
    /// Rotation about the object's z axis, against friction.
    Hinge(HingeConfig),
    /// Rotation about the object's z axis and descent along it, like a cap on a bottle's thread.
    Thread(ThreadConfig),
    /// Rigid-body motion under gravity: the object rests on fixed ones, slides, tips and falls.
    Free(FreeConfig),
}

/// Parameters of a free body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeConfig {
    /// Density (kg/m³), from which mass and inertia follow.
    #[serde(default = "density_of_water")]
    pub density: f64,
    /// Mass (kg). Default: from the density.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Moments of inertia about the axes of the shape's frame through the centre of mass (kg m²). Default: from shape
    /// and mass.
    #[serde(default)]
    pub inertia: Option<[f64; 3]>,
    /// Friction coefficient on fixed objects. Between two free bodies it is the mean of both.
    #[serde(default = "usual_friction")]
    pub friction: f64,
}

fn density_of_water() -> f64 {
    1000.0
}

fn usual_friction() -> f64 {
    0.5
}

impl ObjectConfig {
    /// Rotation in W at the start.
    pub fn rotation(&self) -> DMat3 {
        let [x, y, z] = self.orientation_deg.map(f64::to_radians);
        rotation_z(z) * rotation_y(y) * rotation_x(x)
    }

    /// Thread of the object, if any.
    pub fn thread(&self) -> Option<&ThreadConfig> {
        match &self.motion {
            MotionConfig::Thread(thread) => Some(thread),
            _ => None,
        }
    }

    /// Thread of the object, if any, mutable.
    pub fn thread_mut(&mut self) -> Option<&mut ThreadConfig> {
        match &mut self.motion {
            MotionConfig::Thread(thread) => Some(thread),
            _ => None,
        }
    }

    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.vector(&format!("{key}.position"), self.position);
        checker.vector(&format!("{key}.offset"), self.offset);
        for (axis, angle) in ["x", "y", "z"].into_iter().zip(self.orientation_deg) {
            let key = format!("{key}.orientation_deg.{axis}");
            checker.between(&key, angle, -360.0, 360.0);
        }
        if let Some(friction) = self.friction {
            friction.check(&format!("{key}.friction"), checker);
        }
        self.shape.check(&format!("{key}.shape"), checker);
        match &self.motion {
            MotionConfig::Fixed => {}
            MotionConfig::Hinge(hinge) => hinge.check(&format!("{key}.motion.hinge"), checker),
            MotionConfig::Thread(thread) => thread.check(&format!("{key}.motion.thread"), checker),
            MotionConfig::Free(free) => {
                checker.require(
                    &format!("{key}.shape"),
                    "half_space".to_string(),
                    self.shape != ShapeConfig::HalfSpace,
                    "a shape of finite mass for a free object",
                );
                free.check(&format!("{key}.motion.free"), checker);
            }
        }
    }
}

impl FreeConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.positive(&format!("{key}.density"), self.density);
        checker.not_negative(&format!("{key}.friction"), self.friction);
        if let Some(mass) = self.mass {
            checker.positive(&format!("{key}.mass"), mass);
        }
        let Some(inertia) = self.inertia else { return };
        let [x, y, z] = inertia;
        let good = inertia.iter().all(|&i| i > 0.0) && x <= y + z && y <= z + x && z <= x + y;
        checker.require(
            &format!("{key}.inertia"),
            format!("{inertia:?}"),
            good,
            "three moments above 0, each at most the sum of the other two",
        );
    }
}

/// Motion of an object.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// The object does not move.
    Fixed,
    /// Rotation about the object's z axis.
    Turns(Hinge),
    /// Rigid-body motion.
    Free(FreeConfig),
}

/// An object in a run.
#[derive(Clone)]
pub struct Object {
    /// Name in the experiment file.
    pub name: String,
    /// Shape.
    pub shape: Shape,
    /// Position of the shape's centre in the object's frame (m).
    pub offset: DVec3,
    /// Motion.
    pub motion: Motion,
    /// Pose at the start.
    pub start: Pose,
    /// Friction of feelers on the object, or `None` for that of each feeler.
    pub friction: Option<Friction>,
}

impl Object {
    /// Creates the object `name` of `config`; files are relative to `folder`. At the start it is turned by `angle`
    /// (rad) about its z axis.
    ///
    /// # Errors
    /// If the shape is invalid.
    pub fn new(
        name: &str,
        config: &ObjectConfig,
        angle: f64,
        folder: &Path,
    ) -> Result<Self, ShapeError> {
        Ok(Self {
            name: name.to_string(),
            shape: Shape::new(&config.shape, folder)?,
            offset: config.offset.into(),
            motion: match &config.motion {
                MotionConfig::Fixed => Motion::Fixed,
                MotionConfig::Hinge(hinge) => Motion::Turns(Hinge::plain(hinge)),
                MotionConfig::Thread(thread) => Motion::Turns(Hinge::on_thread(thread)),
                MotionConfig::Free(free) => Motion::Free(free.clone()),
            },
            start: Pose {
                position: config.position.into(),
                rotation: config.rotation() * rotation_z(angle),
            },
            friction: config.friction,
        })
    }

    /// Mass of a free object at the start (kg); `None` for other objects.
    pub fn mass(&self) -> Option<f64> {
        let Motion::Free(config) = &self.motion else {
            return None;
        };
        let own = || self.shape.mass_properties(config.density).mass();
        Some(config.mass.unwrap_or_else(own))
    }

    /// Surface point nearest to `point` (both in the object's frame, m). `None` if `point` is on the surface, up to
    /// rounding.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        let nearest = self.shape.nearest(point - self.offset)?;
        Some(SurfacePoint {
            position: nearest.position + self.offset,
            ..nearest
        })
    }
}
