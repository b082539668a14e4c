//! Streams that take turns.
//!
//! In each round a stream may pass once, whenever its message comes. A round ends when the link has time and a stream
//! comes that passed in it already: this begins the next one. Where there are not enough bytes for all, streams that come
//! often thus pass equally often, once a round, and a stream that comes less often than rounds end passes always (max-min
//! fairness). This takes no knowledge of how often streams come, which would have to be learnt anew when that changes; only
//! when one is to be expected that its round left out goes by when it came before.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use crate::kind_hash::KindHash;

/// Streams that are known. Only made-up addresses are more than that.
pub(super) const MAX_STREAMS: usize = 1 << 16;
/// What has been silent for longer makes room for others,
pub(super) const FORGOTTEN: u64 = 120_000_000_000;
/// at most this often.
const SWEEP_INTERVAL: u64 = 1_000_000_000;
/// Rounds that a stream missed and may make up for: long texts and lists come in bursts.
const CREDIT: u64 = 8;
/// Rounds that are told apart. Far more than `CREDIT`: a stream that does not pass for long comes before those that do.
const LEVELS: usize = 128;

/// Bytes may run ahead of their rate by this long on a link that is busy all the time,
const SHORT: f64 = 100e6;
/// by this much for a stream that is not familiar, and one that was refused in its round,
const MIDDLE: f64 = 800e6;
/// and by this much, or these bytes, for streams that missed rounds, and on a link that rested for as long.
const LONG: f64 = 1_500e6;
const LONG_BYTES: f64 = 160.0;
/// What the link rests makes up for this many times as long that streams may run ahead: batches come in one moment,
const REST_GAIN: f64 = 4.0;
/// which wears off with this time constant while the link is busy.
const REST_DECAY: f64 = 2e9;

/// What the time between two messages of a new stream is taken for, and the most it is taken for.
const FIRST_GAP: u64 = 5_000_000_000;
const MAX_GAP: u64 = 60_000_000_000;
/// By so much of the time between two messages, and by this long at most, they may be early, or late by twice as much;
/// what comes within so much of it is one burst.
const JITTER: u64 = 8;
const MAX_JITTER: u64 = 1_500_000_000;
/// From so many messages on a stream is familiar: one that others wait for.
const FAMILIAR: u8 = 4;

/// One message type from one component. Times are in nanoseconds.
#[derive(Debug)]
struct Stream {
    /// The round from which on it may pass.
    turn: u64,
    /// When its last message came, or burst began, passed or not, and how long after the one before.
    seen: u64,
    gap: u64,
    /// The time that the link takes for one, at all peers.
    cost: f64,
    /// It was refused although it was its turn, and is familiar.
    is_waiting: bool,
    /// It waits, and its next message is to come now: others leave room for it.
    is_expected: bool,
    /// It is among the checks, once.
    is_checked: bool,
    /// Messages that came of it, up to `FAMILIAR`.
    came: u8,
}

impl Stream {
    fn new(turn: u64, cost: f64, now: u64) -> Self {
        Self {
            turn,
            seen: now,
            gap: FIRST_GAP,
            cost,
            is_waiting: false,
            is_expected: false,
            is_checked: false,
            came: 1,
        }
    }

    fn arrive(&mut self, round: u64, now: u64) {
        if !self.is_familiar() {
            self.came += 1;
            // It begins a round, so that all others have their turns beside it: addresses can be made up.
            self.turn = round + 1;
        }
        let gap = now.saturating_sub(self.seen);
        if gap > self.gap / JITTER {
            self.gap = gap.min(MAX_GAP);
            self.seen = now;
        }
    }

    /// Whether it may pass in a round that goes on, be behind others, and have room left for it.
    fn is_familiar(&self) -> bool {
        self.came == FAMILIAR
    }

    /// From when on and until when its next burst is to be expected: later than its last one in any case.
    fn next(&self) -> (u64, u64) {
        let jitter = (self.gap / JITTER).min(MAX_JITTER);
        let next = self.seen.saturating_add(self.gap);
        (next - jitter, next.saturating_add(2 * jitter))
    }
}

