//! A lock that knows the thread that holds it, which may run Python code, be interrupted by a signal's handler, and take it
//! again.
//!
//! Nearly always the lock is free, and taken in two nanoseconds; a standard mutex is another five for every message sent.
//!
//! A lock that is freed is free: nobody is handed it, since who waits may be busy with a signal's handler. Instead, who comes
//! to it leaves it once to those who have waited for long. These are known while they are parked, and run nothing else
//! before they take it, so that it is not left to anybody who does not come.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed, Ordering::SeqCst};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use pyo3::prelude::*;

use crate::python::calling::{Calling, Known};
use crate::sync::lock::Lock;
use crate::sync::shared;
use crate::sync::thread_number;
use crate::sync::thread_owner::Owner;

/// Waiting threads look again after this time even if nobody told them to.
const INTERVAL: Duration = Duration::from_millis(10);
/// So often, that is for a second, in which the lock did not change hands. Counted, not timed: where a process or all of a
/// machine stood still, nobody has waited.
const PATIENCE: u32 = 100;
/// Whoever has waited for so long has the lock left to it. Before that it may be taken by a thread that is running anyway,
/// since changing threads takes longer than most of what the lock is held for.
const FAIR_WAIT: Duration = Duration::from_micros(500);

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
    /// The length of `parked`.
    waiting: AtomicU32,
    /// Who has waited the longest comes first.
    parked: Lock<Vec<Waiter>>,
}

