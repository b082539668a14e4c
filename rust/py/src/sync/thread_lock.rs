//! A lock that knows the thread that holds it. That thread may run Python code, be interrupted by a signal handler, and take
//! the lock again.
//!
//! Nearly always the lock is free, and taken in two nanoseconds. A standard mutex is another five for every message sent.
//! A thread that finds it held looks again every millisecond. A free lock is not handed over: the thread that gets it may be
//! busy with a signal handler.

use std::thread::sleep;
use std::time::Duration;

use pyo3::prelude::*;

use crate::sync::thread_number;
use crate::sync::thread_owner::Owner;

/// How long a thread waits between two looks at the lock.
const INTERVAL: Duration = Duration::from_millis(1);
/// Looks, that is a second, after which a thread goes past an owner that may be waiting for it. Counted, not timed: a process
/// that was stopped has not waited.
const PATIENCE: u32 = 1000;

/// See the module.
pub(crate) struct ThreadLock {
    owner: Owner,
    /// A thread that has waited. Other threads leave the lock to it once: one that sends without a pause would shut out all
    /// others otherwise.
    next: Owner,
}

/// How a thread came to hold a lock.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// It was free, or held by a thread that a fork left behind.
    Free,
    /// The thread held it already.
    Nested,
    /// Its owner has held it for a second.
    Passed,
}

impl ThreadLock {
    pub(crate) const fn new() -> Self {
        Self { owner: Owner::new(), next: Owner::new() }
    }

    /// Waits for its turn; an error if the user's signal handler raises meanwhile. Goes past an owner that has kept the lock
    /// for a second: it may be waiting for this thread, or be a daemon thread at the end of the interpreter.
    #[inline]
    pub(crate) fn lock(&self, py: Python<'_>) -> PyResult<ThreadGuard<'_>> {
        let thread = thread_number::current();
        let way = if self.owner.number() == thread {
            Way::Nested
        } else if self.next.number() == 0 && self.owner.claim(thread) {
            Way::Free
        } else {
            self.wait(py, thread)?
        };
        Ok(ThreadGuard { lock: self, thread, way })
    }

    #[cold]
    fn wait(&self, py: Python<'_>, thread: u64) -> PyResult<Way> {
        let (mut owner, mut looks) = (self.owner.number(), 0);
        loop {
            if looks > 0 || self.next.is_gone() {
                self.next.claim(thread);
            }
            py.detach(|| sleep(INTERVAL));
            // Before signal handlers run, as other threads leave the lock to this one.
            let is_free = self.owner.claim(thread);
            self.next.give_up(thread);
            if is_free {
                return Ok(Way::Free);
            }
            py.check_signals()?;
            looks += 1;
            if self.owner.number() != owner {
                (owner, looks) = (self.owner.number(), 1);
            } else if looks >= PATIENCE && self.owner.replace(owner, thread) {
                return Ok(Way::Passed);
            }
        }
    }
}

/// The lock held, until it is dropped, unless another thread goes past.
pub(crate) struct ThreadGuard<'a> {
    lock: &'a ThreadLock,
    thread: u64,
    way: Way,
}

impl ThreadGuard<'_> {
    /// Another call is in the middle of what the lock guards: of this thread, or of one that was passed.
    pub(crate) fn is_beside(&self) -> bool {
        self.way != Way::Free
    }
}

impl Drop for ThreadGuard<'_> {
    #[inline]
    fn drop(&mut self) {
        if self.way != Way::Nested {
            self.lock.owner.give_up(self.thread);
        }
    }
}
