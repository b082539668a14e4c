//! The lock that is held from taking a sequence number until the frame is written, so that frames leave in sequence and
//! no signing timestamp is used twice.
//!
//! Writing may run Python code: the thread that holds the lock may be interrupted and may take it again, because a write
//! callback may send. Nearly always the lock is free, which under the interpreter's lock takes a look and a store; a
//! standard mutex is another five nanoseconds for every message sent.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::SeqCst};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

use pyo3::prelude::*;

use crate::calling::{Calling, import};
use crate::thread_number;

/// Waiting threads look again after this time even if nobody told them to.
const PATIENCE: Duration = Duration::from_millis(10);

/// See the module.
pub(crate) struct SendLock {
    /// Number of the thread that holds it; 0 while nobody does.
    owner: AtomicU64,
    waiting: AtomicU32,
    gate: Mutex<()>,
    freed: Condvar,
}

impl SendLock {
    pub(crate) const fn new() -> Self {
        Self {
            owner: AtomicU64::new(0),
            waiting: AtomicU32::new(0),
            gate: Mutex::new(()),
            freed: Condvar::new(),
        }
    }

    /// Waits for its turn; an error if the user's signal handler raises meanwhile.
    pub(crate) fn lock<'a>(&'a self, py: Python<'_>) -> PyResult<SendGuard<'a>> {
        let thread = thread_number::current();
        if self.owner.load(SeqCst) == thread {
            return Ok(SendGuard { lock: self, outermost: false });
        }
        if !self.acquire(thread) {
            self.wait(py, thread)?;
        }
        Ok(SendGuard { lock: self, outermost: true })
    }

    #[cfg(not(Py_GIL_DISABLED))]
    #[inline]
    fn acquire(&self, thread: u64) -> bool {
        use std::sync::atomic::Ordering::Relaxed;
        // Whoever is attached is alone.
        let free = self.owner.load(Relaxed) == 0;
        if free {
            self.owner.store(thread, Relaxed);
        }
        free
    }

    #[cfg(Py_GIL_DISABLED)]
    fn acquire(&self, thread: u64) -> bool {
        self.owner.compare_exchange(0, thread, SeqCst, SeqCst).is_ok()
    }

    #[cold]
    fn wait(&self, py: Python<'_>, thread: u64) -> PyResult<()> {
        self.waiting.fetch_add(1, SeqCst);
        let mut signals = Ok(());
        while signals.is_ok() && !self.acquire(thread) && !self.inherit(py, thread) {
            // Another waiter has the gate for a moment only, unless it is one that a fork left behind.
            py.detach(|| match self.gate.try_lock() {
                Ok(gate) => drop(self.freed.wait_timeout(gate, PATIENCE)),
                Err(_) => std::thread::yield_now(),
            });
            signals = py.check_signals();
        }
        self.waiting.fetch_sub(1, SeqCst);
        signals
    }

    /// Takes the lock from a thread that will never free it: it does not exist in this process, which was forked while it
    /// sent, or it is a daemon thread, none of which runs again once the interpreter ends.
    fn inherit(&self, py: Python<'_>, thread: u64) -> bool {
        let owner = self.owner.load(SeqCst);
        let is_left = owner != 0 && (thread_number::is_gone(owner) || is_ending(py));
        is_left && self.owner.compare_exchange(owner, thread, SeqCst, SeqCst).is_ok()
    }
}

/// Whether only this thread still runs Python code; so it is when `sys` can no longer be asked.
fn is_ending(py: Python<'_>) -> bool {
    let answer = import(py, intern!(py, "sys"))
        .and_then(|sys| sys.attribute(intern!(py, "is_finalizing")))
        .and_then(|is_finalizing| is_finalizing.invoke1(()))
        .and_then(|answer| answer.truth());
    answer.unwrap_or(true)
}

/// While it lives, nobody else sends.
pub(crate) struct SendGuard<'a> {
    lock: &'a SendLock,
    /// Not a nested call of the same thread.
    outermost: bool,
}

impl Drop for SendGuard<'_> {
    #[inline]
    fn drop(&mut self) {
        if !self.outermost {
            return;
        }
        #[cfg(not(Py_GIL_DISABLED))]
        self.lock.owner.store(0, std::sync::atomic::Ordering::Relaxed);
        #[cfg(Py_GIL_DISABLED)]
        self.lock.owner.store(0, SeqCst);
        if self.lock.waiting.load(SeqCst) > 0 {
            self.lock.freed.notify_one();
        }
    }
}
