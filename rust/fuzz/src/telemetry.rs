//! Telemetry logs: many processors find what one finds, columns hold what messages hold, copies hold what was good.

use std::io::Cursor;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

use mavwire_columns::arrow::array::{Array, AsArray, RecordBatch};
use mavwire_columns::arrow::compute::cast;
use mavwire_columns::arrow::datatypes::{DataType, Float64Type};
use mavwire_columns::convert::{Compression, Format, Sink};
use mavwire_columns::layout::{Layout, Options, Source};
use mavwire_columns::rewrite::{Merge, Rewrite};
use mavwire_columns::scan::{Framing, LogScanner, UNKNOWN};
use mavwire_columns::select::{Grouped, Wanted};
use mavwire_columns::table::{Found, TableBuilder};
use mavwire_core::anonymize::{Anonymizer, Shift};
use mavwire_core::codec::{Number, number};
use mavwire_core::frame::FrameRef;
use mavwire_core::log::tlog::{FoundRecord, RecordScanner};

use crate::dialects::ALL;
use crate::input::Input;

/// Where records and bytes that belong to none are.
#[derive(Debug, Default, PartialEq, Eq)]
struct Places {
    records: Vec<(usize, u16)>,
    bad: Vec<Range<usize>>,
}

impl Places {
    fn add_bad(&mut self, range: Range<usize>) {
        match self.bad.last_mut().filter(|last| last.end == range.start) {
            Some(last) => last.end = range.end,
            None => self.bad.push(range),
        }
    }
}

/// By one scanner over the whole.
fn sequential(bytes: &[u8], framing: Framing) -> Places {
    let mut scanner = match framing {
        Framing::Stamped => RecordScanner::new(),
        Framing::Raw => RecordScanner::unstamped(),
    };
    let (mut places, mut at) = (Places::default(), 0);
    loop {
        at += match scanner.next(&bytes[at..], &ALL, true) {
            FoundRecord::Record { len, entry, .. } => {
                places.records.push((at, entry.map_or(UNKNOWN, |entry| entry.index)));
                len
            }
            FoundRecord::Junk { len } => {
                places.add_bad(at..at + len);
                len
            }
            FoundRecord::Incomplete { .. } => {
                assert_eq!(at, bytes.len());
                return places;
            }
        }
    }
}

/// Block by block, in stretches.
fn parallel(bytes: &[u8], framing: Framing, block: usize, stretch: usize) -> Places {
    let mut scanner = LogScanner::new(Arc::clone(&ALL), framing).with_stretch(stretch);
    let (mut places, mut start, mut end) = (Places::default(), 0, 0);
    loop {
        let at_end = end == bytes.len();
        end = (end + block).min(bytes.len());
        let found = scanner.scan(&bytes[start..end], at_end);
        places.records.extend(found.records.iter().map(|r| (start + r.at as usize, r.index)));
        for bad in found.bad {
            places.add_bad(start + bad.start..start + bad.end);
        }
        start += found.consumed;
        if at_end {
            return places;
        }
    }
}

fn framing_of(byte: u8) -> Framing {
    if byte % 2 == 0 { Framing::Stamped } else { Framing::Raw }
}

/// Any bytes as a log, in any blocks and stretches.
pub fn tlog(data: &[u8]) {
    let mut input = Input::new(data);
    let framing = framing_of(input.byte());
    let (block, stretch) = (usize::from(input.number()) + 1, usize::from(input.number()) + 1);
    let bytes = input.rest();
    let _ = Framing::of(bytes, &ALL);
    // Blocks of a few bytes are a step each: so many are enough.
    let block = block.max(bytes.len() / 256);
    let stretch = stretch.max(bytes.len() / 256);
    assert_eq!(parallel(bytes, framing, block, stretch), sequential(bytes, framing));
}

/// The tables of a log, by message index.
fn tables(
    bytes: &[u8],
    framing: Framing,
    options: &Options,
) -> Vec<(u16, Arc<Layout>, RecordBatch)> {
    let scanned = LogScanner::new(Arc::clone(&ALL), framing).scan(bytes, true);
    let count = ALL.dialect().messages.len();
    let grouped = Grouped::new(bytes, framing, &scanned, &Wanted::default(), count);
    let mut tables = Vec::new();
    for index in (0..count).filter(|&index| !grouped.of(index).is_empty()) {
        let layout = Arc::new(Layout::new(&ALL, index as u16, framing, options));
        let mut table = TableBuilder::new(Arc::clone(&layout));
        table.append(Found { block: bytes, scanned: &scanned }, grouped.of(index));
        tables.push((index as u16, layout, table.take().expect("a table")));
    }
    tables
}

