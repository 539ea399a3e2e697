//! Plausibility checks of joint sensors against the commands and the finger's geometry.
//!
//! **Deviation.** A drive follows its commanded velocity with some lag. Let `Q` be the integral of the commands. For
//! a delay, a first-order lag or any other response that neither overshoots nor takes longer than `servo_lag`, the
//! joint angle is a weighted mean of `Q` within that time. So the minimum and maximum of `Q` bound the angle through
//! which the joint turns. If the measured turn exceeds these bounds by more than
//! [`joint_deviation`](super::monitor_config::MonitorConfig::joint_deviation) plus a fifth of the commanded turn, the
//! drive does not follow its commands or its sensor is wrong: frozen, reversed, of another scale, or blocked.
//! Pressing does not trigger this check: the feelers yield, and the law stops pressing at F2.
//!
//! **Jumps.** A joint cannot turn faster than its speed limit, and cannot be far outside of its limits.

use super::monitor_config::MonitorConfig;
use super::stop_reason::StopReason;
use crate::hand::finger::FingerGeometry;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Time over which turns are compared (s): long enough to detect a frozen joint in the slowest search.
const WINDOW: f64 = 2.0;
/// Number of blocks into which the window and the preceding lag are divided.
const BLOCKS: usize = 64;
/// Relative tolerance of the measured turn: the scale error of a velocity loop.
const SCALE_TOLERANCE: f64 = 0.2;
/// Tolerance for encoder noise between two readings (rad), in addition to the maximum turn.
const JUMP_NOISE: f64 = 0.005;
/// Tolerance beyond the joint limits (rad), for wrong encoder zeros and limits that are set too narrow.
const BEYOND_LIMITS: f64 = FRAC_PI_2;

/// Minimum and maximum commanded angle of each joint within an interval (rad).
#[derive(Debug, Clone, Copy, Default)]
struct Range {
    low: DVec3,
    high: DVec3,
}

impl Range {
    fn at(angle: DVec3) -> Self {
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

/// A part of the window: the joint angles at its start, and the range of commanded angles during it.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    begin: f64,
    position: DVec3,
    commanded: Range,
}

/// The latest reading.
#[derive(Debug, Clone, Copy)]
struct Reading {
    stamp: f64,
    position: DVec3,
}

/// Compares the commands and readings of one finger's joints over the last seconds. Of a fixed size.
#[derive(Debug, Clone)]
pub struct JointMonitor {
    config: MonitorConfig,
    /// Maximum time between two readings (s). After a longer gap, the drives' motion is unknown and the comparison
    /// restarts.
    most_gap: f64,
    newest: Option<Reading>,
    /// Integral of the commands since the last restart (rad).
    commanded: DVec3,
    /// Ring buffer of completed blocks: `count` of them, the newest before `next`.
    blocks: [Block; BLOCKS],
    next: usize,
    count: usize,
    /// The block in progress.
    current: Block,
}

/// Index of a joint, from 0, and its fault.
type JointFault = (usize, Fault);

enum Fault {
    Beyond,
    Jump { turn: f64, elapsed: f64, limit: f64 },
    Deviation { turn: f64, expected: f64, time: f64 },
}

impl JointMonitor {
    /// Creates a monitor. A gap of more than `most_gap` (s) between two readings restarts the comparison.
    pub fn new(config: MonitorConfig, most_gap: f64) -> Self {
        Self {
            config,
            most_gap,
            newest: None,
            commanded: DVec3::ZERO,
            blocks: [Block::default(); BLOCKS],
            next: 0,
            count: 0,
            current: Block::default(),
        }
    }

    /// Forgets all readings, for example because the joints may have been moved externally.
    pub fn reset(&mut self) {
        self.newest = None;
    }

    /// Checks the joint angles `position` (rad) of `finger` at `stamp` (s). `command` is the joint velocity (rad/s)
    /// in effect since the previous reading. Does not allocate.
    ///
    /// # Errors
    /// If a joint is far outside of its limits, turned too fast, or did not follow its commands.
    pub fn watch(
        &mut self,
        finger: usize,
        geometry: &FingerGeometry,
        (stamp, position): (f64, DVec3),
        command: DVec3,
    ) -> Result<(), StopReason> {
        let reading = Reading { stamp, position };
        let fault = match beyond_limits(geometry, position) {
            Some(joint) => Some((joint, Fault::Beyond)),
            None => self.look(geometry, reading, command),
        };
        match fault {
            None => Ok(()),
            Some((joint, fault)) => Err(fault.reason(finger, joint, geometry, position)),
        }
    }

