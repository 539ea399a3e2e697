//! `feeler calibrate FORCES.csv --wrench`, and `feeler sense` with the resulting calibration.

use crate::program::{folder, rows, run};
use feeler::sensor::wrench::{WrenchAxis, WrenchCalibration};
use image::GrayImage;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes an image of sixteen spots that change by up to 8 % per newton, each differently, lit with brightness `lamp`.
fn picture(path: &Path, [x, y, z]: [f64; 3], lamp: f64, seed: u64) {
    let mut random = Pcg64::seed_from_u64(seed);
    let picture = GrayImage::from_fn(160, 160, |column, row| {
        let index = f64::from((row / 40) * 4 + column / 40);
        let place = [column, row].map(|c| f64::from(c % 40) - 19.5);
        let spot = (-(place[0] * place[0] + place[1] * place[1]) / 40.0).exp();
        let law = |axis: f64| 0.08 * (2.4 * index + 1.7 * axis + 0.3 * index * axis).sin();
        let growth = 1.0 + law(0.0) * x + law(1.0) * y + law(2.0) * z;
        let noise = random.random_range(0.0..4.0);
        image::Luma([(130.0 * lamp * growth * spot + 8.0 + noise) as u8])
    });
    picture.save(path).expect("an image");
}

/// Slowly varying force at `time` (N), like that of a person's hand.
fn force(time: f64) -> [f64; 3] {
    let wave = |period: f64, phase: f64| (TAU * time / period + phase).sin();
    [wave(17.0, 0.0), wave(23.0, 1.0), -1.0 + wave(41.0, 2.0)]
}

/// Writes images of two recordings, their FORCES.csv (with noise as torque about z) and the layout to a new folder.
fn measured(name: &str) -> PathBuf {
    let folder = folder(name);
    fs::create_dir(folder.join("pictures")).unwrap();
    let mut csv = String::from("picture,f_x,f_y,f_z,m_z\n");
    for (recording, count, lamp) in [("rub", 60, 1.0), ("press", 40, 0.95)] {
        for number in 0..count {
            let time = f64::from(number) + if recording == "rub" { 0.0 } else { 100.0 };
            let [x, y, z] = force(time);
            let file = format!("pictures/{recording}_{number}.png");
            let seed = number as u64 + if recording == "rub" { 0 } else { 1000 };
            picture(&folder.join(&file), [x, y, z], lamp, seed);
            let noise = (f64::from(number) * 77.7).sin();
            // f_x is missing for a third of the images.
            let x = if number % 3 == 2 {
                String::new()
            } else {
                x.to_string()
            };
            writeln!(csv, "{file},{x},{y},{z},{noise}").unwrap();
        }
    }
    fs::write(folder.join("FORCES.csv"), csv).unwrap();
    picture(&folder.join("untouched.png"), [0.0; 3], 1.0, 5000);
    let located = run(&folder, &["locate", "untouched.png", "-o", "layout.toml"]);
    assert_eq!(located.status, Some(0), "{located:?}");
    folder
}

const CALIBRATE: [&str; 7] = [
    "calibrate",
    "FORCES.csv",
    "--wrench",
    "--layout",
    "layout.toml",
    "-o",
    "wrench.toml",
];

/// Forces in the format of a spreadsheet give the same calibration as in the format of this test.
#[test]
fn forces_of_other_programs_make_the_same_calibration() {
    let folder = measured("wrench-of-others");
    let calibrate = || {
        let ended = run(&folder, &[&CALIBRATE[..], &["--force"]].concat());
        assert_eq!(ended.status, Some(0), "{ended:?}");
        fs::read_to_string(folder.join("wrench.toml")).unwrap()
    };
    let expected = calibrate();
    let forces = fs::read_to_string(folder.join("FORCES.csv")).unwrap();
    let german = forces
        .replace(',', ";")
        .replace('.', ",")
        .replace(",png", ".png");
    let german = german.replacen(
        "picture;f_x;f_y;f_z;m_z\n",
        "Picture;FX;Fy [N];Force Z;Mz (Nm)\n;N;N;N;\n",
        1,
    );
    let wide = std::iter::once(0xfeff)
        .chain(german.encode_utf16())
        .flat_map(u16::to_be_bytes);
    fs::write(folder.join("FORCES.csv"), wide.collect::<Vec<_>>()).unwrap();
    assert!(calibrate() == expected);
    fs::write(
        folder.join("FORCES.csv"),
        forces
            .replace(',', "; ")
            .replacen("f_x", "Tx", 1)
            .replacen("f_y", "F_Y [m]", 1),
    )
    .unwrap();
    run(&folder, &[&CALIBRATE[..], &["--force"]].concat()).refused(&[
        "\"F_Y [m]\" is in \"m\"",
        "expected N, mN, µN, kN, kgf or gf",
    ]);
}

