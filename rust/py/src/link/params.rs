//! The parameters that `PARAM_VALUE` messages tell, by the component that has them.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::link::message_source::sender_of;
use crate::link::state::Link;
use crate::message::object::Message;
use crate::message::values::field_value;
use crate::python::calling::Calling;

/// Takes a `PARAM_VALUE` into `link.param_state`.
pub(crate) fn keep(link: &Bound<'_, Link>, message: &Bound<'_, Message>) -> PyResult<()> {
    let py = link.py();
    let (sender, _) = sender_of(message)?;
    let component = (sender.sysid, sender.compid).into_pyobject(py)?;
    let states = link.getattr(intern!(py, "param_state"))?.cast_into::<PyDict>()?;
    let state = match states.get_item(&component)? {
        Some(state) => state,
        None => {
            let state = link.invoke_method0(intern!(py, "_new_param_state"))?;
            states.set_item(&component, &state)?;
            state
        }
    };
    let params = state.getattr(intern!(py, "params"))?.cast_into::<PyDict>()?;
    let name = field(message, "param_id")?.str()?;
    if !params.contains(&name)? {
        let is_target = link.getattr(intern!(py, "params"))?.is(&params);
        if !link.get().state().room.take_param(params.len(), is_target) {
            return Ok(());
        }
    }
    params.set_item(name, field(message, "param_value")?)
}

/// A field, as its attribute shows it.
fn field<'py>(message: &Bound<'py, Message>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let this = message.get();
    if let Some(info) = this.info.filter(|_| this.is_pristine())
        && let Some((_, field)) = info.field(name)
    {
        let payload = this.decoded_payload();
        return Ok(field_value(message.py(), field, payload)?.into_bound(message.py()));
    }
    message.getattr(name)
}
