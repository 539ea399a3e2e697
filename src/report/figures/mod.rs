//! The paper's Figs. 8 to 13, drawn from a run.

pub mod calibration;
mod canvas;
pub mod cap;
mod paths;
pub mod sweep;
mod time;

use super::run_data::RunData;

/// One figure of the report.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Number of the paper's figure that it answers; of a task that is not the paper's, just its number.
    pub number: u32,
    /// What it shows.
    pub title: String,
    /// What to see in it, and how that relates to the paper's figure.
    pub caption: String,
    /// The picture, a whole SVG document; none if the recording does not hold what it shows.
    pub svg: Option<String>,
}

impl Figure {
    /// Name of the figure's file.
    pub fn file_name(&self) -> String {
        format!("fig-{:02}.svg", self.number)
    }
}

/// Draws all figures.
pub fn figures(data: &RunData) -> Vec<Figure> {
    vec![
        time::grasp_force_and_torque(data),
        time::shear_rate_and_torque(data),
        time::stroke_in_detail(data, 10, 1),
        time::stroke_in_detail(data, 11, 4),
        paths::before_closing(data),
        paths::after_closing(data),
    ]
}
