//! A single trial: its random values, its run, and its row in the table.

use super::SweepError;
use crate::config::Experiment;
use crate::experiment::truth::Truth;
use crate::experiment::{ExperimentError, Pictures, Session, layouts, run_facts};
use crate::sweep::plan::design::Scheme;
use crate::sweep::plan::parameter::{Parameter, settings};
use crate::sweep::plan::plan_file::Plan;
use crate::sweep::results::claim_columns::ClaimColumns;
use crate::sweep::results::stroke_columns::{MEASURES, PATTERN, PATTERN_STROKES};
use feeler::control::Phase;
use feeler::control::task::TaskConfig;
use feeler::pace::FreeRunning;
use feeler_record::{FindingName, MemoryRecorder, PolicyFile, Recording, RunFacts, RunLog};
use feeler_report::measures::Criterion;
use feeler_report::run::RunRecorder;
use feeler_report::{RunData, Summary, tasks};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use sha2::{Digest as _, Sha256};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// Key of the control law, which determines the claims that apply.
const LAW: &str = "control.law";
/// Maximum number of strokes that have columns.
const MAX_STROKES: u32 = 8;

/// The trials of a sweep, ready to run on any thread.
pub struct Trials {
    plan: Plan,
    policy: Option<PolicyFile>,
    parameters: Vec<Parameter>,
    scheme: Option<Scheme>,
    /// Claims that have columns.
    claims: Vec<ClaimColumns>,
    /// Criterion for the success of a trial.
    criterion: Criterion,
    /// Names of the findings that the task may report.
    findings: Vec<&'static str>,
    /// `true` if a cap is screwed and its final state is measured.
    has_cap: bool,
    strokes: u32,
}

/// Random values of a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialParameters {
    /// Seed of the run.
    pub seed: u64,
    /// Value of each parameter, as text.
    pub values: Vec<String>,
}

impl Trials {
    /// Prepares the trials of `plan`.
    ///
    /// # Errors
    /// If the experiment or a varied parameter is invalid.
    pub fn new(plan: &Plan) -> Result<Self, SweepError> {
        let (experiment, parameters) = plan.load()?;
        let config = &experiment.config;
        config.simulation()?;
        check_law(&experiment)?;
        let screws = matches!(config.task, TaskConfig::Screw(_));
        let facts = run_facts(config)?;
        // The claims of a screw task require a cap.
        let has_claims = !screws || config.cap().is_some();
        let claims = if has_claims {
            let nothing = MemoryRecorder::new(&facts)?.into_recording();
            ClaimColumns::of(&Summary::new(&nothing, &RunData::new(&nothing)))
        } else {
            Vec::new()
        };
        let task = config.task.task();
        let findings = task.findings().iter().map(|finding| finding.name).collect();
        // Stroke measures exist only for screw tasks.
        let strokes = if screws {
            config.task.strokes().min(MAX_STROKES)
        } else {
            0
        };
        let laws_differ = parameters.iter().any(|p| p.sets(LAW));
        let trials = Self {
            plan: plan.clone(),
            policy: experiment.policy_file()?,
            parameters,
            scheme: plan.scheme(),
            criterion: match has_claims {
                true => Criterion::of(&facts, laws_differ),
                false => Criterion::Done,
            },
            claims,
            findings,
            has_cap: facts.cap.is_some(),
            strokes,
        };
        let header = trials.header();
        for parameter in &trials.parameters {
            let columns = header.iter().filter(|name| **name == parameter.name);
            if columns.count() > 1 {
                return Err(parameter.error("another column already has this name".to_string()));
            }
        }
        Ok(trials)
    }

    /// Returns the plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the varied parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Returns the claims that a success requires, if any.
    pub fn required_claims(&self) -> impl Iterator<Item = &ClaimColumns> {
        let claims = self.claims.iter();
        claims.filter(|claim| self.criterion.requires(claim.id, claim.of_any_hand))
    }

    /// Returns the claims about any hand that have columns: those about a cap that is screwed in four or more strokes.
    pub fn hand_claims(&self) -> impl Iterator<Item = &ClaimColumns> {
        self.claims.iter().filter(|claim| claim.of_any_hand)
    }

