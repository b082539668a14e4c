//! `LogScan`: the messages of a telemetry log as objects, with no link behind them. `mavwire.open_log` is its face.
//!
//! Records are found and filtered without the interpreter, a batch at a time; only what is wanted becomes an object.

use std::io;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use mavwire_columns::input::framing_of;
use mavwire_columns::scan::{Framing, UNKNOWN};
use mavwire_columns::select::Wanted;
use mavwire_core::registry::Entry;
use mavwire_core::scan::Resync;
use mavwire_io::files;
use mavwire_io::records::AtOffset;
use pyo3::prelude::*;

use crate::dialect::registry::Dialect;
use crate::message::create;
use crate::message::object::Message;
use crate::python::error::Result;
use crate::sync::lock::Lock;
use crate::tables::columns::Query;
use mavwire_core::frame::FrameBytes;
use mavwire_core::parser::{Parser, Step};
use mavwire_io::log_reader::LogReader;

/// Messages of a batch, and records that are looked at for one before the user's wish to stop is heeded.
const BATCH: usize = 128;
const BUDGET: u32 = 1 << 20;

/// A wanted message, its frame in the batch's bytes.
#[derive(Clone, Copy)]
struct Scanned {
    len: u16,
    /// Message index; `None` for an unknown id.
    index: Option<u16>,
    link: u8,
    time: f64,
}

/// Messages found and not handed out yet.
#[derive(Default)]
struct Batch {
    bytes: Vec<u8>,
    found: Vec<Scanned>,
    /// How many of `found`, and of `bytes`, are handed out.
    taken: usize,
    taken_bytes: usize,
}

impl Batch {
    fn clear(&mut self) {
        self.bytes.clear();
        self.found.clear();
        self.taken = 0;
        self.taken_bytes = 0;
    }

    fn push(&mut self, frame: &[u8], index: Option<u16>, time: f64, link: u8) {
        self.bytes.extend_from_slice(frame);
        self.found.push(Scanned { len: frame.len() as u16, index, link, time });
    }

    /// Appends a message if it is wanted.
    fn push_wanted(
        &mut self,
        wanted: &Wanted,
        frame: &[u8],
        entry: Option<Entry>,
        time: f64,
        link: u8,
    ) {
        let index = entry.map(|entry| entry.index);
        if wanted.wants_frame(index.unwrap_or(UNKNOWN), frame, time) {
            self.push(frame, index, time, link);
        }
    }

    fn append(&mut self, other: &Self) {
        self.bytes.extend_from_slice(&other.bytes);
        self.found.extend_from_slice(&other.found);
    }

    /// The next message, with the bytes from its start on.
    #[inline]
    fn peek(&self) -> Option<(Scanned, &[u8])> {
        Some((*self.found.get(self.taken)?, &self.bytes[self.taken_bytes..]))
    }

    /// Goes over the message that `peek` gave.
    #[inline]
    fn accept(&mut self, next: Scanned) {
        self.taken += 1;
        self.taken_bytes += usize::from(next.len);
    }
}

/// The file, and how it is read.
struct Source {
    reader: LogReader,
    parser: Parser,
    wanted: Wanted,
    /// Why reading failed, until what was read before is handed out.
    failed: Option<io::Error>,
}

/// How a stretch of scanning ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stretch {
    /// The batch is full, or enough was looked at.
    Paused,
    /// The log is at its end.
    Ended,
}

impl Source {
    /// Fills a batch with the next wanted messages.
    fn scan(&mut self, dialect: &Dialect, batch: &mut Batch) -> io::Result<Stretch> {
        for _ in 0..BUDGET {
            if self.next_plain(dialect, batch)? {
                if batch.found.len() == BATCH {
                    break;
                }
                continue;
            }
            let ended = match self.parser.resync() {
                Resync::Rescan => self.find(dialect, batch)?,
                Resync::Skip => self.hop(dialect, batch)?,
            };
            if ended {
                return Ok(Stretch::Ended);
            }
            if batch.found.len() == BATCH {
                break;
            }
        }
        Ok(Stretch::Paused)
    }

    /// The next record if it is a good frame of a known message; false if that is not so, and nothing is read then.
    #[inline]
    fn next_plain(&mut self, dialect: &Dialect, batch: &mut Batch) -> io::Result<bool> {
        let Some(record) = self.reader.peek(&self.parser, &dialect.registry)? else {
            return Ok(false);
        };
        let (len, time, link) = (record.len, record.time, record.link);
        if self.wanted.wants_frame(record.index, record.stream, time) {
            batch.push(&record.stream[..len], Some(record.index), time, link);
        }
        self.reader.accept(len, time, link);
        Ok(true)
    }

    /// The next good record; true at the end of the log.
    fn find(&mut self, dialect: &Dialect, batch: &mut Batch) -> io::Result<bool> {
        match self.reader.next_record(&dialect.registry)? {
            AtOffset::Record { len, entry, .. } => {
                let (time, link) = (self.reader.time, self.reader.link);
                let frame = self.reader.last(len - self.reader.lead())?;
                batch.push_wanted(&self.wanted, frame, entry, time, link);
                Ok(false)
            }
            AtOffset::Junk { .. } => Ok(false),
            AtOffset::End => Ok(true),
        }
    }

