//! Bodies of the fuzz targets: each parses its bytes and, if they are valid, uses the result.
//!
//! The targets share them with the tests `fuzz_corpus` of `feeler-cli`, which run all corpora. A body returns `true` if
//! its bytes were valid.

use feeler::control::law::Law;
use feeler::control::law::policy::{Policy, PolicyModel};
use feeler::control::sense::{FingerReadings, FingertipPose};
use feeler::control::{Plan, TactileReading};
use feeler::hand::{Hand, HandState, JointState, JointVector};
use feeler::sensor::calibration::{Calibration, ForceAxes, read_loads};
use feeler::sensor::fingertip::{ElementLayout, LocatedLayout};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::image::{Camera, CameraError, Frame, ProjectedElement};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::skin::{SerialConfig, SkinDecoder, SkinProtocol};
use feeler::sensor::taxel::{TaxelLayout, TaxelSensor};
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::forces::read_forces;
use feeler::sensor::wrench::moments::MomentBasis;
use feeler::sensor::wrench::taxels::TaxelBasis;
use feeler::sensor::wrench::{CalibrationOf, EstimatorOf};
use feeler_drives::packet::{
    Decoder, LONGEST, Protocol, Sender, complete_blocks, encode, fast_blocks,
};
use feeler_lab::config::Experiment;
use feeler_link::hand::{RigSpeed, RunClock};
use feeler_link::inboxes::{Expected, HandInbox, Inbox, MAX_PEERS, RigInbox, SenseInbox};
use feeler_link::messages::message::{
    Heartbeat, MessageHeader, NO_FINGER, PROTOCOL, ResumeMessage, StateMessage, StopMessage,
    TactileUpdate,
};
use feeler_link::messages::{Echo, JointCounts};
use feeler_link::stop_server::wire::parse as parse_datagram;
use feeler_link::transport::{ProgramRole, Topic, header};
use feeler_record::tactile_array::{TactileArray, from_cloud, to_cloud, to_recorded, to_wrench};
use feeler_record::wire::{Message, Vector3, cdr};
use feeler_record::{RecordedCamera, RecordedHand, RecordedSensor, Recording};
use feeler_ros2::message::{ListParametersRequest, SetParametersRequest};
use feeler_ros2::parameter::Parameters;
use feeler_ros2::{Attachment, JointReader};
use feeler_sources::decode_picture;
use glam::{DVec2, DVec3};
use std::io::Cursor;
use std::str::from_utf8;
use std::sync::Arc;

/// Maximum number of pixels of a layout for which a kernel is built; larger ones are only slower.
const MAX_PIXELS: usize = 1 << 16;

/// A valid layout round-trips, and its kernel is built or rejected.
pub fn layout(bytes: &[u8]) -> bool {
    let Some(layout) = text(bytes).and_then(|text| LocatedLayout::from_toml(text).ok()) else {
        return false;
    };
    let written = layout
        .to_toml()
        .expect("a layout that was read can be written");
    let again = LocatedLayout::from_toml(&written).expect("what was written can be read");
    assert_eq!(layout, again);
    if layout.width * layout.height <= MAX_PIXELS && layout.elements.len() <= 64 {
        let _ = layout.kernel();
    }
    true
}

/// A valid wrench calibration, of a camera or of taxels, round-trips and gives finite components for finite input.
pub fn wrench(bytes: &[u8]) -> bool {
    let cameras = wrench_calibration(bytes, |basis: &MomentBasis, factor| {
        let moments = basis.0.iter().map(|element| {
            Some(ElementMoments {
                integrated_gray: element.gray * factor,
                centroid: element.centroid + DVec2::splat(factor),
            })
        });
        moments.collect()
    });
    cameras
        || wrench_calibration(bytes, |basis: &TaxelBasis, factor| {
            let mut input = basis.missing_input();
            input.values.fill(DVec3::splat(factor));
            input
        })
}

