//! What is missing between the messages of a log, by the gaps in the sequence numbers of each sender.

use std::collections::HashMap;

use mavwire_core::sequence::SequenceTracker;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};

use crate::calling::Calling;
use crate::info::Info;
use crate::lock::Lock;
use crate::message::Message;

/// Messages of one type from one component.
struct Kind {
    sysid: u8,
    compid: u8,
    name: &'static Py<PyString>,
    seen: u64,
    /// Gaps that were noticed by such a message, and the messages missing in them.
    gaps: u64,
    lost: u64,
    /// How many messages of all kinds were seen up to the first of these gaps; 0 if there is none.
    first_gap: u64,
}

/// `(sysid, compid, type, seen, gaps, lost, first_gap)`
type Row = (u8, u8, &'static Py<PyString>, u64, u64, u64, u64);

#[derive(Default)]
struct Counts {
    tracker: SequenceTracker,
    seen: u64,
    /// In the order in which they were first seen.
    kinds: Vec<Kind>,
    /// Where a sender's message of an id stands in `kinds`.
    places: HashMap<(u8, u8, u32), usize>,
}

impl Counts {
    /// False if it is no message of a known type.
    fn count(&mut self, msg: &Message) -> bool {
        let (Some(info), Some(header)) = (msg.info, msg.header()) else { return false };
        let lost = self.tracker.observe(header.sysid, header.compid, header.seq);
        self.seen += 1;
        let seen = self.seen;
        let kind = self.kind(header.sysid, header.compid, info);
        kind.seen += 1;
        if lost > 0 {
            kind.gaps += 1;
            kind.lost += u64::from(lost);
            if kind.first_gap == 0 {
                kind.first_gap = seen;
            }
        }
        true
    }

    fn kind(&mut self, sysid: u8, compid: u8, info: &'static Info) -> &mut Kind {
        let next = self.kinds.len();
        let place = *self.places.entry((sysid, compid, info.definition.id)).or_insert(next);
        if place == next {
            let name = &info.name;
            self.kinds.push(Kind { sysid, compid, name, seen: 0, gaps: 0, lost: 0, first_gap: 0 });
        }
        &mut self.kinds[place]
    }
}

/// Counts messages and the gaps before them.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct SequenceGaps(Lock<Counts>);

#[pymethods]
impl SequenceGaps {
    #[new]
    fn new() -> Self {
        Self(Lock::new(Counts::default()))
    }

    /// Counts messages in the order in which they came. Gives those that it does not know: BAD_DATA
    /// and UNKNOWN.
    fn read<'py>(&self, messages: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyList>> {
        let py = messages.py();
        let others = PyList::empty(py);
        for msg in messages.items()? {
            let msg = msg?;
            if !msg.cast::<Message>().is_ok_and(|msg| self.0.lock(py).count(msg.get())) {
                others.append(msg)?;
            }
        }
        Ok(others)
    }

    /// `(sysid, compid, type, seen, gaps, lost, first_gap)` for each component's messages of a type, in
    /// the order in which they were first seen. `gaps` were noticed by such a message, `lost` are missing
    /// in them, `first_gap` grows with the place of the first one in the log and is 0 if there is none.
    fn rows(&self, py: Python<'_>) -> Vec<Row> {
        let row = |kind: &Kind| {
            let &Kind { sysid, compid, name, seen, gaps, lost, first_gap } = kind;
            (sysid, compid, name, seen, gaps, lost, first_gap)
        };
        self.0.lock(py).kinds.iter().map(row).collect()
    }
}
