//! The next message of a log, with everything it changes.
//!
//! Nearly every record is a good frame of a known message from a known system: `next_plain` makes that message in one go,
//! with the link's lock taken once. Everything else goes the parser's way.

use std::sync::atomic::Ordering::Relaxed;

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::link::log_link::LogLink;
use crate::link::plain::{Interest, Plain, PlainFrame, makes_plain_messages};
use crate::link::tracking;
use crate::message::create;
use crate::message::object::Message;
use crate::protocol::mavlink::MAVLink;
use crate::protocol::parse;
use crate::protocol::parse::{Session, Step};
use crate::python::calling::Calling;
use crate::sync::shared;

impl LogLink {
    /// The next message; `None` at the end of the log.
    pub(crate) fn next_message<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Option<Bound<'py, Message>>> {
        Self::next_keeping(slf, true)
    }

    /// The same; without `params` for who does not ask the link for parameters.
    pub(crate) fn next_keeping<'py>(
        slf: &Bound<'py, Self>,
        keeps_params: bool,
    ) -> PyResult<Option<Bound<'py, Message>>> {
        if let Some(message) = Self::next_plain(slf, keeps_params)? {
            return Ok(Some(message));
        }
        let is_first = {
            let mut state = slf.as_super().get().state();
            state.percent = state.reader.as_ref().map_or(state.percent, |reader| reader.percent());
            state.first_byte
        };
        if is_first {
            Self::detect_version(slf)?;
        }
        let mav = Self::mav(slf)?;
        parse::obey_ignore_checksum(&mav)?;
        let step = Self::next_step(slf, &mav)?;
        let Some(message) = Session::new(&mav).take_step(step)? else { return Ok(None) };
        tracking::post(slf.as_super(), &message)?;
        Ok(Some(message))
    }

    /// The next message if it is of the usual kind; otherwise nothing is read.
    fn next_plain<'py>(
        slf: &Bound<'py, Self>,
        keeps_params: bool,
    ) -> PyResult<Option<Bound<'py, Message>>> {
        let py = slf.py();
        let link = slf.as_super();
        let mut guard = link.get().state();
        let state = &mut *guard;
        let has_hooks = state.has_hooks(py);
        let (Some(reader), Some(mav)) = (state.reader.as_mut(), state.native_mav.as_ref()) else {
            return Ok(None);
        };
        let native = mav.get();
        let dialect = native.dialect.get();
        let mut parser = native.parser();
        // While wrong checksums are ignored the module is asked for each record whether that holds still; else only for
        // those that are not good.
        let ignores = parser.scanner.ignore_checksum;
        if state.first_byte || ignores || !makes_plain_messages(native, &parser) {
            return Ok(None);
        }
        let percent = reader.percent();
        let Some(record) = reader.peek(&parser, &dialect.registry)? else { return Ok(None) };
        let Some(class) = dialect.known_class(record.index) else { return Ok(None) };
        let Some(frame) = PlainFrame::parse(record.stream, class.info) else { return Ok(None) };
        state.reception.record_time = Some(record.time);
        let known = (&mut state.senders, &mut state.reception);
        let interest = Interest { has_hooks, keeps_params };
        let plain = Plain::account(py, known, (native, &parser), &frame, &interest, record.time);
        let Some(plain) = plain else { return Ok(None) };

        let (info, class) = (class.info, class.class.bind(py));
        let posted = |message: Message| message.posted(plain.time, record.link);
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
    fn next_step(slf: &Bound<'_, Self>, mav: &Bound<'_, MAVLink>) -> PyResult<Step> {
        let native = mav.get();
        let mut guard = slf.as_super().get().state();
        let state = &mut *guard;
        let Some(reader) = state.reader.as_mut() else { return Ok(Step::Nothing) };
        let robust = native.robust_parsing.load(Relaxed);
        let (step, fed) = reader.next(&mut native.parser(), native.dialect.get(), robust)?;
        shared::add(&native.counters.bytes_received, fed as u64);
        state.reception.record_time = Some(reader.time);
        Ok(step)
    }

    /// Shows the first byte of the log's first frame to `auto_mavlink_version`.
    fn detect_version(slf: &Bound<'_, Self>) -> PyResult<()> {
        let first = Self::reader(slf, |reader| {
            if !reader.begin_record()? {
                return Ok(None);
            }
            Ok(reader.window.at(reader.offset, 1)?.first().copied())
        })?;
        if let Some(Some(first)) = first {
            Self::show_first_byte(slf, first)?;
        }
        Ok(())
    }

    pub(crate) fn show_first_byte(slf: &Bound<'_, Self>, first: u8) -> PyResult<()> {
        let py = slf.py();
        let byte = PyBytes::new(py, &[first]);
        slf.invoke_method1(intern!(py, "auto_mavlink_version"), (byte,))?;
        Ok(())
    }
}
