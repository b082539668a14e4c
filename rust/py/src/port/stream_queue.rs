//! Frames that wait to be sent on a stream.

use std::collections::VecDeque;

/// The bytes that were not sent, and which frames these are.
#[derive(Default)]
pub(crate) struct StreamQueue {
    bytes: Vec<u8>,
    /// Of `bytes`, so many were sent.
    sent: usize,
    lengths: VecDeque<usize>,
    /// Bytes of the first frame that were sent.
    begun: usize,
    /// How often everything was forgotten.
    epoch: u64,
}

impl StreamQueue {
    pub(crate) fn unsent(&self) -> &[u8] {
        &self.bytes[self.sent..]
    }

    pub(crate) fn epoch(&self) -> u64 {
        self.epoch
    }

    pub(crate) fn add(&mut self, frame: &[u8]) {
        self.lengths.push_back(frame.len());
        self.bytes.extend_from_slice(frame);
    }

    /// So many bytes were sent of those that waited in an `epoch`.
    pub(crate) fn take_off(&mut self, epoch: u64, count: usize) {
        if epoch != self.epoch {
            return;
        }
        let count = count.min(self.unsent().len());
        self.sent += count;
        self.begun += count;
        while let Some(&length) = self.lengths.front()
            && self.begun >= length
        {
            self.begun -= length;
            self.lengths.pop_front();
        }
        // Moved once in a while: a slow peer takes a large queue in small pieces.
        if self.sent * 2 >= self.bytes.len() {
            self.bytes.drain(..self.sent);
            self.sent = 0;
        }
    }

    /// Empties it and says how many frames were in it, of which the first may be sent in part.
    pub(crate) fn forget(&mut self) -> usize {
        let count = self.lengths.len();
        *self = Self { epoch: self.epoch + 1, ..Self::default() };
        count
    }
}
