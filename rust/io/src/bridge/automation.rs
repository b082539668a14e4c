//! Frames that the bridge itself sends over a link: heartbeats, and requests for telemetry to vehicles that send none
//! unasked.
//!
//! It speaks as a component of its own, `MAV_COMP_ID_UDP_BRIDGE` of a system that is no ground station's, and is no ground
//! station either: a vehicle must not take it for the one whose silence is to bring it home.

use std::time::Duration;

use mavwire_core::frame::{FrameBuffer, Header};
use mavwire_core::schema::WireVersion;

const HEARTBEAT: u32 = 0;
const HEARTBEAT_EXTRA: u8 = 50;
const REQUEST_DATA_STREAM: u32 = 66;
const REQUEST_DATA_STREAM_EXTRA: u8 = 148;
/// `MAV_COMP_ID_UDP_BRIDGE`.
const COMPONENT: u8 = 240;
/// `MAV_TYPE_ONBOARD_CONTROLLER`, `MAV_AUTOPILOT_INVALID`, `MAV_STATE_ACTIVE`.
const TYPE: u8 = 18;
const AUTOPILOT: u8 = 8;
const ACTIVE: u8 = 4;
const MAVLINK_VERSION: u8 = 3;
/// The offset of `autopilot` in the payload of `HEARTBEAT`.
const AUTOPILOT_AT: usize = 5;
/// `MAV_AUTOPILOT_ARDUPILOTMEGA`, which sends streams that are asked for.
const ARDUPILOT: u8 = 3;
/// Raw sensors, extended status, RC channels, position, and the three extra ones (`MAV_DATA_STREAM`).
const STREAMS: [u8; 7] = [1, 2, 3, 6, 10, 11, 12];
/// A vehicle is asked again after this long: it may have been restarted; microseconds.
const ASK_AGAIN: u64 = 30_000_000;
/// Vehicles that are remembered as asked, for each peer.
const MAX_ASKED: usize = 64;

/// The frames that the bridge itself sends over a link. By default it sends none.
#[derive(Debug, Clone, Default)]
pub struct AutomationOptions {
    /// The system to speak as.
    pub system: u8,
    /// Time between two heartbeats.
    pub heartbeat: Option<Duration>,
    /// Messages a second of each stream that ArduPilot vehicles are asked for.
    pub stream_rate: Option<u16>,
}

/// The automation of one peer.
#[derive(Debug)]
pub(super) struct Automation {
    options: AutomationOptions,
    seq: u8,
    /// When the next heartbeat leaves; microseconds.
    due: u64,
    /// System, component, and when it was asked.
    asked: Vec<(u8, u8, u64)>,
}

impl Automation {
    pub(super) fn new(options: &AutomationOptions) -> Option<Self> {
        let idle = options.heartbeat.is_none() && options.stream_rate.is_none();
        (!idle).then(|| Self { options: options.clone(), seq: 0, due: 0, asked: Vec::new() })
    }

    /// When there is something to send; microseconds.
    pub(super) fn due(&self) -> Option<u64> {
        self.options.heartbeat.map(|_| self.due)
    }

    /// The heartbeat, if it is time for one.
    pub(super) fn heartbeat(&mut self, now: u64) -> Option<FrameBuffer> {
        let interval = self.options.heartbeat?.as_micros() as u64;
        if now < self.due {
            return None;
        }
        // Without catching up on those that a stopped process missed.
        self.due = (self.due + interval).max(now + interval / 2);
        let payload = [0, 0, 0, 0, TYPE, AUTOPILOT, 0, ACTIVE, MAVLINK_VERSION];
        self.frame(HEARTBEAT, &payload, HEARTBEAT_EXTRA)
    }

    /// The requests that a frame which came from the peer calls for: an ArduPilot vehicle's heartbeat, now and then.
    pub(super) fn requests(&mut self, frame: &[u8], header: &Header, now: u64) -> Vec<FrameBuffer> {
        let Some(rate) = self.options.stream_rate else { return Vec::new() };
        let is_ardupilot = header.msgid == HEARTBEAT
            && usize::from(header.payload_len) > AUTOPILOT_AT
            && frame[header.len() + AUTOPILOT_AT] == ARDUPILOT;
        if !is_ardupilot || !self.is_to_be_asked(header.sysid, header.compid, now) {
            return Vec::new();
        }
        let [low, high] = rate.to_le_bytes();
        let request = |stream| {
            let payload = [low, high, header.sysid, header.compid, stream, 1];
            self.frame(REQUEST_DATA_STREAM, &payload, REQUEST_DATA_STREAM_EXTRA)
        };
        STREAMS.into_iter().filter_map(request).collect()
    }

