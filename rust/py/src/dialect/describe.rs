//! Descriptions out of a user's XML.

use std::collections::{BTreeMap, HashMap};

use mavwire_schema::{WireVersion, resolve};
use pyo3::prelude::*;

use crate::dialect::registry::lookup;
use crate::python::error::Result;

/// Text of a message or an entry, and the texts of its fields by name or of its parameters by number.
type Described<Key> = (String, BTreeMap<Key, String>);

/// All descriptions of a dialect.
#[derive(IntoPyObject)]
pub(crate) struct Descriptions {
    messages: BTreeMap<String, Described<String>>,
    /// By enum and entry.
    enums: BTreeMap<String, BTreeMap<String, Described<u8>>>,
}

/// All descriptions of a dialect: `{"messages": {name: (text, {field: text})}, "enums": {enum: {entry: (text,
/// {parameter: text})}}}`. Raises `DefinitionError`.
#[pyfunction]
pub(crate) fn describe(main: &str, sources: HashMap<String, String>) -> Result<Descriptions> {
    let dialect = resolve(main, &mut |path| lookup(&sources, path), WireVersion::V2)?;
    let messages = dialect.messages.into_iter().map(|message| {
        let fields = message.fields.into_iter().map(|f| (f.name, f.description));
        (message.name, (message.description, fields.collect()))
    });
    let enums = dialect.enums.into_iter().map(|definition| {
        let entries = definition.entries.into_iter().map(|entry| {
            let params = entry.params.into_iter().map(|p| (p.index, p.description));
            (entry.name, (entry.description, params.collect()))
        });
        (definition.name, entries.collect())
    });
    Ok(Descriptions { messages: messages.collect(), enums: enums.collect() })
}
