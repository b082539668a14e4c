//! How much may leave through a link: messages a second of each type, bytes a second of all.
//!
//! Both count with the generic cell rate algorithm: one number, the time at which the stream would be back in its
//! pace. What comes a little early passes, so that a stream at its limit loses nothing to jitter, and the mean rate is kept.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::frame::Header;
use crate::kind_hash::KindHash;

/// Streams whose pace is remembered: message types times components. Only made-up addresses are more than that, and what
/// finds no room does not pass.
const MAX_STREAMS: usize = 1 << 16;
/// Those that are through with their last message are looked for no more often than this.
const SWEEP_INTERVAL: u64 = 100_000_000;
/// Bytes may run ahead of their rate by this long.
const BURST: u64 = 250_000_000;
/// Those of urgent messages by this long, at the expense of what follows.
const URGENT_BURST: u64 = 2_000_000_000;
const SECOND: f64 = 1e9;

/// Bytes a second of whole frames, for a link however many peers it has: clones have one account together.
#[derive(Debug, Clone)]
pub struct ByteRate(Arc<Mutex<Account>>);

#[derive(Debug)]
struct Account {
    /// Nanoseconds that a byte takes.
    byte_time: f64,
    /// When all bytes so far are through.
    due: u64,
    /// The number of the frame that was asked about last, and whether it may leave.
    decided: (u64, bool),
}

impl ByteRate {
    /// An account of its own.
    pub fn new(bytes_per_second: f64) -> Self {
        let byte_time = SECOND / bytes_per_second.max(1e-9);
        Self(Arc::new(Mutex::new(Account { byte_time, due: 0, decided: (0, true) })))
    }

    fn account(&self) -> MutexGuard<'_, Account> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the frame with a number may leave: to all peers that it is for or to none, or else those that are asked
    /// first would get everything.
    fn allows(&self, number: u64, now: u64, early: u64) -> bool {
        let mut account = self.account();
        if account.decided.0 != number {
            account.decided = (number, account.due <= now.saturating_add(early));
        }
        account.decided.1
    }

    /// Puts bytes that leave on the account.
    fn charge(&self, len: usize, now: u64) {
        let mut account = self.account();
        let cost = (account.byte_time * len as f64) as u64;
        account.due = account.due.max(now).saturating_add(cost);
    }
}

/// The limits of a link. By default there are none.
#[derive(Debug, Clone, Default)]
pub struct Limits {
    /// Bytes a second of all frames.
    pub bytes_per_second: Option<ByteRate>,
    /// Messages a second of each type that `message_rates` does not name, from each component.
    pub message_rate: Option<f64>,
    /// Messages a second of a message id, from each component.
    pub message_rates: Vec<(u32, f64)>,
    /// Message ids that leave before others where there is not room for all.
    pub urgent: Vec<u32>,
}

impl Limits {
    /// Everything may pass.
    pub fn is_open(&self) -> bool {
        let no_rates = self.message_rate.is_none() && self.message_rates.is_empty();
        no_rates && self.bytes_per_second.is_none()
    }
}

/// Keeps the limits of a link. Times are in nanoseconds.
#[derive(Debug, Clone)]
pub(super) struct Limiter {
    bytes: Option<ByteRate>,
    /// Shortest mean interval by message id, sorted.
    intervals: Box<[(u32, u64)]>,
    interval: Option<u64>,
    /// When each message type from each component may send again.
    streams: HashMap<u64, u64, KindHash>,
    /// When streams may be swept again.
    sweep_at: u64,
    urgent: Box<[u32]>,
}

/// The time that one of so many a second takes; a rate of 0 or less lets one pass in a lifetime.
fn interval(rate: f64) -> u64 {
    if rate > 0.0 { (SECOND / rate) as u64 } else { u64::MAX / 4 }
}

/// Whether something that takes `cost` may pass now, and if so, puts it on the account.
fn pass(due: &mut u64, now: u64, cost: u64, early: u64) -> bool {
    let passes = *due <= now.saturating_add(early);
    if passes {
        *due = (*due).max(now).saturating_add(cost);
    }
    passes
}

impl Limiter {
    pub(super) fn new(limits: &Limits) -> Self {
        let mut intervals: Vec<(u32, u64)> =
            limits.message_rates.iter().map(|&(msgid, rate)| (msgid, interval(rate))).collect();
        intervals.sort_by_key(|&(msgid, _)| msgid);
        Self {
            bytes: limits.bytes_per_second.clone(),
            intervals: intervals.into(),
            interval: limits.message_rate.map(interval),
            streams: HashMap::default(),
            sweep_at: 0,
            urgent: limits.urgent.as_slice().into(),
        }
    }

    /// Whether a frame of `len` bytes may leave, the one that has this `number` at all links.
    pub(super) fn admit(&mut self, header: &Header, len: usize, number: u64, now: u64) -> bool {
        // The bytes are asked first but counted last: a frame that its type holds back costs nothing.
        let burst = if self.urgent.contains(&header.msgid) { URGENT_BURST } else { BURST };
        let allowed = self.bytes.as_ref().is_none_or(|bytes| bytes.allows(number, now, burst));
        let passes = allowed && self.admit_type(header, now);
        if passes && let Some(bytes) = &self.bytes {
            bytes.charge(len, now);
        }
        passes
    }

