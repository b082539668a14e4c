//! The parameters that `PARAM_VALUE` messages tell, by the component that has them.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::link::message_source::sender_of;
use crate::link::state::Link;
use crate::message::object::Message;
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
    let name = message.getattr(intern!(py, "param_id"))?.str()?;
    if !params.contains(&name)? {
        let is_target = link.getattr(intern!(py, "params"))?.is(&params);
        if !link.get().state().room.take_param(params.len(), is_target) {
            return Ok(());
        }
    }
    params.set_item(name, message.getattr(intern!(py, "param_value"))?)
}
