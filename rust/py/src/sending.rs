//! What the frames of one sender have in common, and what keeps them in sequence.

use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering::Relaxed, Ordering::SeqCst};

use crate::shared;
use crate::thread_lock::ThreadLock;

/// Sequence number, counters, and the lock that is held from taking a sequence number until the frame is written, so that
/// frames leave in sequence and no signing timestamp is used twice.
pub(crate) struct Sending {
    pub(crate) lock: ThreadLock,
    pub(crate) seq: AtomicI64,
    pub(crate) packets: AtomicU64,
    pub(crate) bytes: AtomicU64,
    /// What is written to waits for threads that send: frames are written without the lock.
    pub(crate) writes_unlocked: AtomicBool,
}

impl Sending {
    pub(crate) const fn new() -> Self {
        Self {
            lock: ThreadLock::new(),
            seq: AtomicI64::new(0),
            packets: AtomicU64::new(0),
            bytes: AtomicU64::new(0),
            writes_unlocked: AtomicBool::new(false),
        }
    }

    /// On to the next sequence number; the one before.
    #[inline]
    pub(crate) fn advance(&self) -> i64 {
        let seq = self.seq.load(Relaxed);
        self.seq.store(next(seq), Relaxed);
        seq
    }

    /// The frame with this sequence number was not written: it is the next one, unless another one was taken since.
    pub(crate) fn take_back(&self, seq: i64) {
        let _ = self.seq.compare_exchange(next(seq), seq, SeqCst, Relaxed);
    }

    #[inline]
    pub(crate) fn count(&self, len: usize) {
        shared::add(&self.packets, 1);
        shared::add(&self.bytes, len as u64);
    }
}

fn next(seq: i64) -> i64 {
    seq.wrapping_add(1).rem_euclid(256)
}
