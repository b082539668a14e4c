//! The columns of a record type.
//!
//! `timestamp`, then the fields in the order of the description. Metadata says what UNIT, MULT and FMTU records say: `unit`,
//! `multiplier`, and `instance` for the field that tells instances apart. A type that the log describes anew has the
//! columns of all descriptions, with nulls in rows of one that has not got them.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use arrow::datatypes::DataType;
use mavwire_core::log::dataflash::{ARRAY_LEN, FieldKind, Layout as LogLayout};
use mavwire_schema::{Field, FieldType};

use super::survey::{Form, Survey};
use crate::layout::{Column, HEADER, Layout, Options, Source, metadata};
use crate::units::{Scale, to_si};

/// The columns of a table, and where each layout has them.
#[derive(Debug, Clone)]
pub struct TableLayout {
    /// The columns.
    pub layout: Arc<Layout>,
    /// By layout index.
    pub(super) places: HashMap<u16, Places>,
}

impl TableLayout {
    /// Whether both have the same columns, in the same places of records.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let (columns, others) = (&self.layout.columns, &other.layout.columns);
        let are_same = |(one, other): (&Column, &Column)| {
            one.source == other.source && one.scale == other.scale
        };
        self.places == other.places
            && self.layout.schema == other.layout.schema
            && columns.len() == others.len()
            && columns.iter().zip(others).all(are_same)
    }
}

/// Where a layout has the columns of its table.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Places {
    /// Field of each column; `None` for null.
    pub(super) fields: Vec<Option<u16>>,
    /// The kind of value that a column takes from a record, by field.
    sources: Vec<Source>,
}

impl Places {
    /// The kind of value that each column takes from a record; `None` for null.
    pub(super) fn sources(&self) -> impl Iterator<Item = Option<&Source>> {
        self.fields.iter().map(|field| self.sources.get(usize::from((*field)?)))
    }
}

/// The columns of the table with an index.
pub fn table_layout(survey: &Survey, table: usize, options: &Options) -> TableLayout {
    let mut columns = vec![Column::timestamp()];
    let mut taken: HashSet<String> = HEADER.iter().map(|&name| name.to_owned()).collect();
    let layouts: Vec<_> = survey.layouts_of(table).collect();
    let mut places = HashMap::new();
    // Field name -> its columns, which differ in what they hold.
    let mut by_field: HashMap<&str, Vec<usize>> = HashMap::new();
    for &(index, layout) in &layouts {
        let mut of_layout = Places { fields: vec![None; columns.len()], sources: Vec::new() };
        for (number, field) in layout.fields.iter().enumerate() {
            let mut made = column(survey, layout, number, options);
            let known = by_field.entry(&field.name).or_default();
            let same = known.iter().copied().find(|&place| {
                of_layout.fields[place].is_none() && is_same(&columns[place], &made, &field.name)
            });
            of_layout.sources.push(made.source.clone());
            let place = same.unwrap_or_else(|| {
                let name = free_name(&field.name, known.len(), &mut taken);
                made.field.set_name(name);
                columns.push(made);
                of_layout.fields.push(None);
                known.push(columns.len() - 1);
                columns.len() - 1
            });
            of_layout.fields[place] = Some(number as u16);
        }
        places.insert(index as u16, of_layout);
    }
    choose(&mut columns, &mut places, options);
    let always = matches!(survey.form, Form::Binary(_)) && layouts.len() == 1;
    for column in columns.iter_mut().filter(|_| !always) {
        column.field.set_nullable(true);
    }
    let mut layout = Layout::of(survey.tables[table].to_string(), columns, []);
    if let ([(_, only)], true) = (&layouts[..], always) {
        layout = layout.with_late(options, only.len.into());
    }
    TableLayout { layout: Arc::new(layout), places }
}

/// A name that no other column has, for one of a field that has so many already. Arrow's C interface has no room for
/// the NUL that a damaged description may hold.
fn free_name(field: &str, already: usize, taken: &mut HashSet<String>) -> String {
    let mut name = field.replace('\0', "\u{fffd}") + &"_".repeat(already);
    while !taken.insert(name.clone()) {
        name.push('_');
    }
    name
}

/// Leaves the columns that are wanted, in the order in which they are.
fn choose(columns: &mut Vec<Column>, places: &mut HashMap<u16, Places>, options: &Options) {
    for of_layout in places.values_mut() {
        of_layout.fields.resize(columns.len(), None);
    }
    if options.columns.is_none() {
        return;
    }
    let all = columns.iter().enumerate();
    let mut kept: Vec<_> =
        all.filter_map(|(from, column)| Some((options.place(column.name())?, from))).collect();
    kept.sort_unstable();
    for of_layout in places.values_mut() {
        of_layout.fields = kept.iter().map(|&(_, from)| of_layout.fields[from]).collect();
    }
    let mut all: Vec<_> = columns.drain(..).map(Some).collect();
    columns.extend(kept.iter().filter_map(|&(_, from)| all[from].take()));
}

