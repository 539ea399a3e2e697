//! Messages between programs decode to the encoded values, and their encoding matches their ROS 2 message texts.

use feeler_link::messages::message::{
    CommandMessage, DirectForces, HandMode, Heartbeat, InstrumentsMessage, MessageHeader,
    PictureMessage, ResumeMessage, StateMessage, StopInForce, StopMessage, TactileUpdate,
};
use feeler_record::wire::{Message, Quaternion, Vector3, cdr};
use proptest::prelude::*;
use proptest::{bits, collection::vec};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fmt::Debug;

/// Fields (type, name) of each type in a message text, by type name. The message's own type is "".
type Types<'a> = HashMap<&'a str, Vec<(&'a str, &'a str)>>;

/// Parses a ROS 2 message text, without its constants.
fn parse(schema: &str) -> Types<'_> {
    let mut types = Types::from([("", Vec::new())]);
    let mut current = "";
    for line in schema.lines() {
        let line = line.split('#').next().unwrap().trim();
        if let Some(name) = line.strip_prefix("MSG: ") {
            current = name;
            let before = types.insert(name, Vec::new());
            assert!(before.is_none(), "{name} is defined twice");
        } else if !line.is_empty() && !line.starts_with("====") && !line.contains('=') {
            let (kind, name) = line.split_once(' ').expect("a type and a name");
            types.get_mut(current).unwrap().push((kind, name.trim()));
        }
    }
    types
}

/// Decodes CDR with only a message text.
struct Walker<'a> {
    types: Types<'a>,
    body: &'a [u8],
    at: usize,
}

impl Walker<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        self.at = self.at.next_multiple_of(N);
        let bytes = self.body[self.at..self.at + N].try_into().unwrap();
        self.at += N;
        bytes
    }

    fn value(&mut self, kind: &str) -> Value {
        if let Some(kind) = kind.strip_suffix("[]") {
            let count = u32::from_le_bytes(self.bytes());
            return (0..count).map(|_| self.value(kind)).collect();
        }
        if let Some((kind, length)) = kind.strip_suffix(']').and_then(|k| k.split_once('[')) {
            let count: usize = length.parse().expect("a length");
            return (0..count).map(|_| self.value(kind)).collect();
        }
        match kind {
            "bool" => match self.bytes() {
                [0_u8] => json!(false),
                [1] => json!(true),
                other => panic!("{other:?} is not a bool"),
            },
            "uint8" => json!(u8::from_le_bytes(self.bytes())),
            "int32" => json!(i32::from_le_bytes(self.bytes())),
            "uint32" => json!(u32::from_le_bytes(self.bytes())),
            "uint64" => json!(u64::from_le_bytes(self.bytes())),
            "float64" => json!(f64::from_le_bytes(self.bytes())),
            "string" => {
                let length = u32::from_le_bytes(self.bytes()) as usize;
                let text = &self.body[self.at..self.at + length];
                self.at += length;
                let (end, text) = text.split_last().expect("the text's end");
                assert_eq!(*end, 0);
                json!(str::from_utf8(text).unwrap())
            }
            nested => self.fields(nested),
        }
    }

    fn fields(&mut self, name: &str) -> Value {
        let fields = self.types.get(name);
        let fields = fields.unwrap_or_else(|| panic!("no text of {name}"));
        let mut read = Map::new();
        for (kind, name) in fields.clone() {
            let value = self.value(kind);
            read.insert(name.into(), value);
        }
        Value::Object(read)
    }
}

