//! Videos of a marker gel: locating and tracking the markers.

use super::blobs::{Blob, blobs, median_area};
use super::fit::{Profile, centre};
use super::video::{decode, every_third, ffmpeg, frame};
use crate::program::{Ended, feeler, folder, rows, run};
use crate::recordings::recordings;
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, Located, Polarity, ReferencePicture, locate};
use image::GrayImage;
use std::collections::HashMap;
use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

/// First frame in which markers are tracked. In earlier frames, the lamps settle.
const SETTLED: usize = 12;

/// Quantile of the values: the fraction `part` of them is below the result.
fn quantile(values: &mut [f64], part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * part).round() as usize]
}

/// The element nearest to a blob, if its distance is at most `radius` (px).
fn element_of(located: &Located, blob: &Blob, radius: f64) -> Option<[f64; 2]> {
    let elements = located.elements.iter().map(|e| e.centre_px.to_array());
    let nearest = elements.min_by(|a, b| blob.distance(*a).total_cmp(&blob.distance(*b)));
    nearest.filter(|place| blob.distance(*place) <= radius)
}

/// Asserts that all whole spots are elements and all elements are spots. Returns each whole spot with the position of
/// its element (px).
fn compared(name: &str, picture: &Picture, located: &Located) -> Vec<(Blob, [f64; 2])> {
    let strong = blobs(picture, true, 0.5);
    let typical = median_area(&strong);
    let whole = strong
        .iter()
        .filter(|blob| !blob.at_border && 3 * blob.area > typical);
    let whole: Vec<Blob> = whole.cloned().collect();
    assert!(whole.len() >= 8, "{name}: {} whole spots", whole.len());
    let radius = (typical as f64 / std::f64::consts::PI).sqrt();
    let pairs = whole.into_iter().map(|blob| {
        let element = element_of(located, &blob, radius);
        let element = element.unwrap_or_else(|| panic!("{name}: no element at {blob:?}"));
        (blob, element)
    });
    let pairs: Vec<_> = pairs.collect();
    // A worn marker has half of the contrast of others, and is not among the whole ones. At that contrast, a shadow may
    // merge with a marker.
    let faint = [strong, blobs(picture, true, 0.25)].concat();
    for element in &located.elements {
        let place = element.centre_px.to_array();
        let real = faint.iter().any(|blob| blob.distance(place) <= radius);
        assert!(real, "{name}: nothing is at {place:?}");
    }
    pairs
}

/// Uses the first frame of videos. The median distance to fitted spots must be at most 0.1 px, for flat-topped
/// spots, which resemble the markers, and for Gaussian ones.
#[test]
fn all_whole_markers_are_located_without_false_positives() {
    let test = "all_whole_markers_are_located_without_false_positives";
    let Some((data, ffmpeg)) = recordings("gelsight-slip", test).zip(ffmpeg(test)) else {
        return;
    };
    let (mut flat, mut gaussian) = (Vec::new(), Vec::new());
    for video in every_third(&data) {
        let name = video.display().to_string();
        let picture = frame(&ffmpeg, &video, 0);
        let reference = ReferencePicture::mean([&picture]).unwrap();
        let located = locate(&reference, &LocateConfig::default());
        let located = located.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(located.polarity, Polarity::Dark, "{name}");
        for (blob, [x, y]) in compared(&name, &picture, &located) {
            let off = |profile| {
                let fitted = centre(&picture, &blob, profile);
                (fitted[0] - x).hypot(fitted[1] - y)
            };
            flat.push(off(Profile::Flat));
            gaussian.push(off(Profile::Gaussian));
        }
    }
    for (errors, profile) in [(&mut flat, "flat"), (&mut gaussian, "Gaussian")] {
        let (median, most) = (quantile(errors, 0.5), quantile(errors, 0.95));
        let count = errors.len();
        println!(
            "{count} markers against a {profile} spot: {median:.3} px at the median, {most:.3} px at the 95th percentile"
        );
        assert!(median <= 0.1, "{profile}: {median} px");
    }
}

