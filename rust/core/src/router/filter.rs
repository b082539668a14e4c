//! What may pass a link in one direction, by message, system and component of the sender.

use crate::frame::Header;

/// Lists of what may pass. Without a list everything may; a block list beats an allow list.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter {
    messages: Ids,
    systems: Ids,
    components: Ids,
}

/// Numbers that are let through; the lists are sorted.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Ids {
    allow: Option<Box<[u32]>>,
    block: Box<[u32]>,
}

impl Ids {
    #[inline]
    fn accept(&self, id: u32) -> bool {
        self.allow.as_ref().is_none_or(|ids| ids.binary_search(&id).is_ok())
            && self.block.binary_search(&id).is_err()
    }

    fn is_open(&self) -> bool {
        self.allow.is_none() && self.block.is_empty()
    }
}

fn sorted(ids: impl IntoIterator<Item = u32>) -> Box<[u32]> {
    let mut ids: Vec<u32> = ids.into_iter().collect();
    ids.sort_unstable();
    ids.dedup();
    ids.into()
}

impl Filter {
    /// Lets only these message ids pass.
    #[must_use]
    pub fn allow_messages(mut self, ids: impl IntoIterator<Item = u32>) -> Self {
        self.messages.allow = Some(sorted(ids));
        self
    }

    /// Stops these message ids.
    #[must_use]
    pub fn block_messages(mut self, ids: impl IntoIterator<Item = u32>) -> Self {
        self.messages.block = sorted(ids);
        self
    }

    /// Lets only frames of these systems pass.
    #[must_use]
    pub fn allow_systems(mut self, ids: impl IntoIterator<Item = u8>) -> Self {
        self.systems.allow = Some(sorted(ids.into_iter().map(u32::from)));
        self
    }

    /// Stops frames of these systems.
    #[must_use]
    pub fn block_systems(mut self, ids: impl IntoIterator<Item = u8>) -> Self {
        self.systems.block = sorted(ids.into_iter().map(u32::from));
        self
    }

    /// Lets only frames of these components pass.
    #[must_use]
    pub fn allow_components(mut self, ids: impl IntoIterator<Item = u8>) -> Self {
        self.components.allow = Some(sorted(ids.into_iter().map(u32::from)));
        self
    }

    /// Stops frames of these components.
    #[must_use]
    pub fn block_components(mut self, ids: impl IntoIterator<Item = u8>) -> Self {
        self.components.block = sorted(ids.into_iter().map(u32::from));
        self
    }

    /// Nothing is stopped.
    pub fn is_open(&self) -> bool {
        self.messages.is_open() && self.systems.is_open() && self.components.is_open()
    }

    /// Whether a frame may pass.
    #[inline]
    pub fn accept(&self, header: &Header) -> bool {
        self.admits(header.msgid, header.sysid, header.compid)
    }

    /// Whether a message from a system and component may pass.
    #[inline]
    pub fn admits(&self, msgid: u32, sysid: u8, compid: u8) -> bool {
        self.messages.accept(msgid)
            && self.systems.accept(sysid.into())
            && self.components.accept(compid.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::header;
    use mavwire_schema::WireVersion::V2;

    #[test]
    fn lists_let_pass_and_stop() {
        let cases = [
            (Filter::default(), true),
            (Filter::default().allow_messages([30, 0]), true),
            (Filter::default().allow_messages([31]), false),
            (Filter::default().allow_messages([]), false),
            (Filter::default().block_messages([30]), false),
            (Filter::default().block_messages([31, 29]), true),
            (Filter::default().allow_messages([30]).block_messages([30]), false),
            (Filter::default().allow_systems([7, 1]), true),
            (Filter::default().allow_systems([2]), false),
            (Filter::default().block_systems([1]), false),
            (Filter::default().allow_components([1]), true),
            (Filter::default().block_components([1]), false),
            (Filter::default().allow_systems([1]).block_components([1]), false),
            (Filter::default().allow_messages([30]).allow_systems([2]), false),
        ];
        for (filter, passes) in cases {
            assert_eq!(filter.accept(&header(V2, 30, 0)), passes, "{filter:?}");
            assert_eq!(filter.is_open(), filter == Filter::default());
        }
    }
}
