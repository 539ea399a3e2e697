//! Panels of interactive figures.

use super::table::Rows;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Quantity of a panel's x axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PanelKind {
    /// Time of the run.
    Time,
    /// Any other quantity.
    Xy,
}

/// A panel of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Quantity of the x axis.
    pub kind: PanelKind,
    /// X axis.
    pub x: Axis,
    /// Y axis.
    pub y: Axis,
    /// Displayed series.
    pub series: Vec<Series>,
    /// Horizontal lines.
    pub thresholds: Vec<Threshold>,
    /// `true` if both axes have the same scale.
    pub equal: bool,
    /// Rows that are initially shown; all if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<(usize, usize)>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// Name of the quantity.
    pub label: String,
    /// Displayed unit.
    pub unit: Cow<'static, str>,
    /// Displayed units per SI unit.
    pub scale: f64,
    /// Initial range in SI units; fitted to the data if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
    /// `true` for a logarithmic axis.
    pub log: bool,
}

/// A horizontal line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Threshold {
    /// Value in SI units.
    pub value: f64,
    /// Name of the line.
    pub name: String,
}

/// Number of distinct finger colors.
pub const COLOURS: usize = 5;

/// Colour of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Colour of a finger, or of one of several compared items.
    Finger(usize),
    /// Colour of common quantities.
    Shared,
    /// Colour of planned values and limits.
    Reference,
    /// Colour of less important series.
    Background,
}

impl Serialize for Colour {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Finger(finger) => {
                serializer.collect_str(&format_args!("finger-{}", finger % COLOURS))
            }
            Self::Shared => serializer.serialize_str("shared"),
            Self::Reference => serializer.serialize_str("reference"),
            Self::Background => serializer.serialize_str("background"),
        }
    }
}

/// Drawing style of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Line {
    /// Solid line.
    Solid,
    /// Dashed line.
    Dashed,
    /// Dots.
    Points,
    /// A lane that is filled while a state is active.
    States,
}

/// A series of a panel, from a column of the run or from separate points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// Name of the series.
    pub name: String,
    /// Colour.
    pub colour: Colour,
    /// Drawing style.
    pub line: Line,
    /// Values from a column of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<ColumnPart>,
    /// Separate points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Points>,
}

/// One value of each row of a column, or one bit of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnPart {
    /// Name of the column.
    pub name: String,
    /// Index of the value within a row.
    pub index: usize,
    /// Bit of the value, if it is a bit field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bit: Option<u32>,
}

/// Points in SI units; unknown values are null. The other lists have either one entry per point or none.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Points {
    /// X values.
    pub x: Vec<f64>,
    /// Y values.
    pub y: Vec<Option<f64>>,
    /// Lower ends of the intervals in y.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub low: Vec<Option<f64>>,
    /// Upper ends of the intervals in y.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub high: Vec<Option<f64>>,
    /// Row of the run for each point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub row: Vec<usize>,
    /// Additional text for each point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub label: Vec<String>,
    /// Command for each point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<Command>,
}

/// Shell command for each point of a figure, which reruns its trial.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Command {
    /// Command with placeholders: `{folder}` for the page's folder, `{trial}` for the trial.
    pub pattern: String,
    /// Trial of each point.
    pub trial: Vec<u64>,
}

impl Command {
    /// Commands that repeat trials of the sweep in `folder`, relative to the page's folder.
    pub fn of_trials(folder: &str, trial: Vec<u64>) -> Self {
        let pattern = format!("feeler run --trial {{folder}}{folder} {{trial}}");
        Self { pattern, trial }
    }
}

