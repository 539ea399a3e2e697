//! The data in a report's page match the recording.

use crate::support;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use feeler_record::{Recording, Solid, SolidFrame, SolidShape};
use feeler_report::run::make;
use feeler_report::run::make::page_of;
use flate2::read::DeflateDecoder;
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::PathBuf;

/// Data of a page and its decoded columns.
struct Page {
    data: Value,
    columns: HashMap<String, (usize, Vec<f64>)>,
}

impl Page {
    fn of(page: &str) -> Self {
        let (_, data) = page.split_once(r#"id="page-data">"#).expect("page data");
        let (data, _) = data.split_once("</script>").expect("an end");
        assert!(!data.contains('<'), "the data could end the script element");
        let data: Value = serde_json::from_str(data).expect("JSON");
        let run = &data["run"];
        let stored = STANDARD.decode(run["data"].as_str().expect("a text"));
        let mut bytes = Vec::new();
        DeflateDecoder::new(&stored.expect("base64")[..])
            .read_to_end(&mut bytes)
            .expect("raw deflate");
        let rows = run["rows"].as_u64().expect("a number") as usize;
        let (mut rest, mut columns) = (&bytes[..], HashMap::new());
        for column in run["columns"].as_array().expect("columns") {
            let width = column["width"].as_u64().expect("a number") as usize;
            let scale = column["scale"].as_f64().expect("a number");
            let (size, read): (usize, fn(&[u8]) -> f64) = match column["type"].as_str() {
                Some("f64") => (8, |b| f64::from_le_bytes(b.try_into().unwrap())),
                Some("f32") => (4, |b| f32::from_le_bytes(b.try_into().unwrap()).into()),
                Some("i16") => (2, |b| i16::from_le_bytes(b.try_into().unwrap()).into()),
                Some("u8") => (1, |b| b[0].into()),
                other => panic!("{other:?}"),
            };
            let (own, after) = rest.split_at(rows * width * size);
            let numbers = own
                .chunks(size)
                .map(|number| scale * read(number))
                .collect();
            let name = column["name"].as_str().expect("a name");
            columns.insert(name.to_string(), (width, numbers));
            rest = after;
        }
        assert!(rest.is_empty(), "{} bytes left", rest.len());
        Self { data, columns }
    }

    fn row(&self, column: &str, row: usize) -> &[f64] {
        let (width, numbers) = &self.columns[column];
        &numbers[row * width..(row + 1) * width]
    }
}

#[test]
fn the_rows_of_a_page_equal_those_of_the_recording() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("page-data");
    fs::create_dir_all(&directory).expect("a folder");
    let path = directory.join("recording.mcap");
    support::write_run(&path, 4).expect("a run");
    let recording = Recording::read(&path).expect("a recording");
    let made = make(&directory).expect("a report");
    let page = Page::of(&fs::read_to_string(made.report_path).expect("a page"));
    let rows = page.data["run"]["rows"].as_u64().expect("a number") as usize;
    assert_eq!(rows, recording.task.len());
    let single = |number: f64| f64::from(number as f32);
    for row in 0..rows {
        assert_eq!(page.row("time", row), [recording.task[row].stamp]);
        assert_eq!(
            page.row("phase", row),
            [f64::from(recording.task[row].phase as u8)]
        );
        assert_eq!(
            page.row("torque", row),
            [single(recording.torque_sensor[row].torque)]
        );
        assert_eq!(
            page.row("cap_angle", row),
            [single(recording.cap[row].angle)]
        );
        let centre = recording.cap[row].centre;
        let centre = [centre.x, centre.y, centre.z].map(single);
        assert_eq!(page.row("frame/cap", row)[..3], centre);
        for (number, finger) in recording.fingers.iter().enumerate() {
            let column = |name: &str| page.row(&format!("finger/{number}/{name}"), row);
            let position = finger.joints[row].position.map(single);
            assert_eq!(column("joints"), position.as_slice());
            assert_eq!(
                column("grasp_force"),
                [single(finger.flags[row].grasp_force)]
            );
            let flags = column("flags")[0] as u8;
            let expected = [
                finger.flags[row].touch,
                finger.flags[row].slip,
                finger.flags[row].over,
            ];
            assert_eq!([0, 1, 2].map(|bit| flags >> bit & 1 == 1), expected);
            let forces = finger.tactile[row]
                .forces
                .iter()
                .flat_map(|f| [f.x, f.y, f.z]);
            for (stored, force) in column("forces").iter().zip(forces) {
                // Half of the step to which forces are rounded, plus rounding errors.
                assert!((stored - force).abs() <= 0.251e-3, "{stored} N, {force} N");
            }
        }
    }
}

