//! What the pictures contradict.

use crate::sensor::live_calibration::ForceAxes;

/// What the pictures contradict.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadCheckError {
    /// Forces are too large or too small.
    #[error(
        "the largest load on {what} is {largest} N; expected {low} to {high} N, as {reason}: are these {unit}?"
    )]
    Magnitude {
        /// What they are on.
        what: &'static str,
        /// The largest, N.
        largest: f64,
        /// Least that is expected, N.
        low: f64,
        /// Most that is expected, N.
        high: f64,
        /// Why.
        reason: &'static str,
        /// Unit that the numbers may be in.
        unit: &'static str,
    },
    /// The loads of an element are those of another.
    #[error(
        "the loads of element {element} are not what the pictures show of it (correlation of f_z and growth {own:.2}), but of element \
         {shown} ({other:.2}); expected elements numbered as in the layout, where `feeler locate --preview` draws the numbers, or named \
         by their places (columns column, row)"
    )]
    Number {
        /// The element, as numbered by the loads.
        element: usize,
        /// Correlation with its own growth.
        own: f64,
        /// The element whose growth follows the loads.
        shown: usize,
        /// Correlation with that.
        other: f64,
    },
    /// The axes of the forces are not those of the pictures.
    #[error(
        "{}in {contradicted} of {judged} elements, the first of them {first}, the pictures contradict the loads: {what}",
        recording.as_ref().map_or_else(String::new, |recording| format!("recording {recording:?}: "))
    )]
    Axes {
        /// The recording of whose loads alone this is so; `None` for all loads together.
        recording: Option<String>,
        /// Elements that contradict them alike.
        contradicted: usize,
        /// Elements whose pictures determine the axes.
        judged: usize,
        /// The first.
        first: usize,
        /// What is wrong, and the likely cause.
        what: String,
        /// Columns that are x, y and z by the pictures, if that is so of most elements.
        axes: Option<Box<ForceAxes>>,
    },
    /// Pictures without load differ between recordings.
    #[error(
        "the pictures without load of recordings {one:?} and {other:?} differ by {percent:.0} % of what the loads cause, in most elements; \
         expected one zero: the camera, the light or the fingertip has changed between them, calibrate each by itself"
    )]
    Unloaded {
        /// A recording.
        one: String,
        /// The other.
        other: String,
        /// Median difference over the elements that differ, % of the range under load.
        percent: f64,
    },
    /// Forces differ between recordings by a constant.
    #[error(
        "{column} of recording {one:?} is {offset:+.3} N off that of {other:?} for the same pictures; expected less than {limit:.3} N: \
         the zero of the force sensor has changed between them, take it anew or calibrate each by itself"
    )]
    Offset {
        /// The column.
        column: &'static str,
        /// A recording.
        one: String,
        /// The other.
        other: String,
        /// By how much, N.
        offset: f64,
        /// How much it may be, N.
        limit: f64,
    },
    /// A load is far from what all others predict.
    #[error(
        "picture = {picture:?}: {column} = {given} N on element {element}, {predicted:.3} N expected by its other loads, which are off by \
         {usual:.3} N: is it mistyped?"
    )]
    Outlier {
        /// The picture.
        picture: String,
        /// Index of the element.
        element: usize,
        /// The column.
        column: &'static str,
        /// As in the table, N.
        given: f64,
        /// By the other loads, N.
        predicted: f64,
        /// Standard deviation of the other loads' errors, N.
        usual: f64,
    },
}

impl LoadCheckError {
    /// The same, found in one recording alone: what converts all loads does not convert its own.
    pub(super) fn of_recording(mut self, name: String) -> Self {
        if let Self::Axes {
            recording, axes, ..
        } = &mut self
        {
            *recording = Some(name);
            *axes = None;
        }
        self
    }
}
