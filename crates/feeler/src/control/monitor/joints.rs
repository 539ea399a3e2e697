//! Plausibility checks of joint sensors against the commands and the finger's geometry.
//!
//! **Deviation.** A drive follows its commanded velocity with some lag. Let `Q` be the integral of the commands. For a
//! delay, a first-order lag or any other response that neither overshoots nor takes longer than `servo_lag`, the joint
//! angle is a weighted mean of `Q` within that time. So the minimum and maximum of `Q` bound the rotation of the joint.
//! If the measured rotation exceeds these bounds by more than
//! [`joint_deviation`](super::MonitorConfig::joint_deviation) plus a fifth of the commanded rotation,
//! the drive is blocked or does not follow its commands, or its sensor is frozen, reversed or has another scale.
//! Pressing does not trigger this check: the feelers yield, and the law stops pressing at F2.
//!
//! **Jumps.** A joint cannot move faster than its speed limit, and cannot be far outside its limits.

use super::MonitorConfig;
use crate::control::stop_reason::StopReason;
use crate::hand::geometry::FingerGeometry;
use crate::hand::joint_vector::JointVector;
use std::f64::consts::FRAC_PI_2;

/// Time window over which rotations are compared (s): long enough to detect a frozen joint in the slowest search.
const WINDOW: f64 = 2.0;
/// Number of blocks into which the window and the preceding lag are divided.
const BLOCKS: usize = 64;
/// Tolerance for encoder noise between two readings (rad, or times the reach for a prismatic joint), in addition to the
/// maximum rotation.
const JUMP_NOISE: f64 = 0.005;
/// Tolerance beyond the joint limits (rad, or times the reach for a prismatic joint), for wrong encoder zeros and
/// limits that are too narrow.
const BEYOND_LIMITS: f64 = FRAC_PI_2;

/// Minimum and maximum commanded angle of each joint within an interval (rad).
#[derive(Debug, Clone, Copy, Default)]
struct Range {
    low: JointVector,
    high: JointVector,
}

impl Range {
    fn at(angle: JointVector) -> Self {
        Self {
            low: angle,
            high: angle,
        }
    }

    fn or(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// A section of the time window: the joint angles at its start, and the range of commanded angles during it.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    begin: f64,
    position: JointVector,
    commanded: Range,
}

/// Time and joint angles of a reading.
#[derive(Debug, Clone, Copy)]
struct Reading {
    stamp: f64,
    position: JointVector,
}

/// Compares commands and readings of one finger's joints over the last seconds. Has a fixed size.
#[derive(Debug, Clone)]
pub struct JointMonitor {
    config: MonitorConfig,
    /// Maximum time between two readings (s). After a longer gap, the drives' motion is unknown and the comparison
    /// restarts.
    most_gap: f64,
    newest: Option<Reading>,
    /// Integral of the commands since the last restart (rad).
    commanded: JointVector,
    /// Ring buffer of `count` completed blocks. The latest one precedes the index `next`.
    blocks: [Block; BLOCKS],
    next: usize,
    count: usize,
    /// Block that is not complete yet.
    current: Block,
}

impl JointMonitor {
    /// Creates a monitor. A gap of more than `most_gap` (s) between two readings restarts the comparison.
    pub fn new(config: MonitorConfig, most_gap: f64) -> Self {
        Self {
            config,
            most_gap,
            newest: None,
            commanded: JointVector::default(),
            blocks: [Block::default(); BLOCKS],
            next: 0,
            count: 0,
            current: Block::default(),
        }
    }

    /// Discards all readings, for example because the joints may have been moved externally.
    pub fn reset(&mut self) {
        self.newest = None;
    }

    /// Checks the joint angles `position` (rad) of `finger` at `stamp` (s). `command` is the joint velocity (rad/s)
    /// in effect since the previous reading. Does not allocate.
    ///
    /// # Errors
    /// If a joint is far outside its limits, moved too fast, or did not follow its commands.
    pub fn watch(
        &mut self,
        finger: usize,
        geometry: &FingerGeometry,
        stamp: f64,
        position: JointVector,
        command: JointVector,
    ) -> Result<(), StopReason> {
        let (lower, upper) = (geometry.joint_lower(), geometry.joint_upper());
        let scale = geometry.joint_scale();
        let is_outside = |&joint: &usize| {
            let tolerance = BEYOND_LIMITS * scale[joint];
            position[joint] < lower[joint] - tolerance || position[joint] > upper[joint] + tolerance
        };
        if let Some(joint) = (0..geometry.joint_count()).find(is_outside) {
            return Err(StopReason::JointOutOfRange {
                finger,
                joint,
                angle: position[joint],
                lower: lower[joint],
                upper: upper[joint],
                unit: geometry.joint_unit(joint),
            });
        }
        let reading = Reading { stamp, position };
        let before = self.newest.replace(reading);
        // A clock that runs backwards has been replaced by another clock.
        let Some(before) = before.filter(|before| stamp >= before.stamp) else {
            self.begin(reading);
            return Ok(());
        };
        self.check_jump(finger, geometry, before, reading)?;
        let elapsed = stamp - before.stamp;
        if elapsed > self.most_gap || self.config.joint_deviation == 0.0 {
            self.begin(reading);
            return Ok(());
        }
        self.commanded += elapsed * command;
        let now = Range::at(self.commanded);
        self.current.commanded = self.current.commanded.or(now);
        if stamp - self.current.begin < self.block_length() {
            return Ok(());
        }
        self.end_block(reading);
        self.check_deviation(finger, geometry, reading)
    }

