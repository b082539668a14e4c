//! The types of fields. A row of the table makes a type; matches over it have no `_` arm, so that the compiler names
//! every place that a new type concerns.

use serde::{Deserialize, Serialize};

macro_rules! field_types {
    ($($variant:ident $(#[$mark:ident])? = $number:literal, $name:literal, $size:literal, $code:literal, $is_float:literal;)*) => {
        /// Element type of a field. The discriminants are the `MAVLINK_TYPE_*` numbers.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[repr(u8)]
        pub enum FieldType {
            $(
                #[doc = concat!("`", $name, "`")]
                #[serde(rename = $name)]
                $(#[$mark])?
                $variant = $number,
            )*
        }

        impl FieldType {
            /// Every type, in the order of the `MAVLINK_TYPE_*` numbers.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// Bytes of one element.
            pub const fn size(self) -> usize {
                match self { $(Self::$variant => $size,)* }
            }

            /// The name in XML and in `crc_extra`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Letter of Python's `struct` module.
            pub const fn struct_code(self) -> char {
                match self { $(Self::$variant => $code,)* }
            }

            /// Whether the values are floating point numbers.
            pub const fn is_float(self) -> bool {
                match self { $(Self::$variant => $is_float,)* }
            }
        }
    };
}

field_types! {
    // Type, number, name, bytes, struct code, float.
    Char = 0, "char", 1, 'c', false;
    U8 #[default] = 1, "uint8_t", 1, 'B', false;
    I8 = 2, "int8_t", 1, 'b', false;
    U16 = 3, "uint16_t", 2, 'H', false;
    I16 = 4, "int16_t", 2, 'h', false;
    U32 = 5, "uint32_t", 4, 'I', false;
    I32 = 6, "int32_t", 4, 'i', false;
    U64 = 7, "uint64_t", 8, 'Q', false;
    I64 = 8, "int64_t", 8, 'q', false;
    F32 = 9, "float", 4, 'f', true;
    F64 = 10, "double", 8, 'd', true;
}
