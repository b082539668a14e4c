//! A dataflash log in its text form: a line for each record.

use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::sync::Arc;

use mavwire_core::log::dataflash::Layout;
use mavwire_core::log::dataflash::text::{
    Delimiter, MAX_LINE_LEN, TextDefinitions, decode_line, mark_len, trimmed,
};

use crate::log_contents::Entry;
use crate::window::{CHUNK, FileWindow};

/// Bytes at the start that show the delimiter.
const PROBE: usize = 8000;

/// Different names that are counted at most, and the characters that tell them apart.
const MAX_KEYS: usize = 4096;
const KEY_LEN: usize = 4;

/// An open log.
#[derive(Debug, Clone)]
pub struct TextLogFile {
    window: FileWindow,
    len: u64,
    definitions: TextDefinitions,
    /// First characters of a line up to the comma -> where the first such line starts, and how many there are.
    keys: HashMap<String, (u64, u64)>,
    lines: u64,
    /// Bytes of the longest line that is looked at.
    longest: usize,
}

/// A line of the log.
struct Line {
    /// The line starts here.
    offset: u64,
    /// The next line starts here.
    next: u64,
    /// A line feed ends it. Otherwise its last value may be cut off.
    is_whole: bool,
    /// Bytes without the line's end; 0 of a line that is too long.
    len: usize,
}

/// The key that a line counts for: its first characters up to the comma.
fn key_of(line: &[u8]) -> String {
    let key = &line[..line.len().min(KEY_LEN)];
    decode_line(&key[..memchr::memchr(b',', key).unwrap_or(key.len())])
}

impl TextLogFile {
    /// Opens a file and reads its FMT lines.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::in_chunks(path, CHUNK)
    }

    /// The same with another number of bytes read at a time, as for [`FileWindow::in_chunks`]. Longer lines are passed over.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn in_chunks(path: &Path, chunk: usize) -> io::Result<Self> {
        let mut window = FileWindow::in_chunks(path, chunk)?;
        let len = window.size()?;
        let (probe, longest) = (PROBE.min(chunk), MAX_LINE_LEN.min(chunk));
        let head = window.at(0, probe)?;
        let delimiter = Delimiter::of(&head[..head.len().min(probe)]);
        let definitions = TextDefinitions::new(delimiter);
        let mut log = Self { window, len, definitions, keys: HashMap::new(), lines: 0, longest };
        log.collect()?;
        Ok(log)
    }

    /// Goes through all lines for FMT, and counts the others.
    fn collect(&mut self) -> io::Result<()> {
        let mut at = 0;
        while let Some(line) = self.line_at(at)? {
            at = line.next;
            let bytes = &self.window.buffered(line.offset)[..line.len];
            if trimmed(bytes).is_empty() {
                continue;
            }
            let key = key_of(bytes);
            if line.is_whole {
                self.definitions.collect(bytes, line.offset);
            }
            self.lines += 1;
            if self.keys.len() < MAX_KEYS || self.keys.contains_key(&key) {
                self.keys.entry(key).or_insert((line.offset, 0)).1 += 1;
            }
        }
        Ok(())
    }

    /// Bytes of the file when it was opened.
    pub fn size(&self) -> u64 {
        self.len
    }

    /// The text between values.
    pub fn delimiter(&self) -> Delimiter {
        self.definitions.delimiter()
    }

    /// The layouts of the records.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        self.definitions.layouts()
    }

    /// Lines by their first characters up to the comma, in the order of the log.
    pub fn counts(&self) -> Vec<(&str, u64)> {
        let mut keys: Vec<_> = self.keys.iter().collect();
        keys.sort_unstable_by_key(|(_, (first, _))| *first);
        keys.into_iter().map(|(key, (_, count))| (key.as_str(), *count)).collect()
    }

    /// Lines that are not empty.
    pub fn lines(&self) -> u64 {
        self.lines
    }

    fn line_at(&mut self, mut offset: u64) -> io::Result<Option<Line>> {
        if offset == 0 {
            offset = mark_len(self.window.at(0, self.longest)?) as u64;
        }
        if offset >= self.len {
            return Ok(None);
        }
        let (found, end) = self.line_len(offset)?;
        let (len, next) = match found {
            Some(len) => (len, offset + len as u64 + 1),
            None if end < self.longest => (end, offset + end as u64),
            None => (0, self.end_of_long_line(offset + end as u64)?),
        };
        Ok((next > offset).then_some(Line { offset, next, is_whole: found.is_some(), len }))
    }

    /// Bytes up to the next line feed, and how many bytes there are at all, at most `longest`.
    fn line_len(&mut self, offset: u64) -> io::Result<(Option<usize>, usize)> {
        let found = memchr::memchr(b'\n', self.window.buffered(offset));
        if let Some(len) = found.filter(|&len| len < self.longest) {
            return Ok((Some(len), 0));
        }
        let bytes = self.window.at(offset, self.longest)?;
        let bytes = &bytes[..bytes.len().min(self.longest)];
        Ok((memchr::memchr(b'\n', bytes), bytes.len()))
    }

    fn end_of_long_line(&mut self, mut offset: u64) -> io::Result<u64> {
        loop {
            let bytes = self.window.at(offset, self.longest)?;
            if let Some(len) = memchr::memchr(b'\n', bytes) {
                return Ok(offset + len as u64 + 1);
            }
            if bytes.is_empty() {
                return Ok(offset.max(self.len));
            }
            offset += bytes.len() as u64;
        }
    }

    /// The first record at or behind `offset`; `None` at the end of the log.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn entry_at(&mut self, offset: u64) -> io::Result<Option<Entry>> {
        let mut at = offset;
        while let Some(line) = self.line_at(at)? {
            at = line.next;
            let bytes = trimmed(&self.window.buffered(line.offset)[..line.len]);
            if line.is_whole
                && let Some(layout) = self.definitions.of_line(bytes, line.offset)
            {
                let (offset, layout, len) = (line.offset, layout.into(), bytes.len());
                return Ok(Some(Entry { offset, layout, len, next: at }));
            }
        }
        Ok(None)
    }

    /// The first `len` bytes of the line that [`Self::entry_at`] found last, at `offset`.
    pub fn bytes_at(&self, offset: u64, len: usize) -> &[u8] {
        self.window.buffered(offset).get(..len).unwrap_or_default()
    }
}
