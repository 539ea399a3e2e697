//! Messages as lists of named values, for comparison one by one.

use feeler::control::Phase;
use feeler_record::wire::Vector3;
use feeler_record::{Command, Findings, Flags, Tactile, Task, TaskOutcome};
use std::fmt;

/// One value of a message.
#[derive(Debug, Clone, Copy)]
pub enum Value<'a> {
    Number(f64),
    Count(u64),
    Flag(bool),
    Phase(Phase),
    Text(&'a str),
}

impl Value<'_> {
    /// Returns `true` if both values are bit-identical.
    fn same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a.to_bits() == b.to_bits(),
            (Self::Count(a), Self::Count(b)) => a == b,
            (Self::Flag(a), Self::Flag(b)) => a == b,
            (Self::Phase(a), Self::Phase(b)) => a == b,
            (Self::Text(a), Self::Text(b)) => a == b,
            _ => false,
        }
    }
}

impl fmt::Display for Value<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Show the bits, since different NaNs have the same text.
            Self::Number(x) if x.is_nan() => write!(f, "NaN ({:#018x})", x.to_bits()),
            // The shortest text that parses back to the same number.
            Self::Number(x) => write!(f, "{x:?}"),
            Self::Count(count) => count.fmt(f),
            Self::Flag(flag) => flag.fmt(f),
            Self::Phase(phase) => phase.fmt(f),
            Self::Text(text) => write!(f, "{text:?}"),
        }
    }
}

/// Field in which two messages are compared: its name `list[index]part`, and its value in each message.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    list: &'a str,
    index: Option<usize>,
    part: &'static str,
    /// Recorded value.
    pub expected: Value<'a>,
    /// Replayed value.
    pub actual: Value<'a>,
}

impl Field<'_> {
    pub fn differs(&self) -> bool {
        !self.expected.same(self.actual)
    }

    /// Returns the full name of the value.
    pub fn name(&self) -> String {
        let Self { list, part, .. } = self;
        match self.index {
            Some(index) => format!("{list}[{index}]{part}"),
            None => format!("{list}{part}"),
        }
    }
}

fn one<'a>(name: &'a str, expected: Value<'a>, actual: Value<'a>) -> Field<'a> {
    Field {
        list: name,
        index: None,
        part: "",
        expected,
        actual,
    }
}

fn number(name: &str, expected: f64, actual: f64) -> Field<'_> {
    one(name, Value::Number(expected), Value::Number(actual))
}

fn flag(name: &str, expected: bool, actual: bool) -> Field<'_> {
    one(name, Value::Flag(expected), Value::Flag(actual))
}

/// Compares the lengths of two lists, and their elements up to the shorter length.
fn numbers<'a>(
    list: &'static str,
    length: &'static str,
    expected: &'a [f64],
    actual: &'a [f64],
) -> impl Iterator<Item = Field<'a>> {
    let count = |list: &[f64]| Value::Count(list.len() as u64);
    let lengths = one(length, count(expected), count(actual));
    let numbers = expected.iter().zip(actual).enumerate();
    let numbers = numbers.map(move |(index, (&expected, &actual))| Field {
        index: Some(index),
        ..number(list, expected, actual)
    });
    std::iter::once(lengths).chain(numbers)
}

fn vector<'a>(
    list: &'static str,
    index: Option<usize>,
    expected: Vector3,
    actual: Vector3,
) -> impl Iterator<Item = Field<'a>> {
    let parts = [
        (".x", expected.x, actual.x),
        (".y", expected.y, actual.y),
        (".z", expected.z, actual.z),
    ];
    parts
        .into_iter()
        .map(move |(part, expected, actual)| Field {
            index,
            part,
            ..number(list, expected, actual)
        })
}

/// Fields of two tactile frames: stamp and forces.
pub fn of_tactile<'a>(
    expected: &'a Tactile,
    actual: &'a Tactile,
) -> impl Iterator<Item = Field<'a>> {
    let count = |frame: &Tactile| Value::Count(frame.forces.len() as u64);
    let forces = expected.forces.iter().zip(&actual.forces).enumerate();
    let forces = forces.flat_map(|(index, (&was, &is))| vector("forces", Some(index), was, is));
    [
        number("stamp", expected.stamp, actual.stamp),
        one("number of forces", count(expected), count(actual)),
    ]
    .into_iter()
    .chain(forces)
}

/// Fields of two messages of the flag analyzer.
pub fn of_flags<'a>(expected: &'a Flags, actual: &'a Flags) -> impl Iterator<Item = Field<'a>> {
    let element = |flags: &Flags| Value::Count(flags.largest_element.into());
    let rates = (&expected.shear_rate, &actual.shear_rate);
    [
        flag("touch", expected.touch, actual.touch),
        flag("slip", expected.slip, actual.slip),
        flag("over", expected.over, actual.over),
        one("largest_element", element(expected), element(actual)),
        number("grasp_force", expected.grasp_force, actual.grasp_force),
    ]
    .into_iter()
    .chain(numbers(
        "shear_rate",
        "number of shear rates",
        rates.0,
        rates.1,
    ))
}

/// Fields of two commands of a finger.
pub fn of_command<'a>(
    expected: &'a Command,
    actual: &'a Command,
) -> impl Iterator<Item = Field<'a>> {
    let joints = expected.joint_velocity.iter().zip(&actual.joint_velocity);
    let joints = joints.enumerate().map(|(joint, (&was, &is))| Field {
        index: Some(joint),
        ..number("joint_velocity", was, is)
    });
    let (was, is) = (expected.fingertip_velocity, actual.fingertip_velocity);
    joints
        .chain(vector("fingertip_velocity", None, was, is))
        .chain([
            flag("limited", expected.limited, actual.limited),
            number("damping", expected.damping, actual.damping),
        ])
}

/// Fields of two task messages. Reasons are not compared because their wording may change.
pub fn of_task<'a>(expected: &'a Task, actual: &'a Task) -> impl Iterator<Item = Field<'a>> {
    let stroke = |task: &Task| Value::Count(task.stroke.into());
    let phase = |task: &Task| Value::Phase(task.phase);
    [
        one("phase", phase(expected), phase(actual)),
        one("stroke", stroke(expected), stroke(actual)),
    ]
    .into_iter()
}

/// Fields of two messages with findings.
pub fn of_findings<'a>(
    expected: &'a Findings,
    actual: &'a Findings,
) -> impl Iterator<Item = Field<'a>> {
    let count = |findings: &Findings| Value::Count(findings.values.len() as u64);
    let names = expected.names.iter().zip(&actual.names);
    let names =
        names.map(|(was, is)| one("name", Value::Text(was.as_str()), Value::Text(is.as_str())));
    let values = expected.values.iter().zip(&actual.values);
    let values = expected.names.iter().zip(values);
    let values = values.map(|(name, (&was, &is))| number(name.as_str(), was, is));
    let outcome =
        |findings: &'a Findings| findings.outcome.as_ref().map_or("", TaskOutcome::as_str);
    let (was, is) = (outcome(expected), outcome(actual));
    [
        one("outcome", Value::Text(was), Value::Text(is)),
        one("number of findings", count(expected), count(actual)),
    ]
    .into_iter()
    .chain(names)
    .chain(values)
}
