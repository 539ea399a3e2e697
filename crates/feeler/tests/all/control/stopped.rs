//! Stopped hands: which reason is kept, and how the controller acts meanwhile.

use super::rig::{controller, state, touch};
use feeler::control::{Phase, Plan, StopReason};
use feeler::hand::{HandCommand, JointVector};
use glam::DVec3;

fn stale() -> StopReason {
    StopReason::StaleForces {
        finger: 0,
        age: 1.0,
        limit: 0.035,
    }
}

fn broken() -> StopReason {
    StopReason::NotFinite {
        finger: 0,
        what: "force",
    }
}

fn told() -> StopReason {
    StopReason::Requested {
        by: "a test".to_string(),
    }
}

#[test]
fn the_first_reason_is_kept_but_a_request_replaces_stale_data() {
    for (first, then, kept) in [
        (stale(), broken(), stale()),
        (broken(), stale(), broken()),
        (stale(), told(), told()),
        (told(), stale(), told()),
        (broken(), told(), broken()),
        (told(), broken(), told()),
    ] {
        let mut controller = controller();
        controller.stop(first);
        controller.stop(then);
        assert_eq!(controller.stop_reason(), Some(&kept));
    }
}

#[test]
fn a_task_is_not_advanced_while_the_hand_is_stopped() {
    let mut controller = controller();
    let mut command = HandCommand::stop(1);
    let (touches, state) = ([touch(1.0)], state());
    controller.decide(&touches, &state, &mut command);
    assert_eq!(controller.task().stroke(), 1);
    controller.stop(told());
    assert_eq!(controller.phase(), Phase::Stopped);
    for _ in 0..5 {
        controller.decide(&touches, &state, &mut command);
        assert_eq!(command.joint_velocity(), [JointVector::default()]);
    }
    assert_eq!(controller.task().stroke(), 1);
    controller.resume();
    controller.decide(&touches, &state, &mut command);
    assert_eq!(
        (controller.task().stroke(), controller.phase()),
        (2, Phase::Move)
    );
    assert!(command.joint_velocity()[0] != JointVector::default());
}

/// An agent that requests the law's velocity gets the law's command; any other velocity is limited in the same way.
#[test]
fn an_agents_velocity_is_limited_like_the_laws_velocity() {
    let (mut by_law, mut by_agent) = (controller(), controller());
    let (mut lawful, mut followed) = (HandCommand::stop(1), HandCommand::stop(1));
    let (touches, state) = ([touch(1.0)], state());
    by_law.decide(&touches, &state, &mut lawful);
    by_agent.plan(&touches, &state);
    // The law "open-loop" follows the plan.
    let planned = by_agent.plans()[0].velocity;
    by_agent.follow(&[planned], &state, &mut followed);
    assert_eq!(lawful, followed);
    assert!(lawful.joint_velocity()[0] != JointVector::default());
    by_agent.plan(&touches, &state);
    by_agent.follow(&[DVec3::splat(1e300)], &state, &mut followed);
    assert!(by_agent.fingers()[0].admitted.limited);
    // 20 rad/s² over two periods of 10 ms.
    assert!(followed.joint_velocity()[0].abs().max_element() <= 0.4 + 1e-12);
}

#[test]
fn an_agent_cannot_move_the_hand_without_a_plan_or_while_stopped() {
    let mut controller = controller();
    let mut command = HandCommand::stop(1);
    let (touches, state) = ([touch(1.0)], state());
    let fast = [0.01 * DVec3::Y];
    controller.plan(&touches, &state);
    controller.follow(&fast, &state, &mut command);
    assert!(command.joint_velocity()[0] != JointVector::default());
    controller.follow(&fast, &state, &mut command);
    assert_eq!(command.joint_velocity(), [JointVector::default()]);
    controller.plan(&touches, &state);
    controller.stop(told());
    controller.follow(&fast, &state, &mut command);
    assert_eq!(command.joint_velocity(), [JointVector::default()]);
    controller.plan(&touches, &state);
    assert_eq!(controller.plans(), [Plan::default()]);
    controller.follow(&fast, &state, &mut command);
    assert_eq!(command.joint_velocity(), [JointVector::default()]);
    for (velocities, reason) in [
        (
            vec![],
            StopReason::FingerCount {
                what: "velocities",
                expected: 1,
                actual: 0,
            },
        ),
        (
            vec![DVec3::NAN],
            StopReason::NotFinite {
                finger: 0,
                what: "command",
            },
        ),
    ] {
        controller.resume();
        controller.plan(&touches, &state);
        controller.follow(&velocities, &state, &mut command);
        assert_eq!(command.joint_velocity(), [JointVector::default()]);
        assert_eq!(controller.stop_reason(), Some(&reason));
    }
}
