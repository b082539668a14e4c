//! A copy of what comes by, for a program that fetches it when it likes.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use mavwire_core::router::Filter;

use super::frames::{FrameInfo, Frames};
use super::home::{Home, lock};

/// Bytes that a tap holds for a program that does not fetch them.
pub(super) const TAP_BYTES: usize = 16 << 20;

#[derive(Debug, Default)]
struct Waiting {
    frames: Frames,
    /// How many of them, and of their bytes, are taken out already.
    taken: usize,
    taken_bytes: usize,
    /// Frames that somebody waits for, the least number; 0 while nobody waits.
    wanted: usize,
    dropped: u64,
    closed: bool,
}

impl Waiting {
    fn len(&self) -> usize {
        self.frames.infos.len() - self.taken
    }

    /// Takes out the first frames. Taken frames stay in memory until they are the greater part, so that a long queue is
    /// not moved for every batch.
    fn take_front(&mut self, count: usize) -> Frames {
        let end = self.taken + count.min(self.len());
        let infos = self.frames.infos[self.taken..end].to_vec();
        let len: usize = infos.iter().map(|info| usize::from(info.len)).sum();
        let bytes = self.frames.bytes[self.taken_bytes..self.taken_bytes + len].to_vec();
        (self.taken, self.taken_bytes) = (end, self.taken_bytes + len);
        if self.taken > self.frames.infos.len() / 2 {
            self.frames.infos.drain(..self.taken);
            self.frames.bytes.drain(..self.taken_bytes);
            (self.taken, self.taken_bytes) = (0, 0);
        }
        Frames { bytes, infos }
    }
}

/// The queue of a tap, which the event loop fills and the program empties.
#[derive(Debug)]
pub(super) struct TapShared {
    home: Home,
    filter: Filter,
    waiting: Mutex<Waiting>,
    arrived: Condvar,
}

/// A copy of the frames that come by. Dropping it ends that.
#[derive(Debug)]
pub struct Tap(pub(super) Arc<TapShared>);

impl TapShared {
    pub(super) fn new(home: Home, filter: Filter, closed: bool) -> Self {
        let waiting = Waiting { closed, ..Waiting::default() };
        Self { home, filter, waiting: Mutex::new(waiting), arrived: Condvar::new() }
    }

    pub(super) fn is_closed(&self) -> bool {
        lock(&self.waiting).closed
    }

    pub(super) fn deliver(&self, frames: &Frames) {
        let mut waiting = lock(&self.waiting);
        if waiting.closed {
            return;
        }
        let wants = |info: &FrameInfo| self.filter.admits(info.msgid, info.sysid, info.compid);
        for (info, bytes) in frames.iter().filter(|(info, _)| wants(info)) {
            if waiting.frames.bytes.len() - waiting.taken_bytes + bytes.len() > TAP_BYTES {
                // The older half, so that the cost for each frame stays small.
                let count = waiting.len().div_ceil(2);
                waiting.take_front(count);
                waiting.dropped += count as u64;
            }
            waiting.frames.push(bytes, *info);
        }
        if waiting.wanted > 0 && waiting.len() >= waiting.wanted {
            // A waiter that needs more sets the number again.
            waiting.wanted = 0;
            self.arrived.notify_all();
        }
    }

    pub(super) fn close(&self) {
        lock(&self.waiting).closed = true;
        self.arrived.notify_all();
    }
}

