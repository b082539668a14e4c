//! Python values to payload bytes.
//!
//! The fast path takes what callers nearly always pass: ints, floats, texts as bytes, and lists. Everything else, errors
//! included, is left to Python's own `struct`: it decides what fits, and its exceptions are the ones callers of pymavlink
//! know.

use mavwire_schema::{FieldType, Message as Definition, WireVersion};
use pyo3::Borrowed;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList, PyTuple};

use crate::message::info::{Info, Place};
use crate::message::object::Message;
use crate::python::calling::Calling;
use crate::python::number;

/// Bytes of a payload in a version, before zeros at the end are cut off: extension fields are never sent in version 1.
#[inline]
pub(crate) fn payload_len(definition: &Definition, version: WireVersion) -> usize {
    usize::from(match version {
        WireVersion::V1 => definition.min_len,
        WireVersion::V2 => definition.max_len,
    })
}

/// Encodes the value of a field into a payload; `None` if `struct` has to judge it.
#[inline(always)] // measured: a call for each field is a tenth of sending a message
pub(crate) fn put(payload: &mut [u8], place: Place, value: Borrowed<'_, '_, PyAny>) -> Option<()> {
    let out = payload.get_mut(usize::from(place.offset)..)?;
    if place.array_length == 0 && place.field_type != FieldType::Char {
        return put_scalar(place.field_type, value, out);
    }
    put_many(place, value, out.get_mut(..place.wire_len())?)
}

#[inline(never)]
fn put_many(place: Place, value: Borrowed<'_, '_, PyAny>, out: &mut [u8]) -> Option<()> {
    if place.field_type == FieldType::Char {
        return put_text(place, value, out);
    }
    let count = usize::from(place.array_length);
    let elements = out.chunks_exact_mut(place.field_type.size());
    let list = value.cast_exact::<PyList>().ok().filter(|list| list.len() >= count)?;
    for (i, out) in elements.enumerate() {
        put_scalar(place.field_type, list.get_item(i).ok()?.as_borrowed(), out)?;
    }
    Some(())
}

fn put_text(place: Place, value: Borrowed<'_, '_, PyAny>, out: &mut [u8]) -> Option<()> {
    let text = value.cast_exact::<PyBytes>().ok()?;
    let bytes = text.as_bytes();
    if place.array_length == 0 && bytes.len() != 1 {
        return None;
    }
    let len = bytes.len().min(out.len());
    out[..len].copy_from_slice(&bytes[..len]);
    Some(())
}

/// Writes to the front of `out`.
#[inline(always)] // as above
fn put_scalar(field_type: FieldType, value: Borrowed<'_, '_, PyAny>, out: &mut [u8]) -> Option<()> {
    macro_rules! integer {
        ($type:ty) => {
            *out.first_chunk_mut()? = <$type>::try_from(number::integer(value)?).ok()?.to_le_bytes()
        };
    }
    match field_type {
        FieldType::Char => return None,
        FieldType::U8 => integer!(u8),
        FieldType::I8 => integer!(i8),
        FieldType::U16 => integer!(u16),
        FieldType::I16 => integer!(i16),
        FieldType::U32 => integer!(u32),
        FieldType::I32 => integer!(i32),
        FieldType::I64 => integer!(i64),
        FieldType::U64 => *out.first_chunk_mut()? = number::unsigned(value)?.to_le_bytes(),
        FieldType::F32 => {
            let number = number::float(value)?;
            let single = number as f32;
            if single.is_infinite() && number.is_finite() {
                return None;
            }
            *out.first_chunk_mut()? = single.to_le_bytes();
        }
        FieldType::F64 => *out.first_chunk_mut()? = number::float(value)?.to_le_bytes(),
    }
    Some(())
}

/// Packs through `struct`, whose verdict on odd values is final. `value(i)` is the i-th value in XML order.
pub(crate) fn encode_by_struct<'py>(
    message: &Bound<'py, Message>,
    info: &Info,
    value: impl Fn(usize) -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let py = message.py();
    let mut values = Vec::new();
    for &index in &info.definition.wire_order {
        let field = &info.definition.fields[usize::from(index)];
        let item = value(usize::from(index))?;
        if field.is_numeric_array() {
            for i in 0..field.elements() {
                values.push(item.get_item(i)?);
            }
        } else {
            values.push(item);
        }
    }
    let layout = message.get_type().getattr(intern!(py, "unpacker"))?;
    let packed = layout.invoke_method1(intern!(py, "pack"), PyTuple::new(py, values)?)?;
    Ok(packed.cast_into::<PyBytes>()?)
}