    /// The next message of those that pymavlink's reader gives; true at the end of the log.
    fn hop(&mut self, dialect: &Dialect, batch: &mut Batch) -> io::Result<bool> {
        match self.reader.next(&mut self.parser, &dialect.registry, true)?.0 {
            Step::Frame { bytes, entry, .. } => {
                let (time, link) = (self.reader.time, self.reader.link);
                batch.push_wanted(&self.wanted, &bytes, entry, time, link);
                Ok(false)
            }
            Step::Nothing => Ok(true),
            _ => Ok(false),
        }
    }
}

/// One run over a log: an iterator of message objects.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LogScan {
    dialect: Py<Dialect>,
    /// `None` once the log is at its end, or closed.
    source: Mutex<Option<Source>>,
    ready: Lock<Batch>,
}

impl LogScan {
    /// The next batch, scanned without the interpreter, and whether more may follow.
    fn scan(&self, py: Python<'_>, mut batch: Batch) -> PyResult<(Batch, Stretch)> {
        // Before anything is read: what was read could not be given back if this raised.
        py.check_signals()?;
        let dialect = self.dialect.get();
        batch.clear();
        let scanned = py.detach(|| -> io::Result<_> {
            let mut guard = self.source.lock().unwrap_or_else(PoisonError::into_inner);
            let Some(source) = guard.as_mut() else { return Ok((batch, Stretch::Ended)) };
            if let Some(error) = source.failed.take() {
                *guard = None;
                return Err(error);
            }
            match source.scan(dialect, &mut batch) {
                Ok(Stretch::Paused) => {}
                Ok(Stretch::Ended) => {
                    *guard = None;
                    return Ok((batch, Stretch::Ended));
                }
                Err(error) => source.failed = Some(error),
            }
            Ok((batch, Stretch::Paused))
        });
        Ok(scanned?)
    }

    /// Makes further messages ready; false if there are none.
    #[cold]
    fn refill(&self, py: Python<'_>) -> PyResult<bool> {
        let mut spare = {
            let mut ready = self.ready.lock(py);
            if ready.taken < ready.found.len() {
                // Another thread has been here in the meantime.
                return Ok(true);
            }
            std::mem::take(&mut *ready)
        };
        loop {
            let (batch, stretch) = self.scan(py, spare)?;
            if batch.found.is_empty() && stretch == Stretch::Paused {
                spare = batch;
                continue;
            }
            let some = !batch.found.is_empty();
            let mut ready = self.ready.lock(py);
            if ready.found.is_empty() {
                *ready = batch;
            } else {
                ready.append(&batch);
            }
            return Ok(some);
        }
    }

    /// Makes the next ready message in its place; `None` where that takes more, or where none is ready.
    #[inline]
    fn take_quickly<'py>(&self, py: Python<'py>) -> Option<Bound<'py, Message>> {
        let mut ready = self.ready.lock(py);
        let (next, stream) = ready.peek()?;
        let class = self.dialect.get().known_class(next.index?)?;
        let stamped = |message: Message| message.stamped(next.time, next.link);
        let len = usize::from(next.len);
        let message = create::reused_frame(class.class.bind(py), class.info, stream, len, stamped)?;
        ready.accept(next);
        Some(message)
    }

    /// Makes the next ready message.
    fn take<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, Message>>> {
        let (next, frame) = {
            let mut ready = self.ready.lock(py);
            let Some((next, stream)) = ready.peek() else { return Ok(None) };
            let frame = FrameBytes::from(&stream[..usize::from(next.len)]);
            ready.accept(next);
            (next, frame)
        };
        let stamped = |message: Message| message.stamped(next.time, next.link);
        self.dialect.get().message(py, next.index, frame, stamped).map(Some)
    }
}

#[pymethods]
impl LogScan {
    /// A run over the log at `path` from its start on. `ValueError` for a time where records have none.
    #[new]
    #[pyo3(signature = (path, dialect, rescan, query=None))]
    fn new(
        path: PathBuf,
        dialect: Py<Dialect>,
        rescan: bool,
        query: Option<Query>,
    ) -> Result<Self> {
        let query = query.unwrap_or_default();
        let framing = framing_of(files::open(&path)?, &dialect.get().registry)?;
        query.check_times(framing == Framing::Stamped)?;
        let reader = LogReader::open(&path, framing, 0.0)?;
        let mut parser = Parser::default();
        parser.set_resync(if rescan { Resync::Rescan } else { Resync::Skip });
        let wanted = query.wanted(Some(dialect.get()));
        Ok(Self {
            dialect,
            source: Mutex::new(Some(Source { reader, parser, wanted, failed: None })),
            ready: Lock::new(Batch::default()),
        })
    }

    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __next__<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Message>>> {
        let (py, this) = (slf.py(), slf.get());
        loop {
            if let Some(message) = this.take_quickly(py) {
                return Ok(Some(message));
            }
            if let Some(message) = this.take(py)? {
                return Ok(Some(message));
            }
            if !this.refill(py)? {
                return Ok(None);
            }
        }
    }

    /// Runs to the end and counts the messages instead of making them.
    fn count(&self, py: Python<'_>) -> PyResult<u64> {
        let mut batch = std::mem::take(&mut *self.ready.lock(py));
        let mut count = (batch.found.len() - batch.taken) as u64;
        loop {
            let (scanned, stretch) = self.scan(py, batch)?;
            count += scanned.found.len() as u64;
            if stretch == Stretch::Ended {
                return Ok(count);
            }
            batch = scanned;
        }
    }

    /// Closes the file; the iteration is at its end.
    fn close(&self, py: Python<'_>) {
        py.detach(|| *self.source.lock().unwrap_or_else(PoisonError::into_inner) = None);
        self.ready.lock(py).clear();
    }
}
