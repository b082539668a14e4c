//! The open log below a reader, binary or text.

use std::io;
use std::path::Path;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::{Delimiter, nth_value, number};
use mavwire_core::log::dataflash::{HEAD_LEN, Layout, TimeUnit};
use mavwire_io::dataflash::{Contents, DataflashFile};
use mavwire_io::text_log::TextLogFile;

/// Records that are passed over before the user's wish to stop is heeded.
pub(super) const BUDGET: u32 = 1 << 16;

/// A log.
#[derive(Clone)]
pub(super) enum Source {
    Binary(Box<DataflashFile>),
    Text(Box<TextLogFile>),
}

/// A record: where it is, its layout, its body or line, and where to look for the next.
pub(super) struct Record<'a> {
    pub(super) offset: u64,
    pub(super) layout: usize,
    pub(super) bytes: &'a [u8],
    pub(super) next: u64,
}

impl Source {
    pub(super) fn open(path: &Path, text: bool) -> io::Result<Self> {
        Ok(if text {
            Self::Text(Box::new(TextLogFile::open(path)?))
        } else {
            Self::Binary(Box::new(DataflashFile::open(path)?))
        })
    }

    pub(super) fn len(&self) -> u64 {
        match self {
            Self::Binary(file) => file.len(),
            Self::Text(file) => file.len(),
        }
    }

    pub(super) fn delimiter(&self) -> Option<Delimiter> {
        match self {
            Self::Binary(_) => None,
            Self::Text(file) => Some(file.delimiter()),
        }
    }

    pub(super) fn layouts(&self) -> &[Arc<Layout>] {
        match self {
            Self::Binary(file) => file.definitions().layouts(),
            Self::Text(file) => file.layouts(),
        }
    }

    pub(super) fn contents(
        &mut self,
        progress: &mut dyn FnMut(u64) -> bool,
    ) -> io::Result<Contents> {
        match self {
            Self::Binary(file) => file.contents(progress),
            Self::Text(file) => file.contents(progress),
        }
    }

    /// Offsets of all records, by the `count` layouts. `progress` is told now and then where this has come to, and ends
    /// it with false: `Interrupted`.
    pub(super) fn offsets(
        &mut self,
        count: usize,
        progress: &mut dyn FnMut(u64) -> bool,
    ) -> io::Result<Vec<Vec<u64>>> {
        let mut offsets = vec![Vec::new(); count];
        let (mut at, mut records) = (0, 0_u32);
        while let Some(record) = self.record_at(at)? {
            at = record.next;
            if let Some(offsets) = offsets.get_mut(record.layout) {
                offsets.push(record.offset);
            }
            records = records.wrapping_add(1);
            if records % BUDGET == 0 && !progress(at) {
                return Err(io::ErrorKind::Interrupted.into());
            }
        }
        Ok(offsets)
    }

    /// Passes over records of layouts that are not `wanted`, `most` of them at most, where there is a quick way; returns where
    /// it stopped and how many it passed.
    #[inline]
    pub(super) fn pass(
        &mut self,
        offset: u64,
        wanted: &[bool],
        most: u32,
    ) -> io::Result<(u64, u32)> {
        match self {
            Self::Binary(file) => file.pass(offset, wanted, most),
            Self::Text(_) => Ok((offset, 0)),
        }
    }

    /// The first record at or behind `offset`.
    #[inline]
    pub(super) fn record_at(&mut self, offset: u64) -> io::Result<Option<Record<'_>>> {
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
pub(super) fn seconds(layout: &Layout, bytes: &[u8], delimiter: Option<Delimiter>) -> Option<f64> {
    let Some(delimiter) = delimiter else { return layout.seconds(bytes) };
    let (index, unit) = layout.time?;
    let kind = layout.fields.get(index)?.kind;
    let number = number(kind, nth_value(bytes, delimiter, index)?)?;
    Some(number * if unit == TimeUnit::Micros { 1e-6 } else { 1e-3 })
}