    fn look(
        &mut self,
        geometry: &FingerGeometry,
        reading: Reading,
        command: DVec3,
    ) -> Option<JointFault> {
        let before = self.newest.replace(reading);
        // A clock that runs backwards has been replaced by another clock.
        let before = before.filter(|before| reading.stamp >= before.stamp);
        let Some(before) = before else {
            self.begin(reading);
            return None;
        };
        let jump = self.jump(geometry, before, reading);
        if jump.is_some() {
            return jump;
        }
        let elapsed = reading.stamp - before.stamp;
        if elapsed > self.most_gap || self.config.joint_deviation == 0.0 {
            self.begin(reading);
            return None;
        }
        self.commanded += elapsed * command;
        let now = Range::at(self.commanded);
        self.current.commanded = self.current.commanded.or(now);
        if reading.stamp - self.current.begin < self.block_length() {
            return None;
        }
        self.end_block(reading);
        self.deviation(reading)
    }

    /// Restarts the comparison at `reading`.
    fn begin(&mut self, reading: Reading) {
        self.commanded = DVec3::ZERO;
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

    /// The completed block `back` blocks before the newest one.
    fn block(&self, back: usize) -> Block {
        self.blocks[(self.next + 2 * BLOCKS - 1 - back) % BLOCKS]
    }

    /// Range of the commanded angles of `blocks` completed blocks, ending `back` blocks before the newest one.
    fn commanded(&self, back: usize, blocks: usize) -> Range {
        let before = (back..back + blocks).map(|back| self.block(back).commanded);
        before.reduce(Range::or).unwrap_or_default()
    }

    fn jump(&self, geometry: &FingerGeometry, before: Reading, now: Reading) -> Option<JointFault> {
        if self.config.joint_jump == 0.0 {
            return None;
        }
        let elapsed = now.stamp - before.stamp;
        let most = self.config.joint_jump * elapsed * geometry.joint_speed_limit();
        let (turn, most) = (now.position - before.position, most + JUMP_NOISE);
        let joint = first(turn.abs().cmpgt(most))?;
        let (turn, limit) = (turn[joint], most[joint]);
        let jump = Fault::Jump {
            turn,
            elapsed,
            limit,
        };
        Some((joint, jump))
    }

    /// Returns the first joint whose turn deviates from the commands, measured from the oldest block with a known
    /// history of one lag.
    fn deviation(&self, now: Reading) -> Option<JointFault> {
        let lag = (self.config.servo_lag / self.block_length())
            .ceil()
            .max(1.0) as usize;
        let oldest = self.count.checked_sub(lag + 1)?;
        let since = self.block(oldest);
        let (before, after) = (self.commanded(oldest + 1, lag), self.commanded(0, lag));
        let (low, high) = (after.low - before.high, after.high - before.low);
        let turn = now.position - since.position;
        let nearest = turn.clamp(low, high);
        let scale = low.abs().max(high.abs());
        let most = SCALE_TOLERANCE * scale + self.config.joint_deviation;
        let joint = first((turn - nearest).abs().cmpgt(most))?;
        let (turn, expected) = (turn[joint], nearest[joint]);
        let deviation = Fault::Deviation {
            turn,
            expected,
            time: now.stamp - since.begin,
        };
        Some((joint, deviation))
    }
}

impl Fault {
    fn reason(
        self,
        finger: usize,
        joint: usize,
        geometry: &FingerGeometry,
        position: DVec3,
    ) -> StopReason {
        match self {
            Self::Beyond => StopReason::JointOutOfRange {
                finger,
                joint,
                angle: position[joint],
                lower: geometry.joint_lower()[joint],
                upper: geometry.joint_upper()[joint],
            },
            Self::Jump {
                turn,
                elapsed,
                limit,
            } => StopReason::JointJump {
                finger,
                joint,
                turn,
                elapsed,
                limit,
            },
            Self::Deviation {
                turn,
                expected,
                time,
            } => StopReason::JointDeviation {
                finger,
                joint,
                turn,
                expected,
                time,
            },
        }
    }
}

/// Returns the first joint that is far outside of its limits.
fn beyond_limits(geometry: &FingerGeometry, position: DVec3) -> Option<usize> {
    let low = position.cmplt(geometry.joint_lower() - BEYOND_LIMITS);
    let high = position.cmpgt(geometry.joint_upper() + BEYOND_LIMITS);
    first(low | high)
}

fn first(joints: glam::BVec3) -> Option<usize> {
    joints
        .any()
        .then(|| joints.bitmask().trailing_zeros() as usize)
}
