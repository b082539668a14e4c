//! `<messages>`: messages and their fields.

use std::collections::HashSet;

use roxmltree::Node;

use super::element::{Source, boolean, optional};
use super::reserved;
use crate::definitions::{FieldDef, MessageDef};
use crate::error::{Reason, SchemaError, excerpt};
use crate::field_type::FieldType;
use crate::layout::check_fields;
use crate::limits::{MAX_FIELDS, MAX_MESSAGE_ID};
use crate::number::{parse_decimal, parse_type};

/// The type of a field that carries the dialect's version; a `uint8_t` on the wire.
const VERSION_TYPE: &str = "uint8_t_mavlink_version";

pub(super) fn read_messages(
    source: &Source<'_>,
    messages: Node<'_, '_>,
    into: &mut Vec<MessageDef>,
) -> Result<(), SchemaError> {
    for child in messages.children().filter(Node::is_element) {
        if child.tag_name().name() != "message" {
            source.unexpected(child, "messages")?;
            continue;
        }
        into.push(read_message(source, child)?);
    }
    Ok(())
}

fn read_message(source: &Source<'_>, node: Node<'_, '_>) -> Result<MessageDef, SchemaError> {
    let mut message = MessageDef {
        name: source.identifier(node)?,
        line: source.line(node),
        ..MessageDef::default()
    };
    let name = message.name.clone();
    let within = |error: SchemaError| error.within(format!("message {name}"));
    message.id = read_id(source, node).map_err(within)?;
    read_content(source, node, &mut message).map_err(within)?;
    source.tolerate(node, check_fields(&message), ()).map_err(within)?;
    Ok(message)
}

fn read_id(source: &Source<'_>, node: Node<'_, '_>) -> Result<u32, SchemaError> {
    let text = source.required(node, "id")?;
    parse_decimal(text, MAX_MESSAGE_ID).ok_or_else(|| {
        let (text, max) = (excerpt(text), MAX_MESSAGE_ID.into());
        source.error(node, Reason::InvalidNumber { what: "id", text, min: 0, max })
    })
}

fn read_content(
    source: &Source<'_>,
    node: Node<'_, '_>,
    message: &mut MessageDef,
) -> Result<(), SchemaError> {
    let mut names = HashSet::new();
    let mut is_extension = false;
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "description" => message.description += &source.description(child),
            "extensions" => is_extension = true,
            "field" => {
                let field = read_field(source, child, is_extension)?;
                if !names.insert(field.name.clone()) {
                    source
                        .tolerate(child, Err(Reason::DuplicateField), ())
                        .map_err(|error| error.within(format!("field {}", field.name)))?;
                }
                message.fields.push(field);
            }
            _ if source.status(child, &mut message.status) => {}
            _ => source.unexpected(child, "message")?,
        }
        if message.fields.len() > MAX_FIELDS {
            let reason = Reason::TooMany { what: "fields", limit: MAX_FIELDS };
            return Err(source.error(child, reason));
        }
    }
    Ok(())
}

fn read_field(
    source: &Source<'_>,
    node: Node<'_, '_>,
    is_extension: bool,
) -> Result<FieldDef, SchemaError> {
    let name = source.variable(node, reserved::check_field)?;
    let within = |error: SchemaError| error.within(format!("field {name}"));
    let type_text = source.required(node, "type").map_err(within)?;
    let (field_type, array_length) =
        field_type(type_text).map_err(|reason| within(source.error(node, reason)))?;
    if array_length == 0 && type_text.contains('[') {
        source.tolerate(node, Err(Reason::ArrayLength("0".into())), ()).map_err(within)?;
    }
    let is_instance = source.tolerate(node, boolean(node, "instance"), true).map_err(within)?;
    if let Some(child) = node.children().find(|child| {
        // A description element inside a field is in the schema, though nothing reads it.
        child.is_element() && child.tag_name().name() != "description"
    }) {
        source.unexpected(child, "field").map_err(within)?;
    }
    Ok(FieldDef {
        field_type,
        array_length,
        is_mavlink_version: type_text == VERSION_TYPE,
        is_extension,
        is_instance,
        units: optional(node, "units"),
        enum_name: optional(node, "enum"),
        display: optional(node, "display"),
        print_format: optional(node, "print_format"),
        invalid: optional(node, "invalid"),
        multiplier: optional(node, "multiplier"),
        min_value: optional(node, "minValue"),
        max_value: optional(node, "maxValue"),
        increment: optional(node, "increment"),
        default: optional(node, "default"),
        description: source.description(node),
        name,
    })
}

/// Element type and array length (0 for a scalar) of `uint8_t`, `char[10]` or `array[4]`, the old spelling of `int8_t[4]`.
///
/// # Errors
/// [`Reason::UnknownType`] and [`Reason::ArrayLength`].
pub fn field_type(text: &str) -> Result<(FieldType, u8), Reason> {
    if text == VERSION_TYPE {
        return Ok((FieldType::U8, 0));
    }
    let unknown = || Reason::UnknownType(excerpt(text));
    let Some((base, rest)) = text.split_once('[') else {
        return parse_type(text).map(|field_type| (field_type, 0)).ok_or_else(unknown);
    };
    let field_type =
        if base == "array" { FieldType::I8 } else { parse_type(base).ok_or_else(unknown)? };
    let digits = rest.strip_suffix(']').ok_or_else(unknown)?;
    let length = parse_decimal(digits, u8::MAX.into());
    Ok((field_type, length.ok_or_else(|| Reason::ArrayLength(excerpt(digits)))? as u8))
}
