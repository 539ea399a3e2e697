//! A recording put through the same control loop gives the same commands, bit for bit.

use feeler::config::Experiment;
use feeler::control::control_loop::{ControlError, ControlLoop};
use feeler::control::touch::AnalyzedSensor;
use feeler::experiment::log::{RunLog, run_facts};
use feeler::experiment::{Session, controller, fingers_at_home, layouts};
use feeler::hand::hand::HandError;
use feeler::record::{RecordedHand, RecordedSensor, Recorder, Recording};

fn recorded_run(seconds: f64) -> Recording {
    let settings = ["sensing=direct".into(), format!("time_limit={seconds:?}")];
    let experiment = Experiment::load("cap-closing", &settings).unwrap();
    let path = std::env::temp_dir().join(format!("feeler-replay-{}.mcap", std::process::id()));
    let facts = run_facts(&experiment.config);
    let recorder = Recorder::create(&path, &facts, &experiment.toml).unwrap();
    let mut session = Session::new(&experiment).unwrap();
    let mut log = RunLog::new(recorder, session.layouts());
    while !session.finished() {
        let instruments = session.step().unwrap();
        log.write(&session, &instruments).unwrap();
    }
    log.into_recorder().finish(None).unwrap();
    let recording = Recording::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    recording
}

#[test]
fn a_replayed_recording_gives_the_same_commands() {
    let recording = recorded_run(4.0);
    let experiment = Experiment::parse(&recording.experiment, "recording", &[], None).unwrap();
    let layouts = layouts(&experiment.config).unwrap();
    let (fingers, _) = fingers_at_home(&experiment.config).unwrap();
    let thresholds = experiment.config.control.thresholds();
    let sensors = (0..fingers.len()).map(|f| RecordedSensor::new(&recording, f));
    let sensors = sensors.map(|sensor| AnalyzedSensor::new(sensor, thresholds));
    let mut control_loop = ControlLoop::new(
        sensors.collect(),
        RecordedHand::new(&recording),
        controller(&experiment.config, &fingers, &layouts),
    );
    let steps = recording.task.len();
    assert!(steps >= 400, "{steps} steps on record");
    for step in 0..steps {
        control_loop.step().unwrap();
        for (finger, record) in recording.fingers.iter().enumerate() {
            let replayed = control_loop.command().joint_velocity[finger].to_array();
            let recorded = record.command[step].joint_velocity;
            assert_eq!(
                replayed.map(f64::to_bits),
                recorded.map(f64::to_bits),
                "finger {finger}, step {step}"
            );
        }
    }
    let end = control_loop.step();
    assert!(
        matches!(end, Err(ControlError::Hand(HandError::Ended { count })) if count == steps as u64)
    );
}
