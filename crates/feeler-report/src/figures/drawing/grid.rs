//! Arrangement of panels in rows.

use kuva::render::figure::Figure as Panels;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

/// Spacing between and around panels.
const SPACING: f64 = 6.0;

/// Plots of a panel, and its axes.
pub type Panel = (Vec<Plot>, Layout);

/// A row of panels.
pub struct Row {
    /// Height of the row (SVG units).
    pub height: f64,
    /// Panels from left to right; a single panel spans the width of the figure.
    pub panels: Vec<Panel>,
}

/// Arranges one panel per finger in rows of at most three, without a single panel in the last row.
pub fn rows(height: f64, mut panels: Vec<Panel>) -> Vec<Row> {
    let columns = if panels.len() == 4 { 2 } else { 3 };
    let mut rows = Vec::new();
    while !panels.is_empty() {
        let rest = panels.split_off(columns.min(panels.len()));
        rows.push(Row { height, panels });
        panels = rest;
    }
    rows
}

/// Stacks rows vertically and returns the total height. There must be at least one panel.
pub fn stack(rows: Vec<Row>) -> (Panels, f64) {
    let columns = rows.iter().map(|row| row.panels.len()).max().unwrap_or(0);
    let mut figure = Panels::new(rows.len(), columns)
        .with_spacing(SPACING)
        .with_padding(SPACING);
    let (mut structure, mut plots, mut layouts) = (Vec::new(), Vec::new(), Vec::new());
    let mut height = SPACING;
    for (number, row) in rows.into_iter().enumerate() {
        let cells = number * columns..number * columns + row.panels.len();
        structure.extend(if row.panels.len() == 1 {
            vec![(number * columns..(number + 1) * columns).collect::<Vec<_>>()]
        } else {
            cells.map(|cell| vec![cell]).collect()
        });
        figure = figure.with_row_height(number, row.height);
        height += row.height + SPACING;
        for (panel, layout) in row.panels {
            plots.push(panel);
            layouts.push(layout);
        }
    }
    let figure = figure.with_structure(structure).with_plots(plots);
    (figure.with_layouts(layouts), height)
}
