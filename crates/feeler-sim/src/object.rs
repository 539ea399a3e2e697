//! Things to touch: a shape, and how it may move.

use super::columnar_feeler::Friction;
use super::pose::Pose;
use super::shape::{Shape, ShapeConfig, ShapeError, SurfacePoint};
use super::thread::{Hinge, HingeConfig, ThreadConfig};
use feeler::check::Checker;
use glam::{DMat3, DVec3, EulerRot};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// An object, as an experiment file describes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectConfig {
    /// Its shape.
    pub shape: ShapeConfig,
    /// How it may move.
    pub motion: MotionConfig,
    /// Its origin in W, m, at the start.
    pub position: [f64; 3],
    /// Its rotation in W at the start: about W's x, then y, then z, deg.
    #[serde(default)]
    pub orientation_deg: [f64; 3],
    /// The shape's centre in the object's frame, m. A hinge or a thread turns about the object's z,
    /// so that an offset along x or y makes a cap sit off its centre.
    #[serde(default)]
    pub offset: [f64; 3],
    /// Friction of feelers on this object; without it, each feeler's own.
    #[serde(default)]
    pub friction: Option<Friction>,
}

/// How an object may move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MotionConfig {
    /// Not at all.
    Fixed,
    /// About its z axis, against friction.
    Hinge(HingeConfig),
    /// About its z axis, and along it, as a cap on the thread of a bottle.
    Thread(ThreadConfig),
    /// Every way, under gravity: it rests on what is fixed, slides, tips and falls.
    Free(FreeConfig),
}

/// A free body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeConfig {
    /// Density, kg/m³; with the shape it gives mass and inertia.
    #[serde(default = "density_of_water")]
    pub density: f64,
    /// Mass, kg, instead of what the density gives.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Moments of inertia about the axes of the shape's frame through the centre of mass, kg m²,
    /// instead of what density and shape (and mass) give.
    #[serde(default)]
    pub inertia: Option<[f64; 3]>,
    /// Coefficient of friction on fixed objects; between two free bodies, the mean of both.
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
    /// Its rotation in W at the start.
    pub fn rotation(&self) -> DMat3 {
        let [x, y, z] = self.orientation_deg.map(f64::to_radians);
        DMat3::from_euler(EulerRot::XYZEx, x, y, z)
    }

    /// The thread that the object turns on, if it does.
    pub fn thread(&self) -> Option<&ThreadConfig> {
        match &self.motion {
            MotionConfig::Thread(thread) => Some(thread),
            _ => None,
        }
    }

    /// As [`Self::thread`], to vary it.
    pub fn thread_mut(&mut self) -> Option<&mut ThreadConfig> {
        match &mut self.motion {
            MotionConfig::Thread(thread) => Some(thread),
            _ => None,
        }
    }
}

impl ObjectConfig {
    /// Requires every value of the table `key` to be in its range.
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
                    "a shape of finite mass, because the object is free",
                );
                free.check(&format!("{key}.motion.free"), checker);
            }
        }
    }
}

impl FreeConfig {
    /// Requires every value of the table `key` to be in its range.
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
            "three moments more than 0, none of which exceeds the sum of the other two",
        );
    }
}

/// How an object moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// About its z axis.
    Turns(Hinge),
    /// As a rigid body.
    Free(FreeConfig),
}

/// An object of one run.
#[derive(Clone)]
pub struct Object {
    /// Its name in the experiment file.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
    /// The shape's centre in the object's frame, m.
    pub offset: DVec3,
    /// How it moves.
    pub motion: Motion,
    /// Where it is at the start.
    pub start: Pose,
    /// Friction of feelers on it, where not each feeler's own.
    pub friction: Option<Friction>,
}

impl Object {
    /// The object `name` that `config` describes; files are relative to `folder`. `angle` (rad)
    /// turns it about its z axis at the start.
    ///
    /// # Errors
    /// When its shape cannot be made.
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
                rotation: config.rotation() * DMat3::from_rotation_z(angle),
            },
            friction: config.friction,
        })
    }

    /// Mass of a free object, kg, at the start; none of what is not free.
    pub fn mass(&self) -> Option<f64> {
        let Motion::Free(config) = &self.motion else {
            return None;
        };
        let own = || self.shape.mass_properties(config.density).mass();
        Some(config.mass.unwrap_or_else(own))
    }

    /// The surface point nearest to `point`, both m in the object's frame; `None` when `point` lies
    /// on the surface to within rounding.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        let nearest = self.shape.nearest(point - self.offset)?;
        Some(SurfacePoint {
            position: nearest.position + self.offset,
            ..nearest
        })
    }
}
