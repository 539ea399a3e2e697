//! Message with the contact of a fingertip.

use super::channels::{Tactile, stamped};
use crate::wire::{Vector3, message, vector3_schema};
use feeler::sensor::contact::Contact as Estimate;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Contact of one fingertip with an object, estimated from one tactile frame. Vectors are in the fingertip frame `T`;
/// values that are not known are NaN. See [`Estimate`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Sequence number of the tactile frame.
    pub sequence: u64,
    /// Time of the tactile frame (s).
    pub stamp: f64,
    /// Number of elements without a valid force.
    pub invalid: u32,
    /// Number of touching elements; if 0, all following fields are NaN.
    pub touching: u32,
    /// Centre of pressure (m).
    pub centre: Vector3,
    /// Standard error of the centre along each tangent (m).
    pub centre_error: f64,
    /// Outward normal of the fingertip, a unit vector.
    pub normal: Vector3,
    /// Force on the fingertip by the object (N).
    pub force: Vector3,
    /// Standard error of each component of the force (N).
    pub force_error: f64,
    /// Torque on the fingertip by the object about `normal` through `centre` (N m).
    pub torsion: f64,
    /// Standard error of the torsion (N m).
    pub torsion_error: f64,
    /// Semi-axes of the contact area (m), the longer one first.
    pub semi_axes: [f64; 2],
    /// Standard errors of the semi-axes (m).
    pub semi_axis_errors: [f64; 2],
    /// Direction of the longer semi-axis, a unit vector.
    pub direction: Vector3,
    /// Coefficient of friction.
    pub friction: f64,
    /// Fraction of the elements with a compression of three times the threshold or more that slide.
    pub sliding: f64,
}

message!(
    Contact,
    "Contact",
    "# Contact of one fingertip with an object; fingertip frame, NaN if not known",
    "uint64 sequence  # of the tactile frame",
    "float64 stamp  # s",
    "uint32 invalid  # number of elements without a valid force",
    "uint32 touching  # number of touching elements",
    "geometry_msgs/Vector3 centre  # m, centre of pressure",
    "float64 centre_error  # m, standard error along each tangent",
    "geometry_msgs/Vector3 normal  # outward normal of the fingertip",
    "geometry_msgs/Vector3 force  # N, on the fingertip by the object",
    "float64 force_error  # N, standard error of each component",
    "float64 torsion  # N m, on the fingertip by the object about the normal through the centre",
    "float64 torsion_error  # N m, standard error",
    "float64[2] semi_axes  # m, of the contact area; the longer one first",
    "float64[2] semi_axis_errors  # m, standard errors",
    "geometry_msgs/Vector3 direction  # of the longer semi-axis",
    "float64 friction  # coefficient of friction",
    "float64 sliding  # fraction of the elements pressed with three times the threshold or more that slide",
    vector3_schema!(),
);

impl Contact {
    /// Creates the message of the contact in the frame `tactile`, or of no contact.
    pub fn new(tactile: &Tactile, contact: Option<&Estimate>) -> Self {
        const NONE: Vector3 = Vector3 {
            x: f64::NAN,
            y: f64::NAN,
            z: f64::NAN,
        };
        let is_invalid = |force: &&Vector3| !DVec3::from(**force).is_finite();
        let invalid = tactile.forces.iter().filter(is_invalid);
        let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let ellipse = contact.and_then(|c| c.ellipse);
        let number = |f: &dyn Fn(&Estimate) -> f64| contact.map_or(f64::NAN, f);
        let vector = |f: &dyn Fn(&Estimate) -> DVec3| contact.map_or(NONE, |c| f(c).into());
        Self {
            sequence: tactile.sequence,
            stamp: tactile.stamp,
            invalid: count(invalid.count()),
            touching: contact.map_or(0, |c| count(c.touching)),
            centre: vector(&|c| c.centre),
            centre_error: number(&|c| c.centre_error),
            normal: vector(&|c| c.normal),
            force: vector(&|c| c.force),
            force_error: number(&|c| c.force_error),
            torsion: number(&|c| c.torsion),
            torsion_error: number(&|c| c.torsion_error),
            semi_axes: ellipse.map_or([f64::NAN; 2], |e| e.semi_axes),
            semi_axis_errors: ellipse.map_or([f64::NAN; 2], |e| e.errors),
            direction: ellipse.map_or(NONE, |e| e.direction.into()),
            friction: number(&|c| c.friction.unwrap_or(f64::NAN)),
            sliding: number(&|c| c.sliding.unwrap_or(f64::NAN)),
        }
    }
}

stamped!(Contact);
