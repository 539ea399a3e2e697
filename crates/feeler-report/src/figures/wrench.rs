//! Figures of a wrench calibration: predicted over measured values, and errors over time by recording.

use super::Figure;
use crate::figures::drawing::canvas::{Pen, airy, dots, finger_colour, line, panel, range};
use crate::figures::drawing::sheet::tiled;

/// RMSE, MAE and mean error of one recording, in the component's unit.
pub type RecordingErrors = Option<[f64; 3]>;

/// Results for one component. Errors are in its unit, on samples held out in blocks of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisPoints {
    /// Component name.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Terms of the regression, as text.
    pub terms: String,
    /// Range of the measured values.
    pub range: [f64; 2],
    /// Root mean square error.
    pub rmse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Root mean square error if the mean is always predicted.
    pub mean_rmse: f64,
    /// Coefficient of determination.
    pub r2: f64,
    /// Mean error under growing load minus mean error under falling load; `None` if either has too few samples.
    pub hysteresis: Option<f64>,
    /// Error that 95 % of valid samples do not exceed; `None` if unknown.
    pub band_95: Option<f64>,
    /// For each recording with this component: name, errors with its blocks held out, and errors with the whole
    /// recording held out.
    pub recordings: Vec<(String, RecordingErrors, RecordingErrors)>,
    /// Measured samples in chronological order.
    pub points: Vec<PredictedPoint>,
}

/// Measured and predicted value of one wrench component in one sample, in the unit of the component.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PredictedPoint {
    /// Index of the recording.
    pub recording: usize,
    /// Measured value.
    pub measured: f64,
    /// Prediction with the sample's block of time held out; NaN if there is no prediction.
    pub by_blocks: f64,
    /// Prediction with the sample's recording held out; NaN if there is no prediction.
    pub by_recording: f64,
}

/// Accessor for the error of a sample.
type ErrorOf = fn(&PredictedPoint) -> f64;

/// Maximum number of dots per recording.
const DOTS: usize = 400;
/// Maximum number of recordings with distinct colors.
const COLOURS: usize = 5;
/// Gray of the line of exact predictions.
const EXACT: &str = "#999999";

/// Predicted over measured values, with blocks of time held out.
pub fn predicted_figure(recordings: &[String], axis: &AxisPoints, number: u32) -> Figure {
    let measured = range(axis.points.iter().map(|p| p.measured)).unwrap_or((0.0, 1.0));
    let predicted = range(axis.points.iter().map(|p| p.by_blocks)).unwrap_or((0.0, 1.0));
    let ends = [(measured.0, measured.0), (measured.1, measured.1)];
    let mut plots = vec![line(ends, Pen::solid(EXACT, 1.4))];
    for recording in drawn(axis) {
        let points = axis.points.iter().filter(|p| p.recording == recording);
        let points: Vec<_> = points.map(|p| (p.measured, p.by_blocks)).collect();
        plots.push(dots(&points, DOTS, finger_colour(recording % COLOURS), 2.4));
    }
    let of = |what: &str| format!("{} {what} ({})", axis.name, axis.unit);
    let layout = panel(
        airy(measured),
        airy(predicted),
        &of("measured"),
        &of("predicted"),
    );
    let title = format!("{}: predicted over measured", axis.name);
    let drawing = tiled(
        (number, &title),
        &legend(recordings, axis),
        vec![(plots, layout)],
        1,
        320.0,
    );
    let caption = "Each dot is a sample, predicted with its block of time held out. Dots on the line are exact.";
    Figure::drawn(number, title, caption, Some(drawing))
}

/// Errors in chronological order with blocks held out and, if there are several recordings, with whole recordings held
/// out.
pub fn residuals_figure(recordings: &[String], axis: &AxisPoints, number: u32) -> Figure {
    let kinds: [(&str, ErrorOf); 2] = [
        ("blocks held out", |p| p.by_blocks - p.measured),
        ("recording held out", |p| p.by_recording - p.measured),
    ];
    let panels = kinds.into_iter().filter_map(|(kind, error)| {
        let errors = range(axis.points.iter().map(error))?;
        let last = axis.points.len().saturating_sub(1) as f64;
        let mut plots = vec![line([(0.0, 0.0), (last, 0.0)], Pen::solid(EXACT, 1.4))];
        for recording in drawn(axis) {
            let points = axis.points.iter().enumerate();
            let own = points.filter(|(_, p)| p.recording == recording);
            let own: Vec<_> = own.map(|(place, p)| (place as f64, error(p))).collect();
            plots.push(dots(&own, DOTS, finger_colour(recording % COLOURS), 2.4));
        }
        let label = format!("error, {kind} ({})", axis.unit);
        let layout = panel(airy((0.0, last)), airy(errors), "sample", &label);
        Some((plots, layout))
    });
    let title = format!("{}: errors in chronological order", axis.name);
    let drawing = tiled(
        (number, &title),
        &legend(recordings, axis),
        panels.collect(),
        1,
        240.0,
    );
    let caption = "Predicted minus measured, recording by recording. A recording with errors on one side only has drifted.";
    Figure::drawn(number, title, caption, Some(drawing))
}

/// Recordings in which the component was measured.
fn drawn(axis: &AxisPoints) -> Vec<usize> {
    let mut recordings: Vec<_> = axis.points.iter().map(|point| point.recording).collect();
    recordings.dedup();
    recordings
}

fn legend<'a>(recordings: &'a [String], axis: &AxisPoints) -> Vec<(&'a str, Pen)> {
    let named = drawn(axis).into_iter().take(COLOURS);
    let entry = |recording: usize| {
        let name = recordings.get(recording)?;
        let name = name.rsplit('/').next().unwrap_or(name);
        Some((name, Pen::solid(finger_colour(recording % COLOURS), 2.0)))
    };
    named.filter_map(entry).collect()
}
