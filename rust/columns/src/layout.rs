//! The columns of a message type: names, types and metadata.
//!
//! First `timestamp` (microseconds, UTC; null where the log tells no time), `sysid`, `compid` and `seq`, then the fields in XML order.
//! A field that bears one of those names, or that of a column before it, gets underscores behind its own. Metadata tells the
//! rest: `field` (the name in the definition), `unit`, `enum`, `bitmask`, `multiplier`, `invalid` (as sent, before scaling).

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use arrow::datatypes::{DataType, Field as ArrowField, Schema, SchemaRef, TimeUnit};
use mavwire_core::registry::Registry;
use mavwire_core::telemetry::TextFields;
use mavwire_schema::{Dialect, Enum, Field, FieldType, InvalidRule, Message};

use crate::enums::{Names, mask_len};
use crate::error::Error;
use crate::gather::PAYLOAD;
use crate::units::{Scale, to_si};

/// The columns in front of the fields, which say where a row came from and not what was measured.
pub(crate) const HEADER: [&str; 4] = ["timestamp", "sysid", "compid", "seq"];

/// The column of whole records. A field has a name.
const RECORD: &str = "";

/// Plain columns that cost about as much as a copy of the record: only more than these are decoded late.
const RECORD_COST: usize = 12;

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
#[derive(Debug, Clone, Default, PartialEq, Eq)]
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
    /// Those of a predicate: they are decoded first, and the others for the rows that it keeps.
    pub predicate: Option<Vec<String>>,
}

impl Options {
    /// Where a column of this name comes; `None` where it is not wanted.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.columns.as_ref()?.iter().position(|one| one == name)
    }
}

/// The part of a record that a column holds.
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
    /// All bytes of a row, so many.
    Record(u16),
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
    /// Its name, which is unique in its table, and its type and metadata.
    pub field: ArrowField,
    /// The part of a record that it holds.
    pub source: Source,
    /// The factor that turns its values into SI units.
    pub scale: Option<Scale>,
    /// The names that replace its values.
    pub names: Option<Names>,
    /// The rule for values that become nulls.
    pub invalid: Option<InvalidRule>,
}

/// The columns of all messages, made when a log has the first one, and used again for other logs.
#[derive(Debug)]
pub struct Layouts {
    options: Options,
    made: Box<[OnceLock<Arc<Layout>>]>,
}

impl Layouts {
    /// Those of the messages of a registry.
    pub fn new(registry: &Registry, options: Options) -> Self {
        let made = registry.dialect().messages.iter().map(|_| OnceLock::new()).collect();
        Self { options, made }
    }

    /// The options that they are for.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// The columns of the message with an index in the same registry.
    pub(crate) fn of(&self, registry: &Registry, index: u16) -> Arc<Layout> {
        let layout = || Arc::new(Layout::new(registry, index, &self.options));
        Arc::clone(self.made[usize::from(index)].get_or_init(layout))
    }
}

/// The columns of a message type.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name of the message.
    pub message: String,
    /// In order.
    pub columns: Vec<Column>,
    /// The same for arrow.
    pub schema: SchemaRef,
    /// The layout of the rows that a predicate keeps, where these are its columns alone: see [`Layout::with_late`].
    pub late: Option<Arc<Layout>>,
}

impl Layout {
    /// The columns of the message with an index in the registry.
    pub fn new(registry: &Registry, index: u16, options: &Options) -> Self {
        let message = registry.message(index);
        let mut columns = all_columns(message, registry.dialect(), options);
        if options.columns.is_some() {
            columns.retain(|column| options.place(column.name()).is_some());
            columns.sort_by_key(|column| options.place(column.name()));
        }
        let told =
            [("msgid", message.id.to_string()), ("dialect", registry.dialect().name.clone())];
        let layout = Self::of(message.name.clone(), columns, told);
        if TextFields::of(message).is_some() {
            return layout; // a long text is in several records
        }
        layout.with_late(options, PAYLOAD as u16 + u16::from(message.max_len))
    }

    /// The columns of a predicate, and the records of `len` bytes, from which [`Batch::kept`](crate::reader::Batch::kept)
    /// decodes the wanted columns. The wanted columns at once without a predicate, or if it asks for most of them.
    pub(crate) fn with_late(self, options: &Options, len: u16) -> Self {
        let Some(names) = &options.predicate else { return self };
        let is_asked = |column: &&Column| names.iter().any(|name| name == column.name());
        let is_late = |column: &&Column| !is_asked(column) && column.source != Source::Timestamp;
        if self.columns.iter().filter(is_late).map(Column::cost).sum::<usize>() <= RECORD_COST {
            return self;
        }
        let asked = self.columns.iter().filter(is_asked);
        let asked = asked.filter(|column| column.source != Source::Timestamp).cloned();
        let record =
            Column::new(RECORD, Source::Record(len), DataType::FixedSizeBinary(len.into()));
        let columns = std::iter::once(Column::timestamp()).chain(asked).chain([record]).collect();
        let first = Self::of(self.message.clone(), columns, []);
        Self { late: Some(Arc::new(self)), ..first }
    }

