//! The time of frames that have no time stamp: the one rule for raw streams.
//!
//! * The time is `time_boot_ms`, in microseconds since the start of the system that sends it. `SYSTEM_TIME` has the field too.
//! * The first system that sends a `time_boot_ms` gives the stream its clock. Systems start at different moments, so the
//!   clocks of several do not mix.
//! * A frame without that field has the time of the frame before it. Frames before the first one have no time.

use super::BootTimes;
use crate::frame::Header;

/// The clock of a raw stream.
#[derive(Debug, Clone)]
pub struct StreamClock {
    times: BootTimes,
    system: Option<u8>,
    now: Option<u64>,
}

impl StreamClock {
    /// The clock of a stream that nothing was heard of yet.
    pub fn new(times: BootTimes) -> Self {
        Self { times, system: None, now: None }
    }

    /// The time of the next frame, given the index of its message. Bytes behind the frame do not matter.
    pub fn hear(&mut self, index: u16, frame: &[u8]) -> Option<u64> {
        if let Some(header) = Header::parse(frame)
            && self.system.is_none_or(|system| system == header.sysid)
            && let Some(payload) = frame.get(header.len()..)
            && let sent = usize::from(header.payload_len).min(payload.len())
            && let Some(millis) = self.times.millis(index, &payload[..sent])
        {
            self.system = Some(header.sysid);
            self.now = Some(u64::from(millis) * 1000);
        }
        self.now
    }

    /// The time of the frame before.
    pub fn now(&self) -> Option<u64> {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::testing::{encode, header};
    use mavwire_schema::WireVersion::V2;

    #[test]
    fn the_first_system_with_a_clock_gives_the_times() {
        let dialect = builtin::dialect("common", V2).expect("it is built in");
        let index = |name| dialect.messages.iter().position(|one| one.name == name);
        let index = |name| index(name).expect("a message") as u16;
        let (attitude, heartbeat, time) =
            (index("ATTITUDE"), index("HEARTBEAT"), index("SYSTEM_TIME"));
        let mut clock = StreamClock::new(BootTimes::of(&dialect));
        let mut hear = |sysid, index, payload: &[u8]| {
            let frame = encode(Header { sysid, ..header(V2, 0, 0) }, payload);
            clock.hear(index, &[&frame[..], &[0xFF; 9]].concat())
        };
        let boot = |millis: u32| millis.to_le_bytes();
        assert_eq!(hear(1, heartbeat, &[9; 9]), None);
        assert_eq!(hear(2, attitude, &boot(0)), None);
        // The zero at the end was cut.
        assert_eq!(hear(2, attitude, &boot(1500)[..2]), Some(1_500_000));
        assert_eq!(hear(1, attitude, &boot(700)), Some(1_500_000));
        assert_eq!(hear(1, heartbeat, &[9; 9]), Some(1_500_000));
        assert_eq!(hear(2, time, &[&[0xFF; 8][..], &boot(1600)].concat()), Some(1_600_000));
        assert_eq!(hear(2, u16::MAX, &[]), Some(1_600_000));
        assert_eq!(clock.hear(attitude, &[]), clock.now());
    }
}
