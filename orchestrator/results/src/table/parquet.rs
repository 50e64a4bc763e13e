//! The columns of a Parquet file, of this program or of another.

use parquet::basic::Type;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use std::fs::File;

/// A file whose columns are numbers or Booleans.
pub(super) struct ParquetTable {
    reader: SerializedFileReader<File>,
}

impl ParquetTable {
    /// Opens a file and returns the names of its columns too.
    ///
    /// # Errors
    /// It is no complete Parquet file.
    pub fn open(file: File) -> Result<(Self, Vec<String>), String> {
        let reader = SerializedFileReader::new(file).map_err(|error| text_of(&error))?;
        let columns = reader.metadata().file_metadata().schema_descr().columns().iter();
        let names = columns.map(|column| column.path().string()).collect();
        Ok((Self { reader }, names))
    }

    /// Whether a column holds Booleans or whole numbers.
    pub fn is_discrete(&self, index: usize) -> bool {
        let schema = self.reader.metadata().file_metadata().schema_descr();
        matches!(schema.column(index).physical_type(), Type::BOOLEAN | Type::INT32 | Type::INT64)
    }

    /// The values of a column, row by row; `None` where there is none.
    ///
    /// # Errors
    /// The column does not hold one number or Boolean for each row, or cannot be read.
    pub fn column(&self, index: usize) -> Result<Vec<Option<f64>>, String> {
        let mut values = Vec::new();
        for group in 0..self.reader.num_row_groups() {
            let group = self.reader.get_row_group(group).map_err(|error| text_of(&error))?;
            values.extend(of_group(&*group, index)?);
        }
        Ok(values)
    }
}

fn of_group(group: &dyn RowGroupReader, index: usize) -> Result<Vec<Option<f64>>, String> {
    let column = group.metadata().column(index).column_descr();
    if column.max_rep_level() > 0 || column.max_def_level() > 1 {
        return Err("it holds lists or groups, not one value for each row".to_owned());
    }
    let rows = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
    let is_optional = column.max_def_level() == 1;
    let read = group.get_column_reader(index).map_err(|error| text_of(&error))?;
    match read {
        ColumnReader::DoubleColumnReader(reader) => cells(reader, rows, is_optional, |value: f64| value),
        ColumnReader::FloatColumnReader(reader) => cells(reader, rows, is_optional, f64::from),
        ColumnReader::Int32ColumnReader(reader) => cells(reader, rows, is_optional, f64::from),
        ColumnReader::Int64ColumnReader(reader) => cells(reader, rows, is_optional, |value: i64| value as f64),
        ColumnReader::BoolColumnReader(reader) => {
            cells(reader, rows, is_optional, |value: bool| f64::from(u8::from(value)))
        }
        _ => Err("it holds neither numbers nor Booleans".to_owned()),
    }
}

fn cells<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    is_optional: bool,
    number: impl Fn(T::T) -> f64,
) -> Result<Vec<Option<f64>>, String> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    while reader.read_records(rows, Some(&mut levels), None, &mut values).map_err(|error| text_of(&error))?.0 > 0 {}
    let mut values = values.into_iter().map(number);
    let cells: Vec<_> = if is_optional {
        levels.into_iter().map(|level| if level == 1 { values.next() } else { None }).collect()
    } else {
        values.map(Some).collect()
    };
    if cells.len() == rows { Ok(cells) } else { Err("it has not as many values as the file has rows".to_owned()) }
}

/// The message without the kind of error that the library puts before it.
fn text_of(error: &ParquetError) -> String {
    let text = error.to_string();
    text.split_once(": ").map_or(text.clone(), |(_, message)| message.to_owned())
}
