//! Where the records of a block of a binary log are, found on all processors.
//!
//! The records from a place on do not depend on the bytes before it ([`index`]). So each processor hops through a
//! stretch of the block from an arbitrary start. The walk through the log hops by itself until it reaches a record of
//! such a stretch, and takes over the records from there. Its outcome is that of hopping from the start of the log to
//! its end.

use std::ops::Range;

use mavwire_core::log::dataflash::{Definitions, Found, LOOK_LEN, index, look};
use rayon::prelude::*;

/// Bytes of a record, or fewer: how many records a stretch may be expected to have.
const USUAL_LEN: usize = 32;

/// A record in a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Where it starts.
    pub(super) at: u32,
    /// Bytes of it, head included; of a line without its end.
    pub(super) len: u16,
    /// Index of its layout.
    pub(super) layout: u16,
}

impl Place {
    /// The bytes of the record.
    pub(super) fn of(self, block: &[u8]) -> &[u8] {
        &block[self.at as usize..][..usize::from(self.len)]
    }
}

/// The records of a block.
#[derive(Debug, Default)]
pub(super) struct RecordIndex {
    /// In the order of the log, by the stretches in which they were found; none is empty.
    pub(super) stretches: Vec<Vec<Place>>,
    /// Bytes that belong to no record.
    pub(super) bad: Vec<Range<usize>>,
    /// Bytes consumed.
    pub(super) consumed: usize,
}

/// The records found in a stretch that was searched without the bytes before it.
struct Guess {
    stretch: Range<usize>,
    places: Vec<Place>,
    /// Where the next record has to be looked for.
    next: usize,
    /// Bytes that belong to no record.
    bad: Vec<Range<usize>>,
}

/// Finds the records of `block` that start before `limit`. It begins at `offset` of the log, and is its end if `at_end`.
pub(super) fn hop(
    block: &[u8],
    offset: u64,
    limit: usize,
    definitions: &Definitions,
    at_end: bool,
    stretch: usize,
) -> RecordIndex {
    let starts: Vec<usize> = (0..limit).step_by(stretch).collect();
    let guesses: Vec<Guess> = starts
        .par_iter()
        .with_max_len(1)
        .map(|&start| {
            let stretch = start..limit.min(start + stretch);
            guess(block, offset, definitions, at_end, stretch)
        })
        .collect();
    put_together(block, offset, definitions, at_end, guesses)
}

fn guess(
    block: &[u8],
    offset: u64,
    definitions: &Definitions,
    at_end: bool,
    stretch: Range<usize>,
) -> Guess {
    let start = stretch.start;
    // No further: a stretch of junk would be searched up to the end of the block otherwise, and so would the next one.
    let end = block.len().min(stretch.end + LOOK_LEN);
    let last = at_end && end == block.len();
    let (mut places, mut bad) = (Vec::with_capacity(stretch.len() / USUAL_LEN), Vec::new());
    let bytes = &block[start..end];
    let mut expected = start;
    let (done, _) =
        index(bytes, offset + start as u64, stretch.len(), definitions, last, |entry, _| {
            let at = (entry.offset - offset) as usize;
            if at > expected {
                bad.push(expected..at);
            }
            expected = at + usize::from(entry.len);
            places.push(Place { at: at as u32, len: entry.len.into(), layout: entry.layout });
        });
    let next = start + done;
    if next > expected {
        bad.push(expected..next);
    }
    Guess { stretch, places, next, bad }
}

/// The records that one walk through the block finds, and where it ends.
fn put_together(
    block: &[u8],
    offset: u64,
    definitions: &Definitions,
    at_end: bool,
    guesses: Vec<Guess>,
) -> RecordIndex {
    let (mut at, mut hops) = (0, RecordIndex::default());
    for Guess { stretch, mut places, next, bad } in guesses {
        let mut walked = Vec::new();
        while at < stretch.end {
            let known = places.binary_search_by_key(&at, |place| place.at as usize);
            if let Some(known) = known.ok().or((at == stretch.start).then_some(0)) {
                places.drain(..known);
                hops.stretches.extend([walked, places]);
                bad.into_iter().filter(|bad| bad.start >= at).for_each(|bad| hops.add_bad(bad));
                walked = Vec::new();
                at = next;
                break;
            }
            match look(&block[at..], offset + at as u64, definitions, at_end) {
                Found::Record { len, layout } => {
                    walked.push(Place { at: at as u32, len: len as u16, layout });
                    at += len;
                }
                Found::Junk { len } => {
                    hops.add_bad(at..at + len);
                    at += len;
                }
                Found::Incomplete => break,
            }
        }
        hops.stretches.push(walked);
        if at < stretch.end {
            break;
        }
    }
    hops.stretches.retain(|places| !places.is_empty());
    hops.consumed = at;
    hops
}

impl RecordIndex {
    /// Adds bytes of no record. Ranges that touch become one.
    fn add_bad(&mut self, range: Range<usize>) {
        match self.bad.last_mut().filter(|last| last.end == range.start) {
            Some(last) => last.end = range.end,
            None => self.bad.push(range),
        }
    }
}
