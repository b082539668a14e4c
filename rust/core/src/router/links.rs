//! Sets of links, small enough to be made for every frame.

use std::ops::{BitAnd, BitOr, Sub};

/// Links that a router can have at a time.
pub const MAX_LINKS: usize = 256;

const WORDS: usize = MAX_LINKS / 64;

/// One transport endpoint, as its router numbers it. Numbers of removed links are given out again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub u8);

impl LinkId {
    /// The number, to index with.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// A set of links.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LinkSet([u64; WORDS]);

impl LinkSet {
    /// No link.
    pub const EMPTY: Self = Self([0; WORDS]);

    /// One link.
    #[inline]
    pub fn only(link: LinkId) -> Self {
        let mut set = Self::EMPTY;
        set.insert(link);
        set
    }

    /// Adds a link.
    #[inline]
    pub fn insert(&mut self, link: LinkId) {
        self.0[link.index() / 64] |= 1 << (link.index() % 64);
    }

    /// Takes a link out.
    #[inline]
    pub fn remove(&mut self, link: LinkId) {
        self.0[link.index() / 64] &= !(1 << (link.index() % 64));
    }

    /// Whether a link is in it.
    #[inline]
    pub fn contains(&self, link: LinkId) -> bool {
        self.0[link.index() / 64] >> (link.index() % 64) & 1 == 1
    }

    /// Whether it has no link.
    #[inline]
    pub fn is_empty(&self) -> bool {
        *self == Self::EMPTY
    }

    /// How many links it has.
    pub fn len(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The links in rising order.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = LinkId> + use<> {
        let mut left = self.0;
        let mut word = 0;
        std::iter::from_fn(move || {
            while word < WORDS {
                let bits = left[word];
                if bits != 0 {
                    left[word] = bits & (bits - 1);
                    return Some(LinkId((word * 64) as u8 + bits.trailing_zeros() as u8));
                }
                word += 1;
            }
            None
        })
    }

    #[inline]
    fn zip(self, other: Self, with: impl Fn(u64, u64) -> u64) -> Self {
        Self(std::array::from_fn(|n| with(self.0[n], other.0[n])))
    }
}

impl BitOr for LinkSet {
    type Output = Self;

    #[inline]
    fn bitor(self, other: Self) -> Self {
        self.zip(other, |a, b| a | b)
    }
}

impl BitAnd for LinkSet {
    type Output = Self;

    #[inline]
    fn bitand(self, other: Self) -> Self {
        self.zip(other, |a, b| a & b)
    }
}

impl Sub for LinkSet {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a & !b)
    }
}

impl FromIterator<LinkId> for LinkSet {
    fn from_iter<I: IntoIterator<Item = LinkId>>(links: I) -> Self {
        let mut set = Self::EMPTY;
        links.into_iter().for_each(|link| set.insert(link));
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_is_what_was_put_into_it() {
        let numbers = [0, 1, 63, 64, 127, 128, 200, 255];
        let mut set: LinkSet = numbers.map(LinkId).into_iter().collect();
        assert_eq!(set.iter().map(|link| link.0).collect::<Vec<_>>(), numbers);
        assert_eq!((set.len(), set.is_empty()), (8, false));
        for link in (0..=255).map(LinkId) {
            assert_eq!(set.contains(link), numbers.contains(&link.0));
        }
        set.remove(LinkId(64));
        set.remove(LinkId(65));
        assert_eq!(set.len(), 7);
        let other: LinkSet = [LinkId(0), LinkId(9)].into_iter().collect();
        assert_eq!((set & other).iter().collect::<Vec<_>>(), [LinkId(0)]);
        assert_eq!((other - set), LinkSet::only(LinkId(9)));
        assert_eq!((set | other).len(), 8);
        assert!((set - set).is_empty());
    }
}
