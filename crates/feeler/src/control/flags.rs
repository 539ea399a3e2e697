//! The flag analyzer (paper, Fig. 4): from tri-axial forces to TOUCH, SLIP and OVER.

use crate::sensor::reading::TactileFrame;
use glam::DVec3;
use multiversion::multiversion;

/// The thresholds of the flag analyzer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlagThresholds {
    /// F1: an element pressed harder than this touches, N.
    pub touch_force: f64,
    /// F2: an element pressed harder than this may not be pressed further, N.
    pub over_force: f64,
    /// dr: an element whose shear force changes faster than this slips, N/s.
    pub slip_threshold: f64,
}

/// What one finger feels, in the words of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FingerFlags {
    /// An element is pressed harder than F1, or slips.
    pub touch: bool,
    /// An element's shear force changes faster than dr.
    pub slip: bool,
    /// An element is pressed harder than F2.
    pub over: bool,
    /// The touching element (F_z > F1) of largest F_z.
    pub largest_element: Option<usize>,
    /// Grasp force: sum of the elements' compressions F_z > 0, N.
    pub grasp_force: f64,
}

impl FingerFlags {
    /// What is to be seen of these flags and those of a `newer` frame together: what was up in either is
    /// up; force and element are the newer's, the element at least where it has one.
    pub fn then(self, newer: Self) -> Self {
        Self {
            touch: self.touch || newer.touch,
            slip: self.slip || newer.slip,
            over: self.over || newer.over,
            largest_element: newer.largest_element.or(self.largest_element),
            grasp_force: newer.grasp_force,
        }
    }
}

/// Turns one finger's tactile frames into flags.
#[derive(Debug, Clone)]
pub struct FlagAnalyzer {
    thresholds: FlagThresholds,
    previous: Option<Previous>,
    flags: FingerFlags,
    /// |d(F_x, F_y)/dt| of each element, N/s.
    shear_rate: Vec<f64>,
    /// (F_x, F_y) of each element at the previous frame, N.
    previous_shear: Vec<[f64; 2]>,
}

/// The frame that shear rates are taken against.
#[derive(Debug, Clone, Copy)]
struct Previous {
    sequence: u64,
    stamp: f64,
}

impl FlagAnalyzer {
    /// An analyzer for a finger of `elements` sensing elements that has felt nothing yet.
    pub fn new(thresholds: FlagThresholds, elements: usize) -> Self {
        Self {
            thresholds,
            previous: None,
            flags: FingerFlags::default(),
            shear_rate: vec![0.0; elements],
            previous_shear: vec![[0.0; 2]; elements],
        }
    }

    /// The shear rate |d(F_x, F_y)/dt| of each element at the newest frame, N/s.
    pub fn shear_rate(&self) -> &[f64] {
        &self.shear_rate
    }

    /// Time of the newest frame that was analysed, s; not a number before the first.
    pub fn stamp(&self) -> f64 {
        self.previous.map_or(f64::NAN, |p| p.stamp)
    }

    /// The flags at `frame`. A frame that was analysed already changes nothing; the first frame
    /// has no shear rate. Elements without a valid force raise no flag.
    pub fn analyze(&mut self, frame: &TactileFrame) -> FingerFlags {
        let seen = self.previous.is_some_and(|p| p.sequence == frame.sequence);
        if !seen {
            self.measure_shear_rate(frame);
            self.flags = self.raise_flags(frame);
        }
        self.flags
    }

    fn measure_shear_rate(&mut self, frame: &TactileFrame) {
        let interval = self.previous.map_or(0.0, |p| frame.stamp - p.stamp);
        let previous = &mut self.previous_shear;
        shear_rates(&frame.forces, previous, interval, &mut self.shear_rate);
        self.previous = Some(Previous {
            sequence: frame.sequence,
            stamp: frame.stamp,
        });
    }

    fn raise_flags(&self, frame: &TactileFrame) -> FingerFlags {
        let FlagThresholds {
            touch_force,
            over_force,
            slip_threshold,
        } = self.thresholds;
        let (mut largest_element, mut largest_force) = (None, touch_force);
        let (mut over, mut grasp_force) = (false, 0.0);
        for (element, force) in frame.forces.iter().enumerate() {
            if force.z > largest_force {
                (largest_element, largest_force) = (Some(element), force.z);
            }
            over |= force.z > over_force;
            grasp_force += force.z.max(0.0);
        }
        let slip = self.shear_rate.iter().any(|&rate| rate > slip_threshold);
        FingerFlags {
            touch: largest_element.is_some() || slip,
            slip,
            over,
            largest_element,
            grasp_force,
        }
    }
}

/// Elements whose shear rates are worked out side by side.
const LANES: usize = 4;

/// The rates at which shear forces changed from the `previous` ones, `interval` seconds ago, to those of `forces`, which then take their
/// place. Without an interval they are 0.
#[multiversion(targets("x86_64+avx2"))]
fn shear_rates(forces: &[DVec3], previous: &mut [[f64; 2]], interval: f64, rates: &mut [f64]) {
    let count = forces.len().min(rates.len());
    let (forces, last_forces) = forces[..count].as_chunks::<LANES>();
    let (previous, last_previous) = previous[..count].as_chunks_mut::<LANES>();
    let (rates, last_rates) = rates[..count].as_chunks_mut::<LANES>();
    for ((forces, previous), rates) in forces.iter().zip(previous).zip(rates) {
        *rates = shear_rates_of(forces, previous, interval);
    }
    for ((force, previous), rate) in last_forces.iter().zip(last_previous).zip(last_rates) {
        [*rate] = shear_rates_of(&[*force], std::array::from_mut(previous), interval);
    }
}

#[inline(always)]
fn shear_rates_of<const N: usize>(
    forces: &[DVec3; N],
    previous: &mut [[f64; 2]; N],
    interval: f64,
) -> [f64; N] {
    let mut rates = [0.0; N];
    for lane in 0..N {
        let (x, y) = (forces[lane].x, forces[lane].y);
        let [before_x, before_y] = previous[lane];
        previous[lane] = [x, y];
        let (x, y) = (x - before_x, y - before_y);
        let rate = (x * x + y * y).sqrt() / interval;
        // Of an element without a valid force in either frame, the rate is unknown.
        rates[lane] = if interval > 0.0 && !rate.is_nan() {
            rate
        } else {
            0.0
        };
    }
    rates
}
