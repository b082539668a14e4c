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
use crate::python::calling::Calling;
use crate::sync::gil_yield::GilYield;

/// Messages that do not match between two looks whether other threads want the interpreter.
const TURN_INTERVAL: u64 = 256;

/// What a program asks `recv_match` for, `type` apart.
pub(crate) struct Request<'a, 'py> {
    pub(crate) condition: Option<&'a Bound<'py, PyAny>>,
    pub(crate) is_blocking: bool,
    /// Seconds.
    pub(crate) timeout: Option<f64>,
}

/// `link.recv_msg()`
#[inline(always)] // once for each message of a log
pub(crate) fn recv_msg<'py>(link: &Bound<'py, Link>) -> PyResult<Option<Bound<'py, PyAny>>> {
    if link.get().is_quick() {
        if let Some(message) = log_receive::next_plain(link)? {
            return Ok(Some(message.into_any()));
        }
        if link.get().state().reads_log() {
            return Ok(log_receive::next_parsed(link)?.map(Bound::into_any));
        }
        if let Ok(live) = link.cast::<LiveLink>()
            && let Some(message) = live_receive::next_message(live)?
        {
            return Ok(message.map(Bound::into_any));
        }
    }
    Ok(some(link.invoke_method0(intern!(link.py(), "_recv_by_methods"))?))
}

/// The same by the program's own `recv_msg`, if it has one.
#[inline(always)] // as above
pub(crate) fn next_message<'py>(link: &Bound<'py, Link>) -> PyResult<Option<Bound<'py, PyAny>>> {
    if link.get().is_quick() {
        recv_msg(link)
    } else {
        Ok(some(link.invoke_method0(intern!(link.py(), "recv_msg"))?))
    }
}

fn some(message: Bound<'_, PyAny>) -> Option<Bound<'_, PyAny>> {
    (!message.is_none()).then_some(message)
}

/// `link.recv_match(condition, types, blocking, timeout)`
pub(crate) fn recv_match<'py>(
    link: &Bound<'py, Link>,
    types: Option<&Bound<'py, PyAny>>,
    request: &Request<'_, 'py>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let wants_any = types.is_none() && request.condition.is_none() && !request.is_blocking;
    if wants_any && link.get().is_quick() {
        return recv_msg(link);
    }
    let log = types.and_then(|_| link.cast::<LogLink>().ok());
    let indexed = log.filter(|log| LogLink::is_indexed(log)).zip(types);
    let filter = Filter::new(types, indexed.is_some())?;
    let deadline = deadline_after(request.timeout);
    if request.is_blocking && live_receive::has_nothing_left(link) {
        wait(link, request.timeout, deadline)?;
    }
    let (mut seen, mut gil_yield): (u64, _) = (0, GilYield::new());
    loop {
        if let Some((log, types)) = indexed {
            skip_to_type(log, types)?;
        }
        let message = next_message(link)?;
        let is_idle = message.is_none();
        if let Some(message) = message {
            if filter.wants(&message)? && matches(link, &message, request.condition)? {
                return Ok(Some(message));
            }
            seen += 1;
            if seen.is_multiple_of(TURN_INTERVAL) {
                gil_yield.give_way(link.py())?;
            }
        } else if !request.is_blocking {
            return Ok(None);
        }
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return Ok(None);
        }
        if is_idle {
            wait(link, request.timeout, deadline)?;
        }
    }
}

/// When a timeout in seconds ends; `None` for one that is beyond counting.
fn deadline_after(timeout: Option<f64>) -> Option<Instant> {
    let wait = Duration::try_from_secs_f64(timeout?.max(0.0)).ok()?;
    Instant::now().checked_add(wait)
}

fn skip_to_type(log: &Bound<'_, LogLink>, types: &Bound<'_, PyAny>) -> PyResult<()> {
    if log.as_super().get().is_quick() {
        LogLink::advance(log, types)
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
