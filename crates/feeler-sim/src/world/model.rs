//! The part of the world that is constant in a run: geometry and materials of the rig, varied by the run's seed.

use super::config::SimConfig;
use crate::bench::element::ElementConfig;
use crate::contact::columnar_feeler::{Tip, tip_of};
use crate::contact::feeler_config::FeelerConfig;
use crate::error::SimError;
use crate::objects::holder::PlaySpring;
use crate::objects::object::Object;
use crate::objects::pose::Pose;
use crate::random::{Purpose, generator, uniform};
use crate::rig::arm::ArmMotion;
use crate::rig::servo::ServoConfig;
use crate::rig::torque_sensor::TorqueSensorConfig;
use feeler::hand::{FingerGeometry, JointVector};
use feeler::sensor::fingertip::ElementLayout;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;
use std::path::Path;

/// Constant parameters of the rig in one run.
pub struct WorldModel {
    /// Time step (s).
    pub step: f64,
    /// Gravitational acceleration of free bodies in W (m/s²).
    pub gravity: DVec3,
    /// Motions of the arm that carries the hand.
    pub arm: Vec<ArmMotion>,
    /// The objects.
    pub objects: Vec<Object>,
    /// The torque sensor.
    pub torque_sensor: TorqueSensorConfig,
    /// Torsion spring with play that holds objects on a thread: the bottle's play and the torque sensor's shaft.
    pub shaft: PlaySpring,
    /// Springs with play that hold objects on a thread along W's x and y, or `None` if they cannot shift.
    pub sides: Option<[PlaySpring; 2]>,
    /// The drives.
    pub servo: ServoConfig,
    /// The fingers.
    pub fingers: Vec<Finger>,
    /// `true` if any contact force depends on speed, by damping or Stribeck friction.
    pub depends_on_speed: bool,
    /// `true` if any feeler relaxes.
    pub relaxes: bool,
    /// Fraction of a joint's velocity error that remains after one step.
    pub servo_remaining_error: f64,
    /// Gain of the torque sensor's low-pass filter for one step: the fraction of the difference between input and
    /// output by which the output changes.
    pub torque_low_pass_gain: f64,
}

/// A finger and its fingertip.
pub struct Finger {
    /// Links and joints of the finger.
    pub geometry: FingerGeometry,
    /// Radius of the dome at the centres of the undeformed tips (m).
    pub dome_radius: f64,
    /// Outward normals of the elements in the fingertip frame `T`.
    pub normals: Vec<DVec3>,
    /// Rotations from each element's frame `E_i` to the fingertip frame.
    pub element_rotations: Vec<DMat3>,
    /// The feelers, one per element.
    pub feelers: Vec<FeelerConfig>,
    /// Encoder readings minus joint angles (rad).
    pub encoder_offset: JointVector,
    /// Parameters of all feelers, if they are identical pure springs.
    pub(crate) springs: Option<FeelerConfig>,
    /// Maximum distance of any point of the dome from the axis of each joint (m).
    pub(crate) reach: JointVector,
}

impl WorldModel {
    /// Creates the rig of `config` with one finger per entry of `fingers`, varied by `seed`. Paths in `config` are
    /// relative to `folder`.
    ///
    /// # Errors
    /// If a shape cannot be created, or an override names an element that does not exist.
    pub fn new(
        config: &SimConfig,
        fingers: &[(FingerGeometry, ElementLayout)],
        folder: &Path,
        seed: u64,
    ) -> Result<Self, SimError> {
        let mut config = config.clone();
        let cap_angle = vary(&mut config, seed);
        let objects = config.object.iter().map(|(name, object)| {
            let angle = object.thread().map_or(0.0, |_| cap_angle);
            Object::new(name, object, angle, folder).map_err(|source| SimError::Shape {
                object: name.clone(),
                source,
            })
        });
        let objects = objects.collect::<Result<Vec<_>, _>>()?;
        let mut fingers: Vec<Finger> = fingers
            .iter()
            .map(|(geometry, layout)| Finger::new(geometry, layout, &config.feeler))
            .collect();
        offset_encoders(&mut fingers, config.variation.encoder_offset, seed);
        for exception in &config.element {
            override_feelers(exception, &mut fingers)?;
        }
        for finger in &mut fingers {
            let first = finger.feelers.first().filter(|first| first.is_spring());
            let alike = first.filter(|first| finger.feelers.iter().all(|other| other == *first));
            finger.springs = alike.cloned();
        }
        let feelers = || fingers.iter().flat_map(|finger| &finger.feelers);
        let damped = feelers().any(FeelerConfig::is_damped);
        let frictions = feelers().map(FeelerConfig::friction);
        let stribeck = frictions
            .chain(objects.iter().filter_map(|object| object.friction))
            .any(|friction| friction.stribeck_speed > 0.0);
        let holder = config.holder.unwrap_or_default();
        Ok(Self {
            depends_on_speed: damped || stribeck,
            relaxes: feelers().any(|feeler| feeler.relaxation.is_some()),
            step: config.step,
            gravity: config.gravity.into(),
            arm: config.arm,
            objects,
            servo_remaining_error: config.servo.remaining_error(config.step),
            torque_low_pass_gain: config.torque_sensor.low_pass_gain(config.step),
            shaft: PlaySpring::new(config.torque_sensor.stiffness, holder.turn_play),
            sides: holder.sides(),
            torque_sensor: config.torque_sensor,
            servo: config.servo,
            fingers,
        })
    }

