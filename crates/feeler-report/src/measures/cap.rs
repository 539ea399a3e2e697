//! Measures of a cap that the hand closed or opened by touch: its estimates compared with the rig's instruments.

use super::overload::{DAMAGE_TIME, longest_above};
use super::series::{finite, maximum};
use super::strokes::FeltStroke;
use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use feeler_record::{FindingName, Findings, Recording, TaskKind, TaskOutcome};
use serde::Serialize;

/// Fraction of the torque limit of friction from which a closed cap counts as tight.
pub const TIGHT: f64 = 0.7;
/// Minimum ratio of the true to the estimated rotation of an opened cap; the estimate is accurate to about 5 %.
pub const TURNED_AS_FELT: f64 = 0.9;

impl FeltStroke {
    /// Computes the values over the MOVE phase of `stroke`, which must not be empty.
    pub(crate) fn new(felt: &CapEstimates<'_>, data: &RunData, stroke: &Stroke) -> Self {
        let sense = data.facts.cap.map(|facts| facts.sense);
        let rows = stroke.moving.clone();
        let (first, last) = (rows.start, rows.end - 1);
        let times = (data.time[first], data.time[last]);
        let angle = data.cap.as_ref().map(|cap| &cap.angle);
        let turned = angle.map(|angle| angle[last] - angle[first]);
        let torque = data.torque.as_ref().zip(sense);
        Self {
            index: stroke.index,
            felt_turn: felt.turn(times),
            turn: turned
                .zip(sense)
                .and_then(|(turn, sense)| finite(sense * turn)),
            felt_torque: felt.largest_torque(times),
            torque: torque.and_then(|(torque, sense)| maximum(rows.map(|row| sense * torque[row]))),
        }
    }
}

/// Measures of a run that closed or opened a cap by touch; `None` (JSON null) if undefined.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CapMeasures {
    /// Torque limit of friction (N·m): static coefficient times allowed grasp force times radius times number of
    /// fingers; ground truth, known for simulated runs only.
    pub friction_limit: Option<f64>,
    /// 1 if the strokes close the cap, -1 if they open it; known for simulated runs only.
    pub sense: Option<f64>,
    /// Largest measured torque over all strokes (N·m), positive with the stroke.
    pub largest_torque: Option<f64>,
    /// Largest measured torque of the last stroke (N·m), positive with the stroke.
    pub final_torque: Option<f64>,
    /// Final torque relative to the torque limit of friction.
    pub torque_ratio: Option<f64>,
    /// Longest time for which an element exceeds its damage limit (s).
    pub time_over_damage: Option<f64>,
    /// Values of each stroke.
    pub strokes: Vec<FeltStroke>,
}

impl CapMeasures {
    /// Measures a run. `None` if neither a cap nor estimates of a cap were recorded.
    pub fn new(recording: &Recording, data: &RunData) -> Option<Self> {
        let facts = data.facts.cap;
        if facts.is_none() && !is_felt(recording) {
            return None;
        }
        let sense = facts.map(|facts| facts.sense);
        let felt = CapEstimates::new(recording);
        let strokes = match &data.thinned {
            Some(thinned) => thinned.felt.clone(),
            None => {
                let strokes = data.strokes.iter().filter(|s| !s.moving.is_empty());
                let strokes = strokes.map(|stroke| FeltStroke::new(&felt, data, stroke));
                strokes.collect()
            }
        };
        let final_torque = strokes.last().and_then(|stroke| stroke.torque);
        let limit = facts.map(|facts| facts.friction_limit);
        Some(Self {
            friction_limit: limit,
            sense,
            largest_torque: maximum(strokes.iter().filter_map(|stroke| stroke.torque)),
            final_torque,
            torque_ratio: (final_torque.zip(limit))
                .and_then(|(torque, limit)| finite(torque / limit)),
            time_over_damage: facts.and_then(|facts| longest_above(data, facts.damage_force)),
            strokes,
        })
    }

    /// `true` if the cap was detected closed, is tight, and no element was damaged.
    pub fn closed_well(&self, outcome: Option<&TaskOutcome>) -> bool {
        outcome == Some(&TaskOutcome::Closed)
            && self.torque_ratio.is_some_and(|ratio| ratio >= TIGHT)
            && self.harmed_nothing()
    }

    /// `true` if the hand detected that the cap is open, the true rotation agrees with the estimate, and no element was
    /// damaged.
    pub fn opened_well(&self, outcome: Option<&TaskOutcome>) -> bool {
        let sum = |turn: fn(&FeltStroke) -> Option<f64>| self.strokes.iter().map(turn).sum();
        let (felt, turned): (Option<f64>, Option<f64>) = (sum(|s| s.felt_turn), sum(|s| s.turn));
        outcome == Some(&TaskOutcome::Open)
            && (turned.zip(felt)).is_some_and(|(turned, felt)| turned >= TURNED_AS_FELT * felt)
            && self.harmed_nothing()
    }

    fn harmed_nothing(&self) -> bool {
        let time = self.time_over_damage;
        time.is_some_and(|time| time <= DAMAGE_TIME)
    }
}

/// `true` if the hand screwed a cap until it detected the outcome by touch. Uses the recorded findings, because the
/// run's facts contain this only for simulated runs.
pub fn is_felt(recording: &Recording) -> bool {
    let mut names = recording.findings.iter().flat_map(|found| &found.names);
    recording.facts.task == TaskKind::Screw && names.any(|name| *name == FindingName::Torque)
}

/// Torque and rotation estimates of the hand over time.
pub struct CapEstimates<'a> {
    findings: &'a [Findings],
}

impl<'a> CapEstimates<'a> {
    /// Estimates contained in `recording`.
    pub fn new(recording: &'a Recording) -> Self {
        let findings = &recording.findings;
        Self { findings }
    }

    /// Times (s) and values of a finding within a time span (s).
    pub fn series(&self, name: &FindingName, (from, to): (f64, f64)) -> Vec<(f64, f64)> {
        let within = self.findings.iter();
        let within = within.filter(|f| f.stamp >= from - 1e-9 && f.stamp <= to + 1e-9);
        within
            .filter_map(|f| Some((f.stamp, f.value(name)?)))
            .collect()
    }

    fn turn(&self, (from, to): (f64, f64)) -> Option<f64> {
        let before = self.series(&FindingName::Turned, (f64::NEG_INFINITY, from));
        let after = self.series(&FindingName::Turned, (f64::NEG_INFINITY, to));
        finite(after.last()?.1 - before.last()?.1)
    }

    fn largest_torque(&self, times: (f64, f64)) -> Option<f64> {
        maximum(
            self.series(&FindingName::Torque, times)
                .into_iter()
                .map(|(_, torque)| torque),
        )
    }
}
