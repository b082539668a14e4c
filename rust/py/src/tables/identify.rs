//! `identify`: what kind of log a file is, as `LogKind`.

use std::io;

use mavwire_columns::input;
use mavwire_core::log::kind::Kind;
use mavwire_core::log::tlog::Framing;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::tables::source::Source;

/// A kind of log, or of another file. The names say the same in `mavwire_core::log::kind`.
#[pyclass(eq, frozen, hash, rename_all = "SCREAMING_SNAKE_CASE", module = "mavwire._native")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum LogKind {
    Cut,
    Tlog,
    Raw,
    Dataflash,
    DataflashText,
    Headerless,
    OtherText,
    Gzip,
    Zstd,
    Zip,
    Program,
    Ulog,
    Png,
    Pcap,
    Sqlite,
    Unknown,
}

impl From<Kind> for LogKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Cut => Self::Cut,
            Kind::Tlog => Self::Tlog,
            Kind::Raw => Self::Raw,
            Kind::Dataflash => Self::Dataflash,
            Kind::DataflashText => Self::DataflashText,
            Kind::Headerless => Self::Headerless,
            Kind::OtherText => Self::OtherText,
            Kind::Gzip => Self::Gzip,
            Kind::Zstd => Self::Zstd,
            Kind::Zip => Self::Zip,
            Kind::Program => Self::Program,
            Kind::ULog => Self::Ulog,
            Kind::Png => Self::Png,
            Kind::Pcap => Self::Pcap,
            Kind::Sqlite => Self::Sqlite,
            Kind::Unknown => Self::Unknown,
        }
    }
}

/// The kind of the log in a source, which may be compressed.
pub(crate) fn kind_in(log: &Source) -> io::Result<Kind> {
    match log.framing() {
        Some(Framing::Stamped) => Ok(Kind::Tlog),
        Some(Framing::Raw) => Ok(Kind::Raw),
        None => input::identify_content(log.open()?),
    }
}

/// What kind of log a file is; with `unpack`, what is in it if it is compressed.
#[pyfunction]
#[pyo3(signature = (log, unpack = false))]
pub(crate) fn identify(py: Python<'_>, log: Source, unpack: bool) -> Result<LogKind> {
    let kind = py.detach(|| if unpack { kind_in(&log) } else { input::identify(log.open()?) });
    Ok(kind?.into())
}