    fn is_to_be_asked(&mut self, sysid: u8, compid: u8, now: u64) -> bool {
        self.asked.retain(|&(.., when)| now < when + ASK_AGAIN);
        let known = self.asked.iter().any(|&(system, part, _)| (system, part) == (sysid, compid));
        if known || self.asked.len() >= MAX_ASKED {
            return false;
        }
        self.asked.push((sysid, compid, now));
        true
    }

    fn frame(&mut self, msgid: u32, payload: &[u8], crc_extra: u8) -> Option<FrameBuffer> {
        let system = self.options.system;
        let header = Header::new(WireVersion::V2, self.seq, system, COMPONENT, msgid);
        self.seq = self.seq.wrapping_add(1);
        let mut frame = FrameBuffer::default();
        frame.encode(header, payload, crc_extra).ok().map(|()| frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavwire_core::builtin;
    use mavwire_core::registry::Registry;

    fn automation(heartbeat: Option<u64>, stream_rate: Option<u16>) -> Automation {
        let heartbeat = heartbeat.map(Duration::from_micros);
        let options = AutomationOptions { system: 125, heartbeat, stream_rate };
        Automation::new(&options).expect("there is something to do")
    }

    #[test]
    fn the_constants_are_the_definitions() {
        let dialect = builtin::dialect("common", WireVersion::V2).expect("it is built in");
        let registry = Registry::new(dialect);
        for (msgid, extra) in
            [(HEARTBEAT, HEARTBEAT_EXTRA), (REQUEST_DATA_STREAM, REQUEST_DATA_STREAM_EXTRA)]
        {
            assert_eq!(registry.lookup(msgid).map(|entry| entry.crc_extra), Some(extra));
        }
        let message = registry.message(registry.lookup(HEARTBEAT).expect("known").index);
        let autopilot = message.fields.iter().find(|field| &*field.name == "autopilot");
        assert_eq!(autopilot.map(|field| usize::from(field.offset)), Some(AUTOPILOT_AT));
    }

    #[test]
    fn heartbeats_keep_their_interval_and_are_not_made_up_for() {
        let mut automation = automation(Some(1_000), None);
        let times = (0..10_000).step_by(100).chain(1_000_000..1_000_600);
        let beats: Vec<u64> = times.filter(|&now| automation.heartbeat(now).is_some()).collect();
        let expected: Vec<u64> = (0..10).map(|n| n * 1_000).chain([1_000_000, 1_000_500]).collect();
        assert_eq!((beats, automation.due()), (expected, Some(1_001_500)));
    }

    #[test]
    fn ardupilot_vehicles_are_asked_now_and_then() {
        let mut automation = automation(None, Some(4));
        let mut ask = |sysid, autopilot, now| {
            let mut frame = FrameBuffer::default();
            let header = Header::new(WireVersion::V2, 0, sysid, 1, 0);
            frame.encode(header, &[0, 0, 0, 0, 2, autopilot], HEARTBEAT_EXTRA).expect("it fits");
            let header = Header::parse(&frame).expect("a frame");
            let asked = automation.requests(&frame, &header, now);
            asked.iter().map(|frame| frame[10..16].to_vec()).collect::<Vec<_>>()
        };
        let expected: Vec<Vec<u8>> = STREAMS.map(|stream| vec![4, 0, 7, 1, stream, 1]).into();
        assert_eq!(ask(7, ARDUPILOT, 0), expected);
        for (sysid, autopilot, now) in [(7, ARDUPILOT, 1), (8, 12, 1), (7, ARDUPILOT, 29_999_999)] {
            assert!(ask(sysid, autopilot, now).is_empty(), "{sysid} {now}");
        }
        assert_eq!(ask(8, ARDUPILOT, 2).len(), STREAMS.len());
        assert_eq!(ask(7, ARDUPILOT, ASK_AGAIN), expected);
        let crowd: usize = (10..200).map(|sysid| ask(sysid, ARDUPILOT, 3 * ASK_AGAIN).len()).sum();
        assert_eq!(crowd, MAX_ASKED * STREAMS.len());
    }
}
