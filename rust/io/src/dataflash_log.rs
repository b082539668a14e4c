//! An open dataflash log, binary or text.

use std::io;
use std::path::Path;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::{self, Delimiter, nth_value};
use mavwire_core::log::dataflash::{ClockFinder, FieldKind, HEAD_LEN, Layout, TimeUnit};
use mavwire_core::pyfloat;

use crate::dataflash::{Contents, DataflashFile};
use crate::text_log::{LineEntry, TextLogFile};

/// Records between two looks at whether the user wishes to stop.
pub const BUDGET: u32 = 1 << 16;

/// A log.
#[derive(Debug, Clone)]
pub enum DataflashLog {
    /// A `.BIN` file.
    Binary(Box<DataflashFile>),
    /// A `.log` file.
    Text(Box<TextLogFile>),
}

/// A record of a log.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The record starts here.
    pub offset: u64,
    /// Index of its layout.
    pub layout: usize,
    /// The next record is at or behind this offset.
    pub next: u64,
    /// Bytes of the record, or of the line.
    len: usize,
}

/// How a search for a record ended.
#[derive(Debug, Clone, Copy)]
pub enum Step<T> {
    /// With a record of a wanted layout.
    Found(T),
    /// After as many other records as it may pass.
    Paused,
    /// At the end of the log.
    End,
}

impl DataflashLog {
    /// Opens a file and reads its FMT records.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn open(path: &Path, text: bool) -> io::Result<Self> {
        Ok(if text {
            Self::Text(Box::new(TextLogFile::open(path)?))
        } else {
            Self::Binary(Box::new(DataflashFile::open(path)?))
        })
    }

    /// Bytes of the file when it was opened.
    pub fn size(&self) -> u64 {
        match self {
            Self::Binary(file) => file.size(),
            Self::Text(file) => file.size(),
        }
    }

    /// The text between the values of a text log.
    pub fn delimiter(&self) -> Option<Delimiter> {
        match self {
            Self::Binary(_) => None,
            Self::Text(file) => Some(file.delimiter()),
        }
    }

    /// The layouts of the records.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        match self {
            Self::Binary(file) => file.definitions().layouts(),
            Self::Text(file) => file.layouts(),
        }
    }

    /// Goes through the whole log. `progress` gets the offset now and then, and ends the run with false.
    ///
    /// # Errors
    /// The error of the operating system. `Interrupted` if `progress` ended the run.
    pub fn contents(&mut self, progress: &mut dyn FnMut(u64) -> bool) -> io::Result<Contents> {
        match self {
            Self::Binary(file) => file.contents(progress),
            Self::Text(file) => file.contents(progress),
        }
    }

    /// Goes through the log up to the record that tells when it began. `progress` is that of [`Self::contents`].
    ///
    /// # Errors
    /// Those of [`Self::contents`].
    pub fn find_clock(&mut self, progress: &mut dyn FnMut(u64) -> bool) -> io::Result<ClockFinder> {
        let (layouts, delimiter) = (self.layouts().to_vec(), self.delimiter());
        let wanted = |finder: &ClockFinder| -> Vec<bool> {
            layouts.iter().map(|layout| finder.wants(layout)).collect()
        };
        let mut finder = ClockFinder::default();
        let (mut at, mut telling) = (0, wanted(&finder));
        while !finder.is_settled() {
            let entry = match self.step(&mut at, Some(&telling), &mut { BUDGET })? {
                Step::Found(entry) => entry,
                Step::Paused if progress(at) => continue,
                Step::Paused => return Err(io::ErrorKind::Interrupted.into()),
                Step::End => break,
            };
            let (layout, bytes) = (&layouts[entry.layout], self.bytes(entry));
            if finder.add(layout, entry.offset, |index| number(layout, bytes, delimiter, index)) {
                telling = wanted(&finder);
            }
        }
        Ok(finder)
    }

    /// Offsets of all records, by layout. `progress` is that of [`Self::contents`].
    ///
    /// # Errors
    /// Those of [`Self::contents`].
    pub fn offsets(&mut self, progress: &mut dyn FnMut(u64) -> bool) -> io::Result<Vec<Vec<u64>>> {
        let mut offsets = vec![Vec::new(); self.layouts().len()];
        let (mut at, mut records) = (0, 0_u32);
        while let Some(entry) = self.entry_at(at)? {
            at = entry.next;
            offsets[entry.layout].push(entry.offset);
            records = records.wrapping_add(1);
            if records % BUDGET == 0 && !progress(at) {
                return Err(io::ErrorKind::Interrupted.into());
            }
        }
        Ok(offsets)
    }

    /// The first record at or behind `offset`.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn entry_at(&mut self, offset: u64) -> io::Result<Option<Entry>> {
        Ok(match self {
            Self::Binary(file) => file.entry_at(offset)?.map(|entry| {
                let (offset, len) = (entry.offset, usize::from(entry.len));
                let next = offset + u64::from(entry.len);
                Entry { offset, layout: entry.layout.into(), next, len }
            }),
            Self::Text(file) => file.entry_at(offset)?.map(|line| {
                let LineEntry { offset, layout, next, len } = line;
                Entry { offset, layout: layout.into(), next, len }
            }),
        })
    }

    /// Finds the next record, of the `wanted` layouts if these are given, and moves `at` behind it. `budget` counts down the
    /// other records.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn step(
        &mut self,
        at: &mut u64,
        wanted: Option<&[bool]>,
        budget: &mut u32,
    ) -> io::Result<Step<Entry>> {
        loop {
            if let (Self::Binary(file), Some(wanted)) = (&mut *self, wanted) {
                let passed;
                (*at, passed) = file.pass(*at, wanted, *budget)?;
                *budget -= passed;
            }
            if *budget == 0 {
                return Ok(Step::Paused);
            }
            let Some(entry) = self.entry_at(*at)? else { return Ok(Step::End) };
            *at = entry.next;
            if wanted.is_none_or(|wanted| wanted[entry.layout]) {
                return Ok(Step::Found(entry));
            }
            *budget -= 1;
        }
    }

    /// The body, or the line, of the record that was found last.
    #[inline]
    pub fn bytes(&self, entry: Entry) -> &[u8] {
        match self {
            Self::Binary(file) => file.bytes_at(entry.offset, entry.len).get(HEAD_LEN..),
            Self::Text(file) => Some(file.bytes_at(entry.offset, entry.len)),
        }
        .unwrap_or_default()
    }
}

