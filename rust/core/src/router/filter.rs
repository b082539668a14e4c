//! The filter of a link in one direction, by message, system and component of the sender.

use crate::frame::Header;

/// The frames' property that a list of a filter compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Message ids.
    Messages,
    /// Systems that frames come from.
    Systems,
    /// Components that frames come from.
    Components,
}

/// Lists of what may pass. Without a list everything may; a block list beats an allow list.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter([Ids; 3]);

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
    /// Lets only these numbers pass.
    #[must_use]
    pub fn allow(mut self, part: Part, ids: impl IntoIterator<Item = u32>) -> Self {
        self.0[part as usize].allow = Some(sorted(ids));
        self
    }

    /// Stops these numbers.
    #[must_use]
    pub fn block(mut self, part: Part, ids: impl IntoIterator<Item = u32>) -> Self {
        self.0[part as usize].block = sorted(ids);
        self
    }

    /// Nothing is stopped.
    pub fn is_open(&self) -> bool {
        self.0.iter().all(Ids::is_open)
    }

    /// Whether a frame may pass.
    #[inline]
    pub fn accept(&self, header: &Header) -> bool {
        self.admits(header.msgid, header.sysid, header.compid)
    }

    /// Whether a message from a system and component may pass.
    #[inline]
    pub fn admits(&self, msgid: u32, sysid: u8, compid: u8) -> bool {
        let [messages, systems, components] = &self.0;
        messages.accept(msgid) && systems.accept(sysid.into()) && components.accept(compid.into())
    }
}

#[cfg(test)]
mod tests {
    use super::Part::{Components, Messages, Systems};
    use super::*;
    use crate::testing::header;
    use mavwire_schema::WireVersion::V2;

    #[test]
    fn lists_let_pass_and_stop() {
        let cases = [
            (Filter::default(), true),
            (Filter::default().allow(Messages, [30, 0]), true),
            (Filter::default().allow(Messages, [31]), false),
            (Filter::default().allow(Messages, []), false),
            (Filter::default().block(Messages, [30]), false),
            (Filter::default().block(Messages, [31, 29]), true),
            (Filter::default().allow(Messages, [30]).block(Messages, [30]), false),
            (Filter::default().allow(Systems, [7, 1]), true),
            (Filter::default().allow(Systems, [2]), false),
            (Filter::default().block(Systems, [1]), false),
            (Filter::default().allow(Components, [1]), true),
            (Filter::default().block(Components, [1]), false),
            (Filter::default().allow(Systems, [1]).block(Components, [1]), false),
            (Filter::default().allow(Messages, [30]).allow(Systems, [2]), false),
        ];
        for (filter, passes) in cases {
            assert_eq!(filter.accept(&header(V2, 30, 0)), passes, "{filter:?}");
            assert_eq!(filter.is_open(), filter == Filter::default());
        }
    }
}
