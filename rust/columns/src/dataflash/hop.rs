//! Where the records of a block of a binary log are, found on all processors.
//!
//! What is found from a place on depends on nothing before it ([`index`]). So each stretch of the block is hopped over by
//! itself, from wherever it begins; the walk through the log takes over what was found there from the first record that it
//! reaches, and hops by itself up to that one. Its outcome is that of hopping from the start of the log to its end.

use std::ops::Range;

use mavwire_core::log::dataflash::{Definitions, Found, LOOK_LEN, index, look};
use rayon::prelude::*;

/// Bytes that are hopped over in one go.
pub(super) const STRETCH: usize = 256 << 10;

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

    fn end(self) -> usize {
        self.at as usize + usize::from(self.len)
    }
}

/// The records of a block.
#[derive(Debug, Default)]
pub(super) struct Hops {
    /// In the order of the log, by the stretches in which they were found; none is empty.
    pub(super) stretches: Vec<Vec<Place>>,
    /// Bytes that belong to no record.
    pub(super) bad: Vec<Range<usize>>,
    /// Bytes dealt with.
    pub(super) consumed: usize,
}

/// What was found in a stretch by itself.
struct Guess {
    stretch: Range<usize>,
    places: Vec<Place>,
    /// Where the next record has to be looked for.
    next: usize,
}

/// Finds the records of `block`, which stands at `offset` in the log and ends it if `at_end`.
pub(super) fn hop(
    block: &[u8],
    offset: u64,
    definitions: &Definitions,
    at_end: bool,
    stretch: usize,
) -> Hops {
    let starts: Vec<usize> = (0..block.len()).step_by(stretch).collect();
    let guesses: Vec<Guess> = starts
        .par_iter()
        .map(|&start| {
            let stretch = start..block.len().min(start + stretch);
            guess(block, offset, definitions, at_end, stretch)
        })
        .collect();
    let (stretches, consumed) = put_together(block, offset, definitions, at_end, guesses);
    let bad = gaps(&stretches, consumed);
    Hops { stretches, bad, consumed }
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
    let mut places = Vec::new();
    let bytes = &block[start..end];
    let (done, _) =
        index(bytes, offset + start as u64, stretch.len(), definitions, last, |entry, _| {
            let at = (entry.offset - offset) as u32;
            places.push(Place { at, len: entry.len.into(), layout: entry.layout });
        });
    Guess { stretch, places, next: start + done }
}

/// The records that one walk through the block finds, and where it ends.
fn put_together(
    block: &[u8],
    offset: u64,
    definitions: &Definitions,
    at_end: bool,
    guesses: Vec<Guess>,
) -> (Vec<Vec<Place>>, usize) {
    let (mut at, mut stretches) = (0, Vec::new());
    for Guess { stretch, mut places, next } in guesses {
        let mut walked = Vec::new();
        while at < stretch.end {
            let known = places.binary_search_by_key(&at, |place| place.at as usize);
            if let Some(known) = known.ok().or((at == stretch.start).then_some(0)) {
                places.drain(..known);
                stretches.extend([walked, places]);
                walked = Vec::new();
                at = next;
                break;
            }
            match look(&block[at..], offset + at as u64, definitions, at_end) {
                Found::Record { len, layout } => {
                    walked.push(Place { at: at as u32, len: len as u16, layout });
                    at += len;
                }
                Found::Junk { len } => at += len,
                Found::Incomplete => break,
            }
        }
        stretches.push(walked);
        if at < stretch.end {
            break;
        }
    }
    stretches.retain(|places| !places.is_empty());
    (stretches, at)
}

/// What lies between the records, up to `end`.
fn gaps(stretches: &[Vec<Place>], end: usize) -> Vec<Range<usize>> {
    let ends = stretches.iter().filter_map(|places| places.last()).map(|place| place.end());
    let befores: Vec<usize> = std::iter::once(0).chain(ends).collect();
    let within = stretches.par_iter().zip(&befores).flat_map_iter(|(places, &before)| {
        let mut expected = before;
        places.iter().filter_map(move |place| {
            let gap = expected..place.at as usize;
            expected = place.end();
            (!gap.is_empty()).then_some(gap)
        })
    });
    let mut gaps: Vec<_> = within.collect();
    let rest = befores.last().map_or(0, |&before| before)..end;
    if !rest.is_empty() {
        gaps.push(rest);
    }
    gaps
}
