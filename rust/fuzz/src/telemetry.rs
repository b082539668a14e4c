//! Telemetry logs: runs of records that are looked for anywhere, by guess, change nothing about what one scanner finds.

use mavwire_core::log::tlog::{FoundRecord, Framing, RecordScanner, Runs, find_runs};

use crate::dialects::ALL;
use crate::input::Input;

/// Place of each record and index of its message; an id that nobody knows has none.
type Records = Vec<(usize, Option<u16>)>;

fn scanner(lead: usize) -> RecordScanner {
    let framing = if lead == 0 { Framing::Raw } else { Framing::Stamped };
    framing.scanner()
}

/// The item at `at`, and its length; `None` at the end.
fn step(
    scanner: &mut RecordScanner,
    bytes: &[u8],
    at: usize,
    records: &mut Records,
) -> Option<usize> {
    match scanner.next(&bytes[at..], &ALL, true) {
        FoundRecord::Record { len, entry, .. } => {
            records.push((at, entry.map(|entry| entry.index)));
            Some(len)
        }
        FoundRecord::Junk { len } => Some(len),
        FoundRecord::Incomplete { .. } => None,
    }
}

/// By one scanner over the whole.
fn sequential(bytes: &[u8], lead: usize) -> Records {
    let (mut scanner, mut records, mut at) = (scanner(lead), Records::new(), 0);
    while let Some(len) = step(&mut scanner, bytes, at, &mut records) {
        assert!(len > 0, "every outcome moves on");
        at += len;
    }
    assert_eq!(at, bytes.len());
    records
}

/// The same, passing over the runs of each stretch where the scanner allows it.
fn by_runs(bytes: &[u8], lead: usize, stretch: usize) -> Records {
    let starts = (0..bytes.len()).step_by(stretch);
    let found: Vec<Runs> = starts
        .map(|start| find_runs(bytes, start..bytes.len().min(start + stretch), lead, &ALL))
        .collect();
    let runs = || found.iter().flat_map(|one| one.runs.iter().map(|run| (run, &one.records[..])));
    let (mut scanner, mut records, mut at) = (scanner(lead), Records::new(), 0);
    loop {
        let reached = runs().find_map(|(run, located)| {
            let (rest, end) = scanner.rest_of_run(at, run, located)?;
            Some((end, &located[rest]))
        });
        if let Some((end, located)) = reached {
            records.extend(located.iter().map(|one| (one.at as usize, Some(one.index))));
            scanner.pass_run(end - at);
            at = end;
        } else if let Some(len) = step(&mut scanner, bytes, at, &mut records) {
            at += len;
        } else {
            return records;
        }
    }
}

/// Any bytes as a log, searched in stretches of any length.
pub fn tlog(data: &[u8]) {
    let mut input = Input::new(data);
    let lead = if input.byte().is_multiple_of(2) { 8 } else { 0 };
    let stretch = usize::from(input.number()) % 2048 + 1;
    let bytes = input.rest();
    let stretch = stretch.max(bytes.len() / 64);
    assert_eq!(by_runs(bytes, lead, stretch), sequential(bytes, lead));
}
