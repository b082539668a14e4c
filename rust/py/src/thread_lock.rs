//! A lock that knows the thread that holds it, which may run Python code, be interrupted by a signal's handler, and take it
//! again.
//!
//! Nearly always the lock is free, and taken in two nanoseconds; a standard mutex is another five for every message sent.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering::Relaxed, Ordering::SeqCst};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use pyo3::prelude::*;

use crate::calling::{Calling, Known};
use crate::lock::Lock;
use crate::owner::Owner;
use crate::{shared, thread_number};

/// Waiting threads look again after this time even if nobody told them to.
const INTERVAL: Duration = Duration::from_millis(10);
/// So often, that is for a second, in which the lock did not change hands. Counted, not timed: where a process or all of a
/// machine stood still, nobody has waited.
const PATIENCE: u32 = 100;
/// Whoever has waited for so long is handed the lock. Before that it may be taken by a thread that is running anyway, since
/// changing threads takes longer than most of what the lock is held for.
const FAIR_WAIT: Duration = Duration::from_micros(500);

static IS_FINALIZING: Known = Known::new("sys", "is_finalizing");

/// To be called when the module is loaded, since what asks for it later may be the end of the interpreter.
pub(crate) fn prepare(py: Python<'_>) -> PyResult<()> {
    IS_FINALIZING.get(py).map(drop)
}

/// See the module.
pub(crate) struct ThreadLock {
    owner: Owner,
    /// The owner was handed the lock, and has not noticed yet.
    handed: AtomicBool,
    /// How often it was taken.
    turns: AtomicU64,
    /// The length of `waiters`.
    waiting: AtomicU32,
    /// Who has waited the longest comes first.
    waiters: Lock<Vec<Waiter>>,
}

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
            handed: AtomicBool::new(false),
            turns: AtomicU64::new(0),
            waiting: AtomicU32::new(0),
            waiters: Lock::new(Vec::new()),
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

    #[inline]
    fn take(&self, py: Python<'_>, may_pass: bool) -> PyResult<ThreadGuard<'_>> {
        let thread = thread_number::current();
        let way = if self.owner.number() == thread {
            if !self.accept(py, thread) {
                return Ok(ThreadGuard { lock: self, thread, way: Way::Nested });
            }
            Way::Free // a signal handler gets it before what it interrupts in its wait
        } else if self.owner.claim(thread) {
            Way::Free
        } else {
            self.wait(py, thread, may_pass)?
        };
        shared::add(&self.turns, 1);
        Ok(ThreadGuard { lock: self, thread, way })
    }

    /// Whether this thread was handed the lock.
    fn accept(&self, py: Python<'_>, thread: u64) -> bool {
        self.handed.load(SeqCst) && {
            let _waiters = self.waiters.lock(py);
            self.owner.number() == thread && self.handed.swap(false, SeqCst)
        }
    }

    /// Takes the lock from its `owner`. One that was handed it and has not noticed was not in the middle of anything.
    fn seize(&self, py: Python<'_>, owner: u64, thread: u64, way: Way) -> Option<Way> {
        let _waiters = self.waiters.lock(py);
        let is_seized = self.owner.replace(owner, thread);
        is_seized.then(|| if self.handed.swap(false, SeqCst) { Way::Free } else { way })
    }

    #[cold]
    fn wait(&self, py: Python<'_>, thread: u64, may_pass: bool) -> PyResult<Way> {
        let waiter = Waiter { number: thread, thread: thread::current(), since: Instant::now() };
        self.change_waiters(py, |waiters| waiters.push(waiter));
        let way = self.wait_for_way(py, thread, may_pass);
        self.change_waiters(py, |waiters| {
            // The last one, if the thread waits in a signal handler too.
            if let Some(place) = waiters.iter().rposition(|waiter| waiter.number == thread) {
                waiters.remove(place);
            }
        });
        if way.is_err() && self.accept(py, thread) {
            self.free(py, thread);
        }
        way
    }

    fn change_waiters(&self, py: Python<'_>, change: impl FnOnce(&mut Vec<Waiter>)) {
        let mut waiters = self.waiters.lock(py);
        change(&mut waiters);
        self.waiting.store(waiters.len() as u32, SeqCst);
    }

    fn wait_for_way(&self, py: Python<'_>, thread: u64, may_pass: bool) -> PyResult<Way> {
        let (mut turns, mut waits) = (self.turns.load(Relaxed), 0);
        loop {
            if self.accept(py, thread) || self.owner.claim(thread) {
                return Ok(Way::Free);
            }
            if let Some(way) = self.inherit(py, thread) {
                return Ok(way);
            }
            if waits >= PATIENCE && may_pass {
                let owner = self.owner.number();
                if self.is_same_turn(turns)
                    && let Some(way) = self.seize(py, owner, thread, Way::Passed)
                {
                    return Ok(way);
                }
            }
            py.detach(|| thread::park_timeout(INTERVAL));
            py.check_signals()?;
            waits += 1;
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
    fn inherit(&self, py: Python<'_>, thread: u64) -> Option<Way> {
        let owner = self.owner.number();
        let is_left = owner != 0 && (thread_number::is_gone(owner) || is_ending(py));
        if is_left { self.seize(py, owner, thread, Way::Inherited) } else { None }
    }

    /// Hands the lock to who has waited for long, or frees it and tells whoever waits.
    #[cold]
    fn free(&self, py: Python<'_>, thread: u64) {
        self.change_waiters(py, |waiters| {
            waiters.retain(|waiter| !thread_number::is_gone(waiter.number));
            let Some(first) = waiters.first() else { return self.owner.give_up(thread) };
            if first.since.elapsed() < FAIR_WAIT {
                self.owner.give_up(thread);
            } else if self.owner.number() == thread {
                self.handed.store(true, SeqCst);
                self.owner.replace(thread, first.number);
            }
            first.thread.unpark();
        });
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
        if self.lock.waiting.load(SeqCst) == 0 {
            self.lock.owner.give_up(self.thread);
        } else {
            // SAFETY: a guard lives in a call from Python, which it ends in attached.
            self.lock.free(unsafe { Python::assume_attached() }, self.thread);
        }
    }
}
