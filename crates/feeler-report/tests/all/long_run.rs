//! Recordings read in parts, compared with the same recordings in memory.

use crate::support;
use feeler_record::{Recorder, Recording};
use feeler_report::measures::CapMeasures;
use feeler_report::run::{make, page_of, read, read_within};
use feeler_report::{RunData, Summary, tasks};
use std::fs;
use std::path::{Path, PathBuf};

/// Memory (bytes) for 4 to 7 thousand rows of two fingers: all of 20 strokes, or four strokes in a quarter.
const MEMORY: usize = 18 << 20;
/// Number of rows of a stroke.
const STROKE: usize = 300;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Recording of `strokes` strokes on a rig with all instruments.
fn long(name: &str, strokes: u32) -> PathBuf {
    long_on(support::SIMULATED, name, strokes)
}

fn long_on(rig: support::Rig, name: &str, strokes: u32) -> PathBuf {
    let path = folder("long-run").join(name);
    let recorder = Recorder::create(&path, &support::facts(), support::EXPERIMENT);
    let mut recorder = recorder.expect("a recorder");
    support::write_strokes_on(&mut recorder, strokes, rig).expect("strokes");
    recorder.finish(Some(0.25)).expect("a recording");
    path
}

fn in_memory(path: &Path) -> (Recording, RunData) {
    let recording = Recording::read(path).expect("a recording");
    let data = RunData::new(&recording);
    (recording, data)
}

/// Formats data with all digits, so that NaN compares equal to itself.
fn text(data: &impl std::fmt::Debug) -> String {
    format!("{data:?}")
}

#[test]
fn a_run_of_ordinary_length_reads_like_one_in_memory() {
    let path = folder("long-run").join("feeling.mcap");
    let feeling = support::Rig {
        feels: true,
        torque_from: Some(2.0),
        ..support::SIMULATED
    };
    for rig in [support::SIMULATED, support::REAL, feeling] {
        support::write_run_on(&path, rig).expect("a run");
        let mut shares = Vec::new();
        let (recording, data) = read(&path, &mut |share| shares.push(share)).expect("a run");
        let (whole, expected) = in_memory(&path);
        assert_eq!(text(&data), text(&expected));
        assert_eq!(recording.digest, whole.digest);
        assert_eq!(recording.end, whole.end);
        assert!(recording.complete && data.thinned.is_none());
        let kept = recording.task.len();
        assert!(
            kept < whole.task.len() * 2 / 3,
            "expected fewer task rows in memory, got {kept}"
        );
        assert!(shares.len() > 2 && shares.is_sorted() && shares.iter().all(|s| *s <= 1.0));
    }
}

#[test]
fn a_report_equals_the_page_of_the_recording_in_memory() {
    for share in [1.0, 0.7, 0.31] {
        let folder = folder("long-run-page");
        let path = folder.join("recording.mcap");
        support::write_run(&path, 4).expect("a run");
        let bytes = fs::read(&path).expect("bytes");
        let length = (share * bytes.len() as f64) as usize;
        fs::write(&path, &bytes[..length]).expect("a file");
        let made = make(&folder).expect("a report");
        let page = fs::read_to_string(&made.report_path).expect("a page");
        let recording = Recording::read(&path).expect("a recording");
        assert!(page == page_of(&recording), "with {share} of the file");
        let summary = Summary::new(&recording, &RunData::new(&recording));
        assert_eq!(made.summary.strokes, summary.strokes);
        assert_eq!(made.problem, recording.problem);
    }
}

/// Claims and measures of a long run are computed from all of its rows and bit-identical, though few rows are kept.
#[test]
fn measures_of_a_long_run_equal_those_in_memory() {
    let path = long("forty.mcap", 40);
    let (whole, expected) = in_memory(&path);
    let (recording, data) = read_within(&path, MEMORY, &mut |_| {}).expect("a run");
    let thinned = data.thinned.as_ref().expect("a long run");
    assert_eq!(thinned.rows, expected.time.len());
    assert!(
        data.time.len() < expected.time.len() / 2,
        "{}",
        data.time.len()
    );
    assert_eq!(thinned.too_long, [0; 0]);
    let summary = Summary::new(&recording, &data);
    assert_eq!(text(&summary), text(&Summary::new(&whole, &expected)));
    let claims = |recording: &_, data: &RunData| {
        tasks::of(&support::facts()).claims(recording, data, &data.stroke_measures())
    };
    assert_eq!(
        text(&claims(&recording, &data)),
        text(&claims(&whole, &expected))
    );
    assert!(data.time.is_sorted());
    let kept = data.strokes.iter().filter(|s| s.whole);
    assert_eq!(kept.map(|s| s.rows.len()).collect::<Vec<_>>(), [STROKE; 4]);
}

