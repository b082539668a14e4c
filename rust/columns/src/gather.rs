//! The values of a field in many records that lie side by side.

use std::borrow::Cow;
use std::ops::Range;

use arrow::array::NullBufferBuilder;
use mavwire_core::codec::{read, text_bytes};
use mavwire_core::log::dataflash::{half, text::decode_line};
use mavwire_schema::{FieldType, InvalidRule};

use crate::layout::Source;
use crate::units::Scale;

/// Records side by side: the ids of the sender, then the payload at its full length.
#[derive(Debug)]
pub struct Rows<'a> {
    /// Microseconds since 1970, or [`NO_TIME`] for rows without a time.
    pub times: &'a [i64],
    /// `stride` bytes for each record.
    pub bytes: &'a [u8],
    /// Bytes of a record.
    pub stride: usize,
    /// Whole texts of the records where they are longer than the field; otherwise empty.
    pub texts: &'a [Vec<u8>],
}

impl<'a> Rows<'a> {
    /// Some of the rows, none of which has a whole text of its own.
    pub(crate) fn part(&self, range: Range<usize>) -> Rows<'a> {
        let bytes = &self.bytes[range.start * self.stride..range.end * self.stride];
        Rows { times: &self.times[range], bytes, stride: self.stride, texts: &[] }
    }
}

/// The time of a row without a time.
pub(crate) const NO_TIME: i64 = i64::MIN;

/// Where the payload begins in a row: behind `sysid`, `compid` and `seq`.
pub const PAYLOAD: usize = 3;

/// Bytes into a row, and elements there.
pub(crate) fn place_of(source: &Source) -> (usize, usize) {
    match source {
        Source::Compid => (1, 1),
        Source::Seq => (2, 1),
        Source::Numbers(field) | Source::Half(field) => {
            (PAYLOAD + usize::from(field.offset), field.elements())
        }
        Source::Record(len) => (0, usize::from(*len)),
        _ => (0, 1),
    }
}

/// The bits of a number as a text log has it, if it is one of the field's type.
pub(crate) fn number_in(text: &[u8], source: &Source, scale: Option<Scale>) -> Option<u64> {
    let (Source::Numbers(field) | Source::Half(field)) = source else { return None };
    let text = std::str::from_utf8(text).ok()?.trim();
    macro_rules! parsed {
        ($type:ty) => {{
            let number: $type = text.parse().ok()?;
            match scale {
                Some(scale) => scale.apply(number as f64).to_bits(),
                None => u64::from_le_bytes(read(&number.to_le_bytes(), 0)),
            }
        }};
    }
    Some(match field.field_type {
        FieldType::Char | FieldType::U8 => parsed!(u8),
        FieldType::I8 => parsed!(i8),
        FieldType::U16 => parsed!(u16),
        FieldType::I16 => parsed!(i16),
        FieldType::U32 => parsed!(u32),
        FieldType::I32 => parsed!(i32),
        FieldType::U64 => parsed!(u64),
        FieldType::I64 => parsed!(i64),
        FieldType::F32 => parsed!(f32),
        FieldType::F64 => parsed!(f64),
    })
}

#[inline]
pub(crate) fn gather<T, const N: usize>(
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

/// The rows that have a value of a field, and the elements of arrays that have one.
pub(crate) fn each_valid(
    rows: &Rows<'_>,
    (offset, elements): (usize, usize),
    invalid: &InvalidRule,
    valid: &mut NullBufferBuilder,
    valid_elements: &mut NullBufferBuilder,
) {
    for row in rows.bytes.chunks_exact(rows.stride) {
        let field = &row[offset..];
        if elements == 1 || !invalid.is_by_element() {
            valid.append(!invalid.is_invalid(field, 0));
            valid_elements.append_n_non_nulls(elements);
        } else {
            valid.append_non_null();
            (0..elements).for_each(|n| valid_elements.append(!invalid.is_invalid(field, n)));
        }
    }
}

/// The numbers of a field, scaled.
pub(crate) fn gather_scaled(values: &mut Vec<u64>, rows: &Rows<'_>, source: &Source, scale: Scale) {
    let (Source::Numbers(field) | Source::Half(field)) = source else { return };
    let place = place_of(source);
    macro_rules! each {
        ($type:ty) => {
            gather(values, rows, place, |bytes| {
                scale.apply(<$type>::from_le_bytes(bytes) as f64).to_bits()
            })
        };
    }
    match field.field_type {
        FieldType::F32 if matches!(source, Source::Half(_)) => {
            let float = |bytes| half(u16::from_le_bytes(bytes)) as f32 as f64;
            gather(values, rows, place, |bytes| scale.apply(float(bytes)).to_bits());
        }
        FieldType::Char | FieldType::U8 => each!(u8),
        FieldType::I8 => each!(i8),
        FieldType::U16 => each!(u16),
        FieldType::I16 => each!(i16),
        FieldType::U32 => each!(u32),
        FieldType::I32 => each!(i32),
        FieldType::U64 => each!(u64),
        FieldType::I64 => each!(i64),
        FieldType::F32 => each!(f32),
        FieldType::F64 => each!(f64),
    }
}

/// The bytes of a text field in each row, without trailing NULs.
pub(crate) fn each_text(rows: &Rows<'_>, source: &Source, mut take: impl FnMut(&[u8])) {
    if !rows.texts.is_empty() {
        return rows.texts.iter().for_each(|text| take(text));
    }
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
pub(crate) fn logged(raw: &[u8]) -> Cow<'_, str> {
    let raw = &raw[..memchr::memchr(0, raw).unwrap_or(raw.len())];
    std::str::from_utf8(raw).map_or_else(|_| decode_line(raw).into(), Cow::Borrowed)
}

/// The text up to the first NUL.
pub(crate) fn shown(raw: &[u8]) -> Cow<'_, str> {
    let end = raw.iter().position(|&byte| byte == 0).unwrap_or(raw.len());
    String::from_utf8_lossy(&raw[..end])
}
