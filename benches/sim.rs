//! Time of the physics, and of whole control periods of a simulated run.

use divan::Bencher;
use feeler::config::Experiment;
use feeler::control::phase::Phase;
use feeler::experiment::Session;
use feeler::experiment::log::{RunLog, run_facts};
use feeler::record::Recorder;
use glam::DVec3;

fn main() {
    divan::main();
}

fn experiment(sensing: &str) -> Experiment {
    let settings = [format!("sensing={sensing}")];
    Experiment::load("cap-closing", &settings).expect("the built-in experiment")
}

/// A session in the middle of its first stroke, every fingertip touching.
fn in_contact() -> Session {
    let mut session = Session::new(&experiment("direct")).expect("a session");
    let mut moving = 0;
    while moving < 20 {
        session.step().expect("a step");
        let task = session.control_loop().controller().task();
        moving += usize::from(task.phase() == Phase::Move);
    }
    session
}

/// One physics step, 1 ms, while the fingers turn the cap to and fro.
#[divan::bench]
fn physics_step_in_contact(bencher: Bencher) {
    let session = in_contact();
    let mut world = session.rig().world();
    let commands = session.control_loop().command().joint_velocity.clone();
    let mut steps = 0_u32;
    bencher.bench_local(|| {
        let sign = if (steps / 100).is_multiple_of(2) {
            -1.0
        } else {
            1.0
        };
        for (finger, &velocity) in commands.iter().enumerate() {
            world.command(finger, sign * velocity);
        }
        steps += 1;
        world.step().expect("a step");
    });
}

/// One physics step with the fingers at home.
#[divan::bench]
fn physics_step_out_of_contact(bencher: Bencher) {
    let session = Session::new(&experiment("direct")).expect("a session");
    let mut world = session.rig().world();
    world.command(0, DVec3::ZERO);
    bencher.bench_local(|| world.step().expect("a step"));
}

/// One control period, 10 ms, with everything that `feeler run` does in it: sensors, control,
/// physics, recording. Runs follow each other, so this is the mean over whole runs.
fn control_period(bencher: Bencher, sensing: &str) {
    let experiment = experiment(sensing);
    let path = std::env::temp_dir().join(format!("feeler-bench-{sensing}-{}", std::process::id()));
    let facts = run_facts(&experiment.config);
    let start = || {
        let session = Session::new(&experiment).expect("a session");
        let recorder = Recorder::create(&path, &facts, &experiment.toml).expect("a recorder");
        let log = RunLog::new(recorder, session.layouts());
        (session, log)
    };
    let (mut session, mut log) = start();
    bencher.bench_local(|| {
        if session.finished() {
            (session, log) = start();
        }
        let instruments = session.step().expect("a step");
        log.write(&session, &instruments).expect("a recorded step");
    });
    drop(log);
    // That the file is left over is no reason to fail.
    let _ = std::fs::remove_file(&path);
}

#[divan::bench(sample_count = 20, sample_size = 1300)]
fn control_period_sensed_directly(bencher: Bencher) {
    control_period(bencher, "direct");
}

#[divan::bench(sample_count = 20, sample_size = 130)]
fn control_period_through_pictures(bencher: Bencher) {
    control_period(bencher, "image");
}
