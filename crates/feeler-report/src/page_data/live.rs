//! Page data of a running rig.

use super::panels::{Axis, Colour, Panel, Series};
use super::table::{CONTACT_WIDTH, frame_column, of_finger};
use feeler_record::{FingerModel, RunFacts, SolidFrame};
use serde::Serialize;

/// Source of a live page's rows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Live {
    /// Path of the WebSocket, including its token.
    pub socket: String,
    /// Number of rows that the page keeps.
    pub keep: usize,
    /// `true` if the page can send stop commands.
    pub orders: bool,
    /// `true` if the recording of the run contains the rumble and the tone that the page plays.
    pub felt: bool,
}

/// A running rig.
#[derive(Debug, Clone, Copy)]
pub struct LiveRig<'a> {
    /// Constants of the rig.
    pub facts: &'a RunFacts,
    /// Home position of each finger in `W` (m).
    pub homes: &'a [[f64; 3]],
    /// `true` if rows contain the pose of a cap.
    pub cap: bool,
    /// `true` if rows contain the pose of a carried object.
    pub object: bool,
}

impl LiveRig<'_> {
    /// Names of the columns and their number of values per row, in message order.
    pub fn columns(&self) -> Vec<(String, usize)> {
        let single = |name: &str| (name.to_string(), 1);
        let mut columns = vec![single("time"), single("phase")];
        for (finger, model) in self.facts.hand.iter().enumerate() {
            let parts = [
                ("joints", frame_count(model)),
                ("forces", 3 * model.element_tips.len()),
                ("flags", 1),
                ("grasp_force", 1),
                ("shear_rate", 1),
                ("contact", CONTACT_WIDTH),
            ];
            columns.extend(parts.map(|(name, width)| (of_finger(finger, name), width)));
        }
        columns.push(single("torque"));
        if self.cap {
            columns.push((frame_column(SolidFrame::Cap), 7));
            columns.push(single("cap_angle"));
        }
        if self.object {
            columns.push((frame_column(SolidFrame::Object), 7));
        }
        columns
    }

    /// Figures of the live page: titles and interactive panels.
    pub(crate) fn figures(&self) -> Vec<(&'static str, Panel)> {
        let torque = Series::of_column("torque", Colour::Shared, "torque");
        let facts = self.facts;
        vec![
            (
                "Grasp force",
                self.of_fingers("Grasp force", "N", "grasp_force")
                    .with_threshold(facts.grasp_force_threshold, "grasp threshold"),
            ),
            (
                "Shear rate",
                self.of_fingers("Shear rate", "N/s", "shear_rate")
                    .with_threshold(facts.slip_threshold, "slip threshold"),
            ),
            (
                "Torque",
                Panel::over_time(Axis::new("Torque", "mN·m", 1e3), vec![torque]),
            ),
        ]
    }

    fn of_fingers(&self, label: &str, unit: &'static str, column: &str) -> Panel {
        let fingers = 0..self.facts.hand.len();
        let series = fingers.map(|finger| {
            let (name, colour) = (format!("finger {finger}"), Colour::Finger(finger));
            Series::of_column(name, colour, of_finger(finger, column))
        });
        Panel::over_time(Axis::new(label, unit, 1.0), series.collect())
    }
}

/// Number of moving frames of a finger; three if its geometry is invalid.
fn frame_count(model: &FingerModel) -> usize {
    model
        .geometry()
        .map_or(3, |geometry| geometry.frame_count())
}
