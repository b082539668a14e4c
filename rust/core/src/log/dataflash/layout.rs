//! The content of a FMT record: name, length and fields of a record type.

use std::fmt::Write;

use memchr::memchr;
use thiserror::Error;

use super::field::{FieldKind, Value, value};
use super::text::decode_line;
use super::{FMT_TYPE, HEAD_LEN};
use crate::pyfloat;

/// Bytes of a FMT record.
pub const FMT_LAYOUT_LEN: usize = 89;

const NAME_LEN: usize = 4;
const FORMAT_LEN: usize = 16;

/// A field of a record type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// The column's name.
    pub name: String,
    /// How it is stored.
    pub kind: FieldKind,
    /// Its offset in the record's body.
    pub offset: u8,
}

impl Field {
    /// The stored value.
    #[inline]
    pub fn value<'a>(&self, body: &'a [u8]) -> Value<'a> {
        value(self.kind, body, usize::from(self.offset))
    }
}

/// The unit of a record's time field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// `TimeUS`: microseconds since start.
    Micros,
    /// `TimeMS`: milliseconds since start.
    Millis,
}

/// Why a FMT record describes no type.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LayoutError {
    /// A format character without a meaning.
    #[error("Unsupported format char: '{character}' in message {name}")]
    UnknownKind {
        /// The character.
        character: char,
        /// The type's name.
        name: String,
    },
    /// The fields do not fit into the length.
    #[error("message {name} is said to have {len} bytes, but its fields need {needed}")]
    TooShort {
        /// The type's name.
        name: String,
        /// The length that the record gives.
        len: u8,
        /// Bytes of head and fields.
        needed: usize,
    },
    /// No name, or no whole FMT record.
    #[error("no FMT record")]
    Malformed,
}

/// A record type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// The type's number.
    pub type_id: u8,
    /// Bytes of a record, head included.
    pub len: u8,
    /// The type's name.
    pub name: String,
    /// The format, a character for each field.
    pub format: String,
    /// Names of all columns, even of those without a format character.
    pub columns: Vec<String>,
    /// Fields that have a name and a format character.
    pub fields: Vec<Field>,
    /// Index and unit of the field that holds the time.
    pub time: Option<(usize, TimeUnit)>,
}

impl Layout {
    /// A type by its parts. `len` 0 means the length that the fields need.
    ///
    /// # Errors
    /// Unknown format characters, and fields that do not fit into `len`.
    pub fn new(
        type_id: u8,
        len: u8,
        name: String,
        format: String,
        columns: Vec<String>,
    ) -> Result<Self, LayoutError> {
        let kinds = kinds(&name, &format)?;
        let needed = HEAD_LEN + kinds.iter().map(|kind| kind.size()).sum::<usize>();
        let len = if len == 0 { u8::try_from(needed).unwrap_or(0) } else { len };
        if usize::from(len) < needed {
            return Err(LayoutError::TooShort { name, len, needed });
        }
        let fields = fields(&columns, &kinds);
        let time = time_field(&name, &fields);
        Ok(Self { type_id, len, name, format, columns, fields, time })
    }

    /// Reads the body of a FMT record.
    ///
    /// # Errors
    /// [`LayoutError`] names the first fault of the description.
    pub fn parse(body: &[u8]) -> Result<Self, LayoutError> {
        let (&[type_id, len], rest) = body.split_first_chunk().ok_or(LayoutError::Malformed)?;
        let (name, rest) = rest.split_at_checked(NAME_LEN).ok_or(LayoutError::Malformed)?;
        let (format, columns) = rest.split_at_checked(FORMAT_LEN).ok_or(LayoutError::Malformed)?;
        let name = log_text(name);
        if name.is_empty() || usize::from(len) < HEAD_LEN {
            return Err(LayoutError::Malformed);
        }
        let format = log_text(format);
        // Checked before the columns are split: noise contains many bytes that look like the start of a FMT record.
        kinds(&name, &format)?;
        Self::new(type_id, len, name, format, split_columns(&log_text(columns)))
    }

    /// The layout of FMT records themselves.
    pub fn of_fmt() -> Self {
        let columns = split_columns("Type,Length,Name,Format,Columns");
        let kinds = "BBnNZ".bytes().filter_map(FieldKind::from_char).collect::<Vec<_>>();
        Self {
            type_id: FMT_TYPE,
            len: FMT_LAYOUT_LEN as u8,
            name: "FMT".into(),
            format: "BBnNZ".into(),
            fields: fields(&columns, &kinds),
            columns,
            time: None,
        }
    }

    /// Index of the field called `name`, the last one if there are several.
    pub fn field_index(&self, name: &str) -> Option<usize> {
        self.fields.iter().rposition(|field| field.name == name)
    }

