//! The options of a bridge, read off the objects of `mavwire.bridge.options`.

use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use mavwire_core::border::BorderOptions;
use mavwire_core::router::{ByteRate, Filter, Limits, LinkOptions, Part, Settings};
use mavwire_core::schema::WireVersion;
use mavwire_core::signing::SecretKey;
use mavwire_io::bridge::{AutomationOptions, Endpoint, LinkSpec, NetKind, PortSpec, Recording};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::python::lists::{list, optional_bytes};

/// A number of seconds that a program gave.
pub(crate) fn seconds(name: &str, value: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(value).map_err(|_| {
        PyValueError::new_err(format!("{name} must be a number of seconds, 0 or more, not {value}"))
    })
}

fn microseconds(name: &str, value: f64) -> PyResult<u64> {
    Ok(u64::try_from(seconds(name, value)?.as_micros()).unwrap_or(u64::MAX))
}

/// `mavwire.bridge.options.Settings`.
#[derive(FromPyObject)]
pub(crate) struct SettingsOption {
    dedup: f64,
    max_age: f64,
    sniffer_sysid: u8,
}

impl SettingsOption {
    pub(crate) fn into_settings(self) -> PyResult<Settings> {
        let seed = RandomState::new().build_hasher().finish();
        Ok(Settings {
            max_age: microseconds("max_age", self.max_age)?,
            dedup_window: microseconds("dedup", self.dedup)?,
            sniffer_sysid: self.sniffer_sysid,
            ..Settings::new(seed)
        })
    }
}

/// `mavwire.bridge.options.Recording`.
#[derive(FromPyObject)]
pub(crate) struct RecordingOption {
    directory: PathBuf,
    max_bytes: Option<u64>,
    max_age: Option<f64>,
    flush_interval: f64,
}

impl RecordingOption {
    pub(crate) fn into_recording(self) -> PyResult<Recording> {
        Ok(Recording {
            directory: self.directory,
            max_bytes: self.max_bytes,
            max_age: self.max_age.map(|age| seconds("max_age", age)).transpose()?,
            flush_interval: seconds("flush_interval", self.flush_interval)?,
        })
    }
}

/// One list of a filter: whether it allows, what it is about, and its numbers.
#[derive(FromPyObject)]
struct FilterList(bool, String, #[pyo3(from_py_with = list)] Vec<u32>);

/// `mavwire.bridge.options.Filter`.
fn filter(lists: &Bound<'_, PyAny>) -> PyResult<Filter> {
    let mut filter = Filter::default();
    for FilterList(allows, part, ids) in list(lists)? {
        let part = match part.as_str() {
            "messages" => Part::Messages,
            "systems" => Part::Systems,
            _ => Part::Components,
        };
        filter = if allows { filter.allow(part, ids) } else { filter.block(part, ids) };
    }
    Ok(filter)
}

/// `mavwire.bridge.border.Border`.
#[derive(FromPyObject)]
#[allow(clippy::struct_excessive_bools)] // as in the core
struct BorderOption {
    version: Option<u8>,
    #[pyo3(from_py_with = optional_bytes)]
    key: Option<Vec<u8>>,
    verify: bool,
    #[pyo3(from_py_with = list)]
    unsigned: Vec<u32>,
    sign: bool,
    strip_in: bool,
    strip_out: bool,
    /// In units of signing timestamps.
    max_ahead: Option<u64>,
}

impl BorderOption {
    fn into_border(self) -> Result<BorderOptions> {
        let key = self.key.map(|key| SecretKey::new(&key)).transpose();
        Ok(BorderOptions {
            version: self.version.map(|n| if n == 1 { WireVersion::V1 } else { WireVersion::V2 }),
            key: key?.map(Arc::new),
            verify: self.verify,
            unsigned: self.unsigned,
            sign: self.sign,
            strip_in: self.strip_in,
            strip_out: self.strip_out,
            max_ahead: self.max_ahead,
            ..BorderOptions::default()
        })
    }
}

/// `mavwire.bridge.border.Automation`.
#[derive(FromPyObject)]
struct AutomationOption {
    system: u8,
    heartbeat: Option<f64>,
    stream_rate: Option<u16>,
}

impl AutomationOption {
    fn into_automation(self) -> PyResult<AutomationOptions> {
        let heartbeat = self.heartbeat.map(|time| seconds("heartbeat", time)).transpose()?;
        Ok(AutomationOptions { system: self.system, heartbeat, stream_rate: self.stream_rate })
    }
}

/// `mavwire.bridge.options.Endpoint`.
#[derive(FromPyObject)]
struct EndpointOption {
    kind: String,
    address: String,
    port: u16,
    baud: u32,
    flow_control: bool,
}

impl EndpointOption {
    fn into_endpoint(self) -> PyResult<Endpoint> {
        let Self { kind, address: host, port, baud, flow_control } = self;
        if kind == "serial" {
            return Ok(Endpoint::Serial { path: host.into(), baud, flow_control });
        }
        let wrong = || PyValueError::new_err(format!("no kind of endpoint: {kind:?}"));
        let kind = NetKind::from_word(&kind).ok_or_else(wrong)?;
        Ok(Endpoint::Net { kind, host, port })
    }
}

/// `mavwire.bridge.options.EndpointOptions`, with its group as a number.
#[derive(FromPyObject)]
pub(crate) struct LinkOption {
    name: String,
    endpoint: EndpointOption,
    group_number: Option<u16>,
    private: bool,
    sniffer: bool,
    #[pyo3(from_py_with = filter)]
    inbound: Filter,
    #[pyo3(from_py_with = filter)]
    outbound: Filter,
    border: BorderOption,
    automation: AutomationOption,
    bytes_per_second: Option<f64>,
    message_rate: Option<f64>,
    #[pyo3(from_py_with = list)]
    message_rates: Vec<(u32, f64)>,
    #[pyo3(from_py_with = list)]
    urgent: Vec<u32>,
    queue: usize,
    datagram: usize,
    forward_unverified: bool,
    peer_timeout: f64,
    retry: Option<f64>,
}

impl LinkOption {
    pub(crate) fn into_spec(self) -> PyResult<LinkSpec> {
        let options = LinkOptions {
            group: self.group_number,
            private: self.private,
            sniffer: self.sniffer,
            inbound: self.inbound,
            outbound: self.outbound,
            limits: Limits {
                bytes_per_second: self.bytes_per_second.map(ByteRate::new),
                message_rate: self.message_rate,
                message_rates: self.message_rates,
                urgent: self.urgent,
            },
            border: self.border.into_border()?,
        };
        Ok(LinkSpec {
            name: self.name,
            endpoint: self.endpoint.into_endpoint()?,
            port: PortSpec {
                options,
                automation: self.automation.into_automation()?,
                queue: self.queue,
                datagram: self.datagram,
                forward_unverified: self.forward_unverified,
            },
            peer_timeout: seconds("peer_timeout", self.peer_timeout)?,
            retry: self.retry.map(|retry| seconds("retry", retry)).transpose()?,
        })
    }
}
