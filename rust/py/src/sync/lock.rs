//! A mutex for values that only attached threads touch, and never while Python code runs.
//!
//! The interpreter's lock is the mutex, see `docs/decisions`. Here is only checked that no thread let go of it half-way.

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use pyo3::prelude::*;

/// See the module.
pub(crate) struct Lock<T> {
    held: AtomicBool,
    value: UnsafeCell<T>,
}

// SAFETY: the value is only reached through `lock`, which takes the proof that the thread is attached, and through
// `held`, which a thread sets before and clears after. Only one thread is attached at a time, and the interpreter's
// lock orders what one thread writes before what the next one reads.
unsafe impl<T: Send> Sync for Lock<T> {}

/// Access to the value.
pub(crate) struct Guard<'a, T>(&'a Lock<T>);

impl<T> Lock<T> {
    pub(crate) const fn new(value: T) -> Self {
        Self { held: AtomicBool::new(false), value: UnsafeCell::new(value) }
    }

    #[inline]
    pub(crate) fn lock(&self, py: Python<'_>) -> Guard<'_, T> {
        while self.held.load(Relaxed) {
            wait(py);
        }
        self.held.store(true, Relaxed);
        Guard(self)
    }

    /// The value, for the garbage collector; `None` while another call holds it.
    ///
    /// # Safety
    /// The thread must be attached.
    pub(crate) unsafe fn try_lock(&self) -> Option<Guard<'_, T>> {
        if self.held.load(Relaxed) {
            return None;
        }
        self.held.store(true, Relaxed);
        Some(Guard(self))
    }
}

/// Lets the thread go on that was interrupted while it held the lock.
#[cold]
fn wait(py: Python<'_>) {
    py.detach(std::thread::yield_now);
}

impl<T> Deref for Guard<'_, T> {
    type Target = T;

    #[inline]
    fn deref(&self) -> &T {
        // SAFETY: there is one guard at a time.
        unsafe { &*self.0.value.get() }
    }
}

impl<T> DerefMut for Guard<'_, T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as above.
        unsafe { &mut *self.0.value.get() }
    }
}

impl<T> Drop for Guard<'_, T> {
    #[inline]
    fn drop(&mut self) {
        self.0.held.store(false, Relaxed);
    }
}
