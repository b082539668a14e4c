//! Streams that take turns.
//!
//! In each round a stream may pass once, whenever its message comes. A round ends when the link has time and a stream
//! comes that passed in it already: this begins the next one. Where there are not enough bytes for all, streams that come
//! often thus pass equally often, once a round. A stream that comes less often than rounds end passes always (max-min
//! fairness). This takes no knowledge of how often streams come.

use std::collections::HashMap;

use crate::kind_hash::KindHash;

/// Streams that are remembered. Only made-up addresses are more than that: then all are forgotten.
pub(super) const MAX_STREAMS: usize = 1 << 16;
/// Rounds that a stream missed and may make up for: long texts and lists come in bursts.
const CREDIT: u64 = 8;

/// Bytes may run ahead of their rate by this long on a link that is busy all the time,
const SHORT: u64 = 100_000_000;
/// by this much for a new stream, and for one that has its turn in this round,
const MIDDLE: u64 = 800_000_000;
/// and by this much, or these bytes, for streams that missed rounds, and on a link that rested.
const LONG: u64 = 1_500_000_000;
const LONG_BYTES: f64 = 160.0;
/// Rest makes up for this many times as long of running ahead.
const REST_GAIN: u64 = 8;
/// A stream that was refused in its turn comes before others for this long.
const MAX_WAIT: u64 = 60_000_000_000;

/// The turns of streams, and how far their bytes are ahead. Times are in nanoseconds.
#[derive(Debug)]
pub(super) struct Rounds {
    round: u64,
    /// The first round in which each stream may pass.
    turns: HashMap<u64, u64, KindHash>,
    /// The oldest turn in which a stream was refused, and when.
    refused: Option<(u64, u64)>,
    /// When all bytes that left are through.
    busy_until: u64,
    /// How much further bytes may run ahead after a rest.
    rested: u64,
    /// `LONG` at this rate.
    long: u64,
}

impl Rounds {
    /// Rounds on a link that takes `byte_time` nanoseconds for a byte.
    pub(super) fn new(byte_time: f64) -> Self {
        let long = LONG.max((LONG_BYTES * byte_time) as u64);
        let (turns, rested) = (HashMap::default(), long.saturating_mul(2));
        Self { round: 0, turns, refused: None, busy_until: 0, rested, long }
    }

    /// How far what left is ahead of the rate.
    pub(super) fn lead(&self, now: u64) -> u64 {
        self.busy_until.saturating_sub(now)
    }

    /// Whether a stream's message may leave. If so, the stream takes its turn.
    pub(super) fn arrive(&mut self, stream: u64, now: u64) -> bool {
        self.rest(now);
        self.refused = self.refused.filter(|&(_, at)| now.saturating_sub(at) < MAX_WAIT);
        let known = self.turns.get(&stream).copied();
        let turn = known.unwrap_or(self.round + 1);
        let is_oldest = self.refused.is_none_or(|(oldest, _)| turn <= oldest);
        let after_rest = SHORT.saturating_add(self.rested);
        let reach = match (known, self.round.checked_sub(turn)) {
            (None, _) => MIDDLE,
            _ if !is_oldest => SHORT, // else the first streams of each burst take all of it
            (_, None) => after_rest,
            (_, Some(0)) => MIDDLE.max(after_rest),
            (_, Some(_)) => self.long,
        };
        let passes = self.lead(now) <= reach.min(self.long);
        let mut next_turn = turn;
        if passes {
            self.refused = self.refused.filter(|_| !is_oldest);
            self.round = self.round.max(turn);
            next_turn = turn.max(self.round.saturating_sub(CREDIT)) + 1;
        } else if is_oldest && turn <= self.round {
            self.refused = Some((turn, now));
        }
        if self.turns.len() >= MAX_STREAMS {
            self.turns.clear();
        }
        self.turns.insert(stream, next_turn);
        passes
    }

    /// Puts the time that a frame takes on the account.
    pub(super) fn spend(&mut self, cost: u64, now: u64) {
        self.rest(now);
        self.busy_until = self.busy_until.saturating_add(cost);
        self.rested = self.rested.saturating_sub(cost);
    }

    /// Notes how long nothing left.
    fn rest(&mut self, now: u64) {
        if let Some(idle) = now.checked_sub(self.busy_until) {
            let rested = self.rested.saturating_add(idle.saturating_mul(REST_GAIN));
            self.rested = rested.min(self.long.saturating_mul(2));
            self.busy_until = now;
        }
    }

    #[cfg(test)]
    pub(super) fn known(&self) -> usize {
        self.turns.len()
    }
}
