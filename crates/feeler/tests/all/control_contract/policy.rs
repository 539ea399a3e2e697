//! A learned policy as a control law, compared with plain loops in double precision and with numpy.

use super::policy_file::PolicyFile;
use super::rig::{
    Analyzers, ELEMENTS, config, controller, geometries, hand_at_home, layout, pressed, state,
};
use assert_no_alloc::assert_no_alloc;
use feeler::control::law::policy::{Policy, PolicyConfig, PolicyModel};
use feeler::control::law::{Law, LawConfig, LawError};
use feeler::control::{
    Controller, FingerFlags, FingerReadings, FingertipPose, ObservationLayout, Plan, TactileReading,
};
use feeler::hand::{Hand, HandCommand, JointState, JointVector};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use glam::{DMat3, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Deserialize;
use std::sync::Arc;

/// `file` with a changed or additional metadata entry.
pub fn saying(mut file: PolicyFile, key: &str, value: &str) -> PolicyFile {
    file.metadata.insert(key.into(), value.into());
    file
}

fn model(file: &PolicyFile) -> Arc<PolicyModel> {
    Arc::new(PolicyModel::from_bytes(&file.bytes()).expect("a policy"))
}

fn policy_config(file: &PolicyFile) -> LawConfig {
    LawConfig::Policy(PolicyConfig {
        file: "a.safetensors".into(),
        model: Some(model(file)),
    })
}

/// A ring of `elements` elements.
fn ring(elements: usize) -> ElementLayout {
    ElementLayout::new(&LayoutConfig {
        dome_radius: 0.018,
        rings: vec![RingConfig {
            elements,
            polar_angle_deg: 45.0,
        }],
        grid: None,
    })
}

/// Output of the file's network in double precision, summed in the file's order.
fn evaluated(file: &PolicyFile, observation: &[f32]) -> [f64; 3] {
    let numbers = |name: &str| -> Option<Vec<f64>> {
        let (_, numbers) = file.tensors.get(name)?;
        Some(numbers.iter().map(|&n| f64::from(n)).collect())
    };
    let [mean, scale] =
        ["input.mean", "input.scale"].map(|name| numbers(name).expect("a normalisation"));
    let mut values: Vec<f64> = (0..mean.len())
        .map(|i| (f64::from(observation[i]) - mean[i]) / scale[i])
        .collect();
    for layer in 0.. {
        let Some(weights) = numbers(&format!("layer{layer}.weight")) else {
            break;
        };
        if layer > 0 {
            for value in &mut values {
                *value = match file.metadata["activation"].as_str() {
                    "relu" => value.max(0.0),
                    _ => value.tanh(),
                };
            }
        }
        let mut outputs = numbers(&format!("layer{layer}.bias")).expect("a bias");
        for (output, sum) in outputs.iter_mut().enumerate() {
            for (input, value) in values.iter().enumerate() {
                *sum += weights[output * values.len() + input] * value;
            }
        }
        values = outputs;
    }
    [values[0], values[1], values[2]]
}

/// Random reading, pose and joint state of a finger.
fn drawn_touch(random: &mut Pcg64, elements: usize) -> (TactileReading, FingertipPose, JointState) {
    let mut vector =
        |size: f64| DVec3::from_array([0; 3].map(|_| random.random_range(-size..size)));
    let mut touch = TactileReading::none(elements);
    touch.frame.forces.fill_with(|| vector(1.0));
    touch.flags.grasp_force = vector(2.0).x.abs();
    let pose = FingertipPose {
        position: vector(0.1),
        rotation: DMat3::from_axis_angle(vector(1.0).normalize(), 2.0),
    };
    let joints = JointState {
        position: vector(1.5).to_array().into(),
        velocity: vector(1.0).to_array().into(),
    };
    (touch, pose, joints)
}

#[test]
fn policy_velocity_agrees_with_plain_loops_in_double_precision() {
    let mut random = Pcg64::seed_from_u64(5);
    // Widths around the number of neurons that are computed together, and networks without hidden layers.
    let networks: [&[usize]; 6] = [&[], &[1], &[31, 33], &[64, 64], &[100, 7, 32], &[4; 7]];
    for (case, hidden) in networks.into_iter().enumerate() {
        for activation in ["tanh", "relu"] {
            let elements = 1 + 7 * case;
            let file = PolicyFile::drawn(elements, hidden, case as u64);
            let file = saying(file, "activation", activation);
            let mut policy = Policy::new(model(&file));
            let mut last_action = DVec3::ZERO;
            for step in 0..20 {
                let (touch, pose, joints) = drawn_touch(&mut random, elements);
                let sense = FingerReadings {
                    pose,
                    joints,
                    touch: &touch,
                    layout: &ring(elements),
                };
                let plan = Plan {
                    velocity: 0.01 * pose.rotation.x_axis,
                    towards_object: pose.rotation.y_axis,
                    reflex: step % 3 > 0,
                    keep_grasp: step % 2 > 0,
                };
                let observed = ObservationLayout {
                    elements,
                    joints: 3,
                };
                let mut numbers = vec![0.0; observed.len()];
                let written = observed.write(&plan, &sense, last_action, &mut numbers);
                written.expect("an observation");
                let outputs = DVec3::from_array(evaluated(&file, &numbers).map(f64::tanh));
                let residual = pose.rotation * (0.01 * outputs);
                let expected = plan.velocity + f64::from(u8::from(plan.reflex)) * residual;
                let found = policy.velocity(&plan, &sense);
                // Single precision over at most 150 terms per layer, of 0.01 m/s.
                let off = found.distance(expected);
                assert!(off < 1e-7, "{hidden:?} {activation} {step}: {off:e} m/s");
                last_action = found;
            }
        }
    }
}

/// Result of numpy for a policy written by Python.
#[derive(Deserialize)]
struct Reference {
    observation: Vec<f64>,
    velocity: [f64; 3],
}

#[test]
fn a_policy_written_by_python_agrees_with_numpy() {
    let reference: Reference =
        toml::from_str(include_str!("policy_reference.toml")).expect("a reference");
    let bytes = include_bytes!("policy_reference.safetensors");
    let model = PolicyModel::from_bytes(bytes).expect("a policy");
    assert_eq!(model.elements(), 2);
    let numbers = &reference.observation;
    let vector = |start: usize| DVec3::from_slice(&numbers[start..]);
    let mut touch = TactileReading::none(2);
    touch.frame.forces = vec![vector(0), vector(3)];
    touch.flags = FingerFlags {
        touch: true,
        over: true,
        grasp_force: numbers[9],
        ..FingerFlags::default()
    };
    // The fingertip's frame coincides with W.
    let sense = FingerReadings {
        pose: FingertipPose::default(),
        joints: JointState {
            position: vector(10).to_array().into(),
            velocity: vector(13).to_array().into(),
        },
        touch: &touch,
        layout: &ring(2),
    };
    let mut policy = Policy::new(Arc::new(model));
    let before = Plan {
        velocity: vector(16),
        ..Plan::default()
    };
    assert_eq!(policy.velocity(&before, &sense), before.velocity);
    let plan = Plan {
        velocity: vector(19),
        towards_object: vector(22),
        reflex: true,
        keep_grasp: false,
    };
    let off = policy
        .velocity(&plan, &sense)
        .distance(reference.velocity.into());
    assert!(off < 1e-7, "{off:e} m/s");
}

#[test]
fn a_policy_limits_its_residual_and_neither_allocates_nor_stops_the_hand() {
    let mut config = config();
    config.control.law = policy_config(&PolicyFile::drawn(ELEMENTS, &[64, 64], 1));
    let mut controller = controller(&config);
    let mut hand = hand_at_home(&config);
    let mut analyzers = Analyzers::new(&config);
    let mut command = HandCommand::stop(2);
    let mut added = 0.0_f64;
    for n in 0..2000 {
        let force = 2.5 * (0.05 * n as f64).sin().max(0.0);
        let frames = vec![pressed(n, hand.stamp, force); 2];
        let (touches, state) = (analyzers.touches(&frames), state(&hand));
        assert_no_alloc(|| controller.decide(&touches, &state, &mut command));
        hand.command(&command).expect("an ideal hand");
        for (finger, plan) in controller.fingers().iter().zip(controller.plans()) {
            let residual = finger.velocity - plan.velocity;
            added = added.max(residual.abs().max_element());
            assert!(plan.reflex || residual == DVec3::ZERO, "step {n}");
        }
    }
    assert_eq!(controller.stop_reason(), None);
    // Rotated from T to W, at most the diagonal.
    assert!(added > 1e-3 && added < 0.01 * 3_f64.sqrt(), "{added}");
}

/// Extreme weights and inputs of either sign, with the maximum number of layers.
#[test]
fn finite_inputs_give_finite_velocities() {
    let mut random = Pcg64::seed_from_u64(2);
    for activation in ["tanh", "relu"] {
        let mut file = saying(PolicyFile::zero(1, &[40; 7]), "activation", activation);
        for (name, (_, numbers)) in &mut file.tensors {
            numbers.fill_with(|| match name.as_str() {
                "input.scale" => 1e-6,
                _ => [-1e6, 1e6][random.random_range(0..2_usize)],
            });
        }
        let mut policy = Policy::new(model(&file));
        let mut touch = TactileReading::none(1);
        for force in [0.0, 1e-300, 1.0, -1e30, 1e300, f64::MAX, f64::MIN] {
            touch.frame.forces[0] = DVec3::new(force, -force, force);
            let sense = FingerReadings {
                pose: FingertipPose::default(),
                joints: JointState {
                    position: JointVector::splat(3, force),
                    velocity: JointVector::splat(3, -force),
                },
                touch: &touch,
                layout: &ring(1),
            };
            let plan = Plan {
                reflex: true,
                ..Plan::default()
            };
            let velocity = policy.velocity(&plan, &sense);
            assert!(
                velocity.abs().max_element() <= 0.01,
                "{activation} {force}: {velocity}"
            );
        }
    }
}

#[test]
fn a_policy_requires_its_number_of_elements() {
    let control = config().control;
    let law = |law: LawConfig| law.finger_law(control.reflex(), control.touch_force, ELEMENTS);
    let file = "a.safetensors".to_string();
    let error = law(policy_config(&PolicyFile::zero(40, &[]))).map(|_| ());
    let (expected, actual) = (ELEMENTS, 40);
    let wrong = LawError::Elements {
        file: file.clone(),
        expected,
        actual,
    };
    assert_eq!(error, Err(wrong));
    let config = PolicyConfig {
        file: file.clone(),
        model: None,
    };
    let unread = law(LawConfig::Policy(config)).map(|_| ());
    assert_eq!(unread, Err(LawError::NotRead { file }));
    // A law that receives another fingertip's reading makes the controller stop the hand.
    let mut policy = Policy::new(model(&PolicyFile::zero(40, &[])));
    let touch = TactileReading::none(ELEMENTS);
    let sense = FingerReadings {
        pose: FingertipPose::default(),
        joints: JointState::default(),
        touch: &touch,
        layout: &layout(),
    };
    let plan = Plan {
        reflex: true,
        ..Plan::default()
    };
    assert!(policy.velocity(&plan, &sense).is_nan());
}

#[test]
fn a_policy_requires_its_number_of_joints() {
    // As many inputs as for 43 elements and three joints.
    let file = PolicyFile::zero(43, &[]);
    let file = saying(saying(file, "elements", "41"), "joints", "6");
    assert_eq!((model(&file).elements(), model(&file).joints()), (41, 6));
    let mut config = config();
    config.control.law = policy_config(&file);
    let layouts = vec![layout(); config.finger.len()];
    let made = Controller::new(
        config.control.clone(),
        &config.task,
        &geometries(&config),
        &layouts,
    );
    let (expected, actual) = (3, 6);
    let wrong = LawError::Joints {
        file: "a.safetensors".into(),
        expected,
        actual,
    };
    assert_eq!(made.err(), Some(wrong));
    let touch = TactileReading::none(ELEMENTS);
    let plan = Plan {
        reflex: true,
        ..Plan::default()
    };
    let mut policy = Policy::new(model(&file));
    for joints in 0..=7 {
        let sense = FingerReadings {
            pose: FingertipPose::default(),
            joints: JointState::zero(joints),
            touch: &touch,
            layout: &layout(),
        };
        // More joints than the policy's make the controller stop the hand.
        let velocity = policy.velocity(&plan, &sense);
        assert_eq!(velocity.is_nan(), joints > 6, "{joints}");
    }
}
