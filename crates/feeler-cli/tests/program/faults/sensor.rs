//! Faults of sensors and cameras.

use super::bench::{PERIOD, load, session, step_at, watch};
use assert_no_alloc::assert_no_alloc;
use feeler::control::StopReason;
use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::forces::TactileFrame;
use feeler::sensor::image::{Camera, Frame};
use feeler_lab::experiment::Session;
use feeler_sim::optics::SimCamera;
use feeler_sim::rig::{SensorFaults, SimRig};
use glam::DVec3;

/// Number of control steps. The fingers turn the cap from about 1.5 s on.
const STEPS: usize = 180;
/// Time at which the faults begin (s).
const FROM: f64 = 1.6;

/// Tactile frames of both fingers without and with `faults`, which begin at [`FROM`].
fn both(sensing: &str, faults: &str) -> [Vec<Vec<TactileFrame>>; 2] {
    ["", faults].map(|faults| watch(&mut session(&[sensing], faults), STEPS).0)
}

/// One fault of each kind.
const ALL: &str = "{from=1.6, kind.dead_element={finger=0, element=0}}, \
        {from=1.6, kind.stuck_rows={finger=0, first=100, count=20, gray=255}}, \
        {from=1.6, kind.frozen_frame={finger=1}}, \
        {from=1.6, kind.dropped_frames={finger=1, probability=0.5}}, \
        {from=1.6, kind.camera_latency={finger=0, delay=0.02}}, \
        {from=1.6, kind.servo_stall={finger=0, joint=1}}, \
        {from=1.6, kind.backlash={finger=1, joint=2, angle=0.01}}, \
        {from=1.6, kind.friction_drop={factor=0.1}}";

#[test]
fn faults_have_no_effect_before_they_begin() {
    for sensing in ["sensing=direct", "sensing=image"] {
        let [good, bad] = both(sensing, ALL);
        let from = step_at(FROM);
        assert_eq!(good[..from], bad[..from], "{sensing}");
        assert_ne!(good[from], bad[from], "{sensing}");
    }
}

#[test]
fn faults_do_not_allocate() {
    for sensing in ["sensing=direct", "sensing=image"] {
        let mut session = session(&[sensing], &ALL.replace("1.6", "0.1"));
        let failed = assert_no_alloc(|| (0..40).find_map(|_| session.step().err()));
        assert!(failed.is_none());
    }
}

#[test]
fn sensor_recovers_after_a_fault() {
    // The finger touches nothing, so that the fault does not affect the hand's motion.
    let faults = "{from=0.1, until=0.2, kind.dead_element={finger=0, element=0}}, \
        {from=0.1, until=0.2, kind.camera_latency={finger=0, delay=0.02}}, \
        {from=0.1, until=0.2, kind.dropped_frames={finger=1, probability=0.0}}";
    let [good, bad] = both("sensing=direct", faults);
    let (late, over) = (step_at(0.15), step_at(0.2));
    assert!((bad[late][0].stamp - 0.13).abs() < 1e-9);
    for (good, bad) in good[over..].iter().zip(&bad[over..]) {
        assert_eq!(good[0].stamp, bad[0].stamp);
        assert_eq!(good[0].sequence, bad[0].sequence);
    }
}

/// Index and normal force (N) of the element with the largest normal force.
fn largest(frame: &TactileFrame) -> (usize, f64) {
    let forces = frame.forces.iter().map(|f| f.z).enumerate();
    forces.fold(
        (0, 0.0),
        |best, next| if next.1 > best.1 { next } else { best },
    )
}

