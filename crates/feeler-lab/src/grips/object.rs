//! Random unknown objects for a gripper, and their disturbances while an arm carries it.

use crate::config::ExperimentConfig;
use feeler_sim::contact::Friction;
use feeler_sim::objects::{FreeConfig, MotionConfig, ObjectConfig};
use feeler_sim::rig::{ArmMotion, ArmMotionKind, FaultConfig, FaultKind};
use feeler_sim::shapes::ShapeConfig;
use feeler_sim::world::SimConfig;
use glam::DMat3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Gravitational acceleration (m/s²).
const GRAVITY: f64 = 9.81;
/// Name of the object in the simulated world.
pub(super) const OBJECT: &str = "object";
/// Name of the table in the simulated world.
pub(super) const TABLE: &str = "table";
/// Depth of a box along y (m).
const DEPTH: f64 = 0.030;
/// Height of all objects (m).
const HEIGHT: f64 = 0.060;
/// Thickness of the table (m).
pub(super) const THICKNESS: f64 = 0.02;
/// Height of the centre of an object on the table, relative to the centre of the table (m).
const STANDING: f64 = (HEIGHT + THICKNESS) / 2.0;
/// Height of the lift (m).
const LIFT: f64 = 0.1;
/// Distance by which the arm descends below its initial height (m), because an object that has slid in the grip may be
/// higher than at the start.
const FURTHER: f64 = 0.002;
/// Start of the lift (s).
const LIFT_AT: f64 = 3.0;
/// Start and end of the shake (s).
const SHAKE: [f64; 2] = [4.0, 5.5];
/// Start and end of the tug (s).
const TUG: [f64; 2] = [5.8, 6.2];
/// Start and end of the filling of the object (s).
const FILL: [f64; 2] = [6.5, 7.5];
/// Start and end of the descent (s).
const LOWER: [f64; 2] = [8.0, 8.8];
/// Grip that every object withstands (N).
const SURE: f64 = 1.5;

/// An object and its disturbances. Forces and accelerations act in the y-z plane of W, across the grip. Their angles
/// are measured from y towards z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GripObject {
    /// `true` for an upright cylinder, `false` for a box.
    pub is_round: bool,
    /// Width along the grip (m).
    pub width: f64,
    /// Position of its centre relative to the middle of the gripper (m).
    pub offset: [f64; 3],
    /// Mass before and after the object is filled (kg).
    pub mass: [f64; 2],
    /// Static friction coefficient.
    pub friction: f64,
    /// Kinetic friction coefficient relative to the static one.
    pub kinetic: f64,
    /// Stiffness relative to the gel's, or `None` if it is rigid.
    pub softness: Option<f64>,
    /// Grip above 1.5 N at which the object is crushed, relative to the largest grip that its load requires.
    pub strength: f64,
    /// Duration of the lift (s).
    pub lift_time: f64,
    /// Maximum acceleration of the shake (m/s²), its frequency (Hz) and angle (rad).
    pub shake: [f64; 3],
    /// Force of the tug relative to the weight, its rise time (s) and angle (rad).
    pub tug: [f64; 3],
}

impl GripObject {
    /// Draws the object with this `seed`.
    pub fn draw(seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let full = libm::exp(between(libm::log(0.02), libm::log(0.5)));
        Self {
            is_round: between(0.0, 1.0) < 0.5,
            width: between(0.016, 0.040),
            offset: [
                between(-0.003, 0.003),
                between(-0.002, 0.002),
                between(-0.006, 0.0),
            ],
            mass: [(full * between(0.4, 1.0)).max(0.02), full],
            friction: between(0.2, 1.2),
            kinetic: between(0.85, 1.0),
            softness: (between(0.0, 1.0) < 0.5).then(|| between(0.3, 3.0)),
            strength: between(1.6, 4.0),
            lift_time: between(0.6, 1.0),
            shake: [between(1.0, 5.0), between(1.0, 4.0), between(0.0, TAU)],
            tug: [between(0.2, 0.8), between(0.02, 0.1), between(0.0, TAU)],
        }
    }

    /// Grip of a finger that crushes the object (N), where `required` is the largest grip that its load requires.
    pub fn crush_force(&self, required: f64) -> f64 {
        SURE + self.strength * required
    }

    /// Height of the centre above the lowest point (m) of the object in this orientation.
    pub(super) fn height_of_centre(&self, rotation: &DMat3) -> f64 {
        let vertical = rotation.row(2);
        let half = self.width / 2.0;
        let across = match self.is_round {
            true => half * vertical.truncate().length(),
            false => half * vertical.x.abs() + DEPTH / 2.0 * vertical.y.abs(),
        };
        across + HEIGHT / 2.0 * vertical.z.abs()
    }

    /// Adds the object, its table, the motion of the arm and the disturbances to the experiment `config` of a gripper.
    pub fn place(&self, config: &mut ExperimentConfig) {
        let Some(sim) = &mut config.sim else {
            return;
        };
        let middle = config.task.homes().iter().fold([0.0; 3], |sum, home| {
            [
                sum[0] + home[0] / 2.0,
                sum[1] + home[1] / 2.0,
                sum[2] + home[2] / 2.0,
            ]
        });
        let position = [0, 1, 2].map(|axis| middle[axis] + self.offset[axis]);
        sim.object = [
            (OBJECT.to_string(), self.object(position)),
            (TABLE.to_string(), table(position)),
        ]
        .into();
        sim.arm = self.arm();
        sim.fault = self.disturbances();
        self.soften(sim);
        config.time_limit = LOWER[1] + 2.0;
    }

