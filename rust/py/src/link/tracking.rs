//! The changes that every received message makes: newest messages, loss counts, times.
//!
//! Rare updates (flight modes, home) are left to Python's `_update`, which is called for the few message
//! types that need it.

use std::sync::atomic::Ordering::Relaxed;

use mavwire_core::telemetry::RADIO;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::link::instances;
use crate::link::message_source::{message_type, sender_of};
use crate::link::params;
use crate::link::replaced;
use crate::link::state::Link;
use crate::link::system::SystemState;
use crate::message::info::PARAM_VALUE;
use crate::message::object::{Message, flags};
use crate::python::calling::Calling;
use crate::python::instance_dict::instance_dict;

/// Takes a message into the link's state, once. A log notes its number of the link, and that it was the last one.
pub(crate) fn post(link: &Bound<'_, Link>, message: &Bound<'_, Message>) -> PyResult<()> {
    let link_number = link.get().state().end_record(message.get());
    account(link, message)?;
    if let Some(number) = link_number {
        message.get().link.store(number, Relaxed);
        message.get().set(flags::LINK);
        link.get().state().last_fresh = None;
        link.get().replace(Some(message.clone().unbind()), |state| &mut state.last);
    }
    Ok(())
}

fn account(link: &Bound<'_, Link>, message: &Bound<'_, Message>) -> PyResult<()> {
    let this = message.get();
    if this.has(flags::POSTED) || (this.has(flags::DICT) && is_posted(message)?) {
        return Ok(());
    }
    this.set(flags::POSTED);
    let py = link.py();
    let kind = message_type(message)?;
    let (source, counts) = sender_of(message)?;
    let uptime = uptime_of(message)?;
    let now = replaced::now(py)?;
    let seconds = link.get().state().reception.account(counts.then_some(source), uptime, now);
    if this.has(flags::TIMESTAMP_IN_DICT) {
        message.setattr(intern!(py, "_timestamp"), seconds)?;
    } else {
        this.set_timestamp(seconds);
    }
    let system = system(link, source.sysid)?;
    keep_newest(link, &system, source.compid, &kind, message)?;
    if (source.sysid, source.compid) == RADIO {
        link.invoke_method1(intern!(py, "_post_radio"), (&kind, message))?;
    }
    call_python(link, message, &kind, &system)
}

/// Keeps a message as the newest of its type.
#[inline(always)] // once for each message of a log
pub(crate) fn keep_newest(
    link: &Bound<'_, Link>,
    system: &Bound<'_, SystemState>,
    compid: u8,
    kind: &Bound<'_, PyString>,
    message: &Bound<'_, Message>,
) -> PyResult<()> {
    let (py, this) = (link.py(), message.get());
    let has_room = |entries| link.get().state().room.take(entries);
    let replacement = replaced::add_message(py);
    if let Some(info) = this.info.filter(|_| !this.has(flags::META) && replacement.is_none())
        && let Some(source) = instances::source_of(info, compid, this)
    {
        return system.get().keep(message, info, source, has_room);
    }
    let messages = system.get().messages(py)?;
    match replacement {
        Some(add_message) => add_message.invoke1((messages, kind, message)).map(drop),
        None if !messages.contains(kind)? && !has_room(messages.len()) => Ok(()),
        None => instances::add_message(&messages, kind, message),
    }
}

/// Makes the changes of the few message types that change more, then calls the message hooks.
pub(crate) fn call_python(
    link: &Bound<'_, Link>,
    message: &Bound<'_, Message>,
    kind: &Bound<'_, PyString>,
    state: &Bound<'_, SystemState>,
) -> PyResult<()> {
    let py = link.py();
    match message.get().info {
        Some(info) if info.definition.name == PARAM_VALUE => params::keep(link, message)?,
        Some(info) if info.changes_state => {
            link.invoke_method1(intern!(py, "_update"), (kind, message, state))?;
        }
        _ => {}
    }
    if let Some(hooks) = link.get().hooks(py) {
        for hook in hooks.try_iter()? {
            hook?.invoke1((link, message))?;
        }
    }
    if message.get().has(flags::SIGNED) {
        link.invoke_method1(intern!(py, "_adopt_link_id"), (message,))?;
    }
    Ok(())
}

fn is_posted(message: &Bound<'_, Message>) -> PyResult<bool> {
    let posted = instance_dict(message)?.get_item(intern!(message.py(), "_posted"))?;
    posted.map_or(Ok(false), |posted| posted.is_truthy())
}

/// Seconds since boot, if the message says.
fn uptime_of(message: &Bound<'_, Message>) -> PyResult<Option<f64>> {
    let this = message.get();
    let Some(info) = &this.info else { return Ok(None) };
    if this.is_pristine() {
        return Ok(info.uptime(this.decoded_payload()));
    }
    for (field, scale) in [(info.time_boot_ms, 1.0e-3), (info.usec, 1.0e-6)] {
        if let Some(index) = field {
            let value: f64 =
                message.getattr(info.names[index].name.bind(message.py()))?.extract()?;
            return Ok(Some(value * scale));
        }
    }
    Ok(None)
}

/// The state of a system, made on its first message.
pub(crate) fn system<'py>(link: &Bound<'py, Link>, sysid: u8) -> PyResult<Bound<'py, SystemState>> {
    let py = link.py();
    if let Some(known) = link.get().state().systems.find(sysid) {
        return Ok(known.state.bind(py).clone());
    }
    let states = link.get().state().sysid_state.as_ref().map(|states| states.bind(py).clone());
    let states = states.ok_or_else(|| PyTypeError::new_err("the link is not initialised"))?;
    let state = match states.get_item(sysid)? {
        Some(state) => state,
        None => {
            let state = link.invoke_method0(intern!(py, "_new_state"))?;
            states.as_any().set_item(sysid, &state)?;
            state
        }
    };
    let state = state.cast_into::<SystemState>()?;
    let forgotten = link.get().state().systems.remember(sysid, state.clone().unbind());
    drop(forgotten);
    Ok(state)
}
