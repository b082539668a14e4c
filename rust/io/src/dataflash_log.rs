//! An open dataflash log, binary or text.

use std::io;
use std::path::Path;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::{Delimiter, nth_value, number};
use mavwire_core::log::dataflash::{HEAD_LEN, Layout, TimeUnit};

use crate::dataflash::{Contents, DataflashFile};
use crate::text_log::TextLogFile;

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

/// A record.
#[derive(Debug)]
pub struct Record<'a> {
    /// The record starts here.
    pub offset: u64,
    /// Index of its layout.
    pub layout: usize,
    /// The body, or the line.
    pub bytes: &'a [u8],
    /// The next record is at or behind this offset.
    pub next: u64,
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

    /// Offsets of all records, by layout. `progress` is that of [`Self::contents`].
    ///
    /// # Errors
    /// Those of [`Self::contents`].
    pub fn offsets(&mut self, progress: &mut dyn FnMut(u64) -> bool) -> io::Result<Vec<Vec<u64>>> {
        let mut offsets = vec![Vec::new(); self.layouts().len()];
        let (mut at, mut records) = (0, 0_u32);
        while let Some(record) = self.record_at(at)? {
            at = record.next;
            offsets[record.layout].push(record.offset);
            records = records.wrapping_add(1);
            if records % BUDGET == 0 && !progress(at) {
                return Err(io::ErrorKind::Interrupted.into());
            }
        }
        Ok(offsets)
    }

    /// Passes at most `most` records of layouts that are not `wanted`, as far as a quick way exists. Returns the offset behind
    /// them, and their number.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn pass(&mut self, offset: u64, wanted: &[bool], most: u32) -> io::Result<(u64, u32)> {
        match self {
            Self::Binary(file) => file.pass(offset, wanted, most),
            Self::Text(_) => Ok((offset, 0)),
        }
    }

    /// The first record at or behind `offset`.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn record_at(&mut self, offset: u64) -> io::Result<Option<Record<'_>>> {
        match self {
            Self::Binary(file) => Ok(file.record_at(offset)?.map(|(entry, bytes)| Record {
                offset: entry.offset,
                layout: usize::from(entry.layout),
                bytes: &bytes[HEAD_LEN..],
                next: entry.offset + u64::from(entry.len),
            })),
            Self::Text(file) => Ok(file.record_at(offset)?.map(|(entry, bytes, next)| Record {
                offset: entry.offset,
                layout: usize::from(entry.layout),
                bytes,
                next,
            })),
        }
    }
}

/// Seconds since start, for records that carry a time.
#[inline]
pub fn seconds(layout: &Layout, bytes: &[u8], delimiter: Option<Delimiter>) -> Option<f64> {
    let Some(delimiter) = delimiter else { return layout.seconds(bytes) };
    let (index, unit) = layout.time?;
    let kind = layout.fields.get(index)?.kind;
    let number = number(kind, nth_value(bytes, delimiter, index)?)?;
    Some(number * if unit == TimeUnit::Micros { 1e-6 } else { 1e-3 })
}