/// A number of a record, by the index of its field. The record is a line if there is a delimiter.
#[inline]
pub fn number(
    layout: &Layout,
    bytes: &[u8],
    delimiter: Option<Delimiter>,
    index: usize,
) -> Option<f64> {
    let Some(delimiter) = delimiter else { return layout.number(index, bytes) };
    text::number(layout.fields.get(index)?.kind, nth_value(bytes, delimiter, index)?)
}

/// The stored bytes of a field.
pub fn field_bytes<'a>(
    layout: &Layout,
    bytes: &'a [u8],
    delimiter: Option<Delimiter>,
    index: usize,
) -> Option<&'a [u8]> {
    match delimiter {
        None => layout.field_bytes(index, bytes),
        Some(delimiter) => text::value_at(bytes, delimiter, &layout.name, index),
    }
}

/// The value of a field as Python's `str` shows it. `None` for an array, and for a word in the place of a number.
pub fn field_text(
    layout: &Layout,
    bytes: &[u8],
    delimiter: Option<Delimiter>,
    index: usize,
) -> Option<String> {
    let mut out = String::new();
    let kind = layout.fields.get(index)?.kind;
    let Some(delimiter) = delimiter else {
        return layout.write_text(&mut out, index, bytes).then_some(out);
    };
    let value = text::value_at(bytes, delimiter, &layout.name, index)?;
    match kind {
        FieldKind::Text(_) | FieldKind::Array | FieldKind::Mode => out = text::decode_line(value),
        kind if kind.is_float() => pyfloat::write_repr(&mut out, text::number(kind, value)?),
        kind => out = (text::number(kind, value)? as i64).to_string(),
    }
    Some(out)
}

/// Seconds since start, for records that carry a time.
#[inline]
pub fn seconds(layout: &Layout, bytes: &[u8], delimiter: Option<Delimiter>) -> Option<f64> {
    let (index, unit) = layout.time?;
    let stored = number(layout, bytes, delimiter, index)?;
    Some(stored * if unit == TimeUnit::Micros { 1e-6 } else { 1e-3 })
}
