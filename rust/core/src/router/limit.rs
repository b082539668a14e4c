//! How much may leave through a link: messages a second of each type, bytes a second of all.
//!
//! Both count with the generic cell rate algorithm: one number, the time at which the stream would be back in its
//! pace. What comes a little early passes, so that a stream at its limit loses nothing to jitter, and the mean rate is kept.
//!
//! Vehicles send the same messages one behind the other, several times a second. Where there are bytes for a few of them,
//! the first ones would take these each time. So a stream may run ahead the further the longer it has not passed, and with
//! too many of them each passes about as often as any other.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::frame::Header;
use crate::kind_hash::KindHash;

/// Streams whose pace is remembered: message types times components. Only made-up addresses are more than that, and what
/// finds no room does not pass a limit of its type.
const MAX_STREAMS: usize = 1 << 16;
/// Those that are through with their last message are looked for no more often than this.
const SWEEP_INTERVAL: u64 = 100_000_000;
/// Bytes may run ahead of their rate by this long,
const BURST: u64 = 250_000_000;
/// those of a stream that has not passed for `FULL_WAIT` by this long,
const WAITED_BURST: u64 = 1_500_000_000;
const FULL_WAIT: u64 = 20_000_000_000;
/// and those of urgent messages by this long, at the expense of what follows.
const URGENT_BURST: u64 = 2_000_000_000;
const SECOND: f64 = 1e9;

/// A moment for each stream: a message type from a component. Those that have passed are forgotten when room is needed.
#[derive(Debug, Clone, Default)]
struct Streams {
    moments: HashMap<u64, u64, KindHash>,
    /// When they may be swept again.
    sweep_at: u64,
}

impl Streams {
    fn key(&Header { msgid, sysid, compid, .. }: &Header) -> u64 {
        u64::from(msgid) << 16 | u64::from(sysid) << 8 | u64::from(compid)
    }

    /// Notes the moment of a stream; false if there is no room for another one.
    fn insert(&mut self, key: u64, moment: u64, now: u64) -> bool {
        if let Some(known) = self.moments.get_mut(&key) {
            *known = moment;
            return true;
        }
        if self.moments.len() >= MAX_STREAMS && now >= self.sweep_at {
            self.sweep_at = now.saturating_add(SWEEP_INTERVAL);
            self.moments.retain(|_, moment| *moment > now);
        }
        let has_room = self.moments.len() < MAX_STREAMS;
        if has_room {
            self.moments.insert(key, moment);
        }
        has_room
    }
}

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
    /// When each stream will not have passed for `FULL_WAIT`.
    waiting: Streams,
}

impl Account {
    /// How far a frame may run ahead.
    fn burst(&self, header: &Header, is_urgent: bool, now: u64) -> u64 {
        if is_urgent {
            return URGENT_BURST;
        }
        let until = self.waiting.moments.get(&Streams::key(header)).copied().unwrap_or(0);
        let left = until.saturating_sub(now).min(FULL_WAIT);
        // The root tells apart short waits, which count at high rates, and still leaves something for long ones.
        let waited = 1.0 - left as f64 / FULL_WAIT as f64;
        BURST + ((WAITED_BURST - BURST) as f64 * waited.sqrt()) as u64
    }
}

impl ByteRate {
    /// An account of its own.
    pub fn new(bytes_per_second: f64) -> Self {
        let byte_time = SECOND / bytes_per_second.max(1e-9);
        let waiting = Streams::default();
        Self(Arc::new(Mutex::new(Account { byte_time, due: 0, decided: (0, true), waiting })))
    }

    fn account(&self) -> MutexGuard<'_, Account> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the frame with a number may leave: to all peers that it is for or to none, or else those that are asked
    /// first would get everything.
    fn allows(&self, header: &Header, is_urgent: bool, number: u64, now: u64) -> bool {
        let mut account = self.account();
        if account.decided.0 != number {
            let burst = account.burst(header, is_urgent, now);
            account.decided = (number, account.due <= now.saturating_add(burst));
        }
        account.decided.1
    }

