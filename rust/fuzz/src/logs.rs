//! Logs of good records, damaged here and there, as an input decides.

use mavwire_core::frame::Header;
use mavwire_core::log::dataflash::{FMT_TYPE, FieldKind, HEAD};
use mavwire_schema::WireVersion;

use crate::dialects::{any_message, frame_of, signed};
use crate::input::Input;

/// 2020-09-13, microseconds since 1970.
const START: u64 = 1_600_000_000_000_000;
const DAY: u64 = 24 * 3600 * 1_000_000;

/// Steps from one time stamp to the next; the last ones are not believed behind damage.
const STEPS: [i64; 8] = [0, 1, 0xFD_FE, 1_000_000, -1, -2_000_000, 4 * DAY as i64, i64::MIN];

/// Ids that no dialect has.
const UNKNOWN: [u32; 2] = [0xABCD, 201];

/// A telemetry log whose frames have `lead` bytes in front, 8 or none: its records, and the bytes of other kinds between them.
/// An input whose first byte is 0 is taken as a log as it is.
pub(crate) fn any_telemetry(mut input: Input<'_>, lead: usize) -> Vec<u8> {
    if input.byte() == 0 {
        return input.rest().to_vec();
    }
    let (mut time, mut seq) = (START, 0);
    damaged(input, Vec::new(), |kind, input, log| {
        time = time.wrapping_add_signed(STEPS[usize::from(kind % 8)]);
        seq += 1;
        log.extend_from_slice(&time.to_be_bytes()[..lead]);
        log.extend(small_frame(input, kind, seq));
    })
}

/// A log that begins like this, with the records that `append` makes of a kind below 224, bytes of no record between them, and
/// places where some bytes are missing. Of the start enough stays to tell the kind of log by it.
fn damaged<'a>(
    mut input: Input<'a>,
    start: Vec<u8>,
    mut append: impl FnMut(u8, &mut Input<'a>, &mut Vec<u8>),
) -> Vec<u8> {
    let (least, mut log) = (start.len().min(3), start);
    while !input.is_empty() {
        match input.byte() {
            kind @ 0..224 => append(kind, &mut input, &mut log),
            224..240 => {
                let len = usize::from(input.byte() % 64);
                log.extend_from_slice(input.bytes(len));
            }
            240.. => {
                let cut = usize::from(input.byte() % 32);
                log.truncate(log.len().saturating_sub(cut).max(least));
            }
        }
    }
    log
}

/// A frame with a payload of few bytes, which repeat themselves; some are signed, some of an id that nobody knows.
fn small_frame(input: &mut Input<'_>, kind: u8, seq: u8) -> Vec<u8> {
    let message = any_message(input);
    let (sysid, len) = (input.byte() % 4, usize::from(input.byte() % 16));
    let some = input.bytes(len);
    let payload: Vec<u8> = some.iter().copied().cycle().take(255 * some.len().min(1)).collect();
    if kind / 8 == 1 {
        let header = Header::new(WireVersion::V2, seq, sysid, 1, UNKNOWN[usize::from(sysid % 2)]);
        return frame_of(header, &payload, len as u8 + 1, 77);
    }
    let version =
        if kind / 8 % 4 == 2 && message.id < 256 { WireVersion::V1 } else { WireVersion::V2 };
    let full = if version == WireVersion::V1 { message.min_len } else { message.max_len };
    let header = Header::new(version, seq, sysid, 1, message.id);
    let frame = frame_of(header, &payload, full, message.crc_extra);
    if kind / 8 == 3 { signed(&frame, 1, 0, START / 10) } else { frame }
}

const NAMES: [&str; 12] =
    ["A", "GPS", "UNIT", "MULT", "FMTU", "TIME", "MSG", "POS", "FILE", "ACC1", "PARM", "B"];
const COLUMNS: [&str; 24] = [
    "TimeUS",
    "TimeMS",
    "X",
    "GMS",
    "GWk",
    "T",
    "Week",
    "StartTime",
    "GPSTime",
    "Id",
    "Label",
    "Mult",
    "FmtType",
    "UnitIds",
    "MultIds",
    "Lat",
    "Lng",
    "Alt",
    "Status",
    "Message",
    "I",
    "seq",
    "timestamp",
    "\u{b5}",
];
const KINDS: &[u8] = b"bBhHiIqQgfdnNZcCeELMa";

