//! Messages as Protocol Buffers: a descriptor of the fields, and the bytes of a row.
//!
//! The format: <https://protobuf.dev/programming-guides/encoding/>. Fields are numbered from 1 in their order. A field that
//! has no value is left out, which proto2 tells from 0.

use std::collections::HashSet;

use arrow::array::{Array, ArrayRef, AsArray, StructArray};
use arrow::compute::cast;
use arrow::datatypes::{
    DataType, Field, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, Schema,
    UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use prost::Message as _;
use prost::encoding::{WireType, encode_key, encode_varint};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::source_code_info::Location;
use prost_types::{
    DescriptorProto, FieldDescriptorProto, FieldOptions, FileDescriptorProto, FileDescriptorSet,
    SourceCodeInfo,
};

use super::Put;
use super::channels::{Texts, is_body, said_of};
use crate::error::Error;

/// Places in descriptors, which comments name: the messages of a file, and the fields of a message.
const MESSAGES: i32 = 4;
const FIELDS: i32 = 2;

/// A name that Protocol Buffers take: dataflash logs may have others.
pub(super) fn identifier(name: &str) -> String {
    let mut name = name.replace(|one: char| !one.is_ascii_alphanumeric() && one != '_', "_");
    if !name.starts_with(|one: char| one.is_ascii_alphabetic() || one == '_') {
        name.insert(0, '_');
    }
    name
}

/// The descriptor of a message, with its texts, units and enums as comments.
pub(super) fn descriptor(message: &str, schema: &Schema, texts: Option<&Texts>) -> Vec<u8> {
    let (mut taken, mut fields) = (HashSet::new(), Vec::new());
    let message_text = texts.map(|(text, _)| text.clone()).unwrap_or_default();
    let mut comments = vec![(vec![MESSAGES, 0], message_text)];
    for (at, field) in (0..).zip(schema.fields().iter().filter(|field| is_body(field.name()))) {
        let mut name = identifier(field.name());
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        comments.push((vec![MESSAGES, 0, FIELDS, at], said_of(field, texts)));
        fields.push(field_descriptor(name, at + 1, field));
    }
    let location = |(path, text): (Vec<i32>, String)| Location {
        path,
        span: vec![0, 0, 0],
        leading_comments: Some(text),
        ..Location::default()
    };
    let location =
        comments.into_iter().filter(|(_, text)| !text.is_empty()).map(location).collect();
    let file = FileDescriptorProto {
        name: Some(format!("{message}.proto")),
        message_type: vec![DescriptorProto {
            name: Some(message.to_owned()),
            field: fields,
            ..DescriptorProto::default()
        }],
        source_code_info: Some(SourceCodeInfo { location }),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

fn field_descriptor(name: String, number: i32, field: &Field) -> FieldDescriptorProto {
    let (data_type, is_list) = element(field);
    let options = FieldOptions { packed: Some(true), ..FieldOptions::default() };
    let is_packed = is_list && !matches!(type_of(&data_type), Type::String | Type::Bytes);
    FieldDescriptorProto {
        json_name: Some(name.clone()), // otherwise made of the name, and that of `a_b` is also that of `aB`
        name: Some(name),
        number: Some(number),
        label: Some(if is_list { Label::Repeated } else { Label::Optional }.into()),
        r#type: Some(type_of(&data_type).into()),
        options: is_packed.then_some(options),
        ..FieldDescriptorProto::default()
    }
}

/// The type of a field or of its elements, and whether these are many. Elements of an array have no way to be left out:
/// numbers that may be invalid are of a type that has NaN.
fn element(field: &Field) -> (DataType, bool) {
    match field.data_type() {
        DataType::FixedSizeList(item, _) if item.is_nullable() && item.data_type().is_integer() => {
            (DataType::Float64, true)
        }
        DataType::FixedSizeList(item, _) => (item.data_type().clone(), true),
        scalar => (scalar.clone(), false),
    }
}

fn type_of(data_type: &DataType) -> Type {
    match data_type {
        DataType::Int8 | DataType::Int16 => Type::Sint32,
        DataType::Int32 => Type::Sfixed32,
        DataType::Int64 => Type::Sfixed64,
        DataType::UInt8 | DataType::UInt16 => Type::Uint32,
        DataType::UInt32 => Type::Fixed32,
        DataType::UInt64 => Type::Fixed64,
        DataType::Float32 => Type::Float,
        DataType::Float64 => Type::Double,
        DataType::Binary => Type::Bytes,
        _ => Type::String,
    }
}

fn wire_type(data_type: &DataType) -> WireType {
    match type_of(data_type) {
        Type::Sint32 | Type::Uint32 => WireType::Varint,
        Type::Sfixed32 | Type::Fixed32 | Type::Float => WireType::ThirtyTwoBit,
        Type::Sfixed64 | Type::Fixed64 | Type::Double => WireType::SixtyFourBit,
        _ => WireType::LengthDelimited,
    }
}

/// Appends rows of the fields of a message.
///
/// # Errors
/// Errors of Arrow, for a type that tables do not have.
pub(super) fn encoder(body: &StructArray) -> Result<Put<'static>, Error> {
    let fields = (1..).zip(body.fields().iter().zip(body.columns()));
    let put = fields.map(|(number, (field, array))| put_field(number, field, array));
    let mut put = put.collect::<Result<Vec<_>, _>>()?;
    Ok(Box::new(move |row, out| put.iter_mut().for_each(|put| put(row, out))))
}

fn put_field(number: u32, field: &Field, array: &ArrayRef) -> Result<Put<'static>, Error> {
    let (data_type, is_list) = element(field);
    let mut key = Vec::new();
    if !is_list {
        encode_key(number, wire_type(&data_type), &mut key);
        let (array, mut put) = (array.clone(), put_value(array)?);
        return Ok(Box::new(move |row, out| {
            if array.is_valid(row) {
                out.extend_from_slice(&key);
                put(row, out);
            }
        }));
    }
    encode_key(number, WireType::LengthDelimited, &mut key);
    let list = array.as_fixed_size_list().clone();
    let length = list.value_length().unsigned_abs() as usize;
    let mut put = put_value(&cast(list.values(), &data_type)?)?;
    let mut bytes = Vec::new();
    Ok(Box::new(move |row, out| {
        if list.is_valid(row) {
            out.extend_from_slice(&key);
            bytes.clear();
            (row * length..(row + 1) * length).for_each(|at| put(at, &mut bytes));
            put_bytes(&bytes, out);
        }
    }))
}

/// Appends a value without its key.
fn put_value(array: &ArrayRef) -> Result<Put<'static>, Error> {
    macro_rules! number {
        ($array:ty, |$value:ident, $out:ident| $put:expr) => {{
            let array = array.as_primitive::<$array>().clone();
            Box::new(move |row, $out: &mut Vec<u8>| {
                let $value = array.value(row);
                $put;
            })
        }};
    }
    macro_rules! fixed {
        ($array:ty) => {
            number!($array, |value, out| out.extend_from_slice(&value.to_le_bytes()))
        };
    }
    macro_rules! float {
        ($array:ty, $nan:expr) => {{
            let array = array.as_primitive::<$array>().clone();
            Box::new(move |row, out: &mut Vec<u8>| {
                let value = if array.is_valid(row) { array.value(row) } else { $nan };
                out.extend_from_slice(&value.to_le_bytes());
            })
        }};
    }
    Ok(match array.data_type() {
        DataType::Int8 => number!(Int8Type, |value, out| encode_varint(zigzag(value), out)),
        DataType::Int16 => number!(Int16Type, |value, out| encode_varint(zigzag(value), out)),
        DataType::UInt8 => number!(UInt8Type, |value, out| encode_varint(value.into(), out)),
        DataType::UInt16 => number!(UInt16Type, |value, out| encode_varint(value.into(), out)),
        DataType::Int32 => fixed!(Int32Type),
        DataType::Int64 => fixed!(Int64Type),
        DataType::UInt32 => fixed!(UInt32Type),
        DataType::UInt64 => fixed!(UInt64Type),
        DataType::Float32 => float!(Float32Type, f32::NAN),
        DataType::Float64 => float!(Float64Type, f64::NAN),
        DataType::Binary => {
            let array = array.as_binary::<i32>().clone();
            Box::new(move |row, out| put_bytes(array.value(row), out))
        }
        _ => {
            let array = cast(array, &DataType::Utf8)?.as_string::<i32>().clone();
            Box::new(move |row, out| put_bytes(array.value(row).as_bytes(), out))
        }
    })
}

/// Small numbers of either sign as small numbers without one.
fn zigzag(value: impl Into<i64>) -> u64 {
    let value = value.into();
    ((value << 1) ^ (value >> 63)).cast_unsigned()
}

fn put_bytes(bytes: &[u8], out: &mut Vec<u8>) {
    encode_varint(bytes.len() as u64, out);
    out.extend_from_slice(bytes);
}
