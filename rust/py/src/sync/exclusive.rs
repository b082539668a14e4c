//! `Exclusive`: work that is done by one thread, and which the others do not wait for.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::python::calling::Calling;
use crate::sync::thread_number;
use crate::sync::thread_owner::Owner;

/// A lock that nobody waits for: whoever does not get it leaves the work to the one who has it.
///
/// It is taken and released in one call with the work in between, so that the exception of a signal handler leaves it free
/// wherever it is raised. What a thread had that a fork left behind is free.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Exclusive {
    owner: Owner,
}

impl Exclusive {
    pub(crate) const fn free() -> Self {
        Self { owner: Owner::new() }
    }

    /// `None` while somebody has it, be it this thread.
    #[inline]
    pub(crate) fn take(&self) -> Option<TurnGuard<'_>> {
        self.take_as(thread_number::current())
    }

    fn take_as(&self, number: u64) -> Option<TurnGuard<'_>> {
        self.free_after_fork();
        self.owner.claim(number).then(|| TurnGuard { turn: self, number })
    }

    /// Whether a thread had it that does not exist in this process; then nobody has it any more.
    #[inline]
    pub(crate) fn free_after_fork(&self) -> bool {
        self.owner.is_gone() && self.owner.replace(self.owner.number(), 0)
    }

    fn is_taken(&self) -> bool {
        self.owner.number() != 0 && !self.owner.is_gone()
    }
}

/// While it lives, nobody else has the turn.
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

    /// `act(*args)`; `None`, with nothing done, while somebody has the turn.
    #[pyo3(signature = (act, *args))]
    fn run<'py>(
        &self,
        act: &Bound<'py, PyAny>,
        args: Bound<'py, PyTuple>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(_turn) = self.take() else { return Ok(None) };
        act.invoke1(args).map(Some)
    }

    /// If `is_due()`, runs `act()` in a thread that `start_thread(function, arguments)` starts; whether it does. Nothing is
    /// done while somebody has the turn, which ends with that thread.
    fn start(
        slf: &Bound<'_, Self>,
        start_thread: &Bound<'_, PyAny>,
        is_due: &Bound<'_, PyAny>,
        act: &Bound<'_, PyAny>,
    ) -> PyResult<bool> {
        let py = slf.py();
        let number = thread_number::reserve();
        let Some(turn) = slf.get().take_as(number) else { return Ok(false) };
        if !is_due.invoke1(())?.is_truthy()? {
            return Ok(false);
        }
        let go_on = slf.getattr(intern!(py, "_go_on"))?;
        start_thread.invoke1((go_on, (number, act)))?;
        std::mem::forget(turn);
        Ok(true)
    }

    /// What the thread does that was started with the turn as its own.
    fn _go_on(&self, number: u64, act: &Bound<'_, PyAny>) -> PyResult<()> {
        let _turn = TurnGuard { turn: self, number };
        act.invoke1(())?;
        Ok(())
    }

    /// Whether somebody has it.
    fn locked(&self) -> bool {
        self.is_taken()
    }
}
