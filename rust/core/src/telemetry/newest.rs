//! The newest messages of one system, and how many a link keeps.

/// An odd number without a pattern, so that two instances have one number as good as never.
const FACTOR: u128 = 0x9E37_79B9_7F4A_7C15_F39C_C060_5CED_C835;

/// A component, and one instance of a kind of message: a battery, a servo rail, a named value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Source(u128);

impl Source {
    /// `instance` has the bytes of the field that tells instances apart, zeros at its end or not. It is empty for a kind
    /// without instances.
    #[inline]
    pub fn new(compid: u8, instance: &[u8]) -> Self {
        let number = instance
            .iter()
            .rev()
            .fold(0_u128, |number, &byte| number.wrapping_mul(FACTOR).wrapping_add(byte.into()));
        Self((number << 8) | u128::from(compid))
    }

    /// Component id.
    pub fn compid(self) -> u8 {
        self.0 as u8
    }
}

/// Why a message is or is not in the table.
#[derive(Debug, PartialEq, Eq)]
pub enum Kept<M> {
    /// It took the place of an older one.
    Renewed(M),
    /// It is the first from its source.
    First,
    /// There was no room for it.
    Refused(M),
}

#[derive(Debug)]
struct Entry<M> {
    source: Source,
    /// Number of the arrival among all messages of the system.
    arrival: u64,
    message: M,
}

/// The newest message of each kind from each source. `M` is a handle of a message.
///
/// Storing a message is cheap, because nobody looks at most of them. A reader asks for those that arrived since it looked
/// last.
#[derive(Debug)]
pub struct Newest<M> {
    /// By number of the kind.
    kinds: Vec<Vec<Entry<M>>>,
    /// Entries of all kinds.
    len: usize,
    arrivals: u64,
    /// Arrivals that the reader has seen.
    seen: u64,
    /// Where the entries are that it has not seen.
    unseen: Vec<(usize, Source)>,
}

impl<M> Default for Newest<M> {
    fn default() -> Self {
        Self { kinds: Vec::new(), len: 0, arrivals: 0, seen: 0, unseen: Vec::new() }
    }
}

impl<M> Newest<M> {
    /// Keeps a message. `has_room` is asked before another entry is made; its argument is the number of entries.
    #[inline]
    pub fn keep(
        &mut self,
        kind: usize,
        source: Source,
        message: M,
        has_room: impl FnOnce(usize) -> bool,
    ) -> Kept<M> {
        let entries = self.kinds.get_mut(kind).map(Vec::as_mut_slice).unwrap_or_default();
        let Some(entry) = entries.iter_mut().find(|entry| entry.source == source) else {
            return self.add(kind, source, message, has_room);
        };
        if entry.arrival <= self.seen {
            self.unseen.push((kind, source));
        }
        self.arrivals += 1;
        entry.arrival = self.arrivals;
        Kept::Renewed(std::mem::replace(&mut entry.message, message))
    }

    #[cold]
    fn add(
        &mut self,
        kind: usize,
        source: Source,
        message: M,
        has_room: impl FnOnce(usize) -> bool,
    ) -> Kept<M> {
        if !has_room(self.len) {
            return Kept::Refused(message);
        }
        if self.kinds.len() <= kind {
            self.kinds.resize_with(kind + 1, Vec::new);
        }
        self.len += 1;
        self.arrivals += 1;
        self.kinds[kind].push(Entry { source, arrival: self.arrivals, message });
        self.unseen.push((kind, source));
        Kept::First
    }

    /// Copies of what arrived since the last call, in the order of arrival.
    pub fn take_unseen<T>(&mut self, copy: impl Fn(&M) -> T) -> Vec<T> {
        self.seen = self.arrivals;
        let kinds = &self.kinds;
        let entry = |(kind, source): (usize, Source)| {
            kinds[kind].iter().find(|entry| entry.source == source)
        };
        let mut found: Vec<_> = self.unseen.drain(..).filter_map(entry).collect();
        found.sort_unstable_by_key(|entry| entry.arrival);
        found.into_iter().map(|entry| copy(&entry.message)).collect()
    }

    /// Copies of all messages with their components, in the order of arrival.
    pub fn in_order<T>(&self, copy: impl Fn(&M) -> T) -> Vec<(u8, T)> {
        let mut found: Vec<_> = self.kinds.iter().flatten().collect();
        found.sort_unstable_by_key(|entry| entry.arrival);
        found.into_iter().map(|entry| (entry.source.compid(), copy(&entry.message))).collect()
    }

