//! Runs ffmpeg and parses its messages about frames.

use super::VideoFileError;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Error, Read};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};
use std::sync::mpsc::Sender;

/// Environment variable with the path of ffmpeg.
pub const VARIABLE: &str = "FEELER_FFMPEG";
/// Maximum length of a message line, bytes; longer lines are split.
const LONGEST: u64 = 1 << 16;

/// The ffmpeg program, given by the variable `FEELER_FFMPEG` or found in the search path.
#[derive(Debug, Clone)]
pub struct Ffmpeg {
    program: OsString,
    /// Name of the option that passes frames through unchanged, without duplicating or dropping any.
    sync: &'static str,
}

impl Ffmpeg {
    /// Finds ffmpeg.
    ///
    /// # Errors
    /// If ffmpeg cannot be started.
    pub fn find() -> Result<Self, VideoFileError> {
        let program = std::env::var_os(VARIABLE).unwrap_or_else(|| "ffmpeg".into());
        let mut command = Command::new(&program);
        let command = command.arg("-version").stdin(Stdio::null());
        let missing = |source| missing(&program, source);
        let output = command.stderr(Stdio::null()).output().map_err(missing)?;
        if !output.status.success() {
            let status = output.status;
            return Err(missing(Error::other(format!("exited with {status}"))));
        }
        let sync = sync_option(&String::from_utf8_lossy(&output.stdout));
        Ok(Self { program, sync })
    }

    /// Starts decoding the first video stream of `path`. Grey frames are written to the first pipe, messages to the
    /// second.
    pub(super) fn decode(
        &self,
        path: &Path,
    ) -> Result<(Child, ChildStdout, ChildStderr), VideoFileError> {
        // The prefix `file:` keeps the path from being taken as a URL or an option. The whitelist restricts references
        // inside the video to files.
        let mut input = OsString::from("file:");
        input.push(path);
        let mut command = Command::new(&self.program);
        command
            .args(["-nostdin", "-hide_banner", "-nostats"])
            .args(["-v", "repeat+level+info", "-protocol_whitelist", "file"])
            .arg("-i")
            .arg(input)
            .args(["-map", "0:V:0", "-vf", "showinfo=checksum=0"])
            .args([self.sync, "passthrough"])
            .args(["-f", "rawvideo", "-c:v", "rawvideo"])
            .args(["-pix_fmt", "gray", "-"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        // Ctrl-C reaches only feeler, which then ends ffmpeg.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let missing = |source| missing(&self.program, source);
        let mut child = command.spawn().map_err(missing)?;
        match (child.stdout.take(), child.stderr.take()) {
            (Some(pixels), Some(messages)) => Ok((child, pixels, messages)),
            _ => Err(missing(Error::other("no output pipe"))),
        }
    }
}

fn missing(program: &OsString, source: Error) -> VideoFileError {
    VideoFileError::NoFfmpeg {
        program: program.display().to_string(),
        source,
    }
}

/// Returns the name of the option in this version: `-vsync` before 5.1; later versions may have removed it.
fn sync_option(version: &str) -> &'static str {
    let number = version.strip_prefix("ffmpeg version ").unwrap_or_default();
    let number = number.trim_start_matches('n');
    let mut parts = number.split(|c: char| !c.is_ascii_digit());
    let mut part = || parts.next()?.parse::<u32>().ok();
    match part().zip(part()) {
        Some(version) if version < (5, 1) => "-vsync",
        _ => "-fps_mode",
    }
}

/// Properties of the next frame, as reported by ffmpeg before the frame itself.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameInfo {
    /// Presentation time, s.
    pub stamp: Option<f64>,
    /// Width and height, px.
    pub size: (usize, usize),
    /// Nominal frame rate of the stream, Hz.
    pub rate: Option<f64>,
}

/// Reads ffmpeg's `messages` until they end, and sends the properties of each frame that they report. Returns the first
/// message that reports damage, if any.
pub fn listen(messages: impl Read, frames: &Sender<FrameInfo>) -> Option<String> {
    let mut messages = BufReader::new(messages);
    let mut heard = Heard::default();
    let mut line = Vec::new();
    loop {
        line.clear();
        let read = (&mut messages).take(LONGEST).read_until(b'\n', &mut line);
        if read.unwrap_or(0) == 0 {
            return heard.complaint;
        }
        match heard.line(&String::from_utf8_lossy(&line)) {
            Ok(Some(frame)) => {
                // If the receiver is gone, continues to read so that ffmpeg does not block.
                let _ = frames.send(frame);
            }
            Ok(None) => {}
            Err(complaint) => return Some(complaint),
        }
    }
}

/// State collected from the messages.
#[derive(Default)]
struct Heard {
    /// Numerator and denominator of the unit of time stamps, s.
    time_base: Option<(f64, f64)>,
    rate: Option<f64>,
    complaint: Option<String>,
}

