//! Builds a chain from its configuration.

use super::check::{Drive, check, drive, require};
use super::config::{ChainConfig, DhRow, FrameRow, RowType};
use super::error::ChainError;
use super::task_rank::TaskRanks;
use super::{Chain, Joint, Segment};
use crate::math::{rotation_x, rotation_y, rotation_z};
use glam::{DMat3, DVec3};

/// Default damping threshold epsilon as a fraction of the reach. With two equal links, damping starts within 9 degrees
/// of a straight finger.
const THRESHOLD_SHARE: f64 = 0.04;

/// Minimum reach of a valid chain (m).
const MINIMUM_REACH: f64 = 1e-3;

/// Rigid transform, a rotation followed by a translation: `x -> rotation x + translation`.
#[derive(Clone, Copy)]
struct Transform {
    translation: DVec3,
    rotation: DMat3,
}

impl Transform {
    fn new(translation: [f64; 3], rpy: [f64; 3]) -> Self {
        let [roll, pitch, yaw] = rpy;
        Self {
            translation: DVec3::from_array(translation),
            rotation: rotation_z(yaw) * rotation_y(pitch) * rotation_x(roll),
        }
    }

    fn from_rotation(rotation: DMat3) -> Self {
        Self {
            translation: DVec3::ZERO,
            rotation,
        }
    }

    fn then(self, next: Self) -> Self {
        Self {
            translation: self.translation + self.rotation * next.translation,
            rotation: self.rotation * next.rotation,
        }
    }
}

/// Segments built so far, and the constant transform since the last moving frame.
struct Builder {
    /// Transform from `W` to the first moving frame.
    first: Option<Transform>,
    segments: Vec<Segment>,
    pending: Transform,
}

impl Builder {
    /// Appends a constant transform.
    fn fixed(&mut self, transform: Transform) {
        self.pending = self.pending.then(transform);
    }

    /// Appends a moving frame that rotates about or moves along the z axis of the current frame.
    fn moving(&mut self, prismatic: bool, drive: Drive) {
        self.close();
        self.segments.push(Segment {
            prismatic,
            joint: drive.joint,
            multiplier: drive.multiplier,
            offset: drive.offset,
            translation: DVec3::ZERO,
            rotation: DMat3::IDENTITY,
        });
    }

    /// Stores the pending transform in the last segment.
    fn close(&mut self) {
        let pending =
            std::mem::replace(&mut self.pending, Transform::from_rotation(DMat3::IDENTITY));
        match self.segments.last_mut() {
            None => self.first = Some(pending),
            Some(last) => {
                last.translation = pending.translation;
                last.rotation = pending.rotation;
            }
        }
    }

    fn dh_row(&mut self, row: &DhRow, drive: Option<Drive>) {
        let theta = Transform::from_rotation(rotation_z(row.theta_deg.to_radians()));
        let shift = Transform {
            translation: DVec3::new(row.a, 0.0, row.d),
            rotation: rotation_x(row.alpha_deg.to_radians()),
        };
        let prismatic = row.row_type == RowType::Prismatic;
        if prismatic {
            self.fixed(theta);
        }
        if let Some(drive) = drive {
            self.moving(prismatic, drive);
        }
        if !prismatic {
            self.fixed(theta);
        }
        self.fixed(shift);
    }

    fn frame_row(&mut self, row: &FrameRow, drive: Option<Drive>) {
        self.fixed(Transform::new(row.xyz, row.rpy));
        if let Some(drive) = drive {
            let to_axis = rotation_to(DVec3::from_array(row.axis).normalize());
            self.fixed(Transform::from_rotation(to_axis));
            self.moving(row.row_type == RowType::Prismatic, drive);
            self.fixed(Transform::from_rotation(to_axis.transpose()));
        }
    }
}

/// Rotation that maps the z axis to the unit vector `axis`.
fn rotation_to(axis: DVec3) -> DMat3 {
    let (x, y) = axis.any_orthonormal_pair();
    if x.cross(y).dot(axis) > 0.0 {
        DMat3::from_cols(x, y, axis)
    } else {
        DMat3::from_cols(y, x, axis)
    }
}

