//! Figures of a force calibration: errors per element, and curves and residuals of single elements.

use super::Figure;
use crate::figures::drawing::canvas::{Pen, airy, dots, finger_colour, line, panel, range};
use crate::figures::drawing::sheet::tiled;
use kuva::render::layout::Layout;

/// Errors of one element along x, y, z of its frame (N).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementErrors {
    /// Element name.
    pub name: String,
    /// Root mean square error on held-out loads.
    pub rms: [f64; 3],
    /// Maximum error on held-out loads.
    pub worst: [f64; 3],
    /// Maximum standard deviation under a constant load, if known.
    pub repeatability: Option<[f64; 3]>,
    /// Maximum difference between rising and falling loads, if known.
    pub hysteresis: Option<[f64; 3]>,
    /// Three standard deviations without load, if known.
    pub resolution: Option<[f64; 3]>,
}

/// Loads on one element.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementLoads {
    /// Element name.
    pub name: String,
    /// Unit of displacements in the figure.
    pub length_unit: String,
    /// For x, y, z: applied force (N) over the displacement along x, the displacement along y, and the growth of the
    /// integrated gray value.
    pub loads: [Vec<(f64, f64)>; 3],
    /// For x, y, z: calibrated force (N) over the same input, with the other inputs constant.
    pub curves: [Vec<Vec<(f64, f64)>>; 3],
    /// For x, y, z: reading minus load (mN) over load (N).
    pub residuals: [Vec<(f64, f64)>; 3],
}

const AXES: [&str; 3] = ["x", "y", "z"];
/// Maximum number of dots per panel.
const DOTS: usize = 200;
/// Gray of the loads.
const LOADS: &str = "#999999";

/// Root mean square errors of all elements (% of full scale).
pub fn errors_figure(elements: &[ElementErrors], full_scale: [f64; 3]) -> Figure {
    let percent = |axis: usize| {
        let elements = elements.iter().enumerate();
        elements.map(move |(index, element)| {
            let share = element.rms[axis] / full_scale[axis];
            (index as f64, 100.0 * share)
        })
    };
    let pens = [0, 1, 2].map(|axis| Pen::solid(finger_colour(axis), 1.6));
    let plots = (0..3).map(|axis| line(percent(axis), pens[axis])).collect();
    let largest = range((0..3).flat_map(|axis| percent(axis).map(|p| p.1))).map_or(1.0, |r| r.1);
    let last = elements.len().saturating_sub(1) as f64;
    let upright = (0.0, 1.1 * largest);
    let layout = panel((0.0, last), upright, "element", "error (% of full scale)");
    let legend: Vec<_> = AXES.into_iter().zip(pens).collect();
    let (title, panels) = ("Errors by element", vec![(plots, layout)]);
    let drawing = tiled((1, title), &legend, panels, 1, 300.0);
    let caption = "Root mean square error on held-out loads.";
    Figure::drawn(1, title, caption, Some(drawing))
}

/// Loads, curves and residuals of one element, with one row each for x, y and z.
pub fn loads_figure(element: &ElementLoads, number: u32) -> Figure {
    let panels = AXES.into_iter().enumerate().flat_map(|(axis, name)| {
        let pen = Pen::solid(finger_colour(axis), 1.4);
        let input = match axis {
            2 => "growth of G".to_owned(),
            _ => format!("u_{name} ({})", element.length_unit),
        };
        let force = format!("F_{name} (N)");
        let (loads, residuals) = (&element.loads[axis], &element.residuals[axis]);
        let curves = element.curves[axis].iter();
        let curves = curves.map(|curve| line(curve.iter().copied(), pen));
        let mut drawn = vec![dots(loads, DOTS, LOADS, 1.6)];
        drawn.extend(curves);
        [
            (drawn, over(loads, &input, &force)),
            (
                vec![dots(residuals, DOTS, pen.colour, 1.6)],
                over(residuals, &force, "error (mN)"),
            ),
        ]
    });
    let title = format!("{}: curves and residuals", element.name);
    let legend = [
        ("loads", Pen::solid(LOADS, 2.0)),
        ("x", Pen::solid(finger_colour(0), 2.0)),
        ("y", Pen::solid(finger_colour(1), 2.0)),
        ("z", Pen::solid(finger_colour(2), 2.0)),
    ];
    let drawing = tiled((number, &title), &legend, panels.collect(), 2, 220.0);
    let caption = "Left: loads (dots) and calibration curves; for a coupled model, at zero, half and full growth of \
        the gray value. Right: readings minus loads, on held-out loads if available.";
    Figure::drawn(number, title, caption, Some(drawing))
}

/// An empty panel whose axes cover all points.
fn over(points: &[(f64, f64)], x_label: &str, y_label: &str) -> Layout {
    let x = range(points.iter().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let y = range(points.iter().map(|p| p.1)).unwrap_or((0.0, 1.0));
    panel(airy(x), airy(y), x_label, y_label).with_ticks(4)
}
