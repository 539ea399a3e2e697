//! A feature (column) of a LeRobot data set.

use super::stats::Stats;
use crate::columnar::{AnyCells, Cells, Column};
use serde_json::{Map, Value, json};

/// Values of a feature over all frames, frame by frame, row-major.
#[derive(Debug)]
pub(crate) enum Values {
    /// Booleans.
    Bool(Vec<bool>),
    /// 64-bit integers.
    Int(Vec<i64>),
    /// 32-bit floats, the only float type of LeRobot.
    Float(Vec<f32>),
}

/// A feature with its values over an episode.
#[derive(Debug)]
pub(crate) struct Feature {
    /// Feature key.
    pub key: String,
    /// Shape of the values of one frame.
    pub shape: Vec<usize>,
    /// Names of a vector's entries or of an array's axes; null if they have no names.
    pub names: Value,
    /// Additional metadata that LeRobot preserves but does not use, such as `units`.
    pub about: Map<String, Value>,
    /// Values over all frames.
    pub values: Values,
}

impl Feature {
    /// An index feature required by LeRobot: one integer per frame.
    pub fn index(key: &str, values: impl Iterator<Item = usize>) -> Self {
        let values = values.map(|value| value as i64);
        Self::of_one(key, Values::Int(values.collect()))
    }

    /// A feature with one value per frame.
    pub fn of_one(key: &str, values: Values) -> Self {
        Self {
            key: key.into(),
            shape: vec![1],
            names: Value::Null,
            about: Map::new(),
            values,
        }
    }

    /// Description of the feature for `info.json`.
    pub fn description(&self) -> Value {
        let mut description = self.about.clone();
        let dtype = match self.values {
            Values::Bool(_) => "bool",
            Values::Int(_) => "int64",
            Values::Float(_) => "float32",
        };
        description.insert("dtype".into(), json!(dtype));
        description.insert("shape".into(), json!(self.shape));
        description.insert("names".into(), self.names.clone());
        Value::Object(description)
    }

    /// Data column of the feature. Shape `[1]` becomes a scalar; other shapes become nested lists.
    pub fn column(&self) -> Column {
        let shape = match self.shape.as_slice() {
            [1] => &[],
            shape => shape,
        };
        let cells = match &self.values {
            Values::Bool(values) => AnyCells::Bool(Cells::of_arrays(shape, values.iter().copied())),
            Values::Int(values) => AnyCells::Int(Cells::of_arrays(shape, values.iter().copied())),
            Values::Float(values) => {
                AnyCells::Float(Cells::of_arrays(shape, values.iter().copied()))
            }
        };
        Column {
            name: self.key.clone(),
            cells,
        }
    }

    /// Statistics of each component over the episode.
    pub fn stats(&self) -> Stats {
        let numbers: Vec<f64> = match &self.values {
            Values::Bool(values) => values
                .iter()
                .map(|&value| f64::from(u8::from(value)))
                .collect(),
            Values::Int(values) => values.iter().map(|&value| value as f64).collect(),
            Values::Float(values) => values.iter().map(|&value| value.into()).collect(),
        };
        let width = self.shape.last().copied().unwrap_or(1).max(1);
        let component = |first: usize| numbers.iter().skip(first).step_by(width).copied();
        let components = (0..width).map(|first| component(first).collect());
        let frames = numbers.len() / self.shape.iter().product::<usize>().max(1);
        Stats::new(frames, components.collect())
    }
}
