//! Receiving from a live link by the batch, for loops that are told when there is something to read.

use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::link::live_link::LiveLink;
use crate::link::{live_receive, receive};

/// Appends to `messages` what `link` has received, `limit` messages at most, and says whether there may be more.
///
/// An error is raised with the messages before it in the list. Where a read took everything the socket held, no other
/// read is tried: the event loop that watches the descriptor is told about the next bytes.
#[pyfunction]
pub(crate) fn receive_batch(
    link: &Bound<'_, LiveLink>,
    messages: &Bound<'_, PyList>,
    limit: usize,
) -> PyResult<bool> {
    let base = link.as_super();
    for _ in 0..limit {
        let Some(message) = receive::next_message(base)? else { return Ok(false) };
        messages.append(message)?;
        if live_receive::has_nothing_left(base) {
            return Ok(false);
        }
    }
    Ok(true)
}
