//! How many bytes a second may leave through a link, and whose.
//!
//! Nothing waits for its turn: a frame leaves or is left out. Vehicles send the same messages one behind the other, and
//! many links bring them in batches, so that the first ones would take all the bytes each time. The streams (a message
//! type from a component over a link) therefore take turns in rounds, see [`Rounds`]. Urgent streams have rounds of their own, and of
//! all bytes; the others share what these leave.

mod rounds;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rounds::Rounds;

const SECOND: f64 = 1e9;

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
        stream: u64,
        len: usize,
        is_urgent: bool,
        number: u64,
        now: u64,
    ) -> bool {
        let mut account = self.account();
        if account.decided.number != number {
            account.decide(number, stream, len, is_urgent, now);
        }
        account.decided.passes
    }

    /// Puts the frame that was asked about last on the account: it leaves to one peer.
    pub(super) fn charge(&self, len: usize, now: u64) {
        self.account().charge(len, now);
    }
}

/// What was decided about a frame.
#[derive(Debug)]
struct Decision {
    number: u64,
    key: u64,
    is_urgent: bool,
    passes: bool,
    is_charged: bool,
}

#[derive(Debug)]
struct Account {
    /// Nanoseconds that a byte takes.
    byte_time: f64,
    decided: Decision,
    /// Of these alone.
    urgent: Rounds,
    /// They take their turns with the bytes of the urgent ones on the account.
    ordinary: Rounds,
}

impl Account {
    fn new(byte_time: f64) -> Self {
        let decided =
            Decision { number: 0, key: 0, is_urgent: false, passes: true, is_charged: true };
        let (urgent, ordinary) = (Rounds::new(byte_time), Rounds::new(byte_time));
        Self { byte_time, decided, urgent, ordinary }
    }

    fn rounds(&mut self, is_urgent: bool) -> &mut Rounds {
        if is_urgent { &mut self.urgent } else { &mut self.ordinary }
    }

    fn decide(&mut self, number: u64, key: u64, len: usize, is_urgent: bool, now: u64) {
        let cost = len as f64 * self.byte_time;
        let passes = self.rounds(is_urgent).arrive(key, cost, now);
        self.decided = Decision { number, key, is_urgent, passes, is_charged: false };
    }

    fn charge(&mut self, len: usize, now: u64) {
        let cost = len as f64 * self.byte_time;
        let Decision { key, is_urgent, is_charged, .. } = self.decided;
        self.decided.is_charged = true;
        if is_urgent {
            self.ordinary.spend(cost, now);
        }
        let rounds = self.rounds(is_urgent);
        rounds.spend(cost, now);
        rounds.take_turn(key, cost, !is_charged);
    }
}

#[cfg(test)]
mod tests;
