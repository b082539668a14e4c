//! Addresses of peers as Python's sockets show them, and which peer of a full link makes room.

use core::net::IpAddr;

use mavwire_core::peer_slots::{Origin, Slot, SlotHolder, Usefulness, slot_for};
use mavwire_io::address::Address;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

/// The position of the peer that a full link replaces by a new one from `host`; None if all peers stay. Each peer is given
/// by its host, whether it has sent a message to a system, and the seconds since its last message.
#[pyfunction]
pub(crate) fn peer_to_replace(host: &str, peers: Vec<(String, bool, f64)>) -> Option<usize> {
    let holders: Vec<SlotHolder> = peers
        .into_iter()
        .map(|(host, is_useful, silence)| SlotHolder {
            origin: origin(&host),
            usefulness: if is_useful { Usefulness::Useful } else { Usefulness::Heard },
            silence: (silence * 1e6) as u64,
        })
        .collect();
    match slot_for(origin(host), &holders, holders.len()) {
        Slot::Replace(position) => Some(position),
        Slot::Free | Slot::Refused => None,
    }
}

/// The origin of a host as Python shows it. Host names share one origin.
fn origin(host: &str) -> Origin {
    let address = host.split('%').next().unwrap_or(host).parse();
    Origin::from(address.unwrap_or(IpAddr::from([0; 4])))
}

/// An address as Python's sockets show it.
pub(crate) fn to_python(py: Python<'_>, address: Address) -> PyResult<Bound<'_, PyTuple>> {
    let host = PyString::new(py, &address.host());
    match address.flow_and_scope() {
        None => (host, address.port()).into_pyobject(py),
        Some((flow, scope)) => (host, address.port(), flow, scope).into_pyobject(py),
    }
}

/// The same backwards; `None` for what is no numeric address.
pub(crate) fn from_python(address: &Bound<'_, PyAny>) -> Option<Address> {
    let parts = address.cast::<PyTuple>().ok()?;
    let number = |n: usize| parts.get_item(n).ok()?.extract::<u32>().ok();
    let host = parts.get_item(0).ok()?.extract::<String>().ok()?;
    let port = parts.get_item(1).ok()?.extract().ok()?;
    Address::new(&host, port, number(2).unwrap_or(0), number(3).unwrap_or(0))
}
