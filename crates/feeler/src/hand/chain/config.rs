//! Configuration of a chain, as in the experiment file.

use serde::{Deserialize, Serialize};

/// Configuration of a finger of one to seven independent joints. Its moving frames are described by either `dh` or
/// `frames`, from the base to the fingertip.
///
/// ```
/// use feeler::hand::chain::{Chain, ChainConfig};
///
/// // The second joint bends with the first, as in a finger with one tendon.
/// let config: ChainConfig = toml::from_str(
///     r#"
///     base_position = [0.0, 0.0, 0.1]
///     joints = [{ name = "tendon", lower = 0.0, upper = 1.5, speed = 3.0 }]
///     dh = [
///         { joint = "tendon", a = 0.05 },
///         { mimic = { joint = "tendon", multiplier = 0.7 }, a = 0.04 },
///     ]
///     "#,
/// )?;
/// let chain = Chain::new(&config)?;
/// let (position, _) = chain.pose(&[0.0]);
/// assert_eq!(position.to_array(), [0.09, 0.0, 0.1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChainConfig {
    /// Origin of the finger base `B` in the world `W` (m). Each coordinate is within -100..100.
    pub base_position: [f64; 3],
    /// Roll, pitch and yaw of the base in `W`, the rotation `Rz(yaw) Ry(pitch) Rx(roll)` as in URDF (rad), each
    /// within -10..10.
    #[serde(default)]
    pub base_rpy: [f64; 3],
    /// Independent joints, one to seven.
    pub joints: Vec<JointConfig>,
    /// Rows of a Denavit-Hartenberg table, at most 32, including at most 16 moving ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dh: Vec<DhRow>,
    /// Frames defined like the joints of a URDF file, at most 32, including at most 16 moving ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<FrameRow>,
    /// Origin of the fingertip frame `T`, the dome's centre, in the last frame (m). Each coordinate is within -10..10.
    #[serde(default)]
    pub tip_position: [f64; 3],
    /// Roll, pitch and yaw of `T` in the last frame (rad), each within -10..10. The x axis of `T` is the dome's outward
    /// axis.
    #[serde(default)]
    pub tip_rpy: [f64; 3],
    /// Threshold epsilon (m/rad) of the smallest singular value, below which resolved rate control is damped: 1e-6 to 1
    /// times the chain's reach. Default: 0.04 times the reach.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping_threshold: Option<f64>,
}

impl ChainConfig {
    /// `true` for each joint that is the `joint` of a prismatic row, so that its position is a displacement (m). An
    /// angular joint may drive prismatic rows by `mimic`, as in a rack and pinion.
    pub(in crate::hand) fn is_prismatic(&self) -> Vec<bool> {
        let dh = self.dh.iter().map(|row| (row.row_type, &row.joint));
        let frames = self.frames.iter().map(|row| (row.row_type, &row.joint));
        let rows: Vec<_> = dh.chain(frames).collect();
        let of_joint = |joint: &JointConfig| {
            let mut own = rows.iter();
            own.any(|(row_type, own)| {
                *row_type == RowType::Prismatic && own.as_ref() == Some(&joint.name)
            })
        };
        self.joints.iter().map(of_joint).collect()
    }
}

/// Independent joint. Its position is a displacement (m) if it is the `joint` of a prismatic row, otherwise an angle
/// (rad).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointConfig {
    /// Name by which the rows refer to the joint.
    pub name: String,
    /// Lower limit (rad or m), within -100..100.
    pub lower: f64,
    /// Upper limit (rad or m), above `lower`, within -100..100.
    pub upper: f64,
    /// Maximum speed in either direction (rad/s or m/s), above 0.
    pub speed: f64,
}

/// Type of motion of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowType {
    /// Rotation about the axis.
    #[default]
    Revolute,
    /// Translation along the axis.
    Prismatic,
    /// Constant transform without a joint.
    Fixed,
}

/// Coupling of a row to an independent joint: the row's position is `multiplier * q + offset`, as in URDF.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MimicConfig {
    /// Name of the independent joint.
    pub joint: String,
    /// Change of the row's position per change of the joint's position, within -100..100, not 0 (m/rad or rad/m if their
    /// units differ).
    #[serde(default = "one")]
    pub multiplier: f64,
    /// Position of the row if the position of the joint is 0 (rad or m), within -10..10.
    #[serde(default)]
    pub offset: f64,
}

fn one() -> f64 {
    1.0
}

/// Row of a Denavit-Hartenberg table in the classic (distal) convention: the transform from the previous frame is
/// `Rz(theta) Tz(d) Tx(a) Rx(alpha)`. The row's position is added to theta (revolute) or d (prismatic).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DhRow {
    /// Type of motion of the row.
    #[serde(default, rename = "type")]
    pub row_type: RowType,
    /// Name of the independent joint whose position is the row's position. A moving row has either `joint` or `mimic`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Coupling to an independent joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mimic: Option<MimicConfig>,
    /// Angle theta at row position 0 (degrees), within -360..360.
    #[serde(default)]
    pub theta_deg: f64,
    /// Offset d at row position 0 (m), within -10..10.
    #[serde(default)]
    pub d: f64,
    /// Link length a (m), within -10..10.
    #[serde(default)]
    pub a: f64,
    /// Link twist alpha (degrees), within -360..360.
    #[serde(default)]
    pub alpha_deg: f64,
}

/// Frame defined like a joint of a URDF file: a constant transform from the previous frame, then a motion about or
/// along `axis`.
///
/// The fields have the names, units and defaults of URDF. For a URDF joint without `mimic`, `joint` is its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameRow {
    /// Type of motion of the row.
    #[serde(default, rename = "type")]
    pub row_type: RowType,
    /// Name of the independent joint whose position is the row's position. A moving row has either `joint` or `mimic`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Coupling to an independent joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mimic: Option<MimicConfig>,
    /// Origin of the frame in the previous frame (m). Each coordinate is within -10..10.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// Roll, pitch and yaw in the previous frame, the rotation `Rz(yaw) Ry(pitch) Rx(roll)` (rad), each within -10..10.
    #[serde(default)]
    pub rpy: [f64; 3],
    /// Axis of the motion in this frame; its length is arbitrary within 0.001..1000.
    #[serde(default = "x_axis")]
    pub axis: [f64; 3],
}

fn x_axis() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

impl Default for FrameRow {
    fn default() -> Self {
        Self {
            row_type: RowType::default(),
            joint: None,
            mimic: None,
            xyz: [0.0; 3],
            rpy: [0.0; 3],
            axis: x_axis(),
        }
    }
}
