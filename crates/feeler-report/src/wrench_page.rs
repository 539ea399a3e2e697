//! The page of a wrench calibration: how far off it is on pictures that it has not seen.

use super::document::{Tile, document, tiles};
use super::figures::wrench::{predicted_figure, residuals_figure};
use super::page_data::PageData;
use super::text::significant;
use maud::{Markup, html};

/// What the page says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WrenchPage {
    /// Where the forces come from.
    pub source: String,
    /// SHA-256 of what it was made for.
    pub sha256: String,
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// The components that are calibrated.
    pub axes: Vec<AxisPoints>,
    /// Names of the components that were measured and are not.
    pub left_out: Vec<&'static str>,
}

/// Errors of one recording: RMSE, MAE and mean, in the component's unit.
pub type RecordingErrors = Option<[f64; 3]>;

/// One component. Errors are those on pictures that were not seen, blocks of time left out, in its unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisPoints {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What it is regressed on, in words.
    pub terms: String,
    /// Least and greatest that was measured.
    pub range: [f64; 2],
    /// Root mean square error.
    pub rmse: f64,
    /// Mean magnitude of the error.
    pub mae: f64,
    /// Root mean square error of predicting the mean.
    pub mean_rmse: f64,
    /// Part of the variance that is explained.
    pub r2: f64,
    /// Mean error while the magnitude grew less that while it fell, if it is known.
    pub hysteresis: Option<f64>,
    /// Name of each recording in which it was measured, and errors with its blocks left out and with all of it left out.
    pub recordings: Vec<(String, RecordingErrors, RecordingErrors)>,
    /// Each picture in which it was measured, in the order of time.
    pub points: Vec<PredictedPoint>,
}

/// One component in one picture, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PredictedPoint {
    /// Index of the recording.
    pub recording: usize,
    /// What was measured.
    pub measured: f64,
    /// Predicted without the picture's block of time; not a number where nothing is.
    pub by_blocks: f64,
    /// Predicted without the picture's recording; not a number where nothing is.
    pub by_recording: f64,
}

/// The page, as HTML text.
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
            "On pictures that were not seen: each recording is cut into blocks of time, and everything is learned anew without one."
        }
        (axes_table(page))
        h2 { "Recordings" }
        p.note { "Left out block by block, and as a whole. The mean error of a recording left out is the drift between recordings." }
        (recordings_table(page))
        h2 { "Figures" }
        div.figures { @for figure in &figures { (figure.markup()) } }
        p { "Made for the fingertip of SHA-256" br; span.digest { (page.sha256) } }
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
        format!("{name} by {error} {unit} ({percent:.1} % of what was measured)")
    });
    let errors: Vec<_> = errors.collect();
    html! {
        "On pictures that it has not seen, it is off in " (errors.join(", ")) ", root mean square."
        @if !page.left_out.is_empty() {
            " Left out, as the pictures explain nothing of them: " (page.left_out.join(", ")) "."
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
                    @for name in ["RMSE", "MAE", "RMSE, left out", "MAE, left out", "Drift, left out"] {
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
    fn a_page_holds_its_components_and_is_escaped() {
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
