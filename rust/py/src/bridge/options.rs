//! The options of a bridge, read off the objects of `mavwire.bridge.options`.

use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::sync::Arc;
use std::time::Duration;

use mavwire_core::border::BorderOptions;
use mavwire_core::router::{ByteRate, Filter, Limits, LinkOptions, Part, Settings};
use mavwire_core::schema::WireVersion;
use mavwire_core::signing::SecretKey;
use mavwire_io::bridge::{AutomationOptions, Endpoint, LinkSpec, NetKind, PortSpec, Recording};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::python::lists::{bytes, list};

/// A number of seconds that a program gave.
pub(crate) fn seconds(name: &str, value: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(value).map_err(|_| {
        PyValueError::new_err(format!("{name} must be a number of seconds, 0 or more, not {value}"))
    })
}

/// An attribute.
fn get<'py, T: FromPyObjectOwned<'py>>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<T> {
    object.getattr(name)?.extract().map_err(Into::into)
}

/// An attribute that is a list.
fn get_list<'py, T: FromPyObjectOwned<'py>>(
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Vec<T>> {
    list(&object.getattr(name)?)
}

/// An attribute that is a number of seconds.
fn get_seconds(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Duration> {
    seconds(name, get(object, name)?)
}

/// An attribute that is a number of seconds, or `None`.
fn get_optional_seconds(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<Duration>> {
    get::<Option<f64>>(object, name)?.map(|value| seconds(name, value)).transpose()
}

/// `mavwire.bridge.options.Settings`.
pub(crate) fn settings(options: &Bound<'_, PyAny>) -> PyResult<Settings> {
    let microseconds = |name| -> PyResult<u64> {
        Ok(u64::try_from(get_seconds(options, name)?.as_micros()).unwrap_or(u64::MAX))
    };
    Ok(Settings {
        max_age: microseconds("max_age")?,
        dedup_window: microseconds("dedup")?,
        sniffer_sysid: get(options, "sniffer_sysid")?,
        ..Settings::new(RandomState::new().build_hasher().finish())
    })
}

/// `mavwire.bridge.options.Recording`.
pub(crate) fn recording(options: &Bound<'_, PyAny>) -> PyResult<Recording> {
    Ok(Recording {
        directory: get(options, "directory")?,
        max_bytes: get(options, "max_bytes")?,
        max_age: get_optional_seconds(options, "max_age")?,
        flush_interval: get_seconds(options, "flush_interval")?,
    })
}

/// One list of a filter: whether it allows, what it is about, and its numbers.
#[derive(FromPyObject)]
struct FilterList(bool, String, #[pyo3(from_py_with = list)] Vec<u32>);

/// `mavwire.bridge.options.Filter`.
fn filter(lists: Vec<FilterList>) -> Filter {
    let add = |filter: Filter, FilterList(allows, part, ids): FilterList| {
        let part = match part.as_str() {
            "messages" => Part::Messages,
            "systems" => Part::Systems,
            _ => Part::Components,
        };
        if allows { filter.allow(part, ids) } else { filter.block(part, ids) }
    };
    lists.into_iter().fold(Filter::default(), add)
}

/// `mavwire.bridge.border.Border`.
fn border(options: &Bound<'_, PyAny>) -> Result<BorderOptions> {
    let key: Option<Bound<'_, PyAny>> = get(options, "key")?;
    let key = key.map(|key| bytes(&key)).transpose()?;
    let key = key.map(|key| SecretKey::new(&key)).transpose()?.map(Arc::new);
    let version: Option<u8> = get(options, "version")?;
    Ok(BorderOptions {
        version: version.map(|n| if n == 1 { WireVersion::V1 } else { WireVersion::V2 }),
        key,
        verify: get(options, "verify")?,
        unsigned: get_list(options, "unsigned")?,
        sign: get(options, "sign")?,
        strip_in: get(options, "strip_in")?,
        strip_out: get(options, "strip_out")?,
        max_ahead: get(options, "max_ahead")?, // in units of signing timestamps
        ..BorderOptions::default()
    })
}

/// `mavwire.bridge.options.Endpoint`.
fn endpoint(options: &Bound<'_, PyAny>) -> PyResult<Endpoint> {
    let kind: String = get(options, "kind")?;
    if kind == "serial" {
        return Ok(Endpoint::Serial {
            path: get(options, "address")?,
            baud: get(options, "baud")?,
            flow_control: get(options, "flow_control")?,
        });
    }
    let wrong = || PyValueError::new_err(format!("no kind of endpoint: {kind:?}"));
    Ok(Endpoint::Net {
        kind: NetKind::from_word(&kind).ok_or_else(wrong)?,
        host: get(options, "address")?,
        port: get(options, "port")?,
    })
}

/// `mavwire.bridge.options.EndpointOptions`, with its group as a number.
pub(crate) fn link_spec(link: &Bound<'_, PyAny>) -> Result<LinkSpec> {
    let bytes_per_second: Option<f64> = get(link, "bytes_per_second")?;
    let options = LinkOptions {
        group: get(link, "group_number")?,
        private: get(link, "private")?,
        sniffer: get(link, "sniffer")?,
        inbound: filter(get_list(link, "inbound")?),
        outbound: filter(get_list(link, "outbound")?),
        limits: Limits {
            bytes_per_second: bytes_per_second.map(ByteRate::new),
            message_rate: get(link, "message_rate")?,
            message_rates: get_list(link, "message_rates")?,
            urgent: get_list(link, "urgent")?,
        },
        border: border(&link.getattr("border")?)?,
    };
    let automation = link.getattr("automation")?;
    let automation = AutomationOptions {
        system: get(&automation, "system")?,
        heartbeat: get_optional_seconds(&automation, "heartbeat")?,
        stream_rate: get(&automation, "stream_rate")?,
    };
    Ok(LinkSpec {
        name: get(link, "name")?,
        endpoint: endpoint(&link.getattr("endpoint")?)?,
        port: PortSpec {
            options,
            automation,
            queue: get(link, "queue")?,
            datagram: get(link, "datagram")?,
            forward_unverified: get(link, "forward_unverified")?,
        },
        peer_timeout: get_seconds(link, "peer_timeout")?,
        retry: get_optional_seconds(link, "retry")?,
    })
}
