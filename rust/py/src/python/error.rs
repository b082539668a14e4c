//! The error of this crate: what went wrong in the other ones, and the exception that Python raises for it.

use std::collections::TryReserveError;
use std::io;
use std::path::{Path, PathBuf};

use mavwire_columns::Error as ColumnsError;
use mavwire_columns::arrow::error::ArrowError;
use mavwire_core::frame::FrameError;
use mavwire_core::log::dataflash::LayoutError;
use mavwire_core::signing::SigningError;
#[cfg(unix)]
use mavwire_io::bridge::{BridgeError as Bridge, NO_SUCH_ADDRESS};
use mavwire_io::error_text::in_words;
use mavwire_io::files::Unwritten;
use mavwire_schema::{Reason, SchemaError};
use pyo3::CastIntoError;
use pyo3::create_exception;
use pyo3::exceptions::{
    PyAssertionError, PyException, PyMemoryError, PyOSError, PyOverflowError, PyRuntimeError,
    PyValueError,
};
use pyo3::prelude::*;

create_exception!(
    mavwire._native,
    DefinitionError,
    PyValueError,
    "A definition that is wrong or hostile. The text names file, line and reason."
);

#[cfg(unix)]
create_exception!(
    mavwire._native,
    BridgeError,
    PyRuntimeError,
    "The bridge refuses a request: a name is taken or unknown, there are too many links, or it has stopped."
);

/// The result of most functions of the extension.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a function of the extension failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An exception that Python raised.
    #[error(transparent)]
    Python(#[from] PyErr),
    /// Columns could not be made or written.
    #[error(transparent)]
    Columns(#[from] ColumnsError),
    /// A file could not be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file at a path could not be opened.
    #[error("{path:?}: {error}")]
    Opening {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
        /// The next step for the user, behind the system's text.
        advice: &'static str,
    },
    /// There is not enough memory.
    #[error(transparent)]
    Memory(#[from] TryReserveError),
    /// A frame could not be signed or verified.
    #[error(transparent)]
    Signing(#[from] SigningError),
    /// Bytes are no frame, or a message fits into none.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A definition is wrong.
    #[error(transparent)]
    Definition(#[from] SchemaError),
    /// A field of a definition is wrong.
    #[error(transparent)]
    Field(#[from] Reason),
    /// A FMT record is wrong.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The bridge refused a request.
    #[cfg(unix)]
    #[error(transparent)]
    Bridge(#[from] Bridge),
}

impl From<CastIntoError<'_>> for Error {
    fn from(error: CastIntoError<'_>) -> Self {
        Self::Python(error.into())
    }
}

impl From<ArrowError> for Error {
    fn from(error: ArrowError) -> Self {
        Self::Columns(error.into())
    }
}

impl From<Error> for PyErr {
    fn from(error: Error) -> Self {
        // The text of an exception may be a program's own `__str__`, which must not run here.
        let text = if let Error::Python(_) = error { String::new() } else { error.to_string() };
        match error {
            Error::Python(error) => error,
            Error::Columns(error) => columns_error(error),
            Error::Io(error) => io_error(error),
            Error::Opening { path, error, advice } => {
                of_file(&error, Some(&path), advice).unwrap_or_else(|| error.into())
            }
            Error::Memory(_) => PyMemoryError::new_err(text),
            Error::Signing(SigningError::NoKey) => PyAssertionError::new_err(()),
            Error::Signing(SigningError::TimestampExhausted) => PyOverflowError::new_err(text),
            Error::Definition(_) | Error::Field(_) => DefinitionError::new_err(text),
            // pymavlink raises a plain Exception here.
            Error::Layout(LayoutError::UnknownKind { .. }) => PyException::new_err(text),
            Error::Signing(SigningError::KeyLength(_)) | Error::Frame(_) | Error::Layout(_) => {
                PyValueError::new_err(text)
            }
            #[cfg(unix)]
            Error::Bridge(error) => bridge_error(error),
        }
    }
}

fn columns_error(error: ColumnsError) -> PyErr {
    let known = match error {
        ColumnsError::Io(error) => return io_error(error),
        ColumnsError::Arrow(ref error) => system_error(error),
        ColumnsError::Parquet(ref error) => system_error(error),
        ColumnsError::Mcap(_) // whose `From` takes out what the system says
        | ColumnsError::NoTimes
        | ColumnsError::Untimed
        | ColumnsError::TooManyChannels(_)
        | ColumnsError::TooManyFiles(_)
        | ColumnsError::NoColumn { .. }
        | ColumnsError::MixedColumn(_)
        | ColumnsError::TooManyColumns { .. } => None,
    };
    known.unwrap_or_else(|| PyValueError::new_err(error.to_string()))
}

/// `MemoryError` where there is no memory for a file's bytes.
fn io_error(error: io::Error) -> PyErr {
    if let Some(raised) = system_error(&error) {
        return raised;
    }
    match error.kind() {
        io::ErrorKind::OutOfMemory => PyMemoryError::new_err(error.to_string()),
        _ => error.into(),
    }
}

#[cfg(unix)]
fn bridge_error(error: Bridge) -> PyErr {
    match error {
        // Errors without a number are about an address: an unknown name, or a path that is not a device.
        Bridge::Io { link, error } => {
            let number = error.raw_os_error().unwrap_or(NO_SUCH_ADDRESS);
            PyOSError::new_err((number, in_words(&error), link))
        }
        Bridge::NoFrame { .. } | Bridge::BadFrame { .. } => {
            PyValueError::new_err(error.to_string())
        }
        error => BridgeError::new_err(error.to_string()),
    }
}

/// The error of the operating system that caused another one.
fn system_error(error: &(dyn std::error::Error + 'static)) -> Option<PyErr> {
    let causes = std::iter::successors(Some(error), |&error| error.source());
    causes.filter_map(|one| one.downcast_ref::<io::Error>()).find_map(|one| {
        match one.get_ref().and_then(|inner| inner.downcast_ref::<Unwritten>()) {
            Some(Unwritten { path, error }) => of_file(error, Some(path), ""),
            None => of_file(one, None, ""),
        }
    })
}

/// An error with a number of the operating system.
fn of_file(error: &io::Error, path: Option<&Path>, advice: &str) -> Option<PyErr> {
    let code = error.raw_os_error()?;
    let text = in_words(error) + advice;
    Some(match path {
        Some(path) => PyOSError::new_err((code, text, path.as_os_str().to_owned())),
        None => PyOSError::new_err((code, text)),
    })
}
