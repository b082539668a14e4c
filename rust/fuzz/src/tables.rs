//! Telemetry logs as tables: they hold what one scanner finds and the codec reads, record by record.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use mavwire_columns::arrow::array::{Array, AsArray, RecordBatch};
use mavwire_columns::arrow::datatypes::{
    DataType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type,
    TimestampMicrosecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use mavwire_columns::error::Error;
use mavwire_columns::input::Steps;
use mavwire_columns::layout::{Invalid, Options};
use mavwire_columns::reader::{Limits, Plan, reader};
use mavwire_columns::scan::Framing;
use mavwire_columns::summary::Summary;
use mavwire_core::codec::{Number, number, text_bytes};
use mavwire_core::frame::{FrameRef, Header};
use mavwire_core::log::tlog::FoundRecord;
use mavwire_core::telemetry::{StreamClock, TextFields};
use mavwire_schema::Message;

use crate::dialects::ALL;
use crate::input::Input;
use crate::logs::any_telemetry;
use crate::reading::{
    looks_compressed, on_threads, small_limits, small_steps, source, whole_tables,
};

/// Behind damage, a time further than this from the one before it, and from what its stamp said, is not believed,
const BELIEVED: u64 = 3 * 24 * 3600 * 1_000_000;

/// but for one from 2000 to 2100 where the one before is none.
const DATES: Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;

/// A record, as the way of messages has it.
pub(crate) struct Record {
    pub(crate) time: u64,
    /// The time stamp directly behind; 0 where the log ends before.
    behind: u64,
    /// It has a time: of a raw stream, once the clock is known.
    is_timed: bool,
    pub(crate) header: Header,
    pub(crate) frame: Vec<u8>,
    /// Index of its message; `None` for an id that nobody knows.
    pub(crate) index: Option<u16>,
}

impl Record {
    pub(crate) fn payload(&self) -> &[u8] {
        FrameRef::parse(&self.frame).expect("a frame").payload()
    }
}

/// The records in the order of the log, by one scanner over all of it, and how many bytes belong to none.
pub(crate) fn one_by_one(bytes: &[u8], framing: Framing) -> (Vec<Record>, u64) {
    let mut scanner = framing.scanner();
    let (mut records, mut bad, mut at) = (Vec::<Record>::new(), 0, 0);
    let (mut after_damage, mut said) = (false, 0);
    let mut clock = StreamClock::default();
    loop {
        match scanner.next(&bytes[at..], &ALL, true) {
            FoundRecord::Record { len, stamp, header, entry } => {
                let frame =
                    FrameRef::parse(&bytes[at + framing.lead()..at + len]).expect("a frame");
                let (stamp, mut time) = (stamp.micros(), stamp.micros());
                if let Some(last) =
                    records.last().filter(|_| after_damage && framing == Framing::Stamped)
                    && [last.time, said].iter().all(|one| stamp.abs_diff(*one) >= BELIEVED)
                    && (DATES.contains(&last.time) || !DATES.contains(&stamp))
                {
                    time = last.time;
                }
                (after_damage, said) = (false, stamp);
                let (frame, index) = (frame.bytes().to_vec(), entry.map(|entry| entry.index));
                let now = clock.hear(&ALL, index.unwrap_or(u16::MAX), &frame);
                let is_timed = framing == Framing::Stamped || now.is_some();
                if framing == Framing::Raw {
                    time = now.unwrap_or(0);
                }
                at += len;
                let behind =
                    bytes[at..].first_chunk().map_or(0, |stamp| u64::from_be_bytes(*stamp));
                records.push(Record { time, behind, is_timed, header, frame, index });
            }
            FoundRecord::Junk { len } => {
                (bad, after_damage, at) = (bad + len as u64, true, at + len);
            }
            FoundRecord::Incomplete { .. } => return (records, bad),
        }
    }
}

/// Records with the time in front where both neighbours contradict the own one.
pub(crate) fn mended(mut records: Vec<Record>, framing: Framing) -> Vec<Record> {
    let are_near = |one: u64, other: u64| one.abs_diff(other) < BELIEVED;
    let mut before = None;
    for record in records.iter_mut().filter(|_| framing == Framing::Stamped) {
        let time = *before.get_or_insert(record.time);
        if DATES.contains(&record.behind)
            && are_near(time, record.behind)
            && !are_near(record.time, time)
            && !are_near(record.time, record.behind)
        {
            record.time = time;
        }
        before = Some(record.time);
    }
    records
}

fn tables_of(
    steps: Steps,
    limits: Limits,
    bytes: &[u8],
    framing: Framing,
    options: &Options,
) -> (BTreeMap<u16, RecordBatch>, u64) {
    let plan = Plan { options: options.clone(), limits, ..Plan::default() };
    let reader = reader(steps, source(bytes), Some(framing), Arc::clone(&ALL), plan);
    let mut reader = reader.expect("memory does not fail");
    let tables = whole_tables(&mut *reader);
    assert_eq!(reader.position(), bytes.len() as u64);
    (tables, reader.bad_bytes())
}

/// Any log, in any steps on one thread and at once on several.
pub fn tables(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    let framing = if flags & 1 == 0 { Framing::Stamped } else { Framing::Raw };
    let options = Options {
        si: flags & 2 != 0,
        enum_names: flags & 4 != 0,
        invalid: if flags & 8 == 0 { Invalid::Keep } else { Invalid::Null },
        ..Options::default()
    };
    let (steps, limits) = (small_steps(&mut input, 1), small_limits(&mut input));
    let bytes = any_telemetry(input, framing.lead());
    let (found, bad) = on_threads(false, || tables_of(steps, limits, &bytes, framing, &options));
    let at_once =
        on_threads(true, || tables_of(Steps::default(), Limits::NONE, &bytes, framing, &options));
    assert_eq!((&found, bad), (&at_once.0, at_once.1), "steps and threads");
    let (records, unused) = one_by_one(&bytes, framing);
    assert_eq!(bad, unused);
    let of = |index: u16| records.iter().filter(move |one| one.index == Some(index));
    // Of which several records may make a row.
    let is_text = |index: u16| TextFields::of(ALL.message(index)).is_some();
    let known = records.iter().filter(|record| record.index.is_some_and(|one| !is_text(one)));
    let tables = || found.iter().filter(|&(&index, _)| !is_text(index));
    assert_eq!(tables().map(|(_, rows)| rows.num_rows()).sum::<usize>(), known.count());
    for (&index, rows) in tables() {
        let records: Vec<&Record> = of(index).collect();
        assert_eq!(rows.num_rows(), records.len());
        same_senders(rows, &records);
        if !options.si && !options.enum_names && options.invalid == Invalid::Keep {
            same_values(ALL.message(index), rows, &records);
        }
    }
    if !looks_compressed(&bytes) {
        summarised(&bytes);
    }
}

fn same_senders(rows: &RecordBatch, records: &[&Record]) {
    let times = rows.column(0).as_primitive::<TimestampMicrosecondType>();
    let ids = [1, 2, 3].map(|at| rows.column(at).as_primitive::<UInt8Type>());
    for (row, Record { time, is_timed, header, .. }) in records.iter().enumerate() {
        let time = is_timed.then(|| i64::try_from(*time).unwrap_or(i64::MAX));
        assert_eq!(times.is_valid(row).then(|| times.value(row)), time);
        let sender = [header.sysid, header.compid, header.seq];
        assert_eq!(ids.map(|ids| ids.value(row)), sender);
    }
}

/// Each value is what the codec reads from the payload.
fn same_values(message: &Message, rows: &RecordBatch, records: &[&Record]) {
    let mut columns = rows.columns()[4..].iter();
    for field in &message.fields {
        let column = columns.next().expect("a column");
        if field.is_char() {
            let (texts, raw) = (column.as_string::<i32>(), columns.next().expect("the bytes"));
            let raw = raw.as_binary::<i32>();
            for (row, record) in records.iter().enumerate() {
                let sent = text_bytes(field, record.payload());
                let end = sent.iter().position(|&byte| byte == 0).unwrap_or(sent.len());
                let text = String::from_utf8_lossy(&sent[..end]);
                assert_eq!(texts.value(row), text);
                assert_eq!(raw.is_null(row), text.as_bytes() == sent);
                assert!(raw.is_null(row) || raw.value(row) == sent);
            }
            continue;
        }
        for (row, record) in records.iter().enumerate() {
            let place = |n| usize::from(field.offset) + n * field.field_type.size();
            let read = |n| number(field.field_type, record.payload(), place(n));
            let expected: Vec<Number> = (0..field.elements()).map(read).collect();
            assert!(same(&numbers(column, row), &expected), "{}.{}", message.name, field.name);
        }
    }
    assert!(columns.next().is_none());
}

/// Not-a-number is the same as itself, bit by bit.
pub(crate) fn same(one: &[Number], other: &[Number]) -> bool {
    one.len() == other.len()
        && one.iter().zip(other).all(|pair| match pair {
            (Number::Float(one), Number::Float(other)) => one.to_bits() == other.to_bits(),
            (one, other) => one == other,
        })
}

/// The numbers of a row, of an array field several.
pub(crate) fn numbers(column: &dyn Array, row: usize) -> Vec<Number> {
    if let Some(lists) = column.as_fixed_size_list_opt() {
        let list = lists.value(row);
        return (0..list.len()).map(|at| number_at(&list, at)).collect();
    }
    vec![number_at(column, row)]
}

fn number_at(column: &dyn Array, row: usize) -> Number {
    macro_rules! value {
        ($kind:ident, $arrow:ty) => {
            Number::$kind(column.as_primitive::<$arrow>().value(row).into())
        };
    }
    match column.data_type() {
        DataType::UInt8 => value!(Unsigned, UInt8Type),
        DataType::UInt16 => value!(Unsigned, UInt16Type),
        DataType::UInt32 => value!(Unsigned, UInt32Type),
        DataType::UInt64 => value!(Unsigned, UInt64Type),
        DataType::Int8 => value!(Signed, Int8Type),
        DataType::Int16 => value!(Signed, Int16Type),
        DataType::Int32 => value!(Signed, Int32Type),
        DataType::Int64 => value!(Signed, Int64Type),
        DataType::Float32 => value!(Float, Float32Type),
        DataType::Float64 => value!(Float, Float64Type),
        other => panic!("{other} is no number"),
    }
}

/// The counts of a summary are those of the records.
fn summarised(bytes: &[u8]) {
    let registry = Arc::clone(&ALL);
    let sum = Summary::read(source(bytes), registry, 1_000_000, |_| Ok::<_, Error>(()));
    let sum = sum.expect("memory does not fail");
    assert_eq!((sum.bytes, sum.damage), (bytes.len() as u64, None));
    let framing = if sum.stamped { Framing::Stamped } else { Framing::Raw };
    let (records, bad) = one_by_one(bytes, framing);
    assert_eq!((sum.count.messages, sum.bad_bytes), (records.len() as u64, bad));
    let by_type: u64 = sum.types.iter().map(|count| count.messages).sum();
    let unknown: u64 = sum.unknown.listed.values().map(|count| count.messages).sum();
    assert_eq!(by_type + unknown + sum.unknown.unlisted, sum.count.messages);
    for (&(sysid, compid), sender) in &sum.senders {
        let own = |one: &&Record| (one.header.sysid, one.header.compid) == (sysid, compid);
        assert_eq!(sender.count.messages, records.iter().filter(own).count() as u64);
        let repeated = sender.repeated;
        assert!(
            repeated < sender.count.messages && sender.clocks.reboots() < sender.count.messages
        );
    }
}
