//! Whole runs of the reference experiment through the public API.

use feeler_lab::config::Experiment;
use feeler_lab::experiment::{ExperimentError, Pictures, Session, run_facts};
use feeler_record::{Digest, Recorder, RunLog};
use feeler_report::run::make::RECORDING;
use std::path::{Path, PathBuf};

/// Folder for a test's run.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Runs the reference experiment with `settings`, renders images as selected by `pictures`, and records the run in
/// `folder`.
pub fn run(settings: &[String], pictures: Pictures, folder: &Path) -> Digest {
    run_as(
        settings,
        |experiment| Session::rendering(experiment, pictures),
        folder,
    )
}

/// Like [`run`], but with the session created by `session`.
pub fn run_as(
    settings: &[String],
    session: impl FnOnce(&Experiment) -> Result<Session, ExperimentError>,
    folder: &Path,
) -> Digest {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/experiments/cap-closing.toml");
    let experiment = Experiment::load(file, settings).expect("the reference experiment");
    let mut session = session(&experiment).expect("a session");
    let facts = run_facts(&experiment.config).expect("facts");
    let recorder = Recorder::create(folder.join(RECORDING), &facts, &experiment.toml);
    let mut log = RunLog::new(recorder.expect("a recorder"), &facts).expect("a log");
    while !session.finished() {
        let instruments = session.step().expect("a step");
        instruments
            .record(session.control_loop(), &mut log)
            .expect("a recorded step");
    }
    log.into_recorder().finish(None).expect("a recording")
}
