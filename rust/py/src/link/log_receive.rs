//! The next message of a log, with everything it changes.
//!
//! Nearly every record is a good frame of a known message from a known system: `next_plain` makes that message in one go,
//! with the link's lock taken once. Everything else goes the parser's way.

use std::sync::atomic::Ordering::Relaxed;

use mavwire_core::parser::Step;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::link::plain::{Plain, PlainFrame, makes_plain_messages};
use crate::link::state::Link;
use crate::link::tracking;
use crate::message::create;
use crate::message::object::Message;
use crate::protocol::mavlink::MAVLink;
use crate::protocol::parse;
use crate::protocol::parse::Session;
use crate::python::calling::Calling;
use crate::sync::shared;

/// The next message by the parser; `None` at the end of the log.
pub(crate) fn next_parsed<'py>(link: &Bound<'py, Link>) -> PyResult<Option<Bound<'py, Message>>> {
    let is_first = {
        let mut state = link.get().state();
        state.percent = state.reader.as_ref().map_or(state.percent, |reader| reader.percent());
        !state.knows_version
    };
    if is_first {
        detect_version(link)?;
    }
    let mav = link.get().mav(link.py())?;
    parse::obey_ignore_checksum(&mav)?;
    let step = next_step(link, &mav)?;
    let Some(message) = Session::new(&mav).take_step(step)? else { return Ok(None) };
    tracking::post(link, &message)?;
    Ok(Some(message))
}

/// The next message of a log if it is a plain one. Otherwise nothing is read.
pub(crate) fn next_plain<'py>(link: &Bound<'py, Link>) -> PyResult<Option<Bound<'py, Message>>> {
    let py = link.py();
    let mut guard = link.get().state();
    let state = &mut *guard;
    if !state.knows_version || state.is_recording() || state.has_own_parser() {
        return Ok(None);
    }
    let has_hooks = state.has_hooks(py);
    let (Some(reader), Some(mav)) = (state.reader.as_mut(), state.native_mav.as_ref()) else {
        return Ok(None);
    };
    let native = mav.get();
    let dialect = native.dialect.get();
    let mut parser = native.parser();
    // While wrong checksums are ignored the module is asked for each record whether that holds still; else only for
    // those that are not good.
    if parser.scanner.ignore_checksum || !makes_plain_messages(py, native) {
        return Ok(None);
    }
    let percent = reader.percent();
    // Looked at where it is: moving it would have to wait for it.
    let peeked = reader.peek(&parser, &dialect.registry);
    let record = match peeked {
        Ok(Some(ref record)) => record,
        Ok(None) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let Some(class) = dialect.known_class(record.index) else { return Ok(None) };
    let Some(frame) = PlainFrame::parse(record.stream, class.info) else { return Ok(None) };
    state.reception.record_time = Some(record.time);
    let known = (&mut state.systems, &mut state.reception);
    let plain = Plain::account(py, known, native, &frame, has_hooks, record.time);
    let Some(plain) = plain else { return Ok(None) };

    let (info, class) = (class.info, class.class.bind(py));
    let posted = |message: Message| message.stamped(plain.time, Some(record.link)).posted();
    let made = create::reused_frame(class, info, record.stream, record.len, posted);
    // Making a new object may run Python code, so that has to wait.
    let waiting = made
        .is_none()
        .then(|| (class.clone(), posted(create::around(info, &record.stream[..record.len]))));

    parser.passed(record.stream[0]);
    drop(parser);
    shared::add(&native.counters.bytes_received, record.len as u64);
    state.last_fresh = Some((frame.header.sysid, record.index));
    state.percent = percent;
    let (len, time, link_number) = (record.len, record.time, record.link);
    reader.accept(len, time, link_number);
    drop(guard);

    let message = match (made, waiting) {
        (Some(message), _) => message,
        (None, Some((class, message))) => create::pooled(&class, message)?,
        (None, None) => return Ok(None),
    };
    plain.deliver(link, &message)?;
    Ok(Some(message))
}

/// Reads on by the parser.
fn next_step(link: &Bound<'_, Link>, mav: &Bound<'_, MAVLink>) -> PyResult<Step> {
    let native = mav.get();
    let mut guard = link.get().state();
    let state = &mut *guard;
    let Some(reader) = state.reader.as_mut() else { return Ok(Step::Nothing) };
    let robust = native.robust_parsing.load(Relaxed);
    let (step, fed) = reader.next(&mut native.parser(), &native.dialect.get().registry, robust)?;
    shared::add(&native.counters.bytes_received, fed as u64);
    state.reception.record_time = Some(reader.time);
    Ok(step)
}

/// Shows the first byte of the log's first frame to `auto_mavlink_version`.
fn detect_version(link: &Bound<'_, Link>) -> PyResult<()> {
    let first = link.get().with_reader(|reader| {
        if !reader.begin_record()? {
            return Ok(None);
        }
        Ok(reader.window.at(reader.offset, 1)?.first().copied())
    })?;
    if let Some(Some(first)) = first {
        show_first_byte(link, first)?;
    }
    Ok(())
}

pub(crate) fn show_first_byte(link: &Bound<'_, Link>, first: u8) -> PyResult<()> {
    let py = link.py();
    let byte = PyBytes::new(py, &[first]);
    link.invoke_method1(intern!(py, "auto_mavlink_version"), (byte,))?;
    Ok(())
}
