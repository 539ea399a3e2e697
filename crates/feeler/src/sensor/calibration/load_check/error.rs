//! Errors of the load checks.

use crate::sensor::calibration::live::ForceAxes;

/// Error returned if loads contradict the images.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadCheckError {
    /// The forces are implausibly large or small.
    #[error(
        "the largest load on {what} is {largest} N; expected {low} to {high} N, as {reason}: are these {unit}?"
    )]
    Magnitude {
        /// Description of the loaded object.
        what: &'static str,
        /// The largest load, N.
        largest: f64,
        /// Minimum expected value, N.
        low: f64,
        /// Maximum expected value, N.
        high: f64,
        /// Reason for the limit.
        reason: &'static str,
        /// Probable unit of the numbers.
        unit: &'static str,
    },
    /// The loads of one element match the images of another.
    #[error(
        "the loads of element {element} do not match its growth in the images (correlation with f_z {own:.2}), but that of element \
         {shown} ({other:.2}); expected elements numbered as in the layout (`feeler locate --preview` draws the numbers), or identified \
         by position (columns column, row)"
    )]
    Number {
        /// Index of the element in the loads.
        element: usize,
        /// Correlation of the loads with the gray value of the element itself.
        own: f64,
        /// Index of the element whose gray value follows the loads.
        shown: usize,
        /// Correlation of the loads with the gray value of `shown`.
        other: f64,
    },
    /// The images show the forces along other axes, or with other signs, than the loads.
    #[error(
        "{}in {contradicted} of {judged} elements, the first of them {first}, the images contradict the loads: {what}",
        recording.as_ref().map_or_else(String::new, |recording| format!("recording {recording:?}: "))
    )]
    Axes {
        /// Name of the affected recording, or `None` if all loads together are affected.
        recording: Option<String>,
        /// Number of elements that show this contradiction.
        contradicted: usize,
        /// Number of elements whose images are sufficient to determine the axes.
        judged: usize,
        /// Index of the first affected element.
        first: usize,
        /// Description of the contradiction and its likely cause.
        what: String,
        /// Mapping that corrects the forces, if most elements show the contradiction.
        axes: Option<Box<ForceAxes>>,
    },
    /// The unloaded images differ between recordings.
    #[error(
        "the unloaded images of recordings {one:?} and {other:?} differ by {percent:.0} % of the range under load in most elements; \
         expected the same zero: the camera, the light or the fingertip has changed between them; calibrate each separately"
    )]
    Unloaded {
        /// Name of the first recording.
        one: String,
        /// Name of the second recording.
        other: String,
        /// Median difference over the elements, % of the range under load.
        percent: f64,
    },
    /// The forces of two recordings differ by a constant.
    #[error(
        "{column} of recording {one:?} is {offset:+.3} N off that of {other:?} for the same images; expected less than {limit:.3} N: \
         the zero of the force sensor has changed between them; zero it again or calibrate each separately"
    )]
    Offset {
        /// Name of the force column.
        column: &'static str,
        /// Name of the first recording.
        one: String,
        /// Name of the second recording.
        other: String,
        /// Difference, N.
        offset: f64,
        /// Maximum allowed difference, N.
        limit: f64,
    },
    /// A load differs greatly from the prediction of all others.
    #[error(
        "picture = {picture:?}: {column} = {given} N on element {element}; expected {predicted:.3} N from its other loads, which are off by \
         {usual:.3} N: is it mistyped?"
    )]
    Outlier {
        /// Name of the image.
        picture: String,
        /// Index of the element.
        element: usize,
        /// Name of the force column.
        column: &'static str,
        /// Load as in the table, N.
        given: f64,
        /// Load predicted from the others, N.
        predicted: f64,
        /// Standard deviation of the errors of the other loads, N.
        usual: f64,
    },
}

impl LoadCheckError {
    /// Attributes the error to a single recording. Removes the correcting axes, because they apply to all loads only.
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
