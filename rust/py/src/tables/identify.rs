//! `identify`: what kind of log a file is, as `LogKind`.

use std::io;

use mavwire_columns::input;
use mavwire_core::log::kind::Kind;
use mavwire_core::log::tlog::Framing;
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::tables::source::Source;

macro_rules! log_kinds {
    ($($name:ident),*) => {
        /// A kind of log, or of another file, with the names of `mavwire_core::log::kind`.
        #[pyclass(eq, frozen, hash, rename_all = "SCREAMING_SNAKE_CASE", module = "mavwire._native")]
        #[derive(Debug, PartialEq, Eq, Hash)]
        pub(crate) enum LogKind {
            $($name,)*
        }

        #[pymethods]
        impl LogKind {
            #[getter]
            fn is_telemetry(&self) -> bool {
                match self { $(Self::$name => Kind::$name.is_telemetry(),)* }
            }

            #[getter]
            fn is_dataflash(&self) -> bool {
                match self { $(Self::$name => Kind::$name.is_dataflash(),)* }
            }
        }

        impl From<Kind> for LogKind {
            fn from(kind: Kind) -> Self {
                match kind { $(Kind::$name => Self::$name,)* }
            }
        }
    };
}

log_kinds! {
    Cut, Tlog, Raw, Dataflash, DataflashText, Headerless, OtherText, Gzip, Zstd, Zip, Program, Ulog, Png, Pcap, Sqlite, Unknown
}

/// The kind of the log in a source, which may be compressed.
pub(crate) fn kind_in(log: &Source) -> io::Result<Kind> {
    match log.framing() {
        Some(Framing::Stamped) => Ok(Kind::Tlog),
        Some(Framing::Raw) => Ok(Kind::Raw),
        None => input::identify_content(log.open()?),
    }
}

/// The kind of a log; with `unpack`, the kind of a compressed log's content.
#[pyfunction]
#[pyo3(signature = (log, unpack = false))]
pub(crate) fn identify(py: Python<'_>, log: Source, unpack: bool) -> Result<LogKind> {
    let kind = py.detach(|| if unpack { kind_in(&log) } else { input::identify(log.open()?) });
    Ok(kind?.into())
}
