//! How many bytes a second may leave through a link, and whose.
//!
//! Nothing waits for its turn: a frame leaves or is left out. Vehicles send the same messages one behind the other,
//! several times a second, so that the first ones would take all the bytes each time. Where there are not enough for all,
//! the streams (a message type from a component) therefore have turns: the time between two messages of a stream, the same
//! for all of them, at which together they ask for what the link takes (max-min fairness). A stream that comes less often
//! than that passes always. Urgent streams have their turns first, of all bytes; the others share what these leave.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::frame::Header;
use crate::kind_hash::KindHash;

/// Streams that are known. Only made-up addresses are more than that.
const MAX_STREAMS: usize = 1 << 16;
/// What has been silent for longer makes room for others.
const FORGOTTEN: u64 = 60_000_000_000;
/// Silence behind which a stream asks for nothing any more, beside four of its own intervals.
const SILENCE: u64 = 5_000_000_000;
/// How often turns are worked out.
const SHARE_INTERVAL: u64 = 250_000_000;
/// Bytes may run ahead of their rate by this long,
const BURST: f64 = 100e6;
/// those of a stream whose turn was a whole one ago by this much longer.
const WAITED_BURST: f64 = 1_400e6;
/// By this much of a turn a stream may be early: the next turn is not any earlier for it.
const EARLY: f64 = 0.25;
/// So many turns that were left out a stream may take later, one behind the other: long texts and lists come in bursts.
const CREDIT: f64 = 8.0;
/// What comes may be ahead of the rate by this long at most in `wanted`.
const MAX_WANTED: u64 = 10_000_000_000;
/// What is ahead of the rate for longer is made up for within this time.
const DRAIN: f64 = 2e9;
/// The longest frame.
const MAX_LEN: f64 = 280.0;
/// A stream has no turn.
const NEVER: f64 = 1e18;
const SECOND: f64 = 1e9;

/// Which stream a frame belongs to.
pub(super) fn stream_key(&Header { msgid, sysid, compid, .. }: &Header) -> u64 {
    u64::from(msgid) << 16 | u64::from(sysid) << 8 | u64::from(compid)
}

/// Bytes a second of whole frames, for a link however many peers it has: clones have one account together.
#[derive(Debug, Clone)]
pub struct ByteRate(Arc<Mutex<Account>>);

impl ByteRate {
    /// An account of its own.
    pub fn new(bytes_per_second: f64) -> Self {
        Self(Arc::new(Mutex::new(Account::new(SECOND / bytes_per_second.max(1e-9)))))
    }

    fn account(&self) -> MutexGuard<'_, Account> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the frame with a number may leave: to all peers that it is for or to none, or else those that are asked
    /// first would get everything.
    pub(super) fn allows(
        &self,
        header: &Header,
        len: usize,
        is_urgent: bool,
        number: u64,
        now: u64,
    ) -> bool {
        let mut account = self.account();
        if account.decided.number != number {
            let key = stream_key(header);
            let passes = account.arrive(key, len as f64, is_urgent, now);
            account.decided = Decision { number, key, passes, weight: None };
        }
        account.decided.passes
    }

    /// Puts the frame that was asked about last on the account: it leaves to one peer.
    pub(super) fn charge(&self, len: usize, now: u64) {
        self.account().charge(len as f64, now);
    }
}

/// What was decided about a frame.
#[derive(Debug)]
struct Decision {
    number: u64,
    key: u64,
    passes: bool,
    /// How much its cost counts in the stream's mean, once it was charged.
    weight: Option<f64>,
}

/// One message type from one component. Times are in nanoseconds.
#[derive(Debug)]
struct Stream {
    is_urgent: bool,
    /// When its last message came, passed or not.
    seen: u64,
    /// The mean time between two; `INFINITY` until there were two.
    interval: f64,
    /// The mean time that the link takes for one, at all peers; for one peer until one passed.
    cost: f64,
    has_passed: bool,
    /// When it is its turn.
    due: f64,
}

