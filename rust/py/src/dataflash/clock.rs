//! Times of messages, and the clock of logs with `TimeUS`, kept where the reader can use it without calling Python.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use mavwire_core::log::dataflash::{self, TimeUnit};
use pyo3::prelude::*;
use pyo3::types::PyInt;

/// Unix time of a GPS week and the milliseconds in it.
#[pyfunction]
pub(crate) fn gps_time(week: f64, msec: f64) -> f64 {
    dataflash::gps_time(week, msec)
}

/// Seconds. A NaN that no arithmetic makes is no time yet. -0.0 is the int 0, the time of messages before the first time.
pub(crate) struct Seconds(AtomicU64);

const NOTHING: u64 = 0xFFF8_DEAD_0000_0000;
const INT_ZERO: u64 = (-0.0_f64).to_bits();

impl Seconds {
    pub(crate) const fn nothing() -> Self {
        Self(AtomicU64::new(NOTHING))
    }

    const fn int_zero() -> Self {
        Self(AtomicU64::new(INT_ZERO))
    }

    #[inline]
    pub(crate) fn set(&self, seconds: f64) {
        self.0.store(seconds.to_bits(), Relaxed);
    }

    /// Takes over what another one holds.
    #[inline]
    pub(crate) fn copy(&self, other: &Self) {
        self.0.store(other.0.load(Relaxed), Relaxed);
    }

    #[inline]
    fn number(&self) -> f64 {
        f64::from_bits(self.0.load(Relaxed))
    }

    /// The number as a Python object; `None` if nothing is set.
    pub(crate) fn object<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        match self.0.load(Relaxed) {
            NOTHING => None,
            INT_ZERO => Some(PyInt::new(py, 0_u8).into_any()),
            bits => Some(pyo3::types::PyFloat::new(py, f64::from_bits(bits)).into_any()),
        }
    }

    /// `TypeError` for what is no number.
    pub(crate) fn set_object(&self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let seconds: f64 = value.extract()?;
        if seconds == 0.0 && value.is_exact_instance_of::<PyInt>() {
            self.0.store(INT_ZERO, Relaxed);
        } else {
            self.set(seconds);
        }
        Ok(())
    }
}

impl Clone for Seconds {
    fn clone(&self) -> Self {
        Self(AtomicU64::new(self.0.load(Relaxed)))
    }
}

/// Seconds: where the log's time begins, and the newest time.
#[pyclass(frozen, subclass, module = "mavwire._native")]
pub(crate) struct MicrosClock {
    timebase: Seconds,
    timestamp: Seconds,
}

impl MicrosClock {
    /// Gives a message its time, from the seconds since start in its record; without those it is that of the message
    /// before. Only microseconds may go back; the milliseconds that some old types count are less sure.
    #[inline]
    pub(crate) fn stamp(&self, message: &Seconds, seconds: Option<f64>, unit: Option<TimeUnit>) {
        if let Some(seconds) = seconds {
            let time = self.timebase.number() + seconds;
            if unit == Some(TimeUnit::Micros) || time > self.timestamp.number() {
                self.timestamp.set(time);
            }
        }
        message.copy(&self.timestamp);
    }
}

new! {
    MicrosClock: |_cls| -> Self {
        Self { timebase: Seconds::int_zero(), timestamp: Seconds::int_zero() }
    }
}

#[pymethods]
impl MicrosClock {
    /// Unix time of the log's start.
    #[getter]
    fn timebase<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.timebase.object(py)
    }

    #[setter(timebase)]
    fn set_timebase_seconds(&self, seconds: Bound<'_, PyAny>) -> PyResult<()> {
        self.timebase.set_object(&seconds)
    }

    /// Time of the newest message that had one.
    #[getter]
    fn timestamp<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.timestamp.object(py)
    }

    #[setter]
    fn set_timestamp(&self, seconds: Bound<'_, PyAny>) -> PyResult<()> {
        self.timestamp.set_object(&seconds)
    }
}
