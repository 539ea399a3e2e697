//! Faults of drives, joints and surfaces.

use super::bench::{session, step_at, watch};
use feeler::hand::JointVector;
use feeler_sim::rig::{Joints, ServoConfig};
use glam::DVec3;

#[test]
fn stalled_joint_stops_while_the_others_move() {
    let fault = "{from=0.3, until=0.5, kind.servo_stall={finger=1, joint=2}}";
    let mut session = session(&["sensing=direct"], fault);
    let (_, states) = watch(&mut session, step_at(0.6));
    let position = |time: f64| states[step_at(time)].fingers[1].joints.position;
    let (from, during, until) = (position(0.3), position(0.4), position(0.5));
    assert_eq!((from[2], from[2]), (during[2], until[2]));
    assert!(from[0] != during[0] || from[1] != during[1]);
    assert_ne!(position(0.29)[2], from[2]);
    assert_ne!(position(0.55)[2], until[2]);
    // The encoders measure the true angle.
    let encoded = session.control_loop().state().joints[1].position[2];
    assert!((encoded - states[step_at(0.59)].fingers[1].joints.position[2]).abs() < 1e-4);
}

/// For each step, the encoder reading of joint 2 of finger 1 and its true angle (rad). The monitor's checks are
/// disabled.
fn shown(fault: &str) -> Vec<(f64, f64)> {
    let settings = [
        "sensing=direct",
        "control.monitor.joint_deviation=0.0",
        "control.monitor.joint_jump=0.0",
    ];
    let mut session = session(&settings, fault);
    let step = |_| {
        let truth = session.rig().world().state().fingers[1].joints.position[2];
        session.step().expect("a step");
        (session.control_loop().state().joints[1].position[2], truth)
    };
    (0..step_at(0.6)).map(step).collect()
}

#[test]
fn faulty_encoder_deviates_only_during_the_fault() {
    // Gain of the rotation since 0.3 s, and offset.
    for (kind, gain, offset) in [
        ("joint_freeze={finger=1, joint=2}", 0.0, 0.0),
        ("joint_gain={finger=1, joint=2, gain=0.5}", 0.5, 0.0),
        ("joint_gain={finger=1, joint=2, gain=-1.0}", -1.0, 0.0),
        ("joint_jump={finger=1, joint=2, angle=0.1}", 1.0, 0.1),
    ] {
        let shown = shown(&format!("{{from=0.3, until=0.5, kind.{kind}}}"));
        let broke_at = shown[step_at(0.3)].1;
        for (step, (shown, truth)) in shown.into_iter().enumerate() {
            // The state at a given time is the one after the step that ends then.
            let broken = (step_at(0.3) + 1..=step_at(0.5)).contains(&step);
            let expected = match broken {
                true => broke_at + gain * (truth - broke_at) + offset,
                false => truth,
            };
            // Half an encoder count.
            let off = (shown - expected).abs();
            assert!(off < 0.5e-5 + 1e-12, "{kind}, {step}: {shown}, {expected}");
        }
    }
}

/// Each finger's sensor delivers the forces on the other finger.
#[test]
fn swapped_sensors_measure_the_other_finger() {
    let settings = [
        "sensing=direct",
        "sim.direct_sensing.normal_noise=0.0",
        "sim.direct_sensing.shear_noise=0.0",
    ];
    let mut session = session(&settings, "{kind.swapped_sensors={finger=0, other=1}}");
    let mut felt = false;
    for _ in 0..step_at(1.5) {
        let mut truth = [(); 2].map(|()| vec![DVec3::ZERO; session.layouts()[0].elements.len()]);
        for (finger, truth) in truth.iter_mut().enumerate() {
            session.rig().world().element_forces(finger, truth);
        }
        session.step().expect("a step");
        let touches = session.control_loop().touches();
        assert_eq!(touches[0].frame.forces, truth[1]);
        assert_eq!(touches[1].frame.forces, truth[0]);
        felt |= truth[0] != truth[1];
    }
    assert!(felt);
}

#[test]
fn backlash_follows_its_hysteresis_loop() {
    let servo = ServoConfig {
        lag: 0.0,
        encoder_resolution: 1e-5,
        backlash: 0.0,
    };
    let limits = (JointVector::splat(3, -10.0), JointVector::splat(3, 10.0));
    let (band, swing, step) = (0.02, 0.05, 0.001);
    let mut joints = Joints::at_rest(JointVector::zeros(3));
    joints.backlash[1] = band;
    let mut drive = |speed: f64, steps: usize, expected: &dyn Fn(f64) -> f64| {
        joints.command = JointVector::splat(3, speed);
        for _ in 0..steps {
            servo.advance(&mut joints, step, 0.0, limits);
            let motor = joints.position[1];
            // Rounding of numbers of about 0.1.
            assert!((joints.link[1] - expected(motor)).abs() < 1e-15, "{motor}");
            // The other joints have no backlash.
            assert_eq!((joints.link[0], joints.link[2]), (motor, motor));
        }
    };
    let half = band / 2.0;
    // From the middle of the band, the motor moves by half the band alone, and then moves the link.
    drive(1.0, 50, &|motor| (motor - half).max(0.0));
    // After a reversal, it moves by the whole band alone.
    let high = swing - half;
    drive(-1.0, 100, &|motor| (motor + half).min(high));
    let low = -swing + half;
    drive(1.0, 100, &|motor| (motor - half).max(low));
}

