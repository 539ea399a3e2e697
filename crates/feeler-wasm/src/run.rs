//! A simulated run that a page advances step by step.

use crate::js;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::live::{LiveRows, write_state};
use feeler_lab::experiment::recorded_run::{record_options, run_end};
use feeler_lab::experiment::{Pictures, Session};
use feeler_record::{BufferRecorder, RunLog};
use feeler_report::page_data::PageData;
use feeler_report::pages::Live;
use feeler_report::run::summary_from;
use serde::Serialize;
use std::io::Cursor;
use std::path::Path;
use wasm_bindgen::prelude::*;

/// Sender name of a stop by the page.
const BY: &str = "the page";

/// A simulated run with its recording in memory.
#[wasm_bindgen]
pub struct Run {
    experiment: Experiment,
    session: Session,
    log: RunLog<BufferRecorder>,
    rows: LiveRows,
    numbers: Vec<f32>,
}

/// State of a run, as a live page shows it (`LiveState` in `web/src/page_data.ts`).
#[derive(Serialize)]
struct State {
    state: String,
    stopped: bool,
    over: bool,
    /// Simulated time (s).
    time: f64,
}

#[wasm_bindgen]
impl Run {
    /// Sets up a run of a built-in experiment with `settings` of the form `KEY=VALUE`, as `feeler run --set` takes them.
    ///
    /// # Errors
    /// If the experiment is unknown, or a setting is invalid.
    #[wasm_bindgen(constructor)]
    pub fn new(experiment: &str, settings: Vec<String>) -> Result<Run, JsError> {
        let experiment = Experiment::load(experiment, &settings).map_err(js)?;
        let options = record_options(&experiment, false).map_err(js)?;
        let session = Session::rendering(&experiment, Pictures::Sensed).map_err(js)?;
        let facts = session.facts(&experiment.config);
        let recorder = BufferRecorder::new(&facts, &experiment.toml, &options).map_err(js)?;
        let rows = LiveRows::new(&experiment.config).map_err(js)?;
        Ok(Self {
            log: RunLog::new(recorder, &facts).map_err(js)?,
            numbers: Vec::with_capacity(rows.width()),
            rows,
            session,
            experiment,
        })
    }

    /// Data of the live page (`PageData` in `web/src/page_data.ts`) as JSON: scene, columns of the rows, figures. The
    /// page keeps at least `keep` rows.
    ///
    /// # Errors
    /// Never for a valid run.
    pub fn page(&self, keep: usize) -> Result<String, JsError> {
        let config = &self.experiment.config;
        let title = format!("{}, seed {}", config.name, config.seed);
        let live = Live {
            socket: String::new(),
            keep,
            orders: true,
            felt: false,
        };
        let page = PageData::of_rig(&title, &self.rows.rig(), live);
        page.to_json().map_err(js)
    }

    /// Advances by up to `steps` control steps, and stops early at the end. Returns a row for each step, one after the
    /// other, in the format of a live page's messages: the time (f64) and the other numbers (f32), little-endian.
    ///
    /// # Errors
    /// If a sensor or the hand fails.
    pub fn step(&mut self, steps: u32) -> Result<Vec<u8>, JsError> {
        let mut rows = Vec::new();
        for _ in 0..steps {
            if self.session.finished() {
                break;
            }
            let instruments = self.session.step().map_err(js)?;
            let control_loop = self.session.control_loop();
            instruments
                .record(control_loop, &mut self.log)
                .map_err(js)?;
            self.rows
                .write(&mut self.numbers, control_loop, &instruments);
            rows.extend(control_loop.state().stamp.to_le_bytes());
            rows.extend(self.numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
        Ok(rows)
    }

    /// State of the hand as JSON: `{state, stopped, over, time}`.
    ///
    /// # Errors
    /// Never; required by serde's signature.
    pub fn state(&self) -> Result<String, JsError> {
        let control_loop = self.session.control_loop();
        let controller = control_loop.controller();
        let strokes = self.experiment.config.task.strokes();
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = write_state(&mut text, controller, strokes);
        let state = State {
            state: text,
            stopped: controller.stop_reason().is_some(),
            over: self.session.finished(),
            time: control_loop.state().stamp,
        };
        serde_json::to_string(&state).map_err(js)
    }

    /// Stops the hand; the simulated world continues.
    pub fn stop(&mut self) {
        self.session.stop(BY);
    }

    /// Resumes a stopped hand.
    pub fn resume(&mut self) {
        self.session.resume();
    }

    /// Multiplies the coefficient of friction of the feelers on all objects by `factor` from now on.
    pub fn set_friction(&mut self, factor: f64) {
        self.session.rig().world().set_friction_factor(factor);
    }

    /// Ends the run, closes its recording and summarizes it. An unfinished run is marked as interrupted.
    /// `wall_time` (s) is recorded as the duration of the run.
    ///
    /// # Errors
    /// If the recording cannot be written or read back.
    pub fn finish(self, wall_time: f64) -> Result<FinishedRun, JsError> {
        let interrupted = !self.session.finished();
        let controller = self.session.control_loop().controller();
        let end = run_end(None, controller, interrupted);
        let recorder = self.log.into_recorder();
        let (recording, digest) = recorder.finish(Some(wall_time), end).map_err(js)?;
        let length = recording.len() as u64;
        let mut file = Cursor::new(&recording);
        let name = Path::new("recording.mcap");
        let summary = summary_from(&mut file, length, name).map_err(js)?;
        Ok(FinishedRun {
            digest: digest.to_string(),
            summary: summary.to_json().map_err(js)?,
            recording,
        })
    }
}

/// Results of a run.
#[wasm_bindgen]
pub struct FinishedRun {
    digest: String,
    summary: String,
    recording: Vec<u8>,
}

#[wasm_bindgen]
impl FinishedRun {
    /// SHA-256 digest of the run (hexadecimal), equal to that of `feeler run` with the same settings.
    #[wasm_bindgen(getter)]
    pub fn digest(&self) -> String {
        self.digest.clone()
    }

    /// Results and claims as JSON, the content of `summary.json`.
    #[wasm_bindgen(getter)]
    pub fn summary(&self) -> String {
        self.summary.clone()
    }

    /// Bytes of `recording.mcap`.
    #[wasm_bindgen(getter)]
    pub fn recording(&self) -> Vec<u8> {
        self.recording.clone()
    }
}
