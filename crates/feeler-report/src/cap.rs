//! A cap that was screwed until the hand knew what became of it: what the hand felt, held against the rig's instruments.

use super::claims::longest_above;
use super::run_data::{RunData, Stroke};
use super::series::{finite, maximum};
use feeler_record::{FindingName, Findings, Recording, TaskKind, TaskOutcome};
use serde::Serialize;

/// A closed cap is tight from this share of the torque that friction allows.
pub const TIGHT: f64 = 0.7;
/// A cap that was found open has turned by at least this share of what was felt: 5 % is how well turns are felt.
pub const TURNED_AS_FELT: f64 = 0.9;
/// An element is damaged that stays over its damage limit for longer than this, s.
pub const DAMAGE_TIME: f64 = 0.05;

/// One stroke as it was felt, and as it was.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeltStroke {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// By how much the cap turned, as felt, rad, positive with the stroke.
    pub felt_turn: Option<f64>,
    /// By how much it turned, rad.
    pub turn: Option<f64>,
    /// Largest torque as felt, N·m, positive with the stroke.
    pub felt_torque: Option<f64>,
    /// Largest torque as the torque sensor has it, N·m.
    pub torque: Option<f64>,
}

impl FeltStroke {
    /// Of a `stroke` with a MOVE.
    pub(crate) fn new(felt: &Felt<'_>, data: &RunData, stroke: &Stroke) -> Self {
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

/// What the run measures; `None` (JSON null) where the recording does not define it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CapMeasures {
    /// Torque that friction allows: static coefficient times the grip allowed times radius times fingers, N·m; known of
    /// simulated worlds only.
    pub friction_limit: Option<f64>,
    /// 1 where the strokes close the cap, -1 where they open it; known as the limit is.
    pub sense: Option<f64>,
    /// Largest torque of all strokes by the torque sensor, N·m, positive with the stroke.
    pub largest_torque: Option<f64>,
    /// Largest torque of the last stroke by the torque sensor, N·m, positive with the stroke.
    pub final_torque: Option<f64>,
    /// The final torque relative to the limit of friction.
    pub torque_ratio: Option<f64>,
    /// Longest time of an element over its damage limit, s.
    pub time_over_damage: Option<f64>,
    /// The strokes.
    pub strokes: Vec<FeltStroke>,
}

impl CapMeasures {
    /// Measures a run; none where the strokes were merely counted.
    pub fn new(recording: &Recording, data: &RunData) -> Option<Self> {
        let facts = data.facts.cap;
        if facts.is_none() && !is_felt(recording) {
            return None;
        }
        let sense = facts.map(|facts| facts.sense);
        let felt = Felt::new(recording);
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

    /// Whether the cap was found closed, is tight, and no element was harmed.
    pub fn closed_well(&self, outcome: Option<&TaskOutcome>) -> bool {
        outcome == Some(&TaskOutcome::Closed)
            && self.torque_ratio.is_some_and(|ratio| ratio >= TIGHT)
            && self.harmed_nothing()
    }

    /// Whether the cap was found open, has turned as far as was felt, and no element was harmed.
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

/// Whether a cap was screwed until the hand knew what became of it, as its findings tell. The run's facts say so of
/// simulated worlds only.
pub fn is_felt(recording: &Recording) -> bool {
    let mut names = recording.findings.iter().flat_map(|found| &found.names);
    recording.facts.task == TaskKind::Screw && names.any(|name| *name == FindingName::Torque)
}

/// What the hand felt over time.
pub struct Felt<'a> {
    findings: &'a [Findings],
}

impl<'a> Felt<'a> {
    /// That of `recording`.
    pub fn new(recording: &'a Recording) -> Self {
        let findings = &recording.findings;
        Self { findings }
    }

    /// Time (s) and value of a finding, within a span of time (s).
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
