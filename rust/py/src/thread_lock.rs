//! A lock that knows the thread that holds it, which may run Python code, be interrupted by a signal's handler, and take it
//! again.
//!
//! Nearly always the lock is free, and taken in two nanoseconds; a standard mutex is another five for every message sent.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed, Ordering::SeqCst};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

use pyo3::prelude::*;

use crate::calling::{Calling, Known};
use crate::owner::Owner;
use crate::{shared, thread_number};

/// Waiting threads look again after this time even if nobody told them to.
const INTERVAL: Duration = Duration::from_millis(10);
/// So often, that is for a second, in which the lock did not change hands. Counted, not timed: where a process or all of a
/// machine stood still, nobody has waited.
const PATIENCE: u32 = 100;

static IS_FINALIZING: Known = Known::new("sys", "is_finalizing");

/// To be called when the module is loaded, since what asks for it later may be the end of the interpreter.
pub(crate) fn prepare(py: Python<'_>) -> PyResult<()> {
    IS_FINALIZING.get(py).map(drop)
}

/// See the module.
pub(crate) struct ThreadLock {
    owner: Owner,
    /// How often it was taken.
    turns: AtomicU64,
    waiting: AtomicU32,
    gate: Mutex<()>,
    freed: Condvar,
}

/// How a thread came to hold a lock.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// It was free.
    Free,
    /// The thread held it already.
    Nested,
    /// Whoever held it will never free it.
    Inherited,
    /// Whoever holds it may be waiting for this thread.
    Passed,
}

impl ThreadLock {
    pub(crate) const fn new() -> Self {
        Self {
            owner: Owner::new(),
            turns: AtomicU64::new(0),
            waiting: AtomicU32::new(0),
            gate: Mutex::new(()),
            freed: Condvar::new(),
        }
    }

    /// Waits for its turn; an error if the user's signal handler raises meanwhile.
    pub(crate) fn lock(&self, py: Python<'_>) -> PyResult<ThreadGuard<'_>> {
        self.lock_or_pass(py, || false)
    }

    /// Waits for its turn, for a second if `may_pass()` says then that the owner may be waiting for this thread.
    #[inline]
    pub(crate) fn lock_or_pass(
        &self,
        py: Python<'_>,
        may_pass: impl Fn() -> bool,
    ) -> PyResult<ThreadGuard<'_>> {
        let thread = thread_number::current();
        if self.owner.number() == thread {
            return Ok(ThreadGuard { lock: self, thread, way: Way::Nested });
        }
        let way =
            if self.owner.claim(thread) { Way::Free } else { self.wait(py, thread, &may_pass)? };
        shared::add(&self.turns, 1);
        Ok(ThreadGuard { lock: self, thread, way })
    }

    #[cold]
    fn wait(&self, py: Python<'_>, thread: u64, may_pass: &dyn Fn() -> bool) -> PyResult<Way> {
        self.waiting.fetch_add(1, SeqCst);
        let way = self.wait_for_way(py, thread, may_pass);
        self.waiting.fetch_sub(1, SeqCst);
        way
    }

    fn wait_for_way(
        &self,
        py: Python<'_>,
        thread: u64,
        may_pass: &dyn Fn() -> bool,
    ) -> PyResult<Way> {
        let (mut turns, mut waits) = (self.turns.load(Relaxed), 0);
        loop {
            if self.owner.claim(thread) {
                return Ok(Way::Free);
            }
            if self.inherit(py, thread) {
                return Ok(Way::Inherited);
            }
            if waits >= PATIENCE {
                waits = 0;
                let owner = self.owner.number();
                if may_pass() && self.is_same_turn(turns) && self.owner.replace(owner, thread) {
                    return Ok(Way::Passed);
                }
            }
            // Another waiter has the gate for a moment only, unless it is one that a fork left behind.
            let waited = py.detach(|| match self.gate.try_lock() {
                Ok(gate) => {
                    self.freed.wait_timeout(gate, INTERVAL).is_ok_and(|(_, end)| end.timed_out())
                }
                Err(_) => {
                    std::thread::yield_now();
                    false
                }
            });
            py.check_signals()?;
            waits += u32::from(waited);
            if !self.is_same_turn(turns) {
                (turns, waits) = (self.turns.load(Relaxed), 0);
            }
        }
    }

    fn is_same_turn(&self, turns: u64) -> bool {
        self.turns.load(Relaxed) == turns
    }

    /// Takes the lock from a thread that will never free it: it does not exist in this process, which was forked while it
    /// held it, or it is a daemon thread, none of which runs again once the interpreter ends.
    fn inherit(&self, py: Python<'_>, thread: u64) -> bool {
        let owner = self.owner.number();
        let is_left = owner != 0 && (thread_number::is_gone(owner) || is_ending(py));
        is_left && self.owner.replace(owner, thread)
    }
}

/// Whether only this thread still runs Python code.
fn is_ending(py: Python<'_>) -> bool {
    let answer = IS_FINALIZING.get(py).and_then(|is_finalizing| is_finalizing.invoke1(()));
    answer.and_then(|answer| answer.truth()).unwrap_or(false)
}

/// While it lives, nobody else holds the lock, unless somebody passed.
pub(crate) struct ThreadGuard<'a> {
    lock: &'a ThreadLock,
    thread: u64,
    way: Way,
}

impl ThreadGuard<'_> {
    /// The thread held the lock already.
    pub(crate) fn is_nested(&self) -> bool {
        self.way == Way::Nested
    }

    /// What the lock guards may have been left half done.
    pub(crate) fn is_inherited(&self) -> bool {
        self.way == Way::Inherited
    }

    /// Another thread is still at what the lock guards.
    pub(crate) fn has_passed(&self) -> bool {
        self.way == Way::Passed
    }

    /// Nobody has passed.
    #[inline]
    pub(crate) fn is_held(&self) -> bool {
        self.lock.owner.number() == self.thread
    }
}

impl Drop for ThreadGuard<'_> {
    #[inline]
    fn drop(&mut self) {
        if self.way == Way::Nested {
            return;
        }
        self.lock.owner.give_up(self.thread);
        if self.lock.waiting.load(SeqCst) > 0 {
            self.lock.freed.notify_one();
        }
    }
}
