//! Rows sent over the socket.

use super::viewed::{Viewed, next_row};
use crate::program::folder;
use feeler_record::Recording;
use serde_json::Value;

/// Index of the first value of a column in a row, not counting the time.
fn place(data: &Value, name: &str) -> usize {
    let columns = data["run"]["columns"].as_array().expect("columns");
    let before = columns[1..]
        .iter()
        .take_while(|column| column["name"] != name);
    before
        .map(|column| column["width"].as_u64().expect("a width") as usize)
        .sum()
}

#[test]
fn rows_equal_the_recording() {
    let folder = folder("view-rows");
    let viewed = Viewed::run(&folder, &["--speed=0.5"]);
    let data = viewed.data();
    assert_eq!(data["live"]["orders"], true);
    assert_eq!(data["run"]["rows"], 0);
    let width: u64 = data["run"]["columns"]
        .as_array()
        .expect("columns")
        .iter()
        .map(|column| column["width"].as_u64().expect("a width"))
        .sum();
    let mut socket = viewed.socket();
    let rows: Vec<_> = (0..40).map(|_| next_row(&mut socket)).collect();
    for pair in rows.windows(2) {
        assert!(pair[0].0 < pair[1].0, "time does not increase");
    }
    drop(socket);
    assert_eq!(viewed.interrupt().status, Some(1));
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    for (time, numbers) in &rows {
        assert_eq!(numbers.len() as u64, width - 1);
        for (finger, record) in recording.fingers.iter().enumerate() {
            let joints = record
                .joints
                .iter()
                .find(|joints| (joints.stamp - time).abs() < 1e-9);
            let place = place(&data, &format!("finger/{finger}/joints"));
            let recorded = joints.expect("joints").position;
            let recorded: Vec<_> = recorded.iter().map(|angle| angle as f32).collect();
            assert_eq!(numbers[place..place + 3], recorded[..], "at {time}");
            let flags = record
                .flags
                .iter()
                .find(|flags| (flags.stamp - time).abs() < 1e-9);
            let grasp = numbers[self::place(&data, &format!("finger/{finger}/grasp_force"))];
            assert_eq!(grasp, flags.expect("flags").grasp_force as f32, "at {time}");
        }
        let torque = recording
            .torque_sensor
            .iter()
            .find(|at| (at.stamp - time).abs() < 1e-9);
        let torque = torque.expect("torque").torque as f32;
        assert_eq!(numbers[self::place(&data, "torque")], torque, "at {time}");
    }
}
