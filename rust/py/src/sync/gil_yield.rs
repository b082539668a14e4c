//! What long runs of native code owe to everyone else.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

use crate::python::calling::Calling;

/// The turns that one run gives to others.
///
/// A thread that wants the interpreter asks for it when it has waited for a whole switch interval
/// (`sys.setswitchinterval`) in which nobody let go of it; only then does who lets go wait until it was taken. Letting go
/// more often makes waiting threads start anew each time, and they may never have a turn.
pub(crate) struct GilYield {
    /// When the last turn ended, or the run was seen first.
    last: Option<Instant>,
    interval: Duration,
}

impl GilYield {
    pub(crate) const fn new() -> Self {
        Self { last: None, interval: Duration::ZERO }
    }

    /// Lets signal handlers run, and other threads if it is time. To be called every few milliseconds, with no lock held.
    ///
    /// # Errors
    /// Those of the signal handlers, such as `KeyboardInterrupt`.
    pub(crate) fn give_way(&mut self, py: Python<'_>) -> PyResult<()> {
        match self.last {
            None => {
                self.interval = switch_interval(py)?.saturating_mul(2);
                self.last = Some(Instant::now());
            }
            Some(last) if last.elapsed() >= self.interval => {
                py.detach(|| ());
                self.last = Some(Instant::now());
            }
            Some(_) => {}
        }
        py.check_signals()
    }
}

/// How long a thread waits until it asks for the interpreter.
fn switch_interval(py: Python<'_>) -> PyResult<Duration> {
    let sys = py.import(intern!(py, "sys"))?;
    let seconds: f64 = sys.invoke_method0(intern!(py, "getswitchinterval"))?.extract()?;
    Ok(Duration::try_from_secs_f64(seconds).unwrap_or_default())
}
