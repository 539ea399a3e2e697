//! Video files as sources, decoded by ffmpeg.

use crate::program::{Ended, feeler, folder, rows, run};
use crate::skip::skipped;
use image::GrayImage;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The ffmpeg program. If it is missing, reports the test as skipped and returns `None`.
pub fn ffmpeg() -> Option<OsString> {
    let program = std::env::var_os("FEELER_FFMPEG").unwrap_or_else(|| "ffmpeg".into());
    let mut version = Command::new(&program);
    version.arg("-version").stdout(Stdio::null());
    if version.status().is_ok_and(|status| status.success()) {
        return Some(program);
    }
    skipped("ffmpeg not found; set FEELER_FFMPEG");
    None
}

/// Runs ffmpeg in `folder`, and returns whether it succeeded.
fn encode(ffmpeg: &OsString, folder: &Path, arguments: &str) -> bool {
    let mut command = Command::new(ffmpeg);
    command.args(["-nostdin", "-v", "error", "-y"]);
    command.args(arguments.split_ascii_whitespace());
    let status = command.current_dir(folder).status();
    status.expect("ffmpeg").success()
}

const SIZE: (u32, u32) = (150, 120);
const FRAMES: usize = 12;

/// Renders 20 round spots, moved to the right by `shift` px.
fn spots(shift: f32) -> GrayImage {
    GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| {
        let near = |v: f32| ((v + 12.5) % 25.0 - 12.5).powi(2);
        let inside = (12..138).contains(&x) && (12..113).contains(&y);
        let distance = near(x as f32 - shift) + near(y as f32);
        let lit = if inside {
            180.0 * (-distance / 12.0).exp()
        } else {
            0.0
        };
        image::Luma([10 + lit as u8])
    })
}

