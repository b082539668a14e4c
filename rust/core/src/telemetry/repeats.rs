//! Messages that repeat what the state of a system shows already.

use crate::frame::Header;

/// Message id of `GPS_RAW_INT`, from which mavutil takes the home position until it has one with a fix.
const GPS_RAW_INT: u32 = 24;

/// Message id of `PARAM_VALUE`.
const PARAM_VALUE: u32 = 22;

/// Kinds of messages remembered for a system.
const MAX_KINDS: usize = 64;

/// The newest messages of one system that change its state.
#[derive(Debug, Default)]
pub struct Repeats {
    /// Message id, component id and payload.
    newest: Vec<(u32, u8, Box<[u8]>)>,
    /// The home position does not change any more.
    pub home_is_fixed: bool,
}

impl Repeats {
    /// Whether the last message of this kind from this component was the same. Remembers this one.
    pub fn hear(&mut self, header: &Header, payload: &[u8]) -> bool {
        let &Header { msgid, compid, .. } = header;
        match msgid {
            GPS_RAW_INT => return self.home_is_fixed,
            // A program may change the parameters, and does not tell.
            PARAM_VALUE => return false,
            _ => {}
        }
        let is_full = self.newest.len() >= MAX_KINDS;
        match self.newest.iter_mut().find(|known| (known.0, known.1) == (msgid, compid)) {
            Some((.., last)) if **last == *payload => return true,
            Some((.., last)) => *last = payload.into(),
            None if is_full => {}
            None => self.newest.push((msgid, compid, payload.into())),
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hear(repeats: &mut Repeats, msgid: u8, compid: u8, payload: &[u8]) -> bool {
        let frame = [0xFE, payload.len() as u8, 0, 1, compid, msgid];
        repeats.hear(&Header::parse(&frame).unwrap(), payload)
    }

    #[test]
    fn an_equal_message_of_the_same_component_is_a_repeat() {
        let mut repeats = Repeats::default();
        let heard = [(1, [4]), (1, [4]), (2, [4]), (1, [5]), (1, [4]), (2, [4])]
            .map(|(compid, payload)| hear(&mut repeats, 0, compid, &payload));
        assert_eq!(heard, [false, true, false, false, false, true]);
    }

    #[test]
    fn parameters_and_the_home_position_are_no_repeats() {
        let mut repeats = Repeats::default();
        assert!(![22, 22, 24, 24].map(|msgid| hear(&mut repeats, msgid, 1, &[1])).contains(&true));
        repeats.home_is_fixed = true;
        assert!(hear(&mut repeats, 24, 1, &[2]));
    }

    #[test]
    fn few_kinds_are_remembered() {
        let mut repeats = Repeats::default();
        for compid in 0..=255 {
            hear(&mut repeats, 0, compid, &[]);
        }
        assert_eq!(repeats.newest.len(), MAX_KINDS);
    }
}
