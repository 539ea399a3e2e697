//! Message values as decoded and encoded by rclpy.

use super::peers::{Running, Words, python, script};
use feeler_record::ros::{
    Header, JointState, PointCloud2, PointField, Text, Time, Wrench, WrenchStamped,
};
use feeler_record::wire::{Message, Vector3, cdr};
use feeler_ros2::message::*;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::Stdio;

fn header() -> Header {
    Header {
        stamp: Time { sec: 3, nanosec: 4 },
        frame_id: "finger_0_dome".into(),
    }
}

fn vector(x: f64) -> Vector3 {
    Vector3 {
        x,
        y: x + 1.0,
        z: x + 2.0,
    }
}

/// Checks rclpy's answer for one message.
type Judge = Box<dyn Fn(&serde_json::Value)>;

/// Messages for rclpy, with the checks of its answers.
#[derive(Default)]
struct Questions {
    lines: String,
    judges: Vec<Judge>,
}

impl Questions {
    fn ask<M: Message + PartialEq + std::fmt::Debug + 'static>(&mut self, message: M) {
        let mut bytes = Vec::new();
        cdr::encode(&message, &mut bytes).expect("bytes");
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        writeln!(self.lines, "{} {digits}", M::SCHEMA_NAME).expect("text");
        self.judges.push(Box::new(move |answer| {
            let mut values = serde_json::to_value(&message).expect("values");
            // rclpy does not report this field.
            let fields = values.as_object_mut().expect("fields");
            fields.remove("structure_needs_at_least_one_member");
            assert_eq!(answer["values"], values, "{}", M::SCHEMA_NAME);
            let digits = answer["bytes"].as_str().expect("digits");
            let bytes: Vec<u8> = (0..digits.len() / 2)
                .map(|i| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).expect("a byte"))
                .collect();
            assert_eq!(cdr::decode::<M>(&bytes).expect("a message"), message);
        }));
    }
}

fn questions() -> Questions {
    let mut all = Questions::default();
    all.ask(JointState {
        header: header(),
        name: vec!["a".into(), "bcd".into()],
        position: vec![0.5, -0.25],
        velocity: vec![1.5, 2.5],
        effort: Vec::new(),
    });
    let wrench = Wrench {
        force: vector(0.5),
        torque: vector(-4.5),
    };
    all.ask(WrenchStamped {
        header: header(),
        wrench,
    });
    all.ask(PointCloud2 {
        header: header(),
        height: 1,
        width: 2,
        fields: vec![PointField {
            name: "fx".into(),
            offset: 4,
            datatype: 7,
            count: 1,
        }],
        is_bigendian: false,
        point_step: 3,
        row_step: 6,
        data: vec![1, 2, 3, 4, 5, 6],
        is_dense: true,
    });
    all.ask(Text {
        data: "<robot/>".into(),
        stamp: 0.0,
    });
    all.ask(Clock {
        clock: header().stamp,
    });
    all.ask(Float64MultiArray {
        layout: MultiArrayLayout {
            dim: vec![MultiArrayDimension {
                label: "joint".into(),
                size: 2,
                stride: 3,
            }],
            data_offset: 1,
        },
        data: vec![0.5, 1.5],
    });
    let value = KeyValue {
        key: "phase".into(),
        value: "MOVE".into(),
    };
    all.ask(DiagnosticArray {
        header: header(),
        status: vec![DiagnosticStatus {
            level: DiagnosticLevel::Stale as u8,
            name: "feeler: hand".into(),
            message: "well".into(),
            hardware_id: "rig".into(),
            values: vec![value],
        }],
    });
    all.ask(TriggerRequest::default());
    all.ask(TriggerResponse {
        success: true,
        message: "done".into(),
    });
    services(&mut all);
    all
}

/// Adds parameter requests and responses.
fn services(all: &mut Questions) {
    let value = ParameterValue {
        r#type: 3,
        bool_value: true,
        integer_value: -7,
        double_value: 0.5,
        string_value: "text".into(),
        byte_array_value: vec![1],
        bool_array_value: vec![true, false],
        integer_array_value: vec![2],
        double_array_value: vec![1.5],
        string_array_value: vec!["a".into(), "b".into()],
    };
    all.ask(ListParametersRequest {
        prefixes: vec!["control".into()],
        depth: 2,
    });
    let result = ListParametersResult {
        names: vec!["a.b".into()],
        prefixes: vec!["a".into()],
    };
    all.ask(ListParametersResponse { result });
    all.ask(NamesRequest::<0> {
        names: vec!["a".into()],
    });
    all.ask(GetParametersResponse {
        values: vec![value.clone()],
    });
    let parameters = vec![Parameter {
        name: "a".into(),
        value,
    }];
    all.ask(SetParametersRequest::<false> {
        parameters: parameters.clone(),
    });
    all.ask(SetParametersRequest::<true> { parameters });
    let results = vec![SetParametersResult {
        successful: false,
        reason: "fixed".into(),
    }];
    all.ask(SetParametersResponse { results });
    all.ask(DescribeParametersResponse {
        descriptors: vec![ParameterDescriptor {
            name: "a".into(),
            r#type: 3,
            description: "b".into(),
            additional_constraints: "c".into(),
            read_only: true,
            dynamic_typing: false,
            floating_point_range: vec![FloatingPointRange {
                from_value: 0.5,
                to_value: 1.5,
                step: 0.25,
            }],
            integer_range: vec![IntegerRange {
                from_value: -1,
                to_value: 2,
                step: 3,
            }],
        }],
    });
}

#[test]
fn rclpy_decodes_and_encodes_the_messages_identically() {
    let Some(python) = python(
        "FEELER_ROS_PYTHON",
        "import rclpy.serialization, sensor_msgs.msg, diagnostic_msgs.msg, std_srvs.srv",
    ) else {
        return;
    };
    let questions = questions();
    let rclpy = script(&python, "values.py", &[])
        .stdin(Stdio::piped())
        .spawn();
    let mut rclpy = Running(rclpy.expect("rclpy"));
    let mut words = Words::of(&mut rclpy);
    let mut input = rclpy.0.stdin.take().expect("its input");
    input
        .write_all(questions.lines.as_bytes())
        .expect("the questions");
    drop(input);
    for judge in &questions.judges {
        judge(&words.next());
    }
}
