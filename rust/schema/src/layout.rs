//! Where each field of a message travels, and the checksum seed that makes two ends with different definitions refuse
//! each other's frames.
//!
//! Base fields are ordered by element size, largest first, with equal sizes as written; extension fields follow as
//! written and take no part in `crc_extra`. (MAVLink guide, "Serialization": field reordering, `CRC_EXTRA` calculation.)

use serde::Serialize;

use crate::definitions::{FieldDef, MessageDef};
use crate::dialect::{Field, Message};
use crate::error::Reason;
use crate::limits::{MAX_FIELDS, MAX_PAYLOAD_LEN};

/// Whether the fields of a message fit a frame.
pub(crate) fn check_fields(message: &MessageDef) -> Result<(), Reason> {
    let payload_len: usize = message.fields.iter().map(FieldDef::wire_len).sum();
    if message.fields.is_empty() {
        Err(Reason::NoFields)
    } else if message.fields.len() > MAX_FIELDS {
        Err(Reason::TooMany { what: "fields", limit: MAX_FIELDS })
    } else if payload_len > MAX_PAYLOAD_LEN {
        Err(Reason::PayloadTooLong(payload_len))
    } else {
        Ok(())
    }
}

/// Lays out a message. `version` is what its file says; `is_bitmask` tells by name which enums are bit masks.
pub(crate) fn lay_out(
    definition: MessageDef,
    version: u8,
    is_bitmask: &dyn Fn(&str) -> bool,
) -> Result<Message, Reason> {
    check_fields(&definition)?;
    let Layout { order, offsets, crc_extra } = Layout::of(&definition);
    let instance_field = instance_field(&definition.fields, &order);
    let described = definition.fields.into_iter().map(|field| describe(field, version, is_bitmask));
    let fields: Vec<Field> = described
        .zip(&offsets)
        .map(|(field, &offset)| Field { offset: offset as u8, ..field })
        .collect();
    let base_fields = fields.iter().filter(|field| !field.is_extension);
    Ok(Message {
        id: definition.id,
        name: definition.name.to_ascii_uppercase(),
        crc_extra,
        min_len: base_fields.map(Field::wire_len).sum::<usize>() as u8,
        max_len: fields.iter().map(Field::wire_len).sum::<usize>() as u8,
        instance_field,
        // MANUAL_CONTROL calls the system it is meant for `target`.
        target_system_offset: byte_offset(&fields, "target_system")
            .or_else(|| byte_offset(&fields, "target")),
        target_component_offset: byte_offset(&fields, "target_component"),
        wire_order: order.iter().map(|&index| index as u8).collect(),
        fields,
        description: definition.description,
    })
}

/// Where the fields of a message travel, whether or not a frame can carry them.
#[derive(Debug, Clone, Serialize)]
pub struct Layout {
    /// Indices of the fields in wire order.
    pub order: Vec<usize>,
    /// Payload offset of each field, in XML order.
    pub offsets: Vec<usize>,
    /// Checksum seed.
    pub crc_extra: u8,
}

impl Layout {
    /// The layout of a message.
    pub fn of(message: &MessageDef) -> Self {
        let order = wire_order(&message.fields);
        let base = order.iter().map(|&index| &message.fields[index]).filter(|f| !f.is_extension);
        let words = base.map(|field| (field.field_type.name(), &*field.name, field.array_length));
        let crc_extra = message.crc_extra.unwrap_or_else(|| crc_extra(&message.name, words));
        let mut offsets = vec![0; order.len()];
        let mut end = 0;
        for &index in &order {
            offsets[index] = end;
            end += message.fields[index].wire_len();
        }
        Self { order, offsets, crc_extra }
    }
}

/// Payload offset of the one-byte field `name`.
fn byte_offset(fields: &[Field], name: &str) -> Option<u8> {
    fields
        .iter()
        .find(|field| field.name == name && field.wire_len() == 1)
        .map(|field| field.offset)
}

/// Indices of the fields in wire order.
fn wire_order(fields: &[FieldDef]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..fields.len()).collect();
    // Stable, so that equal sizes and all extension fields stay as written.
    order.sort_by_key(|&index| match &fields[index] {
        field if field.is_extension => usize::MAX,
        field => usize::MAX - field.field_type.size(),
    });
    order
}

/// Index of the field marked as the instance; the last one in wire order where several are.
fn instance_field(fields: &[FieldDef], order: &[usize]) -> Option<u8> {
    order.iter().rev().find(|&&index| fields[index].is_instance).map(|&index| index as u8)
}

/// A field as defined, not yet placed.
fn describe(definition: FieldDef, version: u8, is_bitmask: &dyn Fn(&str) -> bool) -> Field {
    let implied = definition.enum_name.as_deref().filter(|name| is_bitmask(name));
    Field {
        display: definition.display.or_else(|| implied.map(|_| "bitmask".to_owned())),
        name: definition.name,
        field_type: definition.field_type,
        array_length: definition.array_length,
        is_extension: definition.is_extension,
        mavlink_version: definition.is_mavlink_version.then_some(version),
        units: definition.units,
        enum_name: definition.enum_name,
        invalid: definition.invalid,
        multiplier: definition.multiplier,
        description: definition.description,
        ..Field::default()
    }
}

/// The seed: CRC-16/MCRF4XX over a message's name and each base field's type, name and array length in wire order, folded
/// to one byte.
pub fn crc_extra<'a>(name: &str, fields: impl IntoIterator<Item = (&'a str, &'a str, u8)>) -> u8 {
    let mut crc = word(0xFFFF, name);
    for (field_type, name, array_length) in fields {
        crc = word(word(crc, field_type), name);
        if array_length > 0 {
            crc = accumulate(crc, array_length);
        }
    }
    (crc ^ (crc >> 8)) as u8
}

/// A word and the space after it.
fn word(crc: u16, text: &str) -> u16 {
    accumulate(text.bytes().fold(crc, accumulate), b' ')
}

/// One byte of the checksum. Seeds are short and made once, so no table is worth its memory here.
fn accumulate(crc: u16, byte: u8) -> u16 {
    let mixed = byte ^ crc as u8;
    let mixed = u16::from(mixed ^ (mixed << 4));
    (crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4)
}
