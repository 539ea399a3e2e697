//! Runs of the reference experiment with faults.

use feeler::sensor::forces::TactileFrame;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_sim::world::State;

pub const PERIOD: f64 = 0.01;

/// The reference experiment with `settings` and `faults`, inline tables of `sim.fault`.
pub fn load(settings: &[&str], faults: &str) -> Experiment {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../feeler-lab/tests/stiff-feelers.toml"
    );
    let mut settings: Vec<_> = settings.iter().map(ToString::to_string).collect();
    settings.push(format!("sim.fault=[{faults}]"));
    Experiment::load(file, &settings).expect("an experiment")
}

pub fn session(settings: &[&str], faults: &str) -> Session {
    Session::new(&load(settings, faults)).expect("a session")
}

/// Index of the control step that starts at `time` (s).
pub fn step_at(time: f64) -> usize {
    (time / PERIOD).round() as usize
}

/// Runs `steps` control steps. Returns the fingers' tactile frames of each, and the true state at the start of each.
pub fn watch(session: &mut Session, steps: usize) -> (Vec<Vec<TactileFrame>>, Vec<State>) {
    let mut felt = Vec::new();
    let mut states = Vec::new();
    for _ in 0..steps {
        states.push(session.rig().world().state().clone());
        session.step().expect("a step");
        let touches = session.control_loop().touches();
        felt.push(touches.iter().map(|touch| touch.frame.clone()).collect());
    }
    (felt, states)
}
