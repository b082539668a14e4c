//! Layouts, texts and limits of single frames.

use super::*;
use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, header, unhex};
use mavwire_schema::WireVersion::{V1, V2};

const PAYLOAD: [u8; 9] = [4, 0, 0, 0, 2, 3, 0x51, 4, 3];

fn encoded(header: Header, payload: &[u8], crc_extra: u8) -> Vec<u8> {
    let mut out = vec![0xAA];
    let result = encode(&mut out, header, payload, crc_extra);
    assert_eq!((result, out.remove(0)), (Ok(()), 0xAA), "appended");
    out
}

fn error(bytes: &[u8]) -> String {
    FrameRef::parse(bytes).err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn e01_e02_r1_r2_heartbeat() {
    assert_eq!(encoded(header(V2, 0, 0), &PAYLOAD, 50), HEARTBEAT_V2);
    assert_eq!(encoded(header(V1, 0, 0), &PAYLOAD, 50), HEARTBEAT_V1);
}

#[test]
fn e05_e06_r9_zeros_are_trimmed_in_version_2_only() {
    let [v2, v1] = [V2, V1].map(|version| encoded(header(version, 21, 0), &[0, 0], 159));
    assert_eq!(v2, unhex("fd010000000101150000002ec0"));
    assert_eq!(v1, unhex("fe0200010115000004b9"));
    assert_eq!(trim_zeros(&[]), [0_u8; 0]);
    assert_eq!(trim_zeros(&[0, 0, 0]), [0]);
    assert_eq!(trim_zeros(&[0, 5, 0, 0]), [0, 5]);
    assert_eq!(trim_zeros(&[1]), [1]);
}

#[test]
fn r5_ids_that_do_not_fit_are_refused() {
    let mut out = vec![1, 2];
    let payload = [1; 9];
    for (version, msgid) in [(V1, 256), (V1, u32::MAX), (V2, 1 << 24)] {
        let result = encode(&mut out, header(version, msgid, 0), &payload, 0);
        assert_eq!(result, Err(FrameError::IdTooLarge(msgid)));
    }
    let result = encode(&mut out, header(V2, 0, 0), &[1; 256], 0);
    assert_eq!(result, Err(FrameError::PayloadTooLong(256)));
    assert_eq!(out, [1, 2], "nothing is appended");
    let frame = encoded(header(V2, (1 << 24) - 1, 0), &payload, 0);
    assert_eq!(Header::parse(&frame).map(|header| header.msgid), Some((1 << 24) - 1));
}

#[test]
fn r4_lengths() {
    let mut header = header(V2, 0, 0);
    for (version, flags, payload_len, len) in
        [(V1, 0, 0, 8), (V1, 0, 255, 263), (V2, 0, 0, 12), (V2, 1, 255, MAX_FRAME_LEN)]
    {
        header = Header { version, incompat_flags: flags, payload_len, ..header };
        assert_eq!(header.frame_len(), len);
        let stx = if version == V1 { STX_V1 } else { STX_V2 };
        assert_eq!(claimed_len(&[stx, payload_len, flags]), Some(len));
    }
    assert_eq!(claimed_len(&[STX_V2, 0]), None);
    assert_eq!(claimed_len(&[0, 0, 0]), None);
}

#[test]
fn the_header_is_what_the_bytes_say() {
    let bytes = [0xFD, 3, 1, 2, 4, 5, 6, 0x2C, 0x01, 0x02];
    let header = Header {
        version: V2,
        payload_len: 3,
        incompat_flags: 1,
        compat_flags: 2,
        seq: 4,
        sysid: 5,
        compid: 6,
        msgid: 0x02_012C,
    };
    assert_eq!(Header::parse(&bytes), Some(header));
    assert!(header.is_signed());
    let v1 = Header::parse(&[0xFE, 3, 4, 5, 6, 200]);
    let expected = Header { version: V1, incompat_flags: 0, compat_flags: 0, msgid: 200, ..header };
    assert_eq!(v1, Some(expected));
    for short in 0..10 {
        assert_eq!(Header::parse(&bytes[..short]), None);
    }
    assert_eq!(Header::parse(&[0x55; 20]), None);
}

#[test]
fn parts_of_a_signed_frame() {
    let mut signed = header(V2, 0, 0);
    signed.incompat_flags = IFLAG_SIGNED;
    let mut bytes = encoded(signed, &PAYLOAD, 50);
    bytes.extend([3, 6, 5, 4, 3, 2, 1, 0x90, 0x32, 0xcc, 0xaf, 0x59, 0x51]);
    let frame = FrameRef::parse(&bytes).expect("a whole frame");
    assert_eq!((frame.payload(), frame.bytes().len()), (&PAYLOAD[..], 34));
    assert_eq!(frame.checksum(), frame.calculated_checksum(50));
    assert_eq!(frame.crc_region(), &bytes[1..19]);
    let digest = &[0x90, 0x32, 0xcc, 0xaf, 0x59, 0x51];
    let expected = SignatureRef { link_id: 3, timestamp: 0x0102_0304_0506, digest };
    assert_eq!(frame.signature(), Some(expected));
    let unsigned = FrameRef::parse(&HEARTBEAT_V1).expect("a whole frame");
    assert_eq!((unsigned.signature(), unsigned.payload()), (None, &PAYLOAD[..]));
}

#[test]
fn d06_to_d10_errors_have_pymavlinks_texts() {
    let short = "Unable to unpack MAVLink header: unpack requires a buffer of";
    assert_eq!(error(&[0xFD, 9, 0, 0, 0]), format!("{short} 10 bytes"));
    assert_eq!(error(&[0xFE, 9, 0, 0]), format!("{short} 6 bytes"));
    assert_eq!(error(&[]), format!("{short} 10 bytes"));
    let mut foreign = HEARTBEAT_V2;
    foreign[0] = 0x55;
    assert_eq!(error(&foreign), "invalid MAVLink prefix '0x55'");
    let long = [&HEARTBEAT_V2[..], &[0]].concat();
    let text = "invalid MAVLink message length.";
    assert_eq!(error(&long), format!("{text} Got 10 expected 9, msgId=0 headerlen=10"));
    assert_eq!(error(&HEARTBEAT_V1[..16]), format!("{text} Got 8 expected 9, msgId=0 headerlen=6"));
    assert_eq!(error(&HEARTBEAT_V1[..6]), format!("{text} Got -2 expected 9, msgId=0 headerlen=6"));
    assert_eq!(FrameError::BadPrefix(85).to_string(), "invalid MAVLink prefix '85'");
    assert_eq!(FrameError::IncompatFlags(2).to_string(), "invalid incompat_flags 0x2 0xfd 12");
    assert_eq!(FrameError::InvalidSignature.to_string(), "Invalid signature");
    let crc = FrameError::BadChecksum { msgid: 0, received: 0x1B, calculated: 0xAE7B };
    assert_eq!(crc.to_string(), "invalid MAVLink CRC in msgID 0 0x001b should be 0xae7b");
}

proptest::proptest! {
    #[test]
    fn what_is_encoded_is_parsed_back(
        v2: bool, flags: (u8, u8), ids: (u8, u8, u8), msgid in 0u32..1 << 24, crc_extra: u8,
        payload in proptest::collection::vec(proptest::num::u8::ANY, 0..=255),
    ) {
        let header = Header {
            version: if v2 { V2 } else { V1 },
            payload_len: payload.len() as u8,
            incompat_flags: if v2 { flags.0 & !IFLAG_SIGNED } else { 0 },
            compat_flags: if v2 { flags.1 } else { 0 },
            seq: ids.0,
            sysid: ids.1,
            compid: ids.2,
            msgid: if v2 { msgid } else { msgid & 0xFF },
        };
        let bytes = encoded(header, &payload, crc_extra);
        let frame = FrameRef::parse(&bytes).expect("a whole frame");
        let sent = if v2 { trim_zeros(&payload) } else { &payload[..] };
        proptest::prop_assert_eq!(frame.payload(), sent);
        proptest::prop_assert_eq!(frame.checksum(), frame.calculated_checksum(crc_extra));
        proptest::prop_assert_eq!(*frame.header(), Header { payload_len: sent.len() as u8, ..header });
    }
}
