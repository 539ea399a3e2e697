//! Parquet files, written one row group at a time.
//!
//! A cell is a value, an array of values (nested lists), or null. Values within an array are never null.

use parquet::basic::{Compression, LogicalType, Repetition};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::io::Write;
use std::sync::Arc;

/// The cells of a column in Parquet's form: non-null values with their definition and repetition levels.
pub(crate) struct Cells<D: DataType> {
    /// Nesting depth of the lists in a cell; 0 if a cell is a single value.
    depth: i16,
    values: Vec<D::T>,
    definition: Vec<i16>,
    repetition: Vec<i16>,
}

impl<D: DataType> Cells<D> {
    /// Cells with one value each; `None` is null.
    pub fn of_values(cells: impl IntoIterator<Item = Option<D::T>>) -> Self {
        let mut made = Self::empty(0);
        for cell in cells {
            match cell {
                Some(value) => made.push(&[], [value]),
                None => made.push_null(),
            }
        }
        made
    }

    /// Cells with one list each; `None` is null.
    pub fn of_lists<L>(cells: impl IntoIterator<Item = Option<L>>) -> Self
    where
        L: IntoIterator<Item = D::T, IntoIter: ExactSizeIterator>,
    {
        let mut made = Self::empty(1);
        for cell in cells {
            match cell.map(IntoIterator::into_iter) {
                Some(list) => made.push(&[list.len()], list),
                None => made.push_null(),
            }
        }
        made
    }

    /// Cells with one array of this shape each, taken consecutively from the row-major `values`.
    pub fn of_arrays(shape: &[usize], values: impl IntoIterator<Item = D::T>) -> Self {
        let mut made = Self::empty(shape.len());
        let size = shape.iter().product();
        let mut values = values.into_iter().peekable();
        while size > 0 && values.peek().is_some() {
            made.push(shape, values.by_ref().take(size));
        }
        made
    }

    fn empty(depth: usize) -> Self {
        Self {
            depth: depth as i16,
            values: Vec::new(),
            definition: Vec::new(),
            repetition: Vec::new(),
        }
    }

    fn push_null(&mut self) {
        self.definition.push(0);
        self.repetition.push(0);
    }

    fn push(&mut self, shape: &[usize], values: impl IntoIterator<Item = D::T>) {
        let start = self.values.len();
        self.values.extend(values);
        let count = self.values.len() - start;
        if count == 0 {
            // Present, but empty.
            self.definition.push(1);
            self.repetition.push(0);
        }
        for place in 0..count {
            self.definition.push(self.depth + 1);
            self.repetition.push(continued(place, shape));
        }
    }

    fn write(&self, column: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let repetition = (self.depth > 0).then_some(self.repetition.as_slice());
        let writer = column.typed::<D>();
        writer.write_batch(&self.values, Some(&self.definition), repetition)?;
        Ok(())
    }
}

/// Repetition level of the value at index `place` of an array: the nesting level of the list that continues there
/// (outermost list: 1), or 0 for the first value.
fn continued(place: usize, shape: &[usize]) -> i16 {
    if place == 0 {
        return 0;
    }
    let mut size = 1;
    let mut level = shape.len();
    for &length in shape.iter().rev() {
        size *= length;
        if !place.is_multiple_of(size) {
            break;
        }
        level -= 1;
    }
    level as i16
}

/// The cells of a column, by value type.
pub(crate) enum AnyCells {
    /// Booleans.
    Bool(Cells<BoolType>),
    /// 64-bit integers.
    Int(Cells<Int64Type>),
    /// 32-bit floats.
    Float(Cells<FloatType>),
    /// 64-bit floats.
    Double(Cells<DoubleType>),
    /// UTF-8 strings.
    Text(Cells<ByteArrayType>),
}

/// Evaluates `$body` with `$cells` bound to the cells of any variant.
macro_rules! with_cells {
    ($any:expr, $cells:ident => $body:expr) => {
        match $any {
            AnyCells::Bool($cells) => $body,
            AnyCells::Int($cells) => $body,
            AnyCells::Float($cells) => $body,
            AnyCells::Double($cells) => $body,
            AnyCells::Text($cells) => $body,
        }
    };
}