/// Returns `true` if `bytes` is a calibration of the kind `B`. Checks it with an `input` for each factor.
fn wrench_calibration<B: Basis>(bytes: &[u8], input: impl Fn(&B, f64) -> B::Input) -> bool {
    let calibration = text(bytes).and_then(|text| CalibrationOf::<B>::from_toml(text).ok());
    let Some(calibration) = calibration else {
        return false;
    };
    let written = calibration
        .to_toml()
        .expect("a calibration that was read can be written");
    let again = CalibrationOf::from_toml(&written).expect("what was written can be read");
    assert_eq!(calibration, again);
    let basis = calibration.model.elements.clone();
    let mut estimator = EstimatorOf::new(calibration).expect("a sound calibration");
    for factor in [0.0, 0.5, 1.0, 10.0, 1e300] {
        let estimate = estimator.estimate_with(|filled| *filled = input(&basis, factor));
        let mut components = estimate.components.iter().flatten();
        assert!(components.all(|c| c.is_finite()), "{estimate:?}");
    }
    true
}

/// A datagram of a force sensor, a request to one, its address, or its web page; each round-trips.
pub fn netft(bytes: &[u8]) -> bool {
    use feeler_sources::{NetFtAddress, Record, Request, parse_counts};
    let record = Record::from_bytes(bytes);
    if let Ok(record) = record {
        assert_eq!(record.to_bytes(), bytes);
    }
    if let Ok(request) = Request::from_bytes(bytes) {
        assert_eq!(request.to_bytes(), bytes);
    }
    let text = str::from_utf8(bytes).unwrap_or_default();
    if let Ok(address) = text.parse::<NetFtAddress>() {
        assert_eq!(address.to_string().parse(), Ok(address));
    }
    if let Ok(counts) = parse_counts(text) {
        assert!(counts.per_newton > 0.0 && counts.per_newton_metre > 0.0);
    }
    record.is_ok()
}

/// Measured wrenches are in the order of their recordings.
pub fn forces(bytes: &[u8]) -> bool {
    let Ok(forces) = read_forces(bytes) else {
        return false;
    };
    let count = forces.recordings.len();
    assert!(
        forces
            .pictures
            .iter()
            .all(|picture| picture.recording < count)
    );
    true
}

/// A valid calibration round-trips and gives finite forces for finite moments.
pub fn calibration(bytes: &[u8]) -> bool {
    let Some(calibration) = text(bytes).and_then(|text| Calibration::from_toml(text).ok()) else {
        return false;
    };
    let written = calibration
        .to_toml()
        .expect("a calibration that was read can be written");
    let again = Calibration::from_toml(&written).expect("what was written can be read");
    assert_eq!(calibration, again);
    for element in &calibration.elements {
        for factor in [0.0, 0.5, 1.0, 1.5, 10.0] {
            for offset in [-1e-3, 0.0, 1e-3] {
                let moments = ElementMoments {
                    integrated_gray: element.unloaded_gray * factor,
                    centroid: element.unloaded_centroid + DVec2::new(offset, -offset),
                };
                let force = element.force(&moments);
                assert!(force.is_finite(), "{moments:?}: {force}");
                let _ = element.validity(&moments);
            }
        }
    }
    true
}

/// Decodes the bytes of a skin: the first selects the protocol and the number of taxels, the second the size of reads.
pub fn skins(bytes: &[u8]) -> bool {
    let [kind, piece, stream @ ..] = bytes else {
        return false;
    };
    let protocol = SkinProtocol::ALL[usize::from(*kind) % SkinProtocol::ALL.len()];
    let taxels = 1 + usize::from(*kind) / SkinProtocol::ALL.len() % 64;
    let config = SerialConfig::new(protocol);
    let mut decoder = SkinDecoder::new(&config, taxels);
    let mut values = vec![glam::DVec3::NAN; taxels];
    for read in stream.chunks(1 + usize::from(*piece)) {
        decoder.feed(read);
        while let Some(frame) = decoder.next_frame(&mut values) {
            assert!(frame.first_byte < decoder.stream_bytes());
            assert!(
                values
                    .iter()
                    .all(|value| value.is_nan() || value.is_finite())
            );
        }
    }
    let framed = decoder.frames() * config.frame_bytes(taxels) as u64;
    assert!(framed + decoder.skipped_bytes() <= stream.len() as u64);
    decoder.frames() > 0
}