/// See the module.
#[derive(Debug)]
pub(super) struct Rounds {
    streams: HashMap<u64, Stream, KindHash>,
    /// When streams may be forgotten.
    sweep_at: u64,
    turns: Turns,
}

impl Rounds {
    /// Rounds on a link that takes `byte_time` nanoseconds for a byte.
    pub(super) fn new(byte_time: f64) -> Self {
        Self { streams: HashMap::default(), sweep_at: 0, turns: Turns::new(byte_time) }
    }

    /// How far what left is ahead of the rate.
    #[cfg(test)]
    pub(super) fn lead(&self, now: u64) -> f64 {
        self.turns.lead(now)
    }

    /// Takes note of a message that takes `cost`; whether it may leave.
    pub(super) fn arrive(&mut self, key: u64, cost: f64, now: u64) -> bool {
        self.turns.rest(now);
        self.turns.look_at_waiting(&mut self.streams, now);
        if let Some(stream) = self.streams.get_mut(&key) {
            stream.arrive(self.turns.round, now);
            return self.turns.decide(key, stream, now);
        }
        let mut stream = Stream::new(self.turns.round + 1, cost, now);
        let passes = self.turns.decide(key, &mut stream, now);
        self.meet(key, stream, now);
        passes
    }

    /// Puts `cost` on the account.
    pub(super) fn spend(&mut self, cost: f64, now: u64) {
        self.turns.rest(now);
        self.turns.busy_until = self.turns.busy_until.max(now).saturating_add(cost as u64);
    }

    /// A stream passed: to the first peer, or to a further one.
    pub(super) fn take_turn(&mut self, key: u64, cost: f64, is_first: bool) {
        match self.streams.get_mut(&key) {
            Some(stream) if is_first => {
                self.turns.take(stream);
                stream.cost = cost;
            }
            Some(stream) => stream.cost += cost,
            None if is_first => self.turns.begin_round(), // there was no room to remember it
            None => {}
        }
    }

    /// Remembers a new stream, if need be in the place of some that have been silent for long.
    fn meet(&mut self, key: u64, stream: Stream, now: u64) {
        if self.streams.len() == MAX_STREAMS && now >= self.sweep_at {
            self.sweep_at = now.saturating_add(SWEEP_INTERVAL);
            let is_kept =
                |stream: &Stream| stream.is_expected || stream.seen.saturating_add(FORGOTTEN) > now;
            self.streams.retain(|_, stream| is_kept(stream));
        }
        if self.streams.len() < MAX_STREAMS {
            self.streams.insert(key, stream);
        }
    }

    #[cfg(test)]
    pub(super) fn known(&self) -> usize {
        self.streams.len()
    }

    #[cfg(test)]
    pub(super) fn checks(&self) -> usize {
        self.turns.checks.len()
    }
}

/// Whose turn it is.
#[derive(Debug)]
struct Turns {
    /// The number of this round.
    round: u64,
    /// Time that is left to streams that are expected, by the rounds that they are behind, and to how many.
    room: [f64; LEVELS],
    expected: usize,
    /// When to look at streams that wait, each at one time.
    checks: BinaryHeap<Reverse<(u64, u64)>>,
    /// When all bytes that left are through.
    busy_until: u64,
    /// How much further bytes may run ahead after a rest, and of when that is.
    rested: f64,
    rested_at: u64,
    /// `LONG` at this rate.
    long: f64,
}

impl Turns {
    fn new(byte_time: f64) -> Self {
        let long = LONG.max(LONG_BYTES * byte_time);
        Self {
            round: 0,
            room: [0.0; LEVELS],
            expected: 0,
            checks: BinaryHeap::new(),
            busy_until: 0,
            rested: long - SHORT,
            rested_at: 0,
            long,
        }
    }

    fn lead(&self, now: u64) -> f64 {
        self.busy_until.saturating_sub(now) as f64
    }

