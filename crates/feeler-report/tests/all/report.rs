//! Report of a synthetic run: complete, self-contained and explicit about missing data.

use crate::support;
use feeler_report::ReportError;
use feeler_report::run::make;
use std::fs;
use std::path::{Path, PathBuf};

/// Separate run directory with a recording of `strokes` strokes.
fn run(name: &str, strokes: u32) -> PathBuf {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("report")
        .join(name);
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    support::write_run(&directory.join("recording.mcap"), strokes).unwrap();
    directory
}

/// A page without its script and data, as displayed without JavaScript.
pub fn document(page: &str) -> String {
    let (first, rest) = page.split_once("<script").unwrap_or((page, ""));
    let scripts = rest.split("<script");
    let after = scripts.filter_map(|script| Some(script.split_once("</script>")?.1));
    [first].into_iter().chain(after).collect()
}

/// Truncates the recording in a run's directory to a share of its bytes.
fn cut(directory: &Path, share: f64) {
    let path = directory.join("recording.mcap");
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..(share * bytes.len() as f64) as usize]).unwrap();
}

const FIGURES: [&str; 7] = [
    "fig-08", "fig-09", "fig-10", "fig-11", "fig-12", "fig-13", "fig-14",
];

#[test]
fn a_complete_run_gives_every_figure_in_the_page_and_as_a_file() {
    let directory = run("whole", 4);
    let outcome = make(&directory).unwrap();
    assert!(outcome.complete);
    assert_eq!(outcome.claims().len(), 11);
    let page = fs::read_to_string(&outcome.report_path).unwrap();
    assert!(!page.contains("INCOMPLETE"));
    assert!(page.contains("All 11 claims of the paper pass."));
    assert!(page.contains("Hand: 8 of 8 pass"));
    assert!(page.contains("Hand, bottle and torque sensor: 3 of 3 pass"));
    for figure in FIGURES {
        let svg = fs::read_to_string(directory.join(format!("figures/{figure}.svg"))).unwrap();
        assert!(page.contains(&svg), "{figure} is not in the page");
        assert!(svg.len() < 300_000, "{figure} has {} bytes", svg.len());
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{figure}");
        let document = roxmltree::Document::parse(&svg).unwrap();
        let root = document.root_element();
        assert!(root.has_attribute("viewBox"));
        let title = root
            .children()
            .find(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "title")));
        assert!(title.is_some_and(|title| !title.text().unwrap_or("").is_empty()));
    }
    assert!(fs::read_dir(&directory).unwrap().all(|entry| {
        !entry
            .unwrap()
            .file_name()
            .to_string_lossy()
            .ends_with(".part")
    }));
}

#[test]
fn the_page_fetches_nothing_and_its_ids_are_unique() {
    let directory = run("self-contained", 4);
    let page = fs::read_to_string(make(&directory).unwrap().report_path).unwrap();
    let page = document(&page);
    for fetch in ["<link", "<img", "src=", "@import", "url(h", "url(\""] {
        assert!(!page.contains(fetch), "{fetch}");
    }
    // Links that a reader may follow.
    let links: Vec<_> = page.split("href=\"").skip(1).collect();
    assert!(
        links
            .iter()
            .all(|link| link.starts_with("recording.mcap\""))
    );
    let mut ids: Vec<_> = page
        .split(" id=\"")
        .skip(1)
        .filter_map(|s| s.split('"').next())
        .collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}

#[test]
fn text_from_the_recording_is_escaped() {
    let directory = run("escaped", 1);
    let page = fs::read_to_string(make(&directory).unwrap().report_path).unwrap();
    assert!(page.contains("made up &lt;&amp;&gt; \\&quot;quoted\\&quot;"));
    assert!(!page.contains("made up <&>"));
}

#[test]
fn the_same_recording_gives_the_same_report() {
    let directory = run("repeated", 4);
    let first = fs::read(make(&directory).unwrap().report_path).unwrap();
    let second = fs::read(make(&directory).unwrap().report_path).unwrap();
    assert!(first == second);
}

#[test]
fn the_report_of_a_damaged_recording_is_marked_incomplete() {
    let directory = run("damaged", 4);
    make(&directory).unwrap();
    cut(&directory, 0.6);
    let outcome = make(&directory).unwrap();
    assert!(!outcome.complete && outcome.problem.is_some());
    let page = fs::read_to_string(&outcome.report_path).unwrap();
    assert!(page.contains("<title>INCOMPLETE: "));
    assert!(page.contains("INCOMPLETE: readable up to t = "));
    assert!(page.contains("Not in this recording."));
    // The figure of stroke 4 of the complete run is removed.
    assert!(!directory.join("figures/fig-11.svg").exists());
    assert!(directory.join("figures/fig-08.svg").exists());
    let summary = fs::read_to_string(&outcome.summary_path).unwrap();
    assert!(summary.contains("\"state\": \"interrupted\""));
    assert!(!outcome.claims()[2].holds);
}

#[test]
fn recordings_of_any_length_give_a_report_or_a_clear_error() {
    let directory = run("any-length", 2);
    let whole = fs::read(directory.join("recording.mcap")).unwrap();
    for step in 0..25 {
        let bytes = &whole[..whole.len() * step / 25];
        fs::write(directory.join("recording.mcap"), bytes).unwrap();
        match make(&directory) {
            Ok(outcome) => assert!(!outcome.complete),
            Err(error) => assert!(error.to_string().contains("nothing readable"), "{error}"),
        }
    }
}

#[test]
fn a_run_without_messages_gives_a_report_without_figures() {
    let directory = run("empty", 0);
    let page = fs::read_to_string(make(&directory).unwrap().report_path).unwrap();
    assert_eq!(
        page.matches("Not in this recording.").count(),
        FIGURES.len()
    );
}

#[test]
fn without_a_recording_nothing_is_written() {
    let directory = run("without", 0);
    fs::remove_file(directory.join("recording.mcap")).unwrap();
    assert!(matches!(make(&directory), Err(ReportError::Recording(_))));
    assert_eq!(fs::read_dir(&directory).unwrap().count(), 0);
}
