//! The last timestamp of every verified stream.
//!
//! Only genuine frames add streams. The table is bounded, since peers choose `link_id`, `sysid` and `compid` themselves. A new
//! stream replaces the one silent for longest if the table is full. The last timestamp of the replaced stream becomes the
//! floor of its link id: a stream that is not in the table has to begin above it. So no frame is accepted twice.

/// Streams a table holds unless told otherwise.
const DEFAULT_CAPACITY: usize = 1024;

/// Whose timestamps belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StreamId {
    /// Link of the sender.
    pub link_id: u8,
    /// Sending system.
    pub sysid: u8,
    /// Sending component.
    pub compid: u8,
}

#[derive(Debug, Clone, Copy)]
struct StreamEntry {
    id: StreamId,
    timestamp: u64,
    /// The number of timestamps that the table had seen when it came.
    heard: u64,
}

/// Last timestamps by stream, sorted.
#[derive(Debug, Clone)]
pub struct StreamTable {
    streams: Vec<StreamEntry>,
    capacity: usize,
    heard: u64,
    /// The least timestamp of a new stream by link id. Empty until a stream is replaced.
    floors: Vec<u64>,
}

impl Default for StreamTable {
    fn default() -> Self {
        Self::with_capacity(DEFAULT_CAPACITY)
    }
}

impl StreamTable {
    /// A table for `capacity` streams, at least one.
    pub fn with_capacity(capacity: usize) -> Self {
        Self { streams: Vec::new(), capacity: capacity.max(1), heard: 0, floors: Vec::new() }
    }

    /// The index of a stream, or else the index to insert it at.
    #[inline]
    pub(super) fn find(&self, id: StreamId) -> Result<usize, usize> {
        // As one number, which is one comparison.
        let number =
            |StreamId { link_id, sysid, compid }| u32::from_be_bytes([0, link_id, sysid, compid]);
        self.streams.binary_search_by_key(&number(id), |entry| number(entry.id))
    }

    /// The least timestamp of a stream that is not a replay. `at` comes from `find`.
    #[inline]
    pub(super) fn least(&self, at: Result<usize, usize>, id: StreamId) -> u64 {
        match at {
            Ok(at) => self.streams[at].timestamp.saturating_add(1),
            Err(_) => self.floor(id.link_id),
        }
    }

    /// The least timestamp of a new stream with this link id: 0 unless a stream with it was replaced.
    pub fn floor(&self, link_id: u8) -> u64 {
        self.floors.get(usize::from(link_id)).copied().unwrap_or(0)
    }

    /// Sets the last timestamp of a stream. A new stream replaces another if the table is full.
    pub fn set(&mut self, id: StreamId, timestamp: u64) {
        self.put(self.find(id), id, timestamp, u64::MAX);
    }

    /// Sets the last timestamp of a stream. `at` comes from `find`. A new stream replaces another if the table is full, one
    /// with a timestamp up to `horizon` if possible: later ones would make a floor that only wrong clocks reach.
    #[inline]
    pub(super) fn put(
        &mut self,
        at: Result<usize, usize>,
        id: StreamId,
        timestamp: u64,
        horizon: u64,
    ) {
        self.heard += 1;
        let entry = StreamEntry { id, timestamp, heard: self.heard };
        match at {
            Ok(at) => self.streams[at] = entry,
            Err(at) if self.streams.len() < self.capacity => self.streams.insert(at, entry),
            Err(at) => self.replace(at, entry, horizon),
        }
    }

    #[cold]
    fn replace(&mut self, at: usize, new: StreamEntry, horizon: u64) {
        let silent = self.streams.iter().enumerate();
        let silent = silent.min_by_key(|(_, entry)| (entry.timestamp > horizon, entry.heard));
        let Some((place, &StreamEntry { id, timestamp, .. })) = silent else { return };
        self.floors.resize(256, 0);
        let floor = &mut self.floors[usize::from(id.link_id)];
        *floor = (*floor).max(timestamp.saturating_add(1));
        self.streams.remove(place);
        self.streams.insert(at - usize::from(place < at), new);
    }

    /// Forgets all streams. The floors of replaced streams stay.
    pub fn clear(&mut self) {
        self.streams.clear();
    }

    /// The largest number of streams.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// All streams with their last timestamps, in order.
    pub fn iter(&self) -> impl Iterator<Item = (StreamId, u64)> + '_ {
        self.streams.iter().map(|entry| (entry.id, entry.timestamp))
    }
}
