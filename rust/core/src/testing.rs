//! A small dialect made by hand and frames of it, for the unit tests of this crate. It does not go through the schema
//! crate's XML reader, so that a mistake there cannot hide one here.

use crate::frame::{self, Header};
use crate::registry::Registry;
use mavwire_schema::{Dialect, Field, FieldType, Message, WireVersion};

/// Name, type, array length.
type FieldSpec = (&'static str, FieldType, u8);

/// A v2 HEARTBEAT as another implementation writes it.
pub(crate) const HEARTBEAT_V2: [u8; 21] =
    [0xfd, 9, 0, 0, 0, 1, 1, 0, 0, 0, 4, 0, 0, 0, 2, 3, 0x51, 4, 3, 0x7b, 0xae];
/// The same in v1.
pub(crate) const HEARTBEAT_V1: [u8; 17] =
    [0xfe, 9, 0, 1, 1, 0, 4, 0, 0, 0, 2, 3, 0x51, 4, 3, 0xe1, 0x6d];

fn field(&(name, field_type, array_length): &FieldSpec, is_extension: bool) -> Field {
    Field { name: name.into(), field_type, array_length, is_extension, ..Field::default() }
}

/// A message laid out as the protocol says: base fields by falling element size, then the extension fields.
pub(crate) fn message(
    id: u32,
    name: &str,
    crc_extra: u8,
    base: &[FieldSpec],
    extensions: &[FieldSpec],
) -> Message {
    let mut fields: Vec<Field> = base.iter().map(|spec| field(spec, false)).collect();
    fields.extend(extensions.iter().map(|spec| field(spec, true)));
    let mut wire_order: Vec<u8> = (0..fields.len() as u8).collect();
    wire_order[..base.len()]
        .sort_by_key(|&i| std::cmp::Reverse(fields[usize::from(i)].field_type.size()));
    let mut offset = 0;
    for &i in &wire_order {
        let field = &mut fields[usize::from(i)];
        field.offset = offset;
        offset += field.wire_len() as u8;
    }
    let min_len = fields.iter().filter(|f| !f.is_extension).map(|f| f.wire_len() as u8).sum();
    Message {
        id,
        name: name.into(),
        crc_extra,
        fields,
        wire_order,
        min_len,
        max_len: offset,
        ..Message::default()
    }
}

/// Seven messages between them have every type, extension fields and an id above 255.
pub(crate) fn registry() -> Registry {
    use FieldType::{Char, F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    let heartbeat = [
        ("type", U8, 0),
        ("autopilot", U8, 0),
        ("base_mode", U8, 0),
        ("custom_mode", U32, 0),
        ("system_status", U8, 0),
        ("mavlink_version", U8, 0),
    ];
    let param_value = [
        ("param_id", Char, 16),
        ("param_value", F32, 0),
        ("param_type", U8, 0),
        ("param_count", U16, 0),
        ("param_index", U16, 0),
    ];
    let attitude = [
        ("time_boot_ms", U32, 0),
        ("roll", F32, 0),
        ("pitch", F32, 0),
        ("yaw", F32, 0),
        ("rollspeed", F32, 0),
        ("pitchspeed", F32, 0),
        ("yawspeed", F32, 0),
    ];
    let transfer = [
        ("target_network", U8, 0),
        ("target_system", U8, 0),
        ("target_component", U8, 0),
        ("payload", U8, 251),
    ];
    let debug = [("time_boot_ms", U32, 0), ("ind", U8, 0), ("value", F32, 0)];
    let test_types = [
        ("c", Char, 0),
        ("s", Char, 10),
        ("u8", U8, 0),
        ("u16", U16, 0),
        ("u32", U32, 0),
        ("u64", U64, 0),
        ("s8", I8, 0),
        ("s16", I16, 0),
        ("s32", I32, 0),
        ("s64", I64, 0),
        ("f", F32, 0),
        ("d", F64, 0),
        ("u8_array", U8, 3),
        ("u16_array", U16, 3),
        ("u32_array", U32, 3),
        ("u64_array", U64, 3),
        ("s8_array", I8, 3),
        ("s16_array", I16, 3),
        ("s32_array", I32, 3),
        ("s64_array", I64, 3),
        ("f_array", F32, 3),
        ("d_array", F64, 3),
    ];
    Registry::new(Dialect {
        name: "testing".into(),
        wire_version: WireVersion::V2,
        messages: vec![
            message(0, "HEARTBEAT", 50, &heartbeat, &[]),
            message(22, "PARAM_VALUE", 220, &param_value, &[]),
            message(30, "ATTITUDE", 39, &attitude, &[]),
            message(110, "FILE_TRANSFER_PROTOCOL", 84, &transfer, &[]),
            message(
                253,
                "STATUSTEXT",
                83,
                &[("severity", U8, 0), ("text", Char, 50)],
                &[("id", U16, 0), ("chunk_seq", U8, 0)],
            ),
            message(254, "DEBUG", 46, &debug, &[]),
            message(17000, "TEST_TYPES", 103, &test_types, &[]),
        ],
        others: Vec::new(),
        enums: Vec::new(),
    })
}

/// A header from system 1, component 1.
pub(crate) fn header(version: WireVersion, msgid: u32, seq: u8) -> Header {
    Header::new(version, seq, 1, 1, msgid)
}

/// A frame with a right checksum; an id that the dialect lacks gets `crc_extra` 77.
pub(crate) fn encode(header: Header, payload: &[u8]) -> Vec<u8> {
    let crc_extra = registry().lookup(header.msgid).map_or(77, |entry| entry.crc_extra);
    let mut out = Vec::new();
    frame::encode(&mut out, header, payload, crc_extra).expect("a valid header");
    out
}

/// Bytes without pattern, the same on every run.
pub(crate) fn noise(len: usize, seed: u32) -> Vec<u8> {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 11) as u8
    };
    (0..len).map(next).collect()
}

/// `TEST_TYPES` with small numbers in all fields, as another implementation encodes it.
pub(crate) fn test_types_payload() -> Vec<u8> {
    unhex(
        "040000000000000008000000000000000000000000000440\
        0a000000000000000b000000000000000c00000000000000\
        f6fffffffffffffff5fffffffffffffff4ffffffffffffff\
        000000000000124000000000000016400000000000001a40\
        03000000070000000000c03f070000000800000009000000\
        f9fffffff8fffffff7ffffff0000c03f0000204000006040\
        02000600040005000600fcfffbfffaff41303132333435363738390105010203fffefd",
    )
}

/// The bytes of pairs of hexadecimal digits.
pub(crate) fn unhex(hex: &str) -> Vec<u8> {
    let digit = |b: u8| char::from(b).to_digit(16).unwrap_or(0) as u8;
    hex.as_bytes().chunks_exact(2).map(|pair| digit(pair[0]) << 4 | digit(pair[1])).collect()
}
