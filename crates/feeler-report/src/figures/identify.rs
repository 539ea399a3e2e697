//! Figures of a probing run: raw probes with their fits.

use super::Figure;
use crate::figures::drawing::canvas::{
    Pen, airy, dots, finger_colour, finger_legend, line, panel, range,
};
use crate::figures::drawing::sheet::tiled;

/// Raw probes of one finger.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FingerProbes {
    /// Depth (m) and `F_z` (N) of the most loaded contact.
    pub depth: Vec<(f64, f64)>,
    /// Shear displacement (m) and shear force (N) of the same contact.
    pub shear: Vec<(f64, f64)>,
    /// Normal and tangential stiffness (N/m).
    pub stiffness: [f64; 2],
    /// For each slide: time (s) and ratio of shear to normal force.
    pub slides: Vec<Vec<(f64, f64)>>,
    /// Coefficients of static and kinetic friction.
    pub friction: [f64; 2],
    /// Tips of the touching elements: x, y in W (m).
    pub tips: Vec<(f64, f64)>,
}

/// Maximum number of dots per series.
const DOTS: usize = 400;
/// Gray of the fits.
const FITTED: &str = "#555555";
const HEIGHT: f64 = 240.0;

/// Accessor for a finger's points.
type PointsOf = fn(&FingerProbes) -> &[(f64, f64)];

/// `F_z` over depth.
pub fn depth_figure(fingers: &[FingerProbes], number: u32) -> Figure {
    let caption =
        "Most loaded element, pressed and released at two speeds. Line: normal contact stiffness.";
    let labels = ["depth (mm)", "F_z (N)"];
    slope_figure(
        fingers,
        number,
        "Pressing",
        |f| &f.depth,
        0,
        labels,
        caption,
    )
}

/// Shear force over displacement.
pub fn shear_figure(fingers: &[FingerProbes], number: u32) -> Figure {
    let caption = "Same element, sheared along the object's axis while it sticks. Line: tangential contact stiffness.";
    let labels = ["shear displacement (mm)", "shear force (N)"];
    slope_figure(
        fingers,
        number,
        "Shearing",
        |f| &f.shear,
        1,
        labels,
        caption,
    )
}

fn slope_figure(
    fingers: &[FingerProbes],
    number: u32,
    title: &str,
    points: PointsOf,
    stiffness: usize,
    [x_label, y_label]: [&str; 2],
    caption: &str,
) -> Figure {
    let panels = fingers.iter().enumerate().map(|(index, finger)| {
        let points: Vec<_> = points(finger).iter().map(|p| (1e3 * p.0, p.1)).collect();
        let x = range(points.iter().map(|p| p.0)).unwrap_or((0.0, 1.0));
        let y = range(points.iter().map(|p| p.1)).unwrap_or((0.0, 1.0));
        let count = points.len().max(1) as f64;
        let mean = points.iter().fold((0.0, 0.0), |sum, p| {
            (sum.0 + p.0 / count, sum.1 + p.1 / count)
        });
        let slope = 1e-3 * finger.stiffness[stiffness];
        let fitted = [x.0, x.1].map(|at| (at, mean.1 + slope * (at - mean.0)));
        let plots = vec![
            dots(&points, DOTS, finger_colour(index), 1.8),
            line(fitted, Pen::solid(FITTED, 1.4)),
        ];
        (
            plots,
            panel(airy(x), airy(y), x_label, y_label).with_ticks(4),
        )
    });
    let panels = panels.collect();
    let drawing = tiled((number, title), &legend(fingers), panels, 2, HEIGHT);
    Figure::drawn(number, title, caption, Some(drawing))
}

/// Ratio of shear to normal force over time.
pub fn slide_figure(fingers: &[FingerProbes], number: u32) -> Figure {
    let panels = fingers.iter().enumerate().map(|(index, finger)| {
        let all = || finger.slides.iter().flatten();
        let x = range(all().map(|p| p.0)).unwrap_or((0.0, 1.0));
        let coefficients = finger.friction.into_iter();
        let y = range(all().map(|p| p.1).chain(coefficients)).unwrap_or((0.0, 1.0));
        let mut plots: Vec<_> = finger
            .slides
            .iter()
            .map(|slide| line(slide.iter().copied(), Pen::solid(finger_colour(index), 1.0)))
            .collect();
        for coefficient in finger.friction {
            let fitted = [(x.0, coefficient), (x.1, coefficient)];
            plots.push(line(fitted, Pen::solid(FITTED, 1.4)));
        }
        let layout = panel(
            airy(x),
            airy(y),
            "time in the slide (s)",
            "shear / normal force",
        );
        (plots, layout.with_ticks(4))
    });
    let (title, panels) = ("Sliding", panels.collect());
    let caption = "Most loaded element at each place: it first sticks, then alternates between stick and slip within both friction coefficients (lines).";
    let drawing = tiled((number, title), &legend(fingers), panels, 2, HEIGHT);
    Figure::drawn(number, title, caption, Some(drawing))
}

/// Touching tips, and the circle through them: centre x, y in W and radius (m).
pub fn circle_figure(fingers: &[FingerProbes], circle: [f64; 3], number: u32) -> Figure {
    let [x, y, radius] = circle.map(|length| 1e3 * length);
    let turn = (0..=120).map(|step| f64::from(step) / 120.0 * std::f64::consts::TAU);
    let around = turn.map(|angle| (x + radius * angle.cos(), y + radius * angle.sin()));
    let mut plots = vec![line(around, Pen::solid(FITTED, 1.2))];
    for (index, finger) in fingers.iter().enumerate() {
        let tips: Vec<_> = finger.tips.iter().map(|p| (1e3 * p.0, 1e3 * p.1)).collect();
        plots.push(dots(&tips, DOTS, finger_colour(index), 2.4));
    }
    plots.push(dots(&[(x, y)], DOTS, FITTED, 3.0));
    let reach = 1.15 * radius;
    let layout = panel(
        (x - reach, x + reach),
        (y - reach, y + reach),
        "x (mm)",
        "y (mm)",
    )
    .with_equal_aspect();
    let title = "Cross-section of the object";
    let caption = "Centres of the touching tips under load, one dot per element and place; circle fitted through them, and its centre, the pivot. \
        The object's radius is the circle's radius minus the radius of a tip.";
    let drawing = tiled(
        (number, title),
        &legend(fingers),
        vec![(plots, layout)],
        1,
        440.0,
    );
    Figure::drawn(number, title, caption, Some(drawing))
}

fn legend(fingers: &[FingerProbes]) -> Vec<(&'static str, Pen)> {
    let mut legend = finger_legend(fingers.len(), 2.0);
    legend.push(("fitted", Pen::solid(FITTED, 1.4)));
    legend
}