/// Objects without a recorded pose are not drawn, instead of at the world's origin.
#[test]
fn moving_objects_are_drawn_only_if_their_pose_is_known() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("page-solids");
    fs::create_dir_all(&directory).expect("a folder");
    let drawn = |name: &str, rig| {
        let path = directory.join(name);
        support::write_run_on(&path, rig).expect("a run");
        let mut recording = Recording::read(&path).expect("a recording");
        let frames = [SolidFrame::World, SolidFrame::Cap, SolidFrame::Object];
        recording.facts.solids = frames.map(solid).to_vec();
        let page = Page::of(&page_of(&recording));
        let shapes = page.data["scene"]["shapes"].as_array().cloned();
        let solids = shapes.into_iter().flatten();
        let solids = solids.filter(|s| s["role"] == "object" || s["role"] == "fixture");
        let frames = solids.map(|s| s["frame"].as_str().map(String::from));
        frames.collect::<Option<Vec<_>>>().expect("frames")
    };
    assert_eq!(drawn("real.mcap", support::REAL), ["world"]);
    let of_a_simulator = drawn("simulated.mcap", support::SIMULATED);
    assert_eq!(of_a_simulator, ["world", "cap"]);
}

fn solid(frame: SolidFrame) -> Solid {
    Solid {
        name: frame.name().into(),
        frame,
        shape: SolidShape::Sphere { radius: 0.01 },
        position: [0.0; 3],
        orientation: [0.0, 0.0, 0.0, 1.0],
    }
}

/// The scene's domes are at the poses of the recorded joint angles, and figures refer to existing columns.
#[test]
fn the_scene_and_figures_of_a_page_refer_to_existing_data() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("page-scene");
    fs::create_dir_all(&directory).expect("a folder");
    support::write_run(&directory.join("recording.mcap"), 4).expect("a run");
    let made = make(&directory).expect("a report");
    let page = Page::of(&fs::read_to_string(made.report_path).expect("a page"));
    let list = |value: &Value| value.as_array().expect("a list").clone();
    let scene = &page.data["scene"];
    let names: Vec<_> = list(&scene["frames"])
        .iter()
        .map(|frame| frame["name"].clone())
        .collect();
    for frame in list(&scene["frames"]) {
        assert!(
            frame["parent"] == "world" || names.contains(&frame["parent"]),
            "{frame}"
        );
    }
    for part in list(&scene["shapes"])
        .iter()
        .chain(&list(&scene["fingers"]))
    {
        assert!(
            part["frame"] == "world" || names.contains(&part["frame"]),
            "{part}"
        );
    }
    let figures = list(&page.data["figures"]);
    let numbers: Vec<_> = figures
        .iter()
        .map(|figure| figure["number"].as_u64())
        .collect();
    assert_eq!(numbers, [8, 9, 10, 11, 12, 13, 14].map(Some));
    for panel in figures.iter().flat_map(|figure| list(&figure["panels"])) {
        for series in list(&panel["series"]) {
            match series["column"]["name"].as_str() {
                Some(name) => assert!(page.columns.contains_key(name), "{name}"),
                None => assert!(!list(&series["points"]["x"]).is_empty(), "{series}"),
            }
        }
    }
}
