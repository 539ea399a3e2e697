//! Time of control: from the latest forces to joint velocities.

use divan::{Bencher, black_box};
use feeler::control::grasp_slip::{ContactLoss, ContactLossConfig, GraspDrag, GraspDragConfig};
use feeler::control::law::LawConfig;
use feeler::control::law::policy::{PolicyConfig, PolicyModel};
use feeler::control::{
    Controller, FingertipPose, FlagAnalyzer, HandReadings, Plan, TactileReading,
};
use feeler::hand::{FingerGeometry, HandCommand, HandState, JointState, inverse_kinematics};
use feeler::sensor::fingertip::ElementLayout;
use feeler::sensor::forces::TactileFrame;
use feeler_lab::config::{Experiment, ExperimentConfig};
use glam::{DMat3, DVec2, DVec3};

#[path = "../../feeler/tests/support/policy_file.rs"]
mod policy_file;
use policy_file::PolicyFile;

#[path = "../tests/support/urdf_hands.rs"]
mod urdf_hands;

const ELEMENTS: usize = 41;

fn main() {
    divan::main();
}

/// Names of the laws that need no file, and of a policy with two hidden layers of 64 units.
fn laws() -> impl Iterator<Item = &'static str> {
    LawConfig::NAMES.into_iter().chain(["policy"])
}

fn law(name: &str) -> LawConfig {
    LawConfig::named(name).unwrap_or_else(|| {
        let bytes = PolicyFile::drawn(ELEMENTS, &[64, 64], 1).bytes();
        LawConfig::Policy(PolicyConfig {
            file: "drawn.safetensors".into(),
            model: Some(PolicyModel::from_bytes(&bytes).expect("a policy").into()),
        })
    })
}

fn config(name: &str) -> ExperimentConfig {
    let experiment = Experiment::load(name, &[]);
    experiment.expect("the built-in experiment").config
}

/// Forces of a fingertip in contact: three elements pressed, all with some shear.
fn in_contact() -> TactileFrame {
    let mut frame = TactileFrame::unloaded(ELEMENTS);
    for (element, force) in frame.forces.iter_mut().enumerate() {
        *force = DVec3::new(0.001 * element as f64, -0.02, 0.0);
    }
    for force in &mut frame.forces[..3] {
        force.z = 0.4;
    }
    frame
}

/// One decision for two fingers of 41 elements in contact, under each control law.
#[divan::bench(args = laws())]
fn decide_by_law(bencher: Bencher, name: &str) {
    let mut config = config("cap-closing");
    config.control.law = law(name);
    decide_in_contact(bencher, &config);
}

/// One decision for the fingers of each task, in contact.
#[divan::bench(args = ["cap-closing", "cap-until-closed", "friction-scan", "contour", "slide-box-two", "lift"])]
fn decide_by_task(bencher: Bencher, experiment: &str) {
    decide_in_contact(bencher, &config(experiment));
}

fn decide_in_contact(bencher: Bencher, config: &ExperimentConfig) {
    let mut config = config.clone();
    // The fingers ignore the commands and stand still.
    config.control.monitor.joint_deviation = 0.0;
    let layout = ElementLayout::new(&config.sensor.fingertip.layout);
    let fingers: Vec<_> = (config.hand.finger.iter())
        .map(|finger| FingerGeometry::of(finger).expect("a finger"))
        .collect();
    let layouts = vec![layout; fingers.len()];
    let controller = Controller::new(config.control.clone(), &config.task, &fingers, &layouts);
    let mut controller = controller.expect("a controller");
    let mut state = HandState::zero(fingers.len());
    let homes = config.task.homes();
    for ((joints, geometry), home) in state.joints.iter_mut().zip(&fingers).zip(homes) {
        let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
        joints.position = inverse_kinematics(geometry, home.into(), middle).expect("home");
    }
    let mut touches = vec![TactileReading::none(ELEMENTS); fingers.len()];
    let analyzer = FlagAnalyzer::new(config.control.thresholds(), ELEMENTS);
    let mut analyzers = vec![analyzer; fingers.len()];
    for touch in &mut touches {
        touch.frame = in_contact();
    }
    let mut command = HandCommand::stop(fingers.len());
    bencher.bench_local(|| {
        state.stamp += config.control.period;
        for (touch, analyzer) in touches.iter_mut().zip(&mut analyzers) {
            touch.frame.sequence += 1;
            touch.frame.stamp = state.stamp;
            // Constant forces would be detected as a frozen sensor.
            touch.frame.forces[0].z = 0.4 + 1e-3 * (touch.frame.sequence % 2) as f64;
            touch.analyze(analyzer);
        }
        controller.decide(black_box(&touches), black_box(&state), &mut command);
    });
    assert_eq!(controller.stop_reason(), None);
}

