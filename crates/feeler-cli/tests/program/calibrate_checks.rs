//! `feeler calibrate LOADS.csv` with loads that contradict the images: they are refused with an explanation, or
//! converted by options, which gives the same calibration as the original loads.

use crate::program::{experiment, folder, rows, run};
use glam::DVec3;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

type Row = HashMap<String, String>;
/// Error of a table, as a function from correct to wrong forces.
type Turned = fn(DVec3) -> DVec3;

/// A simulated bench: its folder, its rows, and the calibration of the original loads.
struct Bench {
    folder: PathBuf,
    rows: Vec<Row>,
    expected: String,
}

const COLUMNS: [&str; 8] = [
    "picture", "element", "f_x", "f_y", "f_z", "column", "row", "x_angle",
];

impl Bench {
    fn new(name: &str) -> Self {
        let folder = folder(name);
        let arguments = [
            "calibrate",
            "--simulated",
            "--loads",
            "30",
            "--write-loads",
            "loads",
            "-o",
            "a.toml",
        ];
        run(&folder, &arguments).done();
        let rows = rows(&folder.join("loads/LOADS.csv"));
        let mut bench = Self {
            folder,
            rows,
            expected: String::new(),
        };
        bench.expected = bench.calibrated(|_| {}, &[]);
        bench
    }

    /// Writes the rows to CHANGED.csv with `change` applied to each.
    fn write(&self, header: [&str; 8], change: impl Fn(&mut Row)) {
        let mut text = header.join(",") + "\n";
        for row in &self.rows {
            let mut row = row.clone();
            change(&mut row);
            text += &(COLUMNS.map(|column| row[column].clone()).join(",") + "\n");
        }
        fs::write(self.folder.join("loads/CHANGED.csv"), text).unwrap();
    }

    fn calibrate(&self, options: &[&str]) -> crate::program::Ended {
        let start = ["calibrate", "loads/CHANGED.csv", "--force", "-o", "c.toml"];
        run(&self.folder, &[&start[..], options].concat())
    }

    /// The calibration of changed rows.
    fn calibrated(&self, change: impl Fn(&mut Row), options: &[&str]) -> String {
        self.write(COLUMNS, change);
        self.calibrate(options).done();
        fs::read_to_string(self.folder.join("c.toml")).unwrap()
    }

    /// Asserts that changed rows are refused.
    fn refuses(&self, change: impl Fn(&mut Row), options: &[&str], words: &[&str]) {
        let _ = fs::remove_file(self.folder.join("c.toml"));
        self.write(COLUMNS, change);
        self.calibrate(options).refused(words);
        assert!(!self.folder.join("c.toml").exists());
    }
}

fn force(row: &Row) -> DVec3 {
    DVec3::from_array(["f_x", "f_y", "f_z"].map(|column| row[column].parse().unwrap()))
}

fn set(row: &mut Row, force: DVec3) {
    for (column, number) in ["f_x", "f_y", "f_z"].into_iter().zip(force.to_array()) {
        row.insert(column.into(), number.to_string());
    }
}

/// A change of the force in a row.
fn with(change: impl Fn(DVec3) -> DVec3) -> impl Fn(&mut Row) {
    move |row| set(row, change(force(row)))
}