    fn admit_type(&mut self, header: &Header, now: u64) -> bool {
        let named = self.intervals.binary_search_by_key(&header.msgid, |&(msgid, _)| msgid);
        let Some(interval) = named.map(|n| self.intervals[n].1).ok().or(self.interval) else {
            return true;
        };
        let Header { msgid, sysid, compid, .. } = *header;
        let key = u64::from(msgid) << 16 | u64::from(sysid) << 8 | u64::from(compid);
        if let Some(due) = self.streams.get_mut(&key) {
            return pass(due, now, interval, interval / 2);
        }
        if self.streams.len() >= MAX_STREAMS {
            self.sweep(now);
        }
        let has_room = self.streams.len() < MAX_STREAMS;
        if has_room {
            self.streams.insert(key, now.saturating_add(interval));
        }
        has_room
    }

    /// Forgets the streams that may send again, which are as good as new.
    fn sweep(&mut self, now: u64) {
        if now >= self.sweep_at {
            self.sweep_at = now.saturating_add(SWEEP_INTERVAL);
            self.streams.retain(|_, due| *due > now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::header;
    use mavwire_schema::WireVersion::V2;

    const MS: u64 = 1_000_000;

    /// How many of `count` frames pass that come every `interval` nanoseconds.
    fn passed(limits: &Limits, msgid: u32, count: u64, interval: u64) -> u64 {
        let mut limiter = Limiter::new(limits);
        let times = (0..count).map(|n| 1_000 * MS + n * interval);
        times.filter(|&now| limiter.admit(&header(V2, msgid, 0), 50, now, now)).count() as u64
    }

    #[test]
    fn a_type_is_held_to_its_rate() {
        let limits = Limits { message_rates: vec![(30, 10.0), (0, 2.0)], ..Limits::default() };
        let expected = [
            (30, 500, 20 * MS, 100), // 50 Hz for 10 s
            (30, 500, 19 * MS + 7, 95),
            (30, 100, 100 * MS, 100), // at the limit
            (30, 100, 300 * MS, 100), // below it
            (0, 100, 100 * MS, 20),
            (1, 500, MS, 500), // not named
        ];
        for (msgid, count, interval, wanted) in expected {
            let got = passed(&limits, msgid, count, interval);
            assert!(got.abs_diff(wanted) <= 1, "{msgid} every {interval}: {got}, not {wanted}");
        }
    }

    #[test]
    fn each_component_has_a_rate_of_its_own() {
        let limits = Limits { message_rate: Some(1.0), ..Limits::default() };
        let mut limiter = Limiter::new(&limits);
        for time in [0, 100, 400] {
            for (sysid, msgid) in (1..=255).flat_map(|sysid| (0..20).map(move |id| (sysid, id))) {
                let header = Header { sysid, ..header(V2, msgid, 0) };
                assert_eq!(limiter.admit(&header, 50, 0, time * MS), time == 0, "{sysid}: {msgid}");
            }
        }
    }

    #[test]
    fn streams_that_are_too_many_do_not_pass_and_make_room_with_time() {
        let limits = Limits { message_rate: Some(1.0), ..Limits::default() };
        let mut limiter = Limiter::new(&limits);
        let mut passed = |msgid, time: u64| {
            let addresses = (0..=u8::MAX).flat_map(|sysid| (0..=u8::MAX).map(move |c| (sysid, c)));
            let headers =
                addresses.map(|(sysid, compid)| Header { sysid, compid, ..header(V2, msgid, 0) });
            headers.filter(|header| limiter.admit(header, 50, 0, time * MS)).count()
        };
        let counts = [passed(0, 0), passed(30, 400), passed(0, 400), passed(30, 1_000)];
        assert_eq!(counts, [MAX_STREAMS, 0, 0, MAX_STREAMS]);
    }

    #[test]
    fn bytes_are_held_to_their_rate_with_a_short_burst() {
        let limits =
            || Limits { bytes_per_second: Some(ByteRate::new(5_000.0)), ..Limits::default() };
        let got = passed(&limits(), 30, 100_000, MS / 10); // 100 a second of 10,000, for 10 s
        assert!((1_000..=1_027).contains(&got), "{got}");
        assert_eq!(passed(&limits(), 30, 1_000, 10 * MS), 1_000, "at the limit");
    }

    #[test]
    fn urgent_messages_pass_where_others_wait_and_the_rate_is_kept() {
        let limits = Limits {
            bytes_per_second: Some(ByteRate::new(5_000.0)),
            urgent: vec![76],
            ..Limits::default()
        };
        let mut limiter = Limiter::new(&limits);
        let mut passed = [0; 2];
        for now in (0..10_000).map(|n| 1_000 * MS + n * MS) {
            passed[0] += u32::from(limiter.admit(&header(V2, 30, 0), 50, 2 * now, now));
            // 10 of 100 frames a second.
            let is_due = now % (100 * MS) == 0;
            passed[1] +=
                u32::from(is_due && limiter.admit(&header(V2, 76, 0), 50, 2 * now + 1, now));
        }
        assert_eq!(passed[1], 100, "all of them");
        assert!((900..=930).contains(&passed[0]), "{passed:?}");
        let flood =
            (0..10_000).filter(|n| limiter.admit(&header(V2, 76, 0), 50, n + 1, n * MS)).count();
        assert!(flood <= 1_200, "{flood}");
    }

    #[test]
    fn odd_numbers_do_no_harm() {
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, 1e300] {
            let limits =
                Limits { bytes_per_second: Some(ByteRate::new(rate)), ..Limits::default() };
            assert!(passed(&limits, 30, 10, MS) >= 1, "{rate}");
            let limits = Limits { message_rate: Some(rate), ..Limits::default() };
            assert!(passed(&limits, 30, 10, MS) >= 1, "{rate}");
        }
    }
}
