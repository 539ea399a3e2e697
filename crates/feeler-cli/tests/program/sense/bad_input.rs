//! Invalid input is reported with the expected input, and valid frames are still sensed.

use super::rendered::{CALIBRATION, image, pictures, save};
use super::table::{WITH_FORCES, WITHOUT_FORCES, rows};
use crate::program::{Ended, folder, run};
use std::fs;

#[test]
fn damaged_files_are_skipped() {
    let folder = folder("sense-damaged");
    let pictures = pictures(6);
    let files = folder.join("pictures");
    save(&pictures, &files);
    let truncate = |name: &str| {
        let bytes = fs::read(files.join(name)).unwrap();
        fs::write(files.join(name), &bytes[..bytes.len() / 2]).unwrap();
    };
    truncate("frame2.png");
    fs::remove_file(files.join("frame3.png")).unwrap();
    image(&pictures[3].picture)
        .save(files.join("frame3.jpg"))
        .unwrap();
    truncate("frame3.jpg");
    fs::write(files.join("frame4.png"), "no picture").unwrap();
    fs::write(files.join("notes.txt"), "not named as a picture").unwrap();
    let ended = run(
        &folder,
        &["sense", "pictures", "--calibration", CALIBRATION],
    );
    assert_eq!(ended.status, Some(0), "{ended:?}");
    for name in ["frame2.png", "frame3.jpg", "frame4.png"] {
        let named = format!("skipped: pictures/{name}: ");
        assert_eq!(ended.stderr.matches(&named).count(), 1, "{ended:?}");
    }
    assert!(ended.stderr.contains("3 frames sensed"), "{ended:?}");
    assert!(ended.stderr.contains("3 skipped, 0 dropped"), "{ended:?}");
    let rows = rows(&ended.stdout, WITH_FORCES);
    let frames: Vec<_> = rows.chunks(41).map(|rows| rows[0].frame).collect();
    assert_eq!(frames, [0, 1, 5]);
    // Input without any valid image is refused.
    run(&folder, &["sense", "pictures/frame4.png"]).refused(&[
        "no frame",
        "1 skipped, the first: pictures/frame4.png: ",
        "an image (PNG",
    ]);
}

