//! Comparison of messages, value by value.

use feeler_record::wire::Vector3;
use feeler_record::{Command, Findings, Flags, Tactile, Task, TaskOutcome};
use std::fmt::Display;

/// Value in which two messages differ.
pub struct FieldDifference {
    /// Name of the value.
    pub name: String,
    /// Recorded value.
    pub expected: String,
    /// Replayed value.
    pub actual: String,
}

/// Compares two values; `text` formats them for the result.
fn compare<T: PartialEq>(
    name: &dyn Display,
    expected: T,
    actual: T,
    text: impl Fn(&T) -> String,
) -> Option<FieldDifference> {
    (expected != actual).then(|| FieldDifference {
        name: name.to_string(),
        expected: text(&expected),
        actual: text(&actual),
    })
}

fn value<T: PartialEq + Display>(name: &str, expected: T, actual: T) -> Option<FieldDifference> {
    compare(&name, expected, actual, T::to_string)
}

fn text(name: &str, expected: &str, actual: &str) -> Option<FieldDifference> {
    compare(&name, expected, actual, |text| format!("{text:?}"))
}

/// Compares the bits of two numbers.
fn number(name: impl Display, expected: f64, actual: f64) -> Option<FieldDifference> {
    compare(&name, expected.to_bits(), actual.to_bits(), |&bits| {
        match f64::from_bits(bits) {
            // Show the bits, since different NaNs have the same text.
            x if x.is_nan() => format!("NaN ({bits:#018x})"),
            // The shortest text that parses back to the same number.
            x => format!("{x:?}"),
        }
    })
}

/// Compares the elements of two lists, up to the shorter length.
fn numbers(list: &str, expected: &[f64], actual: &[f64]) -> Option<FieldDifference> {
    let mut numbers = expected.iter().zip(actual).enumerate();
    numbers.find_map(|(index, (&was, &is))| number(format_args!("{list}[{index}]"), was, is))
}

fn vector(name: impl Display, expected: Vector3, actual: Vector3) -> Option<FieldDifference> {
    number(format_args!("{name}.x"), expected.x, actual.x)
        .or_else(|| number(format_args!("{name}.y"), expected.y, actual.y))
        .or_else(|| number(format_args!("{name}.z"), expected.z, actual.z))
}

/// Compares stamp and forces of two tactile frames.
pub fn of_tactile(expected: &Tactile, actual: &Tactile) -> Option<FieldDifference> {
    let (was, is) = (&expected.forces, &actual.forces);
    let mut forces = was.iter().zip(is).enumerate();
    number("stamp", expected.stamp, actual.stamp)
        .or_else(|| value("number of forces", was.len(), is.len()))
        .or_else(|| {
            forces.find_map(|(index, (&was, &is))| vector(format_args!("forces[{index}]"), was, is))
        })
}

/// Compares two messages of the flag analyzer.
pub fn of_flags(expected: &Flags, actual: &Flags) -> Option<FieldDifference> {
    let (element, actual_element) = (expected.largest_element, actual.largest_element);
    let (rates, actual_rates) = (&expected.shear_rate, &actual.shear_rate);
    value("touch", expected.touch, actual.touch)
        .or_else(|| value("slip", expected.slip, actual.slip))
        .or_else(|| value("over", expected.over, actual.over))
        .or_else(|| value("largest_element", element, actual_element))
        .or_else(|| number("grasp_force", expected.grasp_force, actual.grasp_force))
        .or_else(|| value("number of shear rates", rates.len(), actual_rates.len()))
        .or_else(|| numbers("shear_rate", rates, actual_rates))
}

/// Compares two commands of a finger.
pub fn of_command(expected: &Command, actual: &Command) -> Option<FieldDifference> {
    let (was, is) = (expected.fingertip_velocity, actual.fingertip_velocity);
    numbers(
        "joint_velocity",
        expected.joint_velocity.as_slice(),
        actual.joint_velocity.as_slice(),
    )
    .or_else(|| vector("fingertip_velocity", was, is))
    .or_else(|| value("limited", expected.limited, actual.limited))
    .or_else(|| number("damping", expected.damping, actual.damping))
}

/// Compares two task messages, except their reasons, whose wording may change.
pub fn of_task(expected: &Task, actual: &Task) -> Option<FieldDifference> {
    value("phase", expected.phase, actual.phase)
        .or_else(|| value("stroke", expected.stroke, actual.stroke))
}

/// Compares two messages with findings.
pub fn of_findings(expected: &Findings, actual: &Findings) -> Option<FieldDifference> {
    let [outcome, actual_outcome] =
        [expected, actual].map(|of| of.outcome.as_ref().map_or("", TaskOutcome::as_str));
    let (was, is) = (&expected.values, &actual.values);
    let mut names = expected.names.iter().zip(&actual.names);
    let mut values = expected.names.iter().zip(was.iter().zip(is));
    text("outcome", outcome, actual_outcome)
        .or_else(|| value("number of findings", was.len(), is.len()))
        .or_else(|| names.find_map(|(was, is)| text("name", was.as_str(), is.as_str())))
        .or_else(|| values.find_map(|(name, (&was, &is))| number(name, was, is)))
}
