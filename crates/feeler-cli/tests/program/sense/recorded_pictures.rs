//! Images that are recorded with the sensed data, and sensed again.

use super::rendered::{CALIBRATION, pictures, save};
use crate::program::{folder, run};
use std::fs;
use std::path::Path;

/// Senses with `arguments`, asserts success, and returns the table.
fn sensed(folder: &Path, source: &str, arguments: &[&str]) -> String {
    let output = ["-o", "out.csv", "--force"];
    let ended = run(
        folder,
        &[&["sense", source], arguments, &output[..]].concat(),
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    fs::read_to_string(folder.join("out.csv")).unwrap()
}

/// Records the images of the folder `pictures` to `name`.
fn record(folder: &Path, name: &str, arguments: &[&str]) {
    let record = ["sense", "pictures", "--record-frames", "-o", name];
    let ended = run(folder, &[&record[..], arguments].concat());
    assert_eq!(ended.status, Some(0), "{ended:?}");
}

#[test]
fn recorded_images_are_sensed_again_bit_identically() {
    let folder = folder("sense-record-frames");
    save(&pictures(6), &folder.join("pictures"));
    run(&folder, &["locate", "pictures/frame0.png", "-o", "l.toml"]).done();
    let calibrated = ["--calibration", CALIBRATION];
    record(&folder, "plain.mcap", &["--unloaded", "4"]);
    record(&folder, "calibrated.mcap", &calibrated);
    let of_picture = ["--layout", "l.toml", "--reference", "pictures/frame0.png"];
    let tracked = ["--layout", "l.toml", "--track"];
    record(&folder, "tracked.mcap", &tracked);
    let ways: [&[&str]; 5] = [
        &[],
        &calibrated,
        &["--layout", "l.toml"],
        &of_picture,
        &tracked,
    ];
    for arguments in ways {
        let expected = sensed(&folder, "pictures", arguments);
        for recording in ["plain.mcap", "calibrated.mcap", "tracked.mcap"] {
            let found = sensed(&folder, recording, arguments);
            assert!(found == expected, "{recording} {arguments:?}");
        }
    }
    // From one recording to another.
    let again = ["sense", "plain.mcap", "--record-frames", "-o", "again.mcap"];
    assert_eq!(run(&folder, &again).status, Some(0));
    assert_eq!(
        sensed(&folder, "again.mcap", &calibrated),
        sensed(&folder, "pictures", &calibrated)
    );
}

#[test]
fn images_are_recorded_on_the_topics_of_viewers() {
    let folder = folder("sense-record-topic");
    let pictures = pictures(3);
    save(&pictures, &folder.join("pictures"));
    for (arguments, topic) in [
        (&[][..], "/finger/0/image"),
        (&["--finger", "1"][..], "/finger/1/image"),
    ] {
        record(&folder, "out.mcap", &[arguments, &["--force"]].concat());
        let file = fs::read(folder.join("out.mcap")).unwrap();
        let messages = mcap::MessageStream::new(&file).unwrap().map(Result::unwrap);
        let images: Vec<_> = messages.filter(|m| m.channel.topic == topic).collect();
        assert_eq!(images.len(), pictures.len());
        for (image, loaded) in images.iter().zip(&pictures) {
            let schema = image.channel.schema.as_ref().unwrap();
            assert_eq!(schema.name, "sensor_msgs/msg/CompressedImage");
            let image: feeler_record::ros::CompressedImage =
                feeler_record::wire::cdr::decode(&image.data).unwrap();
            let decoded = feeler_sources::decode_picture(&image.data).unwrap();
            assert_eq!((image.format.as_str(), &decoded), ("png", &loaded.picture));
        }
        assert_eq!(
            sensed(&folder, "out.mcap", arguments).lines().count(),
            1 + 3 * 41
        );
    }
}

#[test]
fn recordings_without_complete_images_are_reported() {
    let folder = folder("sense-record-cut");
    save(&pictures(10), &folder.join("pictures"));
    record(&folder, "whole.mcap", &["--calibration", CALIBRATION]);
    let bytes = fs::read(folder.join("whole.mcap")).unwrap();
    fs::write(folder.join("cut.mcap"), &bytes[..bytes.len() * 3 / 4]).unwrap();
    let sense = ["sense", "cut.mcap", "--calibration", CALIBRATION];
    let cut = run(&folder, &[&sense[..], &["-o", "cut.csv"]].concat());
    cut.refused(&["cut.mcap", "incomplete", "cut.csv.part is partial"]);
    let kept = fs::read_to_string(folder.join("cut.csv.part")).unwrap();
    let whole = sensed(&folder, "pictures", &["--calibration", CALIBRATION]);
    assert!(kept.lines().count() > 41 && whole.starts_with(&kept));

    let plain = ["sense", "pictures", "-o", "plain.mcap"];
    assert_eq!(run(&folder, &plain).status, Some(0));
    run(&folder, &["sense", "plain.mcap"])
        .refused(&["plain.mcap: contains no images", "--record-frames"]);
}

#[test]
fn images_are_recorded_only_to_mcap() {
    let folder = folder("sense-record-refused");
    save(&pictures(1), &folder.join("pictures"));
    let cases: [(&[&str], &[&str]); 4] = [
        (
            &["-o", "out.csv"],
            &["--record-frames", "expected -o FILE.mcap", "out.csv"],
        ),
        (&["-o", "out.jsonl"], &["--record-frames", "out.jsonl"]),
        (&[], &["--record-frames", "standard output"]),
        (
            &["--taxels=uskin-4x4", "-o", "out.mcap"],
            &["--record-frames", "taxels have no images"],
        ),
    ];
    for (arguments, words) in cases {
        let all = [&["sense", "pictures", "--record-frames"], arguments].concat();
        run(&folder, &all).refused(words);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    // An input is not overwritten.
    record(&folder, "x.mcap", &[]);
    let onto_itself = [
        "sense",
        "x.mcap",
        "--record-frames",
        "--force",
        "-o",
        "x.mcap",
    ];
    run(&folder, &onto_itself).refused(&["x.mcap", "the file is an input"]);
}
