//! Selection of the control steps that become the frames of an episode.

use crate::error::ExportError;
use feeler_record::{FingerStep, Recording, Step, Steps};

/// Maximum relative deviation of the control rate from a whole number, and excess of the frame rate over it.
const RATE_TOLERANCE: f64 = 1e-6;

/// Frame rate of a data set, and length of the windows of tactile samples. The default has a frame per control step and
/// no windows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Frames per second, at most the control rate. `None` for the control rate.
    pub fps: Option<u32>,
    /// Number of tactile samples in the window of each frame; see [`longest_window`](super::longest_window). `None` for
    /// no windows.
    pub window: Option<usize>,
}

/// Frames of an episode.
pub(crate) struct Frames<'a> {
    /// Control step of each frame.
    pub steps: Vec<Step<'a>>,
    /// Frames per second.
    pub rate: u32,
    /// Time of the first frame within the run (s).
    pub start: f64,
}

impl<'a> Frames<'a> {
    /// Selects the frames of `recording`: all control steps from the first at which every finger has a reading. With
    /// another rate or with windows, each frame is the control step that is nearest to its time.
    ///
    /// # Errors
    /// If the recording is incomplete, steps are missing, or the rate is higher than the control rate or not whole.
    pub fn of(
        run: &str,
        recording: &'a Recording,
        sampling: Sampling,
    ) -> Result<Self, ExportError> {
        let steps = control_steps(run, recording)?;
        let start = steps.first().map_or(0.0, |step| step.task.stamp);
        let Sampling { fps, window } = sampling;
        let rate = fps.map_or_else(|| frame_rate(run, recording), Ok)?;
        if fps.is_none() && window.is_none() {
            return Ok(Self { steps, rate, start });
        }
        let period = recording.facts.control_period;
        if f64::from(rate) * period > 1.0 + RATE_TOLERANCE || rate == 0 {
            let expected = format!(
                "1 to {:.6} frames per second, the control rate",
                1.0 / period
            );
            return Err(ExportError::of_run(run, "rate", expected, rate.to_string()));
        }
        let frames = Self {
            steps: Vec::new(),
            rate,
            start,
        };
        let steps = frames.nearest(&steps, period);
        Ok(Self { steps, ..frames })
    }

    /// Time of a frame within the run (s): that of the first frame plus LeRobot's timestamp.
    pub fn time(&self, frame: usize) -> f64 {
        self.start + frame as f64 / f64::from(self.rate)
    }

    /// Time of a frame's control step within the run (s), which differs from [`time`](Self::time) by up to half a
    /// control period.
    pub fn step_time(&self, frame: usize) -> f64 {
        let step = self.steps.get(frame);
        step.map_or_else(|| self.time(frame), |step| step.task.stamp)
    }

    /// Nearest of `steps` at the time of each frame.
    fn nearest(&self, steps: &[Step<'a>], period: f64) -> Vec<Step<'a>> {
        let end = steps
            .last()
            .map_or(f64::NEG_INFINITY, |last| last.task.stamp);
        let times = (0..).map(|frame| self.time(frame));
        let times = times.take_while(|time| *time <= end + 0.5 * period);
        let mut place = 0;
        let nearest = times.filter_map(|time| {
            let apart = |place: usize| Some((steps.get(place)?.task.stamp - time).abs());
            while apart(place + 1) < apart(place) && apart(place + 1).is_some() {
                place += 1;
            }
            steps.get(place).cloned()
        });
        nearest.collect()
    }
}

/// Frames per second of a recording. LeRobot requires a whole number.
///
/// # Errors
/// If the control rate is not a whole number of steps per second.
fn frame_rate(run: &str, recording: &Recording) -> Result<u32, ExportError> {
    let period = recording.facts.control_period;
    let rate = (1.0 / period).round();
    if (rate * period - 1.0).abs() > RATE_TOLERANCE || rate < 1.0 {
        let expected = "a whole number of control steps per second";
        let actual = format!("{} steps, one every {period} s", 1.0 / period);
        return Err(ExportError::of_run(run, "rate", expected, actual));
    }
    Ok(rate as u32)
}

/// Control steps of an episode: all from the first at which every finger has a reading.
///
/// # Errors
/// If the recording is incomplete, if steps are missing, or if there are no such steps.
fn control_steps<'a>(run: &str, recording: &'a Recording) -> Result<Vec<Step<'a>>, ExportError> {
    let refuse = |what: &str, expected: String, actual: String| {
        Err(ExportError::of_run(run, what, expected, actual))
    };
    if let Some(problem) = &recording.problem {
        let expected = "a complete recording, as frames have no timestamps";
        return refuse(
            "recording",
            expected.into(),
            format!("an incomplete one ({problem})"),
        );
    }
    let unfelt = |step: &Step<'_>| !step.fingers.iter().all(is_known);
    let steps: Vec<_> = Steps::new(recording).skip_while(unfelt).collect();
    if steps.is_empty() {
        let actual = format!(
            "{} steps without readings of all fingers",
            recording.task.len()
        );
        return refuse("control steps", "a reading of every finger".into(), actual);
    }
    let period = recording.facts.control_period;
    for pair in steps.windows(2) {
        let (from, to) = (pair[0].task.stamp, pair[1].task.stamp);
        if ((to - from) / period - 1.0).abs() > 0.5 {
            let expected = format!("one every {period} s");
            return refuse(
                "control steps",
                expected,
                format!("one at {from} s, the next at {to} s"),
            );
        }
    }
    Ok(steps)
}

fn is_known(finger: &FingerStep<'_>) -> bool {
    finger.tactile.is_some()
        && finger.flags.is_some()
        && finger.joints.is_some()
        && finger.command.is_some()
}
