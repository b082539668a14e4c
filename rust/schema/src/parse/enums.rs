//! `<enums>`: enums, their entries, and the parameters of commands.

use roxmltree::Node;

use super::element::{Source, boolean, optional};
use super::reserved;
use crate::definitions::{CommandParam, Enum, EnumEntry};
use crate::error::{Reason, SchemaError, excerpt};
use crate::number::{MAX_VALUE, parse_decimal, parse_value};

/// Parameters of a command.
const MAX_PARAMS: u32 = 7;

pub(super) fn read_enums(
    source: &Source<'_>,
    enums: Node<'_, '_>,
    into: &mut Vec<Enum>,
) -> Result<(), SchemaError> {
    for child in enums.children().filter(Node::is_element) {
        if child.tag_name().name() != "enum" {
            source.unexpected(child, "enums")?;
            continue;
        }
        into.push(read_enum(source, child)?);
    }
    Ok(())
}

fn read_enum(source: &Source<'_>, node: Node<'_, '_>) -> Result<Enum, SchemaError> {
    let name = source.identifier(node)?;
    let within = |error: SchemaError| error.within(format!("enum {name}"));
    let mut definition = Enum {
        line: source.line(node),
        bitmask: source.tolerate(node, boolean(node, "bitmask"), false).map_err(within)?,
        ..Enum::default()
    };
    let mut highest = 0;
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "description" => definition.description += &source.description(child),
            "entry" => {
                let entry = read_entry(source, child, highest).map_err(within)?;
                highest = highest.max(entry.value);
                definition.entries.push(entry);
            }
            _ if source.status(child, &mut definition.status) => {}
            _ => source.unexpected(child, "enum").map_err(within)?,
        }
    }
    definition.name = name;
    Ok(definition)
}

/// `highest` is that of the values before.
fn read_entry(
    source: &Source<'_>,
    node: Node<'_, '_>,
    highest: i128,
) -> Result<EnumEntry, SchemaError> {
    let name = source.variable(node, reserved::check_entry)?;
    let within = |error: SchemaError| error.within(format!("entry {name}"));
    let mut entry = EnumEntry {
        line: source.line(node),
        value: read_value(source, node, highest).map_err(within)?,
        is_automatic: node.attribute("value").is_none(),
        has_location: boolean(node, "hasLocation")
            .map_err(|reason| within(source.error(node, reason)))?,
        is_destination: source
            .tolerate(node, boolean(node, "isDestination"), false)
            .map_err(within)?,
        ..EnumEntry::default()
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "description" => entry.description += &source.description(child),
            "param" => entry.params.push(read_param(source, child).map_err(within)?),
            _ if source.status(child, &mut entry.status) => {}
            _ => source.unexpected(child, "entry").map_err(within)?,
        }
    }
    entry.name = name;
    Ok(entry)
}

fn read_value(source: &Source<'_>, node: Node<'_, '_>, highest: i128) -> Result<i128, SchemaError> {
    let Some(text) = node.attribute("value") else {
        let is_left = highest < MAX_VALUE;
        let next = if is_left { Ok(highest + 1) } else { Err(Reason::NoValueLeft(highest)) };
        return source.tolerate(node, next, highest);
    };
    let error = || source.error(node, Reason::InvalidValue(excerpt(text)));
    parse_value(text).ok_or_else(error)
}

fn read_param(source: &Source<'_>, node: Node<'_, '_>) -> Result<CommandParam, SchemaError> {
    let text = source.required(node, "index")?;
    let reason = || {
        let (text, max) = (excerpt(text), MAX_PARAMS.into());
        Reason::InvalidNumber { what: "param index", text, min: 1, max }
    };
    let index = parse_decimal(text, u8::MAX.into()).ok_or_else(|| source.error(node, reason()))?;
    let known = (1..=MAX_PARAMS).contains(&index).then_some(index).ok_or_else(reason);
    let index = source.tolerate(node, known, index)?;
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
        reserved: source.tolerate(node, boolean(node, "reserved"), true)?,
        description: source.description(node),
    })
}
