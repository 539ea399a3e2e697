//! Third-party sensors as fingertips, with messages published by pyzeros.

use super::client::until;
use super::peers::{Running, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use feeler::sensor::forces::{TactileFrame, TactileSensor};
use feeler_record::ros::{PointCloud2, PointField};
use feeler_ros2::{GraphClock, Node, NodeConfig, NodeName, RosSensor, SensorAge};
use glam::DVec3;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{ChildStdin, Stdio};
use std::time::Duration;

/// Maximum age of data (s), longer than a busy computer delays a message.
const MAX_AGE: f64 = 30.0;

/// A node with a connected third-party sensor.
struct Bench {
    node: Node,
    input: ChildStdin,
    _publisher: Running,
}

impl Bench {
    fn start(python: &str) -> Self {
        let endpoint = unused_endpoint();
        let node = Node::open(NodeConfig {
            name: NodeName::new(0, "/", "feeler_sensor").expect("a name"),
            connect: Vec::new(),
            listen: vec![endpoint.clone()],
        });
        let publisher = script(python, "sensor.py", &[&endpoint])
            .stdin(Stdio::piped())
            .spawn();
        let mut publisher = Running(publisher.expect("a sensor"));
        assert_eq!(Words::of(&mut publisher).next()["ready"], true);
        Self {
            node: node.expect("a node"),
            input: publisher.0.stdin.take().expect("its input"),
            _publisher: publisher,
        }
    }

    /// Publishes `message` with an age of `late` seconds until `sensor` receives it, and returns the frame.
    fn read(
        &mut self,
        sensor: &mut RosSensor,
        message: &Value,
        late: f64,
    ) -> Result<TactileFrame, String> {
        let mut frame = TactileFrame::unloaded(sensor.element_count());
        // Skip earlier messages.
        let _ = sensor.read(&mut frame);
        let (before, mut told) = (frame.sequence, message.clone());
        told["late"] = json!(late);
        until("a message", || {
            writeln!(self.input, "{told}").expect("a message");
            sensor
                .wait_for_next(before, Duration::from_millis(100))
                .then_some(())
        });
        let measured = sensor
            .read_measured(&mut frame)
            .map_err(|e| e.to_string())?;
        // The measurement is at least as old as its stamp.
        assert!(measured.elapsed().as_secs_f64() >= late.max(0.0) - 1e-3);
        Ok(frame)
    }
}

fn age() -> SensorAge {
    SensorAge {
        clock: GraphClock::TimeOfDay,
        most: MAX_AGE,
        speed: 1.0,
    }
}

#[test]
fn wrench_is_read_as_the_force_of_a_single_element() {
    let Some(python) = pyzeros() else { return };
    let mut bench = Bench::start(&python);
    let mut sensor = RosSensor::wrench(&mut bench.node, "/wrench", age()).expect("a sensor");
    let nothing = sensor
        .read(&mut TactileFrame::unloaded(1))
        .expect_err("nothing")
        .to_string();
    assert!(
        nothing.contains("/wrench: no message received yet"),
        "{nothing}"
    );

    // A pressing force points inward, against z.
    let pressed = json!({ "force": [0.25, -0.5, -2.0] });
    let old = bench
        .read(&mut sensor, &pressed, 2.0 * MAX_AGE)
        .expect_err("old");
    assert!(old.contains("by their stamp"), "{old}");
    for late in [5.0, 0.0] {
        let frame = bench.read(&mut sensor, &pressed, late).expect("a force");
        assert_eq!(frame.forces, [DVec3::new(0.25, -0.5, 2.0)]);
    }
    // A NaN force is returned as invalid; the controller rejects it.
    let unknown = json!({ "force": ["nan", 0.0, 0.0] });
    let frame = bench.read(&mut sensor, &unknown, 0.0).expect("a frame");
    assert!(frame.forces[0].is_nan());
    let ahead = bench
        .read(&mut sensor, &pressed, -2.0 * MAX_AGE)
        .expect_err("ahead");
    assert!(ahead.contains("ahead of the clock"), "{ahead}");
    let two = sensor
        .read(&mut TactileFrame::unloaded(2))
        .expect_err("two")
        .to_string();
    assert!(two.contains('2') && two.contains('1'), "{two}");
}

/// A cloud of 64-bit values in an unusual field order, with an unused field and padding. The forces press with 1 N and
/// 2 N.
fn cloud() -> PointCloud2 {
    let names = ["fz", "intensity", "fy", "fx", "z", "y", "x"];
    let field = |(place, name): (usize, &&str)| PointField {
        name: (*name).into(),
        offset: 8 * place as u32 + 4,
        datatype: 8,
        count: 1,
    };
    // Element 0 faces along x, element 1 along z.
    let points = [
        [0.0, 9.0, 0.0, -1.0, 0.0, 0.0, 0.02],
        [-2.0, 9.0, 0.0, 0.0, 0.02, 0.0, 0.0],
    ];
    let bytes = points.iter().flat_map(|point| {
        let numbers = point.iter().flat_map(|number: &f64| number.to_le_bytes());
        [0xff; 4].into_iter().chain(numbers).chain([0xff; 4])
    });
    PointCloud2 {
        height: 1,
        width: 2,
        fields: names.iter().enumerate().map(field).collect(),
        is_bigendian: false,
        point_step: 64,
        row_step: 128,
        data: bytes.collect(),
        is_dense: true,
        ..PointCloud2::default()
    }
}

#[test]
fn clouds_of_any_layout_are_read_and_invalid_ones_refused() {
    let Some(python) = pyzeros() else { return };
    let mut bench = Bench::start(&python);
    let mut sensor = RosSensor::cloud(&mut bench.node, "/cloud", 2, age()).expect("a sensor");
    let told = |cloud: &PointCloud2| json!({ "cloud": cloud });
    let frame = bench
        .read(&mut sensor, &told(&cloud()), 0.0)
        .expect("forces");
    for (force, normal) in frame.forces.iter().zip([1.0, 2.0]) {
        assert!(force.abs_diff_eq(DVec3::Z * normal, 1e-12), "{frame:?}");
    }
    let wrong = |change: fn(&mut PointCloud2)| {
        let mut cloud = cloud();
        change(&mut cloud);
        told(&cloud)
    };
    let refused = [
        (wrong(|cloud| cloud.is_bigendian = true), "little-endian"),
        (wrong(|cloud| cloud.width = 3), "a cloud of 2 points"),
        (
            wrong(|cloud| cloud.data.truncate(100)),
            "128 bytes, got 100",
        ),
        (wrong(|cloud| cloud.point_step = 0), "field"),
        (wrong(|cloud| cloud.fields[0].datatype = 2), "field fz"),
        (wrong(|cloud| cloud.fields[6].name = "u".into()), "field x"),
        (wrong(|cloud| cloud.fields[0].offset = 60), "field fz"),
    ];
    for (message, words) in refused {
        let error = bench.read(&mut sensor, &message, 0.0).expect_err(words);
        assert!(error.contains(words) && error.contains("/cloud"), "{error}");
        // The next valid message is accepted.
        bench
            .read(&mut sensor, &told(&cloud()), 0.0)
            .expect("forces");
    }
}