#[test]
fn wrong_signs_and_axes_are_refused_or_converted() {
    let bench = Bench::new("checks-axes");
    let cases: [(Turned, &[&str], &str); 5] = [
        (
            |f| DVec3::new(f.x, f.y, -f.z),
            &["--force-axes", "x,y,-z"],
            "the spots grow where f_z is negative; expected compression",
        ),
        (
            |f| -f,
            &["--force-on", "object"],
            "do these act on the object?",
        ),
        (
            |f| DVec3::new(f.x, -f.y, f.z),
            &["--force-axes", "x,-y,z"],
            "the spots move against f_y",
        ),
        (
            |f| DVec3::new(f.y, f.x, f.z),
            &["--force-axes", "y,x,z"],
            "follow f_y, f_x and f_z",
        ),
        (
            |f| DVec3::new(f.z, f.x, f.y),
            &["--force-axes", "y,z,x"],
            "follow f_y, f_z and f_x",
        ),
    ];
    for (change, converted, words) in cases {
        let option = converted.join(" ");
        bench.refuses(
            with(change),
            &[],
            &[
                "CHANGED.csv: in 41 of 41 elements, the first of them 0",
                words,
                &option,
            ],
        );
        assert!(
            bench.calibrated(with(change), converted) == bench.expected,
            "{option}"
        );
    }
    // A wrong conversion is refused, too, and the right one is suggested.
    let tension = |f: DVec3| DVec3::new(f.x, f.y, -f.z);
    bench.refuses(
        with(tension),
        &["--force-on", "object"],
        &[
            "the spots move against f_x and f_y",
            "use --force-axes x,y,-z instead to convert it",
        ],
    );
    bench.refuses(
        with(|f| f),
        &["--force-on", "object"],
        &["without --force-on and --force-axes, the forces agree with the images"],
    );
    // No option accepts compression that the calibration would report as tension.
    for reversed in [tension, |f: DVec3| -f] {
        bench.refuses(
            with(reversed),
            &["--force-fit"],
            &["f_z is reversed in 41 of 41 elements"],
        );
    }
}

#[test]
fn wrong_element_numbers_are_refused() {
    let bench = Bench::new("checks-elements");
    let numbered = |row: &mut Row, number: usize| {
        row.insert("element".into(), number.to_string());
        for column in ["column", "row", "x_angle"] {
            row.insert(column.into(), String::new());
        }
    };
    let header = ["picture", "element", "f_x", "f_y", "f_z", "-", "-", "-"];
    let refuses = |change: &dyn Fn(&mut Row), words: &[&str]| {
        bench.write(header, change);
        bench.calibrate(&[]).refused(words);
    };
    let number = |row: &Row| row["element"].parse::<usize>().unwrap();
    let exchanged = |row: &mut Row| {
        let element = number(row);
        numbered(
            row,
            match element {
                3 => 7,
                7 => 3,
                other => other,
            },
        );
    };
    refuses(
        &exchanged,
        &[
            "the loads of element 3 do not match its growth in the images",
            "but that of element 7",
        ],
    );
    let shifted = |row: &mut Row| {
        let element = (number(row) + 1) % 41;
        numbered(row, element);
    };
    refuses(
        &shifted,
        &["but that of element 40", "numbered as in the layout"],
    );
    // Forces in the axes of the image, without the angle, are refused. With the angle, they are converted.
    let seen = |row: &mut Row| {
        let angle: f64 = row["x_angle"].parse().unwrap();
        let force = force(row);
        set(row, glam::DMat3::from_rotation_z(angle) * force);
    };
    refuses(
        &|row: &mut Row| {
            seen(row);
            let element = number(row);
            numbered(row, element);
        },
        &["elements, the first of them", "x_angle"],
    );
    bench.calibrated(
        |row| {
            seen(row);
            row.insert("x_angle".into(), "0".into());
        },
        &[],
    );
    // A single mirrored element.
    bench.refuses(
        |row| {
            if row["element"] == "5" {
                set(row, force(row) * DVec3::new(-1.0, 1.0, 1.0));
            }
        },
        &[],
        &[
            "in 1 of 41 elements, the first of them 5",
            "the spots move against f_x",
        ],
    );
}

