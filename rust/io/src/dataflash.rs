//! A binary dataflash log file: its layouts, and its records one after the other.
//!
//! The file is read through a window and never mapped or held. Bytes that were added after it was opened do not count.

use std::io;
use std::path::Path;

use mavwire_core::log::dataflash::{Definitions, FMT_LAYOUT_LEN, Found, LOOK_LEN, look, pass};

use crate::log_contents::Entry;
use crate::window::{CHUNK, FileWindow};

/// An open log.
#[derive(Debug, Clone)]
pub struct DataflashFile {
    window: FileWindow,
    len: u64,
    definitions: Definitions,
}

impl DataflashFile {
    /// Opens a file and reads its FMT records.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::in_chunks(path, CHUNK)
    }

    /// The same with another number of bytes read at a time, as for [`FileWindow::in_chunks`].
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn in_chunks(path: &Path, chunk: usize) -> io::Result<Self> {
        let stretch = chunk.max(FMT_LAYOUT_LEN);
        let mut window = FileWindow::in_chunks(path, stretch)?;
        let len = window.size()?;
        let mut definitions = Definitions::new();
        let mut at = 0;
        while at < len {
            let bytes = window.at(at, stretch)?;
            definitions.collect(bytes, at);
            if bytes.len() < stretch {
                break;
            }
            at += (bytes.len() - (FMT_LAYOUT_LEN - 1)) as u64;
        }
        Ok(Self { window, len, definitions })
    }

    /// Bytes of the file when it was opened.
    pub fn size(&self) -> u64 {
        self.len
    }

    /// The layouts of the records.
    pub fn definitions(&self) -> &Definitions {
        &self.definitions
    }

    /// The first record at or behind `offset`; `None` at the end of the log.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn entry_at(&mut self, offset: u64) -> io::Result<Option<Entry>> {
        let mut at = offset;
        while at < self.len {
            let (bytes, last) = bytes_at(&mut self.window, self.len, at)?;
            match look(bytes, at, &self.definitions, last) {
                Found::Record { len, layout } => {
                    let (layout, next) = (layout.into(), at + len as u64);
                    return Ok(Some(Entry { offset: at, layout, len, next }));
                }
                Found::Junk { len } => at += len as u64,
                Found::Incomplete => break,
            }
        }
        Ok(None)
    }

    /// The first `len` bytes of the record that [`Self::entry_at`] found last, at `offset`.
    #[inline]
    pub fn bytes_at(&self, offset: u64, len: usize) -> &[u8] {
        self.window.buffered(offset).get(..len).unwrap_or_default()
    }

    /// Passes at most `most` records of layouts that are not `wanted`, as far as a quick way exists. Returns the offset behind
    /// them, and their number.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn pass(&mut self, offset: u64, wanted: &[bool], most: u32) -> io::Result<(u64, u32)> {
        let (bytes, _) = bytes_at(&mut self.window, self.len, offset)?;
        let (len, passed) = pass(bytes, offset, &self.definitions, wanted, most);
        Ok((offset + len as u64, passed))
    }
}

fn bytes_at(window: &mut FileWindow, len: u64, offset: u64) -> io::Result<(&[u8], bool)> {
    let left = usize::try_from(len.saturating_sub(offset)).unwrap_or(usize::MAX);
    let bytes = window.at(offset, LOOK_LEN)?;
    let last = bytes.len() >= left || bytes.len() < LOOK_LEN;
    Ok((&bytes[..bytes.len().min(left)], last))
}
