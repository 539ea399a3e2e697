//! HTML report of a wrench calibration.

use feeler::sensor::wrench::FitOf;
use feeler::sensor::wrench::basis::Basis;
use feeler_report::pages::{AxisPoints, PredictedPoint, WrenchPage, wrench_page as render};

/// Renders the report of a fit to the named `recordings` from `source`, as HTML.
pub fn wrench_page<B: Basis>(fitted: &FitOf<B>, recordings: &[String], source: &str) -> String {
    let calibration = &fitted.calibration;
    let axes = calibration.quality.iter().zip(&fitted.held_out);
    let axes = axes.map(|(quality, held_out)| {
        let model = calibration.axis(quality.axis);
        let points = held_out.iter().map(|point| PredictedPoint {
            recording: point.recording,
            measured: point.measured,
            by_blocks: point.by_blocks.unwrap_or(f64::NAN),
            by_recording: point.by_recording.unwrap_or(f64::NAN),
        });
        let rows = quality.recordings.iter().map(|recording| {
            let blocks = recording.blocks.map(|e| [e.rmse, e.mae, e.bias]);
            let left_out = recording.left_out.map(|e| [e.rmse, e.mae, e.bias]);
            (recording.name.clone(), blocks, left_out)
        });
        AxisPoints {
            name: quality.axis.name(),
            unit: quality.axis.unit(),
            terms: model
                .map(|model| B::describe(model.terms))
                .unwrap_or_default(),
            range: quality.range,
            rmse: quality.blocks.rmse,
            mae: quality.blocks.mae,
            mean_rmse: quality.mean_rmse,
            r2: quality.r2,
            hysteresis: quality.hysteresis,
            band_95: quality.band_95,
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