impl Stream {
    fn arrive(&mut self, is_urgent: bool, turn: f64, now: u64) {
        self.is_urgent = is_urgent;
        // Turns may have been longer when it passed last.
        self.due = self.due.min(now as f64 + (1.0 + EARLY) * turn);
        let gap = now.saturating_sub(self.seen) as f64;
        let weight = if self.interval.is_finite() { 0.125 } else { 1.0 };
        let before = if self.interval.is_finite() { self.interval } else { 0.0 };
        self.interval = before + weight * (gap - before);
        self.seen = now;
    }

    /// What it asks for: the time between two messages, and what each takes. `None` if it asks for nothing.
    fn demand(&self, now: u64) -> Option<(f64, f64)> {
        let quiet = now.saturating_sub(self.seen) as f64;
        let asks = quiet <= 4.0 * self.interval + SILENCE as f64;
        asks.then(|| (self.interval.max(quiet).max(1.0), self.cost))
    }
}

#[derive(Debug)]
struct Account {
    /// Nanoseconds that a byte takes.
    byte_time: f64,
    /// When all bytes that left are through, and all that wanted to leave would be.
    due: u64,
    wanted: u64,
    decided: Decision,
    streams: HashMap<u64, Stream, KindHash>,
    /// The time between two messages of a stream that comes more often than that: ordinary ones, urgent ones.
    turns: [f64; 2],
    /// When turns are worked out again.
    share_at: u64,
    /// How many times the rate may be given away: what streams ask for is never known exactly, and where that leaves room
    /// there are more turns.
    slack: f64,
    /// What the most expensive frames may take.
    longest: f64,
}

impl Account {
    fn new(byte_time: f64) -> Self {
        Self {
            byte_time,
            due: 0,
            wanted: 0,
            decided: Decision { number: 0, key: 0, passes: true, weight: None },
            streams: HashMap::default(),
            turns: [0.0; 2],
            share_at: 0,
            slack: 1.0,
            longest: MAX_LEN * byte_time,
        }
    }

    /// How far what left is ahead of the rate.
    fn lead(&self, now: u64) -> f64 {
        self.due.saturating_sub(now) as f64
    }

    /// Takes note of a frame; whether it may leave.
    fn arrive(&mut self, key: u64, len: f64, is_urgent: bool, now: u64) -> bool {
        if now >= self.share_at {
            self.share_at = now.saturating_add(SHARE_INTERVAL);
            self.share(now);
        }
        let turn = self.turns[usize::from(is_urgent)];
        let (cost, reach) = match self.streams.get_mut(&key) {
            Some(stream) => {
                stream.arrive(is_urgent, turn, now);
                (stream.cost, reach(now as f64 - stream.due, turn))
            }
            None => {
                let cost = len * self.byte_time;
                self.meet(key, cost, is_urgent, now);
                // Behind those that are known and have waited: addresses can be made up.
                (cost, Some(BURST + WAITED_BURST / 2.0))
            }
        };
        let latest = now.saturating_add(MAX_WANTED);
        self.wanted = self.wanted.max(now).saturating_add(cost as u64).min(latest);
        // However far the others are ahead, there is room for urgent ones behind them.
        let ahead = if is_urgent { BURST + WAITED_BURST + self.longest } else { 0.0 };
        reach.is_some_and(|reach| self.lead(now) <= ahead + reach)
    }

    /// Remembers a new stream if there is room.
    fn meet(&mut self, key: u64, cost: f64, is_urgent: bool, now: u64) {
        if self.streams.len() < MAX_STREAMS {
            let (interval, due) = (f64::INFINITY, now as f64);
            let stream = Stream { is_urgent, seen: now, interval, cost, has_passed: false, due };
            self.streams.insert(key, stream);
        }
    }

    fn charge(&mut self, len: f64, now: u64) {
        let cost = len * self.byte_time;
        self.due = self.due.max(now).saturating_add(cost as u64);
        let Some(stream) = self.streams.get_mut(&self.decided.key) else { return };
        let weight = *self.decided.weight.get_or_insert_with(|| {
            let turn = self.turns[usize::from(stream.is_urgent)];
            // Who comes late comes earlier next time: the mean counts.
            stream.due = stream.due.max(now as f64 - CREDIT * turn) + turn;
            let weight = if stream.has_passed { 0.125 } else { 1.0 };
            stream.has_passed = true;
            stream.cost *= 1.0 - weight;
            weight
        });
        stream.cost += weight * cost;
    }

