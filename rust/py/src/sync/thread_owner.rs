//! The thread that holds something which only one thread may hold at a time.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::sync::thread_number;

/// The number of the thread that holds it, or 0. The interpreter's lock makes a load and a store one step.
pub(crate) struct Owner(AtomicU64);

impl Owner {
    pub(crate) const fn new() -> Self {
        Self(AtomicU64::new(0))
    }

    #[inline]
    pub(crate) fn number(&self) -> u64 {
        self.0.load(Relaxed)
    }

    /// Whether the owner is left behind by a fork.
    #[inline]
    pub(crate) fn is_gone(&self) -> bool {
        let owner = self.number();
        owner != 0 && thread_number::is_gone(owner)
    }

    /// Takes it if no thread of this process holds it.
    #[inline]
    pub(crate) fn claim(&self, number: u64) -> bool {
        let is_free = self.number() == 0 || self.is_gone();
        if is_free {
            self.0.store(number, Relaxed);
        }
        is_free
    }

    /// Takes it from its owner; false if another thread has it by now.
    pub(crate) fn replace(&self, owner: u64, number: u64) -> bool {
        let is_owner = self.number() == owner;
        if is_owner {
            self.0.store(number, Relaxed);
        }
        is_owner
    }

    /// Gives it up, if it is still this thread's.
    #[inline]
    pub(crate) fn give_up(&self, number: u64) {
        self.replace(number, 0);
    }
}
