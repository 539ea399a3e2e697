//! Random parameters of a simulated grasp.

use feeler_sim::contact::Friction;
use feeler_sim::objects::{FreeConfig, MotionConfig, ObjectConfig};
use feeler_sim::optics::GelLayer;
use feeler_sim::shapes::ShapeConfig;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Gravitational acceleration (m/s²).
const GRAVITY: f64 = 9.81;

/// A gel and the camera behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gel {
    /// Thickness (m).
    pub thickness: f64,
    /// Shear modulus (Pa).
    pub shear_modulus: f64,
    /// Radius of the nearly flat dome (m).
    pub radius: f64,
    /// Additional displacement by creep under a constant force, relative to the elastic one.
    pub creep: f64,
    /// Time constant of the creep (s).
    pub creep_time: f64,
    /// Spacing of the markers (px).
    pub spacing: f64,
    /// Standard deviation of a marker's fixed offset from a regular grid, per axis, in spacings.
    pub irregularity: f64,
    /// Standard deviation of the noise of a located centre, per axis (px).
    pub noise: f64,
    /// Distance of the camera from the gel (m).
    pub camera: f64,
    /// Relative radial distortion at half an image width from the centre.
    pub distortion: f64,
}

/// An object and the way it is grasped.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Gel on both fingers.
    pub gel: Gel,
    /// Shape of the object.
    pub shape: ShapeConfig,
    /// Name of the shape.
    pub shape_name: &'static str,
    /// Half the object's width along the grip (m).
    pub half_width: f64,
    /// Height of the object's centre above its support (m).
    pub height: f64,
    /// `true` if the object lies on its side, rotated about the grip axis.
    pub lies: bool,
    /// Mass of the object (kg).
    pub mass: f64,
    /// Friction between object and gel.
    pub friction: Friction,
    /// Grip force (N).
    pub grip_force: f64,
    /// Position of the grip relative to the object's centre, along the pads (m).
    pub off_centre: [f64; 2],
    /// Height (m) and duration (s) of the lift.
    pub lift: (f64, f64),
    /// Shake of the hand, if any.
    pub shake: Option<Shake>,
    /// Tug: force on the object (N, in W) and its start time (s), if any.
    pub tug: Option<(DVec3, f64)>,
    /// Opening of the fingers, relative to their indentation, and its start time (s), if any.
    pub loosen: Option<(f64, f64)>,
}

/// Sinusoidal motion of the hand with a smooth envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shake {
    /// Amplitude of the translation along each axis of W (m).
    pub way: DVec3,
    /// Amplitude of the rotation about the z axis of W (rad).
    pub turn: f64,
    /// Frequency (Hz).
    pub frequency: f64,
    /// Start time (s).
    pub from: f64,
    /// Duration (s).
    pub duration: f64,
}

/// Source of random parameters.
struct Draw(Pcg64);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Draws from a log-uniform distribution.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn happens(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    fn gel(&mut self) -> Gel {
        Gel {
            thickness: self.between(0.002, 0.005),
            // Young's modulus of 0.1 to 0.6 MPa: soft silicones.
            shear_modulus: self.scale(0.1e6, 0.6e6) / 3.0,
            radius: self.scale(0.04, 0.4),
            creep: self.between(0.0, 0.2),
            creep_time: self.scale(0.3, 5.0),
            spacing: self.between(25.0, 45.0),
            irregularity: self.scale(0.003, 0.012),
            noise: self.scale(0.02, 0.3),
            camera: self.between(0.015, 0.04),
            distortion: self.between(-0.1, 0.1),
        }
    }

    /// Draws a shape. Returns the shape, its name, half its width along x, and half its height.
    fn shape(&mut self) -> (ShapeConfig, &'static str, f64, f64) {
        let radius = self.scale(0.006, 0.04);
        let height = self.between(0.03, 0.12);
        match (4.0 * self.between(0.0, 1.0)) as u32 {
            0 => {
                let size = [2.0 * radius, self.scale(0.006, 0.08), height];
                (ShapeConfig::Box { size }, "box", radius, height / 2.0)
            }
            1 => {
                let radius = radius.max(0.01);
                (ShapeConfig::Sphere { radius }, "sphere", radius, radius)
            }
            2 => {
                let shape = ShapeConfig::Cylinder { radius, height };
                (shape, "cylinder", radius, height / 2.0)
            }
            _ => {
                let length = height;
                let shape = ShapeConfig::Capsule { radius, length };
                (shape, "capsule", radius, height / 2.0 + radius)
            }
        }
    }

    fn shake(&mut self) -> Shake {
        let amplitude = self.scale(0.002, 0.015);
        let mut shake = Shake {
            way: DVec3::ZERO,
            turn: 0.0,
            frequency: self.between(1.0, 4.0),
            from: self.between(3.0, 4.0),
            duration: self.between(1.0, 2.5),
        };
        match (4.0 * self.between(0.0, 1.0)) as u32 {
            0 => shake.way.x = amplitude,
            1 => shake.way.y = amplitude,
            2 => shake.way.z = amplitude,
            _ => shake.turn = self.between(0.05, 0.4),
        }
        shake
    }
}

