//! Newest messages of types that have instances: batteries, servos, cameras.
//!
//! `messages[type]` is a copy of the newest message whose `_instances` holds the newest of each instance, and
//! `messages["TYPE[instance]"]` a further copy.

use mavwire_core::telemetry::Source;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::message::info::Info;
use crate::message::object::{Message, Origin, flags};
use crate::message::values;
use crate::python::instance_dict::{generic_setattr, instance_dict};

/// Stores a message as the newest of its type, and as the newest of its instance if it has one: then `messages[type]`
/// is a copy whose items are the instances' newest messages, and `messages["TYPE[instance]"]` a further copy.
#[pyfunction]
pub(crate) fn add_message(
    messages: &Bound<'_, PyDict>,
    kind: &Bound<'_, PyString>,
    message: &Bound<'_, Message>,
) -> PyResult<()> {
    let Some(instance) = instance_of(message)? else { return messages.set_item(kind, message) };
    let py = messages.py();
    let known = messages.get_item(kind)?.map(|previous| instances_of(&previous)).transpose()?;
    let instances = known.flatten().unwrap_or_else(|| PyDict::new(py));
    instances.set_item(&instance, message)?;
    let newest = Message::copy(message)?;
    generic_setattr(&newest, intern!(py, "_instances"), Some(&instances))?;
    Message::written(&newest, flags::DICT);
    messages.set_item(kind, newest)?;
    let key = format!("{}[{}]", kind.to_str()?, instance.str()?.to_str()?);
    messages.set_item(key, Message::copy(message)?)
}

/// Where a received message belongs among those of its type; `None` if only Python can tell.
#[inline]
pub(crate) fn source_of(info: &Info, compid: u8, message: &Message) -> Option<Source> {
    let Some(field) = info.definition.instance_field else {
        return Some(Source::new(compid, &[]));
    };
    if !message.is_pristine() {
        return None;
    }
    let place = info.places[usize::from(field)];
    let bytes = message.decoded_payload().get(usize::from(place.offset)..).unwrap_or_default();
    Some(Source::new(compid, &bytes[..place.wire_len().min(bytes.len())]))
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
