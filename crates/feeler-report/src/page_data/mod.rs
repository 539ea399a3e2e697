//! Data for a page's script, in the format of `web/src/page_data.ts`, which documents each field.

mod live;
pub mod panels;
mod scene;
pub(crate) mod table;

use super::figures::Figure as StillFigure;
use crate::run::data::RunData;
use feeler_record::Recording;
use scene::Scene;
use serde::Serialize;

pub use live::{Live, LiveRig};
pub use panels::Panel;
pub use table::{CONTACT_WIDTH, contact_values, flag_bits, of_finger};
pub(crate) use table::{Rows, RunTable};

/// Version of this format.
const VERSION: u32 = 1;

/// Data for a page's script.
#[derive(Debug, Clone, Serialize)]
pub struct PageData {
    version: u32,
    title: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<RunTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<Scene>,
    figures: Vec<Figure>,
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<Live>,
}

#[derive(Debug, Clone, Serialize)]
struct Figure {
    number: u32,
    columns: usize,
    panels: Vec<Panel>,
}

impl PageData {
    /// Data of a page about one run, whose rows are in `table`.
    pub(crate) fn of_run(
        title: &str,
        recording: &Recording,
        data: &RunData,
        (run, rows): (RunTable, Rows),
        figures: &[StillFigure],
    ) -> Self {
        let mut figures = interactive(figures);
        for panel in figures.iter_mut().flat_map(|figure| &mut figure.panels) {
            panel.take_rows(&rows);
        }
        Self {
            run: (!data.time.is_empty()).then_some(run),
            scene: Scene::new(recording, data),
            figures,
            ..Self::of_figures(title, &[])
        }
    }

    /// Data of a page that has only figures.
    pub fn of_figures(title: &str, figures: &[StillFigure]) -> Self {
        Self {
            version: VERSION,
            title: title.into(),
            run: None,
            scene: None,
            figures: interactive(figures),
            live: None,
        }
    }

    /// Data of a page about a running rig.
    pub fn of_rig(title: &str, rig: &LiveRig<'_>, live: Live) -> Self {
        let figures = rig.figures().into_iter().zip(1..);
        let figure = |((_, panel), number)| Figure {
            number,
            columns: 1,
            panels: vec![panel],
        };
        Self {
            run: Some(RunTable::to_come(rig.columns())),
            scene: Scene::of_rig(rig),
            figures: figures.map(figure).collect(),
            live: Some(live),
            ..Self::of_figures(title, &[])
        }
    }

    /// JSON for embedding in HTML; cannot terminate the script element.
    ///
    /// # Errors
    /// Never for valid page data; required by serde's signature.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self).map(|json| json.replace('<', "\\u003c"))
    }
}

/// Interactive figures that replace static ones.
fn interactive(figures: &[StillFigure]) -> Vec<Figure> {
    let drawn = figures.iter().filter(|figure| figure.svg.is_some());
    let figures = drawn.map(|figure| Figure {
        number: figure.number,
        columns: figure.columns,
        panels: figure.panels.clone(),
    });
    figures.filter(|figure| !figure.panels.is_empty()).collect()
}
