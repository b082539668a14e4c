//! Receiving from a live link natively: waiting, reading, and a message with all that it changes.

use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

use mavwire_core::parser::Step;
use mavwire_io::address::Address;
use mavwire_io::readiness;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::link::live_link::LiveLink;
use crate::link::plain::{Plain, PlainFrame, makes_plain_messages};
use crate::link::replaced;
use crate::link::state::Link;
use crate::link::tracking;
use crate::message::create;
use crate::message::object::{Message, Origin, flags, payload_of};
use crate::protocol::mavlink::MAVLink;
use crate::protocol::parse::{self, Session};
use crate::python::calling::Calling;
use crate::sync::shared;
use mavwire_core::frame::FrameBytes;
use mavwire_io::live_source::Arrived;

/// Reads per call without a message coming out of them: a peer that sends garbage faster than it is read must not keep a
/// caller from looking at its timeout.
const READS_PER_CALL: usize = 64;
/// How long one wait may last before the user's signals are looked at: those that another thread received end no wait.
const WAIT_SLICE: Duration = Duration::from_millis(200);
/// How often an idle link does what Python has to do for it.
const HOUSEKEEPING_INTERVAL: Duration = Duration::from_secs(1);

/// A plain message, ready to be made.
struct Fresh<'py> {
    plain: Plain<'py>,
    index: u16,
    bytes: FrameBytes,
    /// It is to be recorded.
    is_recorded: bool,
    /// Its peer, if that is to be announced.
    news: Option<Address>,
}

enum Scanned<'py> {
    Nothing,
    Fresh(Fresh<'py>),
    /// With the peer it came from.
    Other(Step, Option<Address>),
}

/// The next message or that there is none; `None` if Python has to look for it.
#[allow(clippy::option_option)] // two questions, two answers
pub(crate) fn next_message<'py>(
    slf: &Bound<'py, LiveLink>,
) -> PyResult<Option<Option<Bound<'py, Message>>>> {
    if !LiveLink::is_quick(slf) {
        return Ok(None);
    }
    let received = next_received(slf);
    // Garbage does not show that the client is alive.
    if match &received {
        Ok(Some(Some(message))) => message.get().origin == Origin::Bad,
        Ok(Some(None)) | Err(_) => true,
        Ok(None) => false,
    } {
        drop_silent_client(slf)?;
    }
    received
}

#[allow(clippy::option_option)] // as above
fn next_received<'py>(slf: &Bound<'py, LiveLink>) -> PyResult<Option<Option<Bound<'py, Message>>>> {
    let Some(mav) = native_mav(slf) else { return Ok(None) };
    for _ in 0..READS_PER_CALL {
        // The time may come from Python code, which must not run while a lock is held.
        match scan(slf, &mav, replaced::now(slf.py())?) {
            Scanned::Fresh(fresh) => return deliver(slf, &mav, fresh).map(Some).map(Some),
            Scanned::Other(step, from) => {
                if let Some(message) = deliver_other(slf, &mav, step, from)? {
                    return Ok(Some(Some(message)));
                }
            }
            Scanned::Nothing => match fill(slf, &mav)? {
                Arrived::Data(_) => {}
                Arrived::Nothing => return Ok(Some(None)),
                Arrived::Trouble => return Ok(None),
            },
        }
    }
    Ok(Some(None))
}

/// Now and then lets Python see whether somebody waits for a client that says nothing sensible.
fn drop_silent_client(slf: &Bound<'_, LiveLink>) -> PyResult<()> {
    if slf.get().source().is_housekeeping_due(Instant::now(), HOUSEKEEPING_INTERVAL) {
        slf.invoke_method0(intern!(slf.py(), "_drop_silent_client"))?;
    }
    Ok(())
}

/// Waiting is better than reading `link` again: the last read emptied its socket, and nothing of it is left.
pub(crate) fn has_nothing_left(link: &Bound<'_, Link>) -> bool {
    link.get().is_quick() && link.cast::<LiveLink>().is_ok_and(LiveLink::is_drained)
}

/// Waits natively until data may be there or `remaining` is over. Returns false, without having waited, if Python has to
/// wait: for idle hooks, or without a descriptor.
pub(crate) fn wait(slf: &Bound<'_, LiveLink>, remaining: Option<Duration>) -> PyResult<bool> {
    let py = slf.py();
    let hooks = slf.getattr(intern!(py, "idle_hooks"))?;
    let has_hooks = hooks.cast::<PyList>().map_or(true, |hooks| !hooks.is_empty());
    let fd = slf.getattr(intern!(py, "fd"))?.extract::<i32>().ok();
    let Some(fd) = fd.filter(|_| !has_hooks) else { return Ok(false) };
    let slice = remaining.map_or(WAIT_SLICE, |remaining| remaining.min(WAIT_SLICE));
    let writable = slf.get().has_unsent(py);
    let ready = if slice.is_zero() {
        readiness::ready(fd, writable, slice)
    } else {
        py.detach(|| readiness::ready(fd, writable, slice))
    };
    py.check_signals()?;
    match ready {
        // The next read says whether there is anything.
        Ok(true) => slf.get().source().drained = false,
        Err(error) if error.kind() != std::io::ErrorKind::Interrupted => {
            slf.get().source().drained = false;
            py.detach(|| std::thread::sleep(slice.min(Duration::from_millis(10))));
        }
        _ => {}
    }
    Ok(true)
}