impl Heard {
    /// Returns the properties of the frame that `line` reports, if any.
    ///
    /// # Errors
    /// If these cannot be parsed.
    fn line(&mut self, line: &str) -> Result<Option<FrameInfo>, String> {
        if let Some(complaint) = complaint(line) {
            self.complaint.get_or_insert(complaint);
        }
        let Some((_, shown)) = line.split_once("[Parsed_showinfo") else {
            return Ok(None);
        };
        if let Some(time_base) = value(shown, "config in time_base:") {
            self.time_base = fraction(time_base);
            let rate = value(shown, "frame_rate:").and_then(fraction);
            let rate = rate.map(|(frames, seconds)| frames / seconds);
            self.rate = rate.filter(|rate| (1e-3..=1e5).contains(rate));
        }
        if value(shown, " pts_time:").is_none() {
            return Ok(None);
        }
        let size = value(shown, " s:").and_then(|size| {
            let (width, height) = size.split_once('x')?;
            Some((width.parse().ok()?, height.parse().ok()?))
        });
        let (Some(size), Some(pts), Some((unit, per))) =
            (size, value(shown, " pts:"), self.time_base)
        else {
            return Err(format!("unknown message {:?}", shown.trim_end()));
        };
        // `pts_time` has only 6 digits.
        let stamp = pts.parse::<i64>().ok().map(|pts| pts as f64 * unit / per);
        let rate = self.rate;
        Ok(Some(FrameInfo { stamp, size, rate }))
    }
}

/// Extracts a report of damage from a line: an error, or a warning about corrupt data.
fn complaint(line: &str) -> Option<String> {
    let after = |level| line.split_once(level).map(|(_, text)| text.trim_end());
    let warning = after("[warning] ").filter(|text| text.contains("corrupt"));
    let text = after("[error] ").or(after("[fatal] ")).or(warning)?;
    Some(text.to_owned())
}

/// Returns the value that follows `key` in a line, up to the next space or comma.
fn value<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(key)?;
    let value = rest.split_ascii_whitespace().next()?;
    Some(value.trim_end_matches(','))
}

fn fraction(text: &str) -> Option<(f64, f64)> {
    let (above, below) = text.split_once('/')?;
    let (above, below) = (above.parse().ok()?, below.parse().ok()?);
    (above > 0.0 && below > 0.0).then_some((above, below))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    fn heard(text: &str) -> (Vec<FrameInfo>, Option<String>) {
        let (sender, receiver) = channel();
        let complaint = listen(text.as_bytes(), &sender);
        drop(sender);
        (receiver.iter().collect(), complaint)
    }

    #[test]
    fn frame_times_are_exact_and_damage_is_reported() {
        let text = "[info]   Stream #0:0: Video: h264, 64x48, 25 fps\n\
            [Parsed_showinfo_0 @ 0x1] [info] config in time_base: 1/90000, frame_rate: 30000/1001\n\
            [Parsed_showinfo_0 @ 0x1] [info] config out time_base: 0/0, frame_rate: 0/0\n\
            [Parsed_showinfo_0 @ 0x1] [info] n:   0 pts:1234567890 pts_time:13717.4 pos: 48 fmt:yuv420p sar:1/1 s:64x48 i:P\n\
            [Parsed_showinfo_0 @ 0x1] [info] n:   1 pts:  NOPTS pts_time:NOPTS   fmt:gray sl:0 s:64x48 [h264 @ 0x2] [error] no frame!\n\
            [warning] file:a.mp4: corrupt input packet in stream 0\n";
        let (frames, complaint) = heard(text);
        let rate = Some(30_000.0 / 1001.0);
        let frame = |stamp| FrameInfo {
            stamp,
            size: (64, 48),
            rate,
        };
        assert_eq!(
            frames,
            [frame(Some(1_234_567_890.0 / 90_000.0)), frame(None)]
        );
        assert_eq!(complaint.as_deref(), Some("no frame!"));
        let (_, complaint) = heard("[warning] deprecated\n[warning] a: corrupt input packet");
        assert_eq!(complaint.as_deref(), Some("a: corrupt input packet"));
    }

    #[test]
    fn unknown_messages_end_the_video() {
        let (frames, complaint) = heard("[Parsed_showinfo_0 @ 0x1] n:0 pts:0 pts_time:0 s:wide\n");
        assert!(frames.is_empty() && complaint.unwrap().contains("s:wide"));
        assert_eq!(heard(&"x".repeat(200_000)), (Vec::new(), None));
    }

    #[test]
    fn the_option_depends_on_the_version() {
        for (version, option) in [
            ("ffmpeg version 4.4.2-0ubuntu0.22.04.1 Copyright", "-vsync"),
            ("ffmpeg version n5.0.1", "-vsync"),
            ("ffmpeg version 5.1.9-0+deb12u1", "-fps_mode"),
            ("ffmpeg version 8.0-static", "-fps_mode"),
            ("ffmpeg version N-109542-gc8f6d1b", "-fps_mode"),
            ("", "-fps_mode"),
        ] {
            assert_eq!(sync_option(version), option, "{version}");
        }
    }
}
