//! A column that grows: one gather appends the values of many records, and the end makes an arrow array of it.

use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, BinaryBuilder, FixedSizeListArray, NullBufferBuilder, PrimitiveArray,
    StringBuilder, TimestampMicrosecondArray,
};
use arrow::buffer::{NullBuffer, ScalarBuffer};
use arrow::datatypes::{
    ArrowPrimitiveType, DataType, Field as ArrowField, Float32Type, Float64Type, Int8Type,
    Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use mavwire_core::log::dataflash::{half, text::decode_line};
use mavwire_schema::{Field, FieldType, InvalidRule};

use crate::gather::{
    NO_TIME, Rows, each_text, each_valid, gather, gather_scaled, logged, number_in, parse,
    place_of, shown,
};
use crate::layout::{Column, Source};
use crate::units::Scale;

/// The values of a column so far.
#[derive(Debug)]
enum Values {
    Time(Vec<i64>),
    /// Times, or [`NO_TIME`].
    SomeTimes(Vec<i64>),
    U8(Vec<u8>),
    I8(Vec<i8>),
    U16(Vec<u16>),
    I16(Vec<i16>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    U64(Vec<u64>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    /// Numbers of any type, scaled.
    Scaled(Vec<f64>, Scale),
    Text(StringBuilder),
    RawText(BinaryBuilder),
}

/// A growing column.
#[derive(Debug)]
pub struct Growing {
    values: Values,
    /// Which rows have a value; of numbers only, the others know themselves.
    valid: NullBufferBuilder,
    /// The elements of an array that have a value.
    valid_elements: NullBufferBuilder,
    /// The rule for invalid values.
    invalid: Option<InvalidRule>,
    /// Numbers of a row.
    elements: usize,
    /// About how many bytes the name of a number may come to.
    name_len: usize,
}

impl Growing {
    /// An empty column.
    pub fn new(column: &Column, stamped: bool) -> Self {
        let (_, elements) = place_of(&column.source);
        let values = match &column.source {
            Source::Timestamp if stamped => Values::Time(Vec::new()),
            Source::Timestamp => Values::SomeTimes(Vec::new()),
            Source::Sysid | Source::Compid | Source::Seq => Values::U8(Vec::new()),
            Source::Text(_) | Source::LogText(_) => Values::Text(StringBuilder::new()),
            Source::RawText(_) | Source::Bytes(_) => Values::RawText(BinaryBuilder::new()),
            Source::Numbers(field) | Source::Half(field) => match column.scale {
                Some(scale) => Values::Scaled(Vec::new(), scale),
                None => empty(field.field_type),
            },
        };
        let name_len = column.names.as_ref().map_or(0, |names| names.mask_len);
        Self {
            values,
            valid: NullBufferBuilder::new(0),
            valid_elements: NullBufferBuilder::new(0),
            invalid: column.invalid.clone(),
            elements,
            name_len,
        }
    }

    /// Bytes of a row; of texts those that each has.
    pub(crate) fn width(&self) -> usize {
        match &self.values {
            Values::U8(_) | Values::I8(_) => self.elements,
            Values::U16(_) | Values::I16(_) => 2 * self.elements,
            Values::U32(_) | Values::I32(_) | Values::F32(_) => 4 * self.elements,
            Values::Text(_) | Values::RawText(_) => 4,
            _ => 8 * self.elements,
        }
    }

    /// Makes room for so many more rows, where there is memory for that.
    pub(crate) fn reserve(&mut self, rows: usize) {
        fn more<T>(values: &mut Vec<T>, count: usize) {
            // What fails here fails when the rows come, if they do.
            let _ = values.try_reserve_exact(count);
        }
        let count = rows.saturating_mul(self.elements);
        match &mut self.values {
            Values::Time(v) | Values::SomeTimes(v) | Values::I64(v) => more(v, count),
            Values::U8(v) => more(v, count),
            Values::I8(v) => more(v, count),
            Values::U16(v) => more(v, count),
            Values::I16(v) => more(v, count),
            Values::U32(v) => more(v, count),
            Values::I32(v) => more(v, count),
            Values::U64(v) => more(v, count),
            Values::F32(v) => more(v, count),
            Values::F64(v) | Values::Scaled(v, _) => more(v, count),
            Values::Text(_) | Values::RawText(_) => {}
        }
    }

    /// Appends a value for each row.
    pub fn append(&mut self, rows: &Rows<'_>, source: &Source) {
        let place = place_of(source);
        match &self.invalid {
            None => self.valid.append_n_non_nulls(rows.times.len()),
            Some(invalid) => {
                each_valid(rows, place, invalid, &mut self.valid, &mut self.valid_elements);
            }
        }
        match &mut self.values {
            Values::Time(values) | Values::SomeTimes(values) => {
                values.extend_from_slice(rows.times);
            }
            Values::U8(values) => gather(values, rows, place, u8::from_le_bytes),
            Values::I8(values) => gather(values, rows, place, i8::from_le_bytes),
            Values::U16(values) => gather(values, rows, place, u16::from_le_bytes),
            Values::I16(values) => gather(values, rows, place, i16::from_le_bytes),
            Values::U32(values) => gather(values, rows, place, u32::from_le_bytes),
            Values::I32(values) => gather(values, rows, place, i32::from_le_bytes),
            Values::U64(values) => gather(values, rows, place, u64::from_le_bytes),
            Values::I64(values) => gather(values, rows, place, i64::from_le_bytes),
            Values::F32(values) if matches!(source, Source::Half(_)) => {
                gather(values, rows, place, |bytes| half(u16::from_le_bytes(bytes)) as f32);
            }
            Values::F32(values) => gather(values, rows, place, f32::from_le_bytes),
            Values::F64(values) => gather(values, rows, place, f64::from_le_bytes),
            Values::Scaled(values, scale) => gather_scaled(values, rows, source, *scale),
            Values::Text(values) if matches!(source, Source::LogText(_)) => {
                each_text(rows, source, |raw| values.append_value(&*logged(raw)));
            }
            Values::Text(values) => {
                each_text(rows, source, |raw| values.append_value(&*shown(raw)));
            }
            Values::RawText(values) if matches!(source, Source::Bytes(_)) => {
                each_text(rows, source, |raw| values.append_value(raw));
            }
            Values::RawText(values) => {
                each_text(rows, source, |raw| {
                    values.append_option((shown(raw).as_bytes() != raw).then_some(raw));
                });
            }
        }
    }

    /// Appends the times of rows, or rows without a value.
    pub(crate) fn append_missing(&mut self, times: &[i64]) {
        let (rows, zeros) = (times.len(), times.len() * self.elements);
        if let Values::Time(values) | Values::SomeTimes(values) = &mut self.values {
            values.extend_from_slice(times);
            return self.valid.append_n_non_nulls(rows);
        }
        self.valid.append_n_nulls(rows);
        if self.invalid.is_some() {
            self.valid_elements.append_n_nulls(zeros);
        }
        match &mut self.values {
            Values::Time(_) | Values::SomeTimes(_) => {}
            Values::U8(v) => v.resize(v.len() + zeros, 0),
            Values::I8(v) => v.resize(v.len() + zeros, 0),
            Values::U16(v) => v.resize(v.len() + zeros, 0),
            Values::I16(v) => v.resize(v.len() + zeros, 0),
            Values::U32(v) => v.resize(v.len() + zeros, 0),
            Values::I32(v) => v.resize(v.len() + zeros, 0),
            Values::U64(v) => v.resize(v.len() + zeros, 0),
            Values::I64(v) => v.resize(v.len() + zeros, 0),
            Values::F32(v) => v.resize(v.len() + zeros, 0.0),
            Values::F64(v) | Values::Scaled(v, _) => v.resize(v.len() + zeros, 0.0),
            Values::Text(v) => v.append_nulls(rows),
            Values::RawText(v) => v.append_nulls(rows),
        }
    }

    /// Appends a value as a text log has it; null where it is none.
    pub(crate) fn append_text(&mut self, text: &[u8], source: &Source) {
        let valid = &mut self.valid;
        match &mut self.values {
            Values::U8(v) => parse(v, text, valid),
            Values::I8(v) => parse(v, text, valid),
            Values::U16(v) => parse(v, text, valid),
            Values::I16(v) => parse(v, text, valid),
            Values::U32(v) => parse(v, text, valid),
            Values::I32(v) => parse(v, text, valid),
            Values::U64(v) => parse(v, text, valid),
            Values::I64(v) => parse(v, text, valid),
            Values::F32(v) => parse(v, text, valid),
            Values::F64(v) => parse(v, text, valid),
            Values::Scaled(v, scale) => {
                let number = number_in(text, source);
                valid.append(number.is_some());
                v.push(number.map_or(0.0, |number| scale.apply(number)));
            }
            Values::Text(v) => v.append_value(decode_line(text)),
            Values::RawText(v) => v.append_value(text),
            Values::Time(_) | Values::SomeTimes(_) => self.append_missing(&[NO_TIME]),
        }
    }

    /// Bytes held, and those of names.
    pub fn bytes(&self) -> usize {
        self.held() + self.valid.len() * self.elements * self.name_len
    }

    fn held(&self) -> usize {
        match &self.values {
            Values::U8(v) => v.len(),
            Values::I8(v) => v.len(),
            Values::U16(v) => v.len() * 2,
            Values::I16(v) => v.len() * 2,
            Values::U32(v) => v.len() * 4,
            Values::I32(v) => v.len() * 4,
            Values::F32(v) => v.len() * 4,
            Values::U64(v) => v.len() * 8,
            Values::Time(v) | Values::SomeTimes(v) | Values::I64(v) => v.len() * 8,
            Values::F64(v) | Values::Scaled(v, _) => v.len() * 8,
            Values::Text(v) => v.values_slice().len() + 4 * v.offsets_slice().len(),
            Values::RawText(v) => v.values_slice().len() + 4 * v.offsets_slice().len(),
        }
    }

    /// What was appended, as arrow has it; the column is empty then.
    pub fn take(&mut self, column: &Column) -> ArrayRef {
        use std::mem::take;
        let valid = (self.valid.finish(), self.valid_elements.finish());
        match &mut self.values {
            Values::Time(v) => {
                v.shrink_to_fit();
                let times: TimestampMicrosecondArray = take(v).into();
                Arc::new(times.with_timezone("UTC"))
            }
            Values::SomeTimes(v) => {
                let times = take(v).into_iter().map(|time| (time != NO_TIME).then_some(time));
                let times: TimestampMicrosecondArray = times.collect();
                Arc::new(times.with_timezone("UTC"))
            }
            Values::U8(v) => finish::<UInt8Type>(take(v), valid, column),
            Values::I8(v) => finish::<Int8Type>(take(v), valid, column),
            Values::U16(v) => finish::<UInt16Type>(take(v), valid, column),
            Values::I16(v) => finish::<Int16Type>(take(v), valid, column),
            Values::U32(v) => finish::<UInt32Type>(take(v), valid, column),
            Values::I32(v) => finish::<Int32Type>(take(v), valid, column),
            Values::U64(v) => finish::<UInt64Type>(take(v), valid, column),
            Values::I64(v) => finish::<Int64Type>(take(v), valid, column),
            Values::F32(v) => finish::<Float32Type>(take(v), valid, column),
            Values::F64(v) | Values::Scaled(v, _) => finish::<Float64Type>(take(v), valid, column),
            Values::Text(v) => Arc::new(v.finish()),
            Values::RawText(v) => Arc::new(v.finish()),
        }
    }
}

fn empty(field_type: FieldType) -> Values {
    match field_type {
        FieldType::Char | FieldType::U8 => Values::U8(Vec::new()),
        FieldType::I8 => Values::I8(Vec::new()),
        FieldType::U16 => Values::U16(Vec::new()),
        FieldType::I16 => Values::I16(Vec::new()),
        FieldType::U32 => Values::U32(Vec::new()),
        FieldType::I32 => Values::I32(Vec::new()),
        FieldType::U64 => Values::U64(Vec::new()),
        FieldType::I64 => Values::I64(Vec::new()),
        FieldType::F32 => Values::F32(Vec::new()),
        FieldType::F64 => Values::F64(Vec::new()),
    }
}

/// A number of any type, as an integer.
trait Number: Copy {
    fn integer(self) -> i128;
}

macro_rules! number {
    ($($native:ty),*) => {
        $(impl Number for $native {
            fn integer(self) -> i128 {
                self as i128
            }
        })*
    };
}

number!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);

fn finish<T: ArrowPrimitiveType>(
    mut values: Vec<T::Native>,
    (valid, valid_elements): (Option<NullBuffer>, Option<NullBuffer>),
    column: &Column,
) -> ArrayRef
where
    T::Native: Number,
{
    values.shrink_to_fit();
    let (Source::Numbers(field) | Source::Half(field)) = &column.source else {
        return Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), valid));
    };
    let (valid, of_lists) =
        if field.is_numeric_array() { (valid_elements, valid) } else { (valid, None) };
    let array: ArrayRef = if let Some(names) = &column.names {
        names.dictionary(values.iter().map(|number| number.integer()), valid)
    } else {
        Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), valid))
    };
    in_lists(field, array, of_lists, column.invalid.is_some())
}

/// The elements of an array field by record.
fn in_lists(field: &Field, array: ArrayRef, valid: Option<NullBuffer>, nullable: bool) -> ArrayRef {
    if !field.is_numeric_array() {
        return array;
    }
    let item = Arc::new(ArrowField::new("item", DataType::clone(array.data_type()), nullable));
    Arc::new(FixedSizeListArray::new(item, field.array_length.into(), array, valid))
}