fn native_mav<'py>(slf: &Bound<'py, LiveLink>) -> Option<Bound<'py, MAVLink>> {
    slf.as_super().get().state().native_mav.as_ref().map(|mav| mav.bind(slf.py()).clone())
}

fn fill(slf: &Bound<'_, LiveLink>, mav: &Bound<'_, MAVLink>) -> PyResult<Arrived> {
    parse::obey_ignore_checksum(mav)?;
    // Last, so that no Python code runs before the read: another thread could close the descriptor, and a third open one
    // of the same number.
    let Some(fd) = LiveLink::descriptor(slf) else { return Ok(Arrived::Trouble) };
    let arrived = slf.get().source().fill(fd, &mut mav.get().parser());
    if let Arrived::Data(bytes) = arrived {
        shared::add(&mav.get().counters.bytes_received, bytes as u64);
    }
    Ok(arrived)
}

/// Looks at what was received, with one lock of the link, its source and the parser.
fn scan<'py>(slf: &Bound<'py, LiveLink>, mav: &Bound<'py, MAVLink>, now: f64) -> Scanned<'py> {
    let py = slf.py();
    let native = mav.get();
    let mut guard = slf.as_super().get().state();
    let state = &mut *guard;
    let mut source = slf.get().source();
    let has_hooks = state.has_hooks(py);
    let mut parser = native.parser();
    let robust = native.robust_parsing.load(Relaxed);
    let (step, used) = source.next(&mut parser, &native.dialect.get().registry, robust);
    shared::add(&native.counters.bytes_received, used as u64);
    let Step::Frame { bytes, header, entry: Some(entry) } = step else {
        return match step {
            Step::Nothing => Scanned::Nothing,
            step => Scanned::Other(step, source.sender()),
        };
    };
    let class = native.dialect.get().known_class(entry.index);
    let plain = class.filter(|_| makes_plain_messages(py, native)).and_then(|class| {
        let frame = PlainFrame { header, info: class.info, payload: payload_of(&bytes) };
        let known = (&mut state.systems, &mut state.reception);
        Plain::account(py, known, native, &frame, has_hooks, now)
    });
    let Some(plain) = plain else {
        return Scanned::Other(Step::Frame { bytes, header, entry: Some(entry) }, source.sender());
    };
    let from = source.sender();
    let news = source.news(from, true, now);
    let is_recorded = state.logfile.is_some();
    Scanned::Fresh(Fresh { plain, index: entry.index, bytes, is_recorded, news })
}

fn deliver<'py>(
    slf: &Bound<'py, LiveLink>,
    mav: &Bound<'py, MAVLink>,
    fresh: Fresh<'py>,
) -> PyResult<Bound<'py, Message>> {
    let Fresh { plain, index, bytes, is_recorded, news } = fresh;
    let class = mav.get().dialect.get().class(slf.py(), index)?;
    if let Some(from) = news {
        LiveLink::announce(slf, from, true, class.info.is_targeted(payload_of(&bytes)))?;
    }
    let message = Message::received(Some(class.info), bytes, Origin::Decoded);
    let message = message.stamped(plain.time, None).posted();
    let message = create::pooled(class.class.bind(slf.py()), message)?;
    if is_recorded {
        slf.invoke_method1(intern!(slf.py(), "_record"), (&message,))?;
    }
    plain.deliver(slf.as_super(), &message)?;
    Ok(message)
}

/// Delivers all but plain messages.
fn deliver_other<'py>(
    slf: &Bound<'py, LiveLink>,
    mav: &Bound<'py, MAVLink>,
    step: Step,
    from: Option<Address>,
) -> PyResult<Option<Bound<'py, Message>>> {
    let Some(message) = Session::new(mav).take_step(step)? else { return Ok(None) };
    // With a key, what a callback let pass does not say who is there.
    let is_good = !matches!(message.get().origin, Origin::Bad | Origin::Unknown)
        && (message.get().has(flags::SIGNED) || !mav.get().checks_signatures(slf.py()));
    let news = slf.get().source().news(from, is_good, replaced::now(slf.py())?);
    if let Some(from) = news {
        let Message { info, frame, .. } = message.get();
        let is_targeted = is_good && info.is_some_and(|info| info.is_targeted(payload_of(frame)));
        LiveLink::announce(slf, from, is_good, is_targeted)?;
    }
    if slf.as_super().get().state().logfile.is_some() {
        slf.invoke_method1(intern!(slf.py(), "_record"), (&message,))?;
    }
    tracking::post(slf.as_super(), &message)?;
    Ok(Some(message))
}