impl AnyCells {
    /// Cells with one string each.
    pub fn texts<T: ToString>(cells: impl IntoIterator<Item = T>) -> Self {
        let text = |text: T| Some(ByteArray::from(text.to_string().as_str()));
        Self::Text(Cells::of_values(cells.into_iter().map(text)))
    }

    /// Cells with one integer each.
    pub fn counts(cells: impl IntoIterator<Item = usize>) -> Self {
        let number = |count| Some(count as i64);
        Self::Int(Cells::of_values(cells.into_iter().map(number)))
    }

    /// Field of a column with these cells in the Parquet schema.
    fn field(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let depth = with_cells!(self, cells => cells.depth);
        let value = with_cells!(self, cells => physical_type(cells));
        let text = matches!(self, Self::Text(_)).then_some(LogicalType::String);
        let repetition = |outermost| match outermost {
            true => Repetition::OPTIONAL,
            false => Repetition::REQUIRED,
        };
        let inner = if depth == 0 { name } else { "element" };
        let value = Type::primitive_type_builder(inner, value)
            .with_logical_type(text)
            .with_repetition(repetition(depth == 0));
        let mut field = Arc::new(value.build()?);
        for level in (0..depth).rev() {
            let list = Type::group_type_builder("list")
                .with_repetition(Repetition::REPEATED)
                .with_fields(vec![field]);
            let outer = if level == 0 { name } else { "element" };
            let group = Type::group_type_builder(outer)
                .with_logical_type(Some(LogicalType::List))
                .with_repetition(repetition(level == 0))
                .with_fields(vec![Arc::new(list.build()?)]);
            field = Arc::new(group.build()?);
        }
        Ok(field)
    }
}

fn physical_type<D: DataType>(_: &Cells<D>) -> parquet::basic::Type {
    D::get_physical_type()
}

/// A column of a row group.
pub(crate) struct Column {
    /// Column name.
    pub name: String,
    /// Cells, one per row.
    pub cells: AnyCells,
}

/// A Parquet file being written to `W`.
pub(crate) struct ParquetFile<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> ParquetFile<W> {
    /// Creates a file with the schema of `columns` and the key-value metadata `about`.
    pub fn create(
        out: W,
        columns: &[Column],
        about: Vec<(String, String)>,
    ) -> Result<Self, ParquetError> {
        let fields = columns
            .iter()
            .map(|column| column.cells.field(&column.name));
        let schema =
            Type::group_type_builder("schema").with_fields(fields.collect::<Result<_, _>>()?);
        let about = about
            .into_iter()
            .map(|(key, value)| KeyValue::new(key, value));
        let properties = WriterProperties::builder()
            // Every reader supports Snappy without a C library.
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(about.collect()))
            .build();
        let writer =
            SerializedFileWriter::new(out, Arc::new(schema.build()?), Arc::new(properties))?;
        Ok(Self { writer })
    }

    /// Writes a row group. `columns` must be in schema order.
    pub fn write(&mut self, columns: &[Column]) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for column in columns {
            let Some(mut writer) = group.next_column()? else {
                break;
            };
            with_cells!(&column.cells, cells => cells.write(&mut writer)?);
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// File size so far (bytes).
    pub fn size(&self) -> usize {
        self.writer.bytes_written()
    }

    /// Writes the footer and closes the file.
    pub fn close(self) -> Result<(), ParquetError> {
        self.writer.close()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetition_levels_match_dremel() {
        // Example of the Dremel paper for regular arrays: [[a, b, c], [d, e, f]].
        let levels = |shape: &[usize], count| -> Vec<i16> {
            (0..count).map(|place| continued(place, shape)).collect()
        };
        assert_eq!(levels(&[2, 3], 6), [0, 2, 2, 1, 2, 2]);
        assert_eq!(levels(&[3], 3), [0, 1, 1]);
        assert_eq!(levels(&[2, 1, 2], 4), [0, 3, 1, 3]);
        assert_eq!(levels(&[3, 1, 1], 3), [0, 1, 1]);
        assert_eq!(levels(&[], 1), [0]);
    }
}