/// Checks that `message` decodes to itself, and that its text decodes to the same fields by name.
fn check<M: Message + PartialEq + Debug>(message: &M) {
    let mut bytes = Vec::new();
    cdr::encode(message, &mut bytes).unwrap();
    assert_eq!(cdr::decode::<M>(&bytes).unwrap(), *message);
    let mut walker = Walker {
        types: parse(M::SCHEMA),
        body: &bytes[4..],
        at: 0,
    };
    let read = walker.fields("");
    assert_eq!(walker.at, walker.body.len(), "{}", M::SCHEMA_NAME);
    let told = serde_json::to_value(message).unwrap();
    assert_eq!(read, told, "{}", M::SCHEMA_NAME);
    for shorter in 0..bytes.len() {
        assert!(cdr::decode::<M>(&bytes[..shorter]).is_err(), "{shorter}");
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop::num::f64::NORMAL
}

fn vector() -> impl Strategy<Value = Vector3> {
    [(); 3]
        .map(|()| number())
        .prop_map(|[x, y, z]| Vector3 { x, y, z })
}

prop_compose! {
    fn header()(
        protocol: u32, [instance, clock, sequence, echo_step, echo_token] in any::<[u64; 5]>(),
        stamp in number(), echo_age in number(),
    ) -> MessageHeader {
        MessageHeader { protocol, instance, clock, sequence, stamp, echo_step, echo_token, echo_age }
    }
}

prop_compose! {
    fn stop()([number, id] in any::<[u64; 2]>(), by: String) -> StopInForce {
        StopInForce { number, id, by }
    }
}

prop_compose! {
    fn instruments()(
        [torque, bridge_voltage, cap_angle, cap_torque] in [number(), number(), number(), number()],
        counts: i32, cap_centre in vector(), slipped in [(); 5].map(|()| number()),
        has_object: bool, object_position in vector(), [x, y, z, w] in [(); 4].map(|()| number()),
    ) -> InstrumentsMessage {
        InstrumentsMessage {
            torque, bridge_voltage, counts, cap_angle, cap_centre, cap_torque, slipped, has_object, object_position,
            object_orientation: Quaternion { x, y, z, w },
        }
    }
}

proptest! {
    #[test]
    fn tactile_updates(
        header in header(), finger: u32, frame: u64, flags in bits::u8::between(0, 3),
        largest_element: u32, grasp_force in number(), forces in vec(vector(), 0..5),
        shear_rate in vec(number(), 0..5), slip_mask: Vec<u8>, invalid_mask: Vec<u8>,
    ) {
        let [touch, slip, over] = [1, 2, 4].map(|bit| flags & bit != 0);
        check(&TactileUpdate {
            header, finger, frame, touch, slip, over, largest_element, grasp_force, forces, shear_rate,
            slip_mask, invalid_mask,
        });
    }

    #[test]
    fn images_and_forces(
        header in header(), [finger, width, height] in any::<[u32; 3]>(), frame: u64, pixels: Vec<u8>,
        forces in vec(vector(), 0..5),
    ) {
        check(&PictureMessage { header, finger, frame, width, height, pixels });
        check(&DirectForces { header, finger, frame, forces });
    }

    #[test]
    fn hands(
        header in header(), [search, r#move] in any::<[bool; 2]>(), phase: u8, stroke: u32,
        stopped: String, [token, state_sequence] in any::<[u64; 2]>(), stops in vec(stop(), 0..3), joint_velocity in vec(vector(), 0..4),
        position in vec(vector(), 0..4), velocity in vec(vector(), 0..4), effort in vec(vector(), 0..4),
        effort_uncertainty in vec(vector(), 0..4), instruments in vec(instruments(), 0..3),
    ) {
        check(&HandMode { header, token, search, r#move, phase, stroke, stopped, stops });
        check(&CommandMessage { header, token, state_sequence, joint_velocity });
        check(&StateMessage { header, position, velocity, effort, effort_uncertainty, instruments });
    }

    #[test]
    fn heartbeats_and_orders(
        [protocol, finger] in any::<[u32; 2]>(),
        [instance, sequence, lost, refused, missed] in any::<[u64; 5]>(),
        [program, version, experiment, fingertip, fault] in any::<[String; 5]>(),
        [rate, age, speed] in [number(), number(), number()],
    ) {
        let from = fault.clone();
        check(&Heartbeat {
            protocol, instance, program: program.into(), version, finger, experiment, fingertip, sequence, rate, age, lost,
            refused, missed, speed, fault,
        });
        check(&StopMessage { protocol, from: from.clone(), id: lost });
        check(&ResumeMessage { protocol, from, number: lost });
    }
}

/// Checks the walker itself, which must detect two swapped fields.
#[test]
#[should_panic(expected = "left == right")]
fn swapped_fields_are_detected() {
    #[derive(Debug, PartialEq, serde::Serialize, serde::Deserialize)]
    struct Swapped {
        first: u32,
        second: u32,
    }
    impl Message for Swapped {
        const SCHEMA_NAME: &'static str = "feeler_msgs/msg/Swapped";
        const SCHEMA: &'static str = "uint32 second  # text\nuint32 first\n";
    }
    let (first, second) = (1, 2);
    check(&Swapped { first, second });
}
