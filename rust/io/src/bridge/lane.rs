//! Frames one behind the other in memory, oldest first.

use std::collections::VecDeque;

#[derive(Debug, Clone, Copy)]
struct Waiting {
    len: u16,
    /// When it arrived; microseconds, which come round after 71 minutes.
    since: u32,
}

/// A queue of frames without a limit.
#[derive(Debug, Default)]
pub(super) struct Lane {
    bytes: Vec<u8>,
    /// `bytes[start..]` waits.
    start: usize,
    waiting: VecDeque<Waiting>,
}

impl Lane {
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Bytes that wait.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.bytes.len() - self.start
    }

    /// Frames that wait.
    pub(super) fn frames(&self) -> usize {
        self.waiting.len()
    }

    /// All that waits.
    #[inline]
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes[self.start..]
    }

    /// Appends a frame; false where there is no memory for it.
    #[inline]
    #[must_use]
    pub(super) fn push(&mut self, frame: &[u8], since: u32) -> bool {
        if self.start > self.bytes.len() / 2 {
            self.bytes.drain(..self.start);
            self.start = 0;
        }
        if self.bytes.try_reserve(frame.len()).is_err() || self.waiting.try_reserve(1).is_err() {
            return false;
        }
        self.bytes.extend_from_slice(frame);
        self.waiting.push_back(Waiting { len: frame.len() as u16, since });
        true
    }

    /// Length of the oldest frame, and when it arrived.
    #[inline]
    pub(super) fn front(&self) -> Option<(usize, u32)> {
        self.waiting.front().map(|front| (front.len.into(), front.since))
    }

    /// Takes the oldest frame out.
    #[inline]
    pub(super) fn take_front(&mut self) -> Option<(usize, u32)> {
        let front = self.waiting.pop_front()?;
        self.start += usize::from(front.len);
        Some((front.len.into(), front.since))
    }

    /// How many of the waiting frames share each datagram of up to `longest` bytes, and how long it is.
    pub(super) fn datagrams(&self, longest: usize) -> impl Iterator<Item = (usize, usize)> {
        let mut lens = self.waiting.iter().map(|waiting| usize::from(waiting.len)).peekable();
        std::iter::from_fn(move || {
            let (mut frames, mut len) = (1, lens.next()?);
            while let Some(next) = lens.next_if(|next| len + next <= longest) {
                (frames, len) = (frames + 1, len + next);
            }
            Some((frames, len))
        })
    }
}