#[test]
fn wrench_calibration_predicts_new_forces() {
    let folder = measured("wrench");
    let ended = run(&folder, &CALIBRATE);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(ended.stderr.contains("m_z is left out"), "{ended:?}");
    for words in [
        "f_x (N)",
        "hysteresis",
        "pictures/rub",
        "pictures/press",
        "wrench.html",
    ] {
        assert!(ended.stdout.contains(words), "no {words} in {ended:?}");
    }
    let page = fs::read_to_string(folder.join("wrench.html")).unwrap();
    assert!(page.contains("FORCES.csv") && page.contains("predicted over measured"));
    let text = fs::read_to_string(folder.join("wrench.toml")).unwrap();
    let calibration = WrenchCalibration::from_toml(&text).unwrap();
    assert_eq!(calibration.quality[0].blocks.rows, 67);

    // New forces, and a lamp that is dimmer than in any calibration image.
    fs::create_dir(folder.join("new")).unwrap();
    for number in 0..20_u32 {
        let file = folder.join(format!("new/{number}.png"));
        picture(
            &file,
            force(0.5 + 3.0 * f64::from(number)),
            0.9,
            9000 + u64::from(number),
        );
    }
    let sense = |output: &str| {
        let start = ["sense", "new", "--layout", "layout.toml"];
        let end = ["--calibration", "wrench.toml", "-o", output];
        let ended = run(&folder, &[&start[..], &end[..]].concat());
        assert_eq!(ended.status, Some(0), "{ended:?}");
    };
    sense("new.csv");
    let sensed = rows(&folder.join("new.csv"));
    assert_eq!(sensed.len(), 20);
    let mut worst = 0.0_f64;
    for (number, row) in sensed.iter().enumerate() {
        let truth = force(0.5 + 3.0 * number as f64);
        for (axis, truth) in WrenchAxis::ALL.into_iter().zip(truth) {
            let value: f64 = row[axis.name()].parse().unwrap();
            worst = worst.max((value - truth).abs());
        }
        assert!(
            row["m_z"].is_empty() && !row["novelty"].is_empty(),
            "{row:?}"
        );
    }
    // Forces are about 1 N. Noise is about 1 % of a spot's level in each of its 130 pixels, hence 0.1 % of their sum,
    // which is 0.02 N at a growth of 6 % per newton. The largest of 60 errors, with a dimmed lamp, is at most ten times
    // that.
    assert!(worst < 0.2, "{worst} N");
    let valid = sensed.iter().filter(|row| row["valid"] == "true").count();
    assert!(valid >= 16, "{valid} of 20");
    sense("new.jsonl");
    let lines = fs::read_to_string(folder.join("new.jsonl")).unwrap();
    assert!(lines.lines().count() == 20 && lines.contains("\"m_z\":null"));
    sense("new.mcap");
    let recorded = fs::read(folder.join("new.mcap")).unwrap();
    let schema = b"geometry_msgs/msg/WrenchStamped";
    assert!(recorded.windows(schema.len()).any(|bytes| bytes == schema));
}

#[test]
fn recording_makes_a_wrench_calibration() {
    let folder = measured("wrench-recorded");
    let start = [
        "sense",
        "pictures",
        "--rate",
        "10",
        "--layout",
        "layout.toml",
    ];
    let sensed = run(&folder, &[&start[..], &["-o", "sensed.mcap"]].concat());
    assert_eq!(sensed.status, Some(0), "{sensed:?}");
    // Images are in the order of their names: the 40 of "press", then those of "rub".
    let mut csv = String::from("recording,time,f_y,f_z\n");
    for number in 0..100 {
        let time = if number < 40 {
            number + 100
        } else {
            number - 40
        };
        let [_, y, z] = force(f64::from(time));
        writeln!(csv, "sensed.mcap,{:.1},{y},{z}", 0.1 * f64::from(number)).unwrap();
    }
    fs::write(folder.join("FORCES.csv"), csv).unwrap();
    let said = run(&folder, &CALIBRATE);
    assert_eq!(said.status, Some(0), "{said:?}");
    let text = fs::read_to_string(folder.join("wrench.toml")).unwrap();
    let calibration = WrenchCalibration::from_toml(&text).unwrap();
    assert!(calibration.quality.iter().all(|quality| quality.r2 > 0.9));
}