/// A valid taxel layout round-trips, and the table after a line of `---` is read to its end: forces are finite or
/// `None`, and rows are counted.
pub fn taxels(bytes: &[u8]) -> bool {
    const LINE: &[u8] = b"\n---\n";
    let place = bytes.windows(LINE.len()).position(|window| window == LINE);
    let (text_of, table) = match place {
        Some(place) => (&bytes[..place], &bytes[place + LINE.len()..]),
        None => (bytes, &[][..]),
    };
    let Some(layout) = text(text_of).and_then(|text| TaxelLayout::from_toml(text).ok()) else {
        return false;
    };
    let written = layout
        .to_toml()
        .expect("a layout that was read can be written");
    let again = TaxelLayout::from_toml(&written).expect("what was written can be read");
    assert_eq!(layout, again);
    let Ok(mut sensor) = TaxelSensor::open(table, &layout, None) else {
        return false;
    };
    let mut frame = TactileFrame::unloaded(sensor.element_count());
    let mut frames = 0;
    loop {
        match sensor.read(&mut frame) {
            Ok(()) => frames += 1,
            Err(SensorError::Ended { count }) => {
                assert_eq!(count, frames);
                return true;
            }
            // The first row reveals a mismatch between table and header.
            Err(SensorError::Table(_)) if frames == 0 => return false,
            Err(error) => panic!("bytes can be read: {error}"),
        }
        assert!(frame.stamp.is_finite());
        let mut forces = frame.forces.iter();
        assert!(forces.all(|force| force.is_finite() || force.is_nan()));
    }
}

/// A valid policy returns finite velocities for any reading.
pub fn policy(bytes: &[u8]) -> bool {
    let Ok(model) = PolicyModel::from_bytes(bytes) else {
        return false;
    };
    let mut touch = TactileReading::none(model.elements());
    let mut policy = Policy::new(Arc::new(model));
    let layout = ElementLayout {
        dome_radius: 0.018,
        elements: Vec::new(),
    };
    let plan = Plan {
        reflex: true,
        ..Plan::default()
    };
    for size in [0.0, 1e-3, 1.0, -1e9, f64::MAX] {
        touch.frame.forces.fill(DVec3::splat(size));
        let sense = FingerReadings {
            pose: FingertipPose::default(),
            joints: JointState {
                position: JointVector::splat(3, size),
                velocity: JointVector::splat(3, -size),
            },
            touch: &touch,
            layout: &layout,
        };
        let velocity = policy.velocity(&plan, &sense);
        assert!(velocity.is_finite(), "{size}: {velocity}");
    }
    true
}

/// Valid loads are finite and on existing elements.
pub fn loads(bytes: &[u8]) -> bool {
    const ELEMENTS: usize = 3;
    let seen = [0.0, 10.0, 20.0].map(|column| ProjectedElement {
        centre_px: DVec2::new(column, 0.0),
        x_angle: column,
    });
    let Ok(pictures) = read_loads(bytes, &seen, ForceAxes::default()) else {
        return false;
    };
    for picture in &pictures {
        assert_eq!(picture.forces.len(), ELEMENTS);
        assert!(
            picture
                .forces
                .iter()
                .flatten()
                .all(|force| force.is_finite())
        );
    }
    true
}

/// The number of pixels of a valid image matches its size.
pub fn picture(bytes: &[u8]) -> bool {
    let Ok(picture) = decode_picture(bytes) else {
        return false;
    };
    assert_eq!(picture.pixels.len(), picture.width * picture.height);
    true
}

