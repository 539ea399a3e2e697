//! A hand that was stopped: which reason is kept, and what goes on meanwhile.

use super::rig::{controller, state, touch};
use feeler::control::phase::Phase;
use feeler::control::stop_reason::StopReason;
use feeler::hand::HandCommand;
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
    StopReason::Told {
        by: "a test".to_string(),
    }
}

#[test]
fn the_first_reason_is_kept_but_what_somebody_said_outlasts_stale_data() {
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
fn a_task_is_not_asked_while_the_hand_is_stopped() {
    let mut controller = controller();
    let mut command = HandCommand::stop(1);
    let (touches, state) = ([touch(1.0)], state());
    controller.decide(&touches, &state, &mut command);
    assert_eq!(controller.task().stroke(), 1);
    controller.stop(told());
    assert_eq!(controller.phase(), Phase::Stopped);
    for _ in 0..5 {
        controller.decide(&touches, &state, &mut command);
        assert_eq!(command.joint_velocity(), [DVec3::ZERO]);
    }
    assert_eq!(controller.task().stroke(), 1);
    controller.resume();
    controller.decide(&touches, &state, &mut command);
    assert_eq!(
        (controller.task().stroke(), controller.phase()),
        (2, Phase::Move)
    );
    assert!(command.joint_velocity()[0] != DVec3::ZERO);
}
