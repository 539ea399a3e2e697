//! A recording in the browser.

use super::viewed::{SLOWLY, Viewed, page_data};
use crate::program::{folder, run, whole_run};
use std::fs;

#[test]
fn a_recording_is_shown_as_its_report() {
    let folder = folder("view-recording");
    let made = whole_run(&folder);
    let report = fs::read_to_string(made.join("report.html")).expect("a report");
    fs::remove_file(made.join("report.html")).expect("the report");
    for what in ["run", "run/recording.mcap"] {
        let viewed = Viewed::start(&folder, &["view", what]);
        let data = viewed.data();
        assert_eq!(data, page_data(&report));
        assert!(data["live"].is_null());
        assert_eq!(viewed.interrupt().status, Some(0));
    }
    // No file is written next to the recording.
    assert!(!made.join("report.html").exists());
    let refused = run(&folder, &["view", "run", "--seed=1", "--no-open"]);
    refused.refused(&["--seed requires a rig", "got the recording run"]);
}

#[test]
fn recording_link_serves_only_that_file() {
    let folder = folder("view-download");
    let made = whole_run(&folder);
    let recorded = fs::read(made.join("recording.mcap")).expect("a recording");
    // The page uses the same link for any file name.
    fs::copy(made.join("recording.mcap"), folder.join("other.mcap")).expect("a copy");
    let viewed = Viewed::start(&folder, &["view", "other.mcap"]);
    assert!(viewed.page().contains(r#"href="recording.mcap""#));
    let (host, path) = (format!("Host: {}", viewed.host()), viewed.path());
    let link = format!("GET {path}recording.mcap");
    let (status, head, body) = viewed.ask_bytes(&link, &[&host]);
    assert_eq!(status, 200);
    let head = head.to_lowercase();
    assert!(
        head.contains("content-type: application/octet-stream"),
        "{head}"
    );
    assert!(
        head.contains(&format!("content-length: {}", recorded.len())),
        "{head}"
    );
    assert!(body == recorded, "{} bytes", body.len());
    for other in [
        "other.mcap",
        "summary.json",
        "run/recording.mcap",
        "../other.mcap",
    ] {
        let (status, _, body) = viewed.ask(&format!("GET {path}{other}"), &[&host]);
        assert_eq!(status, 404, "{other}: {body}");
    }
    let without_token = viewed.ask("GET /recording.mcap", &[&host]);
    assert_eq!(without_token.0, 403);
    let (status, _, body) = viewed.ask(&link, &[&host, "Origin: http://evil.example"]);
    assert_eq!(status, 403, "{body}");
    fs::remove_file(folder.join("other.mcap")).expect("the recording");
    let (status, _, body) = viewed.ask(&link, &[&host]);
    assert!(status == 404 && body.contains("other.mcap"), "{body}");
    viewed.interrupt();
}

#[test]
fn unfinished_recording_is_not_served() {
    let viewed = Viewed::run(&folder("view-no-download"), &[SLOWLY]);
    let (host, path) = (format!("Host: {}", viewed.host()), viewed.path());
    let (status, _, body) = viewed.ask(&format!("GET {path}recording.mcap"), &[&host]);
    assert!(
        status == 404 && body.contains("still being written"),
        "{body}"
    );
    assert_eq!(viewed.interrupt().status, Some(1));
}
