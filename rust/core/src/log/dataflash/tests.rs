//! Tests of the binary and the text form.

use super::Value::{Float, Integer, Text, Unsigned};
use super::*;

fn fmt(type_id: u8, len: u8, name: &str, format: &str, columns: &str) -> Vec<u8> {
    let mut record = vec![HEAD[0], HEAD[1], FMT_TYPE, type_id, len];
    for (text, size) in [(name, 4), (format, 16), (columns, 64)] {
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(size, 0);
        record.extend(bytes);
    }
    record
}

fn record(type_id: u8, body: &[u8]) -> Vec<u8> {
    [&HEAD[..], &[type_id], body].concat()
}

fn all(log: &[u8]) -> (Vec<(u64, String)>, u64) {
    let mut definitions = Definitions::new();
    definitions.collect(log, 0);
    let mut records = Vec::new();
    let (end, junk) = index(log, 0, usize::MAX, &definitions, true, |entry, _| {
        let layout = &definitions.layouts()[usize::from(entry.layout)];
        records.push((entry.offset, layout.name.clone()));
    });
    assert_eq!(end, log.len());
    (records, junk)
}

fn sample() -> Vec<u8> {
    let mut log = fmt(1, 5, "A", "BB", "X,Y");
    log.extend(fmt(2, 11, "B", "Q", "TimeUS"));
    for number in 0..20 {
        log.extend(record(1, &[number, 7]));
        log.extend(record(2, &u64::from(number).to_le_bytes()));
    }
    log
}

#[test]
fn every_cut_leaves_the_records_around_it() {
    let log = sample();
    let (whole, junk) = all(&log);
    assert_eq!((whole.len(), junk), (42, 0));
    for from in 178..log.len() {
        // Not as many as the records that follow have: then what is left looks like a whole record.
        for gone in [1, 2, 3, 4, 7, 9] {
            let to = (from + gone).min(log.len());
            let cut = [&log[..from], &log[to..]].concat();
            let (left, _) = all(&cut);
            for (offset, name) in &whole {
                let len = if name == "A" { 5 } else { 11 };
                let (start, end) = (*offset as usize, *offset as usize + len);
                let place = if start >= to { offset - (to - from) as u64 } else { *offset };
                if name != "FMT" && (end <= from || start >= to) {
                    assert!(left.contains(&(place, name.clone())), "{offset} without {from}..{to}");
                }
            }
        }
    }
}

#[test]
fn any_stretches_give_the_same_index() {
    let mut log = sample();
    log.splice(190..193, []);
    log.splice(260..260, [0, HEAD[0], HEAD[1], 99, 1]);
    let mut definitions = Definitions::new();
    definitions.collect(&log, 0);
    let mut whole = Vec::new();
    let (_, junk) = index(&log, 0, usize::MAX, &definitions, true, |entry, _| whole.push(entry));
    for stretch in [1, 2, 7, 64, 300] {
        let (mut at, mut pieces, mut gone) = (0, Vec::new(), 0);
        while at < log.len() {
            let end = (at + stretch + LOOK_LEN).min(log.len());
            let bytes = &log[at..end];
            let push = |entry, _: &[u8]| pieces.push(entry);
            let last = end == log.len();
            let (next, junk) = index(bytes, at as u64, stretch, &definitions, last, push);
            assert!(next > 0);
            at += next;
            gone += junk;
        }
        assert_eq!((&pieces, gone), (&whole, junk), "stretches of {stretch}");
    }
}

#[test]
fn what_is_passed_over_is_what_a_look_at_each_record_would_leave_out() {
    let mut log = sample();
    for _ in 0..4 {
        log.extend(b"junk");
        log.extend(&sample()[178..]);
    }
    let mut definitions = Definitions::new();
    definitions.collect(&log, 0);
    let of = |name| definitions.layouts().iter().map(|one| one.name == name).collect::<Vec<_>>();
    for (wanted, most) in [(of("A"), 1), (of("B"), 3), (of("nothing"), 7), (of("B"), u32::MAX)] {
        let mut expected = Vec::new();
        index(&log, 0, usize::MAX, &definitions, true, |entry, _| {
            if wanted[usize::from(entry.layout)] {
                expected.push(entry.offset);
            }
        });
        let (mut found, mut at, mut all_passed) = (Vec::new(), 0, 0);
        while at < log.len() {
            let (bytes, passed) = pass(&log[at..], at as u64, &definitions, &wanted, most);
            assert!(passed <= most && (bytes > 0) == (passed > 0));
            all_passed += passed;
            at += bytes;
            match look(&log[at..], at as u64, &definitions, true) {
                Found::Record { len, layout } => {
                    if wanted[usize::from(layout)] {
                        found.push(at as u64);
                    }
                    at += len;
                }
                Found::Junk { len } => at += len,
                Found::Incomplete => break,
            }
        }
        assert_eq!(found, expected);
        assert!(all_passed > 10, "{all_passed} of {} bytes", log.len());
    }
}

