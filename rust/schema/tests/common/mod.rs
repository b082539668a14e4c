//! Small XML files for the tests, kept in memory.

#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use std::collections::HashMap;

use mavwire_schema::{
    Definitions, Dialect, Message, ParseOptions, Reason, SchemaError, WireVersion,
    parse_definitions, resolve,
};

/// Wraps `content` in the root element, which opens on line 1.
pub fn mavlink(content: &str) -> String {
    format!("<mavlink>\n{content}\n</mavlink>")
}

/// A message element.
pub fn message(id: u32, name: &str, fields: &str) -> String {
    format!("<message id=\"{id}\" name=\"{name}\"><description>d</description>{fields}</message>")
}

/// A scalar or array field element.
pub fn field(field_type: &str, name: &str) -> String {
    format!("<field type=\"{field_type}\" name=\"{name}\">text</field>")
}

/// A file of messages.
pub fn messages(content: &str) -> String {
    mavlink(&format!("<messages>{content}</messages>"))
}

/// A file with one enum `E` and a message that makes it a dialect.
pub fn entries(content: &str) -> String {
    mavlink(&format!("<enums><enum name=\"E\">{content}</enum></enums>"))
}

/// Parses `text` as `my.xml`.
pub fn parse(text: &str) -> Result<Definitions, SchemaError> {
    parse_definitions("my.xml", text, &ParseOptions::default())
}

/// The error of parsing `text`, printed.
pub fn parse_error(text: &str) -> String {
    parse(text).expect_err("the text is refused").to_string()
}

/// Resolves `m.xml` of the given files.
pub fn resolve_files(
    files: &[(&str, String)],
    version: WireVersion,
) -> Result<Dialect, SchemaError> {
    let files: HashMap<&str, &String> = files.iter().map(|(name, text)| (*name, text)).collect();
    let mut lookup = |path: &str| match files.get(path) {
        Some(text) => parse_definitions(path, text, &ParseOptions::default()),
        None => Err(SchemaError::new(path, Reason::NotFound)),
    };
    resolve("m.xml", &mut lookup, version)
}

/// Resolves `m.xml` for version 2.
pub fn resolve_v2(files: &[(&str, String)]) -> Dialect {
    resolve_files(files, WireVersion::V2).expect("the files make a dialect")
}

/// The error of resolving `m.xml`, printed.
pub fn resolve_error(files: &[(&str, String)]) -> String {
    resolve_files(files, WireVersion::V2).expect_err("the files are refused").to_string()
}

/// The one message of a dialect made of `fields`.
pub fn lay_out(fields: &str) -> Message {
    resolve_v2(&[("m.xml", messages(&message(1, "Q", fields)))]).messages.remove(0)
}

/// Names of a dialect's messages.
pub fn names(dialect: &Dialect) -> Vec<&str> {
    dialect.messages.iter().map(|message| message.name.as_str()).collect()
}