    /// Works out the turns.
    fn share(&mut self, now: u64) {
        if self.streams.len() == MAX_STREAMS {
            self.streams.retain(|_, stream| stream.seen.saturating_add(FORGOTTEN) > now);
        }
        if self.wanted.saturating_sub(now) as f64 <= BURST + WAITED_BURST {
            self.turns = [0.0; 2];
            self.slack = 1.0;
            return;
        }
        let mut demands = [Vec::new(), Vec::new()];
        for stream in self.streams.values() {
            demands[usize::from(stream.is_urgent)].extend(stream.demand(now));
        }
        let costs = demands.iter().flatten().map(|&(_, cost)| cost);
        let longest = costs.fold(0.0, f64::max);
        self.longest = longest.max(MAX_LEN * self.byte_time);
        let factor = if self.due <= now { 1.1 } else { 0.98 };
        self.slack = (self.slack * factor).clamp(1.0, 4.0);
        let excess = (self.lead(now) - BURST - longest).max(0.0);
        let room = self.slack * (1.0 - excess / DRAIN).max(0.5);
        let [ordinary, urgent] = &mut demands;
        let (urgent_turn, taken) = turn(urgent, room);
        self.turns = [turn(ordinary, room - taken).0, urgent_turn];
    }
}

/// How far the account may be ahead for a stream whose turn was `waited` ago; `None` if it is another one's turn.
fn reach(waited: f64, turn: f64) -> Option<f64> {
    let part = if turn > 0.0 { waited / turn } else { 1.0 };
    (part >= -EARLY).then(|| BURST + WAITED_BURST * part.clamp(0.0, 1.0))
}