    /// Restarts the comparison with `reading`.
    fn begin(&mut self, reading: Reading) {
        self.commanded = JointVector::default();
        self.count = 0;
        self.begin_block(reading);
    }

    fn begin_block(&mut self, reading: Reading) {
        self.current = Block {
            begin: reading.stamp,
            position: reading.position,
            commanded: Range::at(self.commanded),
        };
    }

    fn end_block(&mut self, reading: Reading) {
        self.blocks[self.next] = self.current;
        self.next = (self.next + 1) % BLOCKS;
        self.count = (self.count + 1).min(BLOCKS);
        self.begin_block(reading);
    }

    fn block_length(&self) -> f64 {
        (WINDOW + self.config.servo_lag) / BLOCKS as f64
    }

    /// The completed block that is `back` blocks older than the latest one.
    fn block(&self, back: usize) -> Block {
        self.blocks[(self.next + 2 * BLOCKS - 1 - back) % BLOCKS]
    }

    /// Range of the commanded angles over `blocks` completed blocks that end `back` blocks before the latest one.
    fn commanded(&self, back: usize, blocks: usize) -> Range {
        let before = (back..back + blocks).map(|back| self.block(back).commanded);
        before.reduce(Range::or).unwrap_or_default()
    }

    fn check_jump(
        &self,
        finger: usize,
        geometry: &FingerGeometry,
        before: Reading,
        now: Reading,
    ) -> Result<(), StopReason> {
        if self.config.joint_jump == 0.0 {
            return Ok(());
        }
        let elapsed = now.stamp - before.stamp;
        let (speeds, factor) = (
            geometry.joint_speed_limit(),
            self.config.joint_jump * elapsed,
        );
        for joint in 0..geometry.joint_count() {
            let turn = now.position[joint] - before.position[joint];
            let limit = factor * speeds[joint] + JUMP_NOISE * geometry.joint_scale()[joint];
            if turn.abs() > limit {
                return Err(StopReason::JointJump {
                    finger,
                    joint,
                    turn,
                    elapsed,
                    limit,
                    unit: geometry.joint_unit(joint),
                });
            }
        }
        Ok(())
    }

    /// Checks that the rotation of every joint agrees with the commands, measured from the oldest block for which the
    /// commands of one preceding lag are known.
    fn check_deviation(
        &self,
        finger: usize,
        geometry: &FingerGeometry,
        now: Reading,
    ) -> Result<(), StopReason> {
        let lag = (self.config.servo_lag / self.block_length())
            .ceil()
            .max(1.0) as usize;
        let Some(oldest) = self.count.checked_sub(lag + 1) else {
            return Ok(());
        };
        let since = self.block(oldest);
        let (before, after) = (self.commanded(oldest + 1, lag), self.commanded(0, lag));
        let (low, high) = (after.low - before.high, after.high - before.low);
        let turn = now.position - since.position;
        let nearest = turn.clamp(low, high);
        let scale = low.abs().max(high.abs());
        let most = MonitorConfig::SCALE_TOLERANCE * scale
            + self.config.joint_deviation * geometry.joint_scale();
        match first_above((turn - nearest).abs(), most) {
            None => Ok(()),
            Some(joint) => Err(StopReason::JointDeviation {
                finger,
                joint,
                turn: turn[joint],
                expected: nearest[joint],
                time: now.stamp - since.begin,
                unit: geometry.joint_unit(joint),
                shared: false,
            }),
        }
    }
}

/// Index of the first joint whose value in `numbers` exceeds that in `most`; `None` if there is no such joint.
fn first_above(numbers: JointVector, most: JointVector) -> Option<usize> {
    (0..numbers.len()).find(|&joint| numbers[joint] > most[joint])
}
