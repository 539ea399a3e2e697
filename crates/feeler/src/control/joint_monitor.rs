//! Whether a finger's joint sensors tell the truth, as far as its commands and its geometry show.
//!
//! **Following.** A drive follows its commanded velocity with some lag. Let `Q` be the integral of the commands. With a
//! delay, a first-order lag or any other response that neither overshoots nor takes longer than `servo_lag`, the joint
//! angle is a weighted mean of what `Q` was within that time, so that the angle through which the joint turns lies
//! between bounds that the least and greatest `Q` give. A joint that stays outside of them by more than
//! [`joint_deviation`](super::monitor_config::MonitorConfig::joint_deviation) and a fifth of what was commanded does not
//! do what it is told, or its sensor does not say so: frozen, reversed, of another scale, or blocked where it should move.
//! A finger that presses is not blocked: its feelers give way, and the law stops pressing at F2.
//!
//! **Jumps.** A joint cannot turn faster than it is built to, nor far beyond its limits.

use super::monitor_config::MonitorConfig;
use super::stop_reason::StopReason;
use crate::hand::finger::FingerGeometry;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Time over which turns are compared, s: long enough for the slowest search to show a frozen joint.
const WINDOW: f64 = 2.0;
/// Blocks that the window and the lag before it are divided into.
const BLOCKS: usize = 64;
/// Part of the commanded turn by which the measured one may differ: the scale of a speed loop.
const SCALE_TOLERANCE: f64 = 0.2;
/// Angle by which noise of an encoder may exceed the greatest speed between two readings, rad.
const JUMP_NOISE: f64 = 0.005;
/// How far beyond its limits a joint may be, rad: zeros that are off, and limits drawn too narrow.
const BEYOND_LIMITS: f64 = FRAC_PI_2;

/// Least and greatest commanded angle of each joint in some time, rad, on a common scale.
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

/// A part of the window: joint angles at its begin, and commanded angles all through it.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    begin: f64,
    position: DVec3,
    commanded: Range,
}

/// The newest reading.
#[derive(Debug, Clone, Copy)]
struct Reading {
    stamp: f64,
    position: DVec3,
}

/// What one finger's joints were told and showed in the last seconds. Of a fixed size.
#[derive(Debug, Clone)]
pub struct JointMonitor {
    config: MonitorConfig,
    /// Gap between two readings after which nothing is known of what the drives did, s.
    most_gap: f64,
    newest: Option<Reading>,
    /// Integral of the commands since it began, rad.
    commanded: DVec3,
    /// The last blocks that are whole: `count` of them, the newest before `next`.
    blocks: [Block; BLOCKS],
    next: usize,
    count: usize,
    /// The block under way.
    current: Block,
}

/// A joint's number, from 0, and what is wrong with it.
type JointFault = (usize, Fault);

enum Fault {
    Beyond,
    Jump { turn: f64, elapsed: f64, limit: f64 },
    Deviation { turn: f64, expected: f64, time: f64 },
}

impl JointMonitor {
    /// A monitor that has seen nothing yet; a gap of more than `most_gap` (s) between two readings starts it afresh.
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

    /// Forgets what was: joints may have been moved from outside.
    pub fn reset(&mut self) {
        self.newest = None;
    }

    /// Looks at the joint angles `position` (rad) of `finger` at `stamp` (s). Since the reading before, its drives were to
    /// turn with `command` (rad/s). Does not allocate.
    ///
    /// # Errors
    /// When the joints cannot be there, cannot have come there, or were not told to.
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
        // A clock that goes back is another clock.
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

    /// Begins anew at `reading`.
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

    /// The whole block that was `back` before the newest one.
    fn block(&self, back: usize) -> Block {
        self.blocks[(self.next + 2 * BLOCKS - 1 - back) % BLOCKS]
    }

    /// The commanded angles of `blocks` whole blocks up to that `back` before the newest one.
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

    /// Whether a joint has turned otherwise than commanded since the oldest block before which the lag is known.
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

/// The first joint that is where none can be.
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
