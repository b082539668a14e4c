//! What is missing between the messages of a log, by the gaps in the sequence numbers of each sender.

use std::collections::HashMap;

use mavwire_core::sequence::SequenceTracker;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};

use crate::message::info::Info;
use crate::message::object::Message;
use crate::sync::lock::Lock;

/// Messages from one component, all of them or those of one type.
struct Kind {
    sysid: u8,
    compid: u8,
    name: Option<&'static Py<PyString>>,
    seen: u64,
    /// Gaps that were noticed by such a message, and the messages missing in them.
    gaps: u64,
    lost: u64,
    /// How many messages of all kinds were seen up to the first of these gaps; 0 if there is none.
    first_gap: u64,
}

/// `(sysid, compid, type, seen, gaps, lost, first_gap)`
type Row = (u8, u8, Option<&'static Py<PyString>>, u64, u64, u64, u64);

struct Counts {
    by_type: bool,
    tracker: SequenceTracker,
    seen: u64,
    /// In the order in which they were first seen.
    kinds: Vec<Kind>,
    /// Where a sender's message of an id stands in `kinds`; the id is 0 for all where types do not matter.
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
        let id = if self.by_type { info.definition.id } else { 0 };
        let place = *self.places.entry((sysid, compid, id)).or_insert(next);
        if place == next {
            let name = self.by_type.then_some(&info.name);
            self.kinds.push(Kind { sysid, compid, name, seen: 0, gaps: 0, lost: 0, first_gap: 0 });
        }
        &mut self.kinds[place]
    }
}

/// Counts messages and the gaps before them, of each component, or of its types apart.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct SequenceGaps(Lock<Counts>);

#[pymethods]
impl SequenceGaps {
    #[new]
    fn new(by_type: bool) -> Self {
        Self(Lock::new(Counts {
            by_type,
            tracker: SequenceTracker::new(),
            seen: 0,
            kinds: Vec::new(),
            places: HashMap::new(),
        }))
    }

    /// Counts messages in the order in which they came. Gives those that it does not know: BAD_DATA
    /// and UNKNOWN.
    fn read<'py>(&self, messages: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyList>> {
        let py = messages.py();
        let others = PyList::empty(py);
        for msg in messages.try_iter()? {
            let msg = msg?;
            if !msg.cast::<Message>().is_ok_and(|msg| self.0.lock(py).count(msg.get())) {
                others.append(msg)?;
            }
        }
        Ok(others)
    }

    /// `(sysid, compid, type, seen, gaps, lost, first_gap)` for each component, type `None`, or its messages of a type,
    /// in the order in which they were first seen. `gaps` were noticed by such a message, `lost` are missing
    /// in them, `first_gap` grows with the place of the first one in the log and is 0 if there is none.
    fn rows(&self, py: Python<'_>) -> Vec<Row> {
        let row = |kind: &Kind| {
            let &Kind { sysid, compid, name, seen, gaps, lost, first_gap } = kind;
            (sysid, compid, name, seen, gaps, lost, first_gap)
        };
        self.0.lock(py).kinds.iter().map(row).collect()
    }
}
