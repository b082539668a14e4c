//! Searching on all processors finds exactly what one scanner over the whole log finds.

mod common;

use std::ops::Range;
use std::sync::Arc;

use common::{damage, log, registry};
use mavwire_columns::scan::{Framing, LogScanner, UNKNOWN};
use mavwire_core::log::tlog::FoundRecord;
use mavwire_core::registry::Registry;
use proptest::prelude::*;

/// As in `mavwire_core::log::tlog::Before`.
const BELIEVED: u64 = 3 * 24 * 3600 * 1_000_000;
const DATES: Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;

/// Place and message index of each record, places of bad bytes, times that are not believed.
#[derive(Debug, Default, PartialEq, Eq)]
struct Outcome {
    records: Vec<(usize, u16)>,
    bad: Vec<Range<usize>>,
    distrusted: Vec<(usize, u64)>,
}

impl Outcome {
    fn add_bad(&mut self, range: Range<usize>) {
        match self.bad.last_mut().filter(|last| last.end == range.start) {
            Some(last) => last.end = range.end,
            None => self.bad.push(range),
        }
    }
}

/// By one scanner, told of all bytes at once.
fn sequential(bytes: &[u8], registry: &Registry, framing: Framing) -> Outcome {
    let mut scanner = framing.scanner();
    let (mut out, mut at) = (Outcome::default(), 0);
    let (mut before, mut after_damage) = (None::<(u64, u64)>, false);
    loop {
        match scanner.next(&bytes[at..], registry, true) {
            FoundRecord::Record { len, stamp, entry, .. } => {
                out.records.push((at, entry.map_or(UNKNOWN, |entry| entry.index)));
                let (stamp, mut time) = (stamp.micros(), stamp.micros());
                if let Some((good, said)) = before.filter(|_| after_damage && framing.lead() > 0)
                    && [good, said].iter().all(|one| stamp.abs_diff(*one) >= BELIEVED)
                    && (DATES.contains(&good) || !DATES.contains(&stamp))
                {
                    out.distrusted.push((at, good));
                    time = good;
                }
                (before, after_damage) = (Some((time, stamp)), false);
                at += len;
            }
            FoundRecord::Junk { len } => {
                out.add_bad(at..at + len);
                after_damage = true;
                at += len;
            }
            FoundRecord::Incomplete { .. } => return out,
        }
    }
}

/// Block by block and stretch by stretch.
fn parallel(
    bytes: &[u8],
    registry: &Arc<Registry>,
    framing: Framing,
    block: usize,
    stretch: usize,
) -> Outcome {
    let mut scanner = LogScanner::new(Arc::clone(registry), framing).with_stretch(stretch);
    let (mut out, mut start, mut end) = (Outcome::default(), 0, 0);
    loop {
        let at_end = end == bytes.len();
        end = (end + block).min(bytes.len());
        let found = scanner.scan(&bytes[start..end], at_end);
        let place = |at: u32| start + at as usize;
        out.records.extend(found.records.iter().map(|record| (place(record.at), record.index)));
        out.distrusted.extend(found.distrusted.iter().map(|&(at, time)| (place(at), time)));
        for bad in found.bad {
            out.add_bad(start + bad.start..start + bad.end);
        }
        start += found.consumed;
        if at_end {
            assert_eq!(start, bytes.len(), "everything is dealt with");
            return out;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn any_blocks_stretches_and_threads_give_the_same(
        seed in any::<u64>(),
        places in 0..60_usize,
        raw in any::<bool>(),
        block in 1..4000_usize,
        stretch in 1..2000_usize,
        threads in 1..5_usize,
    ) {
        let registry = registry();
        let framing = if raw { Framing::Raw } else { Framing::Stamped };
        let mut bytes = log(&registry, seed, 200, framing.lead());
        damage(&mut bytes, seed ^ 1, places);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let found = pool.install(|| parallel(&bytes, &registry, framing, block, stretch));
        prop_assert_eq!(found, sequential(&bytes, &registry, framing));
    }
}

#[test]
fn no_garbage_takes_more_than_linear_work() {
    let registry = registry();
    for pattern in [&[0xFE][..], &[0xFD], &[0xFD, 0xFF, 0], &[0xFE, 0xFF], &[0]] {
        let bytes: Vec<u8> = pattern.iter().copied().cycle().take(2_000_000).collect();
        for framing in [Framing::Stamped, Framing::Raw] {
            let found = parallel(&bytes, &registry, framing, 1 << 20, 1 << 17);
            assert_eq!(found, sequential(&bytes, &registry, framing), "{pattern:?}");
            assert!(found.records.is_empty());
        }
    }
}

#[test]
fn kinds_of_logs_are_told_apart() {
    let registry = registry();
    for framing in [Framing::Stamped, Framing::Raw] {
        let bytes = log(&registry, 5, 100, framing.lead());
        for cut in [0, 1, 7, 8, 9, 30, 100] {
            assert_eq!(Framing::of(&bytes[cut..], &registry), framing, "cut at {cut}");
        }
    }
    assert_eq!(Framing::of(&[], &registry), Framing::Stamped);
}
