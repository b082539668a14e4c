//! What long runs of native code owe to everyone else.

use pyo3::prelude::*;

/// Lets other threads have a turn, and the handlers of signals. To be called every few milliseconds, with no lock held.
///
/// # Errors
/// Those of the signal handlers, such as `KeyboardInterrupt`.
pub(crate) fn give_way(py: Python<'_>) -> PyResult<()> {
    py.detach(|| ());
    py.check_signals()
}
