//! A feature of a data set: what LeRobot calls a column.

use super::stats::Stats;
use crate::columnar::{AnyCells, Cells, Column};
use serde_json::{Map, Value, json};

/// Values of a feature, those of one frame after the other, row-major.
#[derive(Debug)]
pub(crate) enum Values {
    /// True or false.
    Bool(Vec<bool>),
    /// Whole numbers.
    Int(Vec<i64>),
    /// Numbers of 32 bits, as LeRobot has them throughout.
    Float(Vec<f32>),
}

/// A feature with its values over an episode.
#[derive(Debug)]
pub(crate) struct Feature {
    /// Its name.
    pub key: String,
    /// Shape of a frame's values.
    pub shape: Vec<usize>,
    /// Names of its entries; of an array, of its axes. Null where there are none.
    pub names: Value,
    /// What LeRobot does not ask for, and leaves as it is: `units`, for one.
    pub about: Map<String, Value>,
    /// Its values.
    pub values: Values,
}

impl Feature {
    /// A feature of one whole number in each frame that LeRobot asks for.
    pub fn index(key: &str, values: impl Iterator<Item = usize>) -> Self {
        let values = values.map(|value| value as i64);
        Self::of_one(key, Values::Int(values.collect()))
    }

    /// A feature of one value in each frame.
    pub fn of_one(key: &str, values: Values) -> Self {
        Self {
            key: key.into(),
            shape: vec![1],
            names: Value::Null,
            about: Map::new(),
            values,
        }
    }

    /// As it stands in `info.json`.
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

    /// As a column: what has the shape [1] is a value, all else lists.
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

    /// Its statistics.
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
