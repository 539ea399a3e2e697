//! One trial: what it draws, how it runs, and the row it makes.

use super::SweepError;
use super::claim_columns::ClaimColumns;
use super::design::Scheme;
use super::parameter::{Parameter, settings};
use super::plan::Plan;
use super::stroke_columns::{MEASURES, PATTERN, PATTERN_STROKES};
use crate::config::Experiment;
use crate::experiment::truth::Truth;
use crate::experiment::{ExperimentError, Pictures, Session, layouts, run_facts};
use feeler::control::phase::Phase;
use feeler::control::task::TaskConfig;
use feeler::pace::Unpaced;
use feeler_record::{FindingName, MemoryRecorder, PolicyFile, Recording, RunFacts, RunLog};
use feeler_report::criterion::Criterion;
use feeler_report::long_run::RunRecorder;
use feeler_report::{RunData, Summary, tasks};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use sha2::{Digest as _, Sha256};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// The key of the control law, on which it depends whether the claims apply.
const LAW: &str = "control.law";
/// Most strokes that have columns of their own.
const MAX_STROKES: u32 = 8;

/// The trials of a sweep, ready to run on any thread.
pub struct Trials {
    plan: Plan,
    policy: Option<PolicyFile>,
    parameters: Vec<Parameter>,
    scheme: Option<Scheme>,
    /// The claims that have columns.
    claims: Vec<ClaimColumns>,
    /// What makes a trial a success.
    criterion: Criterion,
    /// What the task may find out.
    findings: Vec<&'static str>,
    /// Whether a cap is screwed until the hand knows what became of it.
    has_cap: bool,
    strokes: u32,
}

/// What a trial is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The run's seed.
    pub seed: u64,
    /// The value of each parameter, as text.
    pub values: Vec<String>,
}

impl Trials {
    /// The trials of `plan`.
    ///
    /// # Errors
    /// When its experiment or what varies in it makes no sense.
    pub fn new(plan: &Plan) -> Result<Self, SweepError> {
        let (experiment, parameters) = plan.load()?;
        let config = &experiment.config;
        config.simulation()?;
        check_law(&experiment)?;
        let screws = matches!(config.task, TaskConfig::Screw(_));
        let facts = run_facts(config)?;
        // The claims about screwing are about a cap that is screwed on.
        let has_claims = !screws || config.cap().is_some();
        let claims = if has_claims {
            let nothing = MemoryRecorder::new(&facts)?.into_recording();
            ClaimColumns::of(&Summary::new(&nothing, &RunData::new(&nothing)))
        } else {
            Vec::new()
        };
        let task = config.task.task();
        let findings = task.findings().iter().map(|finding| finding.name).collect();
        // The measures of a stroke are of a screw's.
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
                return Err(parameter.error("there is a column of that name already".to_string()));
            }
        }
        Ok(trials)
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// What varies.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The claims that a success requires; empty if it requires none.
    pub fn required_claims(&self) -> impl Iterator<Item = &ClaimColumns> {
        let claims = self.claims.iter();
        claims.filter(|claim| self.criterion.requires(claim.id, claim.of_any_hand))
    }

    /// The claims of any hand, if they have columns: those of a cap that is screwed in four strokes or more.
    pub fn hand_claims(&self) -> impl Iterator<Item = &ClaimColumns> {
        self.claims.iter().filter(|claim| claim.of_any_hand)
    }

    /// What a success is, in words.
    pub fn success(&self) -> &'static str {
        self.criterion.words()
    }

    /// The names of a row's columns.
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

    /// What trial `trial` draws: each quantity from a stream of its own, or as the design has it.
    pub fn draw(&self, trial: u64) -> Drawn {
        let stream = |trial: u64, purpose: &str| generator(self.plan.seed, trial, purpose);
        // A seed of an experiment file is a TOML integer, which has a sign.
        let run_seed = |trial| stream(trial, "").random::<u64>() >> 1;
        let parameters = self.parameters.iter();
        let Some(scheme) = &self.scheme else {
            let draw = |p: &Parameter| p.distribution.draw(&mut stream(trial, &p.name), p.whole);
            let values = parameters.map(draw).collect();
            return Drawn {
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
        Drawn {
            seed: run_seed(seed),
            values,
        }
    }

    /// The experiment that trial `trial` runs.
    ///
    /// # Errors
    /// When what was drawn is out of range.
    pub fn experiment(&self, trial: u64) -> Result<Experiment, SweepError> {
        let drawn = self.draw(trial);
        let set = settings(self.parameters.iter().zip(&drawn.values))?;
        let settings = [vec![format!("seed={}", drawn.seed)], set].concat();
        let origin = format!("trial {trial} of {}", self.plan.origin);
        let (text, folder) = (&self.plan.experiment, self.plan.folder.clone());
        let experiment = Experiment::parse(text, &origin, &settings, folder)?;
        Ok(experiment.with_policy(self.policy.clone()))
    }

    /// Runs trial `trial`; its row, unless `stop` was raised meanwhile. Whatever goes wrong stands in the row.
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
        match &ran.came_of_it {
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
        let mut session = match Session::drawing(&experiment, Pictures::Sensed) {
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
            &mut Unpaced::default(),
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
            came_of_it: Some((log.into_recorder().finish(), Truth::of(&session))),
        }
    }

    /// The columns from `success` to the strokes', by the very code that makes a run's report.
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

    /// Whether each claim holds, its value and its margin; empty for a claim that is not about this run.
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

/// Builds the law of every finger, so that a policy that is none is not found out by each trial.
fn check_law(experiment: &Experiment) -> Result<(), ExperimentError> {
    experiment
        .control()?
        .hand_law(&layouts(&experiment.config)?)?;
    Ok(())
}

/// What came of a trial.
struct Ran {
    outcome: &'static str,
    reason: String,
    /// What the hand recorded, and what the simulator knows beside.
    came_of_it: Option<((Recording, RunData), Truth)>,
}

impl Ran {
    fn failed(outcome: &'static str, reason: String) -> Self {
        Self {
            outcome,
            reason,
            came_of_it: None,
        }
    }
}

/// The stream of `purpose` in trial `trial` of the sweep of `seed`.
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

/// A number that reads back bit for bit; nothing where there is none.
fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}
