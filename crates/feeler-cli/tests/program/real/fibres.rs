//! A fingertip of bright fibres under a known total force.

use super::blobs::{blobs, median_area};
use crate::program::{folder, rows, run};
use crate::recordings::recordings;
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::wrench::{WrenchAxis, WrenchCalibration};
use feeler_sources::read_picture;
use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::{Path, PathBuf};

type Row = HashMap<String, String>;

fn force(row: &Row, axis: &str) -> Option<f64> {
    row[axis].parse().ok()
}

/// Groups the rows by recording. The image names of a recording differ only in their last number.
fn by_recording(rows: &[Row]) -> Vec<Vec<Row>> {
    let mut recordings = BTreeMap::<String, Vec<Row>>::new();
    for row in rows {
        let name = row["picture"].trim_end_matches(".png");
        let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
        recordings
            .entry(name.to_owned())
            .or_default()
            .push(row.clone());
    }
    recordings.into_values().collect()
}

/// RMS of a force component in some rows (N).
fn strength(rows: &[Row], axis: &str) -> f64 {
    let forces: Vec<f64> = rows.iter().filter_map(|row| force(row, axis)).collect();
    let sum: f64 = forces.iter().map(|f| f * f).sum();
    (sum / forces.len().max(1) as f64).sqrt()
}

/// Locates the elements in the image with the least compression. Returns the folder of the recordings and a folder with
/// the layout, or `None` if the recordings are not available.
pub fn located(test: &str) -> Option<(PathBuf, PathBuf)> {
    let data = recordings("optofiber-force", test)?;
    let folder = folder(test);
    let forces = rows(&data.join("FORCES.csv"));
    let measured = forces
        .iter()
        .filter_map(|row| Some((force(row, "f_z")?.abs(), &row["picture"])));
    let lightest = measured
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("a row")
        .1;
    let picture = data.join(lightest);
    let arguments = ["locate", picture.to_str().unwrap(), "-o", "layout.toml"];
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    // There are as many elements as independently detected spots, and each is on one of them.
    let spots = blobs(&read_picture(&picture).unwrap(), false, 0.25);
    let typical = median_area(&spots);
    let spots: Vec<_> = spots
        .iter()
        .filter(|spot| 3 * spot.area > typical && !spot.at_border)
        .collect();
    let text = fs::read_to_string(folder.join("layout.toml")).unwrap();
    let layout = LocatedLayout::from_toml(&text).unwrap();
    println!("{} elements, {} spots", layout.elements.len(), spots.len());
    assert_eq!(layout.elements.len(), spots.len());
    for element in &layout.elements {
        let place = element.centre_px.to_array();
        let near = spots
            .iter()
            .filter(|spot| spot.distance(place) <= spot.radius());
        assert_eq!(near.count(), 1, "element at {place:?}");
    }
    Some((data, folder))
}

