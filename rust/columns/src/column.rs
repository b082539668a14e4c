//! A column that grows: one gather appends the values of many records, and the end makes an arrow array of it.

use std::mem::take;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayData, ArrayRef, BinaryBuilder, FixedSizeBinaryArray, FixedSizeListArray,
    NullBufferBuilder, StringBuilder, TimestampMicrosecondArray, make_array,
};
use arrow::buffer::{Buffer, NullBuffer};
use arrow::datatypes::{DataType, Field as ArrowField};
use arrow::error::ArrowError;
use mavwire_core::codec::{Number, number};
use mavwire_core::log::dataflash::{half, text::decode_line};
use mavwire_schema::{Field, FieldType, InvalidRule};

use crate::gather::{
    NO_TIME, Rows, each_text, each_valid, gather, gather_scaled, logged, number_in, place_of, shown,
};
use crate::layout::{Column, Source, element_type};
use crate::units::Scale;

/// The values of a column so far. Numbers of all types are bits here, by their width.
#[derive(Debug)]
enum Values {
    /// Times, or [`NO_TIME`].
    Times(Vec<i64>),
    Bits8(Vec<u8>),
    Bits16(Vec<u16>),
    Bits32(Vec<u32>),
    Bits64(Vec<u64>),
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
    /// The factor of scaled numbers, which become floats of 64 bits.
    scale: Option<Scale>,
    /// Numbers of a row.
    elements: usize,
    /// About how many bytes the name of a number may come to.
    name_len: usize,
}

impl Growing {
    /// An empty column.
    pub fn new(column: &Column) -> Self {
        let (_, elements) = place_of(&column.source);
        let values = match &column.source {
            Source::Timestamp => Values::Times(Vec::new()),
            Source::Text(_) | Source::LogText(_) => Values::Text(StringBuilder::new()),
            Source::RawText(_) | Source::Bytes(_) => Values::RawText(BinaryBuilder::new()),
            source => match number_type(source, column.scale).size() {
                1 => Values::Bits8(Vec::new()),
                2 => Values::Bits16(Vec::new()),
                4 => Values::Bits32(Vec::new()),
                _ => Values::Bits64(Vec::new()),
            },
        };
        let name_len = column.names.as_ref().map_or(0, |names| names.mask_len);
        Self {
            values,
            valid: NullBufferBuilder::new(0),
            valid_elements: NullBufferBuilder::new(0),
            invalid: column.invalid.clone(),
            scale: column.scale,
            elements,
            name_len,
        }
    }

    /// Bytes of a row; of texts those that each has.
    pub(crate) fn width(&self) -> usize {
        match &self.values {
            Values::Bits8(_) => self.elements,
            Values::Bits16(_) => 2 * self.elements,
            Values::Bits32(_) => 4 * self.elements,
            Values::Text(_) | Values::RawText(_) => 4,
            Values::Times(_) | Values::Bits64(_) => 8 * self.elements,
        }
    }

    /// Makes room for so many more rows, if there is memory for that.
    pub(crate) fn reserve(&mut self, rows: usize) {
        let count = rows.saturating_mul(self.elements);
        // If this fails, appending the rows fails too, if they come.
        let _ = match &mut self.values {
            Values::Times(v) => v.try_reserve_exact(count),
            Values::Bits8(v) => v.try_reserve_exact(count),
            Values::Bits16(v) => v.try_reserve_exact(count),
            Values::Bits32(v) => v.try_reserve_exact(count),
            Values::Bits64(v) => v.try_reserve_exact(count),
            Values::Text(_) | Values::RawText(_) => Ok(()),
        };
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
        match (&mut self.values, source) {
            (Values::Times(values), _) => values.extend_from_slice(rows.times),
            (Values::Bits8(values), Source::Record(_)) => values.extend_from_slice(rows.bytes),
            (Values::Bits8(values), _) => gather(values, rows, place, u8::from_le_bytes),
            (Values::Bits16(values), _) => gather(values, rows, place, u16::from_le_bytes),
            (Values::Bits32(values), Source::Half(_)) => {
                let float = |bytes| half(u16::from_le_bytes(bytes)) as f32;
                gather(values, rows, place, |bytes| float(bytes).to_bits());
            }
            (Values::Bits32(values), _) => gather(values, rows, place, u32::from_le_bytes),
            (Values::Bits64(values), _) => match self.scale {
                Some(scale) => gather_scaled(values, rows, source, scale),
                None => gather(values, rows, place, u64::from_le_bytes),
            },
            (Values::Text(values), Source::LogText(_)) => {
                each_text(rows, source, |raw| values.append_value(&*logged(raw)));
            }
            (Values::Text(values), _) => {
                each_text(rows, source, |raw| values.append_value(&*shown(raw)));
            }
            (Values::RawText(values), Source::Bytes(_)) => {
                each_text(rows, source, |raw| values.append_value(raw));
            }
            (Values::RawText(values), _) => {
                each_text(rows, source, |raw| {
                    values.append_option((shown(raw).as_bytes() != raw).then_some(raw));
                });
            }
        }
    }

