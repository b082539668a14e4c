//! Invalid values: the attribute `invalid` of a field.
//!
//! `NaN`, `-1` or `UINT16_MAX` is the invalid value of a scalar. In arrays, `[x]` marks each element that is `x`, and `[x:]`
//! marks all elements if the first is `x`. `[x,,y]` marks elements that equal the number at their position. (MAVLink guide,
//! "MAVLink XML schema": `invalid`.)

use crate::definitions::Enum;
use crate::dialect::Field;
use crate::field_type::FieldType;
use crate::number::parse_value;

/// The invalid values of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct InvalidRule {
    field_type: FieldType,
    marks: Marks,
}

#[derive(Debug, Clone, PartialEq)]
enum Marks {
    /// Each element with this value.
    Each(Number),
    /// All elements, if the first has this value.
    First(Number),
    /// Invalid values by position. Elements without a number are always valid.
    Places(Vec<Option<Number>>),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    Integer(i128),
    Float(f64),
}

impl InvalidRule {
    /// Of a field; `None` where each of its values is one, and for an attribute that makes no sense with its type.
    pub fn of(field: &Field, enums: &[Enum]) -> Option<Self> {
        let text = field.invalid.as_deref()?.trim();
        let entries = || {
            let name = field.enum_name.as_deref()?;
            enums.iter().find(|definition| definition.name == name)
        };
        let number = |text: &str| {
            let text = text.trim();
            number(text, field.field_type).or_else(|| {
                let entry = entries()?.entries.iter().find(|entry| entry.name == text)?;
                Some(Number::Integer(entry.value))
            })
        };
        let marks = match (text.strip_prefix('['), field.is_numeric_array()) {
            (None, false) => Marks::Each(number(text)?),
            (Some(list), true) => {
                let list = list.strip_suffix(']')?;
                match list.strip_suffix(':') {
                    Some(first) => Marks::First(number(first)?),
                    None if list.contains(',') => {
                        let places = list.split(',').map(|one| match one.trim() {
                            "" => Some(None),
                            one => number(one).map(Some),
                        });
                        Marks::Places(places.collect::<Option<_>>()?)
                    }
                    None => Marks::Each(number(list)?),
                }
            }
            _ => return None,
        };
        (!field.is_char()).then_some(Self { field_type: field.field_type, marks })
    }

    /// Whether single elements can be invalid; otherwise all are or none is.
    pub fn is_by_element(&self) -> bool {
        !matches!(self.marks, Marks::First(_))
    }

    /// Whether an element is invalid. `field` begins with the bytes of the field on the wire.
    #[inline]
    #[allow(clippy::float_cmp)] // exactly the value of the definition
    pub fn is_invalid(&self, field: &[u8], element: usize) -> bool {
        use FieldType as T;
        let (number, element) = match &self.marks {
            Marks::Each(number) => (*number, element),
            Marks::First(number) => (*number, 0),
            Marks::Places(places) => match places.get(element) {
                Some(Some(number)) => (*number, element),
                _ => return false,
            },
        };
        let size = self.field_type.size();
        let Some(bytes) = field.get(element * size..(element + 1) * size) else { return false };
        let mut whole = [0; 8];
        whole[..size].copy_from_slice(bytes);
        let unsigned = u64::from_le_bytes(whole);
        let float = match self.field_type {
            T::F32 => f64::from(f32::from_bits(unsigned as u32)),
            T::F64 => f64::from_bits(unsigned),
            T::I8 | T::I16 | T::I32 | T::I64 => {
                let unused = 64 - 8 * size as u32;
                let signed = (unsigned << unused) as i64 >> unused;
                return number == Number::Integer(i128::from(signed));
            }
            T::Char | T::U8 | T::U16 | T::U32 | T::U64 => {
                return number == Number::Integer(i128::from(unsigned));
            }
        };
        matches!(number, Number::Float(none) if none == float || none.is_nan() && float.is_nan())
    }
}

