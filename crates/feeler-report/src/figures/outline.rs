//! Figures of a measured outline: top view with the true section, and its error.

use super::Figure;
use crate::figures::drawing::canvas::{CAP, Pen, finger_colour, line, panel, range};
use crate::figures::drawing::sheet::column;
use crate::measures::contour_points::{drawn, section};
use crate::measures::paths::{MM, Polyline};
use crate::run::data::RunData;
use feeler_record::{Phase, Recording};
use glam::DVec2;

/// Top view of the outline, and its error over time.
pub fn figures(recording: &Recording, data: &RunData) -> Vec<Figure> {
    vec![outline(recording, data), error(recording)]
}

fn outline(recording: &Recording, data: &RunData) -> Figure {
    let title = "Measured outline, top view";
    let (section, drawn) = (section(recording), drawn(recording));
    let millimetres = |p: DVec2| (MM * p.x, MM * p.y);
    let centre = data.fingers.first().map(|finger| {
        let rows = (0..data.time.len()).filter(|&row| data.phase[row] == Phase::Move);
        rows.map(|row| finger.position[row].truncate())
            .collect::<Vec<_>>()
    });
    let centre = centre.unwrap_or_default();
    let truth = Pen::solid(CAP, 1.2);
    let felt = Pen::solid(finger_colour(1), 1.6);
    let path = Pen::dashed("#888888", 1.0);
    let all = || {
        section
            .iter()
            .chain(&centre)
            .copied()
            .chain(drawn.iter().map(|d| d.1))
    };
    let ranges = range(all().map(|p| MM * p.x)).zip(range(all().map(|p| MM * p.y)));
    let drawing = ranges.filter(|_| !drawn.is_empty()).map(|(x, y)| {
        let mut plots = vec![
            line(centre.iter().copied().map(millimetres), path),
            line(drawn.iter().map(|d| millimetres(d.1)), felt),
        ];
        let mut legend = vec![("measured", felt)];
        if !section.is_empty() {
            plots.push(line(section.iter().copied().map(millimetres), truth));
            legend.push(("true section", truth));
        }
        legend.push(("dome centre", path));
        let layout = panel(x, y, "x (mm)", "y (mm)").with_equal_aspect();
        column((1, title), &legend, vec![(plots, layout)], 480.0)
    });
    let mut caption = "Each point is the contact of the feeler with the largest force, computed from that force, the feeler's stiffness and \
            the pose of the finger. At corners the contact moves from feeler to feeler, and the finger's path has steps."
        .to_string();
    if !section.is_empty() {
        caption += " The true section is ground truth that the hand does not know.";
    }
    Figure::drawn(1, title, caption, drawing)
}

fn error(recording: &Recording) -> Figure {
    let title = "Error of the outline";
    let (section, drawn) = (section(recording), drawn(recording));
    let pen = Pen::solid(finger_colour(0), 1.4);
    let outline = Polyline::new(&section);
    let points: Vec<_> = (drawn.iter().filter(|_| section.len() > 1))
        .map(|&(time, point)| (time, MM * outline.distance(point)))
        .collect();
    let ranges = range(points.iter().map(|p| p.0)).zip(range(points.iter().map(|p| p.1)));
    let drawing = ranges.map(|(time, (_, most))| {
        let layout = panel(time, (0.0, most), "Time (s)", "Distance (mm)");
        let legend = [("measured point to true section", pen)];
        let lines = vec![line(points.iter().copied(), pen)];
        column((2, title), &legend, vec![(lines, layout)], 300.0)
    });
    let caption = "Distance of each measured point from the true section.";
    Figure::drawn(2, title, caption, drawing)
}
