//! A record, binary or text: its fields as numbers and as texts.

use super::field::FieldKind;
use super::layout::{Layout, TimeUnit};
use super::text::{self, Delimiter, decode_line, nth_value};
use super::units::Units;
use crate::pyfloat;

/// The fields of a record, by their indices.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    /// Its layout.
    pub layout: &'a Layout,
    /// The body, or the line.
    pub bytes: &'a [u8],
    /// The text between the values of a line.
    pub delimiter: Option<Delimiter>,
}

impl<'a> Record<'a> {
    /// A number.
    #[inline]
    pub fn number(&self, index: usize) -> Option<f64> {
        let Some(delimiter) = self.delimiter else { return self.layout.number(index, self.bytes) };
        let kind = self.layout.fields.get(index)?.kind;
        text::number(kind, nth_value(self.bytes, delimiter, index)?)
    }

    /// Seconds since start, if records of the layout carry a time.
    #[inline]
    pub fn seconds(&self) -> Option<f64> {
        let (index, unit) = self.layout.time?;
        Some(self.number(index)? * if unit == TimeUnit::Micros { 1e-6 } else { 1e-3 })
    }

    /// The stored bytes.
    pub fn stored(&self, index: usize) -> Option<&'a [u8]> {
        match self.delimiter {
            None => self.layout.field_bytes(index, self.bytes),
            Some(delimiter) => nth_value(self.bytes, delimiter, index),
        }
    }

    /// The value as Python's `str` shows it. `None` for an array, and for a word in the place of a number.
    pub fn text(&self, index: usize) -> Option<String> {
        let mut out = String::new();
        let kind = self.layout.fields.get(index)?.kind;
        if self.delimiter.is_none() {
            return self.layout.write_text(&mut out, index, self.bytes).then_some(out);
        }
        let value = self.stored(index)?;
        match kind {
            FieldKind::Text(_) | FieldKind::Array | FieldKind::Mode => out = decode_line(value),
            kind if kind.is_float() => pyfloat::write_repr(&mut out, text::number(kind, value)?),
            kind => out = (text::number(kind, value)? as i64).to_string(),
        }
        Some(out)
    }

    /// Adds the record to the units, if it describes some.
    pub fn tell_units(&self, units: &mut Units) -> Option<u8> {
        let text = |name: &str| self.text(self.layout.field_index(name)?);
        units.add(&self.layout.name, text)
    }
}