#[test]
fn dead_element_reads_zero_and_the_others_are_unaffected() {
    for sensing in ["sensing=direct", "sensing=image"] {
        let from = step_at(FROM);
        let (element, force) = largest(&both(sensing, "")[0][from][0]);
        assert!(force > 0.2, "{force} N");
        let fault = format!("{{from=1.6, kind.dead_element={{finger=0, element={element}}}}}");
        let [good, bad] = both(sensing, &fault);
        // The hand has not reacted yet. Only noise remains: 2 mN in direct sensing, and less than 10 mN with images,
        // whose noise is the same but is rounded differently near the spots.
        let (good, bad) = (&good[from], &bad[from]);
        assert!(
            bad[0].forces[element].length() < 0.05,
            "{}",
            bad[0].forces[element]
        );
        for (other, (g, b)) in good[0].forces.iter().zip(&bad[0].forces).enumerate() {
            assert!(
                other == element || g.distance(*b) < 0.02,
                "{other}: {g} and {b}"
            );
        }
        assert_eq!(good[1], bad[1]);
    }
}

#[test]
fn frozen_images_have_new_stamps() {
    for sensing in ["sensing=direct", "sensing=image"] {
        let [good, bad] = both(sensing, "{from=1.6, kind.frozen_frame={finger=1}}");
        let last = &bad[step_at(FROM) - 1][1];
        for (good, bad) in good.iter().zip(&bad).skip(step_at(FROM)) {
            assert_eq!(bad[1].forces, last.forces);
            assert_eq!(
                (bad[1].stamp, bad[1].sequence),
                (good[1].stamp, good[1].sequence)
            );
        }
        assert_ne!(good[STEPS - 1][1].forces, last.forces);
    }
}

#[test]
fn lost_frames_stop_the_hand_within_the_limit() {
    for sensing in ["sensing=direct", "sensing=image"] {
        let fault = "{from=0.9, kind.dropped_frames={finger=1, probability=1.0}}";
        let mut session = session(&[sensing], fault);
        while !session.finished() {
            session.step().unwrap();
        }
        let control_loop = session.control_loop();
        // The last frame is from 0.89 s. 3.5 periods are allowed, so that it is stale at 0.93 s.
        assert!((control_loop.state().stamp - 0.93).abs() < 1e-9);
        let reason = control_loop.controller().stop_reason();
        let Some(&StopReason::StaleForces {
            finger: 1,
            age,
            limit,
        }) = reason
        else {
            panic!("{reason:?}")
        };
        assert!((age - 0.04).abs() < 1e-9 && (limit - 0.035).abs() < 1e-9);
        let last = &control_loop.touches()[1].frame;
        assert!((last.stamp - 0.89).abs() < 1e-9 && last.sequence == 89);
    }
}

#[test]
fn frames_are_dropped_with_the_given_probability() {
    let settings = ["sensing=direct", "control.stale_periods=500"];
    let lost = |faults: &str| {
        let steps = 1000;
        let (felt, _) = watch(&mut session(&settings, faults), steps);
        let frames = felt.windows(2);
        let lost = frames.filter(|pair| {
            let same = pair[0][0].sequence == pair[1][0].sequence;
            assert_eq!(same, pair[0][0] == pair[1][0]);
            same
        });
        (lost.count() as f64, (steps - 1) as f64)
    };
    let fault = "{kind.dropped_frames={finger=0, probability=0.3}}";
    let (count, frames) = lost(fault);
    // Four standard deviations of a binomial count.
    let deviation = (frames * 0.3 * 0.7).sqrt();
    assert!(
        (count - 0.3 * frames).abs() < 4.0 * deviation,
        "{count} of {frames}"
    );
    assert_eq!(lost(fault).0, count);
    assert_eq!(
        lost("{kind.dropped_frames={finger=0, probability=0.0}}").0,
        0.0
    );
    // Each fault has a separate random stream, selected by its index: at another index, it drops other frames.
    let second = format!("{{kind.frozen_frame={{finger=1}}}}, {fault}");
    assert_ne!(lost(&second).0, count);
}

