//! The report that a run writes directly equals the report made from its recording.

use feeler::pace::FreeRunning;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::recorded_run::RecordedRun;
use feeler_report::run::make;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("runs")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Files of the report in `folder`, by name.
fn report(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let figures = fs::read_dir(folder.join("figures")).expect("figures");
    let names = figures.map(|file| file.expect("a figure").path());
    let others = ["report.html", "summary.json"].map(|name| folder.join(name));
    names
        .chain(others)
        .map(|path| (path.display().to_string(), fs::read(path).expect("a file")))
        .collect()
}

/// Runs experiment `name`, interrupted after `interrupted_after` steps, and compares its report with the report made
/// from its recording. Returns the run's folder.
fn check(name: &str, settings: &[&str], pictures: bool, interrupted_after: usize) -> PathBuf {
    let settings: Vec<_> = settings.iter().map(|s| s.to_string()).collect();
    let experiment = Experiment::load(name, &settings).expect("an experiment");
    let folder = folder(&format!("{name}-{}", settings.len()));
    let run = RecordedRun::new(&experiment, pictures, &folder).expect("a run");
    let (interrupted, mut steps) = (AtomicBool::new(false), 0);
    let finished = run.run(&mut FreeRunning::default(), &interrupted, |_, _, _| {
        steps += 1;
        interrupted.store(steps == interrupted_after, Ordering::Relaxed);
        None
    });
    let own = finished.expect("a report").report;
    let files = report(&folder);
    assert!(files.len() > 2);
    let of_recording = make(&folder).expect("a report");
    assert_eq!(format!("{of_recording:?}"), format!("{own:?}"));
    for (name, content) in report(&folder) {
        assert!(files.get(&name) == Some(&content), "{name} differs");
    }
    folder
}

/// The selection of rows of a long run does not depend on the batch size: three rows while recording, thousands when
/// reading.
#[test]
fn a_long_runs_report_equals_its_recordings() {
    let settings = [
        "sensing=direct",
        "task.screw.strokes=60",
        "time_limit=300.0",
    ];
    let folder = check("cap-closing", &settings, false, usize::MAX);
    let page = fs::read_to_string(folder.join("report.html")).expect("a page");
    assert!(page.contains("This is a long run"));
}

#[test]
fn a_runs_report_equals_its_recordings() {
    check("cap-closing", &["sensing=direct"], false, usize::MAX);
    check("three-fingers", &["sensing=direct"], false, 700);
    check("lift", &["sensing=direct"], false, usize::MAX);
    check("contour", &["sensing=direct"], false, 900);
    check("cap-until-closed", &["sensing=direct"], false, 1500);
    check("friction-scan", &["sensing=image"], false, 200);
    check("slide-box-two", &["sensing=image"], true, 40);
}
