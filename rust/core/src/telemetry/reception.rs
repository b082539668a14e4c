//! Counts, losses and times of the messages that a link receives.

use crate::sequence::SequenceTracker;

/// System and component id under which a SiK radio injects `RADIO_STATUS`. These messages belong to the link.
pub const RADIO: (u8, u8) = (b'3', b'D');

/// The sender of a message, and the message's sequence number.
#[derive(Debug, Clone, Copy)]
pub struct Sender {
    /// System id.
    pub sysid: u8,
    /// Component id.
    pub compid: u8,
    /// Sequence number.
    pub seq: u8,
}

/// The state of a link that received messages change, as plain data.
#[derive(Debug, Default)]
pub struct Reception {
    /// Last sequence numbers.
    pub sequences: SequenceTracker,
    /// Messages received.
    pub received: u64,
    /// Messages lost, by the gaps in the sequence numbers.
    pub lost: u64,
    /// Time of the last message in seconds since 1970; `None` before the first.
    pub time: Option<f64>,
    /// Seconds since the vehicle booted, by its messages.
    pub uptime: f64,
    /// Time of the log record being read; `None` on live links.
    pub record_time: Option<f64>,
    /// Messages of a log get `uptime` as their time.
    pub stamps_uptime: bool,
}

impl Reception {
    /// Accounts for one message and returns its time, which is `now` on a live link.
    ///
    /// `sender` is `None` for bytes that are no known message. Messages of the radio are not counted either.
    #[inline(always)] // once for each message of a log
    pub fn account(&mut self, sender: Option<Sender>, uptime: Option<f64>, now: f64) -> f64 {
        if let Some(Sender { sysid, compid, seq }) = sender
            && (sysid, compid) != RADIO
        {
            self.lost += u64::from(self.sequences.observe(sysid, compid, seq));
            self.received += 1;
        }
        self.uptime = uptime.unwrap_or(self.uptime);
        let time = match self.record_time {
            Some(_) if self.stamps_uptime => self.uptime,
            Some(time) => time,
            None => now,
        };
        self.time = Some(time);
        time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(sysid: u8, compid: u8, seq: u8) -> Sender {
        Sender { sysid, compid, seq }
    }

    #[test]
    fn losses_are_counted_by_sender() {
        let mut link = Reception::default();
        for sender in [from(1, 1, 7), from(2, 1, 0), from(1, 1, 10), from(2, 1, 1)] {
            link.account(Some(sender), None, 0.0);
        }
        assert_eq!((link.received, link.lost), (4, 2));
    }

    #[test]
    fn bad_data_and_the_radio_are_not_counted() {
        let mut link = Reception::default();
        link.account(None, None, 1.0);
        link.account(Some(from(RADIO.0, RADIO.1, 9)), None, 2.0);
        assert_eq!((link.received, link.lost), (0, 0));
        assert_eq!(link.sequences.last().count(), 0);
    }

    #[test]
    fn a_message_has_the_time_of_its_record() {
        let mut link = Reception { record_time: Some(5.0), ..Reception::default() };
        let time = |link: &mut Reception| link.account(None, Some(3.0), 9.0).to_bits();
        assert_eq!(time(&mut link), 5f64.to_bits());
        link.stamps_uptime = true;
        assert_eq!(time(&mut link), 3f64.to_bits());
        link.record_time = None;
        assert_eq!(time(&mut link), 9f64.to_bits(), "live links use the clock");
    }
}