    /// Index of the object called `name` in the experiment file; valid for all lists with one entry per object.
    pub fn object(&self, name: &str) -> Option<usize> {
        self.objects.iter().position(|object| object.name == name)
    }
}

impl Finger {
    /// The feeler of `element`; if all are identical, always the same reference.
    #[inline(always)]
    pub(crate) fn feeler(&self, element: usize) -> &FeelerConfig {
        self.springs.as_ref().unwrap_or(&self.feelers[element])
    }

    /// Undeformed tip of `element` in the frame in which the fingertip has the pose `seen`. `sets` are the creep
    /// displacements of all feelers in the fingertip frame `T` (m).
    pub(crate) fn undeformed(&self, sets: &[DVec3], seen: &Pose, element: usize) -> Tip {
        let relaxes = self.feeler(element).relaxation.is_some();
        let set = if relaxes {
            seen.rotation * sets[element]
        } else {
            DVec3::ZERO
        };
        tip_of(self.dome_radius, seen, self.normals[element], set)
    }

    fn new(geometry: &FingerGeometry, layout: &ElementLayout, feeler: &FeelerConfig) -> Self {
        let elements = &layout.elements;
        Self {
            springs: None,
            reach: geometry.lever_arms(layout.dome_radius),
            geometry: geometry.clone(),
            dome_radius: layout.dome_radius,
            normals: elements.iter().map(|e| e.normal()).collect(),
            element_rotations: elements.iter().map(|e| e.rotation).collect(),
            feelers: vec![feeler.clone(); elements.len()],
            encoder_offset: JointVector::zeros(geometry.joint_count()),
        }
    }
}

/// Draws the zero offset of every encoder (rad), uniform within ±`most`.
fn offset_encoders(fingers: &mut [Finger], most: f64, seed: u64) {
    let mut random = generator(seed, Purpose::EncoderOffset);
    for finger in fingers {
        let offset = &mut finger.encoder_offset;
        *offset = offset.map(|_| uniform(&mut random, most));
    }
}

/// Applies the overrides of `config` to the feelers of `fingers`.
///
/// # Errors
/// If the finger or an element does not exist.
fn override_feelers(config: &ElementConfig, fingers: &mut [Finger]) -> Result<(), SimError> {
    let count = fingers.len();
    let mut finger = fingers.get_mut(config.finger);
    for &element in &config.elements {
        let no_such_element = |expected| SimError::NoSuchElement {
            finger: config.finger,
            element,
            expected,
        };
        let Some(finger) = &mut finger else {
            return Err(no_such_element(format!("a finger below {count}")));
        };
        let elements = finger.feelers.len();
        let feeler = finger
            .feelers
            .get_mut(element)
            .ok_or_else(|| no_such_element(format!("an element below {elements}")))?;
        *feeler = config.feeler(feeler);
    }
    Ok(())
}

/// Draws the quantities that vary with the seed. Returns the caps' initial angle (rad).
fn vary(config: &mut SimConfig, seed: u64) -> f64 {
    let mut random = generator(seed, Purpose::Variation);
    let variation = &config.variation;
    let x = uniform(&mut random, variation.bottle_position);
    let y = uniform(&mut random, variation.bottle_position);
    let friction = 1.0 + uniform(&mut random, variation.friction);
    let seat_angle = 1.0 + uniform(&mut random, variation.seat_angle);
    let cap_angle = uniform(&mut random, variation.cap_angle).rem_euclid(TAU);
    let kinetic = 1.0 + uniform(&mut random, variation.kinetic_friction);
    let feeler = &mut config.feeler;
    feeler.static_friction *= friction;
    feeler.kinetic_friction *= friction * kinetic;
    feeler.kinetic_friction = feeler.kinetic_friction.min(feeler.static_friction);
    for object in config.object.values_mut() {
        if let Some(own) = &mut object.friction {
            *own = own.scaled(friction);
            own.kinetic_friction = (kinetic * own.kinetic_friction).min(own.static_friction);
        }
        if let Some(thread) = object.thread_mut() {
            thread.seat_angle *= seat_angle;
            object.position[0] += x;
            object.position[1] += y;
        }
    }
    cap_angle
}