impl Tap {
    /// Waits up to `timeout` until so many frames are there; true if they are, or if nothing will come any more.
    pub fn wait(&self, wanted: usize, timeout: Duration) -> bool {
        if self.0.home.is_elsewhere() {
            return true;
        }
        let deadline = Instant::now() + timeout;
        let mut waiting = lock(&self.0.waiting);
        loop {
            if waiting.closed || waiting.len() >= wanted {
                return true;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return false;
            }
            waiting.wanted = if waiting.wanted == 0 { wanted } else { waiting.wanted.min(wanted) };
            let woken = self.0.arrived.wait_timeout(waiting, left);
            waiting = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// The frames that are there, `max_batch` at most; `None` once the bridge has stopped and all is fetched, and in a
    /// fork.
    pub fn take(&self, max_batch: usize) -> Option<Frames> {
        if self.0.home.is_elsewhere() {
            return None;
        }
        let mut waiting = lock(&self.0.waiting);
        let ended = waiting.closed && waiting.len() == 0;
        (!ended).then(|| waiting.take_front(max_batch))
    }

    /// Frames that were dropped because nobody fetched them.
    pub fn dropped(&self) -> u64 {
        if self.0.home.is_elsewhere() {
            return 0;
        }
        lock(&self.0.waiting).dropped
    }

    /// Ends it: nothing is there or will come any more, and nobody waits for it.
    pub fn close(&self) {
        if self.0.home.is_elsewhere() {
            return;
        }
        let mut waiting = lock(&self.0.waiting);
        *waiting = Waiting { closed: true, dropped: waiting.dropped, ..Waiting::default() };
        self.0.arrived.notify_all();
    }
}

impl Drop for Tap {
    fn drop(&mut self) {
        self.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bridge::frames::testing::frames;
    use crate::bridge::hub::Hub;
    use mavwire_core::router::Part;

    const LONG: Duration = Duration::from_secs(60);

    fn ids(frames: &Frames) -> Vec<u32> {
        frames.iter().map(|(info, _)| info.msgid).collect()
    }

    #[test]
    fn a_tap_gets_what_it_wants_in_batches_until_the_end() {
        let hub = Hub::new();
        let wanted = Filter::default().allow(Part::Messages, 0..100).allow(Part::Systems, [1]);
        let tap = hub.tap(wanted);
        assert!(!tap.wait(1, Duration::ZERO));
        assert_eq!(tap.take(10).map(|frames| ids(&frames)), Some(vec![]));
        hub.deliver(&frames(0..200));
        assert!(tap.wait(100, Duration::ZERO) && !tap.wait(101, Duration::ZERO));
        for start in [0, 40, 80] {
            let batch = tap.take(40).expect("the bridge runs");
            assert_eq!(ids(&batch), (start..100.min(start + 40)).collect::<Vec<_>>());
            assert!(batch.iter().all(|(info, bytes)| bytes == [info.msgid as u8; 20]));
        }
        hub.deliver(&frames([7]));
        hub.stop();
        assert!(tap.wait(2, LONG), "nothing will come any more");
        assert_eq!(tap.take(40).map(|frames| ids(&frames)), Some(vec![7]));
        assert!(tap.take(40).is_none());
        assert!(hub.tap(Filter::default()).take(1).is_none());
    }

    #[test]
    fn a_tap_that_nobody_reads_keeps_the_newest() {
        let hub = Hub::new();
        let tap = hub.tap(Filter::default());
        for _ in 0..100 {
            hub.deliver(&frames(0..10_000));
        }
        let mut got = 0;
        let mut last = None;
        while let Some(batch) = tap.take(1_000).filter(|batch| !batch.infos.is_empty()) {
            got += batch.infos.len();
            last = batch.infos.last().map(|info| info.msgid);
        }
        assert_eq!((got as u64 + tap.dropped(), last), (1_000_000, Some(9_999)));
        assert!(got > TAP_BYTES / 20 / 3);
    }

    #[test]
    fn several_may_wait_for_one_tap() {
        let hub = Hub::new();
        let tap = Arc::new(hub.tap(Filter::default()));
        let waiter = |wanted| {
            let (tap, (done, ended)) = (Arc::clone(&tap), std::sync::mpsc::channel());
            std::thread::spawn(move || done.send(tap.wait(wanted, 10 * LONG)));
            ended
        };
        let wanted = |number| {
            let start = Instant::now();
            while lock(&tap.0.waiting).wanted != number {
                assert!(start.elapsed() < LONG, "nobody waits for {number}");
                std::thread::yield_now();
            }
        };
        let two = waiter(2);
        wanted(2);
        let one = waiter(1);
        wanted(1);
        hub.deliver(&frames([7]));
        assert_eq!(one.recv_timeout(LONG), Ok(true));
        wanted(2);
        hub.deliver(&frames([8]));
        assert_eq!(two.recv_timeout(LONG), Ok(true));
        let many = waiter(100);
        wanted(100);
        tap.close();
        assert_eq!(many.recv_timeout(LONG), Ok(true));
        hub.deliver(&frames([9]));
        assert!(tap.take(1).is_none(), "what was there is gone, and nothing comes");
    }
}
