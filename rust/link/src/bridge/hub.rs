//! Where a bridge's frames meet the program around it: the newest frame of each kind, and taps that get a copy of what
//! comes by. The event loop takes the lock once for all frames of a round.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::kind_hash::KindHash;

/// Kinds of frames whose newest is kept: message ids times components.
const MAX_LATEST: usize = 16_384;
/// Removed links whose names are kept, for frames that came over them.
const MAX_RETIRED: usize = 1024;
/// Bytes that a tap holds for a program that does not fetch them.
const TAP_BYTES: usize = 16 << 20;

/// A frame among others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameInfo {
    /// Bytes of the frame.
    pub len: u16,
    /// Microseconds since 1970.
    pub time: u64,
    /// Number of the link that it came over; see [`Hub::link_name`].
    pub link: u32,
    /// System that sent it.
    pub sysid: u8,
    /// Component that sent it.
    pub compid: u8,
    /// Message id.
    pub msgid: u32,
    /// Index of the message in the dialect; `None` for an unknown id.
    pub index: Option<u16>,
}

/// Frames one behind the other.
#[derive(Debug, Clone, Default)]
pub struct Frames {
    /// Their bytes.
    pub bytes: Vec<u8>,
    /// What they are.
    pub infos: Vec<FrameInfo>,
}

impl Frames {
    #[inline]
    pub(super) fn push(&mut self, frame: &[u8], info: FrameInfo) {
        self.bytes.extend_from_slice(frame);
        self.infos.push(info);
    }

    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.infos.clear();
    }

    /// Each with its bytes.
    pub fn iter(&self) -> impl Iterator<Item = (&FrameInfo, &[u8])> {
        let mut at = 0;
        self.infos.iter().map(move |info| {
            let from = at;
            at += usize::from(info.len);
            (info, &self.bytes[from..at])
        })
    }
}

/// Which frames a tap gets; `None` for all.
#[derive(Debug, Clone, Default)]
pub struct TapFilter {
    /// Message ids.
    pub messages: Option<Vec<u32>>,
    /// System ids.
    pub systems: Option<Vec<u8>>,
}

impl TapFilter {
    fn wants(&self, info: &FrameInfo) -> bool {
        self.messages.as_ref().is_none_or(|ids| ids.contains(&info.msgid))
            && self.systems.as_ref().is_none_or(|ids| ids.contains(&info.sysid))
    }
}

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

    /// Takes out the first frames. What is taken stays in memory until it is the greater part, so that a long queue is
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

#[derive(Debug)]
struct TapShared {
    home: Home,
    filter: TapFilter,
    waiting: Mutex<Waiting>,
    arrived: Condvar,
}

/// A copy of the frames that come by. Dropping it ends that.
#[derive(Debug)]
pub struct Tap(Arc<TapShared>);

/// The process that has the bridge's thread. A fork has copies of everything but the thread, and locks that the thread may
/// have held.
#[derive(Debug, Clone, Copy)]
struct Home(u32);

impl Home {
    fn here() -> Self {
        Self(std::process::id())
    }

