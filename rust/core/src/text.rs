//! A message as text: pymavlink's `str()` and `to_json()`, byte for byte.
//!
//! Numbers are spelled as Python spells them, text fields end at their first NUL and show U+FFFD for each byte that is
//! not ASCII.

use crate::codec::{Number, field_bytes, number};
use crate::frame::MAX_PAYLOAD_LEN;
use crate::pyfloat;
use mavwire_schema::{Field, FieldType, Message};

/// The field of `SETUP_SIGNING` that no text shows: it reads as 32 times 255 (MAVLink guide, Message Signing, Logging).
pub const SECRET_FIELD: &str = "secret_key";

/// Appends `NAME {a : 1, b : [1, 2]}`. `payload` may be truncated.
pub fn write_text(out: &mut String, message: &Message, payload: &[u8]) {
    out.push_str(&message.name);
    out.push_str(" {");
    for (n, field) in message.fields.iter().enumerate() {
        if n > 0 {
            out.push_str(", ");
        }
        out.push_str(&field.name);
        out.push_str(" : ");
        write_field_text(out, field, payload);
    }
    out.push('}');
}

/// Appends a field's value as Python's `str` shows it: text as it is, `1.5`, `[1, 2]`.
pub fn write_field_text(out: &mut String, field: &Field, payload: &[u8]) {
    if field.is_char() {
        write_char_text(out, field, payload);
    } else {
        write_numbers(out, field, payload, pyfloat::write_repr);
    }
}

/// Appends `{"mavpackettype": "NAME", "a": 1, "b": [1, 2]}` as Python's `json.dumps` writes it: ASCII only, `NaN` and
/// `Infinity` as such.
pub fn write_json(out: &mut String, message: &Message, payload: &[u8]) {
    out.push_str("{\"mavpackettype\": \"");
    out.push_str(&message.name);
    out.push('"');
    for field in &message.fields {
        out.push_str(", \"");
        out.push_str(&field.name);
        out.push_str("\": ");
        write_field_json(out, field, payload);
    }
    out.push('}');
}

/// Appends a field's value as `json.dumps` writes it.
pub fn write_field_json(out: &mut String, field: &Field, payload: &[u8]) {
    if field.is_char() {
        let mut text = String::new();
        write_char_text(&mut text, field, payload);
        write_json_string(out, &text);
    } else {
        write_numbers(out, field, payload, write_json_float);
    }
}

/// Appends the text of a `char` or `char[n]` field.
pub fn write_char_text(out: &mut String, field: &Field, payload: &[u8]) {
    write_bytes_text(out, field_bytes(field, payload));
}

/// Appends bytes up to the first NUL as a text.
pub fn write_bytes_text(out: &mut String, bytes: &[u8]) {
    let bytes = &bytes[..memchr::memchr(0, bytes).unwrap_or(bytes.len())];
    match std::str::from_utf8(bytes) {
        Ok(text) if text.is_ascii() => out.push_str(text),
        _ => out.extend(bytes.iter().map(|&byte| match byte {
            0..0x80 => char::from(byte),
            _ => char::REPLACEMENT_CHARACTER,
        })),
    }
}

/// Appends a JSON string with everything but printable ASCII escaped, beyond the first 65,536 code points as a
/// surrogate pair.
pub fn write_json_string(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            '\u{8}' => out.push_str("\\b"),
            '\u{C}' => out.push_str("\\f"),
            _ => c.encode_utf16(&mut [0; 2]).iter().for_each(|&unit| write_escape(out, unit)),
        }
    }
    out.push('"');
}

fn write_escape(out: &mut String, unit: u16) {
    out.push_str("\\u");
    for shift in [12, 8, 4, 0] {
        out.push(char::from(b"0123456789abcdef"[usize::from(unit >> shift & 15)]));
    }
}

/// Appends a float as `json.dumps` writes it.
pub fn write_json_float(out: &mut String, value: f64) {
    match value {
        _ if value.is_nan() => out.push_str("NaN"),
        f64::INFINITY => out.push_str("Infinity"),
        f64::NEG_INFINITY => out.push_str("-Infinity"),
        _ => pyfloat::write_repr(out, value),
    }
}

/// Appends a number, or `[a, b]` for an array.
fn write_numbers(
    out: &mut String,
    field: &Field,
    payload: &[u8],
    write_float: fn(&mut String, f64),
) {
    let start = usize::from(field.offset);
    if field.array_length == 0 {
        return write_number(out, field.field_type, payload, start, write_float);
    }
    let redacted = [0xFF; MAX_PAYLOAD_LEN];
    let (payload, start) =
        if &*field.name == SECRET_FIELD { (&redacted[..], 0) } else { (payload, start) };
    out.push('[');
    for n in 0..field.elements() {
        if n > 0 {
            out.push_str(", ");
        }
        let offset = start + n * field.field_type.size();
        write_number(out, field.field_type, payload, offset, write_float);
    }
    out.push(']');
}

#[inline]
fn write_number(
    out: &mut String,
    field_type: FieldType,
    payload: &[u8],
    offset: usize,
    write_float: fn(&mut String, f64),
) {
    match number(field_type, payload, offset) {
        Number::Float(value) => write_float(out, value),
        Number::Unsigned(value) => write_integer(out, value),
        Number::Signed(value) => write_integer(out, value),
    }
}

