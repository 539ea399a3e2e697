//! Panels of figures that answer.

use super::table::Rows;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::ops::Range;

/// What a panel's axis along x is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PanelKind {
    /// Time.
    Time,
    /// Anything.
    Xy,
}

/// A panel of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// What its axis along x is.
    pub kind: PanelKind,
    /// Along x.
    pub x: Axis,
    /// Along y.
    pub y: Axis,
    /// What it shows.
    pub series: Vec<Series>,
    /// Horizontal lines.
    pub thresholds: Vec<Threshold>,
    /// Whether lengths along x and y are alike.
    pub equal: bool,
    /// Rows that are shown at first, if not all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<(usize, usize)>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// What it is.
    pub label: String,
    /// The unit that is shown.
    pub unit: Cow<'static, str>,
    /// Units that are shown per SI unit.
    pub scale: f64,
    /// What it shows at first, in SI units, if not all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
    /// Whether equal distances stand for equal ratios.
    pub log: bool,
}

/// A horizontal line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Threshold {
    /// Where it is, in SI units.
    pub value: f64,
    /// What it is.
    pub name: String,
}

/// Fingers that have a colour of their own.
pub const COLOURS: usize = 5;

/// Colour of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// Of a finger; of one of several things that are compared.
    Finger(usize),
    /// Of what belongs to all.
    Shared,
    /// Of what was planned, or is allowed.
    Reference,
    /// Of what is less important.
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

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Line {
    /// A line.
    Solid,
    /// A broken line.
    Dashed,
    /// Dots.
    Points,
    /// A lane that is filled while something is so.
    States,
}

/// What a panel shows: numbers of a column, or points of its own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// What it is.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// How it is drawn.
    pub line: Line,
    /// Numbers of a column of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<ColumnPart>,
    /// Points of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Points>,
}

/// A number of each row of a column, or a bit of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnPart {
    /// The column.
    pub name: String,
    /// Which number of a row.
    pub index: usize,
    /// Which bit of it, if it holds some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bit: Option<u32>,
}

/// Points in SI units; what is not known is null. What else there is has an entry for each point, or none at all.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Points {
    /// Along x.
    pub x: Vec<f64>,
    /// Along y.
    pub y: Vec<Option<f64>>,
    /// Lower ends of the intervals about y.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub low: Vec<Option<f64>>,
    /// Upper ends of the intervals about y.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub high: Vec<Option<f64>>,
    /// The row of the run that each belongs to.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub row: Vec<usize>,
    /// What else is to be said of each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub label: Vec<String>,
    /// The command that shows each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<Command>,
}

/// A command for each point.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Command {
    /// The command, with `{folder}` in place of the page's folder and `{trial}` in place of the trial.
    pub pattern: String,
    /// The trial of each point.
    pub trial: Vec<u64>,
}

impl Command {
    /// What runs trials alone of the sweep in `folder` of the page's own.
    pub fn of_trials(folder: &str, trial: Vec<u64>) -> Self {
        let pattern = format!("feeler run --trial {{folder}}{folder} {{trial}}");
        Self { pattern, trial }
    }
}

impl Points {
    /// Those whose x is a number.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut taken = Self::default();
        taken.extend(points);
        taken
    }

    /// The same, each with its row.
    pub fn of_rows(points: impl IntoIterator<Item = (usize, f64, f64)>) -> Self {
        let points = points.into_iter().filter(|(_, x, _)| x.is_finite());
        let (row, points): (_, Vec<_>) = points.map(|(row, x, y)| (row, (x, y))).unzip();
        Self {
            row,
            ..Self::new(points)
        }
    }

    /// Takes another line, which does not go on where the last ends.
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

    /// The same, with the intervals about y from low to high.
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

/// A number to six significant digits: more precise than a screen can show.
fn short(value: f64) -> f64 {
    const DIGITS: i32 = 6;
    // Powers of ten up to the 22nd are exact, and so is what is left of the digits.
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
    /// Of a quantity that is shown in `unit`, of which an SI unit has `scale`.
    pub fn new(label: impl Into<String>, unit: impl Into<Cow<'static, str>>, scale: f64) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            scale,
            range: None,
            log: false,
        }
    }

    /// Of time.
    fn time() -> Self {
        Self::new("Time", "s", 1.0)
    }
}

impl Panel {
    /// A quantity over the time of the run.
    pub fn over_time(y: Axis, series: Vec<Series>) -> Self {
        Self {
            kind: PanelKind::Time,
            x: Axis::time(),
            y,
            series,
            thresholds: Vec::new(),
            equal: false,
            rows: None,
        }
    }

    /// A quantity over another.
    pub fn of(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            kind: PanelKind::Xy,
            x,
            ..Self::over_time(y, series)
        }
    }

    /// The same with a horizontal line.
    #[must_use]
    pub fn with_threshold(mut self, value: f64, name: &str) -> Self {
        let name = name.into();
        self.thresholds.push(Threshold { value, name });
        self
    }

    /// The same, showing these rows at first.
    #[must_use]
    pub fn of_rows(mut self, rows: &Range<usize>) -> Self {
        self.rows = Some((rows.start, rows.end));
        self
    }

    /// Takes the run's rows for those of its page, where some are left out.
    pub(super) fn take_rows(&mut self, rows: &Rows) {
        self.rows = self.rows.map(|(start, end)| (rows.of(start), rows.of(end)));
        let points = self.series.iter_mut().filter_map(|s| s.points.as_mut());
        for row in points.flat_map(|points| &mut points.row) {
            *row = rows.of(*row);
        }
    }
}

impl Series {
    /// Numbers of a column.
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

    /// A lane that is filled while a bit of a column is up.
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

    /// The same of another number of each row.
    #[must_use]
    pub fn at(mut self, index: usize) -> Self {
        if let Some(column) = &mut self.column {
            column.index = index;
        }
        self
    }

    /// Points.
    pub fn of_points(name: impl Into<String>, colour: Colour, points: Points) -> Self {
        Self {
            name: name.into(),
            colour,
            line: Line::Solid,
            column: None,
            points: Some(points),
        }
    }

    /// The same as dots.
    #[must_use]
    pub fn dotted(mut self) -> Self {
        self.line = Line::Points;
        self
    }

    /// The same as a broken line.
    #[must_use]
    pub fn dashed(mut self) -> Self {
        self.line = Line::Dashed;
        self
    }
}
