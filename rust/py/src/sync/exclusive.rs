//! `Exclusive`: work that one thread does, and that the others leave to it without waiting.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::python::calling::Calling;
use crate::sync::thread_number;
use crate::sync::thread_owner::Owner;

/// A lock that no thread waits for: a thread that does not get it leaves the work to its owner.
///
/// It is taken and released in one call with the work in between, so that the exception of a signal handler leaves it free
/// wherever it is raised. A thread that a fork left behind holds nothing.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Exclusive {
    owner: Owner,
}

impl Exclusive {
    pub(crate) const fn free() -> Self {
        Self { owner: Owner::new() }
    }

    /// `None` while a thread holds it, be it this one.
    #[inline]
    pub(crate) fn take(&self) -> Option<TurnGuard<'_>> {
        let number = thread_number::current();
        self.owner.claim(number).then(|| TurnGuard { turn: self, number })
    }

    /// Frees it if its owner was left behind by a fork; whether it was.
    #[inline]
    pub(crate) fn free_after_fork(&self) -> bool {
        self.owner.is_gone() && self.owner.replace(self.owner.number(), 0)
    }
}

/// The turn of one call, until it is dropped.
pub(crate) struct TurnGuard<'a> {
    turn: &'a Exclusive,
    number: u64,
}

impl Drop for TurnGuard<'_> {
    #[inline]
    fn drop(&mut self) {
        self.turn.owner.give_up(self.number);
    }
}

#[pymethods]
impl Exclusive {
    #[new]
    fn new() -> Self {
        Self::free()
    }

    /// `act(*args)`; `None`, with nothing done, while another call has the turn.
    #[pyo3(signature = (act, *args))]
    fn run<'py>(
        &self,
        act: &Bound<'py, PyAny>,
        args: Bound<'py, PyTuple>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(_turn) = self.take() else { return Ok(None) };
        act.invoke1(args).map(Some)
    }

    /// Whether a call has the turn.
    fn locked(&self) -> bool {
        self.owner.number() != 0 && !self.owner.is_gone()
    }
}
