//! Dark markers on an uneven background: locating and tracking.

use crate::program::{folder, run};
use std::fs;
use std::path::Path;

/// Columns and rows of markers.
const GRID: (i32, i32) = (9, 7);
/// Spacing of the markers (px).
const SPACING: f64 = 30.0;
/// Radius of a marker (px).
const RADIUS: f64 = 5.0;
/// Width and height of the images (px).
const SIZE: (u32, u32) = (300, 240);

/// Position of a marker of the grid (px) when the middle of the gel is dragged by `drag` (px).
fn place((column, row): (i32, i32), drag: [f64; 2]) -> [f64; 2] {
    let at = |number: i32, count: i32| f64::from(2 * number - count + 1) / f64::from(count - 1);
    let (x, y) = (at(column, GRID.0), at(row, GRID.1));
    let part = (1.0 - x * x) * (1.0 - y * y);
    [
        30.0 + SPACING * f64::from(column) + part * drag[0],
        30.0 + SPACING * f64::from(row) + part * drag[1],
    ]
}

fn markers() -> impl Iterator<Item = (i32, i32)> {
    (0..GRID.1).flat_map(|row| (0..GRID.0).map(move |column| (column, row)))
}

/// Saves an image of the gel, brighter to the right, with an additional marker that the border cuts.
fn save(path: &Path, drag: [f64; 2]) {
    let places: Vec<[f64; 2]> = markers().map(|marker| place(marker, drag)).collect();
    let picture = image::GrayImage::from_fn(SIZE.0, SIZE.1, |column, row| {
        let (x, y) = (f64::from(column), f64::from(row));
        let cover = |[a, b]: &[f64; 2]| (RADIUS + 0.5 - (x - a).hypot(y - b)).clamp(0.0, 1.0);
        let marker = places
            .iter()
            .chain([&[60.0, 3.0]])
            .map(cover)
            .fold(0.0, f64::max);
        let ground = 110.0 + 0.3 * x - 0.1 * y;
        image::Luma([(ground * (1.0 - 0.7 * marker)).round() as u8])
    });
    picture.save(path).unwrap();
}

/// Parses the rows of a table: frame, element, displacement (px), confidence.
fn rows(table: &str) -> Vec<(usize, usize, [f64; 2], f64)> {
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("frame,stamp,element,integrated_gray,u_x,u_y,confidence")
    );
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        (
            cells[0] as usize,
            cells[2] as usize,
            [cells[4], cells[5]],
            cells[6],
        )
    };
    lines.map(row).collect()
}

#[test]
fn dark_markers_are_tracked_beyond_their_spacing() {
    let folder = folder("sense-track");
    fs::create_dir(folder.join("pictures")).unwrap();
    let drag = |frame: usize| [frame as f64 * 2.0, frame as f64 * -0.5];
    save(&folder.join("reference.png"), [0.0, 0.0]);
    for frame in 0..20 {
        save(&folder.join(format!("pictures/{frame}.png")), drag(frame));
    }
    let located = run(&folder, &["locate", "reference.png", "-o", "gel.toml"]);
    assert_eq!(located.status, Some(0), "{located:?}");
    assert!(
        located.stdout.contains("63 elements (dark spots"),
        "{located:?}"
    );
    for how in ["--track", "--track=single"] {
        let ended = run(&folder, &["sense", "pictures", "--layout", "gel.toml", how]);
        assert_eq!(ended.status, Some(0), "{ended:?}");
        let rows = rows(&ended.stdout);
        assert_eq!(rows.len(), 20 * 63);
        for (frame, element, u, confidence) in rows {
            let marker = (element as i32 % GRID.0, element as i32 / GRID.0);
            let (from, to) = (place(marker, [0.0, 0.0]), place(marker, drag(frame)));
            let error = (u[0] - to[0] + from[0]).hypot(u[1] - to[1] + from[1]);
            // The middle has moved by a spacing in frame 15. From then on, markers at the rim touch, so that two form
            // one spot.
            if how == "--track=single" && frame > 15 {
                continue;
            }
            assert!(
                confidence > 0.3,
                "{how}, frame {frame}, element {element}: {confidence}"
            );
            // Gray levels are rounded and the background is sloped, which causes 0.1 to 0.2 px. A swap would cause 30
            // px.
            assert!(
                error < 0.3,
                "{how}, frame {frame}, element {element}: {error} px"
            );
        }
    }
}

/// Saves 90 images of drags, with FORCES.csv for 60 and TEST.csv for 30 of them: force in proportion to the drag, 0.1 N/px. The middle moves by up to
/// 1.2 spacings.
fn dragged(folder: &Path) {
    let mut csv = String::from("picture,f_x,f_y\n");
    for number in 0..90 {
        let (angle, length) = (
            2.4 * f64::from(number),
            36.0 * f64::from(number % 13) / 12.0,
        );
        let drag = [length * angle.cos(), 0.6 * length * angle.sin()];
        save(&folder.join(format!("drag_{number}.png")), drag);
        let [x, y] = drag.map(|px| 0.1 * px);
        csv += &format!("drag_{number}.png,{x},{y}\n");
    }
    let (calibrating, testing) = csv.split_at(csv.find("drag_60").unwrap());
    fs::write(folder.join("FORCES.csv"), calibrating).unwrap();
    let header = csv.lines().next().unwrap();
    fs::write(folder.join("TEST.csv"), format!("{header}\n{testing}")).unwrap();
}

/// Columns `f_x` and `f_y` of a table.
fn forces(table: &str) -> Vec<[f64; 2]> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().unwrap().clone();
    let column = |name| names.iter().position(|n| n == name).unwrap();
    let columns = [column("f_x"), column("f_y")];
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        columns.map(|column| row[column].parse().unwrap())
    });
    rows.collect()
}