    /// Describes the criterion of success.
    pub fn success(&self) -> &'static str {
        self.criterion.words()
    }

    /// Returns the column names.
    pub fn header(&self) -> Vec<String> {
        let mut header: Vec<String> = ["trial", "seed"].map(String::from).to_vec();
        header.extend(self.parameters.iter().map(|p| p.name.clone()));
        let fixed = [
            "outcome",
            "reason",
            "success",
            "sim_time",
            "strokes_made",
            "cap_angle",
            "claims_held",
        ];
        header.extend(fixed.map(String::from));
        for claim in &self.claims {
            header.extend([claim.holds(), claim.value(), claim.margin()]);
        }
        if !self.findings.is_empty() {
            header.push("found".to_string());
            header.extend(self.findings.iter().map(|name| format!("found.{name}")));
        }
        if self.has_cap {
            header.extend(["torque_ratio", "time_over_damage"].map(String::from));
        }
        for stroke in 1..=self.strokes {
            header.extend(MEASURES.map(|(name, _)| format!("stroke{stroke}.{name}")));
        }
        if self.strokes >= PATTERN_STROKES {
            header.extend(PATTERN.map(|(name, _)| name.to_string()));
        }
        header.extend(["cap_torque", "slip_work"].map(String::from));
        header
    }

    /// Draws the values of a trial: each from a separate random stream, or according to the design.
    pub fn draw(&self, trial: u64) -> TrialParameters {
        let stream = |trial: u64, purpose: &str| generator(self.plan.seed, trial, purpose);
        // TOML integers are signed, so the seed must fit into 63 bits.
        let run_seed = |trial| stream(trial, "").random::<u64>() >> 1;
        let parameters = self.parameters.iter();
        let Some(scheme) = &self.scheme else {
            let draw = |p: &Parameter| p.distribution.draw(&mut stream(trial, &p.name), p.whole);
            let values = parameters.map(draw).collect();
            return TrialParameters {
                seed: run_seed(trial),
                values,
            };
        };
        let key = stream(0, "design").random();
        let (sources, seed) = scheme.sources(trial);
        let value = |((index, p), source): ((usize, &Parameter), Option<u64>)| match source {
            None => p.nominal.clone(),
            Some(row) => (p.distribution).quantile(scheme.coordinate(row, index, key), p.whole),
        };
        let values = parameters.enumerate().zip(sources).map(value).collect();
        TrialParameters {
            seed: run_seed(seed),
            values,
        }
    }

    /// Returns the experiment of a trial.
    ///
    /// # Errors
    /// If a drawn value is out of range.
    pub fn experiment(&self, trial: u64) -> Result<Experiment, SweepError> {
        let drawn = self.draw(trial);
        let set = settings(self.parameters.iter().zip(&drawn.values))?;
        let settings = [vec![format!("seed={}", drawn.seed)], set].concat();
        let origin = format!("trial {trial} of {}", self.plan.origin);
        let (text, folder) = (&self.plan.experiment, self.plan.folder.clone());
        let experiment = Experiment::parse(text, &origin, &settings, folder)?;
        Ok(experiment.with_policy(self.policy.clone()))
    }

    /// Runs a trial and returns its row, or `None` if `stop` was set meanwhile. Failures are reported in the row.
    pub fn run(&self, trial: u64, stop: &AtomicBool) -> Option<Vec<String>> {
        let ran = catch_unwind(AssertUnwindSafe(|| self.simulate(trial, stop)));
        let ran = ran.unwrap_or_else(|_| Ran::failed("error", "the program panicked".into()));
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        let drawn = self.draw(trial);
        let mut row = vec![trial.to_string(), drawn.seed.to_string()];
        row.extend(drawn.values);
        row.extend([ran.outcome.to_string(), one_line(&ran.reason)]);
        match &ran.result {
            Some(((recording, data), truth)) => {
                row.extend(self.results(ran.outcome, recording, data));
                row.extend([number(truth.cap_torque), number(Some(truth.slip_work))]);
            }
            None => {
                row.push("0".to_string());
                row.resize(self.header().len(), String::new());
            }
        }
        Some(row)
    }

    fn simulate(&self, trial: u64, stop: &AtomicBool) -> Ran {
        let experiment = match self.experiment(trial) {
            Ok(experiment) => experiment,
            Err(error) => return Ran::failed("invalid", error.to_string()),
        };
        let mut session = match Session::rendering(&experiment, Pictures::Sensed) {
            Ok(session) => session,
            Err(error) => return Ran::failed("invalid", error.to_string()),
        };
        let facts = session.facts(&experiment.config);
        let recorder = RunRecorder::new(&facts);
        let mut log = match recorder.and_then(|recorder| RunLog::new(recorder, &facts)) {
            Ok(log) => log,
            Err(error) => return Ran::failed("invalid", error.to_string()),
        };
        let ran = session.run(
            &mut FreeRunning::default(),
            stop,
            |control_loop, at, _| match at.record(control_loop, &mut log) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => ControlFlow::Break(error.to_string()),
            },
        );
        let failed = ran.unwrap_or_else(|error| Some(error.to_string()));
        let controller = session.control_loop().controller();
        let (outcome, reason) = match (failed, controller.stop_reason()) {
            (Some(error), _) => ("error", error),
            (None, Some(reason)) => ("stopped", reason.to_string()),
            (None, None) if controller.phase() == Phase::Done => ("done", String::new()),
            (None, None) => ("time_limit", String::new()),
        };
        Ran {
            outcome,
            reason,
            result: Some((log.into_recorder().finish(), Truth::of(&session))),
        }
    }

    /// Returns the columns from `success` to those of the strokes, computed by the same code as the report of a run.
    fn results(&self, outcome: &str, recording: &Recording, data: &RunData) -> Vec<String> {
        let summary = Summary::new(recording, data);
        let success = outcome == "done" && self.criterion.holds(&summary);
        let required = self.criterion.claims(&summary);
        let held = required.iter().filter(|claim| claim.holds).count();
        let has_angle = self.has_cap || !self.claims.is_empty();
        let mut row = vec![
            flag(success),
            format!("{:?}", summary.sim_time),
            summary.strokes.len().to_string(),
            number(summary.cap_angle.filter(|_| has_angle)),
            match &required[..] {
                [] => String::new(),
                _ => held.to_string(),
            },
        ];
        row.extend(self.claim_fields(&recording.facts, &summary));
        if !self.findings.is_empty() {
            row.push(
                summary
                    .outcome
                    .clone()
                    .map_or_else(String::new, String::from),
            );
            let found = |&name: &&str| {
                let found = summary.findings.get(&FindingName::from(name));
                number(found.copied().flatten())
            };
            row.extend(self.findings.iter().map(found));
        }
        if self.has_cap {
            let cap = summary.cap.as_ref();
            row.push(number(cap.and_then(|cap| cap.torque_ratio)));
            row.push(number(cap.and_then(|cap| cap.time_over_damage)));
        }
        for stroke in 1..=self.strokes {
            let measured = summary.strokes.iter().find(|s| s.index == stroke);
            row.extend(MEASURES.map(|(_, measure)| number(measured.and_then(measure))));
        }
        if self.strokes >= PATTERN_STROKES {
            let pattern = summary.stroke_pattern.as_ref();
            row.extend(PATTERN.map(|(_, part)| pattern.map(part).map_or_else(String::new, flag)));
        }
        row
    }

    /// Returns the result, value and margin of each claim; empty for claims that do not apply to this run.
    fn claim_fields(&self, facts: &RunFacts, summary: &Summary) -> Vec<String> {
        let applies = tasks::claims_apply(facts);
        let own = summary.claims.iter().filter(|_| applies);
        let claims: Vec<_> = own.chain(&summary.hand_claims).collect();
        let fields = self.claims.iter().flat_map(|columns| {
            let claim = claims.iter().find(|claim| claim.id == columns.id);
            claim.map_or([const { String::new() }; 3], |claim| {
                [
                    flag(claim.holds),
                    number(claim.value),
                    number(claim.margin()),
                ]
            })
        });
        fields.collect()
    }
}

/// Builds the law of every finger, so that an invalid policy is detected before any trial runs.
fn check_law(experiment: &Experiment) -> Result<(), ExperimentError> {
    experiment
        .control()?
        .hand_law(&layouts(&experiment.config)?)?;
    Ok(())
}

/// Result of a trial.
struct Ran {
    outcome: &'static str,
    reason: String,
    /// The recording of the hand, and ground truth from the simulator.
    result: Option<((Recording, RunData), Truth)>,
}

impl Ran {
    fn failed(outcome: &'static str, reason: String) -> Self {
        Self {
            outcome,
            reason,
            result: None,
        }
    }
}

/// Returns the random stream for `purpose` in a trial of the sweep with `seed`.
pub(crate) fn generator(seed: u64, trial: u64, purpose: &str) -> Pcg64 {
    let mut hash = Sha256::new();
    hash.update(seed.to_le_bytes());
    hash.update(trial.to_le_bytes());
    hash.update(purpose.as_bytes());
    Pcg64::from_seed(hash.finalize().into())
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn flag(holds: bool) -> String {
    u8::from(holds).to_string()
}

/// Formats a number such that it parses back to the same value. `None` becomes an empty field.
fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}