fn write_integer(out: &mut String, value: impl itoa::Integer) {
    out.push_str(itoa::Buffer::new().format(value));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::Registry;
    use crate::testing::{message, registry, test_types_payload};
    use mavwire_schema::WireVersion;

    fn both(registry: &Registry, msgid: u32, payload: &[u8]) -> (String, String) {
        let message = registry.message(registry.lookup(msgid).map_or(0, |entry| entry.index));
        let (mut text, mut json) = (String::new(), String::new());
        write_text(&mut text, message, payload);
        write_json(&mut json, message, payload);
        (text, json)
    }

    #[test]
    fn t06_t07_heartbeat() {
        let (text, json) = both(&registry(), 0, &[4, 0, 0, 0, 2, 3, 0x51, 4, 3]);
        assert_eq!(
            text,
            "HEARTBEAT {type : 2, autopilot : 3, base_mode : 81, custom_mode : 4, \
             system_status : 4, mavlink_version : 3}"
        );
        assert_eq!(
            json,
            "{\"mavpackettype\": \"HEARTBEAT\", \"type\": 2, \"autopilot\": 3, \
             \"base_mode\": 81, \"custom_mode\": 4, \"system_status\": 4, \"mavlink_version\": 3}"
        );
    }

    #[test]
    fn r53_a_key_is_not_shown() {
        let common = crate::builtin::dialect("common", WireVersion::V2).expect("built in");
        let (text, json) = both(&Registry::new(common), 256, &[0x5A; 42]);
        let redacted = format!("[{}]", vec!["255"; 32].join(", "));
        assert!(text.contains(&format!("secret_key : {redacted},")), "{text}");
        assert!(json.contains(&format!("\"secret_key\": {redacted},")), "{json}");
        assert!(text.starts_with("SETUP_SIGNING {target_system : 90, target_component : 90"));
    }

    #[test]
    fn t01_t03_t08_floats() {
        let floats = [0.1_f32, 1e20, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0];
        let mut payload = 1_u32.to_le_bytes().to_vec();
        payload.extend(floats.iter().flat_map(|f| f.to_le_bytes()));
        let (text, json) = both(&registry(), 30, &payload);
        assert_eq!(
            text,
            "ATTITUDE {time_boot_ms : 1, roll : 0.10000000149011612, pitch : \
             1.0000000200408773e+20, yaw : nan, rollspeed : inf, pitchspeed : -inf, yawspeed : -0.0}"
        );
        assert!(json.ends_with(
            "\"yaw\": NaN, \"rollspeed\": Infinity, \"pitchspeed\": -Infinity, \"yawspeed\": -0.0}"
        ));
    }

    #[test]
    fn d19_r23_text_that_is_not_ascii() {
        let (text, json) = both(&registry(), 253, b"\x06caf\xc3\xa9 \xff!\0hidden");
        assert_eq!(
            text,
            "STATUSTEXT {severity : 6, text : caf\u{FFFD}\u{FFFD} \u{FFFD}!, id : 0, chunk_seq : 0}"
        );
        assert_eq!(
            json,
            "{\"mavpackettype\": \"STATUSTEXT\", \"severity\": 6, \
             \"text\": \"caf\\ufffd\\ufffd \\ufffd!\", \"id\": 0, \"chunk_seq\": 0}"
        );
    }

    #[test]
    fn d25_every_type() {
        let (text, json) = both(&registry(), 17000, &test_types_payload());
        assert_eq!(
            text,
            "TEST_TYPES {c : A, s : 0123456789, u8 : 1, u16 : 2, u32 : 3, u64 : 4, s8 : 5, s16 : 6, \
             s32 : 7, s64 : 8, f : 1.5, d : 2.5, u8_array : [1, 2, 3], u16_array : [4, 5, 6], \
             u32_array : [7, 8, 9], u64_array : [10, 11, 12], s8_array : [-1, -2, -3], \
             s16_array : [-4, -5, -6], s32_array : [-7, -8, -9], s64_array : [-10, -11, -12], \
             f_array : [1.5, 2.5, 3.5], d_array : [4.5, 5.5, 6.5]}"
        );
        assert!(json.contains("\"c\": \"A\", \"s\": \"0123456789\", \"u8\": 1"), "{json}");
        assert!(json.ends_with("\"d_array\": [4.5, 5.5, 6.5]}"), "{json}");
        // Nothing at all reads as zeros.
        let (text, _) = both(&registry(), 17000, &[]);
        assert!(text.contains("c : , s : , u8 : 0"), "{text}");
        assert!(text.ends_with("d_array : [0.0, 0.0, 0.0]}"), "{text}");
    }

    #[test]
    fn t25_extreme_integers() {
        let fields = [("tc1", FieldType::I64, 0), ("ts1", FieldType::U64, 0)];
        let message = message(111, "TIMESYNC", 34, &fields, &[]);
        let payload = [i64::MIN.to_le_bytes(), u64::MAX.to_le_bytes()].concat();
        let mut text = String::new();
        write_text(&mut text, &message, &payload);
        assert_eq!(text, "TIMESYNC {tc1 : -9223372036854775808, ts1 : 18446744073709551615}");
    }

    #[test]
    fn json_strings_are_escaped_as_python_does() {
        let mut out = String::new();
        write_json_string(&mut out, "a\"\\/\n\r\t\u{8}\u{c}\u{1f}\u{7f}\u{e9}\u{1F600}~");
        assert_eq!(out, "\"a\\\"\\\\/\\n\\r\\t\\b\\f\\u001f\\u007f\\u00e9\\ud83d\\ude00~\"");
    }
}
