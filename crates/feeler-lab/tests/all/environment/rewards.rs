//! Sums of rewards, compared with the simulator's ground truth.

use super::support::{environment, follow, told};
use feeler_lab::environment::Environment;
use feeler_lab::experiment::Truth;

/// Rounding error of a sum of up to 5000 rewards of about 1.
const ROUNDING: f64 = 1e-9;

#[test]
fn rewards_of_a_cap_add_up_to_torque_and_rotation_minus_slip_work() {
    let mut environment = environment("cap-closing", &[]);
    environment.reset(Some(1)).expect("an episode");
    let before = Truth::of(environment.session());
    let mut action = [0.0; 6];
    let (mut sum, mut peak) = (0.0, 0.0);
    loop {
        environment.guide(&mut action).expect("an action");
        let step = environment.step(&action).expect("a step");
        sum += step.reward;
        peak = f64::max(peak, told(&environment, "peak_force_n"));
        if step.terminated {
            break;
        }
    }
    let after = Truth::of(environment.session());
    let gained =
        |of: fn(&Truth) -> Option<f64>| of(&after).expect("a cap") - of(&before).expect("a cap");
    let seat = told(&environment, "cap_angle_rad") - (gained(|t| t.cap_torque) / 0.42);
    let expected = 1e3 * gained(|t| t.cap_torque) + seat - 50.0 * after.slip_work;
    // No element was pressed above 1.25 F2, so no force penalty applies.
    assert!(peak < 0.63, "{peak}");
    assert!((sum - expected).abs() < ROUNDING, "{sum}, not {expected}");
    assert_eq!(told(&environment, "success"), 1.0);
}

#[test]
fn tasks_that_reach_their_goal_earn_its_reward() {
    // In mN·m, mm of both directions, mm and %; costs are small.
    for (name, worth, costs) in [
        ("cap-until-closed", 37.0, 4.0),
        ("lift", 40.0, 0.1),
        ("slide-box-two", 25.0, 0.5),
        ("contour", 99.0, 1.0),
    ] {
        let mut environment = environment(name, &[]);
        let (steps, sum) = follow(&mut environment, 1);
        assert!(steps.last().expect("a step").terminated, "{name}");
        assert_eq!(told(&environment, "success"), 1.0, "{name}");
        assert!((sum - worth).abs() < costs, "{name}: {sum}");
    }
}

/// The box of 0.1 kg is lifted between 3.0 and 3.6 s, filled to 0.2 kg from 7 to 8 s, and put down between 9.0 and 9.8 s.
#[test]
fn rewards_of_a_gripper_are_the_weight_carried_less_a_tenth_of_its_grip() {
    let mut environment = environment("grip", &[]);
    let (steps, sum) = follow(&mut environment, 1);
    assert!(steps.last().expect("a step").terminated);
    assert_eq!(told(&environment, "success"), 1.0);
    let carried = told(&environment, "carried_ns");
    let expected = 9.81 * (0.1 * 4.0 + 0.15 + 0.2 * 1.8);
    // Lift and descent start and end slowly, and the object slides a little: about 0.3 s of a weight of 1 or 2 N.
    assert!(
        (carried - expected).abs() < 0.6,
        "{carried}, not {expected}"
    );
    let rewards = carried - 0.1 * told(&environment, "pressed_ns");
    assert!((sum - rewards).abs() < ROUNDING, "{sum}, not {rewards}");
}

#[test]
fn an_idle_agent_earns_nothing_until_the_time_limit() {
    for name in [
        "cap-closing",
        "cap-until-closed",
        "slide-box-two",
        "contour",
    ] {
        let mut environment = environment(name, &["time_limit=0.5"]);
        environment.reset(Some(0)).expect("an episode");
        let still = vec![0.0; environment.action_len()];
        let mut sum = 0.0;
        let last = loop {
            let step = environment.step(&still).expect("a step");
            sum += step.reward;
            if step.truncated || step.terminated {
                break step;
            }
        };
        assert!(last.truncated && !last.terminated, "{name}");
        // A box settles on its stand by some micrometres.
        assert!(f64::abs(sum) < 0.01, "{name}: {sum}");
    }
}

/// Follows the plan while `goes_on`, then applies `action` for up to `steps` steps or until the episode ends.
///
/// Returns the sum of all rewards and the sum of those after the plan.
fn then(
    environment: &mut Environment,
    goes_on: impl Fn(&Environment) -> bool,
    action: &[f64],
    steps: usize,
) -> (f64, f64) {
    environment.reset(Some(2)).expect("an episode");
    let mut guide = vec![0.0; environment.action_len()];
    let (mut first, mut second) = (0.0, 0.0);
    while goes_on(environment) {
        environment.guide(&mut guide).expect("an action");
        first += environment.step(&guide).expect("a step").reward;
    }
    for _ in 0..steps {
        let step = environment.step(action).expect("a step");
        second += step.reward;
        if step.terminated {
            break;
        }
    }
    (first + second, second)
}

#[test]
fn dropping_a_lifted_object_loses_the_reward_of_lifting() {
    let mut environment = environment("lift", &[]);
    let lifted = |e: &Environment| told(e, "object_z_m") < 0.015;
    let apart = [-0.02, 0.0, 0.0, 0.02, 0.0, 0.0];
    let (sum, lost) = then(&mut environment, lifted, &apart, 60);
    assert!(lost < -14.0, "{lost}");
    // The box is almost back at its initial position.
    assert!(sum.abs() < 0.5, "{sum}");
}

#[test]
fn pressing_too_hard_is_penalized_until_the_hand_stops() {
    let mut environment = environment("lift", &[]);
    let touched = |e: &Environment| told(e, "pressing_force_n") < 0.5;
    let together = [0.02, 0.0, 0.0, -0.02, 0.0, 0.0];
    let (_, second) = then(&mut environment, touched, &together, 500);
    assert!(second < -0.1, "{second}");
    let reason = environment.stop_reason().expect("a reason").to_string();
    assert!(reason.contains("10"), "{reason}");
}

#[test]
fn an_outline_is_rewarded_once() {
    let mut environment = environment("contour", &[]);
    let felt = |e: &Environment| told(e, "outline_felt") < 0.2;
    let (sum, second) = then(&mut environment, felt, &[0.0; 3], 300);
    assert!((20.0..21.0).contains(&sum), "{sum}");
    assert!(second.abs() < 0.5, "{second}");
}
