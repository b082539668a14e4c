//! Pauses of long runs of native code, for signal handlers and other threads.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Time between two pauses: twice Python's switch interval. A thread asks for the interpreter's lock when it has waited for an
/// interval in which no thread let go of it, and waits anew otherwise.
const INTERVAL: Duration = Duration::from_millis(10);

/// The pauses of one run.
pub(crate) struct GilYield {
    /// The first call since the last pause.
    last: Option<Instant>,
}

impl GilYield {
    pub(crate) const fn new() -> Self {
        Self { last: None }
    }

    /// Lets signal handlers run, and other threads if it is time. To be called every few milliseconds, with no lock held.
    ///
    /// # Errors
    /// Those of the signal handlers, such as `KeyboardInterrupt`.
    pub(crate) fn give_way(&mut self, py: Python<'_>) -> PyResult<()> {
        if self.last.get_or_insert_with(Instant::now).elapsed() >= INTERVAL {
            py.detach(|| ());
            self.last = None;
        }
        py.check_signals()
    }
}
