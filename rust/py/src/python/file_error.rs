//! Errors of files as Python raises them: with a number, which chooses the class, and the name of the file.

use std::error::Error;
use std::io;
use std::path::Path;

use mavwire_io::error_text::in_words;
use mavwire_io::files::Unwritten;
use pyo3::exceptions::{PyMemoryError, PyOSError};
use pyo3::prelude::*;

/// The error of the operating system that is behind another one, if there is one.
pub(crate) fn file_error(error: &(dyn Error + 'static)) -> Option<PyErr> {
    let all = std::iter::successors(Some(error), |&error| error.source());
    all.filter_map(|one| one.downcast_ref::<io::Error>()).find_map(|one| {
        match one.get_ref().and_then(|inner| inner.downcast_ref::<Unwritten>()) {
            Some(Unwritten { path, error }) => of_file(error, Some(path), ""),
            None => of_file(one, None, ""),
        }
    })
}

/// The same for a file whose name is known, with what else there is to say.
pub(crate) fn of_file(error: &io::Error, path: Option<&Path>, advice: &str) -> Option<PyErr> {
    let code = error.raw_os_error()?;
    let text = in_words(error) + advice;
    Some(match path {
        Some(path) => PyOSError::new_err((code, text, path.as_os_str().to_owned())),
        None => PyOSError::new_err((code, text)),
    })
}

/// An error of reading, where `MemoryError` is for bytes that there is no memory for.
pub(crate) fn of_reading(error: io::Error) -> PyErr {
    let is_ours = error.raw_os_error().is_none() && error.kind() == io::ErrorKind::OutOfMemory;
    if is_ours {
        return PyMemoryError::new_err(error.to_string());
    }
    of_file(&error, None, "").unwrap_or_else(|| error.into())
}