/// The values of a valid experiment round-trip through its text.
pub fn experiment(bytes: &[u8]) -> bool {
    let read = |text: &str| Experiment::parse(text, "fuzz", &[], None).ok();
    let Some(experiment) = text(bytes).and_then(read) else {
        return false;
    };
    let again = read(&experiment.toml).expect("the text of an experiment can be read");
    assert_eq!(experiment.config, again.config);
    true
}

/// A recording is complete if and only if it has no problem, and it plays back to its end.
pub fn recording(bytes: &[u8]) -> bool {
    let Ok(recording) = Recording::from_bytes(bytes) else {
        return false;
    };
    assert_eq!(recording.complete, recording.problem.is_none());
    assert_eq!(recording.fingers.len(), recording.facts.fingers);
    assert!(recording.readable_until.is_finite());
    play_back(&recording);
    look_again(&recording, bytes);
    true
}

/// Cameras return all recorded images or an error that names the missing one.
fn look_again(recording: &Recording, bytes: &[u8]) {
    for (finger, recorded) in recording.fingers.iter().enumerate() {
        let mut camera = RecordedCamera::new(Cursor::new(bytes), recording, finger);
        let mut frame = Frame::black(4, 3);
        let mut seen = 0;
        let end = loop {
            match camera.capture(&mut frame) {
                Ok(()) => seen += 1,
                Err(end) => break end,
            }
        };
        if let CameraError::Ended { count } = end {
            assert_eq!((count, seen), (seen, recorded.tactile.len() as u64));
        }
    }
}

/// Sensors and hand return all recorded readings or describe the mismatch.
fn play_back(recording: &Recording) {
    for (finger, recorded) in recording.fingers.iter().enumerate() {
        let mut sensor = RecordedSensor::new(recording, finger);
        let mut reading = TactileFrame::unloaded(sensor.element_count());
        let mut read = 0;
        let end = loop {
            match sensor.read(&mut reading) {
                Ok(()) => read += 1,
                Err(end) => break end,
            }
        };
        match end {
            SensorError::Ended { count } => {
                assert_eq!((count, read), (read, recorded.tactile.len() as u64));
            }
            // Frames of different lengths.
            SensorError::ElementCount { expected, actual } => assert_ne!(expected, actual),
            other => panic!("expected no camera or image error, got {other}"),
        }
    }
    let mut hand = RecordedHand::new(recording);
    let mut state = HandState::zero(hand.finger_count());
    let shortest = recording.fingers.iter().map(|f| f.joints.len()).min();
    for _ in 0..shortest.unwrap_or(0) {
        hand.read(&mut state).expect("a state of every finger");
    }
    let end = hand.read(&mut state);
    assert!(recording.fingers.is_empty() || end.is_err(), "{state:?}");
}

/// A hand, a rig and a sensor program of two elements never store non-finite values or wrong sizes from any messages.
///
/// The bytes are messages: topic (index in [`Topic::all`]), length (2 bytes, little endian) and content, in which an
/// echoed token of 0 is replaced by the hand's token.
pub fn link(bytes: &[u8]) -> bool {
    let expected = agreeing();
    let clock = RunClock::new(RigSpeed::Times(1.0), 0.01, 3.5);
    let mut hand = HandInbox::new(&[2], clock, expected.clone());
    let mut rig = RigInbox::new((1, 2), 0.045, expected.clone());
    let longer = Expected {
        joints: JointCounts::new([5]),
        ..expected.clone()
    };
    let mut longer = RigInbox::new((1, 2), 0.045, longer);
    let mut sense = SenseInbox::new(0, 2, (3, 2), expected);
    // A stop to resume.
    hand.holds.order(1, "operator");
    let (mut now, mut bytes, mut sound) = (0.0, bytes, false);
    let topics = Topic::all(0);
    for (place, introduction) in introductions() {
        for inbox in [
            &mut hand as &mut dyn Inbox,
            &mut rig,
            &mut longer,
            &mut sense,
        ] {
            let taken = inbox.take(Topic::Heartbeat(place), &introduction, now);
            taken.expect("a heartbeat of a program that agrees");
        }
    }
    while let [topic, low, high, rest @ ..] = bytes {
        let topic = topics[usize::from(*topic) % topics.len()];
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
        let (message, rest) = rest.split_at(length);
        let mut message = message.to_vec();
        (now, bytes) = (now + 0.01, rest);
        let step = hand.sent.newest() + 1;
        hand.sent.sent(step, now);
        fill_in_token(&hand, &mut message);
        for inbox in [
            &mut hand as &mut dyn Inbox,
            &mut rig,
            &mut longer,
            &mut sense,
        ] {
            sound |= inbox.take(topic, &message, now).is_ok();
            assert!(inbox.peers().all().len() <= MAX_PEERS);
        }
        check_hand(&mut hand, now);
        for (rig, joints) in [(&mut rig, 3), (&mut longer, 5)] {
            rig.time = now;
            let drive = rig.drive(now, 0.045).unwrap_or_default();
            let sound = |velocity: &JointVector| velocity.len() == joints && velocity.is_finite();
            assert!(drive.iter().all(sound));
        }
        let _ = sense.take_next().map(|exposed| exposed.header());
        let _ = sense.echo_at(now);
    }
    sound
}

