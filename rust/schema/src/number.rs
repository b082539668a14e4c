//! Numbers and types as definitions write them. Values are matched against a few fixed forms and never evaluated as
//! code: `42`, `-1`, `0x2A`, `0b101`, `0o52`, `2**6` and `1<<6`.

use crate::field_type::FieldType;

/// Smallest enum value.
pub(crate) const MIN_VALUE: i128 = i64::MIN as i128;
/// Largest enum value.
pub(crate) const MAX_VALUE: i128 = u64::MAX as i128;

/// An enum entry's value; `None` where `text` has none of the known forms or the value does not fit 64 bits.
pub(crate) fn parse_value(text: &str) -> Option<i128> {
    let text = text.trim();
    let value = if let Some((base, exponent)) = text.split_once("**") {
        power(parse_integer(base)?, parse_integer(exponent)?)?
    } else if let Some((base, shift)) = text.split_once("<<") {
        parse_integer(base)?.checked_mul(power(2, parse_integer(shift)?)?)?
    } else {
        parse_integer(text)?
    };
    (MIN_VALUE..=MAX_VALUE).contains(&value).then_some(value)
}

/// `base ** exponent` where the exponent is from 0 to 64.
fn power(base: i128, exponent: i128) -> Option<i128> {
    let exponent = u32::try_from(exponent).ok().filter(|&exponent| exponent <= 64)?;
    base.checked_pow(exponent)
}

/// A signed integer in base 10, 16 (`0x`), 2 (`0b`) or 8 (`0o`).
fn parse_integer(text: &str) -> Option<i128> {
    let text = text.trim();
    let (negative, digits) = match text.as_bytes().first()? {
        b'-' => (true, &text[1..]),
        b'+' => (false, &text[1..]),
        _ => (false, text),
    };
    let (radix, digits) = match digits.get(..2) {
        Some("0x" | "0X") => (16, &digits[2..]),
        Some("0b" | "0B") => (2, &digits[2..]),
        Some("0o" | "0O") => (8, &digits[2..]),
        _ => (10, digits),
    };
    // `from_str_radix` takes a sign of its own, which here would be a second one.
    if !digits.starts_with(|first: char| first.is_digit(radix)) {
        return None;
    }
    let magnitude = i128::from_str_radix(digits, radix).ok()?;
    Some(if negative { -magnitude } else { magnitude })
}

/// A decimal number without sign, up to `max`.
pub(crate) fn parse_decimal(text: &str, max: u32) -> Option<u32> {
    let text = text.trim();
    if !text.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    text.parse().ok().filter(|&number| number <= max)
}

/// An element type by its XML name.
pub(crate) fn parse_type(name: &str) -> Option<FieldType> {
    FieldType::ALL.iter().copied().find(|field_type| field_type.name() == name)
}
