//! Report page of a force calibration, with errors, curves and residuals.

use super::document::{Tile, document_of_figures, figures, number_heads, numbers, table, tiles};
use super::text::significant;
use crate::figures::calibration::{ElementErrors, ElementLoads, errors_figure, loads_figure};
use maud::{Markup, html};
use std::iter;

/// Content of the calibration page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CalibrationPage {
    /// Source of the loads.
    pub source: String,
    /// Model name.
    pub model: String,
    /// SHA-256 of the calibration target.
    pub sha256: String,
    /// Full scale along x, y, z of an element's frame (N).
    pub full_scale: [f64; 3],
    /// Errors of all elements.
    pub elements: Vec<ElementErrors>,
    /// Elements whose loads are plotted.
    pub drawn: Vec<ElementLoads>,
}

/// Renders the page as HTML.
pub fn calibration_page(page: &CalibrationPage) -> String {
    let drawn = page.drawn.iter().zip(2..);
    let loads = drawn.map(|(element, number)| loads_figure(element, number));
    let drawn: Vec<_> = iter::once(errors_figure(&page.elements, page.full_scale))
        .chain(loads)
        .collect();
    let body = html! {
        h1 { "Calibration: " (page.source) }
        p.verdict { (verdict(page)) }
        (tiles(&tiles_of(page)))
        h2 { "Figures" }
        (figures(&drawn))
        h2 { "Elements" }
        p.note { "Values are along x, y and z of each element's frame; percentages are of full scale." }
        (elements_table(page))
        p { "Calibrated for the fingertip with SHA-256" br; span.digest { (page.sha256) } }
    };
    let title = format!("Calibration: {}", page.source);
    document_of_figures(&title, body, &drawn)
}

/// Key figures: errors of the worst element and number of elements.
fn tiles_of(page: &CalibrationPage) -> [Tile; 3] {
    let off = |axes, label| Tile::new(significant(worst(page, axes)), "% of full scale", label);
    [
        off(&[2], "RMS error in compression"),
        off(&[0, 1], "RMS error in shear"),
        Tile::new(page.elements.len().to_string(), "", "elements"),
    ]
}

/// Largest root mean square error of an element along the given axes (% of full scale).
fn worst(page: &CalibrationPage, axes: &[usize]) -> f64 {
    let shares = page.elements.iter().flat_map(|element| {
        let shares = axes
            .iter()
            .map(|&axis| element.rms[axis] / page.full_scale[axis]);
        shares.map(|share| 100.0 * share)
    });
    shares.fold(0.0, f64::max)
}

/// One-paragraph summary of the calibration.
fn verdict(page: &CalibrationPage) -> Markup {
    let (shear, normal) = (worst(page, &[0, 1]), worst(page, &[2]));
    let [full_shear, _, full_normal] = page.full_scale;
    html! {
        "The " (page.model) " model of " (page.elements.len()) " elements has an RMS error of up to "
        (format!("{normal:.2} % of {full_normal} N")) " in compression and "
        (format!("{shear:.2} % of {full_shear} N")) " in shear (worst element)."
    }
}

fn elements_table(page: &CalibrationPage) -> Markup {
    const COLUMNS: [(&str, &str); 7] = [
        ("RMS", "mN"),
        ("RMS", "%"),
        ("Worst", "mN"),
        ("Worst", "%"),
        ("Repeatability", "mN"),
        ("Hysteresis", "mN"),
        ("Resolution", "mN"),
    ];
    let heads = COLUMNS.map(|(name, unit)| html! { (name) " " span.unit { "(" (unit) ")" } });
    let rows = page.elements.iter().map(|element| {
        let columns = [
            millinewtons(Some(element.rms)),
            percent(element.rms, page.full_scale),
            millinewtons(Some(element.worst)),
            percent(element.worst, page.full_scale),
            millinewtons(element.repeatability),
            millinewtons(element.hysteresis),
            millinewtons(element.resolution),
        ];
        html! { td { (element.name) } (numbers(columns)) }
    });
    table(html! { th { "Element" } (number_heads(heads)) }, rows)
}

fn millinewtons(force: Option<[f64; 3]>) -> String {
    let text = |force: [f64; 3]| force.map(|f| format!("{:.1}", 1e3 * f)).join(", ");
    force.map_or("unknown".into(), text)
}

fn percent(force: [f64; 3], full_scale: [f64; 3]) -> String {
    let shares = std::array::from_fn::<_, 3, _>(|axis| 100.0 * force[axis] / full_scale[axis]);
    shares.map(|share| format!("{share:.2}")).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_contains_its_elements_and_is_escaped() {
        let element = ElementErrors {
            name: "element 0".into(),
            rms: [0.01, 0.02, 0.03],
            ..ElementErrors::default()
        };
        let loads = ElementLoads {
            name: "element 0".into(),
            loads: [(); 3].map(|()| vec![(0.0, 0.0), (1.0, 2.0), (f64::NAN, 1.0)]),
            ..ElementLoads::default()
        };
        let page = calibration_page(&CalibrationPage {
            source: "<b>.csv".into(),
            full_scale: [1.0, 1.0, 2.0],
            elements: vec![element],
            drawn: vec![loads, ElementLoads::default()],
            ..CalibrationPage::default()
        });
        assert!(page.contains("&lt;b&gt;.csv") && page.contains("1.50 % of 2 N"));
        assert!(page.contains("10.0, 20.0, 30.0") && page.contains("unknown"));
        assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    }
}
