//! Checks the configuration of a chain.

use super::config::{ChainConfig, MimicConfig, RowType};
use super::error::ChainError;
use super::{MAX_FRAMES, MAX_JOINTS};

/// Maximum absolute value of a base coordinate (m).
const BASE_RANGE: f64 = 100.0;
/// Maximum absolute value of a length in a row (m).
const LENGTH_RANGE: f64 = 10.0;
/// Maximum absolute value of roll, pitch, yaw or offset (rad; m for the offset of a prismatic row).
const ANGLE_RANGE: f64 = 10.0;
/// Maximum absolute value of an angle in a Denavit-Hartenberg row (degrees).
const ANGLE_RANGE_DEG: f64 = 360.0;
/// Maximum absolute value of a joint limit or multiplier.
const JOINT_RANGE: f64 = 100.0;
/// Valid lengths of an axis vector.
const AXIS_RANGE: std::ops::RangeInclusive<f64> = 1e-3..=1e3;
/// Maximum number of rows, including fixed ones.
const MAX_ROWS: usize = 32;

/// Checks all values that do not depend on other parts of the configuration, except the references to joints.
pub(super) fn check(config: &ChainConfig) -> Result<(), ChainError> {
    check_counts(config)?;
    check_joints(config)?;
    vector("base_position", config.base_position, metres_100)?;
    vector("base_rpy", config.base_rpy, radians)?;
    vector("tip_position", config.tip_position, metres_10)?;
    vector("tip_rpy", config.tip_rpy, radians)?;
    for (index, row) in config.dh.iter().enumerate() {
        degrees(&format!("dh[{index}].theta_deg"), row.theta_deg)?;
        metres_10(&format!("dh[{index}].d"), row.d)?;
        metres_10(&format!("dh[{index}].a"), row.a)?;
        degrees(&format!("dh[{index}].alpha_deg"), row.alpha_deg)?;
    }
    for (index, row) in config.frames.iter().enumerate() {
        vector(&format!("frames[{index}].xyz"), row.xyz, metres_10)?;
        vector(&format!("frames[{index}].rpy"), row.rpy, radians)?;
        if row.row_type != RowType::Fixed {
            let length = glam::DVec3::from_array(row.axis).length();
            let field = format!("length of frames[{index}].axis");
            let good = AXIS_RANGE.contains(&length);
            require(&field, length, good, "0.001..1000")?;
        }
    }
    Ok(())
}

fn check_counts(config: &ChainConfig) -> Result<(), ChainError> {
    let count = |field, count, range: std::ops::RangeInclusive<usize>, expected| {
        if range.contains(&count) {
            return Ok(());
        }
        Err(ChainError::Count {
            field,
            count,
            expected,
        })
    };
    count("joints", config.joints.len(), 1..=MAX_JOINTS, "1 to 7")?;
    let (dh, frames) = (config.dh.len(), config.frames.len());
    if (dh == 0) == (frames == 0) {
        return Err(ChainError::Tables { dh, frames });
    }
    count("rows", dh + frames, 1..=MAX_ROWS, "1 to 32")?;
    let types = config.dh.iter().map(|row| row.row_type);
    let types = types.chain(config.frames.iter().map(|row| row.row_type));
    let moving = types.filter(|&row| row != RowType::Fixed).count();
    count("moving rows", moving, 1..=MAX_FRAMES, "1 to 16")
}

fn check_joints(config: &ChainConfig) -> Result<(), ChainError> {
    for (index, joint) in config.joints.iter().enumerate() {
        let mut earlier = config.joints.iter().take(index);
        if joint.name.is_empty() || earlier.any(|other| other.name == joint.name) {
            let name = joint.name.clone();
            return Err(ChainError::Name { index, name });
        }
        let (lower, upper) = (joint.lower, joint.upper);
        for (side, limit) in [("lower", lower), ("upper", upper)] {
            let good = limit.abs() <= JOINT_RANGE;
            let field = format!("joints[{index}].{side}");
            require(&field, limit, good, "-100..100 rad or m")?;
        }
        if lower >= upper {
            return Err(ChainError::JointLimits {
                index,
                lower,
                upper,
            });
        }
        let good = joint.speed > 0.0 && joint.speed.is_finite();
        let field = format!("joints[{index}].speed");
        require(&field, joint.speed, good, "above 0 rad/s or m/s")?;
    }
    Ok(())
}