    /// The stored value of a field.
    #[inline]
    pub fn value<'a>(&self, index: usize, body: &'a [u8]) -> Option<Value<'a>> {
        Some(self.fields.get(index)?.value(body))
    }

    /// The stored bytes of a field.
    #[inline]
    pub fn field_bytes<'a>(&self, index: usize, body: &'a [u8]) -> Option<&'a [u8]> {
        let field = self.fields.get(index)?;
        body.get(usize::from(field.offset)..)?.get(..field.kind.size())
    }

    /// Writes the value of a field as Python's `str` does. False for arrays, which it does not write.
    pub fn write_text(&self, out: &mut String, index: usize, body: &[u8]) -> bool {
        let Some(field) = self.fields.get(index) else { return false };
        match field.value(body) {
            Value::Integer(number) if field.kind.scale().is_some() => {
                pyfloat::write_repr(out, field.kind.scaled(number as f64));
            }
            Value::Integer(number) => drop(write!(out, "{number}")),
            Value::Unsigned(number) => drop(write!(out, "{number}")),
            Value::Float(number) => write_float(out, number),
            Value::Text(bytes) => {
                out.push_str(&decode_line(&bytes[..memchr(0, bytes).unwrap_or(bytes.len())]));
            }
            Value::Array(_) => return false,
        }
        true
    }

    /// The value of a field as a float, scaled; `None` for texts and arrays.
    #[inline]
    pub fn number(&self, index: usize, body: &[u8]) -> Option<f64> {
        let field = self.fields.get(index)?;
        let stored = field.value(body).as_f64()?;
        Some(if field.kind.scale().is_some() { field.kind.scaled(stored) } else { stored })
    }

    /// So many times the same as an integer: see [`whole`].
    #[inline]
    pub fn count(&self, index: usize, body: &[u8], times: i64) -> Option<i64> {
        match self.value(index, body)? {
            Value::Integer(number) if self.fields[index].kind.scale().is_none() => {
                Some(number.saturating_mul(times))
            }
            Value::Unsigned(number) => {
                Some(i64::try_from(number).unwrap_or(i64::MAX).saturating_mul(times))
            }
            _ => self.number(index, body).and_then(|number| whole(number * times as f64)),
        }
    }
}

/// Writes a float as Python's `repr` does, but `qnan` for every NaN except the plain one: autopilots calculate the others.
pub fn write_float(out: &mut String, number: f64) {
    const PLAIN_NAN: u64 = 0x7FF8_0000_0000_0000;
    if number.is_nan() && number.to_bits() != PLAIN_NAN {
        out.push_str("qnan");
    } else {
        pyfloat::write_repr(out, number);
    }
}

/// The nearest integer; the largest or smallest for what is beyond, `None` for NaN and infinity.
#[inline]
pub fn whole(number: f64) -> Option<i64> {
    number.is_finite().then(|| number.round() as i64)
}

fn kinds(name: &str, format: &str) -> Result<Vec<FieldKind>, LayoutError> {
    let kind = |character: char| {
        let byte = u8::try_from(character).ok();
        byte.and_then(FieldKind::from_char)
            .ok_or_else(|| LayoutError::UnknownKind { character, name: name.to_owned() })
    };
    format.chars().map(kind).collect()
}

fn fields(columns: &[String], kinds: &[FieldKind]) -> Vec<Field> {
    let mut offset = 0;
    let field = |(name, &kind): (&String, &FieldKind)| {
        let field = Field { name: name.clone(), kind, offset: offset as u8 };
        offset += kind.size();
        field
    };
    columns.iter().zip(kinds).map(field).collect()
}

/// `TimeUS` or `TimeMS` in front; the latter is no time of logging in the batches of raw samples that `ACC1` and `GYR1`
/// hold.
fn time_field(name: &str, fields: &[Field]) -> Option<(usize, TimeUnit)> {
    let samples = name.starts_with("ACC") || name.starts_with("GYR");
    match fields.first()?.name.as_str() {
        // The last of two columns of one name is the one that counts.
        name @ "TimeUS" => {
            Some((fields.iter().rposition(|field| field.name == name)?, TimeUnit::Micros))
        }
        "TimeMS" if !samples => Some((0, TimeUnit::Millis)),
        _ => None,
    }
}

/// Names of columns, separated by commas.
pub(super) fn split_columns(columns: &str) -> Vec<String> {
    if columns.is_empty() {
        return Vec::new();
    }
    columns.split(',').map(str::to_owned).collect()
}

/// The text in a field that a NUL ends; bytes that are no UTF-8 are shown as `\xff`.
pub fn log_text(bytes: &[u8]) -> String {
    let bytes = &bytes[..memchr(0, bytes).unwrap_or(bytes.len())];
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        for byte in chunk.invalid() {
            let _ = write!(text, "\\x{byte:02x}");
        }
    }
    text
}
