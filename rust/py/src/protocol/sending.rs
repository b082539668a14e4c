//! The state that the frames of one sender share, and the lock that keeps them in sequence.

use std::sync::atomic::{AtomicI64, AtomicU64, Ordering::Relaxed};

use crate::sync::shared;
use crate::sync::thread_lock::ThreadLock;

/// Sequence number, counters, and the lock that is held from taking a sequence number until the frame is written, so that
/// frames leave in sequence and no signing timestamp is used twice.
pub(crate) struct Sending {
    pub(crate) lock: ThreadLock,
    pub(crate) seq: AtomicI64,
    pub(crate) packets: AtomicU64,
    pub(crate) bytes: AtomicU64,
}

impl Sending {
    pub(crate) const fn new() -> Self {
        Self {
            lock: ThreadLock::new(),
            seq: AtomicI64::new(0),
            packets: AtomicU64::new(0),
            bytes: AtomicU64::new(0),
        }
    }

    #[inline]
    pub(crate) fn seq(&self) -> i64 {
        self.seq.load(Relaxed)
    }

    /// Goes on from `seq` to the next sequence number, unless another frame has done so.
    #[inline]
    pub(crate) fn advance(&self, seq: i64) {
        if self.seq() == seq {
            self.seq.store(seq.wrapping_add(1).rem_euclid(256), Relaxed);
        }
    }

    #[inline]
    pub(crate) fn count(&self, frames: usize, len: usize) {
        shared::add(&self.packets, frames as u64);
        shared::add(&self.bytes, len as u64);
    }
}