    /// All messages.
    pub fn iter(&self) -> impl Iterator<Item = &M> {
        self.kinds.iter().flatten().map(|entry| &entry.message)
    }
}

/// Room for what a link keeps under names that senders choose: types, instances, components and parameters.
///
/// Every system has some of its own, more than a vehicle needs, so that a flood of made-up ids shuts out nobody.
#[derive(Debug, Default)]
pub struct Room {
    shared: usize,
    params: usize,
    /// Entries that were refused for lack of room.
    pub refused: u64,
}

impl Room {
    /// Entries of each system.
    pub const OWN: usize = 512;
    /// Entries beyond those, of all systems of a link together.
    pub const SHARED: usize = 4096;
    /// Parameters of a component.
    pub const PARAMS: usize = 16_384;
    /// Parameters of all components together; those of the target are kept beyond it.
    pub const SHARED_PARAMS: usize = 262_144;

    /// Whether a system with `entries` may have another one, which then counts.
    pub fn take(&mut self, entries: usize) -> bool {
        if entries < Self::OWN {
            return true;
        }
        let is_free = self.shared < Self::SHARED;
        self.shared += usize::from(is_free);
        self.refused += u64::from(!is_free);
        is_free
    }

    /// Whether a component with `known` parameters may have another one, which then counts.
    pub fn take_param(&mut self, known: usize, is_target: bool) -> bool {
        let is_counted = known < Self::PARAMS && self.params < Self::SHARED_PARAMS;
        self.params += usize::from(is_counted);
        let is_free = is_counted || (is_target && known < Self::PARAMS);
        self.refused += u64::from(!is_free);
        is_free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keep(newest: &mut Newest<u32>, kind: usize, compid: u8, instance: &[u8], message: u32) {
        newest.keep(kind, Source::new(compid, instance), message, |_| true);
    }

    #[test]
    fn a_reader_gets_what_arrived_since_it_looked_last() {
        let mut newest = Newest::default();
        keep(&mut newest, 3, 1, &[], 10);
        keep(&mut newest, 0, 1, &[], 11);
        keep(&mut newest, 3, 1, &[], 12);
        assert_eq!(newest.take_unseen(|&one| one), [11, 12]);
        assert!(newest.take_unseen(|&one| one).is_empty());
        keep(&mut newest, 0, 1, &[], 13);
        keep(&mut newest, 0, 1, &[], 14);
        assert_eq!(newest.take_unseen(|&one| one), [14]);
        assert_eq!(newest.iter().collect::<Vec<_>>(), [&14, &12]);
    }

    #[test]
    fn components_and_instances_are_kept_apart() {
        let mut newest = Newest::default();
        keep(&mut newest, 5, 1, &[0], 20);
        keep(&mut newest, 5, 1, &[2, 0], 21);
        keep(&mut newest, 5, 154, &[2], 22);
        keep(&mut newest, 5, 1, &[0], 23);
        assert_eq!(newest.in_order(|&one| one), [(1, 21), (154, 22), (1, 23)]);
    }

    #[test]
    fn an_old_message_is_handed_back() {
        let mut newest = Newest::default();
        let source = Source::new(1, b"name");
        assert_eq!(newest.keep(1, source, 30, |entries| entries == 0), Kept::First);
        assert_eq!(newest.keep(1, source, 31, |_| false), Kept::Renewed(30));
        assert_eq!(newest.keep(2, source, 32, |entries| entries != 1), Kept::Refused(32));
    }

    #[test]
    fn r68_each_system_has_room_of_its_own() {
        let mut room = Room::default();
        assert!((0..Room::SHARED).all(|_| room.take(Room::OWN)));
        assert_eq!((room.take(Room::OWN), room.refused), (false, 1));
        assert_eq!((room.take(Room::OWN - 1), room.refused), (true, 1));
    }

    #[test]
    fn r68_the_target_s_parameters_are_kept_in_any_case() {
        let mut room = Room::default();
        assert!((0..Room::SHARED_PARAMS).all(|_| room.take_param(0, false)));
        assert!(!room.take_param(0, false));
        assert!(room.take_param(0, true));
        assert!(!room.take_param(Room::PARAMS, true));
        assert_eq!(room.refused, 2);
    }
}
