//! The state of a reader: the log, its position in it, the wanted types, the newest messages.

use std::collections::HashMap;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::Delimiter;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use super::clock::MicrosClock;
use super::message::DFMessage;
use super::names::Names;
use mavwire_core::frame::FrameBytes;
use mavwire_core::log::dataflash::Record;
use mavwire_io::dataflash_log::{DataflashLog, Step};

/// Keys of instances that are remembered for a type; more are spelled anew each time.
const MAX_KEYS: usize = 4096;

/// A record type of the log.
pub(super) struct Kind {
    pub(super) names: Arc<Names>,
    /// The `DFFormat`.
    pub(super) format: Py<PyAny>,
    /// Index of the field that tells instances apart.
    instance: Option<usize>,
    /// The reader's state changes with messages of this type.
    tracked: bool,
    /// Value of the instance field as stored -> key in `messages`.
    keys: HashMap<Box<[u8]>, Py<PyString>>,
}

impl Kind {
    pub(super) fn new(
        names: Arc<Names>,
        format: Py<PyAny>,
        instance: Option<usize>,
        tracked: bool,
    ) -> Self {
        Self { names, format, instance, tracked, keys: HashMap::new() }
    }

    /// The key of a record's instance in `messages`. The record is a line if there is a delimiter.
    pub(super) fn key(
        &mut self,
        py: Python<'_>,
        bytes: &[u8],
        delimiter: Option<Delimiter>,
    ) -> Option<Py<PyString>> {
        let (index, layout) = (self.instance?, &*self.names.layout);
        let record = Record { layout, bytes, delimiter };
        let stored = record.stored(index)?;
        if let Some(key) = self.keys.get(stored) {
            return Some(key.clone_ref(py));
        }
        let value = record.text(index)?;
        let key = PyString::new(py, &format!("{}[{value}]", layout.name)).unbind();
        if self.keys.len() < MAX_KEYS {
            self.keys.insert(stored.into(), key.clone_ref(py));
        }
        Some(key)
    }
}

/// See the module.
pub(super) struct State {
    pub(super) log: Option<DataflashLog>,
    pub(super) kinds: Vec<Kind>,
    pub(super) offset: u64,
    /// Length of the log when it was opened.
    pub(super) len: u64,
    /// Layouts that a filtered read visits; `None` before the first after a rewind.
    pub(super) latched: Option<Vec<bool>>,
    /// The position of the next filtered read. Other reads and jumps move `offset` and not this one.
    pub(super) filtered_offset: u64,
    pub(super) messages: Py<PyDict>,
    /// The clock, if Python need not be asked for the time.
    pub(super) clock: Option<Py<MicrosClock>>,
}

/// A message that was read, and what is left to do with it.
pub(super) struct Taken {
    pub(super) message: DFMessage,
    /// Where its record starts.
    pub(super) offset: u64,
    /// Key of its instance in `messages`.
    pub(super) key: Option<Py<PyString>>,
    /// Its time is set.
    pub(super) stamped: bool,
    /// The reader's state changes with it.
    pub(super) tracked: bool,
}

impl State {
    pub(super) fn new(py: Python<'_>) -> Self {
        Self {
            log: None,
            kinds: Vec::new(),
            offset: 0,
            len: 0,
            latched: None,
            filtered_offset: 0,
            messages: PyDict::new(py).unbind(),
            clock: None,
        }
    }

    /// Reads the next record of the wanted layouts, and looks at no more than `budget` records. With `stamps` the native clock,
    /// if there is one, sets its time.
    pub(super) fn next(
        &mut self,
        owner: &Bound<'_, PyAny>,
        latched: bool,
        stamps: bool,
        mut budget: u32,
    ) -> PyResult<Step<Taken>> {
        let py = owner.py();
        let log = self.log.as_mut().ok_or_else(closed)?;
        let wanted = self.latched.as_ref().filter(|_| latched);
        let delimiter = log.delimiter();
        let at = if wanted.is_some() { &mut self.filtered_offset } else { &mut self.offset };
        let entry = match log.step(at, wanted.map(Vec::as_slice), &mut budget)? {
            Step::Found(entry) => entry,
            Step::Paused => return Ok(Step::Paused),
            Step::End => {
                self.offset = self.len;
                return Ok(Step::End);
            }
        };
        self.offset = entry.next;
        let bytes = log.bytes(entry);
        let kind = &mut self.kinds[entry.layout];
        let layout = &kind.names.layout;
        let message = DFMessage::read(
            Arc::clone(&kind.names),
            FrameBytes::from(bytes),
            delimiter,
            kind.format.clone_ref(py),
            owner.clone().unbind(),
        );
        let clock = self.clock.as_ref().filter(|_| stamps);
        if let Some(clock) = clock {
            let seconds = Record { layout, bytes, delimiter }.seconds();
            let unit = layout.time.map(|(_, unit)| unit);
            clock.get().stamp(&message.timestamp, seconds, unit);
        }
        let (key, stamped) = (kind.key(py, bytes, delimiter), clock.is_some());
        Ok(Step::Found(Taken {
            message,
            offset: entry.offset,
            key,
            stamped,
            tracked: kind.tracked,
        }))
    }
}

/// The error for reads from a closed log.
pub(super) fn closed() -> PyErr {
    pyo3::exceptions::PyValueError::new_err("the log is closed")
}
