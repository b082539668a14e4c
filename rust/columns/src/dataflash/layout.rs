//! The columns of a record type.
//!
//! `timestamp`, then the fields in the order of the description. Metadata says what UNIT, MULT and FMTU records say: `unit`,
//! `multiplier`, and `instance` for the field that tells instances apart. A type that the log describes anew has the
//! columns of all descriptions, with nulls in rows of one that has not got them.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use arrow::datatypes::{DataType, Field as ArrowField, Schema};
use mavwire_core::log::dataflash::{ARRAY_LEN, Field as LogField, FieldKind, Layout as LogLayout};
use mavwire_schema::{Field, FieldType};

use super::survey::{Form, Survey};
use crate::layout::metadata;
use crate::layout::{
    Column, HEADER, Layout, Options, Source, mark_instance, numbers_of, plain, time,
};
use crate::scan::Framing;
use crate::units::{Scale, to_si};

/// The columns of a table, and where each layout has them.
#[derive(Debug, Clone)]
pub struct TableLayout {
    /// The columns.
    pub layout: Arc<Layout>,
    /// Layout index -> for each column the field's index and what the column takes from a record; `None` for null.
    pub(super) places: HashMap<u16, Vec<Option<(usize, Source)>>>,
}

/// The columns of the table with an index.
pub fn table_layout(survey: &Survey, table: usize, options: &Options) -> TableLayout {
    let mut columns = vec![plain("timestamp", Source::Timestamp, time())];
    let mut taken: HashSet<String> = HEADER.iter().map(|&name| name.to_owned()).collect();
    let layouts: Vec<_> = survey.layouts_of(table).collect();
    let mut places = HashMap::new();
    for &(index, layout) in &layouts {
        let mut of_layout = vec![None; columns.len()];
        for (number, field) in layout.fields.iter().enumerate() {
            let mut made = column(survey, layout, number, options);
            let same = |(place, one): (usize, &(Column, ArrowField))| {
                of_layout[place].is_none() && is_same(one, &made, &field.name)
            };
            let known = (1..).zip(&columns[1..]).find(|&entry| same(entry)).map(|(place, _)| place);
            let source = made.0.source.clone();
            let place = known.unwrap_or_else(|| {
                let mut name = field.name.clone();
                while !taken.insert(name.clone()) {
                    name.push('_');
                }
                made.0.name.clone_from(&name);
                columns.push((made.0, made.1.with_name(name)));
                of_layout.push(None);
                columns.len() - 1
            });
            of_layout[place] = Some((number, source));
        }
        places.insert(index as u16, of_layout);
    }
    choose(&mut columns, &mut places, options);
    let always = matches!(survey.form, Form::Binary(_)) && layouts.len() == 1;
    let (columns, fields): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
    let nullable = |field: &ArrowField| field.is_nullable() || !always;
    let fields: Vec<_> = fields
        .into_iter()
        .map(|f| {
            let null = nullable(&f);
            f.with_nullable(null)
        })
        .collect();
    let name = survey.tables[table].to_string();
    let metadata = HashMap::from([("message".to_owned(), name.clone())]);
    let framing = if survey.clock.is_some() { Framing::Stamped } else { Framing::Raw };
    let schema = Arc::new(Schema::new_with_metadata(fields, metadata));
    let layout = Layout { message: name, max_len: 0, columns, schema, framing };
    TableLayout { layout: Arc::new(layout), places }
}

/// Leaves the columns that are wanted.
fn choose(
    columns: &mut Vec<(Column, ArrowField)>,
    places: &mut HashMap<u16, Vec<Option<(usize, Source)>>>,
    options: &Options,
) {
    for of_layout in places.values_mut() {
        of_layout.resize(columns.len(), None);
    }
    let Some(wanted) = &options.columns else { return };
    let kept: Vec<bool> = columns.iter().map(|(column, _)| wanted.contains(&column.name)).collect();
    for of_layout in places.values_mut() {
        let mut kept = kept.iter();
        of_layout.retain(|_| *kept.next().unwrap_or(&true));
    }
    let mut kept = kept.iter();
    columns.retain(|_| *kept.next().unwrap_or(&true));
}

/// Whether a column of one description can hold a field of another.
fn is_same(one: &(Column, ArrowField), other: &(Column, ArrowField), name: &str) -> bool {
    one.1.metadata().get("field").map(String::as_str) == Some(name)
        && one.1.data_type() == other.1.data_type()
        && one.0.scale == other.0.scale
        && one.0.source.is_like(&other.0.source)
}