#[test]
fn delayed_frames_show_the_world_at_their_stamp() {
    for (delay, periods) in [(0.02, 2), (0.014, 2), (0.03, 3), (0.0, 0)] {
        for sensing in ["sensing=direct", "sensing=image"] {
            let fault = format!("{{kind.camera_latency={{finger=0, delay={delay}}}}}");
            // Noise is drawn when an image is rendered, which is now at another time.
            let quiet = [
                sensing,
                "sim.direct_sensing.normal_noise=0.0",
                "sim.direct_sensing.shear_noise=0.0",
                "sim.optics.read_noise=0.0",
                "sim.optics.shot_noise=0.0",
            ];
            let mut session = session(&quiet, &fault);
            let steps = 170;
            let world = world_forces(&mut session, steps);
            for (step, (felt, _)) in world.iter().enumerate() {
                let exposed = step.saturating_sub(periods);
                assert!(
                    (felt.stamp - PERIOD * exposed as f64).abs() < 1e-9,
                    "{step}"
                );
                assert_eq!(felt.sequence, exposed as u64);
                for (felt, truth) in felt.forces.iter().zip(&world[exposed].1) {
                    // Exactly, or to the accuracy of the calibration in compression.
                    let tolerance = if sensing == "sensing=direct" {
                        0.0
                    } else {
                        0.03
                    };
                    assert!((felt.z - truth.z).abs() <= tolerance, "{felt} and {truth}");
                }
            }
        }
    }
}

/// For each control step, the tactile frame of finger 0 and the true forces at the start of the step.
fn world_forces(session: &mut Session, steps: usize) -> Vec<(TactileFrame, Vec<DVec3>)> {
    let step = |_| {
        let mut truth = vec![DVec3::ZERO; session.layouts()[0].elements.len()];
        session.rig().world().element_forces(0, &mut truth);
        session.step().expect("a step");
        (session.control_loop().touches()[0].frame.clone(), truth)
    };
    (0..steps).map(step).collect()
}

#[test]
fn frames_delayed_beyond_the_limit_stop_the_hand() {
    let mut session = session(
        &[],
        "{from=0.5, kind.camera_latency={finger=0, delay=0.05}}",
    );
    while !session.finished() {
        session.step().unwrap();
    }
    let reason = session.control_loop().controller().stop_reason();
    assert!(
        matches!(reason, Some(StopReason::StaleForces { finger: 0, .. })),
        "{reason:?}"
    );
    // The last frame without delay is from 0.49 s.
    assert!((session.control_loop().state().stamp - 0.53).abs() < 1e-9);
}

#[test]
fn stuck_rows_change_only_these_rows() {
    let fault = "{from=0.05, kind.stuck_rows={finger=0, first=470, count=10, gray=200}}";
    let [good, bad] = ["", fault].map(|fault| {
        let experiment = load(&[], fault);
        let config = &experiment.config;
        let session = Session::new(&experiment).unwrap();
        let rig: &SimRig = session.rig();
        let fingertip = Fingertip::new(&config.sensor.fingertip).unwrap();
        let faults = SensorFaults::new(
            &config.simulation().expect("a simulated world").fault,
            0,
            41,
            PERIOD,
            config.seed,
        );
        let optics = &config.simulation().expect("a simulated world").optics;
        let camera = SimCamera::new(rig.clone(), 0, &fingertip, optics, faults, config.seed);
        let (mut camera, mut frame) = (camera.unwrap(), Frame::black(640, 480));
        let mut pictures = Vec::new();
        for _ in 0..10 {
            camera.capture(&mut frame).unwrap();
            pictures.push(frame.picture.pixels.clone());
            for _ in 0..10 {
                rig.world().step().unwrap();
            }
        }
        pictures
    });
    let rows = 470 * 640;
    for (number, (good, bad)) in good.iter().zip(&bad).enumerate() {
        assert_eq!(good[..rows], bad[..rows]);
        let stuck = bad[rows..].iter().all(|&pixel| pixel == 200);
        assert_eq!(stuck, number >= 5, "image {number}");
        assert_eq!(good == bad, number < 5);
    }
}