/// The content of a FMT record: type, length, name, format, columns.
type Description = (u8, u8, &'static str, String, String);

/// A description of a type, mostly a sound one.
fn any_description(input: &mut Input<'_>) -> Description {
    let (type_id, name) = (input.byte() % 8, NAMES[usize::from(input.byte()) % NAMES.len()]);
    let count = usize::from(input.byte() % 8);
    let (mut format, mut columns, mut len) = (String::new(), Vec::new(), 3);
    for _ in 0..count {
        let kind = KINDS[usize::from(input.byte()) % KINDS.len()];
        let size = FieldKind::from_char(kind).map_or(0, FieldKind::size);
        if len + size > 255 {
            break;
        }
        len += size;
        format.push(char::from(kind));
        columns.push(COLUMNS[usize::from(input.byte()) % COLUMNS.len()]);
    }
    let spare = input.byte();
    let len = if spare < 16 { spare } else { len as u8 };
    (type_id, len, name, format, columns.join(","))
}

/// A binary dataflash log. An input whose first byte is 0 is taken as a log as it is.
pub(crate) fn any_dataflash(mut input: Input<'_>) -> Vec<u8> {
    if input.byte() == 0 {
        return input.rest().to_vec();
    }
    let fmt = description_record((FMT_TYPE, 89, "FMT", "BBnNZ".into(), "Type,Length".into()));
    let (mut lens, mut time) = ([4; 8], 0_u64);
    damaged(input, fmt, |kind, input, log| {
        if kind < 48 {
            let description = any_description(input);
            lens[usize::from(description.0)] = description.1;
            log.extend(description_record(description));
        } else {
            let (type_id, few) = (kind % 8, usize::from(input.byte() % 16));
            time += 1000;
            let mut record = vec![HEAD[0], HEAD[1], type_id];
            record.extend_from_slice(&time.to_le_bytes());
            record.extend_from_slice(input.bytes(few));
            record.resize(lens[usize::from(type_id)].max(3).into(), type_id);
            log.extend(record);
        }
    })
}

fn description_record((type_id, len, name, format, columns): Description) -> Vec<u8> {
    let mut record = vec![HEAD[0], HEAD[1], FMT_TYPE, type_id, len];
    for (text, room) in [(name, 4), (&format, 16), (&columns, 64)] {
        let end = record.len() + room;
        record.extend(text.bytes().take(room));
        record.resize(end, 0);
    }
    record
}

/// Values that lines are made of.
const VALUES: [&[u8]; 16] = [
    b"0",
    b"1",
    b"-1",
    b" 7 ",
    b"1.5",
    b"1e309",
    b"nan",
    b"STABILIZE",
    b"2200",
    b"500000",
    b"",
    b"#",
    b"\xb5m",
    b"\xc2\xb5",
    b"18446744073709551615",
    b"9223372036854775808",
];

/// A text dataflash log. An input whose first byte is 0 is taken as a log as it is.
pub(crate) fn any_text_log(mut input: Input<'_>) -> Vec<u8> {
    let flags = input.byte();
    if flags == 0 {
        return input.rest().to_vec();
    }
    let separator = if flags.is_multiple_of(2) { ", " } else { "," };
    let line = |description: Description| {
        let (type_id, len, name, format, columns) = description;
        let values = [&type_id.to_string(), &len.to_string(), name, &format, &columns];
        format!("FMT{separator}{}\n", values.join(separator))
    };
    let fmt = (FMT_TYPE, 89, "FMT", "BBnNZ".into(), "Type,Length,Name,Format,Columns".into());
    damaged(input, line(fmt).into_bytes(), |kind, input, log| {
        if kind < 48 {
            log.extend(line(any_description(input)).into_bytes());
        } else {
            log.extend_from_slice(NAMES[usize::from(kind) % NAMES.len()].as_bytes());
            for _ in 0..kind % 10 {
                log.extend_from_slice(separator.as_bytes());
                log.extend_from_slice(VALUES[usize::from(input.byte()) % VALUES.len()]);
            }
            log.extend_from_slice(if kind.is_multiple_of(5) { b"\r\n" } else { b"\n" });
        }
    })
}
