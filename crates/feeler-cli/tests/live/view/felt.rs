//! Rumble and tone that a page reports.

use super::viewed::{Viewed, next_row};
use crate::program::{folder, summary};
use feeler_record::Recording;
use tungstenite::Message;

#[test]
fn recording_contains_what_the_page_played() {
    let folder = folder("view-felt");
    let viewed = Viewed::beside_alone(&folder, "--speed=0.2");
    let mut socket = viewed.socket();
    let (time, _) = next_row(&mut socket);
    let report = |strong: &str| {
        let rest = r#""weak":0.5,"frequency":440,"gain":0.25"#;
        Message::text(format!(
            r#"{{"felt":{{"time":{time},"strong":{strong},{rest}}}}}"#
        ))
    };
    for strong in ["0.75", "2", "-1", "null"] {
        socket.send(report(strong)).expect("a report");
    }
    while socket.read().is_ok() {}
    viewed.wait();
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    assert!(recording.complete, "{:?}", recording.problem);
    let (first, rest) = recording.felt.split_first().expect("silence");
    assert!(first.is_silent());
    let (played, rest) = rest.split_first().expect("the report");
    assert!(played.stamp >= time);
    let values = [
        played.data_stamp,
        played.rumble_strong,
        played.rumble_weak,
        played.tone_frequency,
        played.tone_gain,
    ];
    assert_eq!(values, [time, 0.75, 0.5, 440.0, 0.25]);
    // The page did not report any more.
    let [last] = rest else {
        panic!("{rest:?}");
    };
    assert!(last.is_silent() && last.stamp > played.stamp);
    let digest = |name: &str| summary(&folder.join(name))["digest"].clone();
    assert!(digest("run").is_string());
    assert_eq!(digest("run"), digest("alone"));
}
