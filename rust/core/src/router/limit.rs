//! How much may leave through a link: messages a second of each type, bytes a second of all.
//!
//! Both count with the generic cell rate algorithm: one number, the time at which the stream would be back in its
//! pace. A frame a little early passes: a stream at its limit loses nothing to jitter, and the mean rate is kept.

use std::collections::HashMap;

use super::byte_rate::ByteRate;
use super::links::LinkSet;
use crate::frame::Header;
use crate::kind_hash::KindHash;

/// Streams whose pace is remembered: message types times components. Only made-up addresses are more than that. Then all are
/// forgotten: made-up streams must not stop a genuine one.
const MAX_STREAMS: usize = 1 << 16;
const SECOND: f64 = 1e9;

/// The key of a frame's stream: a message type from a component over a link, or over a group of links. Without the link, a
/// forger could use up the rate of a component. Messages of the bridge itself come from no link.
pub(super) fn stream_key(&Header { msgid, sysid, compid, .. }: &Header, source: LinkSet) -> u64 {
    let origin = source.iter().next().map_or(0, |link| u64::from(link.0) + 1);
    origin << 40 | u64::from(msgid) << 16 | u64::from(sysid) << 8 | u64::from(compid)
}

/// The message id of a stream.
fn msgid_of(stream: u64) -> u32 {
    (stream >> 16) as u32 & 0x00FF_FFFF
}

/// The limits of a link. By default there are none.
#[derive(Debug, Clone, Default)]
pub struct Limits {
    /// Bytes a second of all frames.
    pub bytes_per_second: Option<ByteRate>,
    /// Messages a second of each type that `message_rates` does not name, from each component over each link.
    pub message_rate: Option<f64>,
    /// Messages a second of a message id, from each component over each link.
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
    streams: HashMap<u64, u64, KindHash>,
    urgent: Box<[u32]>,
}