    /// Works out how much further bytes may run ahead now.
    fn rest(&mut self, now: u64) {
        if now <= self.rested_at {
            return;
        }
        let passed = (now - self.rested_at) as f64;
        let idle = now.saturating_sub(self.busy_until.max(self.rested_at)) as f64;
        self.rested *= ((idle - passed) / REST_DECAY).exp();
        self.rested = (self.rested + REST_GAIN * idle).min(self.long - SHORT);
        self.rested_at = now;
    }

    fn decide(&mut self, key: u64, stream: &mut Stream, now: u64) -> bool {
        if stream.turn > self.round {
            let reach = if stream.is_familiar() { SHORT } else { MIDDLE };
            return self.fits(now, reach.max(SHORT + self.rested), 0);
        }
        let behind = self.behind(stream);
        let reach = match behind {
            0 if stream.is_waiting => MIDDLE.max(SHORT + self.rested),
            0 => SHORT + self.rested,
            _ => self.long,
        };
        // Those that are as far behind and wait come before one that does not.
        let passes = self.fits(now, reach, behind + usize::from(stream.is_waiting));
        if !passes {
            self.wait(key, stream);
        }
        passes
    }

    /// A stream was refused in its turn: the next message is what room is left for.
    fn wait(&mut self, key: u64, stream: &mut Stream) {
        stream.is_waiting = true;
        self.leave_room(stream, false);
        if !stream.is_checked {
            stream.is_checked = true;
            self.checks.push(Reverse((stream.next().0, key)));
        }
    }

    /// A stream takes its turn, in this round or the next.
    fn take(&mut self, stream: &mut Stream) {
        if stream.turn > self.round {
            self.begin_round();
        }
        self.stop_waiting(stream);
        stream.turn = stream.turn.max(self.round.saturating_sub(CREDIT)) + 1;
    }

    /// Whether bytes that may run ahead by `reach` leave room for streams that are so many rounds behind.
    fn fits(&self, now: u64, reach: f64, behind: usize) -> bool {
        let lead = self.lead(now);
        let room = || self.room[behind..].iter().sum::<f64>();
        lead <= reach && (self.expected == 0 || lead + room() <= self.long)
    }

    /// How many rounds a stream is behind.
    fn behind(&self, stream: &Stream) -> usize {
        (self.round.saturating_sub(stream.turn) as usize).min(LEVELS - 1)
    }

    fn begin_round(&mut self) {
        self.round += 1;
        if self.expected == 0 {
            return;
        }
        let last = self.room[LEVELS - 2] + self.room[LEVELS - 1];
        self.room.copy_within(..LEVELS - 1, 1);
        self.room[0] = 0.0;
        self.room[LEVELS - 1] = last;
    }

    /// Leaves room for streams that wait when their next message is to be expected, and not for any longer.
    fn look_at_waiting(&mut self, streams: &mut HashMap<u64, Stream, KindHash>, now: u64) {
        while let Some(&Reverse((time, key))) = self.checks.peek()
            && time <= now
        {
            self.checks.pop();
            if let Some(stream) = streams.get_mut(&key) {
                let next_check = self.look_at(stream, now);
                stream.is_checked = next_check.is_some();
                self.checks.extend(next_check.map(|time| Reverse((time, key))));
            }
        }
    }

    /// When to look at it again.
    fn look_at(&mut self, stream: &mut Stream, now: u64) -> Option<u64> {
        let (from, until) = stream.next();
        if !stream.is_waiting || now >= until {
            self.stop_waiting(stream);
            return None;
        }
        self.leave_room(stream, now >= from);
        Some(if now < from { from } else { until })
    }

    fn stop_waiting(&mut self, stream: &mut Stream) {
        stream.is_waiting = false;
        self.leave_room(stream, false);
    }

    fn leave_room(&mut self, stream: &mut Stream, is_wanted: bool) {
        if stream.is_expected == is_wanted {
            return;
        }
        stream.is_expected = is_wanted;
        let behind = self.behind(stream);
        if is_wanted {
            self.expected += 1;
            self.room[behind] += stream.cost;
        } else {
            self.expected -= 1;
            self.room[behind] -= stream.cost;
        }
        if self.expected == 0 {
            self.room = [0.0; LEVELS]; // sums drift
        }
    }
}