#[test]
fn fingertip_follows_the_link_and_encoder_follows_the_motor() {
    let fault = "{from=0.3, kind.backlash={finger=0, joint=1, angle=0.004}}";
    let mut session = session(&["sensing=direct"], fault);
    let (_, states) = watch(&mut session, step_at(0.7));
    for state in &states[..=step_at(0.3)] {
        let joints = &state.fingers[0].joints;
        assert_eq!(joints.link, joints.position);
    }
    let end = &states[step_at(0.69)].fingers[0];
    let lag = end.joints.position[1] - end.joints.link[1];
    // The approach turns the joint in one direction, so that the link lags by half the band.
    assert!((lag.abs() - 0.002).abs() < 1e-12, "{lag}");
    let geometry = &session.rig().world().model().fingers[0].geometry.clone();
    let by = |theta| feeler::hand::fingertip_pose(geometry, theta).0;
    assert_eq!(end.tip.position, by(end.joints.link));
    assert!(end.tip.position.distance(by(end.joints.position)) > 1e-4);
    let read = session.control_loop().state().joints[0].position[1];
    assert!((read - end.joints.position[1]).abs() <= 0.5e-5 + 1e-12);
}

#[test]
fn configured_backlash_equals_a_permanent_backlash_fault() {
    let faults = [0, 1].map(|finger| {
        let joint =
            |joint| format!("{{kind.backlash={{finger={finger}, joint={joint}, angle=0.004}}}}");
        [0, 1, 2].map(joint).join(", ")
    });
    let run = |settings: &[&str], faults: &str| {
        let (felt, states) = watch(&mut session(settings, faults), step_at(1.5));
        // Skip the first state, which is before any fault.
        (felt, states[1..].to_vec())
    };
    let broken = run(&["sensing=direct"], &faults.join(", "));
    let loose = ["sensing=direct", "sim.servo.backlash=0.004"];
    assert_eq!(run(&loose, ""), broken);
    // The fault of a joint adds to the configured backlash, while it lasts.
    let fault = "{from=0.3, until=0.5, kind.backlash={finger=0, joint=1, angle=0.01}}";
    let (_, states) = watch(&mut session(&loose, fault), step_at(0.7));
    let bands = [0.2, 0.4, 0.6].map(|time| states[step_at(time)].fingers[0].joints.backlash[1]);
    assert_eq!(bands, [0.004, 0.014, 0.004]);
}

#[test]
fn backlash_spreads_the_home_positions() {
    let home = |settings: &[&str]| {
        let mut session = session(settings, "");
        let mut homes = Vec::new();
        while !session.finished() {
            session.step().expect("a step");
            let stroke = session.control_loop().controller().task().stroke() as usize;
            let tip = session.rig().world().state().fingers[0].tip.position;
            // Keep the last position of each stroke.
            homes.truncate(stroke.saturating_sub(1));
            homes.push(tip);
        }
        homes
    };
    let spread = |homes: &[DVec3]| {
        let from_first = homes.iter().map(|home| home.distance(homes[0]));
        from_first.fold(0.0, f64::max)
    };
    let settings = ["sensing=direct", "sim.servo.backlash=0.004"];
    let (tight, loose) = (home(&settings[..1]), home(&settings));
    // Joints without backlash return to within `home_tolerance`. With backlash, only the motors do.
    assert!(spread(&tight) < 4e-4, "{tight:?}");
    assert!(spread(&loose) > spread(&tight), "{loose:?}");
    let apart = loose[0].distance(tight[0]);
    assert!(apart > 2e-4, "{apart} m");
}

/// A friction drop reduces the largest torque that the fingers can hold by its factor, if the cap is seated hard and
/// does not turn, and the feelers press as before.
#[test]
fn friction_drop_reduces_the_torque_by_its_factor() {
    // A stiff seat at the initial angle: the cap does not turn, and the fingers slide over it.
    let settings = [
        "sensing=direct",
        "control.recompression_speed=0.0",
        "sim.object.cap.motion.thread.running_torque=1.0",
        "sim.object.cap.motion.thread.seat_angle=0.0",
        "sim.feeler.static_friction=0.3",
        "sim.feeler.kinetic_friction=0.3",
    ];
    let torque = |faults: &str, time: f64| {
        let (_, states) = watch(&mut session(&settings, faults), step_at(time) + 1);
        states[step_at(time)].objects[0].turn.torque
    };
    let time = 1.6;
    let dry = torque("", time);
    assert!(dry.abs() > 1e-3, "{dry} N m");
    let wet = torque(
        "{from=1.5, kind.friction_drop={object=\"cap\", factor=0.5}}",
        time,
    );
    // The normal forces change slightly with the reduced shear, because feelers lean on a round cap.
    assert!((wet / dry - 0.5).abs() < 0.05, "{wet} of {dry} N m");
    let over = "{from=0.95, until=1.0, kind.friction_drop={factor=0.5}}";
    let factor = |faults: &str, time: f64| {
        let (_, states) = watch(&mut session(&settings, faults), step_at(time) + 1);
        states[step_at(time)].objects[0].friction_factor
    };
    // The state at a given time is the one after the step that ends then.
    assert_eq!(factor(over, 0.95), 1.0);
    assert_eq!(factor(over, 0.96), 0.5);
    assert_eq!(factor(over, 1.0), 0.5);
    assert_eq!(factor(over, 1.01), 1.0);
}

#[test]
fn dead_element_does_not_affect_the_world() {
    // Compared only until the hand reacts.
    let fault = "{from=1.6, kind.dead_element={finger=0, element=0}}";
    let [good, bad] = ["", fault].map(|fault| {
        let mut session = session(&["sensing=direct"], fault);
        watch(&mut session, step_at(1.6) + 1).1
    });
    assert_eq!(good, bad);
}
