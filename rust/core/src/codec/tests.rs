//! Every type, every truncation.

use super::Number::{Float, Signed, Unsigned};
use super::*;
use crate::testing::{noise, registry, test_types_payload};
use mavwire_schema::Message;

fn test_types() -> Message {
    let registry = registry();
    registry.message(registry.lookup(17000).map_or(0, |entry| entry.index)).clone()
}

/// The numbers of a field, one for a scalar.
fn numbers(field: &Field, payload: &[u8]) -> Vec<Number> {
    let offset = |n| usize::from(field.offset) + n * field.field_type.size();
    (0..field.elements()).map(|n| number(field.field_type, payload, offset(n))).collect()
}

#[test]
fn r3_r8_values_of_every_type() {
    let payload = test_types_payload();
    let message = test_types();
    let (texts, others): (Vec<&Field>, Vec<&Field>) =
        message.fields.iter().partition(|field| field.is_char());
    let texts: Vec<&[u8]> = texts.iter().map(|field| text_bytes(field, &payload)).collect();
    assert_eq!(texts, [&b"A"[..], b"0123456789"]);
    let found: Vec<Vec<Number>> = others.iter().map(|field| numbers(field, &payload)).collect();
    let scalars = [
        Unsigned(1),
        Unsigned(2),
        Unsigned(3),
        Unsigned(4),
        Signed(5),
        Signed(6),
        Signed(7),
        Signed(8),
        Float(1.5),
        Float(2.5),
    ];
    let arrays = [
        [1, 2, 3].map(Unsigned),
        [4, 5, 6].map(Unsigned),
        [7, 8, 9].map(Unsigned),
        [10, 11, 12].map(Unsigned),
        [-1, -2, -3].map(Signed),
        [-4, -5, -6].map(Signed),
        [-7, -8, -9].map(Signed),
        [-10, -11, -12].map(Signed),
        [1.5, 2.5, 3.5].map(Float),
        [4.5, 5.5, 6.5].map(Float),
    ];
    let expected: Vec<Vec<Number>> = scalars
        .iter()
        .map(|&scalar| vec![scalar])
        .chain(arrays.iter().map(|array| array.to_vec()))
        .collect();
    assert_eq!(found, expected);
}

/// All of a payload's values, as text since NaN differs from itself.
fn values(payload: &[u8]) -> String {
    let message = test_types();
    let value = |field: &Field| {
        if field.is_char() {
            format!("{:?}", text_bytes(field, payload))
        } else {
            format!("{:?}", numbers(field, payload))
        }
    };
    message.fields.iter().map(value).collect()
}

#[test]
fn r10_r14_truncation_at_every_length_reads_as_zeros() {
    let whole = noise(179, 5);
    for len in 0..=179 {
        let mut zeroed = whole.clone();
        zeroed[len..].fill(0);
        assert_eq!(values(&whole[..len]), values(&zeroed), "{len}");
    }
}

#[test]
fn r12_surplus_bytes_are_ignored() {
    let mut payload = vec![1; 179];
    let expected = values(&payload);
    payload.extend([9; 76]);
    assert_eq!(values(&payload), expected);
}

#[test]
fn integers_at_the_ends_of_their_ranges() {
    assert_eq!(number(FieldType::U64, &[0xFF; 8], 0), Unsigned(u64::MAX));
    assert_eq!(number(FieldType::I64, &[0, 0, 0, 0, 0, 0, 0, 0x80], 0), Signed(i64::MIN));
    assert_eq!(number(FieldType::I8, &[0x80], 0), Signed(-128));
    assert_eq!(number(FieldType::Char, &[0x80], 0), Unsigned(128));
}

#[test]
fn text_keeps_nuls_inside() {
    let message = test_types();
    let field = &message.fields[1];
    let mut payload = vec![0; usize::from(field.offset)];
    payload.extend(b"a\0\xFF\0\0");
    assert_eq!(text_bytes(field, &payload), b"a\0\xFF");
    assert_eq!(field_bytes(field, &payload), b"a\0\xFF\0\0");
    assert_eq!(text_bytes(field, &payload[..3]), b"");
}

#[test]
fn reading_beyond_any_payload_gives_zeros() {
    assert_eq!(read::<4>(&[1, 2, 3], 1), [2, 3, 0, 0]);
    assert_eq!(read::<2>(&[], 0), [0, 0]);
    assert_eq!(read::<8>(&[1], usize::MAX), [0; 8]);
}
