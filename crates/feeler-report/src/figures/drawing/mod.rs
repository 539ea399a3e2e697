//! Canvas, styles and layout of figures.

pub(crate) mod canvas;
pub(crate) mod grid;
pub(crate) mod pen;
pub(crate) mod sheet;