/// The turn of streams that have `room` (1 is all that the link takes), and how much of that they take then.
fn turn(demands: &mut [(f64, f64)], room: f64) -> (f64, f64) {
    demands.sort_unstable_by(|one, other| other.0.total_cmp(&one.0));
    let mut sharing: f64 = demands.iter().map(|&(_, cost)| cost).sum();
    let mut left = room.max(0.0);
    for &(interval, cost) in &*demands {
        let turn = if left > 0.0 { sharing / left } else { NEVER };
        // The slowest first: this one, and all that follow, come more often.
        if interval <= turn {
            return (turn.min(NEVER), room.max(0.0));
        }
        left -= cost / interval;
        sharing -= cost;
    }
    (0.0, room.max(0.0) - left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::header;
    use mavwire_schema::WireVersion::V2;

    const MS: u64 = 1_000_000;
    const HEARTBEAT: u32 = 0;

    /// A message type: id, bytes, how often in ten seconds.
    type Kind = (u32, usize, u64);

    struct Passed {
        /// Messages of each kind.
        counts: Vec<u64>,
        bytes: usize,
        /// How far ahead of the rate frames left, in seconds: on average.
        lead: f64,
    }

    /// What passes of a vehicle's messages, which come one behind the other in each tenth of a second.
    fn passed(rate: f64, kinds: &[Kind], urgent: &[u32], seconds: u64) -> Passed {
        let bytes = ByteRate::new(rate);
        let (mut counts, mut total, mut lead, mut number) = (vec![0; kinds.len()], 0, 0.0, 0);
        for tenth in 0..10 * seconds {
            let mut now = (1_000 + 100 * tenth) * MS;
            for (&(msgid, len, often), count) in kinds.iter().zip(&mut counts) {
                // Evenly spread, as far as tenths go.
                let is_due = |tenth: u64| tenth * often / 100;
                for _ in is_due(tenth)..is_due(tenth + 1) {
                    now += MS / 10;
                    number += 1;
                    let header = header(V2, msgid, 0);
                    let is_urgent = urgent.contains(&msgid);
                    if bytes.allows(&header, len, is_urgent, number, now) {
                        lead += bytes.account().lead(now) / SECOND;
                        bytes.charge(len, now);
                        *count += 1;
                        total += len;
                    }
                }
            }
        }
        let mean = lead / counts.iter().sum::<u64>().max(1) as f64;
        Passed { counts, bytes: total, lead: mean }
    }

    /// What should pass a second of each of these: as much as there is of it, or as often as the others.
    fn fair(rate: f64, kinds: &[Kind]) -> Vec<f64> {
        let hertz = |kind: &Kind| kind.2 as f64 / 10.0;
        let bytes = |most: f64| -> f64 {
            kinds.iter().map(|kind| hertz(kind).min(most) * kind.1 as f64).sum()
        };
        let (mut low, mut high) = (0.0, 1e6);
        for _ in 0..100 {
            let middle = f64::midpoint(low, high);
            *(if bytes(middle) > rate { &mut high } else { &mut low }) = middle;
        }
        kinds.iter().map(|kind| hertz(kind).min(low)).collect()
    }

    fn check(name: &str, rate: f64, kinds: &[Kind], urgent: &[u32]) {
        let seconds = 300;
        let Passed { counts, bytes, lead } = passed(rate, kinds, urgent, seconds);
        let told = format!("{name} at {rate}: {counts:?}, {bytes} bytes, {lead:.2} s ahead");
        assert!(bytes as f64 <= rate * (seconds as f64 + 2.0) + MAX_LEN, "{told}");
        let longest = kinds.iter().map(|kind| kind.1).max().unwrap_or(0) as f64 / rate;
        assert!(lead < 1.0 + longest, "{told}");
        let (first, others): (Vec<Kind>, Vec<Kind>) =
            kinds.iter().partition(|kind| urgent.contains(&kind.0));
        let first_share = fair(rate, &first);
        let taken: f64 = first.iter().zip(&first_share).map(|(kind, hz)| kind.1 as f64 * hz).sum();
        let others_share = fair((rate - taken).max(0.0), &others);
        let shares = first_share.into_iter().chain(others_share);
        for (kind, share) in first.iter().chain(&others).zip(shares) {
            let got = kinds.iter().zip(&counts).find(|one| one.0 == kind).unwrap().1;
            let expected = share * seconds as f64;
            let near = expected * 0.85 - 2.0..=expected * 1.1 + 10.0;
            assert!(near.contains(&(*got as f64)), "{kind:?}, not {expected:.0}: {told}");
            assert!(kind.0 != HEARTBEAT || taken > rate * 0.9 || *got == 300, "{told}");
        }
    }

    const RATES: [f64; 9] = [40.0, 60.0, 100.0, 200.0, 300.0, 600.0, 1_200.0, 5_760.0, 100_000.0];
    const VEHICLE: [Kind; 9] = [
        (30, 40, 100),
        (27, 41, 100),
        (33, 40, 50),
        (74, 32, 40),
        (1, 43, 20),
        (111, 28, 10),
        (253, 60, 10),
        (2, 24, 10),
        (HEARTBEAT, 21, 10),
    ];

    #[test]
    fn each_stream_gets_what_it_asks_for_or_its_share() {
        let mut backwards = VEHICLE;
        backwards.reverse();
        let heartbeat = [(HEARTBEAT, 21, 10)];
        let of_all_lengths = (1..31).map(|n| (n, 14 + 7 * n as usize, 40)).chain(heartbeat);
        let slow = (1..31).map(|n| (n, 50, 10)).chain(heartbeat);
        let long = (1..16).map(|n| (n, 280, 40)).chain(heartbeat);
        let kinds: [(&str, Vec<Kind>); 6] = [
            ("vehicle", VEHICLE.into()),
            ("backwards", backwards.into()),
            ("files", VEHICLE.into_iter().chain([(110, 263, 50)]).collect()),
            ("of all lengths", of_all_lengths.collect()),
            ("slow", slow.collect()),
            ("long", long.collect()),
        ];
        for (name, kinds) in kinds {
            for rate in RATES {
                check(name, rate, &kinds, &[HEARTBEAT]);
            }
        }
    }

    #[test]
    fn urgent_streams_share_among_themselves_too() {
        for rate in [100.0, 200.0, 300.0, 600.0] {
            check("one", rate, &VEHICLE, &[30, HEARTBEAT]);
            check("two", rate, &VEHICLE, &[30, 27, HEARTBEAT]);
            check("all", rate, &VEHICLE, &VEHICLE.map(|kind| kind.0));
        }
    }

    #[test]
    fn turns_that_were_long_for_a_while_are_forgotten() {
        let bytes = ByteRate::new(150.0);
        let (mut number, mut passed) = (0, vec![0; 8]);
        for tenth in 0..900_u64 {
            let now = (1_000 + 100 * tenth) * MS;
            let mut asks = |header: &Header, len, is_urgent| {
                number += 1;
                let is_allowed = bytes.allows(header, len, is_urgent, number, now);
                if is_allowed {
                    bytes.charge(len, now);
                }
                is_allowed
            };
            for (compid, _) in (1..21).zip(0..20).filter(|_| (200..230).contains(&tenth)) {
                asks(&Header { compid, ..header(V2, 22, 0) }, 37, true);
            }
            for (&(msgid, len, _), count) in VEHICLE.iter().zip(&mut passed) {
                let got = asks(&header(V2, msgid, 0), len, false);
                *count += u32::from(got && tenth >= 300);
            }
        }
        // A minute of 9,000 bytes for frames of 308 in all.
        assert!(passed.iter().all(|count| (24..=34).contains(count)), "{passed:?}");
    }

    #[test]
    fn a_stream_that_asks_for_little_may_ask_for_it_at_once() {
        let bytes = ByteRate::new(300.0);
        let (mut number, mut passed) = (0, [0; 2]);
        for tenth in 0..1_800_u64 {
            let mut now = (1_000 + 100 * tenth) * MS;
            let mut asks = |header: &Header, len| {
                number += 1;
                now += MS / 10;
                let is_allowed = bytes.allows(header, len, false, number, now);
                if is_allowed {
                    bytes.charge(len, now);
                }
                u32::from(is_allowed)
            };
            for msgid in 30..34 {
                asks(&header(V2, msgid, 0), 40);
            }
            // A text in three pieces each ten seconds, eight parameters each fifteen.
            for _ in (0..3).filter(|_| tenth % 100 == 50) {
                passed[0] += asks(&header(V2, 253, 0), 60);
            }
            for _ in (0..8).filter(|_| tenth % 150 == 70) {
                passed[1] += asks(&header(V2, 22, 0), 37);
            }
        }
        assert!(passed[0] >= 50 && passed[1] >= 86, "{passed:?} of [54, 96]");
    }

    #[test]
    fn made_up_streams_take_what_others_leave() {
        let bytes = ByteRate::new(1_000.0);
        let (mut passed, mut number) = (0, 0);
        let mut asks = |header: &Header, now| {
            number += 1;
            let is_allowed = bytes.allows(header, 40, false, number, now);
            if is_allowed {
                bytes.charge(40, now);
            }
            is_allowed
        };
        for tenth in 0..1_200_u64 {
            let now = (1_000 + 100 * tenth) * MS;
            for n in 0..10 {
                let made_up = (tenth * 10 + n) as u32;
                let header = Header {
                    sysid: (made_up >> 8) as u8,
                    compid: made_up as u8,
                    ..header(V2, 30, 0)
                };
                asks(&header, now);
            }
            for msgid in 100..110 {
                passed += u32::from(tenth % 10 == 0 && asks(&header(V2, msgid, 0), now));
            }
        }
        // 400 bytes a second are those of the vehicle.
        assert!(passed > 1_100, "{passed} of 1,200");
    }

    #[test]
    fn streams_that_are_too_many_are_forgotten_with_time() {
        let mut account = Account::new(1e6);
        for key in 0..2 * MAX_STREAMS as u64 {
            account.arrive(key, 40.0, false, key);
        }
        assert_eq!(account.streams.len(), MAX_STREAMS);
        account.arrive(0, 40.0, false, FORGOTTEN * 2);
        assert_eq!(account.streams.len(), 1);
    }
}