/// The run is long enough that findings are thinned, too.
#[test]
fn findings_of_a_long_run_are_measured_as_in_memory() {
    let feeling = support::Rig {
        feels: true,
        torque_from: Some(2.0),
        ..support::SIMULATED
    };
    let path = long_on(feeling, "seventy.mcap", 70);
    let (whole, expected) = in_memory(&path);
    let (recording, data) = read_within(&path, MEMORY, &mut |_| {}).expect("a run");
    assert!(recording.findings.len() < whole.findings.len() / 2);
    let felt = CapMeasures::new(&recording, &data).expect("what was felt");
    assert_eq!(felt.strokes.len(), 70);
    assert!(felt.strokes.iter().all(|s| s.felt_torque.is_some()));
    assert_eq!(Some(felt), CapMeasures::new(&whole, &expected));
    let summary = Summary::new(&recording, &data);
    assert_eq!(text(&summary), text(&Summary::new(&whole, &expected)));
}

#[test]
fn peaks_of_a_long_run_are_kept_in_its_columns() {
    let path = long("peaks.mcap", 40);
    let (_, whole) = in_memory(&path);
    let (_, data) = read_within(&path, MEMORY, &mut |_| {}).expect("a run");
    // In spans of ten seconds, each longer than a cell.
    let greatest = |data: &RunData, column: &[f64]| {
        let mut greatest = vec![f64::MIN; 13];
        for (time, value) in data.time.iter().zip(column) {
            let span = &mut greatest[(time / 10.0) as usize];
            *span = span.max(*value);
        }
        greatest
    };
    let torque = |data: &RunData| data.torque.clone().expect("a torque");
    assert_eq!(
        greatest(&data, &torque(&data)),
        greatest(&whole, &torque(&whole))
    );
    for (kept, all) in data.fingers.iter().zip(&whole.fingers) {
        for column in [
            |f: &feeler_report::FingerColumns| f.grasp_force.clone(),
            |f: &feeler_report::FingerColumns| f.shear_rate.clone(),
        ] {
            assert_eq!(
                greatest(&data, &column(kept)),
                greatest(&whole, &column(all))
            );
        }
    }
    // Kept rows are unchanged.
    for (row, time) in data.time.iter().enumerate() {
        let place = whole.time.binary_search_by(|t| t.total_cmp(time));
        let place = place.expect("the same row");
        assert_eq!(data.fingers[1].forces[row], whole.fingers[1].forces[place]);
        assert_eq!(data.fingers[1].frames[row], whole.fingers[1].frames[place]);
    }
}

/// With memory for a thousand rows, no stroke relevant to claims fits its share, and an overlong stroke is measured by
/// its maximum.
#[test]
fn claims_that_exceed_the_memory_are_not_measured() {
    let path = long("narrow.mcap", 30);
    let (whole, expected) = in_memory(&path);
    let (recording, data) = read_within(&path, 0, &mut |_| {}).expect("a run");
    let thinned = data.thinned.as_ref().expect("a long run");
    assert!(data.time.len() <= 1_000, "{}", data.time.len());
    assert!(data.strokes.iter().all(|stroke| !stroke.whole));
    let summary = Summary::new(&recording, &data);
    let of_all = Summary::new(&whole, &expected);
    for (stroke, expected) in summary.strokes.iter().zip(&of_all.strokes) {
        assert_eq!(stroke.peak_element_force, expected.peak_element_force);
        assert_eq!(stroke.peak_grasp_force, expected.peak_grasp_force);
        assert_eq!(stroke.cap_turn, expected.cap_turn);
        match thinned.too_long.contains(&stroke.index) {
            true => assert_eq!(stroke.mean_grasp_force, None),
            false => assert_eq!(stroke, expected),
        }
    }
    for (claim, of_all) in summary.claims.iter().zip(&of_all.claims) {
        match claim.id {
            "four-peaks" | "no-damage" => assert_eq!(claim, of_all),
            _ => assert!(claim.value.is_none(), "{claim:?}"),
        }
    }
}