#[test]
fn total_force_is_calibrated_from_markers_that_leave_their_places() {
    let folder = folder("sense-track-wrench");
    save(&folder.join("reference.png"), [0.0, 0.0]);
    let located = run(&folder, &["locate", "reference.png", "-o", "gel.toml"]);
    assert_eq!(located.status, Some(0), "{located:?}");
    dragged(&folder);
    let calibrate = |output: &str, more: &[&str]| {
        let arguments = [
            "calibrate",
            "FORCES.csv",
            "--wrench",
            "--layout",
            "gel.toml",
        ];
        run(&folder, &[&arguments, &["-o", output][..], more].concat())
    };
    let ended = calibrate("tracked.toml", &["--track"]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let worst = |calibration: &str| {
        let pictures: Vec<_> = (60..90)
            .map(|number| format!("drag_{number}.png"))
            .collect();
        let pictures: Vec<_> = pictures.iter().map(String::as_str).collect();
        let arguments = ["--layout", "gel.toml", "--calibration", calibration];
        let ended = run(&folder, &[&["sense"], &pictures[..], &arguments].concat());
        assert_eq!(ended.status, Some(0), "{ended:?}");
        let measured = forces(&fs::read_to_string(folder.join("TEST.csv")).unwrap());
        let errors = forces(&ended.stdout).into_iter().zip(measured);
        let errors = errors.map(|([x, y], [a, b])| (x - a).hypot(y - b));
        errors.fold(0.0, f64::max)
    };
    // Each of 63 markers is located to 0.3 px, on average by a third of the drag: 0.03 N / (sqrt(63) / 3), with a margin of
    // 5 for the regression.
    assert!(worst("tracked.toml") < 0.06, "{} N", worst("tracked.toml"));
    // Within their places, markers are confused with their neighbours.
    let ended = calibrate("within.toml", &[]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(worst("within.toml") > 0.2, "{} N", worst("within.toml"));

    // An estimate does not depend on earlier images.
    let sense = |pictures: &[&str]| {
        let arguments = ["--layout", "gel.toml", "--calibration", "tracked.toml"];
        let ended = run(&folder, &[&["sense"], pictures, &arguments].concat());
        *forces(&ended.stdout).last().expect("a row")
    };
    assert_eq!(
        sense(&["drag_64.png"]),
        sense(&["drag_0.png", "drag_77.png", "drag_64.png"])
    );

    let verified = run(
        &folder,
        &["verify", "tracked.toml", "TEST.csv", "--layout", "gel.toml"],
    );
    assert_eq!(verified.status, Some(0), "{verified:?}");
    assert!(verified.stdout.contains("still valid"), "{verified:?}");
    calibrate("copy.toml", &["--from", "tracked.toml"]).refused(&["--from", "--track"]);
    calibrate("copy.toml", &["--track", "--from", "within.toml"]).refused(&["--track", "--from"]);
    let copied = calibrate("copy.toml", &["--track", "--from", "tracked.toml"]);
    assert_eq!(copied.status, Some(0), "{copied:?}");
    // Without the layout, the sensor is another one.
    run(
        &folder,
        &["sense", "drag_1.png", "--calibration", "tracked.toml"],
    )
    .refused(&["tracked.toml"]);
    let arguments = [
        "calibrate",
        "FORCES.csv",
        "--wrench",
        "--track",
        "-o",
        "x.toml",
    ];
    run(&folder, &arguments).refused(&["--layout"]);
    calibrate("x.toml", &["--track", "--taxels", "anyskin"]).refused(&["--taxels"]);
}

#[test]
fn images_without_markers_are_reported() {
    let folder = folder("sense-track-without");
    fs::create_dir(folder.join("pictures")).unwrap();
    save(&folder.join("reference.png"), [0.0, 0.0]);
    save(&folder.join("pictures/0.png"), [0.0, 0.0]);
    let blank = image::GrayImage::from_pixel(SIZE.0, SIZE.1, image::Luma([120]));
    blank.save(folder.join("pictures/1.png")).unwrap();
    save(&folder.join("pictures/2.png"), [5.0, 0.0]);
    run(&folder, &["locate", "reference.png", "-o", "gel.toml"]);
    let ended = run(
        &folder,
        &["sense", "pictures", "--layout", "gel.toml", "--track"],
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(
        ended
            .stderr
            .contains("1 frames show no pattern of markers, the first is frame 1"),
        "{ended:?}"
    );
    for (frame, element, _, confidence) in rows(&ended.stdout) {
        assert_eq!(
            confidence > 0.0,
            frame != 1,
            "frame {frame}, element {element}"
        );
    }
}

#[test]
fn tracking_requires_a_layout() {
    let folder = folder("sense-track-layout");
    save(&folder.join("0.png"), [0.0, 0.0]);
    run(&folder, &["sense", "0.png", "--track"]).refused(&["--track", "--layout LAYOUT.toml"]);
}

#[test]
fn image_without_a_pattern_of_markers_is_refused() {
    let folder = folder("locate-texture");
    // Blurred noise, with grains of all sizes.
    let mut state = 1_u64;
    let noise = image::GrayImage::from_fn(SIZE.0, SIZE.1, |_, _| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        image::Luma([(state >> 56) as u8])
    });
    let texture = image::imageops::blur(&noise, 2.0);
    texture.save(folder.join("texture.png")).unwrap();
    run(&folder, &["locate", "texture.png", "-o", "texture.toml"]).refused(&[
        "not a pattern of markers",
        "spacing differs",
        "--spot-diameter",
    ]);
    assert!(!folder.join("texture.toml").exists());
}
