//! Time of recording all messages of a control step with two fingers of 41 elements.

#[path = "../../feeler-record/tests/support/mod.rs"]
mod support;

use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_record::{Recorder, RunLog};
use std::cell::RefCell;

fn main() {
    divan::main();
}

/// 300 control steps, from opening the file to closing it.
#[divan::bench(sample_count = 20)]
fn record_300_control_steps(bencher: divan::Bencher) {
    let path = std::env::temp_dir().join(format!("feeler-bench-{}.mcap", std::process::id()));
    bencher.bench_local(|| {
        let mut recorder = Recorder::create(&path, &support::facts(), "").expect("a file");
        support::write_strokes(&mut recorder, 1).expect("messages");
        recorder.finish(None).expect("an end")
    });
    let _ = std::fs::remove_file(path);
}

/// Recording of one control step of a run in which two fingers touch: all messages, including those for viewers.
#[divan::bench(sample_count = 1000, sample_size = 1)]
fn record_a_control_step(bencher: divan::Bencher) {
    let path = std::env::temp_dir().join(format!("feeler-bench-step-{}", std::process::id()));
    let settings = ["sensing=\"direct\"".to_string()];
    let experiment = Experiment::load("cap-closing", &settings).expect("an experiment");
    let mut session = Session::new(&experiment).expect("a session");
    let facts = session.facts(&experiment.config);
    let recorder = Recorder::create(&path, &facts, &experiment.toml).expect("a file");
    let mut log = RunLog::new(recorder, &facts).expect("a log");
    // Advance to the first stroke.
    while session.control_loop().state().stamp < 2.0 {
        session.step().expect("a step");
    }
    let session = RefCell::new(session);
    bencher
        .with_inputs(|| session.borrow_mut().step().expect("a step"))
        .bench_local_values(|at| {
            let session = session.borrow();
            at.record(session.control_loop(), &mut log)
                .expect("a message");
        });
    drop(log);
    let _ = std::fs::remove_file(path);
}
