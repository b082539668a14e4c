//! Payload bytes to field values and back.
//!
//! A payload may be shorter than its message (MAVLink 2 drops trailing zeros, older peers lack extension fields) or
//! longer (newer peers have more): what is missing reads as zero, what is too much is ignored. Floats keep every bit,
//! NaN payloads included.

use mavwire_schema::{Field, FieldType, Message};

/// A field's value. Integers are widened; a `char` or `char[n]` field is its bytes without trailing NULs.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Unsigned integer.
    U64(u64),
    /// Signed integer.
    I64(i64),
    /// `float`.
    F32(f32),
    /// `double`.
    F64(f64),
    /// `char` or `char[n]`. NULs inside and bytes that are no text are kept.
    Text(Vec<u8>),
    /// Array of unsigned integers.
    U64Array(Vec<u64>),
    /// Array of signed integers.
    I64Array(Vec<i64>),
    /// Array of `float`.
    F32Array(Vec<f32>),
    /// Array of `double`.
    F64Array(Vec<f64>),
}

/// Why a value does not fit its field.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CodecError {
    /// Another kind of value is wanted.
    #[error("field {field} takes {expected}")]
    WrongKind {
        /// Field name.
        field: String,
        /// What it takes.
        expected: &'static str,
    },
    /// An integer beyond the field's type, or a finite number beyond `float`.
    #[error("field {field}: {value} does not fit {field_type}")]
    OutOfRange {
        /// Field name.
        field: String,
        /// The value.
        value: String,
        /// The type's name in XML.
        field_type: &'static str,
    },
    /// An array with too few elements.
    #[error("field {field} has {expected} elements, {got} given")]
    ArrayTooShort {
        /// Field name.
        field: String,
        /// Elements of the field.
        expected: usize,
        /// Elements given.
        got: usize,
    },
    /// Not one value per field.
    #[error("message {message} has {expected} fields, {got} values given")]
    ValueCount {
        /// Message name.
        message: String,
        /// Fields of the message.
        expected: usize,
        /// Values given.
        got: usize,
    },
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

/// An unsigned or signed integer element, widened; 0 for floats.
#[inline]
pub(crate) fn integer(field_type: FieldType, payload: &[u8], offset: usize) -> i128 {
    match field_type {
        FieldType::Char | FieldType::U8 => read::<1>(payload, offset)[0].into(),
        FieldType::I8 => i8::from_le_bytes(read(payload, offset)).into(),
        FieldType::U16 => u16::from_le_bytes(read(payload, offset)).into(),
        FieldType::I16 => i16::from_le_bytes(read(payload, offset)).into(),
        FieldType::U32 => u32::from_le_bytes(read(payload, offset)).into(),
        FieldType::I32 => i32::from_le_bytes(read(payload, offset)).into(),
        FieldType::U64 => u64::from_le_bytes(read(payload, offset)).into(),
        FieldType::I64 => i64::from_le_bytes(read(payload, offset)).into(),
        FieldType::F32 | FieldType::F64 => 0,
    }
}

/// The bytes of a text field without trailing NULs.
#[inline]
pub fn text_bytes<'a>(field: &Field, payload: &'a [u8]) -> &'a [u8] {
    let start = usize::from(field.offset).min(payload.len());
    let end = (start + field.elements()).min(payload.len());
    let text = &payload[start..end];
    let used = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &text[..used]
}

/// Reads a field.
pub fn decode(field: &Field, payload: &[u8]) -> Value {
    use FieldType::{Char, F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    let start = usize::from(field.offset);
    let size = field.field_type.size();
    let offsets = (0..field.elements()).map(|n| start + n * size);
    let integers = offsets.clone().map(|at| integer(field.field_type, payload, at));
    let f32_at = |at| f32::from_le_bytes(read(payload, at));
    let f64_at = |at| f64::from_le_bytes(read(payload, at));
    match (field.field_type, field.is_numeric_array()) {
        (Char, _) => Value::Text(text_bytes(field, payload).to_vec()),
        (U8 | U16 | U32 | U64, true) => Value::U64Array(integers.map(|v| v as u64).collect()),
        (I8 | I16 | I32 | I64, true) => Value::I64Array(integers.map(|v| v as i64).collect()),
        (U8 | U16 | U32 | U64, false) => {
            Value::U64(integer(field.field_type, payload, start) as u64)
        }
        (I8 | I16 | I32 | I64, false) => {
            Value::I64(integer(field.field_type, payload, start) as i64)
        }
        (F32, true) => Value::F32Array(offsets.map(f32_at).collect()),
        (F64, true) => Value::F64Array(offsets.map(f64_at).collect()),
        (F32, false) => Value::F32(f32_at(start)),
        (F64, false) => Value::F64(f64_at(start)),
    }
}

/// Reads all fields, in XML order.
pub fn decode_all(message: &Message, payload: &[u8]) -> Vec<Value> {
    message.fields.iter().map(|field| decode(field, payload)).collect()
}

/// Writes all fields (`values` in XML order) into `space`; returns the payload at full length.
///
/// # Errors
/// The first value that does not fit its field, or not one value per field.
pub fn encode_all<'a>(
    message: &Message,
    values: &[Value],
    space: &'a mut [u8; 255],
) -> Result<&'a [u8], CodecError> {
    if values.len() != message.fields.len() {
        return Err(CodecError::ValueCount {
            message: message.name.clone(),
            expected: message.fields.len(),
            got: values.len(),
        });
    }
    space.fill(0);
    for (field, value) in message.fields.iter().zip(values) {
        encode(field, value, space)?;
    }
    Ok(&space[..usize::from(message.max_len)])
}

