//! Figures of a synthetic screw task: their content, any number of fingers, and irregular data.

use crate::support;
use feeler_record::Recording;
use feeler_report::figures::{Figure, paths, radius, time};
use feeler_report::run::RunData;
use glam::DVec3;
use std::fs;
use std::path::PathBuf;

/// Synthetic run of four strokes in a separate directory.
fn run(name: &str) -> RunData {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("figures")
        .join(name);
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    let path = directory.join("recording.mcap");
    support::write_run(&path, 4).unwrap();
    RunData::new(&Recording::read(&path).unwrap())
}

fn all(data: &RunData) -> Vec<Figure> {
    vec![
        time::grasp_force_and_torque(data),
        time::shear_rate_and_torque(data),
        time::stroke_in_detail(data, 10, 1),
        time::stroke_in_detail(data, 11, 4),
        paths::before_closing(data),
        paths::after_closing(data),
        radius::over_travel(data),
    ]
}

/// All text in a figure's SVG.
fn texts(figure: &Figure) -> Vec<String> {
    let svg = figure.svg.as_ref().expect("a picture");
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document
        .descendants()
        .filter(|node| node.has_tag_name("text"));
    texts
        .map(|node| node.text().unwrap_or("").to_string())
        .collect()
}

fn count(figure: &Figure, text: &str) -> usize {
    texts(figure).iter().filter(|found| *found == text).count()
}

/// Copy of `data` with `count` fingers, by repeating the first two.
fn with_fingers(data: &RunData, count: usize) -> RunData {
    let mut data = data.clone();
    let two = data.clone();
    let again = |k: usize| k % 2;
    data.fingers = (0..count).map(|k| two.fingers[again(k)].clone()).collect();
    let facts = &two.facts;
    data.facts.approach = (0..count).map(|k| facts.approach[again(k)]).collect();
    data.facts.stroke_direction = (0..count)
        .map(|k| facts.stroke_direction[again(k)])
        .collect();
    data
}

#[test]
fn slip_is_plotted_above_true_slip_if_known() {
    let mut data = run("slip");
    let detail = time::stroke_in_detail(&data, 11, 4);
    assert_eq!(
        (count(&detail, "SLIP"), count(&detail, "true slip")),
        (2, 2)
    );
    let whole = time::shear_rate_and_torque(&data);
    assert_eq!(count(&whole, "SLIP"), 0);
    for finger in &mut data.fingers {
        finger.slipped.fill(None);
    }
    let unknown = time::stroke_in_detail(&data, 11, 4);
    assert_eq!(
        (count(&unknown, "SLIP"), count(&unknown, "true slip")),
        (2, 0)
    );
}

/// Distance from the path's end to the arc's, relative to the planned line's, in the last panel of a figure.
fn off_the_arc(figure: &Figure) -> f64 {
    let document = roxmltree::Document::parse(figure.svg.as_ref().unwrap()).unwrap();
    let lines = document
        .descendants()
        .filter(|node| node.attribute("fill") == Some("none"));
    let end = |points: &str| -> f64 {
        let (_, y) = points.trim().rsplit_once(' ').unwrap();
        y.parse().unwrap()
    };
    let ends: Vec<f64> = lines
        .filter_map(|node| node.attribute("d").map(end))
        .collect();
    let [.., path, line, arc] = ends[..] else {
        panic!("expected a path, a line and an arc, got {ends:?}");
    };
    (path - arc) / (line - arc)
}

#[test]
fn the_closed_stroke_is_drawn_on_the_arc_and_the_first_on_the_line() {
    let data = run("arc");
    // The synthetic paths have 10 % and 95 % of the arc's curvature; line and arc start at a quarter of the travel.
    let [first, .., fourth] = support::BENDS;
    let (first_off, fourth_off) = (
        off_the_arc(&paths::before_closing(&data)),
        off_the_arc(&paths::after_closing(&data)),
    );
    assert!((first_off - (1.0 - first)).abs() < 0.05, "{first_off}");
    assert!((fourth_off - (1.0 - fourth)).abs() < 0.05, "{fourth_off}");
}

#[test]
fn strokes_one_and_four_have_the_same_axes() {
    let data = run("axes");
    let (first, fourth) = (paths::before_closing(&data), paths::after_closing(&data));
    assert_eq!(texts(&first), texts(&fourth));
}

#[test]
fn the_radius_of_every_stroke_is_drawn_for_every_finger() {
    let figure = radius::over_travel(&run("radius"));
    for stroke in 1..=4 {
        assert_eq!(count(&figure, &format!("stroke {stroke}")), 1);
    }
    for finger in 0..2 {
        assert_eq!(count(&figure, &format!("finger {finger}")), 1);
    }
}

#[test]
fn any_number_of_fingers_gives_complete_figures() {
    let data = run("fingers");
    for fingers in 1..=5 {
        for figure in all(&with_fingers(&data, fingers)) {
            let svg = figure.svg.as_ref().expect("a picture");
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            assert!(svg.len() < 300_000, "{} bytes", svg.len());
            let last = format!("finger {}", fingers - 1);
            assert_eq!(count(&figure, &last), 1, "figure {}", figure.number);
        }
    }
}

#[test]
fn figures_omit_curves_without_data() {
    let whole = run("odd");
    let spoil: [fn(&mut RunData); 9] = [
        |data| data.fingers.clear(),
        |data| data.facts.stroke_direction.clear(),
        |data| data.facts.approach[0] = data.facts.stroke_direction[0],
        |data| data.cap = None,
        |data| data.cap.as_mut().expect("a cap").centre.fill(DVec3::NAN),
        |data| data.facts.cap_radius = 0.0,
        |data| data.torque = None,
        |data| data.fingers[0].position.fill(DVec3::NAN),
        |data| data.fingers[1].position.fill(DVec3::ZERO),
    ];
    for (number, spoil) in spoil.iter().enumerate() {
        let mut data = whole.clone();
        spoil(&mut data);
        for figure in all(&data) {
            let Some(svg) = &figure.svg else { continue };
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{number}");
            roxmltree::Document::parse(svg).unwrap();
        }
    }
}