#[test]
fn implausible_loads_are_refused_unless_confirmed() {
    let bench = Bench::new("checks-units");
    let times = |factor: f64| with(move |force| factor * force);
    bench.refuses(
        times(1e3),
        &[],
        &[
            "the largest load on an element is 2",
            "expected 0.01 to 20 N",
            "are these mN?",
            "--confirm-loads",
        ],
    );
    bench.refuses(
        times(1e-3),
        &[],
        &["expected 0.01 to 20 N", "are these kN?"],
    );
    let confirmed = bench.calibrated(times(1e3), &["--confirm-loads"]);
    let normal = |text: &str| {
        text.parse::<toml::Table>().unwrap()["full_scale"]["normal"]
            .as_float()
            .unwrap()
    };
    assert!(
        (normal(&confirmed) - 1e3 * normal(&bench.expected)).abs() < 1.0,
        "{}",
        normal(&confirmed)
    );
    // No program would accept a calibration with such a full scale.
    bench.refuses(
        |_| {},
        &["--full-scale-normal", "50"],
        &["full_scale is 50 N", "expected 0.01 to 20 N"],
    );
    // Units in the header are converted.
    let header = [
        "picture", "element", "Fx [mN]", "Fy [mN]", "Fz [mN]", "column", "row", "x_angle",
    ];
    bench.write(header, times(1e3));
    bench.calibrate(&[]).done();
    let converted = fs::read_to_string(bench.folder.join("c.toml")).unwrap();
    assert!((normal(&converted) - normal(&bench.expected)).abs() < 0.0011);
    // Forces on the whole fingertip.
    fs::write(
        bench.folder.join("FORCES.csv"),
        "picture,f_z\nloads/00000.png,-3000\n",
    )
    .unwrap();
    let wrench = ["calibrate", "FORCES.csv", "--wrench", "-o", "w.toml"];
    run(&bench.folder, &wrench).refused(&[
        "on the fingertip is 3000 N; expected 0.05 to 200 N",
        "are these mN?",
    ]);
    run(
        &bench.folder,
        &[&wrench[..], &["--force-axes", "x,y,-z"]].concat(),
    )
    .refused(&["--force-axes: with --wrench this requires --live"]);
}

/// Copies the images, shifted by `shift` px, to a second recording `later`.
fn in_two_recordings(bench: &Bench, shift: i64) {
    let loads = bench.folder.join("loads");
    fs::create_dir_all(loads.join("later")).unwrap();
    for number in 0.. {
        let name = format!("{number:05}.png");
        let Ok(picture) = image::open(loads.join(&name)) else {
            break;
        };
        let picture = picture.to_luma8();
        let moved = image::GrayImage::from_fn(picture.width(), picture.height(), |x, y| {
            let x = (i64::from(x) - shift).clamp(0, i64::from(picture.width()) - 1);
            *picture.get_pixel(x as u32, y)
        });
        moved.save(loads.join("later").join(&name)).unwrap();
    }
}

fn is_later(row: &Row) -> bool {
    row["picture"]
        .trim_end_matches(".png")
        .parse::<usize>()
        .unwrap()
        % 2
        == 1
}

#[test]
fn recordings_with_different_zeros_are_refused() {
    let bench = Bench::new("checks-zeros");
    in_two_recordings(&bench, 0);
    let offset = |offset: DVec3| {
        move |row: &mut Row| {
            if is_later(row) {
                set(row, force(row) + offset);
                let picture = format!("later/{}", row["picture"]);
                row.insert("picture".into(), picture);
            }
        }
    };
    assert!(bench.calibrated(offset(DVec3::ZERO), &[]) == bench.expected);
    let words = [
        "f_z of recording \"later\" is +0.1",
        "off that of \".\"",
        "the zero of the force sensor has changed",
    ];
    bench.refuses(offset(0.1 * DVec3::Z), &[], &words);
    bench.calibrated(offset(0.1 * DVec3::Z), &["--force-fit"]);
    // The camera has moved.
    in_two_recordings(&bench, 6);
    let words = [
        "unloaded images of recordings",
        "the camera, the light or the fingertip has changed",
    ];
    bench.refuses(offset(DVec3::ZERO), &[], &words);
}

