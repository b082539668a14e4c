//! Binary dataflash logs as tables: they hold what one walk over the records finds, field by field.

use std::collections::BTreeMap;
use std::sync::Arc;

use mavwire_columns::arrow::array::{Array, AsArray, RecordBatch};
use mavwire_columns::arrow::datatypes::TimestampMicrosecondType;
use mavwire_columns::dataflash::{Form, Survey, Whole, read_whole, reader, summary};
use mavwire_columns::error::Error;
use mavwire_columns::input::{Steps, identify_content};
use mavwire_columns::layout::Options;
use mavwire_columns::reader::{Limits, Plan};
use mavwire_core::codec::Number;
use mavwire_core::log::dataflash::text::decode_line;
use mavwire_core::log::dataflash::{
    Definitions, FieldKind, HEAD_LEN, Layout, RecordEntry, Value, index,
};

use crate::input::Input;
use crate::logs::any_dataflash;
use crate::reading::{
    joined, looks_compressed, on_threads, small_limits, small_steps, source, whole_tables,
};
use crate::tables::{numbers, same};

/// All records.

/// A log's description of itself, read in such steps; `None` for something else than a dataflash log.
pub(crate) fn surveyed(steps: Steps, bytes: &[u8]) -> Option<Arc<Survey>> {
    let open = || Ok(source(bytes));
    let survey = Survey::read(steps, &open, || Ok::<_, Error>(()));
    survey.expect("memory does not fail").map(Arc::new)
}

/// The tables of a log that was surveyed, and how many bytes belong to no record.
pub(crate) fn tables_of(
    survey: &Arc<Survey>,
    bytes: &[u8],
    options: &Options,
    limits: Limits,
) -> (BTreeMap<u16, RecordBatch>, u64) {
    let open = || Ok(source(bytes));
    let plan = Plan { options: options.clone(), limits, ..Plan::default() };
    let mut reader = reader(Arc::clone(survey), &open, plan).expect("memory does not fail");
    let tables = whole_tables(&mut *reader);
    assert_eq!(reader.position(), bytes.len() as u64);
    (tables, reader.bad_bytes())
}

/// A log that was read.
pub(crate) struct ReadLog {
    pub(crate) bytes: Vec<u8>,
    pub(crate) survey: Arc<Survey>,
    pub(crate) options: Options,
    pub(crate) tables: BTreeMap<u16, RecordBatch>,
    /// Bytes that belong to no record.
    pub(crate) bad: u64,
}