    fn object(&self, position: [f64; 3]) -> ObjectConfig {
        let shape = match self.is_round {
            true => ShapeConfig::Cylinder {
                radius: self.width / 2.0,
                height: HEIGHT,
            },
            false => ShapeConfig::Box {
                size: [self.width, DEPTH, HEIGHT],
            },
        };
        ObjectConfig {
            shape,
            motion: MotionConfig::Free(FreeConfig {
                density: 1000.0,
                mass: Some(self.mass[0]),
                inertia: None,
                friction: 0.4,
            }),
            position,
            orientation_deg: [0.0; 3],
            offset: [0.0; 3],
            friction: Some(Friction {
                static_friction: self.friction,
                kinetic_friction: self.kinetic * self.friction,
                stribeck_speed: 0.0,
            }),
        }
    }

    fn arm(&self) -> Vec<ArmMotion> {
        let travel = |from: f64, until: f64, by: f64| ArmMotion {
            from,
            until,
            kind: ArmMotionKind::Travel { by: [0.0, 0.0, by] },
        };
        let [acceleration, frequency, angle] = self.shake;
        let size = acceleration / (TAU * frequency * TAU * frequency);
        let amplitude = across(size, angle);
        vec![
            travel(LIFT_AT, LIFT_AT + self.lift_time, LIFT),
            ArmMotion {
                from: SHAKE[0],
                until: SHAKE[1],
                kind: ArmMotionKind::Shake {
                    amplitude,
                    frequency,
                },
            },
            travel(LOWER[0], LOWER[1], -LIFT - FURTHER),
        ]
    }

    fn disturbances(&self) -> Vec<FaultConfig> {
        let [share, rise, angle] = self.tug;
        let object = OBJECT.to_string();
        let pull = FaultKind::Pull {
            object: object.clone(),
            force: across(share * self.mass[0] * GRAVITY, angle),
            over: rise,
        };
        let fill = FaultKind::MassChange {
            object,
            mass: self.mass[1],
            over: FILL[1] - FILL[0],
        };
        vec![
            FaultConfig {
                kind: pull,
                from: TUG[0],
                until: Some(TUG[1]),
            },
            FaultConfig {
                kind: fill,
                from: FILL[0],
                until: None,
            },
        ]
    }

    /// Reduces stiffness and damping of the feelers in `sim` for a soft object, which acts as an elastic layer in
    /// series with the gel.
    fn soften(&self, sim: &mut SimConfig) {
        if let Some(softness) = self.softness {
            let share = softness / (1.0 + softness);
            sim.feeler.normal_stiffness *= share;
            sim.feeler.shear_stiffness *= share;
            sim.feeler.normal_damping *= share;
            sim.feeler.shear_damping *= share;
        }
    }
}

/// Vector of length `size` across the grip, at `angle` (rad) from y towards z.
fn across(size: f64, angle: f64) -> [f64; 3] {
    [0.0, size * libm::cos(angle), size * libm::sin(angle)]
}

/// The table on which an object at `position` stands.
fn table(position: [f64; 3]) -> ObjectConfig {
    let [x, y, z] = position;
    ObjectConfig {
        shape: ShapeConfig::Box {
            size: [0.1, 0.1, THICKNESS],
        },
        motion: MotionConfig::Fixed,
        position: [x, y, z - STANDING],
        orientation_deg: [0.0; 3],
        offset: [0.0; 3],
        friction: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, EulerRot};

    #[test]
    fn the_lowest_point_of_a_tilted_object_is_a_point_of_its_edge() {
        for seed in 0..20 {
            let object = GripObject::draw(seed);
            let angle = 0.1 * seed as f64;
            let rotation = DMat3::from_euler(EulerRot::XYZ, 0.3, angle, 0.7);
            // Points of the lower and the upper edge, one per 0.1 mm or less.
            let edge = |share: f64, height: f64| match object.is_round {
                true => {
                    let (sin, cos) = (TAU * share).sin_cos();
                    object.width / 2.0 * DVec3::new(cos, sin, 0.0) + height * DVec3::Z
                }
                false => {
                    let side = [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)];
                    let (x, y) = side[(4.0 * share) as usize % 4];
                    DVec3::new(x * object.width / 2.0, y * DEPTH / 2.0, height)
                }
            };
            let heights = [-HEIGHT / 2.0, HEIGHT / 2.0]
                .into_iter()
                .flat_map(|height| {
                    (0..2000).map(move |n| (rotation * edge(f64::from(n) / 2000.0, height)).z)
                });
            let lowest = heights.fold(f64::INFINITY, f64::min);
            let error = object.height_of_centre(&rotation) + lowest;
            // Between two points of the circle, 20 mm (1 - cos(pi / 2000)) at most is missed.
            assert!((0.0..1e-7).contains(&(error + 1e-12)), "{error}");
        }
    }
}