    /// Appends the times of rows, or rows without a value.
    pub(crate) fn append_missing(&mut self, times: &[i64]) {
        let (rows, zeros) = (times.len(), times.len() * self.elements);
        self.valid.append_n_nulls(rows);
        if self.invalid.is_some() {
            self.valid_elements.append_n_nulls(zeros);
        }
        match &mut self.values {
            Values::Times(v) => v.extend_from_slice(times),
            Values::Bits8(v) => v.resize(v.len() + zeros, 0),
            Values::Bits16(v) => v.resize(v.len() + zeros, 0),
            Values::Bits32(v) => v.resize(v.len() + zeros, 0),
            Values::Bits64(v) => v.resize(v.len() + zeros, 0),
            Values::Text(v) => v.append_nulls(rows),
            Values::RawText(v) => v.append_nulls(rows),
        }
    }

    /// Appends a value as a text log has it; null where it is none.
    pub(crate) fn append_text(&mut self, text: &[u8], source: &Source) {
        let mut bits = || {
            let number = number_in(text, source, self.scale);
            self.valid.append(number.is_some());
            number.unwrap_or_default()
        };
        match &mut self.values {
            Values::Times(v) => v.push(NO_TIME),
            Values::Bits8(v) => v.push(bits() as u8),
            Values::Bits16(v) => v.push(bits() as u16),
            Values::Bits32(v) => v.push(bits() as u32),
            Values::Bits64(v) => v.push(bits()),
            Values::Text(v) => v.append_value(decode_line(text)),
            Values::RawText(v) => v.append_value(text),
        }
    }

    /// Bytes held, and those of names.
    pub fn bytes(&self) -> usize {
        let names = self.valid.len() * self.elements * self.name_len;
        names
            + match &self.values {
                Values::Times(v) => size_of_val(&v[..]),
                Values::Bits8(v) => size_of_val(&v[..]),
                Values::Bits16(v) => size_of_val(&v[..]),
                Values::Bits32(v) => size_of_val(&v[..]),
                Values::Bits64(v) => size_of_val(&v[..]),
                Values::Text(v) => v.values_slice().len() + size_of_val(v.offsets_slice()),
                Values::RawText(v) => v.values_slice().len() + size_of_val(v.offsets_slice()),
            }
    }

    /// The appended values as arrow has them; the column is empty then.
    ///
    /// # Errors
    /// Errors of arrow, which only a mistake of this crate causes.
    pub fn take(&mut self, column: &Column) -> Result<ArrayRef, ArrowError> {
        let valid = (self.valid.finish(), self.valid_elements.finish());
        let bits = match &mut self.values {
            Values::Times(v) => return Ok(times(take(v))),
            Values::Text(v) => return Ok(Arc::new(v.finish())),
            Values::RawText(v) => return Ok(Arc::new(v.finish())),
            // Not made smaller: the allocator would map fresh memory for each batch.
            Values::Bits8(v) if matches!(column.source, Source::Record(_)) => take(v).into(),
            Values::Bits8(v) => buffer(take(v)),
            Values::Bits16(v) => buffer(take(v)),
            Values::Bits32(v) => buffer(take(v)),
            Values::Bits64(v) => buffer(take(v)),
        };
        numbers(bits, valid, column)
    }
}

/// The type of the numbers in a column.
fn number_type(source: &Source, scale: Option<Scale>) -> FieldType {
    match source {
        _ if scale.is_some() => FieldType::F64,
        Source::Numbers(field) | Source::Half(field) => field.field_type,
        _ => FieldType::U8,
    }
}

fn buffer<T: arrow::datatypes::ArrowNativeType>(mut values: Vec<T>) -> Buffer {
    values.shrink_to_fit();
    values.into()
}

fn times(mut times: Vec<i64>) -> ArrayRef {
    times.shrink_to_fit();
    let times: TimestampMicrosecondArray = if times.contains(&NO_TIME) {
        times.into_iter().map(|time| (time != NO_TIME).then_some(time)).collect()
    } else {
        times.into()
    };
    Arc::new(times.with_timezone("UTC"))
}

fn numbers(
    bits: Buffer,
    (valid, valid_elements): (Option<NullBuffer>, Option<NullBuffer>),
    column: &Column,
) -> Result<ArrayRef, ArrowError> {
    if let Source::Record(len) = column.source {
        return Ok(Arc::new(FixedSizeBinaryArray::try_new(len.into(), bits, None)?));
    }
    let lists = match &column.source {
        Source::Numbers(field) | Source::Half(field) if field.is_numeric_array() => Some(field),
        _ => None,
    };
    let (valid, of_lists) = if lists.is_some() { (valid_elements, valid) } else { (valid, None) };
    let number_type = number_type(&column.source, column.scale);
    let len = bits.len() / number_type.size();
    let array = if let Some(names) = &column.names {
        let integer = |n| match number(number_type, &bits, n * number_type.size()) {
            Number::Unsigned(number) => number.into(),
            Number::Signed(number) => number.into(),
            Number::Float(number) => number as i128,
        };
        names.dictionary((0..len).map(integer), valid)
    } else {
        let data = ArrayData::builder(element_type(number_type)).len(len).add_buffer(bits);
        make_array(data.nulls(valid).build()?)
    };
    Ok(match lists {
        Some(field) => in_lists(field, array, of_lists, column.invalid.is_some()),
        None => array,
    })
}

/// The elements of an array field by record.
fn in_lists(field: &Field, array: ArrayRef, valid: Option<NullBuffer>, nullable: bool) -> ArrayRef {
    let item = Arc::new(ArrowField::new("item", DataType::clone(array.data_type()), nullable));
    Arc::new(FixedSizeListArray::new(item, field.array_length.into(), array, valid))
}
