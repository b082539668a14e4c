//! Telemetry logs made of others: what is repaired, cut, merged or made anonymous is what one scanner finds, record by record.

use mavwire_columns::input::Steps;
use mavwire_columns::rewrite::{Outcome, Rewrite};
use mavwire_columns::scan::Framing;
use mavwire_columns::select::Wanted;
use mavwire_core::anonymize::Anonymizer;

use crate::dialects::ALL;
use crate::input::Input;
use crate::logs::any_telemetry;
use crate::private::ANONYMIZERS;
use crate::reading::{looks_compressed, on_threads, small_steps, source};
use crate::tables::{Record, mended, one_by_one};

/// Any log, repaired, cut and made anonymous, and two of them merged.
pub fn rewrite(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    let framing = if flags & 1 == 0 { Framing::Stamped } else { Framing::Raw };
    let steps = small_steps(&mut input, 1);
    let wanted = any_wanted(&mut input);
    let (_, anonymizer) = &ANONYMIZERS[usize::from(input.byte()) % ANONYMIZERS.len()];
    let rest = input.rest();
    let (first, second) = rest.split_at(if flags & 2 == 0 { 0 } else { rest.len() / 2 });
    let bytes = any_telemetry(Input::new(second), framing.lead());
    on_threads(flags & 4 != 0, || {
        repaired(steps, &bytes, framing);
        cut(steps, &bytes, framing, &wanted);
        anonymous(steps, &bytes, framing, anonymizer);
        merged(steps, &[any_telemetry(Input::new(first), 8), bytes]);
    });
}

/// Some systems, some stretch of time.
fn any_wanted(input: &mut Input<'_>) -> Wanted {
    let flags = input.byte();
    let systems = (flags & 1 != 0).then(|| Box::new(std::array::from_fn(|id| id % 4 > 1)));
    let second = |byte: u8| 1_600_000_000.0 + f64::from(byte) / 16.0;
    let start = if flags & 2 == 0 { f64::NEG_INFINITY } else { second(input.byte()) };
    let end = if flags & 4 == 0 { f64::INFINITY } else { second(input.byte()) };
    Wanted { systems, start, end, ..Wanted::default() }
}

fn rewritten(
    steps: Steps,
    bytes: &[u8],
    framing: Framing,
    wanted: Wanted,
    anonymizer: Option<Anonymizer>,
) -> (Vec<u8>, Outcome) {
    let sources = vec![source(bytes)];
    let rewrite = Rewrite::new(steps, sources, Some(framing), &ALL, wanted, anonymizer);
    let (mut rewrite, mut out) = (rewrite.expect("memory does not fail"), Vec::new());
    while rewrite.advance(&mut out).expect("memory does not fail") {}
    (out, rewrite.outcome())
}

/// The bytes of records.
fn written<'a>(records: impl Iterator<Item = &'a Record>, framing: Framing) -> Vec<u8> {
    let mut out = Vec::new();
    for record in records {
        out.extend_from_slice(&record.time.to_be_bytes()[..framing.lead()]);
        out.extend_from_slice(&record.frame);
    }
    out
}

fn repaired(steps: Steps, bytes: &[u8], framing: Framing) {
    let (records, bad) = one_by_one(bytes, framing);
    let records = mended(records, framing);
    let (out, outcome) = rewritten(steps, bytes, framing, Wanted::default(), None);
    assert_eq!(out, written(records.iter(), framing));
    assert_eq!((outcome.bytes, outcome.bad_bytes), (bytes.len() as u64, bad));
    let count = records.len() as u64;
    assert_eq!((outcome.records, outcome.written), (count, count));
    // A second repair changes nothing. But whether an unknown message is believed depends on its neighbours. Where one
    // is not believed any more, the time behind it may not be either.
    let again = one_by_one(&out, framing).0;
    if records.iter().all(|record| record.index.is_some()) {
        assert_eq!(written(again.iter(), framing), out);
    }
    let known = |records: &[Record]| {
        let known = records.iter().filter(|record| record.index.is_some());
        known.map(|record| record.frame.clone()).collect::<Vec<_>>()
    };
    assert_eq!(known(&again), known(&records));
}

fn cut(steps: Steps, bytes: &[u8], framing: Framing, wanted: &Wanted) {
    let records = mended(one_by_one(bytes, framing).0, framing);
    let (out, _) = rewritten(steps, bytes, framing, wanted.clone(), None);
    let is_kept = |record: &&Record| {
        let seconds = record.time as f64 * 1e-6;
        let system = usize::from(record.header.sysid);
        wanted.systems.as_ref().is_none_or(|systems| systems[system])
            && (framing == Framing::Raw || (wanted.start..wanted.end).contains(&seconds))
    };
    assert_eq!(out, written(records.iter().filter(is_kept), framing));
}

fn anonymous(steps: Steps, bytes: &[u8], framing: Framing, anonymizer: &Anonymizer) {
    let records = mended(one_by_one(bytes, framing).0, framing);
    let mut expected = Vec::new();
    for record in &records {
        let (before, entry) = (expected.len(), ALL.lookup(record.header.msgid));
        expected.extend_from_slice(&record.time.to_be_bytes()[..framing.lead()]);
        if !anonymizer.apply(&record.frame, &record.header, entry, &mut expected) {
            expected.truncate(before);
        }
    }
    let (out, _) = rewritten(steps, bytes, framing, Wanted::default(), Some(anonymizer.clone()));
    assert_eq!(out, expected);
    for left in one_by_one(&out, framing).0 {
        assert!(left.index.is_some() && left.header.msgid != 256 && !left.header.is_signed());
    }
}

fn merged(steps: Steps, logs: &[Vec<u8>; 2]) {
    if logs.iter().any(|log| looks_compressed(log)) {
        return;
    }
    let sources = logs.iter().map(|log| source(log)).collect();
    let merge = Rewrite::new(steps, sources, None, &ALL, Wanted::default(), None);
    let mut merge = merge.expect("memory does not fail");
    // A log whose first block looks like one without times is refused.
    if merge.raw_log().is_some() {
        return;
    }
    let mut out = Vec::new();
    while merge.advance(&mut out).expect("memory does not fail") {}
    let [one, other] = [0, 1].map(|at| one_by_one(&logs[at], Framing::Stamped));
    assert_eq!(merge.outcome().bad_bytes, one.1 + other.1);
    let [one, other] = [one, other].map(|(records, _)| mended(records, Framing::Stamped));
    let (mut one, mut other) = (one.iter().peekable(), other.iter().peekable());
    let in_order = std::iter::from_fn(|| match (one.peek(), other.peek()) {
        (Some(first), Some(second)) if first.time > second.time => other.next(),
        (Some(_), _) => one.next(),
        _ => other.next(),
    });
    assert_eq!(out, written(in_order, Framing::Stamped));
}