/// Replaces a token of 0 in a message's header by the hand's token of the echoed step.
fn fill_in_token(hand: &HandInbox, message: &mut [u8]) {
    // After four bytes of encapsulation: protocol, instance, clock, sequence and stamp of eight bytes each.
    let Some((head, [token @ .., _, _, _, _, _, _, _, _])) = message
        .get_mut(4 + 40..4 + 64)
        .and_then(|m| m.split_first_chunk_mut::<8>())
    else {
        return;
    };
    if token.iter().all(|byte| *byte == 0) {
        let step = u64::from_le_bytes(*head);
        token.copy_from_slice(&hand.sent.token(step).to_le_bytes());
    }
}

/// The first heartbeats of a hand, a world and a sensor program, whose instances are 1, 2 and 3.
fn introductions() -> [(ProgramRole, Vec<u8>); 3] {
    let programs = [
        (ProgramRole::Hand, "hand", NO_FINGER),
        (ProgramRole::World, "world", NO_FINGER),
        (ProgramRole::Sense(0), "sense", 0),
    ];
    let mut instance = 0;
    programs.map(|(place, program, finger)| {
        instance += 1;
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance,
            program: program.into(),
            finger,
            sequence: 1,
            ..Heartbeat::default()
        };
        let mut bytes = Vec::new();
        cdr::encode(&heartbeat, &mut bytes).expect("a heartbeat's bytes");
        (place, bytes)
    })
}

/// Asserts that the hand's data are complete, finite and not from the future.
fn check_hand(hand: &mut HandInbox, now: f64) {
    let _ = hand.stale(now, 0.035);
    assert!((0.0..=2e10).contains(&hand.state().time), "{now} s");
    assert!(hand.time_of(0) >= 0.0);
    assert!(hand.holds.in_force().len() <= 16);
    let (state, mut fingers) = hand.ages(now);
    assert!(state >= 0.0 && fingers.all(|age| age >= 0.0), "{now} s");
    for update in hand.fingers().iter().filter_map(|f| f.newest.as_ref()) {
        assert_eq!((update.forces.len(), update.shear_rate.len()), (2, 2));
        let forces = update.forces.iter().flat_map(|f| [f.x, f.y, f.z]);
        assert!(forces.chain([update.grasp_force]).all(f64::is_finite));
    }
    if let Some(state) = &hand.state().newest {
        let joints = state.position.iter().chain(&state.velocity);
        let joints: Vec<_> = joints.flat_map(|j| [j.x, j.y, j.z]).collect();
        assert_eq!(joints.len(), 6);
        assert!(joints.into_iter().all(f64::is_finite));
    }
}

