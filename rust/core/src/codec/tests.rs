//! Every type, every truncation, every bit.

use super::*;
use crate::testing::{noise, registry, test_types_payload};
use proptest::prelude::*;

fn test_types() -> Message {
    let registry = registry();
    registry.message(registry.lookup(17000).map_or(0, |entry| entry.index)).clone()
}

fn values_of(payload: &[u8]) -> Vec<Value> {
    decode_all(&test_types(), payload)
}

#[test]
fn r3_r8_values_of_every_type() {
    let payload = test_types_payload();
    let values = values_of(&payload);
    let expected = [
        Value::Text(b"A".into()),
        Value::Text(b"0123456789".into()),
        Value::U64(1),
        Value::U64(2),
        Value::U64(3),
        Value::U64(4),
        Value::I64(5),
        Value::I64(6),
        Value::I64(7),
        Value::I64(8),
        Value::F32(1.5),
        Value::F64(2.5),
        Value::U64Array(vec![1, 2, 3]),
        Value::U64Array(vec![4, 5, 6]),
        Value::U64Array(vec![7, 8, 9]),
        Value::U64Array(vec![10, 11, 12]),
        Value::I64Array(vec![-1, -2, -3]),
        Value::I64Array(vec![-4, -5, -6]),
        Value::I64Array(vec![-7, -8, -9]),
        Value::I64Array(vec![-10, -11, -12]),
        Value::F32Array(vec![1.5, 2.5, 3.5]),
        Value::F64Array(vec![4.5, 5.5, 6.5]),
    ];
    assert_eq!(values, expected);
    let mut space = [0xAA; 255];
    assert_eq!(encode_all(&test_types(), &values, &mut space), Ok(&payload[..]));
}

#[test]
fn r10_r14_truncation_at_every_length_reads_as_zeros() {
    let whole = noise(179, 5);
    for len in 0..=179 {
        let mut zeroed = whole.clone();
        zeroed[len..].fill(0);
        // Compared as payloads: NaN differs from itself.
        let mut space = ([0; 255], [0; 255]);
        let message = test_types();
        let short = encode_all(&message, &values_of(&whole[..len]), &mut space.0);
        assert_eq!(short, encode_all(&message, &values_of(&zeroed), &mut space.1), "{len}");
        let mut space = [0x55; 255];
        assert_eq!(payload_extended(&whole[..len], 179, &mut space), zeroed);
    }
}

#[test]
fn r12_surplus_bytes_are_ignored() {
    let mut payload = vec![1; 179];
    let values = values_of(&payload);
    payload.extend([9; 76]);
    assert_eq!(values_of(&payload), values);
    assert_eq!(payload_extended(&payload, 179, &mut [0; 255]), &payload[..179]);
}

#[test]
fn r24_nan_payload_bits_survive() {
    let message = test_types();
    for bits in [0x7FA1_2345_u32, 0xFFC0_0001, 0x7F80_0001, 0x7F80_0000, 0x8000_0000] {
        let mut payload = [0; 179];
        for field in message.fields.iter().filter(|field| field.field_type == FieldType::F32) {
            for n in 0..field.elements() {
                let at = usize::from(field.offset) + 4 * n;
                payload[at..at + 4].copy_from_slice(&bits.to_le_bytes());
            }
        }
        let mut space = [0; 255];
        assert_eq!(encode_all(&message, &values_of(&payload), &mut space), Ok(&payload[..]));
    }
}

#[test]
fn r25_values_that_do_not_fit_are_refused() {
    let message = test_types();
    let field = |name: &str| message.fields.iter().find(|f| f.name == name).cloned();
    let error = |name: &str, value: &Value| {
        let mut space = [0; 255];
        let error = field(name).and_then(|field| encode(&field, value, &mut space).err());
        assert_eq!(space, [0; 255], "nothing is written");
        error.map(|error| error.to_string()).unwrap_or_default()
    };
    assert_eq!(error("u8", &Value::U64(256)), "field u8: 256 does not fit uint8_t");
    assert_eq!(error("u64", &Value::I64(-1)), "field u64: -1 does not fit uint64_t");
    assert_eq!(error("s8", &Value::I64(-129)), "field s8: -129 does not fit int8_t");
    assert_eq!(
        error("s64", &Value::U64(1 << 63)),
        "field s64: 9223372036854775808 does not fit int64_t"
    );
    assert_eq!(error("u16", &Value::F64(1.0)), "field u16 takes an integer");
    assert_eq!(error("f", &Value::Text(b"1".into())), "field f takes a number");
    assert_eq!(error("s", &Value::U64(1)), "field s takes text");
    assert_eq!(error("u8_array", &Value::U64(1)), "field u8_array takes an array of integers");
    assert_eq!(
        error("f", &Value::F64(1e39)).len(),
        "field f: 1".len() + 39 + " does not fit float".len()
    );
    let short = Value::F32Array(vec![1.0]);
    assert_eq!(error("f_array", &short), "field f_array has 3 elements, 1 given");
    let mut space = [0; 255];
    let count = encode_all(&message, &[], &mut space).map_err(|error| error.to_string());
    assert_eq!(count, Err("message TEST_TYPES has 22 fields, 0 values given".into()));
}

#[test]
fn text_and_arrays_that_are_too_long_are_cut() {
    let message = test_types();
    let mut values = values_of(&[]);
    values[1] = Value::Text(b"0123456789ABC".into());
    values[12] = Value::U64Array(vec![1, 2, 3, 4]);
    values[10] = Value::I64(-3);
    values[11] = Value::F32(0.5);
    let mut space = [0; 255];
    let payload = encode_all(&message, &values, &mut space).map(<[u8]>::to_vec);
    let back = payload.as_deref().map(values_of).unwrap_or_default();
    assert_eq!(back[1], Value::Text(b"0123456789".into()));
    assert_eq!(back[12], Value::U64Array(vec![1, 2, 3]));
    assert_eq!((&back[10], &back[11]), (&Value::F32(-3.0), &Value::F64(0.5)));
}

#[test]
fn reading_beyond_any_payload_gives_zeros() {
    assert_eq!(read::<4>(&[1, 2, 3], 1), [2, 3, 0, 0]);
    assert_eq!(read::<2>(&[], 0), [0, 0]);
    assert_eq!(read::<8>(&[1], usize::MAX), [0; 8]);
}

proptest! {
    #[test]
    fn any_payload_survives_decoding_and_encoding(payload in proptest::collection::vec(any::<u8>(), 179)) {
        let mut space = [0; 255];
        let back = encode_all(&test_types(), &values_of(&payload), &mut space);
        prop_assert_eq!(back, Ok(&payload[..]));
    }
}