/// The time that one of so many a second takes; a rate of 0 or less lets one pass in a lifetime.
fn interval(rate: f64) -> u64 {
    if rate > 0.0 { (SECOND / rate) as u64 } else { u64::MAX / 4 }
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
            urgent: limits.urgent.as_slice().into(),
        }
    }

    /// Whether a frame of `len` bytes of a `stream` may leave. `number` identifies the frame at all links.
    pub(super) fn admit(&mut self, stream: u64, len: usize, number: u64, now: u64) -> bool {
        let msgid = msgid_of(stream);
        let interval = self.interval_of(msgid);
        let is_due = |due: &u64| *due <= now.saturating_add(interval.unwrap_or(0) / 2);
        if interval.is_some() && !self.streams.get(&stream).is_none_or(is_due) {
            return false; // asks for no bytes
        }
        let is_urgent = self.urgent.contains(&msgid);
        let passes = |bytes: &ByteRate| bytes.admit(stream, len, is_urgent, number, now);
        if !self.bytes.as_ref().is_none_or(passes) {
            return false;
        }
        if let Some(interval) = interval {
            if self.streams.len() >= MAX_STREAMS && !self.streams.contains_key(&stream) {
                self.streams.clear();
            }
            let due = self.streams.entry(stream).or_insert(now);
            *due = (*due).max(now).saturating_add(interval);
        }
        true
    }

    /// The shortest mean interval of a message type, if it has one.
    fn interval_of(&self, msgid: u32) -> Option<u64> {
        let named = self.intervals.binary_search_by_key(&msgid, |&(msgid, _)| msgid);
        named.map(|n| self.intervals[n].1).ok().or(self.interval)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::header;
    use mavwire_schema::WireVersion::V2;

    const MS: u64 = 1_000_000;

    fn stream(msgid: u32) -> u64 {
        stream_key(&header(V2, msgid, 0), LinkSet::EMPTY)
    }

    #[test]
    fn streams_differ_by_type_sender_and_origin() {
        let of = |msgid, sysid, source| {
            stream_key(&Header { sysid, ..header(V2, msgid, 0) }, LinkSet::only(source))
        };
        let last = of(0x00FF_FFFF, 255, super::super::LinkId(255));
        assert_eq!(msgid_of(last), 0x00FF_FFFF);
        let links = [0, 1, 255].map(super::super::LinkId);
        let mut keys: Vec<u64> = links.map(|link| of(30, 1, link)).into();
        keys.extend([of(31, 1, links[0]), of(30, 2, links[0]), stream(30), last]);
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), 7);
    }

    /// How many of `count` frames pass that come every `interval` nanoseconds.
    fn passed(limits: &Limits, msgid: u32, count: u64, interval: u64) -> u64 {
        let mut limiter = Limiter::new(limits);
        let times = (0..count).map(|n| 1_000 * MS + n * interval);
        times.filter(|&now| limiter.admit(stream(msgid), 50, now, now)).count() as u64
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
                let stream = stream_key(&header, LinkSet::EMPTY);
                assert_eq!(limiter.admit(stream, 50, 0, time * MS), time == 0, "{sysid}: {msgid}");
            }
        }
    }

    #[test]
    fn streams_that_are_too_many_are_forgotten() {
        let limits = Limits { message_rate: Some(1.0), ..Limits::default() };
        let mut limiter = Limiter::new(&limits);
        let mut passed = |msgid, time: u64| {
            let addresses = (0..=u8::MAX).flat_map(|sysid| (0..=u8::MAX).map(move |c| (sysid, c)));
            let headers =
                addresses.map(|(sysid, compid)| Header { sysid, compid, ..header(V2, msgid, 0) });
            let streams = headers.map(|header| stream_key(&header, LinkSet::EMPTY));
            streams.filter(|&stream| limiter.admit(stream, 50, 0, time * MS)).count()
        };
        let counts = [passed(0, 0), passed(0, 400), passed(30, 400), passed(0, 400)];
        assert_eq!(counts, [MAX_STREAMS, 0, MAX_STREAMS, MAX_STREAMS]);
    }

    #[test]
    fn bytes_are_held_to_their_rate_with_a_short_burst() {
        let limits =
            || Limits { bytes_per_second: Some(ByteRate::new(5_000.0)), ..Limits::default() };
        let got = passed(&limits(), 30, 100_000, MS / 10); // 100 a second of 10,000, for 10 s
        assert!((1_000..=1_075).contains(&got), "{got}");
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
            passed[0] += u32::from(limiter.admit(stream(30), 50, 2 * now, now));
            // 10 of 100 frames a second.
            let is_due = now % (100 * MS) == 0;
            passed[1] += u32::from(is_due && limiter.admit(stream(76), 50, 2 * now + 1, now));
        }
        assert_eq!(passed[1], 100, "all of them");
        assert!((900..=975).contains(&passed[0]), "{passed:?}");
        let flood = (0..10_000).filter(|n| limiter.admit(stream(76), 50, n + 1, n * MS)).count();
        assert!(flood <= 1_200, "{flood}");
    }

    #[test]
    fn what_a_type_holds_back_asks_for_no_bytes() {
        let limits = Limits {
            bytes_per_second: Some(ByteRate::new(500.0)),
            message_rates: vec![(30, 1.0)],
            ..Limits::default()
        };
        let mut limiter = Limiter::new(&limits);
        let mut passed = [0; 2];
        for n in 0..3_000 {
            let now = 1_000 * MS + n * 20 * MS;
            for (count, msgid) in passed.iter_mut().zip([30, 31]) {
                let number = 2 * n + u64::from(msgid);
                *count += u32::from(limiter.admit(stream(msgid), 50, number, now));
            }
        }
        // A minute: 10 a second, of which one of the type that may not have more.
        assert!(passed[0].abs_diff(60) <= 2 && passed[1].abs_diff(540) <= 20, "{passed:?}");
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
