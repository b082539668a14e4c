//! XML definitions: refused with a place, or laid out so that every message fits a frame.

use std::collections::HashSet;

use mavwire_core::registry::Registry;
use mavwire_schema::{
    Definitions, Layout, ParseOptions, Reason, Rules, SchemaError, Union, WireVersion,
    check_schema, decode_blob, encode_blob, parse_definitions, resolve, standalone,
};

/// Any text as a definition file.
pub fn xml(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    generator(text);
    let definitions = match parse_definitions("my.xml", text, &ParseOptions::default()) {
        Ok(definitions) => definitions,
        Err(error) => return check(&error),
    };
    let again = decode_blob(&encode_blob(std::slice::from_ref(&definitions)));
    assert_eq!(again.expect("what was encoded"), std::slice::from_ref(&definitions));
    united(&definitions);
    for version in [WireVersion::V1, WireVersion::V2] {
        let mut lookup = |path: &str| match path {
            "my.xml" => Ok(definitions.clone()),
            "minimal.xml" => mavwire_core::builtin::definitions(path),
            _ => Err(SchemaError::new(path, Reason::NotFound)),
        };
        let dialect = match resolve("my.xml", &mut lookup, version) {
            Ok(dialect) => dialect,
            Err(error) => {
                check(&error);
                continue;
            }
        };
        for message in &dialect.messages {
            assert!(message.id < 1 << 24 && message.min_len <= message.max_len);
            for field in &message.fields {
                assert!(usize::from(field.offset) + field.wire_len() <= message.max_len.into());
            }
        }
        let count = dialect.messages.len();
        let registry = Registry::new(dialect);
        let found = registry.dialect().messages.iter().filter(|m| registry.lookup(m.id).is_some());
        assert_eq!(found.count(), count);
    }
}

/// A file beside itself and the built-in definitions: ids stay unique, and the union is a dialect or refused.
fn united(definitions: &Definitions) {
    let mut union = Union::default();
    union.add(vec![definitions.clone(), definitions.clone()]);
    union.add(vec![mavwire_core::builtin::definitions("minimal").expect("it is built in")]);
    let (own, others) = union.finish("union");
    let ids: HashSet<_> = own.messages.iter().map(|message| message.id).collect();
    assert_eq!(ids.len(), own.messages.len());
    let dialect = resolve("union", &mut |_| Ok(own.clone()), WireVersion::V2);
    match dialect.and_then(|mut dialect| dialect.add_others(others).map(|()| dialect)) {
        Ok(dialect) => drop(Registry::new(dialect)),
        Err(error) => check(&error),
    }
}

/// Gives any text to the functions that the generator of modules uses.
fn generator(text: &str) {
    let parse = |text: &str, rules| {
        parse_definitions("my.xml", text, &ParseOptions { rules, ..ParseOptions::default() })
    };
    let Ok(tolerated) = parse(text, Rules::Mavparse) else { return };
    for message in &tolerated.messages {
        let layout = Layout::of(message);
        assert_eq!(
            (layout.order.len(), layout.offsets.len()),
            (message.fields.len(), message.fields.len())
        );
    }
    check_schema("my.xml", text, true).expect("well-formed");
    let standalone = standalone("my.xml", text, &[]).expect("well-formed");
    assert_eq!(parse(&standalone, Rules::Module).is_ok(), parse(text, Rules::Module).is_ok());
}

fn check(error: &SchemaError) {
    assert!(!error.file().is_empty() && error.to_string().starts_with(error.file()));
}