#[test]
fn what_is_not_there_yet_does_not_decide() {
    // A record that nothing follows, and within it the head of one whose end only later bytes show: nothing follows that
    // either, so the first one counts.
    let mut log = fmt(1, 103, "A", "Z", "X");
    log.extend(fmt(2, 255, "B", "Z", "X"));
    let start = log.len();
    log.extend(record(1, &[0; 100]));
    log[start + 50..start + 53].copy_from_slice(&[HEAD[0], HEAD[1], 2]);
    log.extend([7; 600]);
    let mut definitions = Definitions::new();
    definitions.collect(&log, 0);
    let wanted = look(&log[start..], start as u64, &definitions, true);
    assert!(matches!(wanted, Found::Record { len: 103, .. }));
    for end in start + 3..log.len() {
        let found = look(&log[start..end], start as u64, &definitions, false);
        assert!(found == wanted || found == Found::Incomplete, "{} bytes: {found:?}", end - start);
        assert!(end - start < LOOK_LEN || found == wanted, "{} bytes: {found:?}", end - start);
    }
}

#[test]
fn a_type_may_be_described_again() {
    let mut log = record(3, &[1, 2]);
    log.extend(fmt(3, 5, "OLD", "BB", "X,Y"));
    log.extend(record(3, &[1, 2]));
    log.extend(fmt(3, 7, "NEW", "HH", "X,Y"));
    log.extend(record(3, &[1, 2, 3, 4]));
    let (records, junk) = all(&log);
    let names: Vec<_> = records.iter().map(|(_, name)| name.as_str()).collect();
    assert_eq!((names, junk), (vec!["OLD", "FMT", "OLD", "FMT", "NEW"], 0));
}

#[test]
fn layouts_that_lie_describe_nothing() {
    for (len, format) in [(4, "BB"), (0, "BB"), (2, ""), (5, "By"), (255, "ZZZZ")] {
        let record = fmt(9, len, "BAD", format, "X,Y");
        assert!(Layout::parse(&record[HEAD_LEN..]).is_err(), "{len} {format}");
    }
    let mut definitions = Definitions::new();
    for number in 0..=u16::MAX {
        definitions.collect(&fmt(9, 255, "MANY", "", &number.to_string()), u64::from(number) * 89);
    }
    definitions.collect(&fmt(10, 255, "LAST", "", ""), u64::MAX);
    assert_eq!(definitions.layouts().len(), 1 + MAX_DEFINITIONS / 256 + 1);
}

#[test]
fn garbage_takes_linear_time() {
    let mut definitions = Definitions::new();
    definitions.collect(&fmt(1, 255, "LONG", "", ""), 0);
    for pattern in [&[0xA3][..], &[0xA3, 0x95], &[0xA3, 0x95, 1], &[0xA3, 0x95, 1, 0], &[0]] {
        let garbage: Vec<u8> = pattern.iter().copied().cycle().take(3_000_000).collect();
        let mut count = 0_u64;
        index(&garbage, 0, usize::MAX, &definitions, true, |entry, _| {
            count += u64::from(entry.len);
        });
        assert!(count <= 3_000_000);
    }
}

#[test]
fn values_of_every_kind() {
    let layout = Layout::new(
        7,
        0,
        "KIND".into(),
        "bBhHiIqQgfdnM".into(),
        "a,b,c,d,e,f,g,h,i,j,k,l,m".split(',').map(str::to_owned).collect(),
    )
    .expect("a layout");
    let mut body = vec![0xFF, 0xFF];
    body.extend([0xFF; 28]);
    body.extend(0x3E00_u16.to_le_bytes());
    body.extend(1.5_f32.to_le_bytes());
    body.extend((-2.5_f64).to_le_bytes());
    body.extend(b"ab\0c\xFE");
    let values: Vec<_> = (0..13).filter_map(|index| layout.value(index, &body)).collect();
    assert_eq!(
        values,
        [
            Integer(-1),
            Integer(255),
            Integer(-1),
            Integer(65535),
            Integer(-1),
            Integer(4_294_967_295),
            Integer(-1),
            Unsigned(u64::MAX),
            Float(1.5),
            Float(1.5),
            Float(-2.5),
            Text(b"ab\0c"),
            Integer(-2),
        ]
    );
    assert_eq!(usize::from(layout.len), HEAD_LEN + body.len());
    assert_eq!(layout.value(7, &body[..20]), Some(Unsigned(0)), "a body that is too short");
}