/// Whether a column of one description can hold a field of another.
fn is_same(one: &Column, other: &Column, name: &str) -> bool {
    one.field.metadata().get("field").map(String::as_str) == Some(name)
        && one.field.data_type() == other.field.data_type()
        && one.scale == other.scale
        && one.source.is_like(&other.source)
}

fn column(survey: &Survey, layout: &LogLayout, number: usize, options: &Options) -> Column {
    let log_field = &layout.fields[number];
    let (unit, multiplier) = unit_of(survey, layout, number);
    let mut field =
        Field { name: log_field.name.clone(), offset: log_field.offset, ..Field::default() };
    field.units = unit;
    // A field that is scaled on reading already has its unit's value.
    field.multiplier = multiplier.filter(|_| log_field.kind.scale().is_none());
    let is_text_log = matches!(survey.form, Form::Text(_));
    let mut column = if is_text_log {
        text_log_column(field, log_field.kind, options)
    } else {
        binary_column(field, log_field.kind, layout.name == "FILE", options)
    };
    // Tables are not split by lists.
    if survey.units.instance_field(layout) == Some(number) && log_field.kind != FieldKind::Array {
        column.mark_instance();
    }
    column
}

/// The unit of a field, and its multiplier unless that is 1 or unknown.
fn unit_of(survey: &Survey, layout: &LogLayout, number: usize) -> (Option<String>, Option<String>) {
    let units = &survey.units;
    let Some((unit_ids, mult_ids)) = units.fields.get(&layout.type_id) else { return (None, None) };
    let unit = unit_ids.chars().nth(number).filter(|&id| id != '#').and_then(|id| {
        units.labels.iter().find(|(known, label)| *known == id && !label.is_empty())
    });
    let factor = mult_ids.chars().nth(number).and_then(|id| {
        let usual = |factor: f64| {
            factor == 0.0 || (factor - 1.0).abs() < f64::EPSILON || !factor.is_finite()
        };
        units.multipliers.iter().find(|&&(known, factor)| known == id && !usual(factor))
    });
    (unit.map(|(_, label)| label.clone()), factor.map(|(_, factor)| factor.to_string()))
}

/// The column of a field of binary records.
fn binary_column(mut field: Field, kind: FieldKind, raw_bytes: bool, options: &Options) -> Column {
    if let FieldKind::Text(len) = kind {
        field.array_length = len;
        return if raw_bytes && len == 64 {
            textual(field, Source::Bytes, DataType::Binary)
        } else {
            textual(field, Source::LogText, DataType::Utf8)
        };
    }
    field.field_type = stored_type(kind);
    field.array_length = if kind == FieldKind::Array { ARRAY_LEN as u8 } else { 0 };
    let over = if kind == FieldKind::Degrees { 1e7 } else { 100.0 };
    let scale = kind.scale().map(|_| Scale::down(over));
    let mut column = scaled(&field, scale, options);
    if kind == FieldKind::F16 {
        column.source = Source::Half(field);
    }
    column
}

/// A text log has names of modes, and numbers with all their digits, scaled already.
fn text_log_column(mut field: Field, kind: FieldKind, options: &Options) -> Column {
    if matches!(kind, FieldKind::Text(_) | FieldKind::Array | FieldKind::Mode) {
        return textual(field, Source::LogText, DataType::Utf8);
    }
    field.field_type = if kind.is_float() { FieldType::F64 } else { stored_type(kind) };
    scaled(&field, None, options)
}

/// The type of the numbers of binary records.
fn stored_type(kind: FieldKind) -> FieldType {
    use FieldKind as K;
    match kind {
        K::Text(_) => FieldType::Char,
        K::I8 | K::Mode => FieldType::I8,
        K::U8 => FieldType::U8,
        K::I16 | K::CentiI16 | K::Array => FieldType::I16,
        K::U16 | K::CentiU16 => FieldType::U16,
        K::I32 | K::CentiI32 | K::Degrees => FieldType::I32,
        K::U32 | K::CentiU32 => FieldType::U32,
        K::I64 => FieldType::I64,
        K::U64 => FieldType::U64,
        K::F16 | K::F32 => FieldType::F32,
        K::F64 => FieldType::F64,
    }
}

fn textual(field: Field, source: fn(Field) -> Source, data_type: DataType) -> Column {
    let (name, metadata) = (field.name.clone(), metadata(&field, None));
    Column::new(&name, source(field), data_type).with_metadata(metadata)
}

/// A column of numbers, with the scale of its kind, and what makes them SI if that is wanted.
fn scaled(field: &Field, scale: Option<Scale>, options: &Options) -> Column {
    let si = if options.si { to_si(field) } else { None };
    let both = match (scale, si) {
        (Some(one), Some((other, _))) => Some(one.and(other)),
        (one, other) => one.or(other.map(|(scale, _)| scale)),
    };
    Column::numbers(&field.name, field, both, None, None).with_metadata(metadata(field, si))
}
