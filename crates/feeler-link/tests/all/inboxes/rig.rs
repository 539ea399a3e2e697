//! Commands that a rig executes or rejects.

use super::bench::{HAND, NOBODY, SENSE, STALE, command, hear, heartbeat, mode, put, rig};
use feeler::hand::JointVector;
use feeler_link::messages::Rejection;
use feeler_link::messages::message::CommandMessage;
use feeler_link::transport::Topic;
use feeler_record::wire::Vector3;

/// Result for command 6, a motion, after the change `spoil`. Command 5 has been accepted before.
fn spoiled(spoil: impl Fn(&mut CommandMessage)) -> Result<(), Rejection> {
    let mut rig = rig();
    put(&mut rig, Topic::Command, &command(5, 0.1), 1.0).unwrap();
    let mut message = command(6, 0.2);
    spoil(&mut message);
    let taken = put(&mut rig, Topic::Command, &message, 1.01);
    let obeyed = rig.drive(1.01, STALE).map(|velocity| velocity[0][0]);
    assert_eq!(obeyed, Some(if taken.is_ok() { 0.2 } else { 0.1 }));
    taken
}

#[test]
fn each_invalid_command_field_is_rejected() {
    type Spoil = fn(&mut CommandMessage);
    let cases: [(Spoil, Rejection); 13] = [
        (|c| c.header.protocol = 2, Rejection::Protocol),
        (|c| c.header.instance = NOBODY, Rejection::Unintroduced),
        (|c| c.header.instance = SENSE, Rejection::Stranger),
        (|c| c.header.sequence = 5, Rejection::Old),
        (|c| c.header.sequence = u64::MAX, Rejection::Implausible),
        // Based on data of the previous rig.
        (|c| c.header.clock = NOBODY, Rejection::Clock),
        // Based on stale data, future data, no data.
        (|c| c.header.stamp = 1.0 - STALE - 0.011, Rejection::Old),
        (|c| c.header.stamp = 1.0 + STALE + 0.011, Rejection::Old),
        (|c| c.header.stamp = f64::NAN, Rejection::Old),
        (|c| c.joint_velocity.clear(), Rejection::Size),
        (
            |c| c.joint_velocity.push(Vector3::default()),
            Rejection::Size,
        ),
        (|c| c.joint_velocity[0].y = f64::NAN, Rejection::NotFinite),
        (|c| c.joint_velocity[0].z = -1e6, Rejection::Implausible),
    ];
    assert_eq!(spoiled(|_| {}), Ok(()));
    for (index, (spoil, rejection)) in cases.into_iter().enumerate() {
        assert_eq!(spoiled(spoil), Err(rejection), "{index}");
    }
}

#[test]
fn stale_motions_are_counted_and_stale_stops_executed() {
    let mut rig = rig();
    let mut old = command(1, 0.1);
    old.header.stamp = 0.9;
    let refused = put(&mut rig, Topic::Command, &old, 1.0);
    assert_eq!((refused, rig.stale_commands), (Err(Rejection::Old), 1));
    let mut still = command(2, 0.0);
    still.header.stamp = 0.9;
    assert_eq!(put(&mut rig, Topic::Command, &still, 1.0), Ok(()));
    assert_eq!(rig.drive(1.0, STALE), Some(&[JointVector::default()][..]));
}

#[test]
fn watchdog_stops_the_drives_without_commands() {
    let mut rig = rig();
    put(&mut rig, Topic::Command, &command(1, 0.1), 1.0).unwrap();
    assert!(rig.drive(1.0 + STALE, STALE).is_some());
    assert!(rig.drive(1.0 + STALE + 1e-6, STALE).is_none());
    assert_eq!(rig.watchdog_stops, 1);
    // A clock that runs backwards does not reactivate a command.
    assert!(rig.drive(1.0, STALE).is_none());
}

#[test]
fn the_latest_step_is_echoed_with_its_token() {
    let mut rig = rig();
    put(&mut rig, Topic::Mode, &mode(7), 1.0).unwrap();
    assert_eq!(
        (rig.echo.step, rig.echo.token, rig.echo.arrived),
        (7, 1007, 1.0)
    );
    // The mode of a step is sent after its command.
    put(&mut rig, Topic::Command, &command(8, 0.1), 1.01).unwrap();
    assert_eq!(put(&mut rig, Topic::Mode, &mode(8), 1.011), Ok(()));
    assert_eq!((rig.echo.step, rig.echo.arrived), (8, 1.01));
    assert_eq!(
        put(&mut rig, Topic::Mode, &mode(7), 1.02),
        Err(Rejection::Old)
    );
    let runaway = put(&mut rig, Topic::Mode, &mode(u64::MAX), 1.02);
    assert_eq!((runaway, rig.echo.step), (Err(Rejection::Implausible), 8));
}

#[test]
fn forged_heartbeats_do_not_free_the_place_of_the_hand() {
    let mut rig = rig();
    let mut own = heartbeat("hand", HAND);
    for sequence in [u64::MAX - 1, u64::MAX] {
        own.sequence = sequence;
        assert_eq!(hear(&mut rig, &own, 0.1), Err(Rejection::Implausible));
    }
    // The actual hand continues, so another program's heartbeat finds the place taken.
    for beat in 2..=30 {
        own.sequence = beat;
        assert_eq!(hear(&mut rig, &own, 0.1 * beat as f64), Ok(()));
    }
    hear(&mut rig, &heartbeat("hand", NOBODY), 3.05).unwrap();
    let mut strange = command(9, 0.1);
    strange.header.instance = NOBODY;
    let refused = put(&mut rig, Topic::Command, &strange, 3.06);
    assert_eq!(refused, Err(Rejection::Stranger));
}
