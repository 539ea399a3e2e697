//! HTML report of a wrench calibration.

use feeler::sensor::wrench::FitOf;
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::quality::Errors;
use feeler_report::pages::{AxisPoints, PredictedPoint, WrenchPage, wrench_page as render};

/// Renders the report of a fit to the named `recordings` from `source`, as HTML.
pub fn wrench_page<B: Basis>(fitted: &FitOf<B>, recordings: &[String], source: &str) -> String {
    let calibration = &fitted.calibration;
    let axes = calibration.quality.iter().zip(&fitted.held_out);
    let axes = axes.map(|(quality, held_out)| {
        let model = calibration.axis(quality.axis);
        let (unit, factor) = quality.axis.shown_unit();
        let points = held_out.iter().map(|point| PredictedPoint {
            recording: point.recording,
            measured: factor * point.measured,
            by_blocks: factor * point.by_blocks.unwrap_or(f64::NAN),
            by_recording: factor * point.by_recording.unwrap_or(f64::NAN),
        });
        let shown = |e: Errors| [e.rmse, e.mae, e.bias].map(|error| factor * error);
        let rows = quality.recordings.iter().map(|recording| {
            let blocks = recording.blocks.map(shown);
            let left_out = recording.left_out.map(shown);
            (recording.name.clone(), blocks, left_out)
        });
        AxisPoints {
            name: quality.axis.name(),
            unit,
            terms: model
                .map(|model| B::describe(model.terms))
                .unwrap_or_default(),
            range: quality.range.map(|end| factor * end),
            rmse: factor * quality.blocks.rmse,
            mae: factor * quality.blocks.mae,
            mean_rmse: factor * quality.mean_rmse,
            r2: quality.r2,
            hysteresis: quality.hysteresis.map(|error| factor * error),
            band_95: quality.band_95.map(|band| factor * band),
            recordings: rows.collect(),
            points: points.collect(),
        }
    });
    render(&WrenchPage {
        source: source.into(),
        sha256: calibration.made_for.sha256.clone(),
        recordings: recordings.to_vec(),
        axes: axes.collect(),
        left_out: fitted
            .left_out
            .iter()
            .map(|(axis, _)| axis.name())
            .collect(),
    })
}