/// Coupling of a moving frame to its independent joint: index of the joint, multiplier and offset.
pub(super) struct Drive {
    pub(super) joint: usize,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

/// Coupling of the row `field` to a joint; `None` if the row is fixed.
///
/// # Errors
/// If the row has neither or both of `joint` and `mimic`, or refers to an unknown joint.
pub(super) fn drive(
    config: &ChainConfig,
    field: &str,
    row_type: RowType,
    joint: Option<&str>,
    mimic: Option<&MimicConfig>,
) -> Result<Option<Drive>, ChainError> {
    let driver = |expected| {
        let field = field.to_string();
        Err(ChainError::Driver { field, expected })
    };
    match (row_type, joint, mimic) {
        (RowType::Fixed, None, None) => Ok(None),
        (RowType::Fixed, ..) => driver("a fixed row without joint and mimic"),
        (_, Some(name), None) => Ok(Some(Drive {
            joint: find(config, &format!("{field}.joint"), name)?,
            multiplier: 1.0,
            offset: 0.0,
        })),
        (_, None, Some(mimic)) => coupled(config, field, mimic).map(Some),
        _ => driver("a moving row with either joint or mimic"),
    }
}

fn coupled(config: &ChainConfig, field: &str, mimic: &MimicConfig) -> Result<Drive, ChainError> {
    let (multiplier, offset) = (mimic.multiplier, mimic.offset);
    let good = multiplier != 0.0 && multiplier.abs() <= JOINT_RANGE;
    let expected = "-100..100, not 0";
    let name = format!("{field}.mimic.multiplier");
    require(&name, multiplier, good, expected)?;
    let good = offset.abs() <= ANGLE_RANGE;
    let name = format!("{field}.mimic.offset");
    require(&name, offset, good, "-10..10 rad or m")?;
    Ok(Drive {
        joint: find(config, &format!("{field}.mimic.joint"), &mimic.joint)?,
        multiplier,
        offset,
    })
}

fn find(config: &ChainConfig, field: &str, name: &str) -> Result<usize, ChainError> {
    let position = config.joints.iter().position(|joint| joint.name == name);
    position.ok_or_else(|| {
        let names: Vec<_> = config.joints.iter().map(|j| j.name.as_str()).collect();
        ChainError::UnknownJoint {
            field: field.to_string(),
            name: name.to_string(),
            known: names.join(", "),
        }
    })
}

/// Returns `Ok` if `good`, otherwise an error for `value`.
pub(super) fn require(
    field: &str,
    value: f64,
    good: bool,
    expected: &'static str,
) -> Result<(), ChainError> {
    if good {
        return Ok(());
    }
    Err(ChainError::OutOfRange {
        field: field.to_string(),
        value,
        expected,
    })
}

fn vector(
    field: &str,
    values: [f64; 3],
    check: fn(&str, f64) -> Result<(), ChainError>,
) -> Result<(), ChainError> {
    for (index, value) in values.into_iter().enumerate() {
        check(&format!("{field}[{index}]"), value)?;
    }
    Ok(())
}

fn metres_100(field: &str, value: f64) -> Result<(), ChainError> {
    require(field, value, value.abs() <= BASE_RANGE, "-100..100 m")
}

fn metres_10(field: &str, value: f64) -> Result<(), ChainError> {
    require(field, value, value.abs() <= LENGTH_RANGE, "-10..10 m")
}

fn radians(field: &str, value: f64) -> Result<(), ChainError> {
    require(field, value, value.abs() <= ANGLE_RANGE, "-10..10 rad")
}

fn degrees(field: &str, value: f64) -> Result<(), ChainError> {
    require(
        field,
        value,
        value.abs() <= ANGLE_RANGE_DEG,
        "-360..360 deg",
    )
}
