//! A column that grows: one gather appends the values of many records, and the end makes an arrow array of it.

use std::borrow::Cow;
use std::str::FromStr;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, BinaryBuilder, FixedSizeListArray, Float64Array, NullBufferBuilder,
    PrimitiveArray, StringBuilder, TimestampMicrosecondArray,
};
use arrow::buffer::{NullBuffer, ScalarBuffer};
use arrow::datatypes::{
    ArrowPrimitiveType, DataType, Field as ArrowField, Float32Type, Float64Type, Int8Type,
    Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use mavwire_core::codec::{read, text_bytes};
use mavwire_core::log::dataflash::{half, text::decode_line};
use mavwire_schema::{Field, FieldType};

use crate::layout::{Column, Source};

/// Records side by side: the ids of the sender, then the payload at its full length.
#[derive(Debug)]
pub struct Rows<'a> {
    /// Microseconds since 1970.
    pub times: &'a [i64],
    /// `stride` bytes for each record.
    pub bytes: &'a [u8],
    /// Bytes of a record.
    pub stride: usize,
}

/// Where the payload begins in a row: behind `sysid`, `compid` and `seq`.
pub const PAYLOAD: usize = 3;

/// The values of a column so far.
#[derive(Debug)]
enum Values {
    Time(Vec<i64>),
    /// No times at all.
    NoTime(usize),
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
    Text(StringBuilder),
    RawText(BinaryBuilder),
}

/// A growing column.
#[derive(Debug)]
pub struct Growing {
    values: Values,
    /// Which rows have a value; of numbers only, the others know themselves.
    valid: NullBufferBuilder,
    /// Numbers of a row.
    elements: usize,
}

impl Growing {
    /// An empty column.
    pub fn new(column: &Column, stamped: bool) -> Self {
        let (_, elements) = place_of(&column.source);
        let values = match &column.source {
            Source::Timestamp if stamped => Values::Time(Vec::new()),
            Source::Timestamp => Values::NoTime(0),
            Source::Sysid | Source::Compid | Source::Seq => Values::U8(Vec::new()),
            Source::Text(_) | Source::LogText(_) => Values::Text(StringBuilder::new()),
            Source::RawText(_) | Source::Bytes(_) => Values::RawText(BinaryBuilder::new()),
            Source::Numbers(field) | Source::Half(field) => empty(field.field_type),
        };
        Self { values, valid: NullBufferBuilder::new(0), elements }
    }

