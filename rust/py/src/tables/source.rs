//! Where the bytes of a log are: in a file, a part of one, or in memory.

use std::io::{self, Cursor, Read};
use std::path::PathBuf;
use std::sync::Arc;

use mavwire_columns::scan::Framing;
use mavwire_io::files;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

/// The bytes of a log, which can be read any number of times. In Python a path, `(path, start, end)`,
/// `(path, start, end, stamped)`, or bytes.
pub(crate) enum Source {
    File(PathBuf),
    /// From the first byte to the one that does not belong to it any more, and how the telemetry log is framed that it is a
    /// part of; `None` where the part is to be taken for what it looks like.
    Part(PathBuf, u64, u64, Option<Framing>),
    Memory(Shared),
}

/// Bytes that Python made.
#[derive(Clone)]
pub(crate) struct Shared(Arc<PyBackedBytes>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl<'py> FromPyObject<'_, 'py> for Source {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(bytes) = object.extract::<PyBackedBytes>() {
            return Ok(Self::Memory(Shared(Arc::new(bytes))));
        }
        if let Ok((path, start, end)) = object.extract() {
            return Ok(Self::Part(path, start, end, None));
        }
        if let Ok((path, start, end, stamped)) = object.extract() {
            let framing = if stamped { Framing::Stamped } else { Framing::Raw };
            return Ok(Self::Part(path, start, end, Some(framing)));
        }
        Ok(Self::File(object.extract()?))
    }
}

impl Source {
    /// The bytes from the start.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub(crate) fn open(&self) -> io::Result<Box<dyn Read + Send>> {
        match self {
            Self::File(path) => files::open(path),
            Self::Part(path, start, end, _) => files::open_part(path, *start..*end),
            Self::Memory(bytes) => Ok(Box::new(Cursor::new(bytes.clone()))),
        }
    }

    /// How the log is framed, where that is known: it is a telemetry log then, and not compressed.
    pub(crate) fn framing(&self) -> Option<Framing> {
        if let Self::Part(.., framing) = self { *framing } else { None }
    }

    /// About how many bytes there are; 0 where that is not known.
    pub(crate) fn size(&self) -> u64 {
        match self {
            Self::File(path) => path.metadata().map_or(0, |status| status.len()),
            Self::Part(_, start, end, _) => end.saturating_sub(*start),
            Self::Memory(bytes) => bytes.as_ref().len() as u64,
        }
    }
}
