//! Contact flags of a finger (paper, Fig. 4): computes TOUCH, SLIP and OVER from tri-axial forces.

use crate::sensor::forces::reading::TactileFrame;
use glam::DVec3;
use multiversion::multiversion;

/// Thresholds of the contact flags TOUCH, SLIP and OVER.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlagThresholds {
    /// F1: compression above which an element is in contact (N).
    pub touch_force: f64,
    /// F2: compression above which an element must not be pressed further (N).
    pub over_force: f64,
    /// dr: shear rate above which an element counts as slipping (N/s).
    pub slip_threshold: f64,
}

/// Flags and grasp force of one finger (paper, Fig. 4).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FingerFlags {
    /// TOUCH: the compression of an element is above F1, or SLIP is raised.
    pub touch: bool,
    /// SLIP: the shear rate of an element is above dr.
    pub slip: bool,
    /// OVER: the compression of an element is above F2.
    pub over: bool,
    /// Element in contact (F_z > F1) with the largest F_z, if any.
    pub largest_element: Option<usize>,
    /// Grasp force: sum of the elements' compressions F_z > 0 (N).
    pub grasp_force: f64,
}

impl FingerFlags {
    /// Combines these flags with those of a `newer` frame. A flag is raised if it is raised in either frame. The grasp
    /// force is that of the newer frame, and so is the element if the newer frame has one.
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

/// Computes the flags of one finger from its tactile frames.
#[derive(Debug, Clone)]
pub struct FlagAnalyzer {
    thresholds: FlagThresholds,
    previous: Option<Previous>,
    flags: FingerFlags,
    /// |d(F_x, F_y)/dt| of each element (N/s).
    shear_rate: Vec<f64>,
    /// (F_x, F_y) of each element at the previous frame (N).
    previous_shear: Vec<[f64; 2]>,
}

/// Stamp and sequence number of the frame that shear rates refer to.
#[derive(Debug, Clone, Copy)]
struct Previous {
    sequence: u64,
    stamp: f64,
}

impl FlagAnalyzer {
    /// Creates an analyzer for a finger of `elements` sensing elements.
    pub fn new(thresholds: FlagThresholds, elements: usize) -> Self {
        Self {
            thresholds,
            previous: None,
            flags: FingerFlags::default(),
            shear_rate: vec![0.0; elements],
            previous_shear: vec![[0.0; 2]; elements],
        }
    }

    /// Shear rate |d(F_x, F_y)/dt| of each element at the latest frame (N/s).
    pub fn shear_rate(&self) -> &[f64] {
        &self.shear_rate
    }

    /// Time of the latest analysed frame (s), or NaN before the first.
    pub fn stamp(&self) -> f64 {
        self.previous.map_or(f64::NAN, |p| p.stamp)
    }

    /// Returns the flags for `frame`. If `frame` has already been analysed, nothing changes. The shear rates of the
    /// first frame are zero. Elements without a valid force raise no flag.
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

/// Number of elements processed in parallel.
const LANES: usize = 4;

/// Computes the shear rates from the `previous` forces, measured `interval` seconds ago, to `forces`. Stores `forces`
/// as the new previous ones. If `interval` is 0 or negative, the rates are 0.
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
        // The rate is NaN if the element has no valid force in one of the frames.
        rates[lane] = if interval > 0.0 && !rate.is_nan() {
            rate
        } else {
            0.0
        };
    }
    rates
}
