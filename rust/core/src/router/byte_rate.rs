//! How many bytes a second may leave through a link, and whose.
//!
//! Nothing waits for its turn: a frame leaves or is left out. Vehicles send the same messages one behind the other, and
//! many links bring them in batches. The first ones would take all the bytes of a plain token bucket each time. The streams (a
//! message type from a component over a link) therefore take turns in [`Rounds`]. Urgent streams have rounds of their own,
//! and of all bytes. The others share the bytes that these leave.

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
        let byte_time = SECOND / bytes_per_second.max(1e-9);
        let [urgent, ordinary] = [Rounds::new(byte_time), Rounds::new(byte_time)];
        Self(Arc::new(Mutex::new(Account { byte_time, asked: None, urgent, ordinary })))
    }

    fn account(&self) -> MutexGuard<'_, Account> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the frame with a number may leave, and if so, puts it on the account. A frame leaves to all peers that it is for or
    /// to none. Otherwise those that are asked first would get everything.
    pub(super) fn admit(
        &self,
        stream: u64,
        len: usize,
        is_urgent: bool,
        number: u64,
        now: u64,
    ) -> bool {
        let mut account = self.account();
        let Account { byte_time, asked, urgent, ordinary } = &mut *account;
        let cost = (len as f64 * *byte_time) as u64;
        let rounds = if is_urgent { &mut *urgent } else { &mut *ordinary };
        let passes = match *asked {
            Some((last, passes)) if last == number => passes,
            _ => rounds.arrive(stream, now),
        };
        *asked = Some((number, passes));
        if passes {
            rounds.spend(cost, now);
            if is_urgent {
                ordinary.spend(cost, now);
            }
        }
        passes
    }
}

#[derive(Debug)]
struct Account {
    /// Nanoseconds that a byte takes.
    byte_time: f64,
    /// The number of the last frame, and whether it passed.
    asked: Option<(u64, bool)>,
    /// Of these alone.
    urgent: Rounds,
    /// They take their turns with the bytes of the urgent ones on the account.
    ordinary: Rounds,
}

#[cfg(test)]
mod tests;