fn column(
    survey: &Survey,
    layout: &LogLayout,
    number: usize,
    options: &Options,
) -> (Column, ArrowField) {
    let log_field = &layout.fields[number];
    let (unit, multiplier) = unit_of(survey, layout, number);
    let mut field =
        Field { name: log_field.name.clone(), offset: log_field.offset, ..Field::default() };
    field.units = unit;
    // What is scaled when it is read is measured in the unit itself.
    field.multiplier = multiplier.filter(|_| log_field.kind.scale().is_none());
    let is_text_log = matches!(survey.form, Form::Text(_));
    let (mut column, mut arrow) = if is_text_log {
        text_log_column(field, log_field, options)
    } else {
        binary_column(field, log_field, layout.name == "FILE", options)
    };
    column.name.clone_from(&log_field.name);
    if survey.units.instance_field(layout) == Some(number) {
        mark_instance(&mut arrow);
    }
    (column, arrow)
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

/// Element type, elements and scale of the numbers of a binary record.
fn binary_column(
    mut field: Field,
    log_field: &LogField,
    raw_bytes: bool,
    options: &Options,
) -> (Column, ArrowField) {
    use FieldKind as K;
    let mut scale = None;
    (field.field_type, field.array_length) = match log_field.kind {
        K::Text(len) => {
            field.array_length = len;
            return if raw_bytes && len == 64 {
                textual(Source::Bytes(field), DataType::Binary)
            } else {
                textual(Source::LogText(field), DataType::Utf8)
            };
        }
        K::Array => (FieldType::I16, ARRAY_LEN as u8),
        K::I8 | K::Mode => (FieldType::I8, 0),
        K::U8 => (FieldType::U8, 0),
        K::I16 | K::CentiI16 => (FieldType::I16, 0),
        K::U16 | K::CentiU16 => (FieldType::U16, 0),
        K::I32 | K::CentiI32 | K::Degrees => (FieldType::I32, 0),
        K::U32 | K::CentiU32 => (FieldType::U32, 0),
        K::I64 => (FieldType::I64, 0),
        K::U64 => (FieldType::U64, 0),
        K::F16 | K::F32 => (FieldType::F32, 0),
        K::F64 => (FieldType::F64, 0),
    };
    if log_field.kind.scale().is_some() {
        scale = Some(Scale::down(if log_field.kind == K::Degrees { 1e7 } else { 100.0 }));
    }
    let (mut column, arrow) = scaled(&field, scale, options);
    if log_field.kind == K::F16 {
        column.source = Source::Half(field);
    }
    (column, arrow)
}

/// A text log has names of modes, and numbers with all their digits, scaled already.
fn text_log_column(
    mut field: Field,
    log_field: &LogField,
    options: &Options,
) -> (Column, ArrowField) {
    use FieldKind as K;
    field.field_type = match log_field.kind {
        K::Text(_) | K::Array | K::Mode => {
            return textual(Source::LogText(field), DataType::Utf8);
        }
        kind if kind.is_float() => FieldType::F64,
        K::I8 => FieldType::I8,
        K::U8 => FieldType::U8,
        K::I16 => FieldType::I16,
        K::U16 => FieldType::U16,
        K::I32 => FieldType::I32,
        K::U32 => FieldType::U32,
        K::U64 => FieldType::U64,
        _ => FieldType::I64,
    };
    scaled(&field, None, options)
}

fn textual(source: Source, data_type: DataType) -> (Column, ArrowField) {
    let field = match &source {
        Source::LogText(field) | Source::Bytes(field) => metadata(field, None),
        _ => HashMap::new(),
    };
    let (column, arrow) = plain("", source, data_type);
    (column, arrow.with_metadata(field))
}

/// A column of numbers, with the scale of its kind, and what makes them SI if that is wanted.
fn scaled(field: &Field, scale: Option<Scale>, options: &Options) -> (Column, ArrowField) {
    let si = if options.si { to_si(field) } else { None };
    let both = match (scale, si) {
        (Some(one), Some((other, _))) => Some(one.and(other)),
        (one, other) => one.or(other.map(|(scale, _)| scale)),
    };
    numbers_of(field, both, None, metadata(field, si))
}
