//! What a reader keeps: the log, where it stands, which types are wanted, the newest messages.

use std::collections::HashMap;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use super::clock::MicrosClock;
use super::message::DFMessage;
use super::shape::Names;
use mavwire_core::frame::FrameBytes;
use mavwire_io::dataflash_log::{self, DataflashLog, Step};

/// Keys of instances that are remembered for a type; more are spelled anew each time.
const MAX_KEYS: usize = 4096;

/// A record type of the log.
pub(super) struct Kind {
    pub(super) names: Arc<Names>,
    /// The `DFFormat`.
    pub(super) format: Py<PyAny>,
    /// Index of the field that tells instances apart.
    pub(super) instance: Option<usize>,
    /// The reader's state changes with messages of this type.
    pub(super) tracked: bool,
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

    /// Stored bytes of the instance field of a binary record.
    fn instance_bytes<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let field = self.names.layout.fields.get(self.instance?)?;
        let start = usize::from(field.offset);
        bytes.get(start..start + field.kind.size())
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
    /// Index of its kind.
    pub(super) kind: usize,
    /// Key of its instance in `messages`; `Err` if that has to be made of the field's value.
    pub(super) key: Option<Result<Py<PyString>, Box<[u8]>>>,
    /// Its time is set.
    pub(super) stamped: bool,
}

/// How a search ended.
pub(super) enum Search {
    Found(Taken),
    /// Enough was looked at for once.
    Paused,
    End,
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
    ) -> PyResult<Search> {
        let py = owner.py();
        let log = self.log.as_mut().ok_or_else(closed)?;
        let wanted = self.latched.as_ref().filter(|_| latched);
        let delimiter = log.delimiter();
        let at = if wanted.is_some() { &mut self.filtered_offset } else { &mut self.offset };
        let entry = match log.step(at, wanted.map(Vec::as_slice), &mut budget)? {
            Step::Found(entry) => entry,
            Step::Paused => return Ok(Search::Paused),
            Step::End => {
                self.offset = self.len;
                return Ok(Search::End);
            }
        };
        self.offset = entry.next;
        let bytes = log.bytes(entry);
        let kind = &self.kinds[entry.layout];
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
            let seconds = dataflash_log::seconds(layout, bytes, delimiter);
            let unit = layout.time.map(|(_, unit)| unit);
            clock.get().stamp(&message.timestamp, seconds, unit);
        }
        let key = kind.instance.map(|_| {
            let bytes = kind.instance_bytes(bytes).filter(|_| delimiter.is_none());
            let known = bytes.and_then(|bytes| kind.keys.get(bytes));
            known.map(|key| key.clone_ref(py)).ok_or_else(|| bytes.unwrap_or_default().into())
        });
        let stamped = clock.is_some();
        Ok(Search::Found(Taken { message, kind: entry.layout, key, stamped }))
    }

    /// Remembers the key of an instance.
    pub(super) fn remember_key(&mut self, kind: usize, bytes: Box<[u8]>, key: Py<PyString>) {
        if let Some(kind) = self.kinds.get_mut(kind)
            && !bytes.is_empty()
            && kind.keys.len() < MAX_KEYS
        {
            kind.keys.insert(bytes, key);
        }
    }
}

/// The error for reads from a closed log.
pub(super) fn closed() -> PyErr {
    pyo3::exceptions::PyValueError::new_err("the log is closed")
}
