//! Receiving from a live link by the batch, for loops that are told when there is something to read.

use std::sync::atomic::Ordering::Relaxed;

use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::link::live_link::LiveLink;
use crate::python::calling::Calling;

/// Appends to `messages` what `link` has received, `limit` messages at most, and says whether there may be more.
///
/// An error is raised with the messages before it in the list. Where a read took everything the socket held, no other
/// read is tried: whoever watches the descriptor is told about what comes next.
#[pyfunction]
pub(crate) fn receive_batch(
    link: &Bound<'_, LiveLink>,
    messages: &Bound<'_, PyList>,
    limit: usize,
) -> PyResult<bool> {
    let py = link.py();
    for _ in 0..limit {
        if link.get().quick.load(Relaxed) {
            let Some(message) = LiveLink::next_message(link)? else { return Ok(false) };
            messages.append(message)?;
            if LiveLink::is_drained(link) {
                return Ok(false);
            }
        } else {
            let message = link.invoke_method0(intern!(py, "recv_msg"))?;
            if message.is_none() {
                return Ok(false);
            }
            messages.append(message)?;
        }
    }
    Ok(true)
}
