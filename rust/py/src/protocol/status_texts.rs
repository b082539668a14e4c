//! `StatusTexts`: joins long texts that several STATUSTEXT messages carry. See `mavwire_core::telemetry`.

use mavwire_core::telemetry::{StatusTexts as Texts, TextFields};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::message::object::{Message, Origin};
use crate::sync::lock::Lock;

/// A message and the text that begins with it.
type Text<'py> = (Py<Message>, Bound<'py, PyBytes>);

/// Joins the parts of long texts.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct StatusTexts(Lock<Texts<Py<Message>>>);

#[pymethods]
impl StatusTexts {
    #[new]
    fn new() -> Self {
        Self(Lock::new(Texts::default()))
    }

    /// The texts that end with a message: `(first message, text)`. None for the start of a longer one, and for a message
    /// that is not a STATUSTEXT.
    fn hear<'py>(&self, message: &Bound<'py, Message>) -> PyResult<Vec<Text<'py>>> {
        let (py, this) = (message.py(), message.get());
        let fields = this.info.and_then(|info| TextFields::of(&info.definition));
        let header = this.header().filter(|_| this.origin == Origin::Decoded);
        let (Some(fields), Some(header)) = (fields, header) else { return whole_text(message) };
        let own = || message.clone().unbind();
        let sender = (header.sysid, header.compid);
        Ok(shown(py, self.0.lock(py).receive(fields, sender, this.decoded_payload(), own)))
    }

    /// Gives up the texts that are incomplete.
    fn finish<'py>(&self, py: Python<'py>) -> Vec<Text<'py>> {
        shown(py, self.0.lock(py).finish())
    }
}

/// The text of a STATUSTEXT whose definition has no parts, as in MAVLink 1, or that was not received.
fn whole_text<'py>(message: &Bound<'py, Message>) -> PyResult<Vec<Text<'py>>> {
    let is_text = message.get().info.is_some_and(|info| info.definition.name == "STATUSTEXT");
    let text = if is_text { message.as_any().getattr_opt("_text_raw")? } else { None };
    let Some(text) = text else { return Ok(Vec::new()) };
    Ok(vec![(message.clone().unbind(), text.cast_into()?)])
}

fn shown(py: Python<'_>, found: Vec<(Py<Message>, Vec<u8>)>) -> Vec<Text<'_>> {
    found.into_iter().map(|(first, text)| (first, PyBytes::new(py, &text))).collect()
}