    /// Appends a value for each row.
    pub fn append(&mut self, rows: &Rows<'_>, source: &Source) {
        let place = place_of(source);
        self.valid.append_n_non_nulls(rows.times.len());
        match &mut self.values {
            Values::Time(values) => values.extend_from_slice(rows.times),
            Values::NoTime(count) => *count += rows.times.len(),
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
        if let Values::Time(values) = &mut self.values {
            values.extend_from_slice(times);
            return self.valid.append_n_non_nulls(rows);
        }
        self.valid.append_n_nulls(rows);
        match &mut self.values {
            Values::Time(_) => {}
            Values::NoTime(count) => *count += rows,
            Values::U8(v) => v.resize(v.len() + zeros, 0),
            Values::I8(v) => v.resize(v.len() + zeros, 0),
            Values::U16(v) => v.resize(v.len() + zeros, 0),
            Values::I16(v) => v.resize(v.len() + zeros, 0),
            Values::U32(v) => v.resize(v.len() + zeros, 0),
            Values::I32(v) => v.resize(v.len() + zeros, 0),
            Values::U64(v) => v.resize(v.len() + zeros, 0),
            Values::I64(v) => v.resize(v.len() + zeros, 0),
            Values::F32(v) => v.resize(v.len() + zeros, 0.0),
            Values::F64(v) => v.resize(v.len() + zeros, 0.0),
            Values::Text(v) => v.append_nulls(rows),
            Values::RawText(v) => v.append_nulls(rows),
        }
    }

    /// Appends a value as a text log has it; null where it is none.
    pub(crate) fn append_text(&mut self, text: &[u8]) {
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
            Values::Text(v) => v.append_value(decode_line(text)),
            Values::RawText(v) => v.append_value(text),
            Values::Time(_) | Values::NoTime(_) => self.append_missing(&[0]),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        match &self.values {
            Values::NoTime(count) => *count,
            Values::U8(v) => v.len(),
            Values::I8(v) => v.len(),
            Values::U16(v) => v.len() * 2,
            Values::I16(v) => v.len() * 2,
            Values::U32(v) => v.len() * 4,
            Values::I32(v) => v.len() * 4,
            Values::F32(v) => v.len() * 4,
            Values::U64(v) => v.len() * 8,
            Values::Time(v) | Values::I64(v) => v.len() * 8,
            Values::F64(v) => v.len() * 8,
            Values::Text(v) => v.values_slice().len() + 4 * v.offsets_slice().len(),
            Values::RawText(v) => v.values_slice().len() + 4 * v.offsets_slice().len(),
        }
    }

    /// What was appended, as arrow has it; the column is empty then.
    pub fn take(&mut self, column: &Column) -> ArrayRef {
        use std::mem::take;
        let valid = self.valid.finish();
        match &mut self.values {
            Values::Time(v) => {
                let times: TimestampMicrosecondArray = take(v).into();
                Arc::new(times.with_timezone("UTC"))
            }
            Values::NoTime(count) => {
                let times = TimestampMicrosecondArray::new_null(take(count));
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
            Values::F64(v) => finish::<Float64Type>(take(v), valid, column),
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

/// Bytes into a row, and elements there.
fn place_of(source: &Source) -> (usize, usize) {
    match source {
        Source::Compid => (1, 1),
        Source::Seq => (2, 1),
        Source::Numbers(field) | Source::Half(field) => {
            (PAYLOAD + usize::from(field.offset), field.elements())
        }
        _ => (0, 1),
    }
}

fn parse<T: FromStr + Default>(values: &mut Vec<T>, text: &[u8], valid: &mut NullBufferBuilder) {
    let value = std::str::from_utf8(text).ok().and_then(|text| text.trim().parse().ok());
    valid.append(value.is_some());
    values.push(value.unwrap_or_default());
}

#[inline]
fn gather<T, const N: usize>(
    values: &mut Vec<T>,
    rows: &Rows<'_>,
    (offset, elements): (usize, usize),
    decode: impl Fn([u8; N]) -> T,
) {
    let each = rows.bytes.chunks_exact(rows.stride);
    if elements == 1 {
        values.extend(each.map(|row| decode(read(row, offset))));
    } else {
        for row in each {
            values.extend((0..elements).map(|n| decode(read(row, offset + n * N))));
        }
    }
}

/// The bytes of a text field in each row, without trailing NULs.
fn each_text(rows: &Rows<'_>, source: &Source, mut take: impl FnMut(&[u8])) {
    let rows = rows.bytes.chunks_exact(rows.stride).map(|row| &row[PAYLOAD..]);
    match source {
        Source::Text(field) | Source::RawText(field) | Source::LogText(field) => {
            rows.for_each(|payload| take(text_bytes(field, payload)));
        }
        Source::Bytes(field) => {
            let start = usize::from(field.offset);
            rows.for_each(|payload| take(&payload[start..start + field.elements()]));
        }
        _ => {}
    }
}

/// The same of a dataflash log: Latin-1 where it is not UTF-8.
fn logged(raw: &[u8]) -> Cow<'_, str> {
    let raw = &raw[..memchr::memchr(0, raw).unwrap_or(raw.len())];
    std::str::from_utf8(raw).map_or_else(|_| decode_line(raw).into(), Cow::Borrowed)
}

/// The text up to the first NUL.
fn shown(raw: &[u8]) -> Cow<'_, str> {
    let end = raw.iter().position(|&byte| byte == 0).unwrap_or(raw.len());
    String::from_utf8_lossy(&raw[..end])
}

/// A number of any type.
trait Number: Copy {
    fn integer(self) -> i128;
    fn float(self) -> f64;
}

macro_rules! number {
    ($($native:ty),*) => {
        $(impl Number for $native {
            fn integer(self) -> i128 {
                self as i128
            }

            #[inline]
            fn float(self) -> f64 {
                self as f64
            }
        })*
    };
}

number!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);

fn finish<T: ArrowPrimitiveType>(
    values: Vec<T::Native>,
    valid: Option<NullBuffer>,
    column: &Column,
) -> ArrayRef
where
    T::Native: Number,
{
    let (Source::Numbers(field) | Source::Half(field)) = &column.source else {
        return Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), valid));
    };
    let (valid, of_lists) = if field.is_numeric_array() { (None, valid) } else { (valid, None) };
    let array: ArrayRef = if let Some(names) = &column.names {
        names.dictionary(values.iter().map(|number| number.integer()))
    } else if let Some(scale) = column.scale {
        let scaled: Vec<f64> = values.iter().map(|number| scale.apply(number.float())).collect();
        Arc::new(Float64Array::new(scaled.into(), valid))
    } else {
        Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), valid))
    };
    in_lists(field, array, of_lists)
}

/// The elements of an array field by record.
fn in_lists(field: &Field, array: ArrayRef, valid: Option<NullBuffer>) -> ArrayRef {
    if !field.is_numeric_array() {
        return array;
    }
    let item = Arc::new(ArrowField::new("item", DataType::clone(array.data_type()), false));
    Arc::new(FixedSizeListArray::new(item, field.array_length.into(), array, valid))
}
