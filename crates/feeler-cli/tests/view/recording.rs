//! A recording in the browser.

use crate::program::{folder, run, whole_run};
use crate::viewed::{Viewed, page_data};
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
    // Nothing is written beside it.
    assert!(!made.join("report.html").exists());
    let refused = run(&folder, &["view", "run", "--seed=1", "--no-open"]);
    refused.refused(&["--seed is for a rig", "run is a recording"]);
}