/// Writes some rows to `FORCES.csv` and calibrates with them. Returns the mean absolute error of each axis over blocks
/// of time (N).
fn calibrated(data: &Path, folder: &Path, rows: &[Row]) -> HashMap<WrenchAxis, f64> {
    let mut table = String::from("picture,f_x,f_y,f_z\n");
    for row in rows {
        let picture = data.join(&row["picture"]);
        let [x, y, z] = ["f_x", "f_y", "f_z"].map(|axis| &row[axis]);
        table += &format!("{},{x},{y},{z}\n", picture.display());
    }
    fs::write(folder.join("FORCES.csv"), table).unwrap();
    let arguments = [
        "calibrate",
        "FORCES.csv",
        "--wrench",
        "--layout=layout.toml",
    ];
    let ended = run(
        folder,
        &[&arguments[..], &["-o=wrench.toml", "--force"]].concat(),
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let text = fs::read_to_string(folder.join("wrench.toml")).unwrap();
    let calibration = WrenchCalibration::from_toml(&text).unwrap();
    println!("{}", ended.stdout);
    calibration
        .quality
        .iter()
        .map(|quality| (quality.axis, quality.blocks.mae))
        .collect()
}

fn held(errors: &HashMap<WrenchAxis, f64>, bounds: &[(WrenchAxis, f64)]) {
    for (axis, bound) in bounds {
        let error = errors.get(axis).copied();
        assert!(
            error.is_some_and(|error| error <= *bound),
            "{axis:?}: {error:?} N, at most {bound} N"
        );
    }
}

/// All recordings together. Bounds: in shear, the known error of a ridge regression on the spots' brightness from one
/// recording to another; in compression, the error over a range that is three times as large as that of shear.
#[test]
fn forces_on_a_fingertip_of_fibres_are_calibrated() {
    let Some((data, folder)) = located("forces_on_a_fingertip_of_fibres_are_calibrated") else {
        return;
    };
    let all = rows(&data.join("FORCES.csv"));
    let errors = calibrated(&data, &folder, &all);
    held(
        &errors,
        &[
            (WrenchAxis::ForceX, 0.54),
            (WrenchAxis::ForceY, 0.67),
            (WrenchAxis::ForceZ, 1.5),
        ],
    );
}

/// The recording with the most shear alone, 30 images. Shear must be within a twelfth of the 9 N to either side,
/// compression within 1 N.
#[test]
fn shear_is_calibrated_from_a_single_recording() {
    let Some((data, folder)) = located("shear_is_calibrated_from_a_single_recording") else {
        return;
    };
    let recordings = by_recording(&rows(&data.join("FORCES.csv")));
    let shear = |rows: &Vec<Row>| strength(rows, "f_x").hypot(strength(rows, "f_y"));
    let most = recordings
        .iter()
        .max_by(|a, b| shear(a).total_cmp(&shear(b)));
    let errors = calibrated(&data, &folder, most.expect("a recording"));
    held(
        &errors,
        &[
            (WrenchAxis::ForceX, 0.75),
            (WrenchAxis::ForceY, 0.75),
            (WrenchAxis::ForceZ, 1.0),
        ],
    );
}

/// The longest recording alone, which contains presses without shear.
#[test]
fn compression_is_calibrated_from_a_single_recording() {
    let Some((data, folder)) = located("compression_is_calibrated_from_a_single_recording") else {
        return;
    };
    let recordings = by_recording(&rows(&data.join("FORCES.csv")));
    let longest = recordings.iter().max_by_key(|rows| rows.len());
    let errors = calibrated(&data, &folder, longest.expect("a recording"));
    held(&errors, &[(WrenchAxis::ForceZ, 1.0)]);
}

/// Images of other recordings that pass the novelty check but whose compression error is 5 to 8 N, several times the
/// error by blocks of time.
#[test]
fn valid_forces_of_other_recordings_are_within_the_stated_band() {
    let test = "valid_forces_of_other_recordings_are_within_the_stated_band";
    let Some((data, folder)) = located(test) else {
        return;
    };
    let Some(others) = recordings("real-faults", test) else {
        return;
    };
    let others = others.join("fibre-valid-but-off");
    calibrated(&data, &folder, &rows(&data.join("FORCES.csv")));
    let text = fs::read_to_string(folder.join("wrench.toml")).unwrap();
    let calibration = WrenchCalibration::from_toml(&text).unwrap();
    for row in rows(&others.join("FORCES.csv")) {
        let picture = others.join(&row["picture"]);
        let options = [
            "--layout=layout.toml",
            "--calibration=wrench.toml",
            "-o=sensed.csv",
            "--force",
        ];
        let arguments = [&["sense", picture.to_str().unwrap()], &options[..]].concat();
        let ended = run(&folder, &arguments);
        assert_eq!(ended.status, Some(0), "{ended:?}");
        let sensed = &rows(&folder.join("sensed.csv"))[0];
        for quality in &calibration.quality {
            let axis = quality.axis.name();
            let error = (force(sensed, axis).unwrap() - force(&row, axis).unwrap()).abs();
            let band = quality.band_95.expect("enough images");
            println!(
                "{}: {axis} off by {error:.2} N, band {band:.2} N, valid {}",
                row["picture"], sensed["valid"]
            );
            assert!(sensed["valid"] == "false" || error <= band);
        }
    }
}