impl Scenario {
    /// Draws the grasp with this seed.
    pub fn draw(seed: u64) -> Self {
        let mut draw = Draw(Pcg64::seed_from_u64(seed));
        let gel = draw.gel();
        let (shape, shape_name, half_width, half_height) = draw.shape();
        let lies = matches!(shape_name, "cylinder" | "capsule") && draw.happens(0.5);
        let static_friction = draw.between(0.2, 1.2);
        let kinetic_friction = static_friction * draw.between(0.6, 0.95);
        let mass = draw.scale(0.02, 0.5);
        // From 0.5 to 12 times the force that just holds the object at rest, within the range of two-jaw grippers.
        let holds = mass * GRAVITY / (2.0 * kinetic_friction);
        let grip_force = (holds * draw.scale(0.5, 12.0)).clamp(2.0, 40.0);
        let shake = draw.happens(0.7).then(|| draw.shake());
        let weight = mass * GRAVITY;
        let tug = draw.happens(0.4).then(|| {
            let force = weight * draw.scale(0.2, 2.0);
            let angle = draw.between(0.0, TAU);
            (
                force * DVec3::new(0.0, angle.cos(), angle.sin()),
                draw.between(3.0, 5.5),
            )
        });
        let loosen = draw.happens(0.4);
        let loosen = loosen.then(|| (draw.between(0.1, 1.2), draw.between(3.0, 5.5)));
        Self {
            off_centre: [
                draw.between(-0.004, 0.004),
                draw.between(-0.3, 0.3) * half_height.min(0.02),
            ],
            lift: (draw.between(0.12, 0.16), draw.between(0.8, 1.5)),
            height: if lies { half_width } else { half_height },
            gel,
            shape,
            shape_name,
            half_width,
            lies,
            mass,
            friction: Friction {
                static_friction,
                kinetic_friction,
                stribeck_speed: 0.0,
            },
            grip_force,
            shake,
            tug,
            loosen,
        }
    }

    /// Configuration of the object, with its centre above the point `at` (m, in W).
    pub fn object(&self, at: DVec3) -> ObjectConfig {
        ObjectConfig {
            shape: self.shape.clone(),
            motion: MotionConfig::Free(FreeConfig {
                density: 1000.0,
                mass: Some(self.mass),
                inertia: None,
                friction: 0.5,
            }),
            position: (at + self.height * DVec3::Z).to_array(),
            // The rotation is about x, the axis of the grip.
            orientation_deg: [if self.lies { 90.0 } else { 0.0 }, 0.0, 0.0],
            offset: [0.0; 3],
            friction: Some(self.friction),
        }
    }
}

impl Gel {
    /// Response of the gel to forces on markers at distances of `spacing` (m), up to the distance `reach` (m).
    pub fn layer(&self, spacing: f64, reach: f64) -> GelLayer {
        // With this spread, equal forces on a grid add up to a uniform load.
        GelLayer::new(self.thickness, self.shear_modulus, spacing / 2.0, reach)
    }
}