#[test]
fn unusable_tables_are_refused_and_damaged_images_skipped() {
    let folder = measured("wrench-refused");
    let good = fs::read_to_string(folder.join("FORCES.csv")).unwrap();
    let write = |text: &str| fs::write(folder.join("FORCES.csv"), text).unwrap();
    let noise: String = (0..60)
        .map(|number| {
            format!(
                "pictures/rub_{number}.png,{}\n",
                (f64::from(number) * 77.7).sin()
            )
        })
        .collect();
    write(&format!("picture,m_z\n{noise}"));
    run(&folder, &CALIBRATE).refused(&["FORCES.csv", "held-out R²", "m_z", "--force-fit"]);
    assert!(!folder.join("wrench.toml").exists());
    let forced = run(&folder, &[&CALIBRATE[..], &["--force-fit"]].concat());
    assert_eq!(forced.status, Some(0), "{forced:?}");
    assert!(
        forced.stderr.contains("kept because of --force-fit"),
        "{forced:?}"
    );

    write("picture,f_x\nnowhere.png,1\n");
    run(&folder, &[&CALIBRATE[..], &["--force"]].concat()).refused(&[
        "none of the images can be used",
        "line 2",
        "nowhere.png",
    ]);
    write("picture,f_x\npictures/rub_0.png,1\n");
    run(&folder, &[&CALIBRATE[..], &["--force"]].concat()).refused(&["at least 10", "got 1"]);
    write("picture,force\npictures/rub_0.png,1\n");
    run(&folder, &[&CALIBRATE[..], &["--force"]].concat()).refused(&["no column f_x"]);

    fs::write(
        folder.join("pictures/rub_3.png"),
        b"\x89PNG\r\n\x1a\nand no more",
    )
    .unwrap();
    write(&good);
    let ended = run(&folder, &[&CALIBRATE[..], &["--force"]].concat());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(
        ended.stderr.contains("skipped") && ended.stderr.contains("rub_3.png"),
        "{ended:?}"
    );

    let start = ["sense", "pictures", "--calibration", "wrench.toml"];
    run(&folder, &start).refused(&["--calibration wrench.toml", "another fingertip"]);
    let layout = ["--layout", "layout.toml", "--drift-correction"];
    run(&folder, &[&start[..], &layout[..]].concat()).refused(&["--drift-correction"]);
    let conflict = ["calibrate", "--simulated", "--wrench", "-o", "x.toml"];
    run(&folder, &conflict).refused(&["--wrench"]);
}

/// In white-on-black images all pixels of a spot are saturated, like the pins in two-level images. They remain usable.
#[test]
fn two_level_images_are_calibrated_and_sensed() {
    let folder = measured("wrench_two_levels");
    let pictures = fs::read_dir(folder.join("pictures")).unwrap();
    let mut pictures: Vec<_> = pictures.map(|entry| entry.unwrap().path()).collect();
    pictures.push(folder.join("untouched.png"));
    for path in pictures {
        let mut picture = image::open(&path).unwrap().into_luma8();
        let level = |gray: u8| if gray > 60 { 255 } else { 0 };
        picture
            .pixels_mut()
            .for_each(|pixel| pixel.0[0] = level(pixel.0[0]));
        picture.save(&path).unwrap();
    }
    let located = run(
        &folder,
        &["locate", "untouched.png", "-o", "layout.toml", "--force"],
    );
    assert_eq!(located.status, Some(0), "{located:?}");
    let ended = run(&folder, &CALIBRATE);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(!ended.stderr.contains("dark or saturated"), "{ended:?}");
    let start = ["sense", "pictures", "--layout", "layout.toml"];
    let ended = run(
        &folder,
        &[
            &start[..],
            &["--calibration", "wrench.toml", "-o", "again.csv"],
        ]
        .concat(),
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let sensed = rows(&folder.join("again.csv"));
    let valid = sensed.iter().filter(|row| row["valid"] == "true").count();
    assert!(valid > 90, "{valid} of 100 calibration images");
}