/// Writes a field into a payload of full length. Text and arrays that are too long are cut, short text is filled with
/// NULs.
///
/// # Errors
/// A value of the wrong kind, beyond the field's range, or an array with too few elements.
pub fn encode(field: &Field, value: &Value, payload: &mut [u8; 255]) -> Result<(), CodecError> {
    let wrong_kind = || CodecError::WrongKind { field: field.name.clone(), expected: kind(field) };
    let mut slot = Slot { field, bytes: &mut payload[usize::from(field.offset)..] };
    match (value, field.is_numeric_array()) {
        (Value::Text(text), false) if field.is_char() => {
            let slot = &mut slot.bytes[..field.elements()];
            let used = text.len().min(slot.len());
            slot[..used].copy_from_slice(&text[..used]);
            slot[used..].fill(0);
            Ok(())
        }
        (_, false) if field.is_char() => Err(wrong_kind()),
        (Value::U64(v), false) => slot.put_integer(0, (*v).into()),
        (Value::I64(v), false) => slot.put_integer(0, (*v).into()),
        (Value::F32(v), false) => slot.put_f32(0, *v),
        (Value::F64(v), false) => slot.put_f64(0, *v),
        (Value::U64Array(v), true) => slot.put_array(v, |s, n, v| s.put_integer(n, (*v).into())),
        (Value::I64Array(v), true) => slot.put_array(v, |s, n, v| s.put_integer(n, (*v).into())),
        (Value::F32Array(v), true) => slot.put_array(v, |s, n, v| s.put_f32(n, *v)),
        (Value::F64Array(v), true) => slot.put_array(v, |s, n, v| s.put_f64(n, *v)),
        _ => Err(wrong_kind()),
    }
}

/// What a field takes, for errors.
fn kind(field: &Field) -> &'static str {
    match (field.field_type, field.is_numeric_array()) {
        (FieldType::Char, _) => "text",
        (FieldType::F32 | FieldType::F64, false) => "a number",
        (FieldType::F32 | FieldType::F64, true) => "an array of numbers",
        (_, false) => "an integer",
        (_, true) => "an array of integers",
    }
}

/// A field's place in a payload.
struct Slot<'a> {
    field: &'a Field,
    bytes: &'a mut [u8],
}

impl Slot<'_> {
    fn put_array<T>(
        &mut self,
        values: &[T],
        put: impl Fn(&mut Self, usize, &T) -> Result<(), CodecError>,
    ) -> Result<(), CodecError> {
        let expected = self.field.elements();
        if values.len() < expected {
            let field = self.field.name.clone();
            return Err(CodecError::ArrayTooShort { field, expected, got: values.len() });
        }
        (0..expected).try_for_each(|n| put(self, n, &values[n]))
    }

    fn put<const N: usize>(&mut self, element: usize, bytes: [u8; N]) {
        self.bytes[element * N..][..N].copy_from_slice(&bytes);
    }

    fn out_of_range(&self, value: &dyn ToString) -> CodecError {
        CodecError::OutOfRange {
            field: self.field.name.clone(),
            value: value.to_string(),
            field_type: self.field.field_type.name(),
        }
    }

    fn put_integer(&mut self, element: usize, value: i128) -> Result<(), CodecError> {
        let range = match self.field.field_type {
            FieldType::Char | FieldType::U8 => 0..=u8::MAX.into(),
            FieldType::I8 => i8::MIN.into()..=i8::MAX.into(),
            FieldType::U16 => 0..=u16::MAX.into(),
            FieldType::I16 => i16::MIN.into()..=i16::MAX.into(),
            FieldType::U32 => 0..=u32::MAX.into(),
            FieldType::I32 => i32::MIN.into()..=i32::MAX.into(),
            FieldType::U64 => 0..=u64::MAX.into(),
            FieldType::I64 => i64::MIN.into()..=i64::MAX.into(),
            FieldType::F32 => return self.put_f32(element, value as f32),
            FieldType::F64 => return self.put_f64(element, value as f64),
        };
        if !range.contains(&value) {
            return Err(self.out_of_range(&value));
        }
        match self.field.field_type.size() {
            1 => self.put(element, (value as u8).to_le_bytes()),
            2 => self.put(element, (value as u16).to_le_bytes()),
            4 => self.put(element, (value as u32).to_le_bytes()),
            _ => self.put(element, (value as u64).to_le_bytes()),
        }
        Ok(())
    }

    fn put_f32(&mut self, element: usize, value: f32) -> Result<(), CodecError> {
        match self.field.field_type {
            FieldType::F32 => self.put(element, value.to_le_bytes()),
            FieldType::F64 => self.put(element, f64::from(value).to_le_bytes()),
            _ => return Err(self.not_an_integer()),
        }
        Ok(())
    }

    fn put_f64(&mut self, element: usize, value: f64) -> Result<(), CodecError> {
        match self.field.field_type {
            FieldType::F32 if value.is_finite() && (value as f32).is_infinite() => {
                return Err(self.out_of_range(&value));
            }
            FieldType::F32 => self.put(element, (value as f32).to_le_bytes()),
            FieldType::F64 => self.put(element, value.to_le_bytes()),
            _ => return Err(self.not_an_integer()),
        }
        Ok(())
    }

    fn not_an_integer(&self) -> CodecError {
        CodecError::WrongKind { field: self.field.name.clone(), expected: kind(self.field) }
    }
}

#[cfg(test)]
mod tests;