/// Writes images `p/00.png` to `p/11.png`, the first black, and `clip.mkv`, a lossless video of them with 25 frames per
/// second.
fn clip(ffmpeg: &OsString, folder: &Path) {
    fs::create_dir(folder.join("p")).unwrap();
    for number in 0..FRAMES {
        let picture = match number {
            0 => GrayImage::new(SIZE.0, SIZE.1),
            _ => spots(number as f32 / 4.0),
        };
        picture
            .save(folder.join(format!("p/{number:02}.png")))
            .unwrap();
    }
    assert!(encode(
        ffmpeg,
        folder,
        "-framerate 25 -i p/%02d.png -c:v ffv1 -pix_fmt gray clip.mkv"
    ));
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn video_frame_is_located_like_its_image() {
    let Some(ffmpeg) = ffmpeg() else { return };
    let folder = folder("video-locate");
    clip(&ffmpeg, &folder);
    run(&folder, &["locate", "p/01.png", "-o", "picture.toml"]).done();
    run(&folder, &["locate", "clip.mkv@0.05", "-o", "frame.toml"]).done();
    assert_eq!(read(&folder, "picture.toml"), read(&folder, "frame.toml"));
    // The first frame is black, like its image.
    let words = run(&folder, &["locate", "p/00.png", "-o", "no.toml"]).refused(&["feeler: "]);
    run(&folder, &["locate", "clip.mkv", "-o", "no.toml"]).refused(&[words.trim_end()]);
    run(&folder, &["locate", "clip.mkv@2", "-o", "no.toml"])
        .refused(&["clip.mkv@2", "expected a time from 0 to 0.44 s"]);
    for named in ["clip.mkv", "clip.mkv@0.05"] {
        run(&folder, &["locate", named, "--force", "-o", "clip.mkv"])
            .refused(&["the file is an input"]);
    }
}

#[test]
fn video_is_sensed_like_its_images_with_its_frame_times() {
    let Some(ffmpeg) = ffmpeg() else { return };
    let folder = folder("video-sense");
    clip(&ffmpeg, &folder);
    run(&folder, &["locate", "p/01.png", "-o", "layout.toml"]).done();
    let sense = |source: &str, more: &[&str], output: &str| {
        let arguments = ["sense", source, "--layout=layout.toml", "-o", output];
        let ended = run(&folder, &[&arguments[..], more].concat());
        assert_eq!(ended.status, Some(0), "{ended:?}");
        read(&folder, output)
    };
    let pictures = sense("p", &["--rate=25"], "p.csv");
    let video = sense("clip.mkv", &[], "v.csv");
    assert_eq!(video, pictures);
    assert_eq!(sense("clip.mkv", &["--rate=25"], "r.csv"), pictures);
    // Every third and every fifth frame, with their original times.
    let some = "-i clip.mkv -vf select='not(mod(n,3))+not(mod(n,5))' -fps_mode passthrough -c:v ffv1 some.mkv";
    assert!(encode(&ffmpeg, &folder, some));
    sense("some.mkv", &[], "s.csv");
    let (all, some) = (rows(&folder.join("v.csv")), rows(&folder.join("s.csv")));
    let elements = all.len() / FRAMES;
    let kept = [0, 3, 5, 6, 9, 10];
    assert_eq!(some.len(), kept.len() * elements);
    for (position, row) in some.iter().enumerate() {
        let same = &all[kept[position / elements] * elements + position % elements];
        for column in ["stamp", "element", "integrated_gray", "u_x"] {
            assert_eq!(row[column], same[column], "{column} of {row:?}");
        }
    }
    let refused = ["sense", "clip.mkv", "p", "--layout=layout.toml"];
    run(&folder, &refused).refused(&["clip.mkv: expected a single video"]);
}

#[test]
fn rotation_of_a_video_is_applied() {
    let Some(ffmpeg) = ffmpeg() else { return };
    let folder = folder("video-rotated");
    clip(&ffmpeg, &folder);
    assert!(encode(
        &ffmpeg,
        &folder,
        "-i clip.mkv -c:v mpeg4 -q:v 1 upright.mp4"
    ));
    // The first option is that of ffmpeg 6 and later.
    let rotated = encode(
        &ffmpeg,
        &folder,
        "-display_rotation 90 -i upright.mp4 -c copy turned.mp4",
    ) || encode(
        &ffmpeg,
        &folder,
        "-i upright.mp4 -c copy -metadata:s:v rotate=90 turned.mp4",
    );
    assert!(rotated);
    let out = run(&folder, &["locate", "turned.mp4@0.2", "-o", "turned.toml"]).done();
    assert!(out.contains("in 120x150 px"), "{out}");
    run(&folder, &["sense", "upright.mp4", "--layout=turned.toml"])
        .refused(&["upright.mp4 150x120", "120x150 px"]);
}

#[test]
fn truncated_video_gives_a_partial_table() {
    let Some(ffmpeg) = ffmpeg() else { return };
    let folder = folder("video-truncated");
    clip(&ffmpeg, &folder);
    run(&folder, &["locate", "p/01.png", "-o", "layout.toml"]).done();
    let whole = fs::read(folder.join("clip.mkv")).unwrap();
    fs::write(folder.join("torn.mkv"), &whole[..whole.len() * 2 / 3]).unwrap();
    let sense = ["sense", "torn.mkv", "--layout=layout.toml", "-o", "t.csv"];
    let words = ["torn.mkv: the video is damaged", "t.csv.part is partial"];
    let stderr = run(&folder, &sense).refused(&words);
    assert!(!folder.join("t.csv").exists(), "{stderr}");
    let sensed = rows(&folder.join("t.csv.part")).len() / 20;
    assert!((1..FRAMES).contains(&sensed), "{sensed}");
    let count = format!("{sensed} frames were decoded");
    assert!(stderr.contains(&count), "no {count} in {stderr}");
    run(&folder, &["locate", "torn.mkv@0.04", "-o", "no.toml"]).refused(&words[..1]);
}

#[test]
fn invalid_videos_are_refused() {
    let folder = folder("video-bad");
    fs::write(folder.join("empty.mp4"), "").unwrap();
    fs::write(folder.join("text.MP4"), "nothing").unwrap();
    fs::create_dir(folder.join("folder.mp4")).unwrap();
    let commands = |name: &'static str| {
        let sense = ["sense", name, "--experiment=cap-closing", "-o", "o.csv"];
        [vec!["locate", name, "-o", "o.toml"], sense.to_vec()]
    };
    for command in commands("empty.mp4") {
        run(&folder, &command).refused(&["empty.mp4: the file is empty"]);
    }
    for command in commands("none.mp4") {
        run(&folder, &command).refused(&["none.mp4", "expected a video"]);
    }
    for command in commands("folder.mp4") {
        run(&folder, &command).refused(&["folder.mp4: "]);
    }
    for command in commands("text.MP4") {
        let mut program = feeler(&folder, &command);
        let program = program.env("FEELER_FFMPEG", "./no-ffmpeg");
        Ended::of(program.output().unwrap()).refused(&[
            "./no-ffmpeg",
            "ffmpeg is required",
            "apt-get install ffmpeg",
        ]);
    }
    let Some(ffmpeg) = ffmpeg() else { return };
    for command in commands("text.MP4") {
        run(&folder, &command).refused(&["text.MP4: no video frame found", "ffmpeg: "]);
    }
    let sound = "-f lavfi -i sine=duration=1 -c:a aac sound.mp4";
    assert!(encode(&ffmpeg, &folder, sound));
    for command in commands("sound.mp4") {
        run(&folder, &command).refused(&["sound.mp4: no video frame found"]);
    }
    assert!(!folder.join("o.csv").exists() && !folder.join("o.toml").exists());
}