/// Positions of the markers in the last frame of a table of tracks (px).
fn last_places(folder: &Path) -> Vec<[f64; 2]> {
    let text = fs::read_to_string(folder.join("gel.toml")).unwrap();
    let layout = LocatedLayout::from_toml(&text).unwrap();
    let tracks = rows(&folder.join("tracks.csv"));
    let last = &tracks[tracks.len() - layout.elements.len()..];
    let number = |row: &HashMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    let places = layout.elements.iter().zip(last).map(|(element, row)| {
        let from = element.centre_px;
        [from.x + number(row, "u_x"), from.y + number(row, "u_y")]
    });
    places.collect()
}

/// Result of tracking: numbers of table rows, of rows with a lost marker, of markers, and of markers that are not on a
/// spot in the last frame.
#[derive(Debug, Default, Clone, Copy)]
struct Followed {
    rows: usize,
    lost: usize,
    markers: usize,
    off_spots: usize,
}

/// Tracks the markers of `video` with the program, from the frame in which they are located to the end.
fn followed(ffmpeg: &OsString, video: &Path, folder: &Path) -> Followed {
    let Picture {
        width,
        height,
        pixels,
    } = frame(ffmpeg, video, SETTLED);
    let size = format!("{width}x{height}");
    let reference = GrayImage::from_raw(width as u32, height as u32, pixels).unwrap();
    reference.save(folder.join("reference.png")).unwrap();
    let located = run(
        folder,
        &["locate", "reference.png", "-o", "gel.toml", "--force"],
    );
    assert_eq!(located.status, Some(0), "{located:?}");
    let frames = decode(ffmpeg, video, SETTLED, &["-f", "rawvideo"]);
    let sense = [
        "sense", "-", "--raw", &size, "--layout", "gel.toml", "--track",
    ];
    let mut command = feeler(
        folder,
        &[&sense[..], &["-o", "tracks.csv", "--force"]].concat(),
    );
    let command = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(&frames).unwrap();
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let count = frames.len() / (width * height);
    assert!(
        ended.stderr.contains(&format!("{count} frames sensed")),
        "{ended:?}"
    );
    assert!(ended.stderr.contains("; 0 skipped, 0 dropped"), "{ended:?}");
    let newest = frames[(count - 1) * width * height..].to_vec();
    let newest = Picture {
        width,
        height,
        pixels: newest,
    };
    let places = last_places(folder);
    let at_end = on_spots(&video.display().to_string(), &newest, &places);
    let tracks = rows(&folder.join("tracks.csv"));
    let lost = |row: &&HashMap<String, String>| row["confidence"].parse::<f64>().unwrap() == 0.0;
    Followed {
        rows: tracks.len(),
        lost: tracks.iter().filter(lost).count(),
        markers: places.len(),
        off_spots: places.len() - at_end,
    }
}

/// Number of `places` on a spot of `picture`. Asserts that no spot has two of them.
fn on_spots(name: &str, picture: &Picture, places: &[[f64; 2]]) -> usize {
    let spots = blobs(picture, true, 0.5);
    let radius = (median_area(&spots) as f64 / std::f64::consts::PI).sqrt();
    let mut taken = vec![0; spots.len()];
    for &place in places {
        let near = spots.iter().position(|spot| spot.distance(place) <= radius);
        if let Some(spot) = near {
            taken[spot] += 1;
        }
    }
    assert!(
        taken.iter().all(|&count| count <= 1),
        "{name}: two markers on a spot"
    );
    taken.iter().sum()
}

/// Tracks from the 13th frame to the end of videos. At most 1 % of the markers in all frames may be lost: those
/// that leave the image with the gel, and those that fade under pressure. In the last frames, at most 2 % may be off a
/// spot.
#[test]
fn markers_are_tracked_to_the_end_of_videos() {
    let test = "markers_are_tracked_to_the_end_of_videos";
    let Some((data, ffmpeg)) = recordings("gelsight-slip", test).zip(ffmpeg(test)) else {
        return;
    };
    let folder = folder("real-tracks");
    let mut all = Followed::default();
    for video in every_third(&data) {
        let own = followed(&ffmpeg, &video, &folder);
        println!("{}: {own:?}", video.display());
        all.rows += own.rows;
        all.lost += own.lost;
        all.markers += own.markers;
        all.off_spots += own.off_spots;
    }
    println!("{all:?}");
    assert!(100 * all.lost <= all.rows, "{all:?}");
    assert!(50 * all.off_spots <= all.markers, "{all:?}");
}
