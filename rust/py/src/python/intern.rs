//! Texts that Python knows once and for all, such as the names of attributes.
//!
//! PyO3's own `intern!` lets other threads run while it makes the text. A process that is forked in that moment would
//! wait for ever for a thread that it does not have.

use std::sync::OnceLock;

use pyo3::prelude::*;
use pyo3::types::PyString;

/// The interned text, made when it is first asked for.
macro_rules! intern {
    ($py:expr, $text:expr) => {{
        static TEXT: $crate::python::intern::Interned =
            $crate::python::intern::Interned::new($text);
        TEXT.get($py)
    }};
}

/// See the module.
pub(crate) struct Interned {
    text: &'static str,
    made: OnceLock<Py<PyString>>,
}

impl Interned {
    pub(crate) const fn new(text: &'static str) -> Self {
        Self { text, made: OnceLock::new() }
    }

    #[inline]
    pub(crate) fn get<'py>(&self, py: Python<'py>) -> &Bound<'py, PyString> {
        self.made.get().unwrap_or_else(|| self.make(py)).bind(py)
    }

    #[cold]
    fn make(&self, py: Python<'_>) -> &Py<PyString> {
        let text = PyString::intern(py, self.text).unbind();
        self.made.get_or_init(|| text)
    }
}