/// Errors of a single load, or of one of two recordings, that all loads together do not reveal.
#[test]
fn loads_that_contradict_the_others_are_refused() {
    let bench = Bench::new("checks-others");
    in_two_recordings(&bench, 0);
    let exchanged = |row: &mut Row| {
        if is_later(row) {
            let own = force(row);
            set(row, DVec3::new(own.y, own.x, own.z));
            let picture = format!("later/{}", row["picture"]);
            row.insert("picture".into(), picture);
        }
    };
    let words = ["recording \"later\": in ", "follow f_y, f_x and f_z"];
    bench.refuses(exchanged, &[], &words);
    let is_large = |row: &&Row| row["element"] == "7" && force(row).z > 1.5;
    let large = bench.rows.iter().find(is_large).unwrap().clone();
    let mistyped = |row: &mut Row| {
        if *row == large {
            set(row, force(row) * DVec3::new(1.0, 1.0, 10.0));
        }
    };
    let picture = format!("picture = {:?}: f_z = ", large["picture"]);
    let words = [
        &*picture,
        "N on element 7",
        "is it mistyped?",
        "--force-fit",
    ];
    bench.refuses(mistyped, &[], &words);
    bench.calibrated(mistyped, &["--force-fit"]);
    // A load no larger than the others is only reported.
    let reversed = |row: &mut Row| {
        if *row == large {
            set(row, force(row) * DVec3::new(1.0, 1.0, 0.1));
        }
    };
    bench.write(COLUMNS, reversed);
    let said = bench.calibrate(&[]);
    assert!(
        said.stderr.contains(&picture) && said.status == Some(0),
        "{said:?}"
    );
}

/// Multiplies all numbers in the lines of a calibration that start with `key`.
fn multiplied(text: &str, key: &str, factor: f64) -> String {
    let multiply = |line: &str| match line.strip_prefix(&format!("{key} = [")) {
        Some(numbers) => {
            let numbers = numbers.trim_end_matches(']').split(", ");
            let numbers: Vec<_> = numbers
                .map(|n| (factor * n.parse::<f64>().unwrap()).to_string())
                .collect();
            format!("{key} = [{}]\n", numbers.join(", "))
        }
        None => format!("{line}\n"),
    };
    text.lines().map(multiply).collect()
}

/// No program accepts a calibration of reversed loads, or of loads in another unit.
#[test]
fn calibrations_of_wrong_loads_are_refused_by_all_programs() {
    let folder = folder("checks-reversed");
    experiment(&folder, "", "");
    let path = folder.join("reference-fingertip.coupled.calibration.toml");
    let text = fs::read_to_string(&path).unwrap();
    for (key, words) in [
        (
            "normal",
            "f_z is reversed in 41 of 41 elements: the calibration would report tension where an element is pressed",
        ),
        (
            "shear_y",
            "f_y is reversed in 41 of 41 elements: the calibration would report shear against",
        ),
    ] {
        fs::write(&path, multiplied(&text, key, -1.0)).unwrap();
        run(&folder, &["run", "my.toml", "--out", "run"])
            .refused(&[words, "run `feeler calibrate` again"]);
        assert!(!Path::new(&folder.join("run/recording.mcap")).exists());
        run(&folder, &["check", "my.toml"]).refused(&[words]);
    }
    // Loads in another unit.
    let thousandfold = ["normal", "shear_x", "shear_y"]
        .iter()
        .fold(text, |text, key| multiplied(&text, key, 1e3));
    let words = "expected 0.01 to 20 N on a soft element: are its loads in another unit?";
    fs::write(&path, &thousandfold).unwrap();
    run(&folder, &["run", "my.toml", "--out", "run"]).refused(&[words]);
    let confirmed =
        thousandfold.replacen("[full_scale]", "loads_confirmed = true\n[full_scale]", 1);
    fs::write(&path, confirmed).unwrap();
    run(&folder, &["check", "my.toml"]).done();
}
