//! A bottle with play in its holder, compared with statics calculated by hand.

use super::one_feeler::OneFeeler;
use feeler_sim::objects::{
    FingerLoad, Hinge, HolderConfig, LateralConfig, PlaySpring, ThreadConfig, Turn,
};
use glam::DVec3;

const RADIUS: f64 = 0.014;
const CLAMP: LateralConfig = LateralConfig {
    stiffness: [2e4, 5e3],
    play: [3e-4, 1e-4],
};

/// A feeler in front of a cap that does not turn, on a bottle held by [`CLAMP`].
fn before_a_bottle() -> OneFeeler {
    OneFeeler::new(-RADIUS, |sim| {
        sim.holder = Some(HolderConfig {
            lateral: Some(CLAMP),
            turn_play: 0.0,
        });
        sim.torque_sensor.stiffness = 1e9;
        let cap = sim.object.get_mut("cap").expect("a cap");
        cap.position = [0.0; 3];
        cap.thread_mut().expect("a thread").running_torque = 1e3;
    })
}

/// Equilibrium position (m) of two springs in series, the second with play, if the free end of the first is at `drive`
/// (m).
fn balanced(spring: f64, clamp: f64, play: f64, drive: f64) -> f64 {
    if drive <= play {
        drive
    } else {
        (spring * drive + clamp * play) / (spring + clamp)
    }
}

/// Tolerance of shifts (m): one Newton step each along x and y balances them to 1e-11 m.
const BALANCED: f64 = 1e-10;

#[test]
fn a_bottle_shifts_by_its_play_and_then_by_force_over_clamp_stiffness() {
    let mut rig = before_a_bottle();
    let [play, _] = CLAMP.play;
    for n in 0..=200 {
        let depth = 5e-6 * f64::from(n);
        let force = rig.press(depth, DVec3::ZERO);
        let expected = balanced(rig.feeler.normal_stiffness, CLAMP.stiffness[0], play, depth);
        let centre = rig.world.state().objects[0].pose.position;
        assert!(
            (centre - expected * DVec3::X).length() < BALANCED,
            "{centre}"
        );
        // The clamp's force balances the feeler's.
        let held = CLAMP.stiffness[0] * (centre.x - play).max(0.0);
        assert!(
            (force.x - held).abs() < CLAMP.stiffness[0] * BALANCED,
            "{force}"
        );
    }
}

#[test]
fn a_bottle_follows_shear_and_stays_at_the_end_of_its_play_when_released() {
    let mut rig = before_a_bottle();
    let ([_, stiffness], [x_play, y_play]) = (CLAMP.stiffness, CLAMP.play);
    for n in 0..=100 {
        rig.press(1e-5 * f64::from(n), DVec3::ZERO);
    }
    let shear = rig.feeler.shear_stiffness;
    for n in 0..=100 {
        let aside = -3e-6 * f64::from(n);
        rig.press(1e-3, aside * DVec3::Y);
        let expected = -balanced(shear, stiffness, y_play, -aside);
        let centre = rig.world.state().objects[0].pose.position;
        assert!((centre.y - expected).abs() < BALANCED, "{centre}");
    }
    // No force recentres the bottle.
    for _ in 0..10 {
        rig.press(-1e-3, DVec3::ZERO);
        let centre = rig.world.state().objects[0].pose.position;
        let left = DVec3::new(x_play, -y_play, 0.0);
        assert!((centre - left).length() < BALANCED, "{centre}");
    }
}

#[test]
fn no_torque_acts_on_the_shaft_within_the_play() {
    let hinge = Hinge::on_thread(&ThreadConfig {
        running_torque: 1.0,
        seat_angle: 1.0,
        seat_stiffness: 0.0,
        static_factor: 1.0,
        lead: 0.0,
        fault: None,
    });
    let (stiffness, play, pull) = (50.0, 0.01, 0.4);
    let shaft = PlaySpring::new(stiffness, play);
    let mut state = Turn::default();
    // Two springs in series beyond the play, in both directions; the cap does not turn on its thread.
    let row = stiffness * pull / (stiffness + pull);
    let swing = (0..=300).chain((-300..300).rev()).chain(-299..=0);
    for n in swing {
        let drive = 1e-4 * f64::from(n);
        hinge.turn(&mut state, (0.0, 0.0), &shaft, |state| FingerLoad {
            load: pull * (drive - state.angle - state.twist),
            stiffness: pull,
            firm: pull,
            room: f64::INFINITY,
        });
        let beyond = drive.signum() * (drive.abs() - play).max(0.0);
        // Torques are balanced to 1e-9 N m.
        assert!(
            (state.torque - row * beyond).abs() < 2e-9,
            "{state:?} at {drive}"
        );
        assert_eq!((state.angle, state.turning), (0.0, false));
    }
}

#[test]
fn a_cap_turns_at_its_running_torque_once_the_play_is_used_up() {
    let thread = ThreadConfig {
        running_torque: 0.003,
        seat_angle: 1.0,
        seat_stiffness: 0.0,
        static_factor: 1.15,
        lead: 0.0,
        fault: None,
    };
    let (stiffness, play, pull) = (50.0, 0.01, 0.4);
    let (hinge, shaft) = (Hinge::on_thread(&thread), PlaySpring::new(stiffness, play));
    let mut state = Turn::default();
    // The second step exceeds the thread's resistance until the play is used up.
    for n in 1..=20 {
        let drive = 0.009 * f64::from(n);
        hinge.turn(&mut state, (0.0, 0.0), &shaft, |state| FingerLoad {
            load: pull * (drive - state.angle - state.twist),
            stiffness: pull,
            firm: pull,
            room: f64::INFINITY,
        });
        let expected = drive - play - thread.running_torque * (1.0 / pull + 1.0 / stiffness);
        if n > 2 {
            assert!(
                (state.angle - expected).abs() < 1e-8,
                "{state:?} at {drive}"
            );
        } else {
            assert_eq!(state.angle, 0.0, "{state:?} at {drive}");
        }
    }
}
