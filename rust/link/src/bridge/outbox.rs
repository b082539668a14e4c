//! What waits to leave through a link: whole frames, so many bytes at most. A link that cannot keep up loses its oldest
//! frames, and no other link waits for it.

use std::collections::VecDeque;
use std::io;

use mavwire_core::frame::MAX_FRAME_LEN;

/// A bounded queue of frames, side by side in memory.
#[derive(Debug)]
pub(super) struct Outbox {
    bytes: Vec<u8>,
    /// `bytes[start..]` waits.
    start: usize,
    lens: VecDeque<u16>,
    /// The rest of a frame that a stream took the beginning of: it has to follow, or the stream is broken.
    rest: Vec<u8>,
    limit: usize,
    /// Frames share a datagram up to this length.
    datagram: usize,
    pub(super) sent: u64,
    pub(super) sent_bytes: u64,
    pub(super) dropped: u64,
}

impl Outbox {
    /// `limit` in bytes; one frame always has room. Frames that wait together share a datagram up to `datagram` bytes;
    /// 0 for one in each.
    pub(super) fn new(limit: usize, datagram: usize) -> Self {
        Self {
            bytes: Vec::new(),
            start: 0,
            lens: VecDeque::new(),
            rest: Vec::new(),
            limit: limit.max(MAX_FRAME_LEN),
            datagram,
            sent: 0,
            sent_bytes: 0,
            dropped: 0,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lens.is_empty() && self.rest.is_empty()
    }

    /// Bytes that wait.
    pub(super) fn queued(&self) -> usize {
        self.bytes.len() - self.start + self.rest.len()
    }

    /// Queues a frame; the oldest ones make room for it.
    #[inline]
    pub(super) fn push(&mut self, frame: &[u8]) {
        while self.bytes.len() - self.start + frame.len() > self.limit {
            self.take_front();
            self.dropped += 1;
        }
        if self.start > self.bytes.len() / 2 {
            self.bytes.drain(..self.start);
            self.start = 0;
        }
        self.bytes.extend_from_slice(frame);
        self.lens.push_back(frame.len() as u16);
    }

    /// Takes the oldest frame out; its length.
    fn take_front(&mut self) -> usize {
        let len = usize::from(self.lens.pop_front().unwrap_or(0));
        self.start += len;
        len
    }

    /// Drops everything, as a link does that goes down.
    pub(super) fn clear(&mut self) {
        self.dropped += self.lens.len() as u64 + u64::from(!self.rest.is_empty());
        self.bytes = Vec::new();
        self.start = 0;
        self.lens.clear();
        self.rest.clear();
    }

    /// Writes to a stream until nothing is left or it takes no more; true if nothing is left.
    pub(super) fn write_to(
        &mut self,
        mut write: impl FnMut(&[u8]) -> io::Result<usize>,
    ) -> io::Result<bool> {
        while !self.is_empty() {
            let from_rest = !self.rest.is_empty();
            let waiting = if from_rest { &self.rest[..] } else { &self.bytes[self.start..] };
            let written = match write(waiting) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(written) => written,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(false),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            self.sent_bytes += written as u64;
            if from_rest {
                self.rest.drain(..written);
                self.sent += u64::from(self.rest.is_empty());
            } else {
                self.written(written);
            }
        }
        Ok(true)
    }

    /// Takes out what a stream took of the front.
    fn written(&mut self, mut len: usize) {
        while let Some(&front) = self.lens.front() {
            let front = usize::from(front);
            if len < front {
                if len > 0 {
                    self.rest.extend_from_slice(&self.bytes[self.start + len..self.start + front]);
                    self.take_front();
                }
                return;
            }
            len -= self.take_front();
            self.sent += 1;
        }
    }

    /// How many of the waiting frames share each datagram, and how long it is.
    fn datagrams(&self) -> impl Iterator<Item = (usize, usize)> {
        let mut lens = self.lens.iter().map(|&len| usize::from(len)).peekable();
        let longest = self.datagram;
        std::iter::from_fn(move || {
            let (mut frames, mut len) = (1, lens.next()?);
            while let Some(next) = lens.next_if(|next| len + next <= longest) {
                (frames, len) = (frames + 1, len + next);
            }
            Some((frames, len))
        })
    }

    /// Hands the oldest frames as datagrams, `at_most` of them, to a call that says how many it took.
    pub(super) fn send_with(
        &mut self,
        at_most: usize,
        send: impl FnOnce(&mut dyn Iterator<Item = &[u8]>) -> io::Result<usize>,
    ) -> io::Result<()> {
        let count = {
            let mut at = self.start;
            let mut datagrams = self.datagrams().take(at_most).map(|(_, len)| {
                let from = at;
                at += len;
                &self.bytes[from..at]
            });
            send(&mut datagrams)?
        };
        let frames: usize = self.datagrams().take(count).map(|(frames, _)| frames).sum();
        for _ in 0..frames {
            self.sent_bytes += self.take_front() as u64;
            self.sent += 1;
        }
        Ok(())
    }

    /// Drops the oldest frame, which could not be sent.
    pub(super) fn drop_front(&mut self) {
        if !self.lens.is_empty() {
            self.take_front();
            self.dropped += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(n: u8) -> Vec<u8> {
        vec![n; 100]
    }

    /// What a stream gets that takes `chunk` bytes at a time.
    fn drain(outbox: &mut Outbox, chunk: usize) -> Vec<u8> {
        let mut out = Vec::new();
        let write = |bytes: &[u8]| {
            let len = chunk.min(bytes.len());
            out.extend_from_slice(&bytes[..len]);
            Ok(len)
        };
        assert!(outbox.write_to(write).unwrap());
        out
    }

    #[test]
    fn a_stream_gets_whole_frames_in_order_however_it_takes_them() {
        for chunk in [1, 7, 99, 100, 101, 250, 10_000] {
            let mut outbox = Outbox::new(10_000, 0);
            let expected: Vec<u8> = (0..20).flat_map(frame).collect();
            (0..20).for_each(|n| outbox.push(&frame(n)));
            assert_eq!(drain(&mut outbox, chunk), expected, "{chunk}");
            assert_eq!((outbox.sent, outbox.sent_bytes, outbox.dropped), (20, 2_000, 0));
            assert!(outbox.is_empty());
        }
    }

    #[test]
    fn r63_the_oldest_go_but_never_half_a_frame() {
        let mut outbox = Outbox::new(1_000, 0);
        (0..5).for_each(|n| outbox.push(&frame(n)));
        let mut begun = Vec::new();
        let mut room = 150;
        let blocked = outbox.write_to(|bytes| {
            let len = bytes.len().min(room);
            room -= len;
            begun.extend_from_slice(&bytes[..len]);
            if len == 0 { Err(io::ErrorKind::WouldBlock.into()) } else { Ok(len) }
        });
        assert!(!blocked.unwrap());
        (5..40).for_each(|n| outbox.push(&frame(n)));
        assert!(outbox.queued() <= 1_050, "{}", outbox.queued());
        begun.extend(drain(&mut outbox, 64));
        let expected: Vec<u8> = [0, 1].into_iter().chain(30..40).flat_map(frame).collect();
        assert_eq!(begun, expected);
        assert_eq!((outbox.sent, outbox.dropped), (12, 28));
    }

    #[test]
    fn datagrams_leave_as_many_as_were_taken() {
        let mut outbox = Outbox::new(1_000, 0);
        (0..5).for_each(|n| outbox.push(&frame(n)));
        let mut seen = Vec::new();
        outbox
            .send_with(3, |frames| {
                seen.extend(frames.map(|frame| (frame[0], frame.len())));
                Ok(2)
            })
            .unwrap();
        assert_eq!(seen, [(0, 100), (1, 100), (2, 100)]);
        outbox.drop_front();
        assert_eq!(drain(&mut outbox, 1_000), [frame(3), frame(4)].concat());
        outbox.push(&frame(9));
        outbox.clear();
        outbox.drop_front();
        assert_eq!((outbox.sent, outbox.dropped, outbox.queued()), (4, 2, 0));
    }

    #[test]
    fn frames_share_a_datagram_as_far_as_it_is_long_enough() {
        for (longest, lens) in [(0, vec![100; 5]), (199, vec![100; 5]), (250, vec![200, 200, 100])]
        {
            let mut outbox = Outbox::new(1_000, longest);
            (0..5).for_each(|n| outbox.push(&frame(n)));
            let mut seen = Vec::new();
            let all = |datagrams: &mut dyn Iterator<Item = &[u8]>| {
                seen.extend(datagrams.map(<[u8]>::len));
                Ok(seen.len())
            };
            outbox.send_with(10, all).unwrap();
            assert_eq!((seen, outbox.sent, outbox.sent_bytes), (lens, 5, 500));
            assert!(outbox.is_empty());
        }
    }
}
