//! Report page of a wrench calibration: errors on held-out samples.

use super::document::{Tile, document_of_figures, figures, number_heads, numbers, table, tiles};
use super::text::significant;
use crate::figures::wrench::{AxisPoints, RecordingErrors, predicted_figure, residuals_figure};
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

/// Renders the page as HTML.
pub fn wrench_page(page: &WrenchPage) -> String {
    let drawn = page.axes.iter().enumerate().flat_map(|(index, axis)| {
        let number = 2 * index as u32 + 1;
        [
            predicted_figure(&page.recordings, axis, number),
            residuals_figure(&page.recordings, axis, number + 1),
        ]
    });
    let drawn: Vec<_> = drawn.collect();
    let body = html! {
        h1 { "Wrench calibration: " (page.source) }
        p.verdict { (verdict(page)) }
        (tiles(&page.axes.iter().map(tile).collect::<Vec<_>>()))
        h2 { "Components" }
        p.note {
            "Errors on held-out samples: each recording is divided into blocks of time, and the model is fitted without the block under test."
        }
        (axes_table(page))
        h2 { "Recordings" }
        p.note { "Held out block by block, and as a whole. The mean error of a held-out recording is the drift between recordings." }
        (recordings_table(page))
        h2 { "Figures" }
        (figures(&drawn))
        p { "Calibrated for the fingertip with SHA-256" br; span.digest { (page.sha256) } }
    };
    let title = format!("Wrench calibration: {}", page.source);
    document_of_figures(&title, body, &drawn)
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
        "RMS error on held-out samples: " (errors.join(", ")) "."
        @if !page.left_out.is_empty() {
            " Not calibrated, because the samples do not predict them: " (page.left_out.join(", ")) "."
        }
    }
}

/// Cell with the name and unit of a component.
fn component(axis: &AxisPoints) -> Markup {
    html! { td { (axis.name) " " span.unit { "(" (axis.unit) ")" } } }
}

fn axes_table(page: &WrenchPage) -> Markup {
    const COLUMNS: [&str; 8] = [
        "Range",
        "RMSE",
        "% of range",
        "MAE",
        "RMSE of the mean",
        "R²",
        "Hysteresis",
        "95 % of valid samples within",
    ];
    let head = html! { th { "Component" } (number_heads(COLUMNS)) th { "Regressed on" } };
    let rows = page.axes.iter().map(|axis| {
        let values = [
            format!("{:.3} to {:.3}", axis.range[0], axis.range[1]),
            format!("{:.4}", axis.rmse),
            format!("{:.1}", percent(axis)),
            format!("{:.4}", axis.mae),
            format!("{:.4}", axis.mean_rmse),
            format!("{:.3}", axis.r2),
            (axis.hysteresis).map_or("unknown".into(), |h| format!("{h:+.4}")),
            (axis.band_95).map_or("unknown".into(), |band| format!("{band:.4}")),
        ];
        html! { (component(axis)) (numbers(values)) td { (axis.terms) } }
    });
    table(head, rows)
}

fn recordings_table(page: &WrenchPage) -> Markup {
    let number = |errors: &RecordingErrors, which: usize| {
        errors.map_or("unknown".into(), |errors| format!("{:.4}", errors[which]))
    };
    const COLUMNS: [&str; 5] = [
        "RMSE",
        "MAE",
        "RMSE, held out",
        "MAE, held out",
        "Drift, held out",
    ];
    let head = html! { th { "Component" } th { "Recording" } (number_heads(COLUMNS)) };
    let recordings = page.axes.iter();
    let recordings = recordings.flat_map(|axis| axis.recordings.iter().map(move |r| (axis, r)));
    let rows = recordings.map(|(axis, (name, blocks, left_out))| {
        html! {
            (component(axis))
            td { (name) }
            (numbers([0, 1].map(|which| number(blocks, which))))
            (numbers([0, 1, 2].map(|which| number(left_out, which))))
        }
    });
    table(head, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::wrench::PredictedPoint;

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
