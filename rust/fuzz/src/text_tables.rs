//! Dataflash logs in their text form as tables: they hold the values of the lines.

use mavwire_columns::arrow::array::{Array, AsArray, RecordBatch};
use mavwire_columns::arrow::datatypes::TimestampMicrosecondType;
use mavwire_columns::dataflash::{Form, Survey};
use mavwire_core::log::dataflash::text::{
    MAX_LINE_LEN, TextDefinitions, decode_line, mark_len, nth_value, number, trimmed,
};
use mavwire_core::log::dataflash::{FieldKind, Layout, whole};

use crate::dataflash_tables::{ReadLog, in_any_steps, summarised, table_of_layout};
use crate::input::Input;
use crate::logs::any_text_log;

/// A line that is a record: its layout, its time, and the line.
type Record<'a> = (u16, i64, &'a [u8]);

/// Any log, in any steps.
pub fn text_tables(data: &[u8]) {
    let read = in_any_steps(&mut Input::new(data), any_text_log);
    let Some(ReadLog { bytes, survey, options, tables: found, bad }) = read else { return };
    let Form::Text(definitions) = &survey.form else { return };
    let (records, unused) = one_by_one(&survey, definitions, &bytes);
    assert_eq!(bad, unused);
    let tables = table_of_layout(&survey);
    for (&table, rows) in &found {
        let own = |one: &&Record<'_>| tables.get(&one.0.into()) == Some(&table);
        let records: Vec<&Record<'_>> = records.iter().filter(own).collect();
        assert_eq!(rows.num_rows(), records.len());
        let times = rows.column(0).as_primitive::<TimestampMicrosecondType>();
        for (row, (_, time, _)) in records.iter().enumerate() {
            assert_eq!(times.is_valid(row), survey.clock.is_some());
            assert!(times.is_null(row) || times.value(row) == *time);
        }
        let mut layouts = survey.layouts_of(table.into());
        if let (Some((_, layout)), None) = (layouts.next(), layouts.next())
            && layout.name != "FMT"
            && !options.si
        {
            same_values(definitions, layout, rows, &records);
        }
    }
    let rows: usize = found.values().map(RecordBatch::num_rows).sum();
    assert_eq!(rows, records.iter().filter(|one| tables.contains_key(&one.0.into())).count());
    summarised(&survey, &bytes, records.len(), bad);
}

/// The records, and how many bytes of lines belong to none.
fn one_by_one<'a>(
    survey: &Survey,
    definitions: &TextDefinitions,
    bytes: &'a [u8],
) -> (Vec<Record<'a>>, u64) {
    let mut newest = survey.clock.map_or(0, |clock| clock.first);
    let mark = mark_len(bytes);
    let (mut records, mut bad, mut at) = (Vec::new(), 0, mark as u64);
    for with_end in bytes[mark..].split_inclusive(|&byte| byte == b'\n') {
        let whole_line = with_end.strip_suffix(b"\n").unwrap_or(with_end);
        let line = trimmed(whole_line);
        let is_ended = whole_line.len() < with_end.len();
        let layout = definitions.of_line(line, at);
        let layout = layout.filter(|_| is_ended && whole_line.len() < MAX_LINE_LEN);
        at += with_end.len() as u64;
        let Some(layout) = layout else {
            bad += if line.is_empty() { 0 } else { with_end.len() as u64 };
            continue;
        };
        let of = &definitions.layouts()[usize::from(layout)];
        let text = |field| nth_value(line, definitions.delimiter(), field);
        let count = |field: usize, times: i64| {
            whole(number(of.fields[field].kind, text(field)?)? * times as f64)
        };
        newest = survey.clock.map_or(newest, |clock| clock.stamp(clock.rule(of), newest, count));
        records.push((layout, newest, line));
    }
    (records, bad)
}

fn same_values(
    definitions: &TextDefinitions,
    layout: &Layout,
    rows: &RecordBatch,
    records: &[&Record<'_>],
) {
    assert_eq!(rows.num_columns(), 1 + layout.fields.len());
    for (at, field) in layout.fields.iter().enumerate() {
        let column = rows.column(1 + at);
        for (row, (_, _, line)) in records.iter().enumerate() {
            let raw = nth_value(line, definitions.delimiter(), at).expect("a whole line");
            let number = std::str::from_utf8(raw).ok().map(str::trim);
            match field.kind {
                FieldKind::Text(_) | FieldKind::Array | FieldKind::Mode => {
                    assert_eq!(column.as_string::<i32>().value(row), decode_line(raw));
                }
                kind if kind.is_float() => {
                    use mavwire_columns::arrow::datatypes::Float64Type;
                    let expected = number.and_then(|text| text.parse::<f64>().ok());
                    let column = column.as_primitive::<Float64Type>();
                    let found = column.is_valid(row).then(|| column.value(row));
                    assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits));
                }
                kind => {
                    let expected = number.and_then(|text| text.parse::<i128>().ok());
                    let fits = expected.filter(|number| range(kind).contains(number));
                    let found = column.is_valid(row).then(|| integer(column, row));
                    assert_eq!(found, fits, "{kind:?}");
                }
            }
        }
    }
}

/// The numbers that a column can hold.
fn range(kind: FieldKind) -> std::ops::RangeInclusive<i128> {
    let bits = 8 * kind.size() as u32;
    match kind {
        FieldKind::U8 | FieldKind::U16 | FieldKind::U32 | FieldKind::U64 => 0..=(1 << bits) - 1,
        _ => -(1 << (bits - 1))..=(1 << (bits - 1)) - 1,
    }
}

fn integer(column: &dyn Array, row: usize) -> i128 {
    use mavwire_core::codec::Number;
    match crate::tables::numbers(column, row)[..] {
        [Number::Unsigned(number)] => number.into(),
        [Number::Signed(number)] => number.into(),
        ref other => panic!("{other:?} is no integer"),
    }
}
