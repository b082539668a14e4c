//! A column that grows: one gather appends the values of many records, and the end makes an arrow array of it.

use std::borrow::Cow;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, BinaryBuilder, FixedSizeListArray, Float64Array, PrimitiveArray,
    StringBuilder, TimestampMicrosecondArray,
};
use arrow::buffer::ScalarBuffer;
use arrow::datatypes::{
    ArrowPrimitiveType, DataType, Field as ArrowField, Float32Type, Float64Type, Int8Type,
    Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use mavwire_core::codec::{read, text_bytes};
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
    /// Bytes into a row, and elements there.
    place: (usize, usize),
}

impl Growing {
    /// An empty column.
    pub fn new(column: &Column, stamped: bool) -> Self {
        let (values, place) = match &column.source {
            Source::Timestamp if stamped => (Values::Time(Vec::new()), (0, 1)),
            Source::Timestamp => (Values::NoTime(0), (0, 1)),
            Source::Sysid => (Values::U8(Vec::new()), (0, 1)),
            Source::Compid => (Values::U8(Vec::new()), (1, 1)),
            Source::Seq => (Values::U8(Vec::new()), (2, 1)),
            Source::Text(_) => (Values::Text(StringBuilder::new()), (0, 1)),
            Source::RawText(_) => (Values::RawText(BinaryBuilder::new()), (0, 1)),
            Source::Numbers(field) => {
                (empty(field.field_type), (PAYLOAD + usize::from(field.offset), field.elements()))
            }
        };
        Self { values, place }
    }

    /// Appends a value for each row.
    pub fn append(&mut self, rows: &Rows<'_>, source: &Source) {
        let place = self.place;
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
            Values::F32(values) => gather(values, rows, place, f32::from_le_bytes),
            Values::F64(values) => gather(values, rows, place, f64::from_le_bytes),
            Values::Text(values) => {
                each_text(rows, source, |raw| values.append_value(&*shown(raw)));
            }
            Values::RawText(values) => {
                each_text(rows, source, |raw| {
                    values.append_option((shown(raw).as_bytes() != raw).then_some(raw));
                });
            }
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
        match &mut self.values {
            Values::Time(v) => {
                let times: TimestampMicrosecondArray = take(v).into();
                Arc::new(times.with_timezone("UTC"))
            }
            Values::NoTime(count) => {
                let times = TimestampMicrosecondArray::new_null(take(count));
                Arc::new(times.with_timezone("UTC"))
            }
            Values::U8(v) => finish::<UInt8Type>(take(v), column),
            Values::I8(v) => finish::<Int8Type>(take(v), column),
            Values::U16(v) => finish::<UInt16Type>(take(v), column),
            Values::I16(v) => finish::<Int16Type>(take(v), column),
            Values::U32(v) => finish::<UInt32Type>(take(v), column),
            Values::I32(v) => finish::<Int32Type>(take(v), column),
            Values::U64(v) => finish::<UInt64Type>(take(v), column),
            Values::I64(v) => finish::<Int64Type>(take(v), column),
            Values::F32(v) => finish::<Float32Type>(take(v), column),
            Values::F64(v) => finish::<Float64Type>(take(v), column),
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
    let (Source::Text(field) | Source::RawText(field)) = source else { return };
    for row in rows.bytes.chunks_exact(rows.stride) {
        take(text_bytes(field, &row[PAYLOAD..]));
    }
}

/// The text up to the first NUL.
fn shown(raw: &[u8]) -> Cow<'_, str> {
    let end = raw.iter().position(|&byte| byte == 0).unwrap_or(raw.len());
    String::from_utf8_lossy(&raw[..end])
}

/// A number of any type.
#[derive(Debug, Clone, Copy)]
enum Number {
    Integer(i128),
    Float(f64),
}

impl Number {
    fn integer(self) -> i128 {
        match self {
            Self::Integer(value) => value,
            Self::Float(value) => value as i128,
        }
    }

    fn float(self) -> f64 {
        match self {
            Self::Integer(value) => value as f64,
            Self::Float(value) => value,
        }
    }
}

macro_rules! number_from {
    ($variant:ident, $($native:ty),*) => {
        $(impl From<$native> for Number {
            fn from(value: $native) -> Self {
                Self::$variant(value.into())
            }
        })*
    };
}

number_from!(Integer, u8, i8, u16, i16, u32, i32, u64, i64);
number_from!(Float, f32, f64);

fn finish<T: ArrowPrimitiveType>(values: Vec<T::Native>, column: &Column) -> ArrayRef
where
    T::Native: Into<Number>,
{
    let Source::Numbers(field) = &column.source else {
        return Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), None));
    };
    let numbers = || values.iter().map(|&value| value.into());
    let array: ArrayRef = if let Some(names) = &column.names {
        names.dictionary(numbers().map(|number: Number| number.integer()))
    } else if let Some(scale) = column.scale {
        Arc::new(Float64Array::from_iter_values(numbers().map(|n| scale.apply(n.float()))))
    } else {
        Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::from(values), None))
    };
    in_lists(field, array)
}

/// The elements of an array field by record.
fn in_lists(field: &Field, array: ArrayRef) -> ArrayRef {
    if !field.is_numeric_array() {
        return array;
    }
    let item = Arc::new(ArrowField::new("item", DataType::clone(array.data_type()), false));
    Arc::new(FixedSizeListArray::new(item, field.array_length.into(), array, None))
}