/// One decision for two fingers with four joints each, in contact, with flags.
#[divan::bench(args = ["allegro", "leap"])]
fn decide_with_four_joints(bencher: Bencher, hand: &str) {
    let setting = match hand {
        "allegro" => urdf_hands::allegro(),
        _ => urdf_hands::leap(),
    };
    let experiment = Experiment::load("cap-until-closed", &[setting]);
    decide_in_contact(bencher, &experiment.expect("the hand").config);
}

/// Velocities of two fingers under each control law, while they keep their grasp.
#[divan::bench(args = laws())]
fn law_in_contact(bencher: Bencher, name: &str) {
    let control = config("cap-closing").control;
    let layout = ElementLayout::new(&config("cap-closing").sensor.fingertip.layout);
    let layouts = [layout.clone(), layout];
    let mut law =
        (law(name).hand_law(control.reflex(), &control.thresholds(), &layouts)).expect("a law");
    let mut touches = [
        TactileReading::none(ELEMENTS),
        TactileReading::none(ELEMENTS),
    ];
    let mut analyzer = FlagAnalyzer::new(control.thresholds(), ELEMENTS);
    for touch in &mut touches {
        touch.frame = in_contact();
        touch.analyze(&mut analyzer);
    }
    // The fingertips face each other across the cap.
    let mut poses = [FingertipPose::default(); 2];
    poses[0].position.x = -0.032;
    poses[1].position.x = 0.032;
    poses[1].rotation = DMat3::from_rotation_z(std::f64::consts::PI);
    let plan = |sign: f64, keep_grasp| Plan {
        velocity: sign * DVec3::new(0.0, -0.01, 0.0),
        towards_object: sign * DVec3::X,
        reflex: true,
        keep_grasp,
    };
    let joints = [JointState::default(); 2];
    let (mut closed, mut velocities) = ([None; 2], [DVec3::ZERO; 2]);
    let mut step = |keep_grasp: bool, way: f64| {
        for (touch, pose) in touches.iter_mut().zip(&mut poses) {
            touch.frame.sequence += 1;
            touch.frame.stamp += control.period;
            pose.position.x -= way * pose.position.x.signum();
        }
        let hand = HandReadings {
            stamp: 0.0,
            poses: &poses,
            joints: &joints,
            touches: &touches,
            layouts: &layouts,
            closed: &[],
        };
        law.observe(black_box(&hand), &mut closed);
        let plans = [plan(1.0, keep_grasp), plan(-1.0, keep_grasp)];
        law.velocities(black_box(&plans), black_box(&hand), &mut velocities);
        velocities
    };
    // The fingers close before they move.
    for _ in 0..100 {
        step(false, 1e-5);
    }
    bencher.bench_local(|| step(true, 0.0));
}

/// Flags of one finger.
#[divan::bench]
fn analyze_flags(bencher: Bencher) {
    let control = config("cap-closing").control;
    let mut analyzer = FlagAnalyzer::new(control.thresholds(), ELEMENTS);
    let mut frame = in_contact();
    bencher.bench_local(|| {
        frame.sequence += 1;
        frame.stamp += control.period;
        analyzer.analyze(black_box(&frame))
    });
}

/// Both detectors of slip in grasps on the markers of one finger: contact loss on a regular pattern, and drag.
#[divan::bench]
fn detect_grasp_slip(bencher: Bencher) {
    let at = |i: usize| 36.0 * DVec2::new((i % 7) as f64, (i / 7) as f64);
    let mut places: Vec<_> = (0..ELEMENTS).map(at).collect();
    let config = ContactLossConfig::default();
    let mut loss = ContactLoss::on_pattern(&places, None, config).expect("a grid");
    let mut drag = GraspDrag::new(ELEMENTS, 36.0, GraspDragConfig::default()).expect("a scale");
    let mut by = 1.0;
    bencher.bench_local(|| {
        by = -by;
        places[20].x += by;
        let places = black_box(&places);
        let contact = loss.update(0.01, places.iter().copied());
        (
            contact,
            drag.update(0.01, places.iter().map(|place| place.extend(0.0))),
        )
    });
}