/// Any packet of the stop protocol round-trips or is rejected.
pub fn stop_wire(bytes: &[u8]) -> bool {
    let Some(datagram) = parse_datagram(bytes) else {
        return false;
    };
    assert_eq!(parse_datagram(&datagram.bytes()), Some(datagram));
    true
}

/// Any message of a ROS 2 graph is read or rejected; the first byte selects its kind.
pub fn ros2(bytes: &[u8]) -> bool {
    let Some((kind, bytes)) = bytes.split_first() else {
        return false;
    };
    let parameters = Parameters::new("they are fixed");
    match kind {
        b'j' => cdr::decode(bytes).is_ok_and(|message| {
            let names = ["a", "b", "c"].map(String::from).to_vec();
            let mut reader = JointReader::new(vec![names]).expect("a finger");
            reader.read(&message, &mut HandState::zero(1)).is_ok()
        }),
        b'c' => cdr::decode(bytes)
            .is_ok_and(|cloud| feeler_ros2::read_forces(&cloud, &mut [DVec3::ZERO; 2]).is_ok()),
        b't' => cdr::decode(bytes).is_ok_and(|array: TactileArray| {
            let _ = (to_wrench(&array), to_recorded(&array));
            to_cloud(&array).is_ok_and(|cloud| from_cloud(&cloud).is_ok())
        }),
        b'p' => cdr::decode(bytes).is_ok_and(|cloud| from_cloud(&cloud).is_ok()),
        b'a' => Attachment::decode(bytes).is_ok(),
        b'l' => cdr::decode::<ListParametersRequest>(bytes)
            .is_ok_and(|request| parameters.list(&request).result.names.is_empty()),
        b's' => cdr::decode::<SetParametersRequest<false>>(bytes).is_ok_and(|request| {
            let results = parameters.set(&request.parameters).results;
            results.iter().all(|result| !result.successful)
        }),
        _ => false,
    }
}

/// For any messages between known programs, a hand's time never goes back, and the hand stays stopped until each stop
/// has been resumed.
///
/// The bytes are steps of eight: event, field to modify, and added value.
pub fn inboxes(bytes: &[u8]) -> bool {
    let clock = RunClock::new(RigSpeed::Times(1.0), 0.01, 3.5);
    let mut hand = HandInbox::new(&[2], clock, agreeing());
    for (place, introduction) in introductions() {
        let taken = hand.take(Topic::Heartbeat(place), &introduction, 0.0);
        taken.expect("a heartbeat of a program that agrees");
    }
    let (mut now, mut sequence, mut time, mut stopped) = (0.0, 0_u64, 0.0, Vec::new());
    let mut sound = false;
    for step in bytes.chunks_exact(8) {
        let [what, field, low, high, mantissa @ ..] = step else {
            continue;
        };
        let added = i64::from(i16::from_le_bytes([*low, *high]));
        let odd = f64::from(f32::from_le_bytes(mantissa.try_into().expect("four bytes")));
        now += 0.001 * f64::from(what >> 3);
        sequence += 1;
        let newest = hand.sent.newest() + 1;
        hand.sent.sent(newest, now);
        let mut header = honest(&hand, sequence, now);
        spoil(&mut header, field % 8, added, odd);
        match what % 8 {
            0..=2 => sound |= take(&mut hand, Topic::State, &state_of(header), now),
            3..=5 => sound |= take(&mut hand, Topic::Tactile(0), &update_of(header), now),
            6 => {
                let (protocol, from, id) = (PROTOCOL, "fuzz".to_string(), added.unsigned_abs() + 1);
                let before = hand.holds.newest();
                take(
                    &mut hand,
                    Topic::Stop,
                    &StopMessage { protocol, from, id },
                    now,
                );
                if hand.holds.newest() > before {
                    stopped.push(hand.holds.newest());
                }
            }
            _ => {
                let (protocol, from, number) = (PROTOCOL, "fuzz".to_string(), u64::from(*field));
                let resume = ResumeMessage {
                    protocol,
                    from,
                    number,
                };
                if take(&mut hand, Topic::Resume, &resume, now) {
                    stopped.retain(|stop| *stop != number);
                }
            }
        }
        // Beyond the number of distinct stops, the newest represents the others.
        let is_stopped = !hand.holds.in_force().is_empty();
        assert!(is_stopped || stopped.is_empty(), "{stopped:?} at {now} s");
        if !is_stopped {
            stopped.clear();
        }
        assert!(
            hand.state().time >= time,
            "{time} s, then {} s",
            hand.state().time
        );
        time = hand.state().time;
        check_hand(&mut hand, now);
    }
    sound
}

