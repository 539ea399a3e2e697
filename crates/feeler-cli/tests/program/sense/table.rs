//! Parser of the program's tables.

use glam::DVec3;
use serde::Deserialize;

/// A row of a table.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Row {
    pub frame: u64,
    pub stamp: f64,
    pub element: usize,
    pub integrated_gray: Option<f64>,
    pub u_x: Option<f64>,
    pub u_y: Option<f64>,
    #[serde(default)]
    pub f_x: Option<f64>,
    #[serde(default)]
    pub f_y: Option<f64>,
    #[serde(default)]
    pub f_z: Option<f64>,
}

impl Row {
    pub fn force(&self) -> Option<DVec3> {
        Some(DVec3::new(self.f_x?, self.f_y?, self.f_z?))
    }
}

/// Header of a table with forces.
pub const WITH_FORCES: &str = "frame,stamp,element,integrated_gray,u_x,u_y,f_x,f_y,f_z";
/// Header of a table without forces.
pub const WITHOUT_FORCES: &str = "frame,stamp,element,integrated_gray,u_x,u_y";

/// Parses the rows of a table with this header.
pub fn rows(text: &str, header: &str) -> Vec<Row> {
    assert_eq!(text.lines().next(), Some(header));
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.expect("a table")
}
