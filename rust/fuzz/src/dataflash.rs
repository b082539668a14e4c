//! Dataflash logs, binary and text.

use mavwire_core::log::dataflash::text::{
    Delimiter, TextDefinitions, decode_line, nth_value, text_values,
};
use mavwire_core::log::dataflash::{Definitions, HEAD_LEN, LOOK_LEN, RecordEntry, index};

use crate::input::Input;

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
            let _ = (layout.number(field, body), layout.count(field, body, 1000));
        }
    });
    assert_eq!(end, bytes.len());
    let covered: usize = whole.iter().map(|entry| usize::from(entry.len)).sum();
    assert_eq!(covered as u64 + junk, bytes.len() as u64);
    // Behind its limit a stretch sees all that decides.
    let cut = cut % (bytes.len() + 1);
    let first = bytes.len().min(cut + LOOK_LEN);
    let mut parts = Vec::new();
    let last = first == bytes.len();
    let (at, _) = index(&bytes[..first], 0, cut, &definitions, last, |entry, _| parts.push(entry));
    index(&bytes[at..], at as u64, usize::MAX, &definitions, true, |entry, _| parts.push(entry));
    assert_eq!(parts, whole);
}

/// Lines of a text log, and the values in them.
pub fn dataflash_text(data: &[u8]) {
    let delimiter = Delimiter::of(data);
    let mut definitions = TextDefinitions::new(delimiter);
    let mut at = 0;
    for line in data.split(|&byte| byte == b'\n') {
        definitions.collect(line, at);
        if let Some(layout) = definitions.of_line(line, at) {
            let layout = &definitions.layouts()[usize::from(layout)];
            let text = decode_line(line);
            let found = text_values(&text, delimiter, &layout.name);
            for (column, value) in found.iter().enumerate() {
                let bytes = nth_value(line, delimiter, column);
                assert!(bytes.is_some() || layout.name == "FMT", "{value}");
            }
        }
        at += line.len() as u64 + 1;
    }
}