#[derive(Clone)]
struct Waiter {
    number: u64,
    thread: Thread,
    since: Instant,
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
            parked: Lock::new(Vec::new()),
        }
    }

    /// Waits for its turn; an error if the user's signal handler raises meanwhile.
    pub(crate) fn lock(&self, py: Python<'_>) -> PyResult<ThreadGuard<'_>> {
        self.take(py, false)
    }

    /// Waits for its turn, but goes past an owner that has kept the lock for a second: it may be waiting for this thread.
    #[inline]
    pub(crate) fn lock_or_pass(&self, py: Python<'_>) -> PyResult<ThreadGuard<'_>> {
        self.take(py, true)
    }

    /// Does not wait: `None` while somebody holds it, be it this thread.
    pub(crate) fn try_lock(&self, py: Python<'_>) -> Option<ThreadGuard<'_>> {
        let thread = thread_number::current();
        let way = self.claim(thread).or_else(|| self.inherit(py, thread))?;
        Some(ThreadGuard { lock: self, thread, way })
    }

    #[inline]
    fn take(&self, py: Python<'_>, may_pass: bool) -> PyResult<ThreadGuard<'_>> {
        let thread = thread_number::current();
        let way = if self.owner.number() == thread {
            Way::Nested
        } else if self.waiting.load(SeqCst) == 0
            && let Some(way) = self.claim(thread)
        {
            way
        } else {
            self.wait(py, thread, may_pass)?
        };
        Ok(ThreadGuard { lock: self, thread, way })
    }

    #[inline]
    fn claim(&self, thread: u64) -> Option<Way> {
        self.taken(self.owner.claim(thread), Way::Free)
    }

    #[cold]
    fn wait(&self, py: Python<'_>, thread: u64, may_pass: bool) -> PyResult<Way> {
        let this = Waiter { number: thread, thread: thread::current(), since: Instant::now() };
        let (mut turns, mut waits) = (self.turns.load(Relaxed), 0);
        if self.is_left_to_others(py, &this) {
            self.park(py, &this);
        }
        loop {
            if let Some(way) = self.claim(thread).or_else(|| self.inherit(py, thread)) {
                return Ok(way);
            }
            if may_pass
                && waits >= PATIENCE
                && let Some(way) = self.pass(thread, turns)
            {
                return Ok(way);
            }
            self.park(py, &this);
            // Others left it to this thread: handlers of signals come later.
            if let Some(way) = self.claim(thread) {
                return Ok(way);
            }
            py.check_signals()?;
            waits += 1;
            if self.turns.load(Relaxed) != turns {
                (turns, waits) = (self.turns.load(Relaxed), 0);
            }
        }
    }

    /// Whether somebody else has waited for long.
    fn is_left_to_others(&self, py: Python<'_>, this: &Waiter) -> bool {
        self.change_parked(py, |parked| {
            parked.first().is_some_and(|first| this.since - first.since >= FAIR_WAIT)
        })
    }

    /// Waits to be woken, for an interval at most. Nothing of the user's runs while others count on this thread.
    fn park(&self, py: Python<'_>, this: &Waiter) {
        self.change_parked(py, |parked| {
            let place = parked.partition_point(|other| other.since <= this.since);
            parked.insert(place, this.clone());
        });
        py.detach(|| thread::park_timeout(INTERVAL));
        self.change_parked(py, |parked| parked.retain(|other| other.number != this.number));
    }

    fn change_parked<T>(&self, py: Python<'_>, change: impl FnOnce(&mut Vec<Waiter>) -> T) -> T {
        let mut parked = self.parked.lock(py);
        parked.retain(|waiter| !thread_number::is_gone(waiter.number));
        let result = change(&mut parked);
        self.waiting.store(parked.len() as u32, SeqCst);
        result
    }

    /// Takes the lock from a thread that will never free it: it does not exist in this process, which was forked while it
    /// held it, or it is a daemon thread, none of which runs again once the interpreter ends.
    fn inherit(&self, py: Python<'_>, thread: u64) -> Option<Way> {
        let owner = self.owner.number();
        let is_left = owner != 0 && (thread_number::is_gone(owner) || is_ending(py));
        self.taken(is_left && self.owner.replace(owner, thread), Way::Inherited)
    }

    /// Takes the lock from a thread that has kept it since the turn before `turns`.
    fn pass(&self, thread: u64, turns: u64) -> Option<Way> {
        let owner = self.owner.number();
        let is_stuck = owner != 0 && self.turns.load(Relaxed) == turns;
        self.taken(is_stuck && self.owner.replace(owner, thread), Way::Passed)
    }

    #[inline]
    fn taken(&self, is_taken: bool, way: Way) -> Option<Way> {
        if is_taken {
            shared::add(&self.turns, 1);
        }
        is_taken.then_some(way)
    }

    /// Wakes who has waited for the longest.
    #[cold]
    fn wake(&self, py: Python<'_>) {
        self.change_parked(py, |parked| {
            if let Some(first) = parked.first() {
                first.thread.unpark();
            }
        });
    }
}

/// Whether only this thread still runs Python code.
fn is_ending(py: Python<'_>) -> bool {
    let answer = IS_FINALIZING.get(py).and_then(|is_finalizing| is_finalizing.invoke1(()));
    answer.and_then(|answer| answer.is_truthy()).unwrap_or(false)
}

/// While it lives, nobody else holds the lock, unless somebody passed.
pub(crate) struct ThreadGuard<'a> {
    lock: &'a ThreadLock,
    thread: u64,
    way: Way,
}

impl ThreadGuard<'_> {
    /// Nobody passed.
    #[inline]
    pub(crate) fn is_held(&self) -> bool {
        self.lock.owner.number() == self.thread
    }

    /// Somebody is in the middle of what the lock guards: this thread, or one that was passed.
    pub(crate) fn is_beside(&self) -> bool {
        matches!(self.way, Way::Nested | Way::Passed)
    }

    /// What the lock guards may have been left half done.
    pub(crate) fn is_inherited(&self) -> bool {
        self.way == Way::Inherited
    }
}

impl Drop for ThreadGuard<'_> {
    #[inline]
    fn drop(&mut self) {
        if self.way == Way::Nested {
            return;
        }
        self.lock.owner.give_up(self.thread);
        if self.lock.waiting.load(SeqCst) != 0 {
            // SAFETY: a guard lives in a call from Python, which it ends in attached.
            self.lock.wake(unsafe { Python::assume_attached() });
        }
    }
}
