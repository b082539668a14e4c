//! Numbers of threads, and which threads are gone because the process is the fork of one where they ran.

use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::python::calling::Calling;

static NEXT: AtomicU64 = AtomicU64::new(1);
/// The threads before this one ran in the process that this one was forked from, ...
static FIRST: AtomicU64 = AtomicU64::new(0);
/// ... and of those this one goes on.
static SURVIVOR: AtomicU64 = AtomicU64::new(0);

thread_local! {
    static NUMBER: u64 = NEXT.fetch_add(1, SeqCst);
}

/// The number of the thread that asks; not 0.
pub(crate) fn current() -> u64 {
    NUMBER.with(|number| *number)
}

/// Whether the thread with this number was left behind by a fork.
pub(crate) fn is_gone(number: u64) -> bool {
    number < FIRST.load(SeqCst) && number != SURVIVOR.load(SeqCst)
}

#[pyfunction]
fn forked() {
    SURVIVOR.store(current(), SeqCst);
    FIRST.store(NEXT.load(SeqCst), SeqCst);
}

/// Has `forked` called in every process that is forked from this one.
pub(crate) fn follow_forks(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let os = py.import(intern!(py, "os"))?;
    let Some(register) = os.getattr_opt(intern!(py, "register_at_fork"))? else {
        return Ok(()); // a system that does not fork
    };
    let options = PyDict::new(py);
    options.set_item(intern!(py, "after_in_child"), wrap_pyfunction!(forked, module)?)?;
    register.invoke((), Some(&options))?;
    Ok(())
}
