//! The layouts of a log's record types, by type and place.
//!
//! A log may describe a type again, as one that was continued by another firmware does. A record is read by the last
//! description in front of it, or by the first behind it where none is in front.

use std::sync::Arc;

use memchr::memmem;

use super::layout::{FMT_LAYOUT_LEN, Layout};
use super::{FMT_TYPE, HEAD, HEAD_LEN};

/// Layouts of one type that are kept at most, the first ones: a hostile log shall not fill the memory.
const MAX_FOR_TYPE: usize = 16;

/// Layouts of a log that are kept at most.
pub const MAX_DEFINITIONS: usize = 256 * MAX_FOR_TYPE;

/// No layout, and several.
const NONE: u16 = u16::MAX;
const SEVERAL: u16 = u16::MAX - 1;

/// The layout of a type that has one. The length is copied here, since each step to the next record has to wait for it.
#[derive(Debug, Clone, Copy)]
struct Only {
    /// Its index, [`NONE`] or [`SEVERAL`].
    index: u16,
    /// Bytes of a record.
    len: u8,
}

/// All layouts of a log.
#[derive(Debug, Clone)]
pub struct Definitions {
    layouts: Vec<Arc<Layout>>,
    /// The layout of each type.
    only: [Only; 256],
    /// By type: from which offset each of its layouts holds, and its index.
    places: Vec<Vec<(u64, u16)>>,
}

impl Default for Definitions {
    fn default() -> Self {
        let mut definitions = Self {
            layouts: Vec::new(),
            only: [Only { index: NONE, len: 0 }; 256],
            places: vec![Vec::new(); 256],
        };
        definitions.add(Layout::of_fmt(), 0);
        definitions
    }
}

impl Definitions {
    /// Only what every log has: the layout of FMT itself.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in all FMT records in `bytes`, which stand at `offset` in the log, wherever they are: damage around them
    /// does not matter. Stretches of a log must come in order and overlap by [`FMT_LAYOUT_LEN`] - 1 bytes.
    pub fn collect(&mut self, bytes: &[u8], offset: u64) {
        let head = [HEAD[0], HEAD[1], FMT_TYPE];
        for at in memmem::find_iter(bytes, &head) {
            let Some(body) = bytes.get(at + HEAD_LEN..at + FMT_LAYOUT_LEN) else { break };
            if let Ok(layout) = Layout::parse(body)
                && layout.type_id != FMT_TYPE
            {
                self.add(layout, offset + at as u64);
            }
        }
    }

    /// Adds a layout that was found at `offset`, behind those that were added before.
    pub fn add(&mut self, layout: Layout, offset: u64) {
        let type_id = usize::from(layout.type_id);
        let places = &mut self.places[type_id];
        let known = places.last().map(|&(_, index)| &self.layouts[usize::from(index)]);
        if known.is_some_and(|known| **known == layout) || places.len() >= MAX_FOR_TYPE {
            return;
        }
        let (index, len) = (self.layouts.len() as u16, layout.len);
        let (from, only) = if places.is_empty() { (0, index) } else { (offset, SEVERAL) };
        places.push((from, index));
        self.only[type_id] = Only { index: only, len };
        self.layouts.push(Arc::new(layout));
    }

    /// Index and length of a record of a type at a place in the log.
    #[inline]
    pub(super) fn record(&self, type_id: u8, offset: u64) -> Option<(u16, usize)> {
        let Only { index, len } = self.only[usize::from(type_id)];
        match index {
            NONE => None,
            SEVERAL => {
                let places = &self.places[usize::from(type_id)];
                let behind = places.partition_point(|&(from, _)| from <= offset);
                let index = places.get(behind.checked_sub(1)?)?.1;
                Some((index, usize::from(self.layouts.get(usize::from(index))?.len)))
            }
            index => Some((index, usize::from(len))),
        }
    }

    /// All layouts, in the order in which they were found; FMT's own is the first.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        &self.layouts
    }
}
