//! Injected faults of one finger's tactile sensor: lost, late, frozen and corrupted exposures.

use super::fault::{FaultConfig, FaultKind, SAME_TIME};
use crate::random::{Generator, Purpose, chance, generator};
use feeler::sensor::image::Picture;
use glam::DVec3;

/// Faults of one finger's tactile sensor. Allocates only on construction.
#[derive(Debug, Clone)]
pub struct SensorFaults {
    faults: Vec<(FaultConfig, Generator)>,
    /// Number of exposures so far.
    exposures: u64,
    /// Ring buffer of exposures that may not have arrived yet; empty without latency.
    under_way: Vec<Exposure>,
    /// Sequence number of the latest exposure that has arrived.
    arrived: Option<u64>,
}

#[derive(Debug, Clone)]
struct Exposure {
    sequence: u64,
    stamp: f64,
    due: f64,
    forces: Vec<DVec3>,
}

/// An exposure that has arrived.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Sequence number.
    pub sequence: u64,
    /// Time of the exposure (s).
    pub stamp: f64,
    /// `true` if it repeats the previous one, including noise.
    pub frozen: bool,
}

impl SensorFaults {
    /// Selects the `faults` that affect the sensor of `finger`, which has this number of `elements` and is exposed
    /// every `period` (s). `seed` determines random losses.
    pub fn new(
        faults: &[FaultConfig],
        finger: usize,
        elements: usize,
        period: f64,
        seed: u64,
    ) -> Self {
        let own = |(index, fault): (usize, &FaultConfig)| {
            let random = generator(seed, Purpose::Fault(index));
            (fault.kind.finger() == Some(finger)).then(|| (fault.clone(), random))
        };
        let faults: Vec<_> = faults.iter().enumerate().filter_map(own).collect();
        let delays = faults.iter().filter_map(|(fault, _)| fault.delay());
        let places = delays
            .reduce(f64::max)
            .map_or(0, |delay| (delay / period).ceil() as usize + 2);
        let place = Exposure {
            sequence: 0,
            stamp: 0.0,
            due: f64::INFINITY,
            forces: vec![DVec3::ZERO; elements],
        };
        Self {
            faults,
            exposures: 0,
            under_way: vec![place; places],
            arrived: None,
        }
    }

    /// Returns `true` if there are no faults.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// Exposes the sensor at `now` (s) to `forces`. Returns the latest exposure if one has arrived since the last call,
    /// and replaces `forces` by its forces.
    pub fn expose(&mut self, now: f64, forces: &mut [DVec3]) -> Option<Arrival> {
        let sequence = self.exposures;
        self.exposures += 1;
        let first = self.arrived.is_none();
        let lost = self.spoil(now, forces) && !first;
        let stamp = if self.under_way.is_empty() {
            if lost {
                return None;
            }
            self.arrived = Some(sequence);
            now
        } else {
            if !lost {
                let late = |(fault, _): &(FaultConfig, Generator)| {
                    fault.delay().filter(|_| fault.active(now) && !first)
                };
                let delay = self.faults.iter().filter_map(late).fold(0.0, f64::max);
                self.send(sequence, now, now + delay, forces);
            }
            self.receive(now, forces)?
        };
        let frozen =
            !first && self.any(stamp, |kind| matches!(kind, FaultKind::FrozenFrame { .. }));
        Some(Arrival {
            sequence: self.arrived?,
            stamp,
            frozen,
        })
    }

    /// Overwrites the stuck rows of a `picture` that was exposed at `stamp`.
    pub fn overwrite_rows(&self, stamp: f64, picture: &mut Picture) {
        for (fault, _) in self.faults.iter().filter(|(f, _)| f.active(stamp)) {
            if let FaultKind::StuckRows {
                first, count, gray, ..
            } = fault.kind
            {
                let end = first.saturating_add(count).min(picture.height);
                let pixels = first.min(end) * picture.width..end * picture.width;
                if let Some(rows) = picture.pixels.get_mut(pixels) {
                    rows.fill(gray);
                }
            }
        }
    }

    /// Zeroes the forces of dead elements and scales those of a sensor with a wrong gain. Returns `true` if the exposure is lost.
    fn spoil(&mut self, now: f64, forces: &mut [DVec3]) -> bool {
        let mut lost = false;
        for (fault, random) in &mut self.faults {
            if !fault.active(now) {
                continue;
            }
            match fault.kind {
                FaultKind::DeadElement { element, .. } => {
                    if let Some(force) = forces.get_mut(element) {
                        *force = DVec3::ZERO;
                    }
                }
                FaultKind::SensorGain { gain, .. } => {
                    forces.iter_mut().for_each(|force| *force *= gain);
                }
                FaultKind::DroppedFrames { probability, .. } => lost |= chance(random, probability),
                _ => {}
            }
        }
        lost
    }

    fn any(&self, time: f64, kind: impl Fn(&FaultKind) -> bool) -> bool {
        let mut faults = self.faults.iter();
        faults.any(|(fault, _)| kind(&fault.kind) && fault.active(time))
    }

    /// Stores an exposure in the latency buffer.
    fn send(&mut self, sequence: u64, stamp: f64, due: f64, forces: &[DVec3]) {
        let places = self.under_way.len() as u64;
        let place = &mut self.under_way[(sequence % places) as usize];
        (place.sequence, place.stamp, place.due) = (sequence, stamp, due);
        for (kept, &force) in place.forces.iter_mut().zip(forces) {
            *kept = force;
        }
    }

    /// Stamp of the latest exposure that has arrived by `now`, if it is new; writes its forces to `forces`.
    fn receive(&mut self, now: f64, forces: &mut [DVec3]) -> Option<f64> {
        let there = self.under_way.iter().filter(|e| e.due <= now + SAME_TIME);
        let newest = there.max_by_key(|exposure| exposure.sequence)?;
        if self
            .arrived
            .is_some_and(|arrived| newest.sequence <= arrived)
        {
            return None;
        }
        self.arrived = Some(newest.sequence);
        for (force, &kept) in forces.iter_mut().zip(&newest.forces) {
            *force = kept;
        }
        Some(newest.stamp)
    }
}

impl FaultConfig {
    fn delay(&self) -> Option<f64> {
        match self.kind {
            FaultKind::CameraLatency { delay, .. } => Some(delay),
            _ => None,
        }
    }
}
