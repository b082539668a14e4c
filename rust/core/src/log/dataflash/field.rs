//! Fields of binary records: the meaning of each format character of a FMT record.

/// The type of a field, named by one character of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FieldKind {
    /// `b`
    I8,
    /// `B`
    U8,
    /// `h`
    I16,
    /// `H`
    U16,
    /// `i`
    I32,
    /// `I`
    U32,
    /// `q`
    I64,
    /// `Q`
    U64,
    /// `g`: half precision
    F16,
    /// `f`
    F32,
    /// `d`
    F64,
    /// `n`, `N`, `Z`: text of 4, 16 or 64 bytes, ended by a NUL if shorter
    Text(u8),
    /// `c`: hundredths in 16 bits
    CentiI16,
    /// `C`
    CentiU16,
    /// `e`: hundredths in 32 bits
    CentiI32,
    /// `E`
    CentiU32,
    /// `L`: 1e-7 degrees of latitude or longitude
    Degrees,
    /// `M`: number of a flight mode, its name in text logs
    Mode,
    /// `a`: 32 numbers of 16 bits
    Array,
}

/// Elements of an `a` field.
pub const ARRAY_LEN: usize = 32;

impl FieldKind {
    /// The kind of a format character.
    pub fn from_char(character: u8) -> Option<Self> {
        Some(match character {
            b'b' => Self::I8,
            b'B' => Self::U8,
            b'h' => Self::I16,
            b'H' => Self::U16,
            b'i' => Self::I32,
            b'I' => Self::U32,
            b'q' => Self::I64,
            b'Q' => Self::U64,
            b'g' => Self::F16,
            b'f' => Self::F32,
            b'd' => Self::F64,
            b'n' => Self::Text(4),
            b'N' => Self::Text(16),
            b'Z' => Self::Text(64),
            b'c' => Self::CentiI16,
            b'C' => Self::CentiU16,
            b'e' => Self::CentiI32,
            b'E' => Self::CentiU32,
            b'L' => Self::Degrees,
            b'M' => Self::Mode,
            b'a' => Self::Array,
            _ => return None,
        })
    }

    /// Bytes of the field in a record.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Mode => 1,
            Self::I16 | Self::U16 | Self::F16 | Self::CentiI16 | Self::CentiU16 => 2,
            Self::I32 | Self::U32 | Self::F32 | Self::CentiI32 | Self::CentiU32 | Self::Degrees => {
                4
            }
            Self::I64 | Self::U64 | Self::F64 => 8,
            Self::Text(len) => usize::from(len),
            Self::Array => 2 * ARRAY_LEN,
        }
    }

    /// The factor from the stored integer to the field's unit; `None` for values that are stored without one.
    pub fn scale(self) -> Option<f64> {
        match self {
            Self::CentiI16 | Self::CentiU16 | Self::CentiI32 | Self::CentiU32 => Some(0.01),
            Self::Degrees => Some(1e-7),
            _ => None,
        }
    }

    /// The value of a stored integer in the field's unit; dividing gives the float that is nearest to the decimal.
    #[inline]
    pub fn scaled(self, stored: f64) -> f64 {
        match self {
            Self::Degrees => stored / 1e7,
            _ => stored / 100.0,
        }
    }

    /// The values are numbers with a fraction.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64) || self.scale().is_some()
    }
}

/// A field's value as it is stored, without its scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// An integer that fits; `Q` beyond the signed range is [`Value::Unsigned`].
    Integer(i64),
    /// An unsigned integer of 64 bits.
    Unsigned(u64),
    /// A float.
    Float(f64),
    /// All bytes of a text.
    Text(&'a [u8]),
    /// The bytes of an array of 32 little-endian numbers.
    Array(&'a [u8]),
}

impl Value<'_> {
    /// The value as a float; `None` for texts and arrays.
    #[inline]
    pub fn as_f64(self) -> Option<f64> {
        match self {
            Self::Integer(number) => Some(number as f64),
            Self::Unsigned(number) => Some(number as f64),
            Self::Float(number) => Some(number),
            Self::Text(_) | Self::Array(_) => None,
        }
    }
}

/// Reads the field of the given kind at `offset` of a record's body. Bytes beyond the body read as zero.
#[inline]
pub fn value(kind: FieldKind, body: &[u8], offset: usize) -> Value<'_> {
    use FieldKind as K;
    match kind {
        K::I8 | K::Mode => Value::Integer(i64::from(i8::from_le_bytes(bytes(body, offset)))),
        K::U8 => Value::Integer(i64::from(u8::from_le_bytes(bytes(body, offset)))),
        K::I16 | K::CentiI16 => Value::Integer(i64::from(i16::from_le_bytes(bytes(body, offset)))),
        K::U16 | K::CentiU16 => Value::Integer(i64::from(u16::from_le_bytes(bytes(body, offset)))),
        K::I32 | K::CentiI32 | K::Degrees => {
            Value::Integer(i64::from(i32::from_le_bytes(bytes(body, offset))))
        }
        K::U32 | K::CentiU32 => Value::Integer(i64::from(u32::from_le_bytes(bytes(body, offset)))),
        K::I64 => Value::Integer(i64::from_le_bytes(bytes(body, offset))),
        K::U64 => Value::Unsigned(u64::from_le_bytes(bytes(body, offset))),
        K::F16 => Value::Float(half(u16::from_le_bytes(bytes(body, offset)))),
        K::F32 => Value::Float(f64::from(f32::from_le_bytes(bytes(body, offset)))),
        K::F64 => Value::Float(f64::from_le_bytes(bytes(body, offset))),
        K::Text(_) => Value::Text(slice(body, offset, kind.size())),
        K::Array => Value::Array(slice(body, offset, kind.size())),
    }
}

#[inline]
fn bytes<const N: usize>(body: &[u8], offset: usize) -> [u8; N] {
    body.get(offset..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N])
}

#[inline]
fn slice(body: &[u8], offset: usize, len: usize) -> &[u8] {
    body.get(offset..(offset + len).min(body.len())).unwrap_or_default()
}

/// The value of a half precision float (IEEE 754 binary16).
pub fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let fraction = f64::from(bits & 0x3FF);
    match bits >> 10 & 0x1F {
        0 => sign * fraction * 2.0_f64.powi(-24),
        0x1F if fraction == 0.0 => sign * f64::INFINITY,
        // The payload of a NaN stays, so that quiet ones can be told apart as in the wider formats.
        0x1F => f64::from_bits(
            u64::from(bits & 0x8000) << 48 | 0x7FF << 52 | 1 << 51 | u64::from(bits & 0x1FF) << 42,
        ),
        exponent => sign * (1.0 + fraction / 1024.0) * 2.0_f64.powi(i32::from(exponent) - 15),
    }
}
