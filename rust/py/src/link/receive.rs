//! Receiving: one way for logs, for live links and for links that a program reads itself.
//!
//! Native code reads as long as no program replaced one of the methods that it skips. Python's `_recv_by_methods`
//! does the rest: it calls these methods, and `post_message` for the same accounting.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

use crate::link::filter::Filter;
use crate::link::live_link::LiveLink;
use crate::link::live_receive;
use crate::link::log_link::LogLink;
use crate::link::log_receive;
use crate::link::state::Link;
use crate::python::calling::{Calling, truth};
use crate::sync::gil_yield::GilYield;

/// Messages that do not match between two looks whether other threads want the interpreter.
const TURN_INTERVAL: u64 = 256;

#[pymethods]
impl Link {
    /// The next message, BAD_DATA and UNKNOWN included; None when nothing has arrived, and at the end of a log.
    #[inline(always)] // once for each message of a log
    fn recv_msg<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        if slf.get().is_quick() {
            if let Some(message) = log_receive::next_plain(slf)? {
                return Ok(Some(message.into_any()));
            }
            if slf.get().state().reads_log() {
                return Ok(log_receive::next_parsed(slf)?.map(Bound::into_any));
            }
            if let Ok(live) = slf.cast::<LiveLink>()
                && let Some(message) = live_receive::next_message(live)?
            {
                return Ok(message.map(Bound::into_any));
            }
        }
        Ok(some(slf.invoke_method0(intern!(slf.py(), "_recv_by_methods"))?))
    }

    /// The next message of a `type` (name, list or set) for which `condition` holds.
    ///
    /// Messages that do not match are consumed, but have updated the state. Returns None when nothing is there, or when
    /// blocking, after `timeout` seconds. An indexed log is read only where messages of the wanted types, heartbeats and
    /// parameters are.
    #[pyo3(signature = (condition = None, r#type = None, blocking = false, timeout = None))]
    fn recv_match<'py>(
        slf: &Bound<'py, Self>,
        condition: Option<&Bound<'py, PyAny>>,
        r#type: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = truth)] blocking: bool,
        timeout: Option<f64>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        if r#type.is_none() && condition.is_none() && !blocking && slf.get().is_quick() {
            return Self::recv_msg(slf);
        }
        let log = r#type.and_then(|_| slf.cast::<LogLink>().ok());
        let indexed = log.filter(|log| LogLink::is_indexed(log)).zip(r#type);
        let filter = Filter::new(r#type, indexed.is_some())?;
        let deadline = deadline_after(timeout);
        if blocking && live_receive::has_nothing_left(slf) {
            wait(slf, timeout, deadline)?;
        }
        let (mut seen, mut gil_yield): (u64, _) = (0, GilYield::new());
        loop {
            if let Some((log, types)) = indexed {
                skip_to_type(log, types)?;
            }
            let message = next_message(slf)?;
            let is_idle = message.is_none();
            if let Some(message) = message {
                if filter.wants(&message)? && matches(slf, &message, condition)? {
                    return Ok(Some(message));
                }
                seen += 1;
                if seen.is_multiple_of(TURN_INTERVAL) {
                    gil_yield.give_way(slf.py())?;
                }
            } else if !blocking {
                return Ok(None);
            }
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return Ok(None);
            }
            if is_idle {
                wait(slf, timeout, deadline)?;
            }
        }
    }
}

/// The same by the program's own `recv_msg`, if it has one.
#[inline(always)] // as above
pub(crate) fn next_message<'py>(link: &Bound<'py, Link>) -> PyResult<Option<Bound<'py, PyAny>>> {
    if link.get().is_quick() {
        Link::recv_msg(link)
    } else {
        Ok(some(link.invoke_method0(intern!(link.py(), "recv_msg"))?))
    }
}

fn some(message: Bound<'_, PyAny>) -> Option<Bound<'_, PyAny>> {
    (!message.is_none()).then_some(message)
}

/// When a timeout in seconds ends; `None` for one that is beyond counting.
fn deadline_after(timeout: Option<f64>) -> Option<Instant> {
    let wait = Duration::try_from_secs_f64(timeout?.max(0.0)).ok()?;
    Instant::now().checked_add(wait)
}

fn skip_to_type(log: &Bound<'_, LogLink>, types: &Bound<'_, PyAny>) -> PyResult<()> {
    if log.as_super().get().is_quick() {
        LogLink::skip_to_type(log, types)
    } else {
        log.invoke_method1(intern!(log.py(), "skip_to_type"), (types,)).map(drop)
    }
}

/// Whether the sender of `message` is known and `condition` holds for its messages.
fn matches(
    link: &Bound<'_, Link>,
    message: &Bound<'_, PyAny>,
    condition: Option<&Bound<'_, PyAny>>,
) -> PyResult<bool> {
    if condition.is_none() && link.get().is_quick() {
        return Ok(true);
    }
    link.invoke_method1(intern!(link.py(), "_matches"), (message, condition))?.is_truthy()
}

/// Waits until data may be there, `deadline` has come or the idle hooks are due.
fn wait(link: &Bound<'_, Link>, timeout: Option<f64>, deadline: Option<Instant>) -> PyResult<()> {
    let remaining = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
    if let Ok(live) = link.cast::<LiveLink>()
        && link.get().is_quick()
        && live_receive::wait(live, remaining)?
    {
        return Ok(());
    }
    let remaining = remaining.map(|remaining| remaining.as_secs_f64());
    link.invoke_method1(intern!(link.py(), "_idle"), (timeout, remaining)).map(drop)
}
