//! Cheap updates of values that several threads see.
//!
//! Under the interpreter's lock one thread is attached at a time, so that a load and a store do. An atomic
//! read-modify-write would cost three times as much.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// Adds to a counter.
#[inline]
pub(crate) fn add(counter: &AtomicU64, number: u64) {
    counter.store(counter.load(Relaxed).wrapping_add(number), Relaxed);
}

/// Sets bits and returns the bits before.
#[inline]
pub(crate) fn set_bits(flags: &AtomicU32, bits: u32) -> u32 {
    let before = flags.load(Relaxed);
    flags.store(before | bits, Relaxed);
    before
}