#[test]
fn video_frames_make_the_same_calibration_as_images() {
    let Some(ffmpeg) = ffmpeg() else { return };
    let folder = folder("video-calibrate");
    let simulated = ["calibrate", "--simulated", "--loads=20", "-o", "s.toml"];
    run(
        &folder,
        &[&simulated[..], &["--write-loads=loads"]].concat(),
    )
    .done();
    let pictures = "-framerate 10 -i loads/%05d.png -c:v ffv1 -pix_fmt gray loads/clip.mkv";
    assert!(encode(&ffmpeg, &folder, pictures));
    let calibrate = |loads: &str| {
        let path = format!("loads/{loads}");
        run(&folder, &["calibrate", &path, "--force", "-o", "c.toml"])
    };
    calibrate("LOADS.csv").done();
    let expected = read(&folder, "c.toml");
    let loads = read(&folder, "loads/LOADS.csv");
    let named = |row: &str| match row.split_once(".png") {
        Some((number, rest)) => {
            let time = 0.1 * number.parse::<f64>().unwrap();
            format!("clip.mkv@{time:.1}{rest}\n")
        }
        None => format!("{row}\n"),
    };
    let rows: String = loads.lines().map(named).collect();
    fs::write(folder.join("loads/V.csv"), rows).unwrap();
    calibrate("V.csv").done();
    assert_eq!(read(&folder, "c.toml"), expected);

    let refused = |picture: &str, words: &[&str]| {
        // The first row refers to a later frame than the second.
        let text =
            format!("picture,element,f_x,f_y,f_z\nclip.mkv@0.5,0,0,0,1\n{picture},0,0,0,1\n");
        fs::write(folder.join("loads/BAD.csv"), text).unwrap();
        calibrate("BAD.csv").refused(words);
    };
    refused("clip.mkv@1e5", &["line 3", "expected a time from 0 to"]);
    refused("clip.mkv", &["line 3", "expected FILE@TIME"]);
    refused("none.mkv@1", &["line 3", "none.mkv"]);
    fs::write(folder.join("loads/empty.avi"), "").unwrap();
    refused("empty.avi@1", &["line 3", "the file is empty"]);
}
