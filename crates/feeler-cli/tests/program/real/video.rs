//! Frames of videos, decoded by ffmpeg.

use crate::how_many::is_long;
use crate::recordings::cannot;
use feeler::sensor::image::Picture;
use feeler_sources::decode_picture;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The ffmpeg program. If it is missing, reports the test called `test` as skipped and returns `None`.
pub fn ffmpeg(test: &str) -> Option<OsString> {
    let program = std::env::var_os("FEELER_FFMPEG").unwrap_or_else(|| "ffmpeg".into());
    let mut version = Command::new(&program);
    version
        .arg("-version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if version.status().is_ok_and(|status| status.success()) {
        return Some(program);
    }
    cannot(test, "ffmpeg not found; set FEELER_FFMPEG");
    None
}

/// The videos in `folder`, sorted by name.
pub fn videos(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut videos: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|extension| extension == "avi"))
        .collect();
    videos.sort();
    assert!(!videos.is_empty(), "no video in {}", folder.display());
    videos
}

/// Every third of the [`videos`] in `folder`, or all of them if `FEELER_LONG_TESTS` is set.
pub fn every_third(folder: &Path) -> Vec<PathBuf> {
    let step = if is_long() { 1 } else { 3 };
    videos(folder).into_iter().step_by(step).collect()
}

/// Output of ffmpeg for the frames of `video` from number `first` on, with more arguments.
pub fn decode(ffmpeg: &OsString, video: &Path, first: usize, arguments: &[&str]) -> Vec<u8> {
    let mut command = Command::new(ffmpeg);
    command.args(["-nostdin", "-v", "error", "-i"]).arg(video);
    command.args(["-vf", &format!("select=gte(n\\,{first})")]);
    let output = command
        .args(arguments)
        .args(["-pix_fmt", "gray", "-"])
        .output();
    let output = output.expect("ffmpeg");
    assert!(output.status.success(), "{}: {output:?}", video.display());
    output.stdout
}

/// Frame number `number` of `video`.
pub fn frame(ffmpeg: &OsString, video: &Path, number: usize) -> Picture {
    let one = ["-frames:v", "1", "-f", "image2pipe", "-c:v", "pgm"];
    let bytes = decode(ffmpeg, video, number, &one);
    decode_picture(&bytes).unwrap_or_else(|e| panic!("{}: {e}", video.display()))
}
