//! The columns of one message type over several logs: each dataflash log describes its types itself.
//!
//! The result holds the columns of all logs and does not depend on the order of the logs. docs/columns.md states the rule.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow::datatypes::{DataType, Field, FieldRef, Schema, SchemaRef};

use crate::error::Error;

/// Largest number of columns of one frame. Logs made for it would fill the memory with nulls otherwise.
const MAX_COLUMNS: usize = 4096;
/// The key of a field's metadata that marks the column of instances.
const INSTANCE: &str = "instance";

/// The different schemas of one type in several logs, each with the path of one log.
#[derive(Debug, Default)]
pub struct CommonSchema {
    known: Vec<(SchemaRef, PathBuf)>,
}

impl CommonSchema {
    /// Adds the schema of a log. For logs with the same schema, the alphabetically first path is kept.
    pub fn add(&mut self, schema: &SchemaRef, path: PathBuf) {
        match self.known.iter_mut().find(|(one, _)| one == schema) {
            Some((_, known)) => *known = path.min(std::mem::take(known)),
            None => self.known.push((Arc::clone(schema), path)),
        }
    }

    /// The columns of all logs. Without telemetry logs, whose columns the dialect gives, each column may lack values.
    ///
    /// # Errors
    /// Columns of one name in two logs have no common type, or there are more columns than a frame may have.
    pub fn schema(mut self) -> Result<SchemaRef, Error> {
        if let [(one, _)] = &self.known[..]
            && is_telemetry(one)
        {
            return Ok(Arc::clone(one));
        }
        self.known.sort_by_cached_key(|(schema, _)| {
            let names = schema.fields().iter().map(|field| field.name().clone());
            let types = schema.fields().iter().map(|field| field.data_type().to_string());
            let names_and_types: Vec<_> = names.chain(types).collect();
            let largest_first = Reverse(schema.fields().len());
            (!is_telemetry(schema), largest_first, !has_instances(schema), names_and_types)
        });
        let message = self.known.first().and_then(|(one, _)| one.metadata().get("message"));
        let message = message.cloned().unwrap_or_default();
        let mut columns: Vec<Column<'_>> = Vec::new();
        let mut places = HashMap::new();
        for (schema, path) in &self.known {
            for field in schema.fields() {
                let place = *places.entry(field.name()).or_insert(columns.len());
                match columns.get_mut(place) {
                    Some(column) => column.join(field, path, &message)?,
                    None => columns.push(Column::new(field, path)),
                }
            }
        }
        if columns.len() > MAX_COLUMNS {
            return Err(Error::TooManyColumns {
                message,
                columns: columns.len(),
                most: MAX_COLUMNS,
            });
        }
        let fields: Vec<_> = columns.into_iter().map(Column::into_field).collect();
        let metadata = HashMap::from([("message".to_owned(), message)]);
        Ok(Arc::new(Schema::new_with_metadata(fields, metadata)))
    }
}

/// A column whose types in two logs have no common type.
#[derive(Debug, thiserror::Error)]
#[error(
    "column {column:?} of {message} is {kind} in {} and {other_kind} in {}. One frame cannot hold both: read these logs \
     in two frames, or leave the column out (fields=, columns=)",
    path.display(),
    other_path.display()
)]
pub struct MixedColumn {
    message: String,
    column: String,
    kind: String,
    path: PathBuf,
    other_kind: String,
    other_path: PathBuf,
}

/// Whether the dialect gives the columns.
fn is_telemetry(schema: &Schema) -> bool {
    schema.metadata().contains_key("msgid")
}

/// Whether a column tells instances apart.
fn has_instances(schema: &Schema) -> bool {
    schema.fields().iter().any(|field| field.metadata().get(INSTANCE).is_some())
}

/// A column of all logs.
struct Column<'a> {
    name: &'a str,
    data_type: DataType,
    /// A log that caused this type.
    path: &'a Path,
    metadata: HashMap<String, String>,
}

impl<'a> Column<'a> {
    fn new(field: &'a FieldRef, path: &'a Path) -> Self {
        let (data_type, metadata) = (field.data_type().clone(), field.metadata().clone().into());
        Self { name: field.name(), data_type, path, metadata }
    }

    /// Merges the column of the same name of another log.
    fn join(&mut self, field: &FieldRef, path: &'a Path, message: &str) -> Result<(), Error> {
        let Some(data_type) = common_type(&self.data_type, field.data_type()) else {
            return Err(Box::new(MixedColumn {
                message: message.to_owned(),
                column: self.name.to_owned(),
                kind: in_words(&self.data_type),
                path: self.path.to_owned(),
                other_kind: in_words(field.data_type()),
                other_path: path.to_owned(),
            })
            .into());
        };
        if data_type != self.data_type {
            (self.data_type, self.path) = (data_type, path);
        }
        // A unit would be wrong for a log that does not state it. For instances, one log that states them is enough.
        let other = field.metadata();
        self.metadata.retain(|key, value| key == INSTANCE || other.get(key) == Some(value));
        if let Some(value) = other.get(INSTANCE) {
            self.metadata.insert(INSTANCE.to_owned(), value.clone());
        }
        Ok(())
    }

    fn into_field(self) -> Field {
        Field::new(self.name, self.data_type, true).with_metadata(self.metadata)
    }
}

/// The narrowest type that holds the values of both, or `None`.
fn common_type(one: &DataType, other: &DataType) -> Option<DataType> {
    if one == other {
        return Some(one.clone());
    }
    if !(one.is_numeric() && other.is_numeric()) {
        return None;
    }
    let integers = one.is_integer() && other.is_integer();
    let common = if integers { common_integer(one, other) } else { None };
    Some(common.unwrap_or(DataType::Float64))
}