    /// These columns of a type, and metadata beside its name.
    pub(crate) fn of<const N: usize>(
        message: String,
        columns: Vec<Column>,
        told: [(&str, String); N],
    ) -> Self {
        let told = told.into_iter().map(|(key, value)| (key.to_owned(), value));
        let mut metadata: HashMap<_, _> = told.collect();
        metadata.insert("message".to_owned(), message.clone());
        let fields: Vec<_> = columns.iter().map(|column| column.field.clone()).collect();
        let schema = Arc::new(Schema::new_with_metadata(fields, metadata));
        Self { message, columns, schema, late: None }
    }

    /// Checks that each of the columns is there.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(registry: &Registry, index: u16, columns: &[String]) -> Result<(), Error> {
        let message = registry.message(index);
        let known = all_columns(message, registry.dialect(), &Options::default());
        let missing = |column: &&String| known.iter().all(|one| one.name() != **column);
        match columns.iter().find(missing) {
            None => Ok(()),
            Some(column) => {
                Err(Error::NoColumn { message: message.name.clone(), column: column.clone() })
            }
        }
    }
}

impl Column {
    pub(crate) fn new(name: &str, source: Source, data_type: DataType) -> Self {
        let nullable = source == Source::Timestamp;
        let field = ArrowField::new(name, data_type, nullable);
        Self { field, source, scale: None, names: None, invalid: None }
    }

    /// The times of records.
    pub(crate) fn timestamp() -> Self {
        let time = DataType::Timestamp(TimeUnit::Microsecond, Some("UTC".into()));
        Self::new("timestamp", Source::Timestamp, time)
    }

    /// The numbers of a field.
    pub(crate) fn numbers(
        name: &str,
        field: &Field,
        scale: Option<Scale>,
        names: Option<Names>,
        invalid: Option<InvalidRule>,
    ) -> Self {
        let element = if names.is_some() {
            DataType::Dictionary(Box::new(DataType::Int32), Box::new(DataType::Utf8))
        } else if scale.is_some() {
            DataType::Float64
        } else {
            element_type(field.field_type)
        };
        let nullable = invalid.is_some();
        let data_type = if field.is_numeric_array() {
            let item = Arc::new(ArrowField::new("item", element, nullable));
            DataType::FixedSizeList(item, field.array_length.into())
        } else {
            element
        };
        let source = Source::Numbers(field.clone());
        let field = ArrowField::new(name, data_type, nullable);
        Self { field, source, scale, names, invalid }
    }

    pub(crate) fn with_metadata(mut self, metadata: HashMap<String, String>) -> Self {
        self.field.set_metadata(metadata);
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        self.field.name()
    }

    /// About what it costs to decode, in columns of numbers as they are.
    fn cost(&self) -> usize {
        let is_plain = self.scale.is_none() && self.invalid.is_none();
        if is_plain && self.field.data_type().is_primitive() { 1 } else { 4 }
    }

    /// Says that its values tell apart what the messages of one type are about.
    pub(crate) fn mark_instance(&mut self) {
        let mut metadata = self.field.metadata().clone();
        metadata.insert("instance".to_owned(), "true".to_owned());
        self.field.set_metadata(metadata);
    }
}

fn all_columns(message: &Message, dialect: &Dialect, options: &Options) -> Vec<Column> {
    let mut columns = vec![
        Column::timestamp(),
        Column::new("sysid", Source::Sysid, DataType::UInt8),
        Column::new("compid", Source::Compid, DataType::UInt8),
        Column::new("seq", Source::Seq, DataType::UInt8),
    ];
    columns.reserve_exact(message.fields.len());
    for (index, field) in message.fields.iter().enumerate() {
        let first = columns.len();
        let name = unique(&columns, field.name.clone());
        if field.is_char() {
            let raw = unique(&columns, format!("{name}_raw"));
            let text = Column::new(&name, Source::Text(field.clone()), DataType::Utf8);
            columns.push(text.with_metadata(metadata(field, None)));
            let mut raw = Column::new(&raw, Source::RawText(field.clone()), DataType::Binary);
            raw.field.set_nullable(true);
            columns.push(raw.with_metadata(metadata(field, None)));
        } else {
            columns.push(numbers(field, &name, dialect, options));
        }
        if message.instance_field.map(usize::from) == Some(index) {
            columns[first..].iter_mut().for_each(Column::mark_instance);
        }
    }
    columns
}

/// The name with as many underscores behind it as no column has.
fn unique(columns: &[Column], mut name: String) -> String {
    while columns.iter().any(|column| column.name() == name) {
        name.push('_');
    }
    name
}

fn numbers(field: &Field, name: &str, dialect: &Dialect, options: &Options) -> Column {
    let definition = options.enum_names.then(|| enum_of(field, dialect)).flatten();
    let names = definition.map(|definition| Names::new(definition, is_bitmask(field)));
    let si = if options.si && field.enum_name.is_none() { to_si(field) } else { None };
    let scale = si.map(|(scale, _)| scale);
    let invalid = match options.invalid {
        Invalid::Null => InvalidRule::of(field, &dialect.enums),
        Invalid::Keep => None,
    };
    Column::numbers(name, field, scale, names, invalid).with_metadata(metadata(field, si))
}

fn enum_of<'a>(field: &Field, dialect: &'a Dialect) -> Option<&'a Enum> {
    let name = field.enum_name.as_deref()?;
    if field.field_type.is_float() {
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

/// The field's metadata from its definition. Scaled values have the unit that they are scaled to, and no multiplier.
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
