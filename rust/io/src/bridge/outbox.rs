//! The queue of whole frames that wait to leave through a link, limited in bytes. A link that cannot keep up loses its
//! oldest frames, the urgent ones last. No other link waits for it.

use std::io;

use mavwire_core::frame::MAX_FRAME_LEN;

use super::lane::Lane;
use super::latency::Latency;

/// Where urgent frames wait, and where all others do.
const URGENT: usize = 0;
const PLAIN: usize = 1;

/// A bounded queue of frames. Urgent ones leave first.
#[derive(Debug)]
pub(super) struct Outbox {
    lanes: [Lane; 2],
    /// The rest of a frame that a stream took the beginning of: it has to follow, or the stream is broken.
    rest: Vec<u8>,
    /// When that frame arrived.
    rest_since: u32,
    limit: usize,
    /// Frames share a datagram up to this length.
    datagram: usize,
    pub(super) sent: u64,
    pub(super) sent_bytes: u64,
    pub(super) dropped: u64,
    /// How long the frames that left were in the bridge.
    pub(super) latency: Latency,
}

impl Outbox {
    /// `limit` in bytes; one frame always has room. Frames that wait together share a datagram up to `datagram` bytes;
    /// 0 for one in each.
    pub(super) fn new(limit: usize, datagram: usize) -> Self {
        Self {
            lanes: [Lane::default(), Lane::default()],
            rest: Vec::new(),
            rest_since: 0,
            limit: limit.max(MAX_FRAME_LEN),
            datagram,
            sent: 0,
            sent_bytes: 0,
            dropped: 0,
            latency: Latency::default(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lanes.iter().all(Lane::is_empty) && self.rest.is_empty()
    }

    /// Bytes that wait.
    pub(super) fn queued(&self) -> usize {
        self.queued_whole() + self.rest.len()
    }

    /// Half of what may wait does.
    #[inline]
    pub(super) fn is_half_full(&self) -> bool {
        2 * self.queued_whole() > self.limit
    }

    #[inline]
    fn queued_whole(&self) -> usize {
        self.lanes[URGENT].len() + self.lanes[PLAIN].len()
    }

    /// Queues a frame that arrived at `since`; the oldest ones make room for it, and urgent ones only for another.
    #[inline]
    pub(super) fn push(&mut self, frame: &[u8], urgent: bool, since: u32) {
        while self.queued_whole() + frame.len() > self.limit {
            self.dropped += 1;
            if self.lanes[PLAIN].take_front().is_none() {
                if !urgent {
                    return;
                }
                self.lanes[URGENT].take_front();
            }
        }
        let is_queued = self.lanes[if urgent { URGENT } else { PLAIN }].push(frame, since);
        self.dropped += u64::from(!is_queued);
    }

    /// The lane whose turn it is.
    fn lane(&mut self) -> &mut Lane {
        let turn = if self.lanes[URGENT].is_empty() { PLAIN } else { URGENT };
        &mut self.lanes[turn]
    }

    /// Drops everything, as a link does that goes down.
    pub(super) fn clear(&mut self) {
        let waiting: usize = self.lanes.iter().map(Lane::frames).sum();
        self.dropped += waiting as u64 + u64::from(!self.rest.is_empty());
        self.lanes = [Lane::default(), Lane::default()];
        self.rest.clear();
    }

    /// Writes to a stream until nothing is left or it takes no more; true if nothing is left. `clock` tells the time
    /// after each write.
    pub(super) fn write_to(
        &mut self,
        mut write: impl FnMut(&[u8]) -> io::Result<usize>,
        clock: impl Fn() -> u32,
    ) -> io::Result<bool> {
        while !self.is_empty() {
            let from_rest = !self.rest.is_empty();
            let waiting = if from_rest { &self.rest[..] } else { self.lane().bytes() };
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
                if self.rest.is_empty() {
                    self.left(self.rest_since, clock());
                }
            } else {
                self.written(written, clock());
            }
        }
        Ok(true)
    }

    /// Removes the bytes that a stream took.
    fn written(&mut self, mut len: usize, now: u32) {
        while let Some((front, since)) = self.lane().front() {
            if len < front {
                let rest = self.lane().bytes()[len..front].to_vec();
                (self.rest, self.rest_since) = (rest, since);
                self.lane().take_front();
                return;
            }
            len -= front;
            self.lane().take_front();
            self.left(since, now);
            if len == 0 {
                return; // the next lane is another write
            }
        }
    }

    /// Counts a frame that left.
    #[inline]
    fn left(&mut self, since: u32, now: u32) {
        self.sent += 1;
        self.latency.record(now.wrapping_sub(since));
    }

    /// Hands the oldest frames as datagrams, `at_most` of them, to a call that says how many it took.
    pub(super) fn send_with(
        &mut self,
        at_most: usize,
        send: impl FnOnce(&mut dyn Iterator<Item = &[u8]>) -> io::Result<usize>,
        clock: impl Fn() -> u32,
    ) -> io::Result<()> {
        let longest = self.datagram;
        let lane = self.lane();
        let count = {
            let mut at = 0;
            let bytes = lane.bytes();
            let mut datagrams = lane.datagrams(longest).take(at_most).map(|(_, len)| {
                let from = at;
                at += len;
                &bytes[from..at]
            });
            send(&mut datagrams)?
        };
        let frames: usize = lane.datagrams(longest).take(count).map(|(frames, _)| frames).sum();
        let now = clock();
        for _ in 0..frames {
            if let Some((len, since)) = self.lane().take_front() {
                self.sent_bytes += len as u64;
                self.left(since, now);
            }
        }
        Ok(())
    }

    /// Drops the frame whose turn it is, which could not be sent.
    pub(super) fn drop_front(&mut self) {
        self.dropped += u64::from(self.lane().take_front().is_some());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(n: u8) -> Vec<u8> {
        vec![n; 100]
    }

    /// The bytes that a stream receives if it takes `chunk` bytes at a time.
    fn drain(outbox: &mut Outbox, chunk: usize) -> Vec<u8> {
        let mut out = Vec::new();
        let write = |bytes: &[u8]| {
            let len = chunk.min(bytes.len());
            out.extend_from_slice(&bytes[..len]);
            Ok(len)
        };
        assert!(outbox.write_to(write, || 0).unwrap());
        out
    }

    #[test]
    fn a_stream_gets_whole_frames_in_order_however_it_takes_them() {
        for chunk in [1, 7, 99, 100, 101, 250, 10_000] {
            let mut outbox = Outbox::new(10_000, 0);
            let expected: Vec<u8> = (0..20).flat_map(frame).collect();
            (0..20).for_each(|n| outbox.push(&frame(n), false, 0));
            assert_eq!(drain(&mut outbox, chunk), expected, "{chunk}");
            assert_eq!((outbox.sent, outbox.sent_bytes, outbox.dropped), (20, 2_000, 0));
            assert!(outbox.is_empty());
        }
    }

    #[test]
    fn r63_the_oldest_go_but_never_half_a_frame() {
        let mut outbox = Outbox::new(1_000, 0);
        (0..5).for_each(|n| outbox.push(&frame(n), false, 0));
        let mut begun = Vec::new();
        let mut room = 150;
        let some = |bytes: &[u8]| {
            let len = bytes.len().min(room);
            room -= len;
            begun.extend_from_slice(&bytes[..len]);
            if len == 0 { Err(io::ErrorKind::WouldBlock.into()) } else { Ok(len) }
        };
        let blocked = outbox.write_to(some, || 0);
        assert!(!blocked.unwrap());
        (5..40).for_each(|n| outbox.push(&frame(n), false, 0));
        assert!(outbox.queued() <= 1_050, "{}", outbox.queued());
        begun.extend(drain(&mut outbox, 64));
        let expected: Vec<u8> = [0, 1].into_iter().chain(30..40).flat_map(frame).collect();
        assert_eq!(begun, expected);
        assert_eq!((outbox.sent, outbox.dropped), (12, 28));
    }

    #[test]
    fn datagrams_leave_as_many_as_were_taken() {
        let mut outbox = Outbox::new(1_000, 0);
        (0..5).for_each(|n| outbox.push(&frame(n), false, 0));
        let mut seen = Vec::new();
        outbox
            .send_with(
                3,
                |frames| {
                    seen.extend(frames.map(|frame| (frame[0], frame.len())));
                    Ok(2)
                },
                || 0,
            )
            .unwrap();
        assert_eq!(seen, [(0, 100), (1, 100), (2, 100)]);
        outbox.drop_front();
        assert_eq!(drain(&mut outbox, 1_000), [frame(3), frame(4)].concat());
        outbox.push(&frame(9), false, 0);
        outbox.clear();
        outbox.drop_front();
        assert_eq!((outbox.sent, outbox.dropped, outbox.queued()), (4, 2, 0));
    }

    #[test]
    fn frames_share_a_datagram_as_far_as_it_is_long_enough() {
        for (longest, lens) in [(0, vec![100; 5]), (199, vec![100; 5]), (250, vec![200, 200, 100])]
        {
            let mut outbox = Outbox::new(1_000, longest);
            (0..5).for_each(|n| outbox.push(&frame(n), false, 0));
            let mut seen = Vec::new();
            let all = |datagrams: &mut dyn Iterator<Item = &[u8]>| {
                seen.extend(datagrams.map(<[u8]>::len));
                Ok(seen.len())
            };
            outbox.send_with(10, all, || 0).unwrap();
            assert_eq!((seen, outbox.sent, outbox.sent_bytes), (lens, 5, 500));
            assert!(outbox.is_empty());
        }
    }

    #[test]
    fn urgent_frames_leave_first_and_are_dropped_last() {
        let mut outbox = Outbox::new(1_000, 0);
        (0..10).for_each(|n| outbox.push(&frame(n), false, 0));
        (10..14).for_each(|n| outbox.push(&frame(n), true, 0));
        let expected: Vec<u8> = (10..14).chain(4..10).flat_map(frame).collect();
        assert_eq!((drain(&mut outbox, 70), outbox.dropped), (expected, 4));
        (0..12).for_each(|n| outbox.push(&frame(n), true, 0));
        outbox.push(&frame(99), false, 0);
        let expected: Vec<u8> = (2..12).flat_map(frame).collect();
        assert_eq!((drain(&mut outbox, 1_000), outbox.dropped), (expected, 7));
        outbox.push(&frame(1), false, 0);
        outbox.push(&frame(2), true, 0);
        let mut seen = Vec::new();
        for _ in 0..2 {
            let all = |frames: &mut dyn Iterator<Item = &[u8]>| {
                seen.extend(frames.map(|frame| frame[0]));
                Ok(1)
            };
            outbox.send_with(10, all, || 0).unwrap();
        }
        assert_eq!((seen, outbox.is_empty()), (vec![2, 1], true));
    }

    #[test]
    fn a_frame_is_late_by_the_time_between_arriving_and_having_left() {
        let mut outbox = Outbox::new(1_000, 0);
        for since in [u32::MAX, 90, 95] {
            outbox.push(&frame(0), false, since);
        }
        let mut room = 150;
        let some = |bytes: &[u8]| {
            let len = bytes.len().min(room);
            room -= len;
            if len == 0 { Err(io::ErrorKind::WouldBlock.into()) } else { Ok(len) }
        };
        assert!(!outbox.write_to(some, || 99).unwrap());
        assert_eq!(
            outbox.latency.percentile(0.5),
            Some(103),
            "100 and its step, over the turn of the clock"
        );
        assert!(outbox.write_to(|bytes| Ok(bytes.len()), || 100).unwrap());
        assert_eq!((outbox.latency.percentile(0.3), outbox.sent), (Some(5), 3));
    }
}
