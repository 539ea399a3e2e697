//! Contacts that drag the pins of a TacTip by more than their spacing, calibrated like a total force.

use crate::program::{folder, rows, run};
use crate::recordings::recordings;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;

type Row = HashMap<String, String>;

/// Targets in `targets.csv`, the component that stands for each, and the factor from the target to the component.
const TARGETS: [(&str, &str, f64); 3] = [
    ("pose_z", "f_z", 1.0),
    ("pose_Rx", "m_x", 0.1),
    ("pose_Ry", "m_y", 0.1),
];

/// Depth (mm) and tilts (degrees) of every third contact, calibrated on the others. Bounds: a published network on the
/// same data, 0.15 mm and 1.3 to 1.5 degrees.
#[test]
fn depth_and_tilt_of_sheared_contacts_are_calibrated_from_tracked_pins() {
    let test = "depth_and_tilt_of_sheared_contacts_are_calibrated_from_tracked_pins";
    let Some(data) = recordings("tactip-shear", test) else {
        return;
    };
    let folder = folder(test);
    let targets = rows(&data.join("targets.csv"));
    let number = |row: &Row, name: &str| row[name].parse::<f64>().expect(name);
    let lightest = targets
        .iter()
        .min_by(|a, b| number(a, "pose_z").total_cmp(&number(b, "pose_z")))
        .expect("a row");
    let path = |row: &Row| data.join("images").join(&row["sensor_image"]);
    let located = [
        "locate",
        path(lightest).to_str().unwrap(),
        "-o",
        "layout.toml",
    ]
    .map(String::from);
    let located = run(&folder, &located.each_ref().map(String::as_str));
    assert_eq!(located.status, Some(0), "{located:?}");
    let mut csv = String::from("picture,f_z,m_x,m_y\n");
    let mut held_out = Vec::new();
    for (index, row) in targets.iter().enumerate() {
        if index % 3 == 2 {
            held_out.push(row);
            continue;
        }
        let [z, x, y] = TARGETS.map(|(target, _, factor)| factor * number(row, target));
        writeln!(csv, "{},{z},{x},{y}", path(row).display()).unwrap();
    }
    fs::write(folder.join("FORCES.csv"), csv).unwrap();
    let arguments = "calibrate FORCES.csv --wrench --track --layout layout.toml -o wrench.toml";
    let ended = run(&folder, &arguments.split(' ').collect::<Vec<_>>());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let pictures: Vec<_> = held_out
        .iter()
        .map(|row| path(row).display().to_string())
        .collect();
    let arguments = "--layout layout.toml --calibration wrench.toml -o out.csv".split(' ');
    let pictures = pictures.iter().map(String::as_str);
    let arguments: Vec<_> = ["sense"]
        .into_iter()
        .chain(pictures)
        .chain(arguments)
        .collect();
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let found = rows(&folder.join("out.csv"));
    assert_eq!(found.len(), held_out.len());
    let valid = found
        .iter()
        .zip(held_out)
        .filter(|(found, _)| found["valid"] == "true");
    let valid: Vec<_> = valid.collect();
    println!("{} of {} contacts are valid", valid.len(), found.len());
    assert!(valid.len() * 10 >= found.len() * 9);
    for ((target, component, factor), bound) in TARGETS.into_iter().zip([0.15, 1.3, 1.3]) {
        let error = |(found, row): &(&Row, &Row)| {
            (number(found, component) / factor - number(row, target)).abs()
        };
        let mean = valid.iter().map(error).sum::<f64>() / valid.len() as f64;
        println!("{target}: mean absolute error {mean:.3}");
        assert!(mean < bound, "{target}: {mean}");
    }
}
