//! Counts of the messages that the dialect does not define, with their times.

use std::collections::BTreeMap;

use mavwire_core::unknown::{MOST_LISTED, UnknownKind};

use crate::summary::{Count, RecordTime};

/// The messages of each kind.
pub type UnknownCounts = mavwire_core::unknown::UnknownCounts<Count>;

/// Counts the message whose frame is at the front of some bytes.
pub(crate) fn add(counts: &mut UnknownCounts, frame: &[u8], moment: Option<RecordTime>) {
    match counts.of(UnknownKind::of(frame), MOST_LISTED) {
        Some(count) => count.add(moment),
        None => counts.unlisted += 1,
    }
}

/// The messages of each id.
pub fn by_id(counts: &UnknownCounts) -> BTreeMap<u32, Count> {
    let mut ids = BTreeMap::<u32, Count>::new();
    for (kind, count) in &counts.listed {
        ids.entry(kind.msgid).or_default().merge(count);
    }
    ids
}