/// Files disappear before they are read, as if a disk had been removed.
#[cfg(unix)]
#[test]
fn files_that_disappear_are_reported_with_the_cause() {
    let folder = folder("sense-halfway");
    let files = folder.join("pictures");
    save(&pictures(4), &files);
    for frame in [2, 3] {
        let file = files.join(format!("frame{frame}.png"));
        fs::remove_file(&file).unwrap();
        std::os::unix::fs::symlink("gone.png", file).unwrap();
    }
    let ended = run(&folder, &["sense", "pictures", "-o", "out.csv"]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    for frame in [2, 3] {
        let named = format!("skipped: pictures/frame{frame}.png: No such file or directory");
        assert!(ended.stderr.contains(&named), "{ended:?}");
    }
    let table = fs::read_to_string(folder.join("out.csv")).unwrap();
    assert_eq!(rows(&table, WITHOUT_FORCES).len(), 2 * 41);
}

#[test]
fn images_of_another_size_are_skipped() {
    let folder = folder("sense-size");
    save(&pictures(3), &folder.join("pictures"));
    let small = image::GrayImage::new(320, 240);
    small.save(folder.join("pictures/frame1.png")).unwrap();
    let ended = run(&folder, &["sense", "pictures"]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert_eq!(rows(&ended.stdout, WITHOUT_FORCES).len(), 2 * 41);
    for said in [
        "skipped: pictures/frame1.png",
        "expected an image of 640x480 px",
        "320x240",
        "1 skipped, 0 dropped",
    ] {
        assert!(ended.stderr.contains(said), "{ended:?}");
    }
    // Input without any valid image is refused.
    small.save(folder.join("frame2.png")).unwrap();
    let named = ["sense", "frame2.png", "--experiment=cap-closing"];
    run(&folder, &named).refused(&["no frame", "1 skipped", "frame2.png"]);
    run(&folder, &["sense", "frame2.png"]).refused(&["frame2.png", "320x240", "feeler locate"]);
    fs::rename(
        folder.join("frame2.png"),
        folder.join("pictures/frame2.png"),
    )
    .unwrap();
    let reference = ["sense", "pictures", "--reference", "pictures/frame2.png"];
    run(&folder, &reference).refused(&["--reference pictures/frame2.png", "320x240"]);
    run(&folder, &["sense", "-", "--raw=320x240"]).refused(&["--raw 320x240", "640x480"]);
}

#[test]
fn repeated_image_is_kept_and_reported() {
    let folder = folder("sense-twice");
    let files = folder.join("pictures");
    save(&pictures(4), &files);
    let different = run(&folder, &["sense", "pictures"]);
    assert!(
        !different.stderr.contains("previous frame"),
        "{different:?}"
    );
    fs::copy(files.join("frame1.png"), files.join("frame2.png")).unwrap();
    let ended = run(&folder, &["sense", "pictures"]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let said = "1 frame with readings identical to the previous frame (kept), the first is frame 2";
    assert!(ended.stderr.contains(said), "{ended:?}");
    assert_eq!(rows(&ended.stdout, WITHOUT_FORCES).len(), 4 * 41);
}

#[test]
fn invalid_sources_are_refused() {
    let folder = folder("sense-sources");
    fs::create_dir(folder.join("empty")).unwrap();
    fs::write(folder.join("notes.txt"), "text").unwrap();
    fs::write(folder.join("empty/notes.txt"), "text").unwrap();
    fs::write(folder.join("bad.mcap"), "text").unwrap();
    let cases: [(&[&str], &[&str]); 20] = [
        (
            &["missing"],
            &["missing: ", "expected an image file or a folder"],
        ),
        (&["missing.png"], &["missing.png: ", "No such file"]),
        (
            &["empty"],
            &["empty: the folder contains no image", ".png", ".tiff"],
        ),
        (
            &["notes.txt"],
            &["notes.txt: expected a file ending in .png"],
        ),
        (&["bad.mcap"], &["bad.mcap", "nothing readable"]),
        (&["missing.mcap"], &["missing.mcap", "No such file"]),
        (&["-"], &["expected --raw WIDTHxHEIGHT"]),
        (&["-", "--raw=640"], &["expected WIDTHxHEIGHT"]),
        (&["-", "--raw=0x99999999"], &["1 to 16384"]),
        (
            &["empty", "--raw=640x480"],
            &["--raw requires raw frames", "empty"],
        ),
        (
            &["empty", "--exposure=0.01"],
            &["--exposure requires a camera"],
        ),
        (&["empty", "--gain=6"], &["--gain requires a camera"]),
        (
            &["empty", "--roi-offset=8,16"],
            &["--roi-offset requires a camera"],
        ),
        (
            &["empty", "--trigger=software"],
            &["--trigger requires a camera"],
        ),
        (&["genicam:", "--roi-offset=8"], &["COLUMN,ROW"]),
        (&["genicam:", "--exposure=0"], &["0.000001 to 1000 s"]),
        (&["genicam:", "--gain=nan"], &["expected a number"]),
        (&["genicam:", "--trigger=a b"], &["free, software"]),
        (&["empty", "--rate=nan"], &["expected 0.001 to 100000 Hz"]),
        (&["/dev/video99"], &["/dev/video99"]),
    ];
    for (arguments, words) in cases {
        let all = [&["sense"], arguments, &["-o", "out.csv"]].concat();
        run(&folder, &all).refused(words);
        assert!(!folder.join("out.csv").exists(), "{arguments:?}");
    }
    let both = [
        "sense",
        "empty",
        "--reference=a.png",
        "--calibration=b.toml",
    ];
    run(&folder, &both).refused(&["cannot be used with"]);
}

#[test]
fn missing_and_unsuitable_calibrations_are_refused() {
    let folder = folder("sense-calibration");
    save(&pictures(1), &folder.join("pictures"));
    let text = fs::read_to_string(CALIBRATION).unwrap();
    fs::write(folder.join("text.toml"), "text").unwrap();
    let other = text.replacen("dark_level = ", "dark_level = 1", 1);
    assert_ne!(other, text);
    fs::write(folder.join("other.toml"), other).unwrap();
    for (file, words) in [
        (
            "missing.toml",
            ["--calibration missing.toml", "No such file"],
        ),
        (
            "text.toml",
            ["--calibration text.toml", "not a calibration"],
        ),
        (
            "other.toml",
            ["--calibration other.toml", "changed after the calibration"],
        ),
    ] {
        run(&folder, &["sense", "pictures", "--calibration", file]).refused(&words);
    }
}

#[test]
fn unwritable_outputs_are_refused() {
    let folder = folder("sense-unwritable");
    save(&pictures(1), &folder.join("pictures"));
    let cases = [
        (
            "out.txt",
            ["out.txt", "expected a file ending in .csv, .jsonl or .mcap"],
        ),
        (
            "missing/out.csv",
            [
                "--output missing/out.csv",
                "expected a file in a writable folder",
            ],
        ),
        ("missing/out.mcap", ["missing/out.mcap", "No such file"]),
        (
            "pictures/frame0.png",
            ["frame0.png", "expected a file ending in .csv"],
        ),
    ];
    for (output, words) in cases {
        run(&folder, &["sense", "pictures", "-o", output]).refused(&words);
    }
}

#[test]
fn options_without_effect_are_refused() {
    let folder = folder("sense-no-effect");
    save(&pictures(1), &folder.join("pictures"));
    let cases = [
        ["--set=control.touch_force=1.0", "--set"],
        ["--seed=3", "--seed"],
        ["--rig=mine", "--rig"],
        ["--connect=tcp/127.0.0.1:7447", "--connect"],
    ];
    for [option, name] in cases {
        run(&folder, &["sense", "pictures", option]).refused(&[name, "without --publish"]);
    }
}

#[test]
fn failures_keep_an_existing_table() {
    let folder = folder("sense-keeps");
    save(&pictures(3), &folder.join("pictures"));
    let sense = ["sense", "pictures", "-o", "out.csv"];
    assert_eq!(run(&folder, &sense).status, Some(0));
    let good = fs::read(folder.join("out.csv")).unwrap();
    let unchanged = || assert_eq!(fs::read(folder.join("out.csv")).unwrap(), good);

    run(&folder, &sense).refused(&["--output out.csv", "exists already", "--force"]);
    unchanged();
    let forced = run(&folder, &[&sense[..], &["--force"]].concat());
    assert_eq!(forced.status, Some(0), "{forced:?}");
    unchanged();
    // No frame can be sensed.
    fs::create_dir(folder.join("none")).unwrap();
    fs::write(folder.join("none/a.png"), "no picture").unwrap();
    let none = ["sense", "none", "-o", "out.csv", "--force"];
    run(&folder, &none).refused(&["no frame"]);
    unchanged();
    assert!(!folder.join("out.csv.part").exists());
    // The partial file of a killed program is not overwritten either.
    let another = ["sense", "pictures/frame0.png", "-o", "new.csv"];
    fs::write(folder.join("new.csv.part"), &good[..good.len() / 2]).unwrap();
    run(&folder, &another).refused(&["new.csv.part: exists already"]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_endless_layout_or_calibration_is_refused() {
    let folder = folder("sense-endless");
    save(&pictures(1), &folder.join("pictures"));
    for option in ["--layout=/dev/zero", "--calibration=/dev/zero"] {
        let sense = ["sense", "pictures", option, "-o", "new.csv"];
        run(&folder, &sense).refused(&["/dev/zero", "longer than 16 MiB"]);
        assert!(!folder.join("new.csv").exists());
    }
}

#[test]
fn inputs_are_never_overwritten() {
    let folder = folder("sense-inputs");
    save(&pictures(1), &folder.join("pictures"));
    fs::copy(CALIBRATION, folder.join("c.csv")).unwrap();
    fs::copy(folder.join("pictures/frame0.png"), folder.join("r.csv")).unwrap();
    fs::hard_link(folder.join("c.csv"), folder.join("link.csv")).unwrap();
    for (option, output) in [
        ("--calibration=c.csv", "c.csv"),
        ("--calibration=c.csv", "pictures/../c.csv"),
        ("--calibration=c.csv", "link.csv"),
        ("--layout=c.csv", "c.csv"),
        ("--reference=r.csv", "r.csv"),
    ] {
        let before = fs::read(folder.join(output)).unwrap();
        let sense = ["sense", "pictures", option, "-o", output, "--force"];
        let ended = run(&folder, &sense);
        assert_eq!(ended.status, Some(2), "{ended:?}");
        assert_eq!(fs::read(folder.join(output)).unwrap(), before, "{option}");
    }
    let onto = |output| {
        [
            "sense",
            "pictures",
            "--calibration=c.csv",
            "--force",
            "-o",
            output,
        ]
    };
    for output in ["c.csv", "link.csv"] {
        run(&folder, &onto(output)).refused(&["--output", output, "the file is an input"]);
    }
}

#[cfg(unix)]
#[test]
fn full_disk_is_an_error_and_leaves_complete_rows() {
    let folder = folder("sense-full");
    save(&pictures(40), &folder.join("pictures"));
    for name in ["full.csv", "full.jsonl", "full.mcap"] {
        // The file size limit of 16 blocks of 512 bytes is reached within a row.
        let limited = "trap '' XFSZ; ulimit -f 16; exec \"$@\"";
        let mut command = std::process::Command::new("sh");
        command.args(["-c", limited, "sh", env!("CARGO_BIN_EXE_feeler")]);
        command.args(["sense", "pictures", "-o", name]);
        if name.ends_with("mcap") {
            command.arg("--record-frames");
        }
        let ended = Ended::of(command.current_dir(&folder).output().unwrap());
        ended.refused(&[name, "File too large", &format!("{name}.part is partial")]);
        assert!(!folder.join(name).exists());
        let part = fs::read(folder.join(format!("{name}.part"))).unwrap();
        assert!(!part.is_empty() && (name == "full.mcap" || part.ends_with(b"\n")));
    }
}
