//! Report page of a wrench calibration: errors on held-out images.

use super::document::{Tile, document, tiles};
use super::text::significant;
use crate::figures::wrench::{predicted_figure, residuals_figure};
use crate::page_data::PageData;
use maud::{Markup, html};

/// Content of the wrench calibration page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WrenchPage {
    /// Source of the forces.
    pub source: String,
    /// SHA-256 of the calibration target.
    pub sha256: String,
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// Calibrated components.
    pub axes: Vec<AxisPoints>,
    /// Components that were measured but could not be calibrated.
    pub left_out: Vec<&'static str>,
}

/// RMSE, MAE and mean error of one recording, in the component's unit.
pub type RecordingErrors = Option<[f64; 3]>;

/// Results for one component. Errors are in its unit, on images held out in blocks of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisPoints {
    /// Component name.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Regression terms.
    pub terms: String,
    /// Range of the measured values.
    pub range: [f64; 2],
    /// Root mean square error.
    pub rmse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Root mean square error of predicting the mean.
    pub mean_rmse: f64,
    /// Coefficient of determination.
    pub r2: f64,
    /// Mean error under growing load minus mean error under falling load; `None` if either has too few images.
    pub hysteresis: Option<f64>,
    /// For each recording with this component: name, errors with its blocks held out, and errors with the whole
    /// recording held out.
    pub recordings: Vec<(String, RecordingErrors, RecordingErrors)>,
    /// Measured images in chronological order.
    pub points: Vec<PredictedPoint>,
}

/// Measured and predicted value of one wrench component in one image, in the unit of the component.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PredictedPoint {
    /// Index of the recording.
    pub recording: usize,
    /// Measured value.
    pub measured: f64,
    /// Prediction with the image's block of time held out; NaN if there is no prediction.
    pub by_blocks: f64,
    /// Prediction with the image's recording held out; NaN if there is no prediction.
    pub by_recording: f64,
}

/// Renders the page as HTML.
pub fn wrench_page(page: &WrenchPage) -> String {
    let figures = page.axes.iter().enumerate().flat_map(|(index, axis)| {
        let number = 2 * index as u32 + 1;
        [
            predicted_figure(page, axis, number),
            residuals_figure(page, axis, number + 1),
        ]
    });
    let figures: Vec<_> = figures.collect();
    let body = html! {
        h1 { "Wrench calibration: " (page.source) }
        p.verdict { (verdict(page)) }
        (tiles(&page.axes.iter().map(tile).collect::<Vec<_>>()))
        h2 { "Components" }
        p.note {
            "Errors on held-out images: each recording is divided into blocks of time, and the model is fitted without the block under test."
        }
        (axes_table(page))
        h2 { "Recordings" }
        p.note { "Held out block by block, and as a whole. The mean error of a held-out recording is the drift between recordings." }
        (recordings_table(page))
        h2 { "Figures" }
        div.figures { @for figure in &figures { (figure.markup()) } }
        p { "Calibrated for the fingertip with SHA-256" br; span.digest { (page.sha256) } }
    };
    let title = format!("Wrench calibration: {}", page.source);
    document(&title, body, &PageData::of_figures(&title, &figures))
}

fn percent(axis: &AxisPoints) -> f64 {
    100.0 * axis.rmse / (axis.range[1] - axis.range[0])
}

fn tile(axis: &AxisPoints) -> Tile {
    let label = format!("RMS error of {}", axis.name);
    Tile::new(significant(axis.rmse), axis.unit, label)
}

fn verdict(page: &WrenchPage) -> Markup {
    let errors = page.axes.iter().map(|axis| {
        let (name, unit) = (axis.name, axis.unit);
        let (error, percent) = (significant(axis.rmse), percent(axis));
        format!("{name} {error} {unit} ({percent:.1} % of the measured range)")
    });
    let errors: Vec<_> = errors.collect();
    html! {
        "RMS error on held-out images: " (errors.join(", ")) "."
        @if !page.left_out.is_empty() {
            " Not calibrated, because the images do not predict them: " (page.left_out.join(", ")) "."
        }
    }
}

fn axes_table(page: &WrenchPage) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr {
                    th { "Component" }
                    @for name in ["Range", "RMSE", "% of range", "MAE", "RMSE of the mean", "R²", "Hysteresis"] {
                        th.number { (name) }
                    }
                    th { "Regressed on" }
                } }
                tbody {
                    @for axis in &page.axes {
                        tr {
                            td { (axis.name) " " span.unit { "(" (axis.unit) ")" } }
                            td.number { (format!("{:.3} to {:.3}", axis.range[0], axis.range[1])) }
                            td.number { (format!("{:.4}", axis.rmse)) }
                            td.number { (format!("{:.1}", percent(axis))) }
                            td.number { (format!("{:.4}", axis.mae)) }
                            td.number { (format!("{:.4}", axis.mean_rmse)) }
                            td.number { (format!("{:.3}", axis.r2)) }
                            td.number { (axis.hysteresis.map_or("unknown".into(), |h| format!("{h:+.4}"))) }
                            td { (axis.terms) }
                        }
                    }
                }
            }
        }
    }
}

fn recordings_table(page: &WrenchPage) -> Markup {
    let number = |errors: &RecordingErrors, which: usize| {
        errors.map_or("unknown".into(), |errors| format!("{:.4}", errors[which]))
    };
    html! {
        div.scroll {
            table {
                thead { tr {
                    th { "Component" } th { "Recording" }
                    @for name in ["RMSE", "MAE", "RMSE, held out", "MAE, held out", "Drift, held out"] {
                        th.number { (name) }
                    }
                } }
                tbody {
                    @for axis in &page.axes {
                        @for (name, blocks, left_out) in &axis.recordings {
                            tr {
                                td { (axis.name) " " span.unit { "(" (axis.unit) ")" } }
                                td { (name) }
                                td.number { (number(blocks, 0)) }
                                td.number { (number(blocks, 1)) }
                                td.number { (number(left_out, 0)) }
                                td.number { (number(left_out, 1)) }
                                td.number { (number(left_out, 2)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_contains_its_components_and_is_escaped() {
        let point = |measured: f64| PredictedPoint {
            measured,
            by_blocks: measured + 0.1,
            by_recording: f64::NAN,
            ..PredictedPoint::default()
        };
        let axis = AxisPoints {
            name: "f_x",
            unit: "N",
            range: [-1.0, 1.0],
            rmse: 0.1,
            recordings: vec![("<i>".into(), Some([0.1, 0.2, 0.3]), None)],
            points: [-1.0, 0.0, 1.0].map(point).to_vec(),
            ..AxisPoints::default()
        };
        let page = wrench_page(&WrenchPage {
            source: "<b>.csv".into(),
            recordings: vec!["<i>".into()],
            axes: vec![axis, AxisPoints::default()],
            left_out: vec!["m_z"],
            ..WrenchPage::default()
        });
        assert!(page.contains("&lt;b&gt;.csv") && page.contains("&lt;i&gt;"));
        assert!(page.contains("0.2000") && page.contains("unknown") && page.contains("m_z"));
        assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    }
}
