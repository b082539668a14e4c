//! The clock of logs with `TimeUS`, kept where the reader can use it without calling Python.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Seconds: where the log's time begins, and the newest time.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct MicrosClock {
    timebase: AtomicU64,
    timestamp: AtomicU64,
}

impl MicrosClock {
    /// Takes in the time of a record, seconds since start, and returns the time of a message; without one it is that of
    /// the message before.
    #[inline]
    pub(crate) fn stamp(&self, seconds: Option<f64>) -> f64 {
        let Some(seconds) = seconds else { return f64::from_bits(self.timestamp.load(Relaxed)) };
        let time = f64::from_bits(self.timebase.load(Relaxed)) + seconds;
        self.timestamp.store(time.to_bits(), Relaxed);
        time
    }
}

#[pymethods]
impl MicrosClock {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self { timebase: AtomicU64::new(0), timestamp: AtomicU64::new(0) }
    }

    /// Unix time of the log's start.
    #[getter]
    fn timebase(&self) -> f64 {
        f64::from_bits(self.timebase.load(Relaxed))
    }

    #[setter(timebase)]
    fn set_timebase_seconds(&self, seconds: f64) {
        self.timebase.store(seconds.to_bits(), Relaxed);
    }

    /// Time of the newest message that had one.
    #[getter]
    fn timestamp(&self) -> f64 {
        f64::from_bits(self.timestamp.load(Relaxed))
    }

    #[setter]
    fn set_timestamp(&self, seconds: f64) {
        self.timestamp.store(seconds.to_bits(), Relaxed);
    }
}
