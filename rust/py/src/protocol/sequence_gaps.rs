//! `SequenceGaps`: what is missing between the messages of a log. See `mavwire_core::sequence`.

use mavwire_core::sequence::{GapCount, GapCounts};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};

use crate::message::info::Info;
use crate::message::object::Message;
use crate::sync::lock::Lock;

/// `(sysid, compid, type, seen, gaps, lost, first_gap)`
type Row = (u8, u8, Option<&'static Py<PyString>>, u64, u64, u64, u64);

struct Counts {
    gaps: GapCounts,
    /// The definition of the first message of each count.
    infos: Vec<&'static Info>,
}

impl Counts {
    /// False if it is no message of a known type.
    fn count(&mut self, msg: &Message) -> bool {
        let (Some(info), Some(header)) = (msg.info, msg.header()) else { return false };
        let kinds = self.gaps.counts().len();
        self.gaps.count(&header);
        if self.gaps.counts().len() > kinds {
            self.infos.push(info);
        }
        true
    }
}

/// Counts messages and the gaps before them, of each component, or of its types apart.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct SequenceGaps(Lock<Counts>);

#[pymethods]
impl SequenceGaps {
    #[new]
    fn new(by_type: bool) -> Self {
        Self(Lock::new(Counts { gaps: GapCounts::new(by_type), infos: Vec::new() }))
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
        let counts = self.0.lock(py);
        let row = |(count, info): (&GapCount, &&'static Info)| {
            let name = count.msgid.map(|_| &info.name);
            (count.sysid, count.compid, name, count.seen, count.gaps, count.lost, count.first_gap)
        };
        counts.gaps.counts().iter().zip(&counts.infos).map(row).collect()
    }
}
