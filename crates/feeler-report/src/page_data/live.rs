//! What a page needs of a rig that works while it is looked at.

use super::panels::{Axis, Colour, Panel, Series};
use super::scene::Scene;
use super::table::{RunTable, frame_column, of_finger};
use super::{Figure, PageData, VERSION};
use feeler_record::{RunFacts, SolidFrame};
use serde::Serialize;

/// Where the rows of a page come from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Live {
    /// Path of the WebSocket, with its token.
    pub socket: String,
    /// Rows that the page keeps.
    pub keep: usize,
    /// Whether there is somebody who can be told to stop.
    pub orders: bool,
}

/// A rig that works.
#[derive(Debug, Clone, Copy)]
pub struct LiveRig<'a> {
    /// Its constants.
    pub facts: &'a RunFacts,
    /// Where its fingers begin, m in `W`.
    pub homes: &'a [[f64; 3]],
    /// Whether its rows say how a cap stands.
    pub cap: bool,
    /// Whether its rows say where an object is that is carried.
    pub object: bool,
}

impl LiveRig<'_> {
    /// Names of the columns and numbers of each in a row, in the order of a message.
    pub fn columns(&self) -> Vec<(String, usize)> {
        let single = |name: &str| (name.to_string(), 1);
        let mut columns = vec![single("time"), single("phase")];
        for (finger, model) in self.facts.hand.iter().enumerate() {
            let parts = [
                ("joints", 3),
                ("forces", 3 * model.element_tips.len()),
                ("flags", 1),
                ("grasp_force", 1),
                ("shear_rate", 1),
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

    /// The figures of its page: titles, and what answers.
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

impl PageData {
    /// Of a page about a rig that works.
    pub fn of_rig(title: &str, rig: &LiveRig<'_>, live: Live) -> Self {
        let figures = rig.figures().into_iter().zip(1..);
        let figure = |((_, panel), number)| Figure {
            number,
            columns: 1,
            panels: vec![panel],
        };
        Self {
            version: VERSION,
            title: title.into(),
            run: Some(RunTable::to_come(rig.columns())),
            scene: Scene::of_rig(rig),
            figures: figures.map(figure).collect(),
            live: Some(live),
        }
    }
}
