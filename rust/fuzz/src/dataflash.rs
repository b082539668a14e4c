//! Dataflash logs, binary and text.

use std::io::{Cursor, Read};
use std::sync::Arc;

use mavwire_columns::dataflash::{Reader, Survey, Wanted};
use mavwire_columns::error::Error;
use mavwire_columns::input::decompressed;
use mavwire_columns::layout::Options;
use mavwire_columns::reader::{Decode, Limits};
use mavwire_core::log::dataflash::text::{
    Delimiter, TextDefinitions, decode_line, nth_value, values,
};
use mavwire_core::log::dataflash::{Definitions, HEAD_LEN, MAX_RECORD_LEN, RecordEntry, index};

use crate::input::Input;
use crate::telemetry::is_compressed;

/// Records of a binary log: in two stretches the same as in one, every value of them readable.
pub fn dataflash(data: &[u8]) {
    let mut input = Input::new(data);
    let cut = usize::from(input.number());
    let bytes = input.rest();
    let mut definitions = Definitions::new();
    definitions.collect(bytes, 0);
    let mut whole: Vec<RecordEntry> = Vec::new();
    let (end, junk) = index(bytes, 0, usize::MAX, &definitions, true, |entry, record| {
        assert_eq!(record.len(), usize::from(entry.len));
        whole.push(entry);
        let layout = &definitions.layouts()[usize::from(entry.layout)];
        let body = &record[HEAD_LEN..];
        for field in 0..layout.fields.len() {
            let _ = (layout.value(field, body), layout.count(field, body));
        }
        let _ = layout.seconds(body);
    });
    assert_eq!(end, bytes.len());
    let covered: usize = whole.iter().map(|entry| usize::from(entry.len)).sum();
    assert_eq!(covered as u64 + junk, bytes.len() as u64);
    // A stretch is told of so many bytes behind its limit.
    let cut = cut % (bytes.len() + 1);
    let first = bytes.len().min(cut + MAX_RECORD_LEN + 2);
    let mut parts = Vec::new();
    let last = first == bytes.len();
    let (at, _) = index(&bytes[..first], 0, cut, &definitions, last, |entry, _| parts.push(entry));
    index(&bytes[at..], at as u64, usize::MAX, &definitions, true, |entry, _| parts.push(entry));
    assert_eq!(parts, whole);
}

/// Lines of a text log, and what columns are made of them.
pub fn dataflash_text(data: &[u8]) {
    let delimiter = Delimiter::of(data);
    let mut definitions = TextDefinitions::new(delimiter);
    let mut at = 0;
    for line in data.split(|&byte| byte == b'\n') {
        definitions.collect(line, at);
        if let Some(layout) = definitions.of_line(line, at) {
            let layout = &definitions.layouts()[usize::from(layout)];
            let text = decode_line(line);
            let found = values(&text, delimiter, &layout.name);
            for (column, value) in found.iter().enumerate() {
                let bytes = nth_value(line, delimiter, column);
                assert!(bytes.is_some() || layout.name == "FMT", "{value}");
            }
        }
        at += line.len() as u64 + 1;
    }
}

/// Columns of any bytes that are a dataflash log.
pub fn dataflash_columns(data: &[u8]) {
    if is_compressed(data) {
        return;
    }
    let open = || Ok(Box::new(Cursor::new(data.to_vec())) as Box<dyn Read + Send>);
    let survey = Survey::read::<Error>(&open, || Ok(())).expect("no file");
    let Some(survey) = survey.map(Arc::new) else { return };
    let wanted = Wanted { names: None, start: f64::NEG_INFINITY, end: f64::INFINITY };
    let options = Options { si: true, ..Options::default() };
    let reader = Reader::new(survey, &open, wanted, &options, Limits { rows: 100, ..Limits::NONE });
    let mut reader = reader.expect("no file");
    while let Some(batches) = reader.advance().expect("tables") {
        assert!(batches.iter().all(|batch| batch.rows.num_rows() > 0));
    }
    assert!(reader.position() <= data.len() as u64 && reader.bad_bytes() <= reader.position());
}

/// Compressed bytes, damaged or not: an end or an error.
pub fn compressed(data: &[u8]) {
    let source = Box::new(Cursor::new(data.to_vec()));
    let Ok(source) = decompressed(source) else { return };
    let mut out = Vec::new();
    let read = source.take(1 << 20).read_to_end(&mut out);
    if !is_compressed(data) {
        read.expect("bytes as they are");
        assert_eq!(out, &data[..data.len().min(1 << 20)]);
    }
}
