//! Newest messages of types that have instances: batteries, servos, cameras.
//!
//! `messages[type]` is a copy of the newest message whose `_instances` holds the newest of each instance, and
//! `messages["TYPE[instance]"]` a further copy. As long as nobody but the table holds such a copy, it is made the next
//! copy in its place. The row `python/instances` of the instruction budget is its cost.

use std::sync::atomic::Ordering::Relaxed;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::link::name_budget::NameBudget;
use crate::message::create::{self, create};
use crate::message::dict;
use crate::message::object::{Message, Origin, flags, instance_dict};
use crate::message::values;
use crate::python::instance_dict::generic_setattr;

/// Instances kept per message type: they are chosen by whoever sends.
const MAX_INSTANCES: usize = 4096;

/// Stores a message as the newest of its type, and as the newest of its instance if it has one: then `messages[type]`
/// is a copy whose items are the instances' newest messages, and `messages["TYPE[instance]"]` a further copy.
#[pyfunction]
#[pyo3(name = "add_message")]
pub(crate) fn add_message_alone(
    messages: &Bound<'_, PyDict>,
    kind: &Bound<'_, PyString>,
    message: &Bound<'_, Message>,
) -> PyResult<()> {
    add_message(messages, kind, message, &NameBudget::alone())
}

/// The same as far as there is budget.
pub(crate) fn add_message(
    messages: &Bound<'_, PyDict>,
    kind: &Bound<'_, PyString>,
    message: &Bound<'_, Message>,
    budget: &NameBudget<'_>,
) -> PyResult<()> {
    let Some(instance) = instance_of(message)? else {
        return add_plain(messages, kind, message, budget);
    };
    let Some(instances) = renew_newest(messages, kind, message, budget)? else { return Ok(()) };
    let is_known = instances.contains(&instance)?;
    if !is_known && (instances.len() >= MAX_INSTANCES || !budget.takes(messages.len())?) {
        return Ok(());
    }
    instances.set_item(&instance, message)?;
    let key = instance_key(kind, message, &instance)?;
    let renewed = match messages.get_item(&key)? {
        Some(previous) => renew(&previous, message, 0),
        None => false,
    };
    if !renewed {
        messages.set_item(key, shallow_copy(message)?)?;
    }
    Ok(())
}

/// Stores a message of a type without instances.
pub(crate) fn add_plain(
    messages: &Bound<'_, PyDict>,
    kind: &Bound<'_, PyString>,
    message: &Bound<'_, Message>,
    budget: &NameBudget<'_>,
) -> PyResult<()> {
    let names = messages.len();
    if budget.owns(names) || messages.contains(kind)? || budget.takes(names)? {
        messages.set_item(kind, message)?;
    }
    Ok(())
}

/// Makes `messages[kind]` a copy of `message`; gives its table of instances, or `None` if there is no budget for it.
fn renew_newest<'py>(
    messages: &Bound<'py, PyDict>,
    kind: &Bound<'py, PyString>,
    message: &Bound<'py, Message>,
    budget: &NameBudget<'_>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let name = intern!(messages.py(), "_instances");
    let mut kept = None;
    if let Some(previous) = messages.get_item(kind)? {
        kept = match instances_of(&previous)? {
            Some(instances)
                if holds_instances_alone(&previous)? && renew(&previous, message, flags::DICT) =>
            {
                return Ok(Some(instances));
            }
            Some(instances) => Some(instances),
            None => None,
        };
    } else if !budget.takes(messages.len())? {
        return Ok(None);
    }
    let instances = kept.unwrap_or_else(|| PyDict::new(messages.py()));
    let newest = shallow_copy(message)?;
    generic_setattr(&newest, name, Some(&instances))?;
    Message::written(&newest, flags::DICT);
    messages.set_item(kind, newest)?;
    Ok(Some(instances))
}

/// Nothing else was written to `previous`.
fn holds_instances_alone(previous: &Bound<'_, PyAny>) -> PyResult<bool> {
    let Ok(message) = previous.cast::<Message>() else { return Ok(false) };
    Ok(instance_dict(message)?.len() == 1)
}

/// `previous._instances`
fn instances_of<'py>(previous: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyDict>>> {
    let name = intern!(previous.py(), "_instances");
    let instances = match previous.cast::<Message>() {
        Ok(message) if !message.get().has(flags::DICT) => None,
        Ok(message) => instance_dict(message)?.get_item(name)?,
        Err(_) => Some(previous.getattr(name)?),
    };
    match instances {
        Some(instances) if !instances.is_none() => Ok(Some(instances.cast_into::<PyDict>()?)),
        _ => Ok(None),
    }
}

/// Makes the object `previous` a copy of `message`, if it has written to it what `written` says at most and if nobody
/// can notice.
fn renew(previous: &Bound<'_, PyAny>, message: &Bound<'_, Message>, written: u32) -> bool {
    let this = message.get();
    let Ok(previous) = previous.cast::<Message>() else { return false };
    let before = previous.get().flags.load(Relaxed);
    let of_python = flags::DICT | flags::FIELDS | flags::META | flags::TIMESTAMP_IN_DICT;
    !this.has(flags::DICT)
        && before & (of_python | flags::MATERIALISED) == written
        && create::renew(previous, message, written)
}

/// `TYPE[instance]`
fn instance_key<'py>(
    kind: &Bound<'py, PyString>,
    message: &Bound<'py, Message>,
    instance: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyString>> {
    let py = kind.py();
    let make = || -> PyResult<_> {
        let key = format!("{}[{}]", kind.to_str()?, instance.str()?.to_str()?);
        Ok(PyString::new(py, &key))
    };
    let Some(info) = message.get().info.filter(|info| info.name.is(kind)) else { return make() };
    let known = instance.extract::<usize>().ok().and_then(|number| info.instance_keys.get(number));
    let Some(known) = known else { return make() };
    if let Some(key) = known.get() {
        return Ok(key.bind(py).clone());
    }
    let key = make()?;
    Ok(known.get_or_init(|| key.unbind()).bind(py).clone())
}

fn instance_of<'py>(message: &Bound<'py, Message>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = message.py();
    let this = message.get();
    if let (Some(info), false) = (&this.info, this.has(flags::META)) {
        let Some(field) = info.definition.instance_field.map(usize::from) else {
            return Ok(None);
        };
        if this.is_pristine() {
            let definition = &info.definition.fields[field];
            return values::field_value(py, definition, this.decoded_payload())
                .map(|value| Some(value.into_bound(py)));
        }
        let value = message.getattr(info.names[field].name.bind(py))?;
        return Ok((!value.is_none()).then_some(value));
    }
    if matches!(this.origin, Origin::Bad | Origin::Unknown) {
        return Ok(None);
    }
    let field = message.getattr(intern!(py, "_instance_field"))?;
    if field.is_none() {
        return Ok(None);
    }
    let value = message.getattr_opt(field.cast_into::<PyString>()?)?;
    Ok(value.filter(|value| !value.is_none()))
}

fn shallow_copy<'py>(message: &Bound<'py, Message>) -> PyResult<Bound<'py, Message>> {
    if message.get().has(flags::DICT) {
        return dict::copy(message, |value| Ok(value.clone()));
    }
    create(&message.get_type(), message.get().duplicate(message.py()))
}
