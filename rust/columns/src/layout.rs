//! The columns of a message type: names, types and metadata.
//!
//! First `timestamp` (microseconds, UTC; null where the log tells no time), `sysid`, `compid` and `seq`, then the fields in XML order.
//! A field that bears one of those names, or that of a column before it, gets underscores behind its own. Metadata tells the
//! rest: `field` (the name in the definition), `unit`, `enum`, `bitmask`, `multiplier`, `invalid` (as sent, before scaling).

use std::collections::HashMap;
use std::sync::Arc;

use arrow::datatypes::{DataType, Field as ArrowField, Schema, SchemaRef, TimeUnit};
use mavwire_core::registry::Registry;
use mavwire_schema::{Dialect, Enum, Field, FieldType, InvalidRule, Message};

use crate::enums::{Names, mask_len};
use crate::error::Error;
use crate::scan::Framing;
use crate::units::{Scale, to_si};

/// The columns in front of the fields, which say where a row came from and not what was measured.
pub(crate) const HEADER: [&str; 4] = ["timestamp", "sysid", "compid", "seq"];

/// The policy for invalid values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Invalid {
    /// They become nulls.
    Null,
    /// They stay as they are.
    #[default]
    Keep,
}

/// How a table is wanted.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Values in SI units.
    pub si: bool,
    /// Enum values by name.
    pub enum_names: bool,
    /// The policy for invalid values.
    pub invalid: Invalid,
    /// A row for each part of a long text, where the other parts may be elsewhere.
    pub text_parts: bool,
    /// The columns that are wanted, in their order; `None` for all.
    pub columns: Option<Vec<String>>,
}

impl Options {
    /// Where a column of this name comes; `None` where it is not wanted.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.columns.as_ref()?.iter().position(|one| one == name)
    }
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// Time of the record.
    Timestamp,
    /// Sending system.
    Sysid,
    /// Sending component.
    Compid,
    /// Sequence number.
    Seq,
    /// A field of numbers.
    Numbers(Field),
    /// A `char` field as text: up to the first NUL, with U+FFFD for what is not UTF-8.
    Text(Field),
    /// The bytes of a `char` field without trailing NULs, where the text does not hold them all.
    RawText(Field),
    /// Floats of half precision, in a dataflash log.
    Half(Field),
    /// The text of a dataflash log, Latin-1 where it is not UTF-8.
    LogText(Field),
    /// All bytes of a field.
    Bytes(Field),
}

impl Source {
    /// Whether values of both can stand in one column.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

/// A column.
#[derive(Debug, Clone)]
pub struct Column {
    /// Name, unique in its table.
    pub name: String,
    /// What it holds.
    pub source: Source,
    /// What makes its values SI.
    pub scale: Option<Scale>,
    /// What makes names of its values.
    pub names: Option<Names>,
    /// Which values become nulls.
    pub invalid: Option<InvalidRule>,
}

/// The columns of a message type.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name of the message.
    pub message: String,
    /// Payload bytes of the message.
    pub max_len: usize,
    /// In order.
    pub columns: Vec<Column>,
    /// The same for arrow.
    pub schema: SchemaRef,
    /// Whether records have a time.
    pub framing: Framing,
}

impl Layout {
    /// The columns of the message with an index in the registry.
    pub fn new(registry: &Registry, index: u16, framing: Framing, options: &Options) -> Self {
        let message = registry.message(index);
        let mut columns = all_columns(message, registry.dialect(), options);
        if options.columns.is_some() {
            columns.retain(|(column, _)| options.place(&column.name).is_some());
            columns.sort_by_key(|(column, _)| options.place(&column.name));
        }
        let metadata = HashMap::from([
            ("message".to_owned(), message.name.clone()),
            ("msgid".to_owned(), message.id.to_string()),
            ("dialect".to_owned(), registry.dialect().name.clone()),
        ]);
        let (columns, fields): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
        Self {
            message: message.name.clone(),
            max_len: message.max_len.into(),
            columns,
            schema: Arc::new(Schema::new_with_metadata(fields, metadata)),
            framing,
        }
    }

    /// Checks that each of the columns is there.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(registry: &Registry, index: u16, columns: &[String]) -> Result<(), Error> {
        let message = registry.message(index);
        let known = all_columns(message, registry.dialect(), &Options::default());
        let missing = |column: &&String| known.iter().all(|(one, _)| one.name != **column);
        match columns.iter().find(missing) {
            None => Ok(()),
            Some(column) => {
                Err(Error::NoColumn { message: message.name.clone(), column: column.clone() })
            }
        }
    }
}

pub(crate) fn plain(name: &str, source: Source, data_type: DataType) -> (Column, ArrowField) {
    let nullable = source == Source::Timestamp;
    let field = ArrowField::new(name, data_type, nullable);
    (Column { name: name.to_owned(), source, scale: None, names: None, invalid: None }, field)
}

/// The type of `timestamp`.
pub(crate) fn time() -> DataType {
    DataType::Timestamp(TimeUnit::Microsecond, Some("UTC".into()))
}

fn all_columns(
    message: &Message,
    dialect: &Dialect,
    options: &Options,
) -> Vec<(Column, ArrowField)> {
    let mut columns = vec![
        plain("timestamp", Source::Timestamp, time()),
        plain("sysid", Source::Sysid, DataType::UInt8),
        plain("compid", Source::Compid, DataType::UInt8),
        plain("seq", Source::Seq, DataType::UInt8),
    ];
    columns.reserve_exact(message.fields.len());
    for (index, field) in message.fields.iter().enumerate() {
        let first = columns.len();
        let name = unique(&columns, field.name.clone());
        if field.is_char() {
            let raw = unique(&columns, format!("{name}_raw"));
            columns.push(text(field, &name));
            columns.push(raw_text(field, &raw));
        } else {
            columns.push(numbers(field, &name, dialect, options));
        }
        if message.instance_field.map(usize::from) == Some(index) {
            for (_, arrow) in &mut columns[first..] {
                mark_instance(arrow);
            }
        }
    }
    columns
}