/// A number of the type, in one of the forms of definitions.
fn number(text: &str, field_type: FieldType) -> Option<Number> {
    use FieldType as T;
    let limit = match text {
        "UINT8_MAX" => Some(i128::from(u8::MAX)),
        "UINT16_MAX" => Some(i128::from(u16::MAX)),
        "UINT32_MAX" => Some(i128::from(u32::MAX)),
        "UINT64_MAX" => Some(i128::from(u64::MAX)),
        "INT8_MAX" => Some(i128::from(i8::MAX)),
        "INT16_MAX" => Some(i128::from(i16::MAX)),
        "INT32_MAX" => Some(i128::from(i32::MAX)),
        "INT64_MAX" => Some(i128::from(i64::MAX)),
        "INT8_MIN" => Some(i128::from(i8::MIN)),
        "INT16_MIN" => Some(i128::from(i16::MIN)),
        "INT32_MIN" => Some(i128::from(i32::MIN)),
        "INT64_MIN" => Some(i128::from(i64::MIN)),
        "UINT8_MIN" | "UINT16_MIN" | "UINT32_MIN" | "UINT64_MIN" => Some(0),
        _ => parse_value(text),
    };
    let float = limit.map(|limit| limit as f64).or_else(|| text.parse().ok());
    match field_type {
        // As the field holds it, so that 0.1 is equal to the nearest float.
        T::F32 => float.map(|float: f64| Number::Float(f64::from(float as f32))),
        T::F64 => float.map(Number::Float),
        T::Char | T::U8 | T::I8 | T::U16 | T::I16 | T::U32 | T::I32 | T::U64 | T::I64 => {
            limit.map(Number::Integer)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definitions::EnumEntry;

    fn marked(text: &str, field_type: FieldType, array_length: u8, field: &[u8]) -> Vec<bool> {
        let entry = EnumEntry { name: "UNDEFINED".into(), value: 3, ..EnumEntry::default() };
        let enums = [Enum { name: "STATE".into(), entries: vec![entry], ..Enum::default() }];
        let field_of = Field {
            field_type,
            array_length,
            invalid: Some(text.into()),
            enum_name: Some("STATE".into()),
            ..Field::default()
        };
        let Some(invalid) = InvalidRule::of(&field_of, &enums) else { return Vec::new() };
        (0..field_of.elements()).map(|n| invalid.is_invalid(field, n)).collect()
    }

    #[test]
    fn scalars() {
        for (text, field_type, field) in [
            ("UINT16_MAX", FieldType::U16, &[255, 255][..]),
            ("0xFFFF", FieldType::U16, &[255, 255]),
            ("-1", FieldType::I8, &[255]),
            ("-1000", FieldType::I16, &(-1000_i16).to_le_bytes()),
            ("INT32_MAX", FieldType::I32, &i32::MAX.to_le_bytes()),
            ("INT64_MIN", FieldType::I64, &i64::MIN.to_le_bytes()),
            ("UINT64_MAX", FieldType::U64, &[255; 8]),
            ("UINT16_MIN", FieldType::U16, &[0, 0]),
            ("UNDEFINED", FieldType::U8, &[3]),
            ("NAN", FieldType::F32, &f32::NAN.to_le_bytes()),
            ("NaN", FieldType::F64, &(-f64::NAN).to_le_bytes()),
            ("-1.0", FieldType::F32, &(-1_f32).to_le_bytes()),
            ("0.1", FieldType::F32, &0.1_f32.to_le_bytes()),
            ("0", FieldType::F32, &(-0_f32).to_le_bytes()),
        ] {
            assert_eq!(marked(text, field_type, 0, field), [true], "{text}");
            assert_eq!(marked(text, field_type, 0, &[1; 8]), [false], "{text}");
        }
    }

    #[test]
    fn arrays() {
        let of = |text| marked(text, FieldType::U8, 4, &[9, 8, 9, 8]);
        assert_eq!(of("[9]"), [true, false, true, false]);
        assert_eq!(of("[9:]"), [true; 4]);
        assert_eq!(of("[8:]"), [false; 4]);
        assert_eq!(of("[9,]"), [true, false, false, false]);
        assert_eq!(of("[8,,9,]"), [false, false, true, false]);
        assert_eq!(of("[,8]"), [false, true, false, false]);
    }

    #[test]
    fn senseless_attributes_mark_nothing() {
        for (text, length) in [
            ("", 0),
            ("[9]", 0),
            ("9", 4),
            ("NaN", 0),
            ("-0.5", 0),
            ("[9", 4),
            ("[]", 4),
            ("[x,9]", 4),
            ("NOBODY", 0),
        ] {
            assert_eq!(marked(text, FieldType::U8, length, &[9; 4]), [], "{text}");
        }
        assert_eq!(marked("0", FieldType::Char, 0, &[0]), []);
    }
}
