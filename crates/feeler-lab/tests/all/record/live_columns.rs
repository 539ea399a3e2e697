//! Columns of a run, built while it is recorded.

use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session};
use feeler_record::{MemoryRecorder, RunLog};
use feeler_report::run::RunRecorder;
use feeler_report::{RunData, Summary};

/// Formats data with all digits, so that NaN compares equal to itself.
fn text(data: &impl std::fmt::Debug) -> String {
    format!("{data:?}")
}

#[test]
fn columns_built_while_recording_equal_those_from_memory() {
    let settings = ["sensing=direct", "task.screw.strokes=2"].map(String::from);
    let experiment = Experiment::load("cap-closing", &settings).expect("an experiment");
    let mut session = Session::rendering(&experiment, Pictures::Sensed).expect("a session");
    let facts = session.facts(&experiment.config);
    let mut whole = RunLog::new(MemoryRecorder::new(&facts).unwrap(), &facts).unwrap();
    let mut columns = RunLog::new(RunRecorder::new(&facts).unwrap(), &facts).unwrap();
    while !session.finished() {
        let instruments = session.step().expect("a step");
        let control_loop = session.control_loop();
        instruments.record(control_loop, &mut whole).unwrap();
        instruments.record(control_loop, &mut columns).unwrap();
    }
    let whole = whole.into_recorder().into_recording();
    let expected = RunData::new(&whole);
    let (recording, data) = columns.into_recorder().finish();
    assert_eq!(text(&data), text(&expected));
    let summaries = [(&recording, &data), (&whole, &expected)];
    let [summary, expected] =
        summaries.map(|(recording, data)| text(&Summary::new(recording, data)));
    assert_eq!(summary, expected);
    assert!(
        recording.task.len() < 10,
        "expected fewer task rows in memory"
    );
}
