//! Payload bytes to field values.
//!
//! A payload may be shorter than its message (MAVLink 2 drops trailing zeros, older peers lack extension fields) or
//! longer (newer peers have more): what is missing reads as zero, what is too much is ignored.

use mavwire_schema::{Field, FieldType};

/// A number in a payload, widened. A `char` counts as one, too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// Of an unsigned integer type, or `char`.
    Unsigned(u64),
    /// Of a signed integer type.
    Signed(i64),
    /// `float` or `double`.
    Float(f64),
}

/// `N` bytes of a payload from `offset`; bytes beyond its end are zero.
#[inline]
pub fn read<const N: usize>(payload: &[u8], offset: usize) -> [u8; N] {
    let rest = payload.get(offset..).unwrap_or_default();
    if let Some(bytes) = rest.first_chunk::<N>() {
        return *bytes;
    }
    let mut bytes = [0; N];
    bytes[..rest.len()].copy_from_slice(rest);
    bytes
}

/// The payload at its full length: cut to `max_len` bytes, or extended to it with zeros in `space`.
#[inline]
pub fn payload_extended<'a>(payload: &'a [u8], max_len: u8, space: &'a mut [u8; 255]) -> &'a [u8] {
    let max_len = usize::from(max_len);
    if let Some(whole) = payload.get(..max_len) {
        return whole;
    }
    let (present, missing) = space[..max_len].split_at_mut(payload.len());
    present.copy_from_slice(payload);
    missing.fill(0);
    &space[..max_len]
}

/// Reads a number of this type at `offset`.
#[inline]
pub fn number(field_type: FieldType, payload: &[u8], offset: usize) -> Number {
    use Number::{Float, Signed, Unsigned};
    match field_type {
        FieldType::Char | FieldType::U8 => Unsigned(read::<1>(payload, offset)[0].into()),
        FieldType::I8 => Signed(i8::from_le_bytes(read(payload, offset)).into()),
        FieldType::U16 => Unsigned(u16::from_le_bytes(read(payload, offset)).into()),
        FieldType::I16 => Signed(i16::from_le_bytes(read(payload, offset)).into()),
        FieldType::U32 => Unsigned(u32::from_le_bytes(read(payload, offset)).into()),
        FieldType::I32 => Signed(i32::from_le_bytes(read(payload, offset)).into()),
        FieldType::U64 => Unsigned(u64::from_le_bytes(read(payload, offset))),
        FieldType::I64 => Signed(i64::from_le_bytes(read(payload, offset))),
        FieldType::F32 => Float(f32::from_le_bytes(read(payload, offset)).into()),
        FieldType::F64 => Float(f64::from_le_bytes(read(payload, offset))),
    }
}

/// The bytes of a field that a payload has.
#[inline]
pub fn field_bytes<'a>(field: &Field, payload: &'a [u8]) -> &'a [u8] {
    let start = usize::from(field.offset).min(payload.len());
    let end = (start + field.wire_len()).min(payload.len());
    &payload[start..end]
}

/// The bytes of a text field without trailing NULs. NULs inside and bytes that are no text are kept.
#[inline]
pub fn text_bytes<'a>(field: &Field, payload: &'a [u8]) -> &'a [u8] {
    let text = field_bytes(field, payload);
    let used = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &text[..used]
}

#[cfg(test)]
mod tests;