/// The tables of any log in small steps on one thread, if those are the ones of the whole at once on several.
pub(crate) fn in_any_steps(
    input: &mut Input<'_>,
    log: impl FnOnce(Input<'_>) -> Vec<u8>,
) -> Option<ReadLog> {
    let options = Options { si: input.byte() & 1 == 1, ..Options::default() };
    let (steps, limits) = (small_steps(input, 256), small_limits(input));
    let bytes = log(std::mem::take(input));
    if looks_compressed(&bytes) {
        return None;
    }
    let survey = on_threads(true, || surveyed(Steps::default(), &bytes));
    let kind = identify_content(source(&bytes)).expect("memory does not fail");
    assert_eq!(kind.is_dataflash(), survey.is_some());
    let survey = survey?;
    let (found, bad) = on_threads(true, || tables_of(&survey, &bytes, &options, Limits::NONE));
    let stepped = on_threads(false, || surveyed(steps, &bytes));
    // The first block alone may not show the kind of the log, or the separator of its values.
    if let Some(stepped) = stepped.filter(|stepped| same_form(&stepped.form, &survey.form)) {
        same_survey(&stepped, &survey);
        let tables = on_threads(false, || tables_of(&stepped, &bytes, &options, limits));
        assert_eq!((&tables.0, tables.1), (&found, bad), "steps and threads");
        let whole = on_threads(false, || in_one_pass(steps, &bytes, &options, limits));
        same_survey(&whole.survey, &survey);
        if let Some((batches, junk)) = whole.rows {
            assert_eq!((&joined(batches), junk), (&found, bad), "one pass");
        }
    }
    Some(ReadLog { bytes, survey, options, tables: found, bad })
}

/// The tables of a log that was not surveyed, if one pass does.
fn in_one_pass(steps: Steps, bytes: &[u8], options: &Options, limits: Limits) -> Whole {
    let (options, size) = (options.clone(), bytes.len() as u64);
    let plan = Plan { options, limits, size, ..Plan::default() };
    let open = || Ok(source(bytes));
    let whole = read_whole(steps, &open, &plan, || Ok::<_, Error>(()));
    whole.expect("memory does not fail").expect("a dataflash log")
}

fn same_survey(one: &Survey, other: &Survey) {
    assert_eq!(one.form.layouts(), other.form.layouts());
    assert_eq!(
        (&one.tables, one.clock, format!("{:?}", one.units)),
        (&other.tables, other.clock, format!("{:?}", other.units)),
    );
}

fn same_form(one: &Form, other: &Form) -> bool {
    match (one, other) {
        (Form::Binary(_), Form::Binary(_)) => true,
        (Form::Text(one), Form::Text(other)) => one.delimiter() == other.delimiter(),
        _ => false,
    }
}

/// Table of each layout that has one.
pub(crate) fn table_of_layout(survey: &Survey) -> BTreeMap<usize, u16> {
    let tables = 0..survey.tables.len();
    let layouts = |table| survey.layouts_of(table).map(move |(index, _)| (index, table as u16));
    tables.flat_map(layouts).collect()
}

/// Any log, in any steps.
pub fn dataflash_tables(data: &[u8]) {
    let read = in_any_steps(&mut Input::new(data), any_dataflash);
    let Some(ReadLog { bytes, survey, options, tables: found, bad }) = read else { return };
    let Form::Binary(definitions) = &survey.form else { return };
    let (records, junk) = one_by_one(&survey, definitions, &bytes);
    assert_eq!(bad, junk);
    let tables = table_of_layout(&survey);
    for (&table, rows) in &found {
        let own = |one: &&(RecordEntry, i64)| tables.get(&one.0.layout.into()) == Some(&table);
        let records: Vec<_> = records.iter().filter(own).collect();
        assert_eq!(rows.num_rows(), records.len());
        let times = rows.column(0).as_primitive::<TimestampMicrosecondType>();
        for (row, (_, time)) in records.iter().enumerate() {
            assert_eq!(times.is_valid(row), survey.clock.is_some());
            assert!(times.is_null(row) || times.value(row) == *time);
        }
        // With several descriptions a column is not that of the field at its place.
        let mut layouts = survey.layouts_of(table.into());
        if let (Some((_, layout)), None) = (layouts.next(), layouts.next())
            && !options.si
        {
            same_values(layout, rows, &records, &bytes);
        }
    }
    let in_tables = records.iter().filter(|one| tables.contains_key(&one.0.layout.into()));
    let rows: usize = found.values().map(RecordBatch::num_rows).sum();
    assert_eq!(rows, in_tables.count());
    summarised(&survey, &bytes, records.len(), bad);
}

/// Records with their times, and how many bytes belong to none.
fn one_by_one(
    survey: &Survey,
    definitions: &Definitions,
    bytes: &[u8],
) -> (Vec<(RecordEntry, i64)>, u64) {
    let mut newest = survey.clock.map_or(0, |clock| clock.first);
    let mut records = Vec::new();
    let (end, junk) = index(bytes, 0, usize::MAX, definitions, true, |entry, record| {
        let layout = &definitions.layouts()[usize::from(entry.layout)];
        let count = |field, times| layout.count(field, &record[HEAD_LEN..], times);
        newest =
            survey.clock.map_or(newest, |clock| clock.stamp(clock.rule(layout), newest, count));
        records.push((entry, newest));
    });
    assert_eq!(end, bytes.len());
    (records, junk)
}

fn same_values(layout: &Layout, rows: &RecordBatch, records: &[&(RecordEntry, i64)], bytes: &[u8]) {
    assert_eq!(rows.num_columns(), 1 + layout.fields.len());
    for (at, field) in layout.fields.iter().enumerate() {
        let column = rows.column(1 + at);
        for (row, (entry, _)) in records.iter().enumerate() {
            let record = &bytes[entry.offset as usize..][..usize::from(entry.len)];
            let body = &record[HEAD_LEN..];
            let name = (&layout.name, &field.name);
            match layout.value(at, body).expect("a value") {
                Value::Text(raw) if layout.name == "FILE" && raw.len() == 64 => {
                    assert_eq!(column.as_binary::<i32>().value(row), raw, "{name:?}");
                }
                Value::Text(raw) => {
                    let end = raw.iter().position(|&byte| byte == 0).unwrap_or(raw.len());
                    let text = decode_line(&raw[..end]);
                    assert_eq!(column.as_string::<i32>().value(row), text, "{name:?}");
                }
                value => {
                    let expected = expected(layout, at, body, value);
                    assert!(same(&numbers(column, row), &expected), "{name:?}");
                }
            }
        }
    }
}

/// The numbers of a field in the type of its column.
fn expected(layout: &Layout, at: usize, body: &[u8], value: Value<'_>) -> Vec<Number> {
    let kind = layout.fields[at].kind;
    let unsigned = [FieldKind::U8, FieldKind::U16, FieldKind::U32, FieldKind::U64];
    let number = match value {
        _ if kind.scale().is_some() => Number::Float(layout.number(at, body).expect("a number")),
        Value::Integer(number) if unsigned.contains(&kind) => {
            Number::Unsigned(number.try_into().expect("not negative"))
        }
        Value::Integer(number) => Number::Signed(number),
        Value::Unsigned(number) => Number::Unsigned(number),
        Value::Float(number) if kind == FieldKind::F16 => Number::Float((number as f32).into()),
        Value::Float(number) => Number::Float(number),
        Value::Array(raw) => {
            let each = raw.chunks_exact(2).map(|two| i16::from_le_bytes([two[0], two[1]]));
            return each.map(|number| Number::Signed(number.into())).collect();
        }
        Value::Text(_) => unreachable!("a text is no number"),
    };
    vec![number]
}

/// The counts of a summary are those of the records.
pub(crate) fn summarised(survey: &Arc<Survey>, bytes: &[u8], records: usize, bad: u64) {
    let open = || Ok(source(bytes));
    let sum = summary(survey, &open, 1_000_000, |_| Ok::<_, Error>(()));
    let sum = sum.expect("memory does not fail");
    let by_table: u64 = sum.types.iter().map(|count| count.messages).sum();
    assert_eq!(
        (sum.count.messages, by_table + sum.unknown.unlisted),
        (records as u64, records as u64)
    );
    assert_eq!((sum.bytes, sum.bad_bytes), (bytes.len() as u64, bad));
}
