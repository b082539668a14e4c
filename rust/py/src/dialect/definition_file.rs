//! A definition file for the generator, which works on one file at a time and before anything is known to be right.

use std::collections::BTreeMap;

use mavwire_core::builtin;
use mavwire_schema::{
    Definitions, Layout, ParseOptions, Reason, Rules, SchemaError, Union, check_schema,
    parse_definitions, standalone,
};
use pyo3::prelude::*;

use crate::python::error::{DefinitionError, Error, Result};

/// The text of a file, and the name for errors. Errors of syntax have the `lineno` and `offset` of an `ExpatError`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct DefinitionFile {
    name: String,
    text: String,
}

#[pymethods]
impl DefinitionFile {
    #[new]
    fn new(name: String, text: String) -> Self {
        Self { name, text }
    }

    /// `Definitions` by the rules of `mavparse` and the `Layout` of each message, as JSON.
    fn parse(&self, py: Python<'_>) -> PyResult<String> {
        let options = ParseOptions { rules: Rules::Mavparse, ..ParseOptions::default() };
        let definitions = parse_definitions(&self.name, &self.text, &options);
        to_json(&definitions.map_err(|error| with_position(py, &error))?)
    }

    /// The file's errors by the MAVLink XML schema.
    fn schema_problems(&self, py: Python<'_>, strict_units: bool) -> PyResult<Vec<String>> {
        let problems = check_schema(&self.name, &self.text, strict_units);
        let problems = problems.map_err(|error| with_position(py, &error))?;
        Ok(problems.iter().map(ToString::to_string).collect())
    }

    /// The first reason why no module can be made of the file.
    fn module_problem(&self) -> Option<String> {
        let options = ParseOptions { rules: Rules::Module, ..ParseOptions::default() };
        let definitions = parse_definitions(&self.name, &self.text, &options);
        definitions.err().map(|error| error.to_string())
    }

    /// The text for a generated module to carry, with its includes by these names.
    fn standalone(&self, py: Python<'_>, includes: Vec<String>) -> PyResult<String> {
        let text = standalone(&self.name, &self.text, &includes);
        text.map_err(|error| with_position(py, &error))
    }
}

/// A definition file that comes with mavwire, as `DefinitionFile.parse` gives it.
#[pyfunction]
pub(crate) fn builtin_definitions(name: &str) -> PyResult<String> {
    to_json(&builtin::definitions(name).map_err(Error::from)?)
}

/// Texts by file base names.
pub(crate) type FileSet = BTreeMap<String, String>;

/// The definitions of sets of files.
pub(crate) fn parse_sets(sets: &[FileSet]) -> Result<Vec<Vec<Definitions>>, SchemaError> {
    let parse = |(name, text): (&String, &String)| {
        parse_definitions(&format!("{name}.xml"), text, &ParseOptions::default())
    };
    sets.iter().map(|set| set.iter().map(parse).collect()).collect()
}

/// The union of sets of files, with the dialect `upstream` behind them if wanted, as `DefinitionFile.parse` gives it. The
/// `line` of an enum, an entry or a message is its number: within a file enums with their entries come first.
#[pyfunction]
pub(crate) fn definition_union(sets: Vec<FileSet>, with_upstream: bool) -> PyResult<String> {
    let mut sets = parse_sets(&sets).map_err(Error::from)?;
    let mut numbers = 0..;
    let mut number = |line: &mut u32| *line = numbers.next().unwrap_or_default();
    for file in sets.iter_mut().flatten() {
        for definition in &mut file.enums {
            number(&mut definition.line);
            definition.entries.iter_mut().for_each(|entry| number(&mut entry.line));
        }
        file.messages.iter_mut().for_each(|message| number(&mut message.line));
    }
    if with_upstream {
        sets.push(vec![builtin::definitions(builtin::UPSTREAM).map_err(Error::from)?]);
    }
    let mut union = Union::default();
    for set in sets {
        union.add(set);
    }
    to_json(&union.finish(builtin::UPSTREAM).0)
}

/// The text of `message_definitions/sources.toml`: where the definitions come from that come with mavwire.
#[pyfunction]
pub(crate) fn definition_sources() -> &'static str {
    builtin::SOURCES
}

fn to_json(definitions: &Definitions) -> PyResult<String> {
    let layouts: Vec<_> = definitions.messages.iter().map(Layout::of).collect();
    let json = serde_json::to_string(&(definitions, layouts));
    json.map_err(|error| DefinitionError::new_err(error.to_string()))
}

fn with_position(py: Python<'_>, error: &SchemaError) -> PyErr {
    let raised = PyErr::from(Error::from(error.clone()));
    if matches!(error.reason(), Reason::Xml(_) | Reason::Empty | Reason::DocumentType) {
        let value = raised.value(py);
        let set = value.setattr("lineno", error.line());
        if let Err(failure) = set.and(value.setattr("offset", error.column().saturating_sub(1))) {
            return failure;
        }
    }
    raised
}

/// `(type, elements, bytes of one, struct code)` of a field's type as definitions write it; 0 elements for a scalar.
#[pyfunction]
pub(crate) fn field_type(text: &str) -> Result<(&'static str, u8, usize, char)> {
    let (kind, length) = mavwire_schema::field_type(text)?;
    Ok((kind.name(), length, kind.size(), kind.struct_code()))
}

/// The checksum seed of a message with these base fields in wire order: type, name and array length.
#[pyfunction]
pub(crate) fn crc_extra(name: &str, fields: Vec<(String, String, u8)>) -> u8 {
    let fields = fields.iter().map(|(kind, name, length)| (&**kind, &**name, *length));
    mavwire_schema::crc_extra(name, fields)
}

/// The values of entries that have none in the definitions, after an included file adds to their enum. Ranges are the
/// lowest and the highest value of each file.
#[pyfunction]
pub(crate) fn number_behind(
    automatic: Vec<i128>,
    own: (i128, i128),
    included: (i128, i128),
) -> Vec<i128> {
    mavwire_schema::number_behind(&automatic, own, included)
}