fn as_float(number: Number) -> f64 {
    match number {
        Number::Unsigned(n) => n as f64,
        Number::Signed(n) => n as f64,
        Number::Float(n) => n,
    }
}

/// Columns hold what the messages hold, row by row.
pub fn columns(data: &[u8]) {
    let mut input = Input::new(data);
    let framing = framing_of(input.byte());
    let bytes = input.rest();
    let places = sequential(bytes, framing);
    for (index, layout, batch) in tables(bytes, framing, &Options::default()) {
        let frames: Vec<FrameRef<'_>> = places
            .records
            .iter()
            .filter(|&&(_, of)| of == index)
            .map(|&(at, _)| frame_at(bytes, at + framing.lead()))
            .collect();
        assert_eq!(batch.num_rows(), frames.len());
        for (column, values) in layout.columns.iter().zip(batch.columns()) {
            assert_eq!(values.len(), frames.len());
            let Source::Numbers(field) = &column.source else { continue };
            if field.is_numeric_array() {
                continue;
            }
            let values = cast(values, &DataType::Float64).expect("numbers");
            for (value, frame) in values.as_primitive::<Float64Type>().values().iter().zip(&frames)
            {
                let of = number(field.field_type, frame.payload(), field.offset.into());
                let same = as_float(of).to_bits() == value.to_bits();
                assert!(same || (value.is_nan() && as_float(of).is_nan()), "{}", column.name);
            }
        }
    }
}

fn frame_at(bytes: &[u8], at: usize) -> FrameRef<'_> {
    let len = mavwire_core::frame::claimed_len(&bytes[at..]).expect("a frame");
    FrameRef::parse(&bytes[at..at + len]).expect("a frame")
}

/// Tables as files of each format.
pub fn convert(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    let options = Options { si: flags & 4 != 0, enum_names: flags & 8 != 0, columns: None };
    let formats = [Format::Csv, Format::JsonLines, Format::Arrow, Format::Parquet];
    let format = formats[usize::from(flags / 16 % 4)];
    let framing = framing_of(flags);
    for (_, layout, batch) in tables(input.rest(), framing, &options).iter().take(4) {
        let sink = Sink::new(Vec::new(), &layout.schema, format, Compression::None);
        let mut sink = sink.expect("a file");
        sink.write(batch).expect("rows");
        assert_eq!(sink.rows(), batch.num_rows() as u64);
        assert!(!sink.finish().expect("a whole file").is_empty());
    }
}

static ANONYMIZER: LazyLock<Anonymizer> =
    LazyLock::new(|| Anonymizer::new(ALL.dialect(), Shift { latitude: 1.5, longitude: -2.5 }));

/// What is repaired, made anonymous or merged is a log without damage, of as many records as were counted.
pub fn rewrite(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    let bytes = input.rest();
    let source = |bytes: &[u8]| Box::new(Cursor::new(bytes.to_vec())) as _;
    if is_compressed(bytes) {
        return;
    }
    let mut out = Vec::new();
    let (written, framing) = if flags % 4 == 3 {
        let (one, other) = bytes.split_at(bytes.len() / 2);
        if is_compressed(other) {
            return;
        }
        let sources = vec![source(one), source(other)];
        let Ok(mut merge) = Merge::new(sources, &ALL).expect("no file") else { return };
        while merge.advance(&mut out).expect("memory") {}
        (merge.outcome().written, Framing::Stamped)
    } else {
        let anonymizer = (flags % 2 == 1).then(|| ANONYMIZER.clone());
        let mut rewrite =
            Rewrite::new(source(bytes), Arc::clone(&ALL), Wanted::default(), anonymizer)
                .expect("no file");
        while rewrite.advance(&mut out).expect("memory") {}
        (rewrite.outcome().written, rewrite.framing())
    };
    let again = sequential(&out, framing);
    assert!(again.bad.is_empty(), "{:?}", again.bad);
    assert_eq!(again.records.len() as u64, written);
}

/// Whether it is read as a compressed file.
pub(crate) fn is_compressed(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1F, 0x8B]) || bytes.starts_with(&[0x28, 0xB5, 0x2F, 0xFD])
}
