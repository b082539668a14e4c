//! Which thread has what only one may have at a time.

use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

#[cfg(not(Py_GIL_DISABLED))]
use std::sync::atomic::Ordering::Relaxed;

use crate::sync::thread_number;

/// The number of the thread that has it; 0 while nobody does. Nearly always nobody does, which under the interpreter's lock
/// takes a look and a store to find out and to change.
pub(crate) struct Owner(AtomicU64);

impl Owner {
    pub(crate) const fn new() -> Self {
        Self(AtomicU64::new(0))
    }

    #[inline]
    pub(crate) fn number(&self) -> u64 {
        self.0.load(SeqCst)
    }

    /// Whether the owner is left behind by a fork.
    #[inline]
    pub(crate) fn is_gone(&self) -> bool {
        let owner = self.number();
        owner != 0 && thread_number::is_gone(owner)
    }

    /// Takes it if nobody has it.
    #[cfg(not(Py_GIL_DISABLED))]
    #[inline]
    pub(crate) fn claim(&self, number: u64) -> bool {
        // Whoever is attached is alone.
        let free = self.0.load(Relaxed) == 0;
        if free {
            self.0.store(number, Relaxed);
        }
        free
    }

    #[cfg(Py_GIL_DISABLED)]
    pub(crate) fn claim(&self, number: u64) -> bool {
        self.replace(0, number)
    }

    /// Takes it from its owner, or gives it up with 0; false if somebody else has it by now.
    pub(crate) fn replace(&self, owner: u64, number: u64) -> bool {
        self.0.compare_exchange(owner, number, SeqCst, SeqCst).is_ok()
    }

    /// Gives it up, if it is still this thread's.
    #[inline]
    pub(crate) fn give_up(&self, number: u64) {
        #[cfg(not(Py_GIL_DISABLED))]
        if self.0.load(Relaxed) == number {
            self.0.store(0, Relaxed);
        }
        #[cfg(Py_GIL_DISABLED)]
        self.replace(number, 0);
    }
}
