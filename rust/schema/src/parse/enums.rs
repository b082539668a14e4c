//! `<enums>`: enums, their entries, and the parameters of commands.

use roxmltree::Node;

use super::element::{Source, optional};
use super::reserved;
use crate::definitions::{CommandParam, EnumDef, EnumEntryDef};
use crate::error::{Reason, SchemaError, excerpt};
use crate::number::{MAX_VALUE, MIN_VALUE, parse_decimal, parse_value};

/// Parameters of a command.
const MAX_PARAMS: u32 = 7;

pub(super) fn read_enums(
    source: &Source<'_>,
    enums: Node<'_, '_>,
    into: &mut Vec<EnumDef>,
) -> Result<(), SchemaError> {
    for child in enums.children().filter(Node::is_element) {
        if child.tag_name().name() != "enum" {
            return Err(source.unexpected(child, "enums"));
        }
        into.push(read_enum(source, child)?);
    }
    Ok(())
}

fn read_enum(source: &Source<'_>, node: Node<'_, '_>) -> Result<EnumDef, SchemaError> {
    let name = source.identifier(node)?;
    let within = |error: SchemaError| error.within(format!("enum {name}"));
    let mut definition = EnumDef {
        line: source.line(node),
        bitmask: source.boolean(node, "bitmask").map_err(within)?,
        ..EnumDef::default()
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "description" => definition.description += &source.description(child),
            "entry" => definition.entries.push(read_entry(source, child).map_err(within)?),
            _ if source.status(child, &mut definition.status) => {}
            _ => return Err(within(source.unexpected(child, "enum"))),
        }
    }
    definition.name = name;
    Ok(definition)
}

fn read_entry(source: &Source<'_>, node: Node<'_, '_>) -> Result<EnumEntryDef, SchemaError> {
    let name = source.variable(node, reserved::check_entry)?;
    let within = |error: SchemaError| error.within(format!("entry {name}"));
    let mut entry = EnumEntryDef {
        line: source.line(node),
        value: read_value(source, node).map_err(within)?,
        has_location: source.boolean(node, "hasLocation").map_err(within)?,
        is_destination: source.boolean(node, "isDestination").map_err(within)?,
        ..EnumEntryDef::default()
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "description" => entry.description += &source.description(child),
            "param" => entry.params.push(read_param(source, child).map_err(within)?),
            _ if source.status(child, &mut entry.status) => {}
            _ => return Err(within(source.unexpected(child, "entry"))),
        }
    }
    entry.name = name;
    Ok(entry)
}

fn read_value(source: &Source<'_>, node: Node<'_, '_>) -> Result<Option<i128>, SchemaError> {
    let Some(text) = node.attribute("value") else { return Ok(None) };
    let value = parse_value(text).ok_or_else(|| {
        let text = excerpt(text);
        let reason = Reason::InvalidNumber { what: "value", text, min: MIN_VALUE, max: MAX_VALUE };
        source.error(node, reason)
    })?;
    Ok(Some(value))
}

fn read_param(source: &Source<'_>, node: Node<'_, '_>) -> Result<CommandParam, SchemaError> {
    let text = source.required(node, "index")?;
    let index = parse_decimal(text, MAX_PARAMS).filter(|&index| index > 0).ok_or_else(|| {
        let (text, max) = (excerpt(text), MAX_PARAMS.into());
        source.error(node, Reason::InvalidNumber { what: "param index", text, min: 1, max })
    })?;
    Ok(CommandParam {
        index: index as u8,
        label: optional(node, "label"),
        units: optional(node, "units"),
        enum_name: optional(node, "enum"),
        multiplier: optional(node, "multiplier"),
        min_value: optional(node, "minValue"),
        max_value: optional(node, "maxValue"),
        increment: optional(node, "increment"),
        default: optional(node, "default"),
        reserved: source.boolean(node, "reserved")?,
        description: source.description(node),
    })
}
