//! What differs from grasp to grasp, drawn at random.

use feeler_sim::columnar_feeler::Friction;
use feeler_sim::gel::GelLayer;
use feeler_sim::object::{FreeConfig, MotionConfig, ObjectConfig};
use feeler_sim::shape::ShapeConfig;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// m/s².
const GRAVITY: f64 = 9.81;

/// The gel and the camera behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gel {
    /// m.
    pub thickness: f64,
    /// Pa.
    pub shear_modulus: f64,
    /// Radius of its dome, m: it is nearly flat.
    pub radius: f64,
    /// Share by which it goes on giving way under a steady force.
    pub creep: f64,
    /// Time constant of that, s.
    pub creep_time: f64,
    /// Distance of markers from each other, px.
    pub spacing: f64,
    /// Standard deviation of a marker's place from a regular grid, each way, in spacings: it stays.
    pub irregularity: f64,
    /// Standard deviation of a located centre, each way, px: another in each frame.
    pub noise: f64,
    /// Distance of the camera, m.
    pub camera: f64,
    /// Radial distortion half a picture's width off its middle, relative.
    pub distortion: f64,
}

/// An object, and how it is grasped.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// The sensor on both fingers.
    pub gel: Gel,
    /// What is grasped.
    pub shape: ShapeConfig,
    /// What that is called.
    pub shape_name: &'static str,
    /// Half its width along the grip, m.
    pub half_width: f64,
    /// Height of its middle over what it stands on, m.
    pub height: f64,
    /// Whether it lies on its side, turned about the grip's axis.
    pub lies: bool,
    /// Its mass, kg.
    pub mass: f64,
    /// Between it and the gel.
    pub friction: Friction,
    /// Force with which it is grasped, N.
    pub grip_force: f64,
    /// Where on it, from its middle, along the pads, m.
    pub off_centre: [f64; 2],
    /// Way up, m, and how long it takes, s.
    pub lift: (f64, f64),
    /// How the hand shakes, if it does.
    pub shake: Option<Shake>,
    /// A force on the object, N in W, if somebody tugs, and when it begins, s.
    pub tug: Option<(DVec3, f64)>,
    /// How far the fingers open, in parts of how far they have pressed in, if they do; and when they begin, s.
    pub loosen: Option<(f64, f64)>,
}

/// A sine of the hand that swells and ebbs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shake {
    /// Amplitude along W's axes, m.
    pub way: DVec3,
    /// Amplitude about W's z axis, rad.
    pub turn: f64,
    /// Hz.
    pub frequency: f64,
    /// When it begins, s.
    pub from: f64,
    /// How long it goes on, s.
    pub duration: f64,
}

/// Draws numbers.
struct Draw(Pcg64);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// As often in each octave.
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

    /// A shape, its name, half its width along x and half its height.
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
    /// The grasp of `seed`.
    pub fn draw(seed: u64) -> Self {
        let mut draw = Draw(Pcg64::seed_from_u64(seed));
        let gel = draw.gel();
        let (shape, shape_name, half_width, half_height) = draw.shape();
        let lies = matches!(shape_name, "cylinder" | "capsule") && draw.happens(0.5);
        let static_friction = draw.between(0.2, 1.2);
        let kinetic_friction = static_friction * draw.between(0.6, 0.95);
        let mass = draw.scale(0.02, 0.5);
        // From half to twelve times what just holds it at rest, as far as grippers of two jaws go.
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

    /// The object, its middle over the point `at` of the ground, m in W.
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
            // About x, along which it is grasped.
            orientation_deg: [if self.lies { 90.0 } else { 0.0 }, 0.0, 0.0],
            offset: [0.0; 3],
            friction: Some(self.friction),
        }
    }
}

impl Gel {
    /// Its response to forces on markers `spacing` (m) apart, as far as `reach`, m.
    pub fn layer(&self, spacing: f64, reach: f64) -> GelLayer {
        // Of this spread, the forces of a grid make an even load.
        GelLayer::new(self.thickness, self.shear_modulus, spacing / 2.0, reach)
    }
}