    fn is_elsewhere(self) -> bool {
        self.0 != std::process::id()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl TapShared {
    fn deliver(&self, frames: &Frames) {
        let mut waiting = lock(&self.waiting);
        if waiting.closed {
            return;
        }
        for (info, bytes) in frames.iter().filter(|(info, _)| self.filter.wants(info)) {
            if waiting.frames.bytes.len() - waiting.taken_bytes + bytes.len() > TAP_BYTES {
                // The older half, so that the cost for each frame stays small.
                let count = waiting.len().div_ceil(2);
                waiting.take_front(count);
                waiting.dropped += count as u64;
            }
            waiting.frames.push(bytes, *info);
        }
        if waiting.wanted > 0 && waiting.len() >= waiting.wanted {
            // Who is not content with that says again what it waits for.
            waiting.wanted = 0;
            self.arrived.notify_all();
        }
    }

    fn close(&self) {
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

/// The newest frame of its kind.
#[derive(Debug, Clone)]
pub struct Latest {
    /// What it is.
    pub info: FrameInfo,
    /// Its bytes.
    pub frame: Vec<u8>,
    /// Frames of its kind so far.
    count: u64,
    /// Frames that came before it: those of a round have the same time.
    order: u64,
}

/// A message from a component, and how often it came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// What the newest one is.
    pub info: FrameInfo,
    /// How many came.
    pub count: u64,
}

#[derive(Debug, Default)]
struct State {
    /// By [`key`].
    latest: HashMap<u64, Latest, KindHash>,
    count: u64,
    taps: Vec<Arc<TapShared>>,
    link_names: HashMap<u32, String>,
    /// Removed links, oldest first.
    retired: VecDeque<u32>,
    stopped: bool,
}

/// What stands for a kind of message: one number is hashed faster than three.
#[inline]
fn key(msgid: u32, sysid: u8, compid: u8) -> u64 {
    u64::from(msgid) << 16 | u64::from(sysid) << 8 | u64::from(compid)
}

/// What event loop and program share.
#[derive(Debug)]
pub struct Hub {
    home: Home,
    state: Mutex<State>,
}

impl Hub {
    pub(super) fn new() -> Self {
        Self { home: Home::here(), state: Mutex::default() }
    }

    /// Whether this is the copy of a fork, which nothing comes to.
    pub(super) fn is_forked(&self) -> bool {
        self.home.is_elsewhere()
    }

    pub(super) fn deliver(&self, frames: &Frames) {
        let mut guard = lock(&self.state);
        let state = &mut *guard;
        for (info, bytes) in frames.iter().filter(|(info, _)| info.index.is_some()) {
            state.count += 1;
            let order = state.count;
            let key = key(info.msgid, info.sysid, info.compid);
            if let Some(latest) = state.latest.get_mut(&key) {
                (latest.info, latest.order) = (*info, order);
                latest.count += 1;
                latest.frame.clear();
                latest.frame.extend_from_slice(bytes);
            } else {
                if state.latest.len() >= MAX_LATEST {
                    state.latest.clear(); // someone makes up addresses; what is real comes again
                }
                state
                    .latest
                    .insert(key, Latest { info: *info, frame: bytes.to_vec(), count: 1, order });
            }
        }
        state.taps.retain(|tap| !lock(&tap.waiting).closed);
        state.taps.iter().for_each(|tap| tap.deliver(frames));
    }

    pub(super) fn stop(&self) {
        let mut state = lock(&self.state);
        state.stopped = true;
        state.taps.drain(..).for_each(|tap| tap.close());
    }

    pub(super) fn name_link(&self, number: u32, name: &str) {
        lock(&self.state).link_names.insert(number, name.to_owned());
    }

    /// Notes that a link is no more. Names of the last of these stay.
    pub(super) fn retire_link(&self, number: u32) {
        let mut state = lock(&self.state);
        state.retired.push_back(number);
        if state.retired.len() > MAX_RETIRED
            && let Some(oldest) = state.retired.pop_front()
        {
            state.link_names.remove(&oldest);
        }
    }

    /// What the link with a number is called, or was.
    pub fn link_name(&self, number: u32) -> Option<String> {
        lock(&self.state).link_names.get(&number).cloned()
    }

    /// The newest frame with a message id, from a system and component or from any.
    pub fn latest(&self, msgid: u32, sysid: Option<u8>, compid: Option<u8>) -> Option<Latest> {
        let state = lock(&self.state);
        if let (Some(sysid), Some(compid)) = (sysid, compid) {
            return state.latest.get(&key(msgid, sysid, compid)).cloned();
        }
        let matching = state.latest.values().filter(|latest| {
            latest.info.msgid == msgid
                && sysid.is_none_or(|sysid| sysid == latest.info.sysid)
                && compid.is_none_or(|compid| compid == latest.info.compid)
        });
        matching.max_by_key(|latest| latest.order).cloned()
    }

    /// Every kind of message that came, in no order.
    pub fn kinds(&self) -> Vec<Kind> {
        let state = lock(&self.state);
        state.latest.values().map(|one| Kind { info: one.info, count: one.count }).collect()
    }

    /// A tap for what comes from now on.
    pub fn tap(&self, filter: TapFilter) -> Tap {
        let mut state = lock(&self.state);
        let waiting = Waiting { closed: state.stopped, ..Waiting::default() };
        let (waiting, arrived) = (Mutex::new(waiting), Condvar::new());
        let tap = Arc::new(TapShared { home: self.home, filter, waiting, arrived });
        if !state.stopped {
            state.taps.push(Arc::clone(&tap));
        }
        Tap(tap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONG: Duration = Duration::from_secs(60);

    fn frames(msgids: impl IntoIterator<Item = u32>) -> Frames {
        let mut frames = Frames::default();
        for (n, msgid) in msgids.into_iter().enumerate() {
            let (time, index) = (n as u64, (msgid < 1_000).then_some(0));
            let info = FrameInfo { len: 20, time, link: 1, sysid: 1, compid: 1, msgid, index };
            frames.push(&[msgid as u8; 20], info);
        }
        frames
    }

    fn ids(frames: &Frames) -> Vec<u32> {
        frames.iter().map(|(info, _)| info.msgid).collect()
    }

    #[test]
    fn a_tap_gets_what_it_wants_in_batches_until_the_end() {
        let hub = Hub::new();
        let wanted = TapFilter { messages: Some((0..100).collect()), systems: Some(vec![1]) };
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
        assert!(hub.tap(TapFilter::default()).take(1).is_none());
    }

    #[test]
    fn a_tap_that_nobody_reads_keeps_the_newest() {
        let hub = Hub::new();
        let tap = hub.tap(TapFilter::default());
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
        let tap = Arc::new(hub.tap(TapFilter::default()));
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

    #[test]
    fn names_of_removed_links_do_not_pile_up() {
        let hub = Hub::new();
        hub.name_link(0, "stays");
        for number in 1..=2_000 {
            hub.name_link(number, "guest");
            hub.retire_link(number);
        }
        let named = |number| hub.link_name(number).is_some();
        assert_eq!((named(0), named(1), named(2_000)), (true, false, true));
        assert_eq!(lock(&hub.state).link_names.len(), MAX_RETIRED + 1);
    }

    #[test]
    fn the_newest_of_each_kind_is_kept() {
        let hub = Hub::new();
        let mut second = frames([30, 30]);
        second.infos[1].compid = 9;
        hub.deliver(&frames([30, 0, 30, 5_000]));
        hub.deliver(&second);
        let time = |sysid, compid| hub.latest(30, sysid, compid).map(|latest| latest.info.time);
        assert_eq!((time(Some(1), Some(1)), time(None, None)), (Some(0), Some(1)));
        assert_eq!(
            (time(Some(1), None), time(None, Some(9)), time(Some(2), None)),
            (Some(1), Some(1), None)
        );
        assert!(hub.latest(5_000, None, None).is_none(), "the dialect does not know it");
        let mut counts: Vec<(u32, u8, u64)> = hub
            .kinds()
            .iter()
            .map(|kind| (kind.info.msgid, kind.info.compid, kind.count))
            .collect();
        counts.sort_unstable();
        assert_eq!(counts, [(0, 1, 1), (30, 1, 3), (30, 9, 1)]);
    }
}