impl Points {
    /// Points with a finite x.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut taken = Self::default();
        taken.extend(points);
        taken
    }

    /// Like [`new`](Self::new), with the row of each point.
    pub fn of_rows(points: impl IntoIterator<Item = (usize, f64, f64)>) -> Self {
        let points = points.into_iter().filter(|(_, x, _)| x.is_finite());
        let (row, points): (_, Vec<_>) = points.map(|(row, x, y)| (row, (x, y))).unzip();
        Self {
            row,
            ..Self::new(points)
        }
    }

    /// Appends points as a separate line.
    pub fn append(&mut self, points: Vec<(f64, f64)>) {
        if let (Some(&end), false) = (self.x.last(), points.is_empty()) {
            self.x.push(end);
            self.y.push(None);
        }
        self.extend(points);
    }

    fn extend(&mut self, points: impl IntoIterator<Item = (f64, f64)>) {
        for (x, y) in points.into_iter().filter(|(x, _)| x.is_finite()) {
            self.x.push(short(x));
            self.y.push(shown(y));
        }
    }

    /// Adds a vertical error bar to each point, given as (low, high).
    #[must_use]
    pub fn within(mut self, intervals: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let ends = intervals.into_iter().map(|(l, h)| (shown(l), shown(h)));
        (self.low, self.high) = ends.unzip();
        self
    }
}

fn shown(value: f64) -> Option<f64> {
    value.is_finite().then(|| short(value))
}

/// Rounds to six significant digits, which exceeds screen resolution.
fn short(value: f64) -> f64 {
    const DIGITS: i32 = 6;
    // Powers of ten up to 10^22 are exact, and so is the rounded result.
    match value.abs().log10().floor() as i32 {
        _ if value == 0.0 => 0.0,
        magnitude if magnitude < DIGITS => {
            let factor = 10_f64.powi((DIGITS - 1 - magnitude).min(22));
            (value * factor).round() / factor
        }
        _ => value.round(),
    }
}

impl Axis {
    /// Axis of a quantity shown in `unit`; `scale` is the number of these units per SI unit.
    pub fn new(label: impl Into<String>, unit: impl Into<Cow<'static, str>>, scale: f64) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            scale,
            range: None,
            log: false,
        }
    }
}

impl Panel {
    /// Panel of a quantity over the time of the run.
    pub fn over_time(y: Axis, series: Vec<Series>) -> Self {
        Self {
            kind: PanelKind::Time,
            x: Axis::new("Time", "s", 1.0),
            y,
            series,
            thresholds: Vec::new(),
            equal: false,
            rows: None,
        }
    }

    /// Panel of a quantity over another.
    pub fn of(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            kind: PanelKind::Xy,
            x,
            ..Self::over_time(y, series)
        }
    }

    /// Adds a horizontal line.
    #[must_use]
    pub fn with_threshold(mut self, value: f64, name: &str) -> Self {
        let name = name.into();
        self.thresholds.push(Threshold { value, name });
        self
    }

    /// Converts rows of the run to rows of the page, which may omit some.
    pub(super) fn take_rows(&mut self, rows: &Rows) {
        self.rows = self.rows.map(|(start, end)| (rows.of(start), rows.of(end)));
        let points = self.series.iter_mut().filter_map(|s| s.points.as_mut());
        for row in points.flat_map(|points| &mut points.row) {
            *row = rows.of(*row);
        }
    }
}

impl Series {
    /// Series of a column's values.
    pub fn of_column(name: impl Into<String>, colour: Colour, column: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            colour,
            line: Line::Solid,
            column: Some(ColumnPart {
                name: column.into(),
                index: 0,
                bit: None,
            }),
            points: None,
        }
    }

    /// A lane that is filled while a bit of a column is set.
    pub fn of_bit(name: String, colour: Colour, column: String, bit: u32) -> Self {
        Self {
            line: Line::States,
            column: Some(ColumnPart {
                name: column,
                index: 0,
                bit: Some(bit),
            }),
            ..Self::of_column(name, colour, "")
        }
    }

    /// Series of separate points.
    pub fn of_points(name: impl Into<String>, colour: Colour, points: Points) -> Self {
        Self {
            name: name.into(),
            colour,
            line: Line::Solid,
            column: None,
            points: Some(points),
        }
    }

    /// Draws the series as dots.
    #[must_use]
    pub fn dotted(mut self) -> Self {
        self.line = Line::Points;
        self
    }

    /// Draws the series as a dashed line.
    #[must_use]
    pub fn dashed(mut self) -> Self {
        self.line = Line::Dashed;
        self
    }
}
