//! Prints a dialect as JSON lines, one per message and per enum, for comparison with other implementations:
//! `cargo run -p mavwire-schema --example describe -- message_definitions/v1.0 common 2.0`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command line tool")]

use std::path::Path;
use std::process::ExitCode;

use mavwire_schema::{
    Dialect, Enum, Field, Message, ParseOptions, Reason, SchemaError, WireVersion,
    parse_definitions, resolve,
};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [directory, dialect, version] = arguments.as_slice() else {
        eprintln!("usage: describe DIRECTORY DIALECT 1.0|2.0");
        return ExitCode::from(2);
    };
    let wire_version = if version == "1.0" { WireVersion::V1 } else { WireVersion::V2 };
    match load(Path::new(directory), dialect, wire_version) {
        Ok(dialect) => {
            dialect.messages.iter().for_each(|message| println!("{}", message_json(message)));
            dialect.enums.iter().for_each(|definition| println!("{}", enum_json(definition)));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn load(directory: &Path, main: &str, version: WireVersion) -> Result<Dialect, SchemaError> {
    let mut lookup = |path: &str| {
        let file = directory.join(path).with_extension("xml");
        let text = std::fs::read_to_string(&file)
            .map_err(|error| SchemaError::new(path, Reason::Unreadable(error.to_string())))?;
        parse_definitions(path, &text, &ParseOptions::default())
    };
    resolve(main, &mut lookup, version)
}

fn message_json(message: &Message) -> String {
    let instance = message.instance_field.map(|index| &message.fields[usize::from(index)]);
    let wire = |value: &dyn Fn(&Field) -> String| {
        list(message.wire_fields().map(|(_, field)| value(field)))
    };
    let fields = |value: &dyn Fn(&Field) -> Option<String>| {
        object(message.fields.iter().filter_map(|field| Some((&*field.name, value(field)?))))
    };
    let wire_index = |index: usize| {
        let place = message.wire_fields().position(|(other, _)| other == index);
        place.unwrap_or_default().to_string()
    };
    object([
        ("kind", quote("message")),
        ("id", message.id.to_string()),
        ("name", quote(&message.name)),
        ("crc_extra", message.crc_extra.to_string()),
        ("fieldnames", list(message.fields.iter().map(|field| quote(&field.name)))),
        ("fieldtypes", list(message.fields.iter().map(|field| quote(field.field_type.name())))),
        ("ordered_fieldnames", wire(&|field| quote(&field.name))),
        ("orders", list((0..message.fields.len()).map(wire_index))),
        ("offsets", wire(&|field| field.offset.to_string())),
        ("lengths", wire(&wire_length)),
        ("array_lengths", wire(&|field| field.array_length.to_string())),
        ("format", quote(&message.struct_format())),
        ("min_len", message.min_len.to_string()),
        ("max_len", message.max_len.to_string()),
        ("instance_field", optional(instance.map(|field| quote(&field.name)))),
        ("instance_offset", instance.map_or("-1".into(), |field| field.offset.to_string())),
        ("target_system_offset", optional(message.target_system_offset)),
        ("target_component_offset", optional(message.target_component_offset)),
        ("units", fields(&|field| field.units.as_deref().map(quote))),
        ("enums", fields(&|field| field.enum_name.as_deref().map(quote))),
        ("displays", fields(&|field| field.display.as_deref().map(quote))),
        ("mavlink_version", fields(&|field| field.mavlink_version.map(|v| v.to_string()))),
        ("description", quote(&message.description)),
        ("descriptions", fields(&|field| Some(quote(&field.description)))),
        ("extensions", fields(&|field| field.is_extension.then(|| "true".into()))),
    ])
}

/// Elements that pymavlink counts: text is one.
fn wire_length(field: &Field) -> String {
    (if field.is_numeric_array() { field.elements() } else { 1 }).to_string()
}

fn enum_json(definition: &Enum) -> String {
    let entries = definition.entries.iter().map(|entry| {
        let label = |param: &mavwire_schema::CommandParam| {
            param.label.as_ref().map(|label| (param.index.to_string(), quote(label)))
        };
        let description = |param: &mavwire_schema::CommandParam| {
            (param.index.to_string(), quote(&param.description))
        };
        object([
            ("value", entry.value.to_string()),
            ("name", quote(&entry.name)),
            ("has_location", entry.has_location.to_string()),
            ("description", quote(&entry.description)),
            ("params", object(entry.params.iter().map(description))),
            ("label", object(entry.params.iter().filter_map(label))),
        ])
    });
    object([
        ("kind", quote("enum")),
        ("name", quote(&definition.name)),
        ("bitmask", definition.bitmask.to_string()),
        ("entries", list(entries)),
    ])
}

fn optional(value: Option<impl ToString>) -> String {
    value.map_or("null".into(), |value| value.to_string())
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(","))
}

fn object<K: AsRef<str>>(items: impl IntoIterator<Item = (K, String)>) -> String {
    let members = items.into_iter().map(|(key, value)| format!("{}:{value}", quote(key.as_ref())));
    format!("{{{}}}", members.collect::<Vec<_>>().join(","))
}

fn quote(text: &str) -> String {
    let escaped = text.chars().map(|c| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04x}", u32::from(c)),
        c => c.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}
