//! Reports of a recording that is not called recording.mcap.

use crate::program::{document, folder, run, summary};
use std::fs;

#[test]
fn renamed_recording_is_reported_next_to_it() {
    let folder = folder("named-recording");
    let arguments = [
        "run",
        "cap-closing",
        "--sensing=direct",
        "--set=time_limit=2",
        "--out=x",
    ];
    let _ = run(&folder, &arguments);
    let of_run = summary(&folder.join("x"));
    for name in ["z.mcap", "x/copy.of.it.mcap", "plain"] {
        fs::copy(folder.join("x/recording.mcap"), folder.join(name)).expect("a copy");
    }
    fs::create_dir(folder.join("here")).expect("a folder");
    fs::rename(folder.join("z.mcap"), folder.join("here/z.mcap")).expect("a recording");
    for (name, report, link) in [
        ("here/z.mcap", "here/z", "../z.mcap"),
        ("x/copy.of.it.mcap", "x/copy.of.it", "../copy.of.it.mcap"),
        ("plain", "plain-report", "../plain"),
        ("x/recording.mcap", "x", "recording.mcap"),
    ] {
        let said = run(&folder, &["report", name]).done();
        assert!(said.contains(&format!("{report}/report.html")), "{said}");
        assert_eq!(summary(&folder.join(report)), of_run);
        let page = document(&folder.join(report).join("report.html"));
        assert!(page.contains(&format!("href=\"{link}\"")), "{name}");
    }
    // The report of another run is not overwritten.
    fs::copy(folder.join("here/z.mcap"), folder.join("x.mcap")).expect("a copy");
    run(&folder, &["report", "x.mcap"]).refused(&["x.mcap", "another run", "rename"]);
    // Neither is an unrelated page.
    fs::copy(folder.join("here/z.mcap"), folder.join("page.mcap")).expect("a copy");
    fs::create_dir(folder.join("page")).expect("a folder");
    fs::write(folder.join("page/report.html"), "precious").expect("a file");
    run(&folder, &["report", "page.mcap"]).refused(&["page.mcap", "report.html", "rename"]);
    let page = fs::read_to_string(folder.join("page/report.html"));
    assert_eq!(page.expect("a file"), "precious");
    // The report of the same recording is replaced.
    run(&folder, &["report", "here/z.mcap"]).done();
    fs::write(folder.join("no.mcap"), "no recording").expect("a file");
    run(&folder, &["report", "no.mcap"]).refused(&["no.mcap", "magic bytes"]);
    assert!(!folder.join("no").exists());
}
