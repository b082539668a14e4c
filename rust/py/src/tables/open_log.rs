//! `LogScan`: the messages of a telemetry log as objects, with no link behind them. `mavwire.open_log` is its face.
//!
//! Only what is wanted becomes an object. Where nothing of the next records is wanted, the search goes on without the
//! interpreter.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mavwire_columns::input::framing_of;
use mavwire_columns::scan::{Framing, UNKNOWN};
use mavwire_columns::select::Wanted;
use mavwire_core::frame::FrameBytes;
use mavwire_core::log::tlog::FoundRecord;
use mavwire_core::parser::{Parser, Step};
use mavwire_core::registry::Registry;
use mavwire_core::scan::Resync;
use mavwire_io::files;
use mavwire_io::log_reader::{LogReader, Peeked};
use pyo3::prelude::*;

use crate::dialect::registry::Dialect;
use crate::message::create;
use crate::message::object::Message;
use crate::python::error::Result;
use crate::sync::shared;
use crate::tables::columns::Query;

/// Records that are looked at before the interpreter is let go of.
const NEAR: u32 = 32;
/// Messages that are handed out before signal handlers and other threads get a turn. A list that is made of the run runs
/// no Python code.
const TURN: u64 = 128;
/// Records that are looked at before the user's wish to stop is heeded.
const BUDGET: u32 = 1 << 20;

/// The file, and how it is read.
struct Source {
    reader: LogReader,
    parser: Parser,
    wanted: Wanted,
}

/// A wanted message of which an object is still to be made.
struct Found {
    /// Message index; `None` for an unknown id.
    index: Option<u16>,
    frame: FrameBytes,
    time: f64,
    link: u8,
}

/// The result of a look at the log.
enum Look<M> {
    /// A message, made in its place.
    Made(M),
    Found(Found),
    /// Nothing that is wanted.
    Nothing,
    End,
}

impl Source {
    /// Looks at the next record. `make` gets a wanted message in the reader's buffer; it may leave it to the caller.
    #[inline]
    fn look<M>(
        &mut self,
        registry: &Arc<Registry>,
        make: impl FnOnce(&Peeked<'_>) -> Option<M>,
    ) -> io::Result<Look<M>> {
        let Some(record) = self.reader.peek(&self.parser, registry)? else {
            return self.look_closer(registry);
        };
        let (len, time, link) = (record.len, record.time, record.link);
        let mut look = Look::Nothing;
        if self.wanted.wants_frame(record.index, record.stream, time) {
            let found = || {
                let frame = FrameBytes::from(&record.stream[..len]);
                Look::Found(Found { index: Some(record.index), frame, time, link })
            };
            look = make(&record).map_or_else(found, Look::Made);
        }
        self.reader.accept(len, time, link);
        Ok(look)
    }

    /// The same for what is no good frame of a known message.
    #[cold]
    fn look_closer<M>(&mut self, registry: &Registry) -> io::Result<Look<M>> {
        let (frame, entry) = match self.parser.resync() {
            Resync::Rescan => match self.reader.next_record(registry)? {
                FoundRecord::Record { len, entry, .. } => {
                    let len = len - self.reader.lead();
                    (FrameBytes::from(self.reader.last(len)?), entry)
                }
                FoundRecord::Junk { .. } => return Ok(Look::Nothing),
                FoundRecord::Incomplete { .. } => return Ok(Look::End),
            },
            // The messages that pymavlink's reader gives.
            Resync::Skip => match self.reader.next(&mut self.parser, registry, true)?.0 {
                Step::Frame { bytes, entry, .. } => (bytes, entry),
                Step::Nothing => return Ok(Look::End),
                _ => return Ok(Look::Nothing),
            },
        };
        let (time, link) = (self.reader.time, self.reader.link);
        let index = entry.map(|entry| entry.index);
        let is_wanted = self.wanted.wants_frame(index.unwrap_or(UNKNOWN), &frame, time);
        Ok(if is_wanted { Look::Found(Found { index, frame, time, link }) } else { Look::Nothing })
    }
}

/// One run over a log: an iterator of message objects.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LogScan {
    dialect: Py<Dialect>,
    /// `None` once the log is at its end, or closed. No Python code runs while it is held.
    source: Mutex<Option<Source>>,
    /// How often it was asked for a message.
    asked: AtomicU64,
}

impl LogScan {
    fn source(&self) -> MutexGuard<'_, Option<Source>> {
        self.source.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Looks for the next wanted message among so many records. An error ends the run.
    #[inline]
    fn search<M>(
        &self,
        records: u32,
        make: impl Fn(&Peeked<'_>) -> Option<M>,
    ) -> io::Result<Look<M>> {
        let registry = &self.dialect.get().registry;
        let mut guard = self.source();
        let Some(source) = guard.as_mut() else { return Ok(Look::End) };
        for _ in 0..records {
            let look = source.look(registry, &make);
            if let Ok(Look::End) | Err(_) = look {
                *guard = None;
                return look;
            }
            if !matches!(look, Ok(Look::Nothing)) {
                return look;
            }
        }
        Ok(Look::Nothing)
    }

    fn message<'py>(&self, py: Python<'py>, found: Found) -> PyResult<Option<Bound<'py, Message>>> {
        let Found { index, frame, time, link } = found;
        let stamped = |message: Message| message.stamped(time, Some(link));
        self.dialect.get().message(py, index, frame, stamped).map(Some)
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
        let source = Mutex::new(Some(Source { reader, parser, wanted }));
        Ok(Self { dialect, source, asked: AtomicU64::new(0) })
    }

    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __next__<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Message>>> {
        let (py, this) = (slf.py(), slf.get());
        if this.asked.load(Relaxed).is_multiple_of(TURN) {
            py.check_signals()?; // before anything is read, which could not be given back
            py.detach(|| ());
        }
        shared::add(&this.asked, 1);
        let make = |record: &Peeked<'_>| {
            let class = this.dialect.get().known_class(record.index)?;
            let stamped = |message: Message| message.stamped(record.time, Some(record.link));
            create::reused_frame(
                class.class.bind(py),
                class.info,
                record.stream,
                record.len,
                stamped,
            )
        };
        match this.search(NEAR, make)? {
            Look::Made(message) => return Ok(Some(message)),
            Look::Found(found) => return this.message(py, found),
            Look::End => return Ok(None),
            Look::Nothing => {}
        }
        loop {
            py.check_signals()?;
            match py.detach(|| this.search(BUDGET, |_| None::<()>))? {
                Look::Found(found) => return this.message(py, found),
                Look::End => return Ok(None),
                Look::Made(()) | Look::Nothing => {}
            }
        }
    }

    /// Runs to the end and counts the messages instead of making them.
    fn count(&self, py: Python<'_>) -> PyResult<u64> {
        let mut count = 0;
        loop {
            py.check_signals()?;
            let is_end = py.detach(|| -> io::Result<_> {
                for _ in 0..BUDGET {
                    match self.search(BUDGET, |_| Some(()))? {
                        Look::Made(()) | Look::Found(_) => count += 1,
                        Look::Nothing => break,
                        Look::End => return Ok(true),
                    }
                }
                Ok(false)
            })?;
            if is_end {
                return Ok(count);
            }
        }
    }

    /// Closes the file; the iteration is at its end.
    fn close(&self, py: Python<'_>) {
        py.detach(|| *self.source() = None);
    }
}
