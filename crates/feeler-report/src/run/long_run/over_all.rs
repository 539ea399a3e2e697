//! Quantities accumulated over all rows of a run.

use crate::measures::overload::damage_limit;
use crate::measures::peaks::{PEAK_ENDS_BELOW, PEAK_RISES_ABOVE, PeakCounter};
use crate::measures::smoothing::smoothing_window;
use crate::run::data::RunData;
use crate::run::thinned::Pressed;
use std::ops::Range;

pub struct OverAll {
    grasp_force: PeakCounter,
    torque: PeakCounter,
    /// Index among all rows of the first row with a torque.
    first_torque: Option<usize>,
    /// See [`DecimatedRun::longest_above`](crate::run::thinned::DecimatedRun::longest_above).
    pub pressed: Vec<Pressed>,
}

impl OverAll {
    /// Accumulator without rows.
    pub fn new(data: &RunData) -> Self {
        let window = smoothing_window(&data.facts);
        let peaks = PeakCounter::new(window, PEAK_RISES_ABOVE, PEAK_ENDS_BELOW);
        let of_cap = data.facts.cap.map(|cap| cap.damage_force);
        let limits = [damage_limit(&data.facts)].into_iter().chain(of_cap);
        Self {
            grasp_force: peaks.clone(),
            torque: peaks,
            first_torque: None,
            pressed: limits
                .map(|limit| Pressed::new(limit, data.fingers.len()))
                .collect(),
        }
    }

    /// Adds the latest rows of `data`; the first has the index `place` among all rows.
    pub fn take(&mut self, data: &RunData, rows: Range<usize>, place: usize) {
        for (row, place) in rows.zip(place..) {
            self.grasp_force.take(data.grasp_force(row));
            if let Some(torque) = &data.torque {
                if self.first_torque.is_none() && torque[row].is_finite() {
                    self.first_torque = Some(place);
                }
                if self.first_torque.is_some() {
                    self.torque.take(torque[row]);
                }
            }
            for pressed in &mut self.pressed {
                pressed.take_row(&data.fingers, row);
            }
        }
    }

    /// Number of peaks of grasp force and of torque. The torque count is `None` unless torque is known from the row
    /// `first_move`, at which the first MOVE starts.
    pub fn peaks(&self, first_move: Option<usize>) -> [Option<usize>; 2] {
        let in_time = |first: usize| first_move.is_none_or(|start| first <= start);
        let torque = self.first_torque.filter(|&first| in_time(first));
        [
            self.grasp_force.clone().count(),
            torque.and_then(|_| self.torque.clone().count()),
        ]
    }
}