/// The name with as many underscores behind it as no column has.
fn unique(columns: &[(Column, ArrowField)], mut name: String) -> String {
    while columns.iter().any(|(column, _)| column.name == name) {
        name.push('_');
    }
    name
}

/// Says of a column that its values tell apart what the messages of one type are about.
pub(crate) fn mark_instance(arrow: &mut ArrowField) {
    let mut metadata = arrow.metadata().clone();
    metadata.insert("instance".to_owned(), "true".to_owned());
    arrow.set_metadata(metadata);
}

fn text(field: &Field, name: &str) -> (Column, ArrowField) {
    let (column, arrow) = plain(name, Source::Text(field.clone()), DataType::Utf8);
    (column, arrow.with_metadata(metadata(field, None)))
}

fn raw_text(field: &Field, name: &str) -> (Column, ArrowField) {
    let (column, arrow) = plain(name, Source::RawText(field.clone()), DataType::Binary);
    (column, arrow.with_nullable(true).with_metadata(metadata(field, None)))
}

fn numbers(
    field: &Field,
    name: &str,
    dialect: &Dialect,
    options: &Options,
) -> (Column, ArrowField) {
    let definition = options.enum_names.then(|| enum_of(field, dialect)).flatten();
    let names = definition.map(|definition| Names::new(definition, is_bitmask(field)));
    let si = if options.si && field.enum_name.is_none() { to_si(field) } else { None };
    let scale = si.map(|(scale, _)| scale);
    let invalid = match options.invalid {
        Invalid::Null => InvalidRule::of(field, &dialect.enums),
        Invalid::Keep => None,
    };
    let (mut column, arrow) = numbers_of(field, scale, names, invalid, metadata(field, si));
    name.clone_into(&mut column.name);
    (column, arrow.with_name(name))
}

/// A column of the numbers of a field, without a name as yet.
pub(crate) fn numbers_of(
    field: &Field,
    scale: Option<Scale>,
    names: Option<Names>,
    invalid: Option<InvalidRule>,
    metadata: HashMap<String, String>,
) -> (Column, ArrowField) {
    let element = if names.is_some() {
        DataType::Dictionary(Box::new(DataType::Int32), Box::new(DataType::Utf8))
    } else if scale.is_some() {
        DataType::Float64
    } else {
        element_type(field.field_type)
    };
    let data_type = if field.is_numeric_array() {
        let item = Arc::new(ArrowField::new("item", element, invalid.is_some()));
        DataType::FixedSizeList(item, field.array_length.into())
    } else {
        element
    };
    let (mut column, arrow) = plain("", Source::Numbers(field.clone()), data_type);
    column.scale = scale;
    column.names = names;
    let arrow = arrow.with_nullable(invalid.is_some()).with_metadata(metadata);
    column.invalid = invalid;
    (column, arrow)
}

fn enum_of<'a>(field: &Field, dialect: &'a Dialect) -> Option<&'a Enum> {
    let name = field.enum_name.as_deref()?;
    if matches!(field.field_type, FieldType::F32 | FieldType::F64) {
        return None;
    }
    dialect.enums.iter().find(|definition| definition.name == name)
}

fn is_bitmask(field: &Field) -> bool {
    field.display.as_deref() == Some("bitmask")
}

/// Bytes that the names in a row of a message may come to.
pub(crate) fn names_len(message: &Message, dialect: &Dialect) -> usize {
    let of_field = |field: &Field| {
        let definition = enum_of(field, dialect)?;
        Some(field.elements() * mask_len(definition, is_bitmask(field)))
    };
    message.fields.iter().filter_map(of_field).sum()
}

pub(crate) fn element_type(field_type: FieldType) -> DataType {
    match field_type {
        FieldType::Char | FieldType::U8 => DataType::UInt8,
        FieldType::I8 => DataType::Int8,
        FieldType::U16 => DataType::UInt16,
        FieldType::I16 => DataType::Int16,
        FieldType::U32 => DataType::UInt32,
        FieldType::I32 => DataType::Int32,
        FieldType::U64 => DataType::UInt64,
        FieldType::I64 => DataType::Int64,
        FieldType::F32 => DataType::Float32,
        FieldType::F64 => DataType::Float64,
    }
}

/// What the definition says of a field. Scaled values have the unit that they are scaled to, and no multiplier.
pub(crate) fn metadata(
    field: &Field,
    si: Option<(Scale, Option<&str>)>,
) -> HashMap<String, String> {
    let mut metadata = HashMap::from([("field".to_owned(), field.name.clone())]);
    let mut add = |key: &str, value: Option<&str>| {
        if let Some(value) = value {
            metadata.insert(key.to_owned(), value.to_owned());
        }
    };
    match si {
        Some((_, unit)) => add("unit", unit),
        None => {
            add("unit", field.units.as_deref());
            add("multiplier", field.multiplier.as_deref());
        }
    }
    add("invalid", field.invalid.as_deref());
    add("enum", field.enum_name.as_deref());
    add("bitmask", is_bitmask(field).then_some("true"));
    metadata
}