#[test]
fn half_precision() {
    let cases =
        [(0, 0.0), (1, 5.960_464_477_539_063e-8), (0x3C00, 1.0), (0xC000, -2.0), (0x7BFF, 65504.0)];
    for (bits, expected) in cases {
        assert_eq!(value(FieldKind::F16, &u16::to_le_bytes(bits), 0), Value::Float(expected));
    }
    assert_eq!(value(FieldKind::F16, &[0, 0xFC], 0), Value::Float(f64::NEG_INFINITY));
}

#[test]
fn lines() {
    use text::{Delimiter, layout, nth_value, text_values};
    let delimiter = Delimiter::of(b"junk\nFMT, 128, 89, FMT, BBnNZ, Type\n");
    assert_eq!(delimiter, Delimiter::CommaSpace);
    assert_eq!(Delimiter::of(b"FMT,128"), Delimiter::Comma);
    let found = layout("FMT, 162, 18, IMU, QBf, TimeUS,I,AccX", delimiter).expect("a layout");
    assert_eq!((found.len, found.fields.len(), found.time), (18, 3, Some((0, TimeUnit::Micros))));
    assert!(layout("FMT, 162, 18", delimiter).is_err());
    assert!(layout("FMT, x, 18, IMU, QBf, TimeUS", delimiter).is_err());
    assert_eq!(text_values("IMU, 1, 2, a,b", delimiter, "IMU"), ["1", "2", "a,b"]);
    assert_eq!(nth_value(b"IMU, 1, 2, a,b", delimiter, 2), Some(&b"a,b"[..]));
    assert_eq!(nth_value(b"IMU, 1", delimiter, 1), None);
}

/// Lines are long, and what is kept of a line is kept for each column.
#[test]
fn units_and_columns_of_a_text_log_are_bounded() {
    use text::{Delimiter, layout};
    for (len, is_kept) in [(64, true), (65, false)] {
        let mut units = Units::default();
        let label = "m".repeat(len);
        units.add("UNIT", |name| Some(if name == "Id" { "110".into() } else { label.clone() }));
        assert_eq!(units.labels.len(), usize::from(is_kept), "{len}");
    }
    for (columns, is_layout) in [(255, true), (256, false)] {
        let names = vec!["a"; columns].join(",");
        let line = format!("FMT, 130, 255, GAP, {}, {names}", "B".repeat(200));
        assert_eq!(layout(&line, Delimiter::CommaSpace).is_ok(), is_layout, "{columns}");
    }
}

#[test]
fn a_type_of_a_text_log_may_have_no_fields() {
    use super::text::{Delimiter, TextDefinitions, trimmed};

    let delimiter = Delimiter::CommaSpace;
    let mut definitions = TextDefinitions::new(delimiter);
    definitions.collect(b"FMT, 10, 3, STRT, , \n", 0);
    let layout = &definitions.layouts()[1];
    assert_eq!(
        (layout.name.as_str(), layout.columns.len(), layout.format.as_str()),
        ("STRT", 0, "")
    );
    for line in ["STRT", "STRT, ", "STRT,\r\n", "STRT, 5"] {
        let expected = (line != "STRT,\r\n").then_some(1);
        assert_eq!(definitions.of_line(trimmed(line.as_bytes()), 50), expected, "{line:?}");
    }
    definitions.collect(b"FMT, 11, 9, UNIT, bZ, Id,Label\n", 0);
    for (line, expected) in
        [("UNIT, 45, ", None), ("UNIT, 45, m", Some(2)), ("UNIT, 45, m, ", Some(2))]
    {
        assert_eq!(definitions.of_line(trimmed(line.as_bytes()), 50), expected, "{line:?}");
    }
}

#[test]
fn values_as_text() {
    let columns = ["A", "B", "C", "D", "E", "F"].map(str::to_owned).to_vec();
    let layout = Layout::new(1, 0, "X".into(), "bQcfna".into(), columns).expect("a layout");
    let mut body = vec![0xFF];
    body.extend(u64::MAX.to_le_bytes());
    body.extend((-150_i16).to_le_bytes());
    body.extend(1.5_f32.to_le_bytes());
    body.extend(b"a\xe9\0z");
    body.resize(body.len() + 2 * ARRAY_LEN, 0);
    let mut out = String::new();
    for index in 0..5 {
        assert!(layout.write_text(&mut out, index, &body));
        out.push(' ');
    }
    assert_eq!(out, format!("-1 {} -1.5 1.5 a\u{e9} ", u64::MAX));
    assert!(!layout.write_text(&mut out, 5, &body) && !layout.write_text(&mut out, 6, &body));
    assert_eq!(layout.field_bytes(2, &body), Some(&body[9..11]));
    assert_eq!(layout.field_bytes(5, &body[..20]), None);
    for (number, text) in [(f64::NAN, "nan"), (-f64::NAN, "qnan"), (2.0, "2.0")] {
        let mut out = String::new();
        write_float(&mut out, number);
        assert_eq!(out, text);
    }
}
