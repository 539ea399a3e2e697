//! Parquet files, a group of rows at a time.
//!
//! A cell is a value, or an array of values: lists in lists. A cell without a value is null; values within an array are
//! never null.

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

/// The cells of a column, as Parquet keeps them: values without nulls, and where each stands by its levels.
pub(crate) struct Cells<D: DataType> {
    /// Lists in each other in a cell; 0 where a cell is one value.
    depth: i16,
    values: Vec<D::T>,
    definition: Vec<i16>,
    repetition: Vec<i16>,
}

impl<D: DataType> Cells<D> {
    /// Cells of one value each.
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

    /// Cells of one list each.
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

    /// Cells of an array of this shape each, one after the other in `values`, row-major.
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
            // There, but empty.
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

/// Which list goes on with the value at a place of an array, from the outermost, 1; 0 where the array begins.
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

/// The cells of a column of any type.
pub(crate) enum AnyCells {
    /// True or false.
    Bool(Cells<BoolType>),
    /// Whole numbers.
    Int(Cells<Int64Type>),
    /// Numbers of 32 bits.
    Float(Cells<FloatType>),
    /// Numbers of 64 bits.
    Double(Cells<DoubleType>),
    /// Texts.
    Text(Cells<ByteArrayType>),
}

/// Calls `$body` with the cells of any type.
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
    /// A text in each cell.
    pub fn texts<T: ToString>(cells: impl IntoIterator<Item = T>) -> Self {
        let text = |text: T| Some(ByteArray::from(text.to_string().as_str()));
        Self::Text(Cells::of_values(cells.into_iter().map(text)))
    }

    /// A whole number in each cell.
    pub fn counts(cells: impl IntoIterator<Item = usize>) -> Self {
        let number = |count| Some(count as i64);
        Self::Int(Cells::of_values(cells.into_iter().map(number)))
    }

    /// What a column of such cells is called in a file's schema.
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

/// A column of a group of rows.
pub(crate) struct Column {
    /// Its name.
    pub name: String,
    /// Its cells, one for each row.
    pub cells: AnyCells,
}

/// A Parquet file on its way to `W`.
pub(crate) struct ParquetFile<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> ParquetFile<W> {
    /// Begins a file of columns such as these, with texts about it by name.
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
            // What every reader has, without a C library.
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(about.collect()))
            .build();
        let writer =
            SerializedFileWriter::new(out, Arc::new(schema.build()?), Arc::new(properties))?;
        Ok(Self { writer })
    }

    /// Writes a group of rows: the columns of the file, in its order.
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

    /// How large the file is so far, bytes.
    pub fn size(&self) -> usize {
        self.writer.bytes_written()
    }

    /// Ends the file.
    pub fn close(self) -> Result<(), ParquetError> {
        self.writer.close()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_tell_where_a_value_stands_in_lists_of_lists() {
        // The example of Dremel's paper for regular arrays: [[a, b, c], [d, e, f]].
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
