//! The counts of a bridge as dictionaries, which `json` can write without a conversion.

use mavwire_io::bridge::{ComponentReport, LinkReport, RecordingStats, Stats};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::tables::columns::unknown_counts;

/// A dictionary of names and values.
macro_rules! dict {
    ($py:expr, $($name:literal: $value:expr),+ $(,)?) => {{
        let dict = PyDict::new($py);
        $(dict.set_item($name, $value)?;)+
        dict
    }};
}

pub(crate) fn to_dict<'py>(py: Python<'py>, stats: &Stats) -> PyResult<Bound<'py, PyDict>> {
    let links = PyList::empty(py);
    for one in &stats.links {
        links.append(link(py, one)?)?;
    }
    let components = PyList::empty(py);
    for one in &stats.components {
        components.append(component(py, one)?)?;
    }
    let recording = stats.recording.as_ref().map(|one| recording(py, one)).transpose()?;
    Ok(dict!(py,
        "uptime": stats.uptime,
        "links": links,
        "components": components,
        "hidden_components": stats.hidden_components,
        "recording": recording,
    ))
}

fn link<'py>(py: Python<'py>, link: &LinkReport) -> PyResult<Bound<'py, PyDict>> {
    let [p50, p99, p999] = link.latency.map(|micros| micros.map(|micros| f64::from(micros) / 1e6));
    let latency = dict!(py, "p50": p50, "p99": p99, "p99.9": p999);
    let dict = dict!(py,
        "name": &link.name,
        "endpoint": &link.endpoint,
        "peer": &link.peer,
        "state": link.state,
    );
    for (name, count) in link.traffic.clone().counters() {
        dict.set_item(name, *count)?;
    }
    let unknown = PyList::empty(py);
    for (kind, count) in unknown_counts(&link.unknown, |count| *count) {
        let (id, extra) = kind.unzip();
        unknown.append(dict!(py, "id": id, "crc_extra": extra, "frames": count))?;
    }
    let last = dict!(py,
        "unknown": unknown,
        "overrun": link.overrun,
        "latency": latency,
        "queued_bytes": link.queued,
        "refused": link.refused,
        "connections": link.connections,
        "error": &link.error,
    );
    dict.update(last.as_mapping())?;
    Ok(dict)
}

fn component<'py>(py: Python<'py>, one: &ComponentReport) -> PyResult<Bound<'py, PyDict>> {
    Ok(dict!(py,
        "system": one.sysid,
        "component": one.compid,
        "frames": one.stats.frames,
        "bytes": one.stats.bytes,
        "lost": one.stats.lost,
        "duplicates": one.stats.duplicates,
        "age": one.age,
        "links": &one.links,
    ))
}

fn recording<'py>(py: Python<'py>, one: &RecordingStats) -> PyResult<Bound<'py, PyDict>> {
    Ok(dict!(py,
        "path": one.path.display().to_string(),
        "files": one.files,
        "records": one.records,
        "bytes": one.bytes,
        "dropped": one.dropped,
        "error": &one.error,
    ))
}
