//! Time of the physics, and of complete control periods of a simulated run.

use divan::Bencher;
use divan::counter::ItemsCount;
use feeler::control::Phase;
use feeler::hand::JointVector;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session, run_facts};
use feeler_record::{Recorder, RunLog};
use feeler_sim::world::World;
use glam::{DMat3, DVec3};

#[path = "../../feeler-sim/tests/support/experiment_file.rs"]
mod experiment_file;
#[path = "../../feeler-sim/tests/support/mujoco_scene.rs"]
#[allow(dead_code)]
mod mujoco_scene;

fn main() {
    divan::main();
}

fn experiment(sensing: &str) -> Experiment {
    let settings = [format!("sensing={sensing}")];
    Experiment::load("cap-closing", &settings).expect("the built-in experiment")
}

/// Physics of the reference run (82 elements, forces only) with steps of 1 ms.
#[divan::bench(sample_count = 20)]
fn physics_of_the_reference_run(bencher: Bencher) {
    physics(bencher, |_| true);
}

/// Physics of the first stroke, while the fingers turn the cap.
#[divan::bench(sample_count = 50)]
fn physics_of_the_first_stroke(bencher: Bencher) {
    physics(bencher, |phase| phase == Phase::Move);
}

/// Repeats the commands of a run and measures the steps of the first consecutive control periods
/// whose phase satisfies `timed`.
fn physics(bencher: Bencher, timed: fn(Phase) -> bool) {
    let experiment = experiment("direct");
    let mut session = Session::new(&experiment).expect("a session");
    let (mut phases, mut commands) = (Vec::new(), Vec::new());
    while !session.finished() {
        session.step().expect("a step");
        let control_loop = session.control_loop();
        phases.push(control_loop.controller().phase());
        commands.push(control_loop.command().joint_velocity().to_vec());
    }
    let start = phases.iter().position(|&p| timed(p)).expect("the phase");
    let length = phases[start..].iter().take_while(|&&p| timed(p)).count();
    let (before, own) = commands[..start + length].split_at(start);
    let steps = (experiment.config.control.period
        / experiment
            .config
            .simulation()
            .expect("a simulated world")
            .step)
        .round() as usize;
    bencher
        .counter(ItemsCount::new(steps * length))
        .with_inputs(|| {
            let session = Session::new(&experiment).expect("a session");
            give(&session, before, steps);
            session
        })
        .bench_local_refs(|session| give(session, own, steps));
}

fn give(session: &Session, commands: &[Vec<JointVector>], steps: usize) {
    let mut world = session.rig().world();
    for command in commands {
        for (finger, &velocity) in command.iter().enumerate() {
            world.command(finger, velocity);
        }
        for _ in 0..steps {
            world.step().expect("a step");
        }
    }
}

/// The scene and motion of 5 s used for the comparison with MuJoCo (`benches/peers/mujoco.py`). The poses of the
/// fingertips are computed in advance for both.
#[divan::bench(sample_count = 50)]
fn physics_of_mujocos_scene(bencher: Bencher) {
    let reference = mujoco_scene::reference("round_tips");
    let header = &reference.header;
    let steps = (header.knot_times[header.knot_times.len() - 1] / STEP).round() as u32;
    let scene = || mujoco_scene::Scene::new(header, STEP);
    let at = scene();
    let poses = (1..=steps)
        .map(|step| at.poses(|finger| header.joints(finger, STEP * f64::from(step))))
        .collect::<Vec<_>>();
    bencher
        .counter(ItemsCount::new(steps))
        .with_inputs(scene)
        .bench_local_refs(|scene| poses.iter().for_each(|poses| scene.advance(poses)));
}

/// Time step (s).
const STEP: f64 = 0.001;

/// One step of 1 ms with a free box on a table, touched by two fingers.
#[divan::bench(sample_count = 50, sample_size = 1000)]
fn physics_step_of_a_free_box(bencher: Bencher) {
    let mut world = squeezed_box();
    let touching = |world: &World| world.state().fingers.iter().all(|f| !f.contacts.is_empty());
    assert!(touching(&world));
    bencher.bench_local(|| world.step().expect("a step"));
}

/// A box of 30 x 30 x 60 mm and 50 g on a table between two fingertips that indent by 1.5 mm.
fn squeezed_box() -> World {
    let mut experiment = experiment("direct");
    let sim = experiment.config.sim.as_mut().expect("a simulated world");
    let object = |text: &str| toml::from_str(text).expect("an object");
    let text =
        "position = [0.0, 0.0, 0.1]\nshape.box.size = [0.03, 0.03, 0.06]\nmotion.free.mass = 0.05";
    let table = "position = [0.0, 0.0, 0.07]\nshape = \"half_space\"\nmotion = \"fixed\"";
    sim.object = [
        ("box".into(), object(text)),
        ("table".into(), object(table)),
    ]
    .into();
    let mut world = feeler_lab::experiment::world(&experiment).expect("a world");
    for step in 1..=500 {
        let depth = -0.0005 + 4e-6 * f64::from(step);
        for (finger, toward) in [1.0, -1.0].into_iter().enumerate() {
            let mut tip = world.state().fingers[finger].tip;
            tip.position = DVec3::new(-toward * (0.0345 - depth), 0.0, 0.1);
            let side = DVec3::new(0.0, toward, 0.0);
            tip.rotation = DMat3::from_cols(toward * DVec3::X, side, DVec3::Z);
            world.hold_fingertip(finger, Some(tip));
        }
        world.step().expect("a step");
    }
    world
}

/// One physics step with the fingers at their home positions.
#[divan::bench(sample_count = 50, sample_size = 2000)]
fn physics_step_out_of_contact(bencher: Bencher) {
    let session = Session::new(&experiment("direct")).expect("a session");
    let mut world = session.rig().world();
    world.command(0, JointVector::default());
    bencher.bench_local(|| world.step().expect("a step"));
}

/// One control period of 10 ms with all operations of `feeler run`: sensors, control, physics, recording. Runs
/// are repeated, so the result is the mean over complete runs.
fn control_period(bencher: Bencher, sensing: &str) {
    let experiment = experiment(sensing);
    let path = std::env::temp_dir().join(format!("feeler-bench-{sensing}-{}", std::process::id()));
    let facts = run_facts(&experiment.config).expect("facts");
    let start = || {
        let session = Session::rendering(&experiment, Pictures::Sensed).expect("a session");
        let recorder = Recorder::create(&path, &facts, &experiment.toml).expect("a recorder");
        let log = RunLog::new(recorder, &facts).expect("a log");
        (session, log)
    };
    let (mut session, mut log) = start();
    bencher.bench_local(|| {
        if session.finished() {
            (session, log) = start();
        }
        let instruments = session.step().expect("a step");
        instruments
            .record(session.control_loop(), &mut log)
            .expect("a recorded step");
    });
    drop(log);
    // A file that cannot be removed is not an error.
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
