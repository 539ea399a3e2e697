//! Errors of a wrench calibration as text.

use feeler::sensor::wrench::CalibrationOf;
use feeler::sensor::wrench::basis::Basis;
use feeler::sensor::wrench::quality::{AxisQuality, Errors, RecordingQuality};
use std::fmt::Write;

/// Minimum width of the column of recording names.
const NAME: usize = 22;

/// Formats the held-out errors by component and by recording.
pub fn wrench_table<B: Basis>(calibration: &CalibrationOf<B>) -> String {
    let mut text = String::new();
    // Writing to a `String` cannot fail.
    let _ = write_axes(&mut text, calibration);
    let _ = write_recordings(&mut text, &calibration.quality);
    text
}

fn write_axes<B: Basis>(text: &mut String, calibration: &CalibrationOf<B>) -> std::fmt::Result {
    writeln!(
        text,
        "held-out errors with blocks of time left out (% of the measured range), RMSE of predicting the mean, and the error \
         that 95 % of valid samples do not exceed"
    )?;
    writeln!(
        text,
        "{:<10}{:>6}  {:<20}{:<20}{:>10}{:>8}{:>12}{:>10}  regressed on",
        "", "n", "RMSE", "MAE", "mean RMSE", "R²", "hysteresis", "95 %"
    )?;
    for quality in &calibration.quality {
        let axis = quality.axis;
        let (unit, factor) = axis.shown_unit();
        let with_percent =
            |error: f64| format!("{:.4} ({:.1} %)", factor * error, quality.percent(error));
        let errors = quality.blocks;
        let hysteresis = quality
            .hysteresis
            .map_or("-".into(), |h| format!("{:+.4}", factor * h));
        let model = calibration.axis(axis);
        let terms = model
            .map(|model| format!("{}, penalty {:.3}", B::describe(model.terms), model.penalty));
        writeln!(
            text,
            "{:<10}{:>6}  {:<20}{:<20}{:>10.4}{:>8.3}{:>12}{:>10}  {}",
            format!("{} ({unit})", axis.name()),
            errors.rows,
            with_percent(errors.rmse),
            with_percent(errors.mae),
            factor * quality.mean_rmse,
            quality.r2,
            hysteresis,
            quality
                .band_95
                .map_or("-".into(), |band| format!("{:.4}", factor * band)),
            terms.unwrap_or_default(),
        )?;
    }
    Ok(())
}

fn write_recordings(text: &mut String, qualities: &[AxisQuality]) -> std::fmt::Result {
    let names = qualities.iter().flat_map(|quality| &quality.recordings);
    let width = names.map(|recording| recording.name.chars().count()).max();
    let width = width.unwrap_or(0).max(NAME);
    writeln!(
        text,
        "\nby recording: RMSE / MAE with blocks of it left out; with the whole recording left out; its mean error then (drift)"
    )?;
    for quality in qualities {
        let (_, factor) = quality.axis.shown_unit();
        for RecordingQuality {
            name,
            blocks,
            left_out,
        } in &quality.recordings
        {
            let pair = |errors: &Option<Errors>| match errors {
                Some(errors) => format!("{:.4} / {:.4}", factor * errors.rmse, factor * errors.mae),
                None => "-".into(),
            };
            let drift =
                left_out.map_or("-".into(), |errors| format!("{:+.4}", factor * errors.bias));
            let rows = blocks.or(*left_out).map_or(0, |errors| errors.rows);
            writeln!(
                text,
                "{:<10}{name:<width$}  {rows:>6}  {:<18}  {:<18}  {drift:>9}",
                quality.axis.name(),
                pair(blocks),
                pair(left_out),
            )?;
        }
    }
    Ok(())
}