    /// Puts a frame that leaves on the account.
    fn charge(&self, header: &Header, len: usize, now: u64) {
        let mut account = self.account();
        let cost = (account.byte_time * len as f64) as u64;
        account.due = account.due.max(now).saturating_add(cost);
        // One that finds no room counts as one that has waited.
        account.waiting.insert(Streams::key(header), now.saturating_add(FULL_WAIT), now);
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
    /// When each stream may send again.
    streams: Streams,
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
            streams: Streams::default(),
            urgent: limits.urgent.as_slice().into(),
        }
    }

    /// Whether a frame of `len` bytes may leave, the one that has this `number` at all links.
    pub(super) fn admit(&mut self, header: &Header, len: usize, number: u64, now: u64) -> bool {
        // The bytes are asked first but counted last: a frame that its type holds back costs nothing.
        let is_urgent = self.urgent.contains(&header.msgid);
        let bytes = self.bytes.as_ref();
        let allowed = bytes.is_none_or(|bytes| bytes.allows(header, is_urgent, number, now));
        let passes = allowed && self.admit_type(header, now);
        if passes && let Some(bytes) = &self.bytes {
            bytes.charge(header, len, now);
        }
        passes
    }

    fn admit_type(&mut self, header: &Header, now: u64) -> bool {
        let named = self.intervals.binary_search_by_key(&header.msgid, |&(msgid, _)| msgid);
        let Some(interval) = named.map(|n| self.intervals[n].1).ok().or(self.interval) else {
            return true;
        };
        let key = Streams::key(header);
        match self.streams.moments.get_mut(&key) {
            Some(due) => pass(due, now, interval, interval / 2),
            None => self.streams.insert(key, now.saturating_add(interval), now),
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
        assert!((1_000..=1_037).contains(&got), "{got}");
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

    /// What passes in two minutes of a vehicle's messages, 30 types of 50 bytes that come at so many hertz one behind the
    /// other, and a heartbeat of 21 bytes behind them each second.
    fn passed_of_a_vehicle(bytes_per_second: f64, hertz: u64) -> (Vec<u32>, u32) {
        let limits = Limits {
            bytes_per_second: Some(ByteRate::new(bytes_per_second)),
            urgent: vec![0],
            ..Limits::default()
        };
        let mut limiter = Limiter::new(&limits);
        let mut number = 0;
        let mut admit = |msgid, len, now| {
            number += 1;
            u32::from(limiter.admit(&header(V2, msgid, 0), len, number, now * MS))
        };
        let (mut passed, mut heartbeats) = (vec![0; 30], 0);
        for n in 0..120 * hertz {
            let now = 1_000 + n * 1_000 / hertz;
            for (msgid, count) in (1..).zip(&mut passed) {
                *count += admit(msgid, 50, now + u64::from(msgid) / 5);
            }
            if n % hertz == 0 {
                heartbeats += admit(0, 21, now + 9);
            }
        }
        (passed, heartbeats)
    }

    #[test]
    fn each_of_too_many_streams_passes_about_as_often_and_heartbeats_always_do() {
        for (rate, hertz) in
            [(150.0, 1), (150.0, 4), (300.0, 2), (300.0, 4), (300.0, 50), (1_200.0, 4)]
        {
            let (passed, heartbeats) = passed_of_a_vehicle(rate, hertz);
            assert_eq!(heartbeats, 120, "{rate}, {hertz} Hz");
            let total: u32 = passed.iter().sum();
            let expected = (rate - 21.0) * 120.0 / 50.0;
            assert!((f64::from(total) / expected - 1.0).abs() < 0.1, "{rate}, {hertz} Hz: {total}");
            let even = total / 30;
            let near = passed.iter().all(|&count| (even / 3..=even * 3).contains(&count));
            assert!(near, "{rate}, {hertz} Hz: {passed:?}");
        }
    }

    #[test]
    fn a_slow_stream_does_not_suffer_from_a_fast_one() {
        let limits = Limits { bytes_per_second: Some(ByteRate::new(200.0)), ..Limits::default() };
        let mut limiter = Limiter::new(&limits);
        let mut passed = [0; 3];
        for n in 0..1_000 {
            for (msgid, len) in [(0, 21), (1, 21), (30, 40)] {
                let admitted = limiter.admit(
                    &header(V2, msgid, 0),
                    len,
                    3 * n + u64::from(msgid),
                    n * 30 * MS,
                );
                passed[msgid.min(2) as usize] += u32::from(admitted);
            }
        }
        assert!(passed.iter().all(|count| *count > 50), "{passed:?}");
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
