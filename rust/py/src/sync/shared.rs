//! Cheap updates of values that several threads see.
//!
//! Where the interpreter has its lock, whoever is attached is alone, so that a load and a store do; an atomic
//! read-modify-write would cost three times as much. Free-threaded builds get the real thing.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// Adds to a counter.
#[inline]
pub(crate) fn add(counter: &AtomicU64, number: u64) {
    #[cfg(not(Py_GIL_DISABLED))]
    counter.store(counter.load(Relaxed).wrapping_add(number), Relaxed);
    #[cfg(Py_GIL_DISABLED)]
    counter.fetch_add(number, Relaxed);
}

/// Sets bits and returns what was there before.
#[inline]
pub(crate) fn set_bits(flags: &AtomicU32, bits: u32) -> u32 {
    #[cfg(not(Py_GIL_DISABLED))]
    {
        let before = flags.load(Relaxed);
        flags.store(before | bits, Relaxed);
        before
    }
    #[cfg(Py_GIL_DISABLED)]
    flags.fetch_or(bits, Relaxed)
}