/// The narrowest integer type that holds all values of both; `None` for unsigned 64-bit and signed integers.
fn common_integer(one: &DataType, other: &DataType) -> Option<DataType> {
    let bits = |data_type: &DataType| data_type.primitive_width().map(|bytes| 8 * bytes);
    let signed_bits = |data_type: &DataType| {
        Some(bits(data_type)? * if data_type.is_signed_integer() { 1 } else { 2 })
    };
    if one.is_signed_integer() == other.is_signed_integer() {
        return Some(if bits(one) > bits(other) { one } else { other }.clone());
    }
    match signed_bits(one).max(signed_bits(other))? {
        16 => Some(DataType::Int16),
        32 => Some(DataType::Int32),
        64 => Some(DataType::Int64),
        _ => None,
    }
}

fn in_words(data_type: &DataType) -> String {
    match data_type {
        DataType::Utf8 => "text".to_owned(),
        DataType::Binary => "bytes".to_owned(),
        DataType::Dictionary(..) => "names of an enum".to_owned(),
        DataType::FixedSizeList(item, len) => format!("a list of {len} {}", item.data_type()),
        number => format!("a number ({number})"),
    }
}

#[cfg(test)]
mod tests {
    use DataType::{
        Float32, Float64, Int8, Int16, Int32, Int64, UInt8, UInt16, UInt32, UInt64, Utf8,
    };

    use super::*;

    fn schema(columns: &[(&str, DataType)]) -> SchemaRef {
        let field =
            |(name, data_type): &(&str, DataType)| Field::new(*name, data_type.clone(), false);
        let message = HashMap::from([("message".to_owned(), "ABC".to_owned())]);
        let fields: Vec<_> = columns.iter().map(field).collect();
        Arc::new(Schema::new_with_metadata(fields, message))
    }

    fn common(schemas: &[SchemaRef]) -> Result<SchemaRef, Error> {
        let mut all = CommonSchema::default();
        for (number, schema) in schemas.iter().enumerate() {
            all.add(schema, PathBuf::from(format!("{number}.BIN")));
        }
        all.schema()
    }

    #[test]
    fn numbers_widen_in_any_order() {
        let kinds = [
            (Int8, UInt8, Int16),
            (Int16, UInt8, Int16),
            (UInt8, UInt32, UInt32),
            (Int32, UInt16, Int32),
            (Int8, UInt32, Int64),
            (Int8, UInt64, Float64),
            (UInt64, UInt8, UInt64),
            (Int8, Float32, Float64),
            (Float32, Float64, Float64),
        ];
        for (one, other, expected) in kinds {
            let schemas = [schema(&[("X", one)]), schema(&[("X", other)])];
            let found = common(&schemas).expect("numbers");
            assert_eq!(found.field(0).data_type(), &expected);
            assert!(found.field(0).is_nullable());
            let [one, other] = schemas;
            assert_eq!(common(&[other, one]).expect("numbers"), found);
        }
    }

    #[test]
    fn columns_of_the_largest_come_first() {
        let few = schema(&[("T", UInt64), ("Old", UInt8), ("A", Int8)]);
        let most = schema(&[("T", UInt64), ("I", UInt8), ("A", Int8), ("B", Int8)]);
        let expected = ["T", "I", "A", "B", "Old"];
        for schemas in [[few.clone(), most.clone(), few.clone()], [most.clone(), few.clone(), most]]
        {
            let found = common(&schemas).expect("no mixed column");
            let names: Vec<_> = found.fields().iter().map(|field| field.name().as_str()).collect();
            assert_eq!(names, expected);
        }
    }

    #[test]
    fn text_beside_a_number_names_both_logs() {
        let schemas = [schema(&[("X", Utf8)]), schema(&[("X", Int8), ("Y", Int8)])];
        let said = common(&schemas).expect_err("a mixed column").to_string();
        let kinds = "column \"X\" of ABC is a number (Int8) in 1.BIN and text in 0.BIN";
        assert!(said.starts_with(kinds), "{said}");
    }

    #[test]
    fn metadata_is_that_of_all_logs() {
        let with = |entries: &[(&str, &str)]| {
            let entries = entries.iter().map(|&(key, value)| (key.to_owned(), value.to_owned()));
            let field =
                Field::new("X", Int8, false).with_metadata(entries.collect::<HashMap<_, _>>());
            Arc::new(Schema::new(vec![field]))
        };
        let one = with(&[("field", "X"), ("unit", "m")]);
        let other = with(&[("field", "X"), ("unit", "cm"), (INSTANCE, "true")]);
        let found = common(&[one, other]).expect("one type");
        let expected = [("field", "X"), (INSTANCE, "true")];
        let expected = expected.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let found: HashMap<_, _> = found.field(0).metadata().clone().into();
        assert_eq!(found, HashMap::from(expected));
    }

    #[test]
    fn a_frame_does_not_grow_without_end() {
        let wide = |from: usize| {
            let field = |number| Field::new(format!("C{number}"), Int8, false);
            Arc::new(Schema::new((from..from + 3000).map(field).collect::<Vec<_>>()))
        };
        assert!(common(&[wide(0)]).is_ok());
        let said = common(&[wide(0), wide(3000)]).expect_err("too many").to_string();
        assert!(said.contains("6000 columns"), "{said}");
    }
}