/// Checks `config` and builds the chain with precomputed transforms.
pub(super) fn build(config: &ChainConfig) -> Result<Chain, ChainError> {
    check(config)?;
    let mut builder = Builder {
        first: None,
        segments: Vec::new(),
        pending: Transform::new(config.base_position, config.base_rpy),
    };
    for (index, row) in config.dh.iter().enumerate() {
        let (field, joint) = (format!("dh[{index}]"), row.joint.as_deref());
        let drive = drive(config, &field, row.row_type, joint, row.mimic.as_ref())?;
        builder.dh_row(row, drive);
    }
    for (index, row) in config.frames.iter().enumerate() {
        let (field, joint) = (format!("frames[{index}]"), row.joint.as_deref());
        let drive = drive(config, &field, row.row_type, joint, row.mimic.as_ref())?;
        builder.frame_row(row, drive);
    }
    builder.fixed(Transform::new(config.tip_position, config.tip_rpy));
    builder.close();
    finish(config, builder)
}

fn finish(config: &ChainConfig, builder: Builder) -> Result<Chain, ChainError> {
    let Builder {
        first, segments, ..
    } = builder;
    // `check` ensures at least one moving row, whose motion sets `first`.
    let first = first.unwrap_or(Transform::from_rotation(DMat3::IDENTITY));
    let reach = reach(config, &segments);
    let good = reach >= MINIMUM_REACH;
    require("reach of the chain", reach, good, "at least 0.001 m")?;
    let damping_threshold = config.damping_threshold.unwrap_or(THRESHOLD_SHARE * reach);
    let good = (1e-6 * reach..=reach).contains(&damping_threshold);
    let expected = "1e-6 of the reach to the reach";
    require("damping_threshold", damping_threshold, good, expected)?;

    let is_prismatic = config.is_prismatic();
    let mut joints = Vec::new();
    for (index, joint) in config.joints.iter().enumerate() {
        let driven = segments.iter().filter(move |s| s.joint == index);
        if driven.clone().next().is_none() {
            let name = joint.name.clone();
            return Err(ChainError::UnusedJoint { name });
        }
        joints.push(Joint {
            lower: joint.lower,
            upper: joint.upper,
            speed: joint.speed,
            scale: scale(driven, reach),
            prismatic: is_prismatic[index],
        });
    }
    let mut chain = Chain {
        base_position: DVec3::from_array(config.base_position),
        origin: first.translation,
        rotation: first.rotation,
        segments,
        joints,
        reach,
        damping_threshold,
        ranks: TaskRanks::default(),
    };
    chain.ranks = TaskRanks::of(&chain);
    let rank = chain.ranks.rank((1 << chain.joint_count()) - 1);
    let expected = "at least 1";
    let field = "number of directions in which the fingertip moves";
    require(field, rank as f64, rank > 0, expected)?;
    Ok(chain)
}

/// Change of a joint's position that corresponds to one scaled unit: 1 rad if the joint rotates any of the `driven`
/// frames, otherwise the displacement that moves the fastest of them by the reach.
fn scale<'a>(driven: impl Iterator<Item = &'a Segment> + Clone, reach: f64) -> f64 {
    if driven.clone().any(|segment| !segment.prismatic) {
        return 1.0;
    }
    let fastest = driven.map(|segment| segment.multiplier.abs());
    reach / fastest.fold(f64::MIN_POSITIVE, f64::max)
}

/// Upper bound of the distance from base to fingertip (m): sum of the links' lengths and of the largest displacements.
fn reach(config: &ChainConfig, segments: &[Segment]) -> f64 {
    let length = |segment: &Segment| {
        let joint = &config.joints[segment.joint];
        let at = |q: f64| (segment.multiplier * q + segment.offset).abs();
        let travel = at(joint.lower).max(at(joint.upper));
        segment.translation.length() + if segment.prismatic { travel } else { 0.0 }
    };
    segments.iter().map(length).sum()
}
