//! The time of frames that have no time stamp: the one rule for raw streams.
//!
//! * The time is `time_boot_ms`, in microseconds since the start of the system that sends it. `SYSTEM_TIME` has the field too.
//! * The first system that sends a `time_boot_ms` gives the stream its clock. Systems start at different moments, so the
//!   clocks of several do not mix.
//! * `time_boot_ms` wraps after 49.7 days; the time goes on. It begins again where the system started anew.
//! * A frame without that field has the time of the frame before it. Frames before the first one have no time.

use super::boot_clocks::{is_near, is_start};
use crate::frame::Header;
use crate::registry::Registry;

/// The clock of a raw stream.
#[derive(Debug, Clone, Default)]
pub struct StreamClock {
    system: Option<u8>,
    now: Option<u64>,
}

impl StreamClock {
    /// The time of the next frame, given the index of its message. Bytes behind the frame do not matter.
    pub fn hear(&mut self, registry: &Registry, index: u16, frame: &[u8]) -> Option<u64> {
        if let Some(header) = Header::parse(frame)
            && self.system.is_none_or(|system| system == header.sysid)
            && let Some(payload) = frame.get(header.len()..)
            && let sent = usize::from(header.payload_len).min(payload.len())
            && let Some(millis) = registry.boot_times().millis(index, &payload[..sent])
        {
            self.system = Some(header.sysid);
            self.now = Some(
                self.now.map_or(u64::from(millis), |now| unwrapped(now / 1000, millis)) * 1000,
            );
        }
        self.now
    }

    /// The time of the frame before.
    pub fn now(&self) -> Option<u64> {
        self.now
    }
}

/// Milliseconds since the start, of which `millis` has the low 32 bits; `before` is the time heard last.
fn unwrapped(before: u64, millis: u32) -> u64 {
    let newest = before as u32;
    let later = millis.wrapping_sub(newest);
    if is_start(newest, millis) {
        millis.into()
    } else if is_near(newest, millis) {
        before.saturating_add_signed((later as i32).into())
    } else {
        before + u64::from(later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::testing::{encode, header};
    use mavwire_schema::WireVersion::V2;

    #[test]
    fn a_wrap_goes_on_and_a_start_begins_again() {
        const WRAP: u64 = 1 << 32;
        let heard = |times: &[u32]| {
            let step = |now: &mut u64, &millis: &u32| {
                *now = unwrapped(*now, millis);
                Some(*now)
            };
            times.iter().scan(u64::from(times[0]), step).collect::<Vec<_>>()
        };
        let (last, before) = (u32::MAX, u64::from(u32::MAX));
        assert_eq!(heard(&[last, 999, 60_000]), [before, WRAP + 999, WRAP + 60_000]);
        // A message from before the wrap that came late.
        assert_eq!(heard(&[last - 9, 10, last, 20]), [before - 9, WRAP + 10, before, WRAP + 20]);
        assert_eq!(heard(&[last - 1_000_000, 5000])[1], WRAP + 5000);
        assert_eq!(heard(&[600_000, 596_000, 1000, 700_000]), [600_000, 596_000, 1000, 700_000]);
        assert_eq!(heard(&[last, 10, 3_000_000_000, 10])[2..], [WRAP + 3_000_000_000, 10]);
    }

    #[test]
    fn the_first_system_with_a_clock_gives_the_times() {
        let dialect = builtin::dialect("common", V2).expect("it is built in");
        let index = |name| dialect.messages.iter().position(|one| one.name == name);
        let index = |name| index(name).expect("a message") as u16;
        let (attitude, heartbeat, time) =
            (index("ATTITUDE"), index("HEARTBEAT"), index("SYSTEM_TIME"));
        let (registry, mut clock) = (Registry::new(dialect.clone()), StreamClock::default());
        let mut hear = |sysid, index, payload: &[u8]| {
            let frame = encode(Header { sysid, ..header(V2, 0, 0) }, payload);
            clock.hear(&registry, index, &[&frame[..], &[0xFF; 9]].concat())
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
        assert_eq!(clock.hear(&registry, attitude, &[]), clock.now());
    }
}
