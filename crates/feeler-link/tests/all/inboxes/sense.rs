//! Images and forces that the sensor program of a finger accepts or rejects, and the steps that it echoes.

use super::bench::{ELEMENTS, HAND, NOBODY, WORLD, hear, heartbeat, mode, put, sense};
use feeler_link::messages::Rejection;
use feeler_link::messages::message::{DirectForces, PictureMessage};
use feeler_link::transport::{Topic, header};
use feeler_record::wire::Vector3;

fn picture(sequence: u64) -> PictureMessage {
    PictureMessage {
        header: header(WORLD, sequence, 1.0),
        finger: 0,
        frame: sequence,
        width: 2,
        height: 1,
        pixels: vec![0, 255],
    }
}

fn forces(sequence: u64) -> DirectForces {
    DirectForces {
        header: header(WORLD, sequence, 1.0),
        finger: 0,
        frame: sequence,
        forces: vec![Vector3::default(); ELEMENTS],
    }
}

/// Result for image 6 after the change `spoil`. Image 5 has been accepted before.
fn spoiled(spoil: impl Fn(&mut PictureMessage)) -> Result<(), Rejection> {
    let mut sense = sense();
    put(&mut sense, Topic::Picture(0), &picture(5), 1.0).unwrap();
    let mut message = picture(6);
    spoil(&mut message);
    put(&mut sense, Topic::Picture(0), &message, 1.01)
}

#[test]
fn each_invalid_image_field_is_rejected() {
    type Spoil = fn(&mut PictureMessage);
    let cases: [(Spoil, Rejection); 9] = [
        (|p| p.header.protocol = 2, Rejection::Protocol),
        (|p| p.header.instance = NOBODY, Rejection::Unintroduced),
        (|p| p.header.instance = HAND, Rejection::Stranger),
        (|p| p.header.sequence = 4, Rejection::Old),
        (|p| p.header.sequence = u64::MAX, Rejection::Implausible),
        (|p| p.header.stamp = f64::NAN, Rejection::NotFinite),
        (|p| p.finger = 1, Rejection::Size),
        (|p| p.width = 1, Rejection::Size),
        (|p| p.pixels.truncate(1), Rejection::Size),
    ];
    assert_eq!(spoiled(|_| {}), Ok(()));
    // A repetition, by a rig in lockstep that waits for an answer, is accepted.
    assert_eq!(spoiled(|picture| picture.header.sequence = 5), Ok(()));
    for (index, (spoil, rejection)) in cases.into_iter().enumerate() {
        assert_eq!(spoiled(spoil), Err(rejection), "{index}");
    }
}

#[test]
fn each_invalid_forces_field_is_rejected() {
    type Spoil = fn(&mut DirectForces);
    let cases: [(Spoil, Rejection); 4] = [
        (|f| f.header.protocol = 2, Rejection::Protocol),
        (|f| f.forces.truncate(1), Rejection::Size),
        (|f| f.forces[0].x = f64::NAN, Rejection::NotFinite),
        (|f| f.forces[0].x = 1e308, Rejection::Implausible),
    ];
    for (index, (spoil, rejection)) in cases.into_iter().enumerate() {
        let mut message = forces(1);
        spoil(&mut message);
        let taken = put(&mut sense(), Topic::DirectForces(0), &message, 1.0);
        assert_eq!(taken, Err(rejection), "{index}");
    }
}

#[test]
fn images_are_queued_in_order_and_the_oldest_are_dropped() {
    let mut sense = sense();
    for sequence in 1..=10 {
        put(&mut sense, Topic::Picture(0), &picture(sequence), 1.0).unwrap();
    }
    let mut taken = Vec::new();
    while let Some(exposed) = sense.take_next() {
        taken.push(exposed.header().1);
    }
    assert_eq!(taken, [3, 4, 5, 6, 7, 8, 9, 10]);
    assert_eq!(sense.lost, 2);
}

#[test]
fn an_image_echoes_the_latest_step_before_it() {
    let mut sense = sense();
    assert_eq!(sense.echo_at(1.0).step, 0);
    for step in 1..=5 {
        put(&mut sense, Topic::Mode, &mode(step), step as f64).unwrap();
    }
    assert_eq!(
        put(&mut sense, Topic::Mode, &mode(4), 5.1),
        Err(Rejection::Old)
    );
    let echo = sense.echo_at(3.5);
    assert_eq!((echo.step, echo.token, echo.arrived), (3, 1003, 3.0));
    assert_eq!(sense.echo_at(0.5).step, 0);
}

#[test]
fn steps_of_a_new_hand_replace_those_of_the_previous_one() {
    let mut sense = sense();
    put(&mut sense, Topic::Mode, &mode(500), 1.0).unwrap();
    hear(&mut sense, &heartbeat("hand", NOBODY), 3.0).unwrap();
    let mut first = mode(1);
    first.header.instance = NOBODY;
    put(&mut sense, Topic::Mode, &first, 3.1).unwrap();
    assert_eq!(sense.echo_at(2.0).step, 0, "no step of the previous hand");
    assert_eq!(sense.echo_at(3.2).step, 1);
}