fn agreeing() -> Expected {
    Expected {
        fingertips: vec![String::new()],
        ..Expected::default()
    }
}

/// Header of the rig, whose clock is 5 s ahead.
fn honest(hand: &HandInbox, sequence: u64, now: f64) -> MessageHeader {
    let step = hand.sent.newest();
    let echo = Echo {
        step,
        token: hand.sent.token(step),
        arrived: now,
    };
    header(2, sequence, now + 5.0).echoing(echo, now)
}

/// Modifies one field of a header.
fn spoil(header: &mut MessageHeader, field: u8, added: i64, odd: f64) {
    let whole = |number: u64| number.wrapping_add_signed(added);
    match field {
        1 => header.instance = whole(header.instance),
        2 => header.clock = whole(header.clock),
        3 => header.sequence = whole(header.sequence),
        4 => header.stamp += odd,
        5 => header.echo_step = whole(header.echo_step),
        6 => header.echo_token = whole(header.echo_token),
        7 => header.echo_age += odd,
        _ => {}
    }
}

fn take<M: Message>(hand: &mut HandInbox, topic: Topic, message: &M, now: f64) -> bool {
    let mut bytes = Vec::new();
    cdr::encode(message, &mut bytes).expect("a message's bytes");
    hand.take(topic, &bytes, now).is_ok()
}

fn state_of(header: MessageHeader) -> StateMessage {
    StateMessage {
        header,
        position: vec![Vector3::default()],
        velocity: vec![Vector3::default()],
        ..StateMessage::default()
    }
}

fn update_of(header: MessageHeader) -> TactileUpdate {
    TactileUpdate {
        header: MessageHeader {
            instance: header.instance.wrapping_add(1),
            ..header
        },
        forces: vec![Vector3::default(); 2],
        shear_rate: vec![0.0; 2],
        slip_mask: vec![0],
        invalid_mask: vec![0],
        ..TactileUpdate::default()
    }
}

fn text(bytes: &[u8]) -> Option<&str> {
    from_utf8(bytes).ok()
}

/// Packets on a bus of servos round-trip; the first byte selects sender and protocol.
pub fn drives_bus(bytes: &[u8]) -> bool {
    let [how, bytes @ ..] = bytes else {
        return false;
    };
    let protocol = if how & 1 == 0 {
        Protocol::Dynamixel
    } else {
        Protocol::Feetech
    };
    let sender = if how & 2 == 0 {
        Sender::Master
    } else {
        Sender::Servo
    };
    let (mut decoder, mut again) = (
        Decoder::new(protocol, sender),
        Decoder::new(protocol, Sender::Master),
    );
    let (mut written, mut sound) = (Vec::new(), false);
    let mut rest = bytes;
    while !rest.is_empty() {
        let taken = decoder.feed(rest);
        assert!(taken > 0, "there is room once all packets are read");
        rest = &rest[taken..];
        while let Some(packet) = decoder.next() {
            let Ok(packet) = packet else { continue };
            sound = true;
            assert!(fast_blocks(packet.parameters, 8).all(|block| block.data.len() == 8));
            if encode(
                protocol,
                (packet.id, packet.code),
                packet.parameters,
                &mut written,
            )
            .is_ok()
            {
                again.clear();
                again.feed(&written);
                assert_eq!(again.next(), Some(Ok(packet)));
            }
        }
        assert!(complete_blocks(decoder.pending(), 8) <= LONGEST);
    }
    sound
}
