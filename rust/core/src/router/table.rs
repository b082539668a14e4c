//! Which links lead to which system and component, and what each of them sent.
//!
//! A route lasts while its owner is heard. Each keeps the links of this epoch and of the one before, so that ageing is a
//! comparison at the next look and nothing has to be swept. The table is bounded by the protocol, which has 256 systems
//! of 256 components: some 15 MB if a sender makes up all of them.

use super::links::{LinkId, LinkSet};

/// The links that lead somewhere.
#[derive(Debug, Clone, Copy, Default)]
struct Route {
    current: LinkSet,
    previous: LinkSet,
    epoch: u32,
}

impl Route {
    #[inline]
    fn learn(&mut self, links: LinkSet, epoch: u32) {
        if epoch != self.epoch {
            let next = epoch.wrapping_sub(self.epoch) == 1;
            self.previous = if next { self.current } else { LinkSet::EMPTY };
            self.current = LinkSet::EMPTY;
            self.epoch = epoch;
        }
        self.current = self.current | links;
    }

    #[inline]
    fn links(&self, epoch: u32) -> LinkSet {
        match epoch.wrapping_sub(self.epoch) {
            0 => self.current | self.previous,
            1 => self.current,
            _ => LinkSet::EMPTY,
        }
    }

    fn forget(&mut self, links: LinkSet) {
        self.current = self.current - links;
        self.previous = self.previous - links;
    }
}

/// The links that lead to a system or a component.
#[derive(Debug, Clone, Copy, Default)]
struct Routes {
    /// Links where its frames came first.
    heard: Route,
    /// Links where copies of its frames came after that. Others were faster, and the route is as good as before. Copies do
    /// not count in `heard`: a ring of bridges would lose its second route otherwise.
    renewed: Route,
}

impl Routes {
    #[inline]
    fn links(&self, epoch: u32) -> LinkSet {
        self.heard.links(epoch) | self.renewed.links(epoch)
    }

    /// Renews known routes for a copy that came over `links`. A copy makes no new route.
    fn renew(&mut self, links: LinkSet, epoch: u32) {
        let known = self.links(epoch) & links;
        if !known.is_empty() {
            self.renewed.learn(known, epoch);
        }
    }

    fn forget(&mut self, links: LinkSet) {
        self.heard.forget(links);
        self.renewed.forget(links);
    }
}

/// Counts of the frames received from a component.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ComponentStats {
    /// Frames, without duplicates.
    pub frames: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Frames missing in the sequence numbers. One that comes late was counted and stays so.
    pub lost: u64,
    /// Copies of its frames that came over another link.
    pub duplicates: u64,
    /// When it was heard last, in microseconds.
    pub heard: u64,
}

#[derive(Debug, Clone, Default)]
struct Component {
    routes: Routes,
    stats: ComponentStats,
    next_seq: u8,
}

#[derive(Debug, Clone)]
struct System {
    /// The links of all its components.
    routes: Routes,
    components: Box<[Option<Box<Component>>; 256]>,
}

/// A frame's sender and the numbers of the frame that its counters need.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sender {
    pub(super) sysid: u8,
    pub(super) compid: u8,
    pub(super) seq: u8,
    pub(super) len: usize,
}

#[derive(Debug, Clone)]
pub(super) struct Table {
    systems: Vec<Option<System>>,
    /// Microseconds.
    epoch_len: u64,
    epoch: u32,
    /// When this epoch ends: dividing for every frame would cost as much as finding its sender.
    epoch_end: u64,
}

impl Table {
    /// Routes are forgotten between `max_age` and twice that after their owner was heard; microseconds.
    pub(super) fn new(max_age: u64) -> Self {
        let epoch_len = max_age.max(1);
        let systems = (0..256).map(|_| None).collect();
        Self { systems, epoch_len, epoch: 0, epoch_end: epoch_len }
    }

    /// Moves on to a moment; everything below is about that.
    #[inline]
    pub(super) fn advance(&mut self, now: u64) {
        if now >= self.epoch_end {
            self.epoch = (now / self.epoch_len) as u32;
            self.epoch_end = (now / self.epoch_len + 1).saturating_mul(self.epoch_len);
        }
    }

    /// The entries of a system and one of its components.
    #[inline]
    fn entries(&mut self, sysid: u8, compid: u8) -> (&mut Routes, &mut Component) {
        let system = self.systems[usize::from(sysid)].get_or_insert_with(|| System {
            routes: Routes::default(),
            components: Box::new([const { None }; 256]),
        });
        let component = system.components[usize::from(compid)].get_or_insert_with(Box::default);
        (&mut system.routes, component)
    }

    /// Notes that a frame is heard over `links`, and what is missing before it; returns all the links its sender lives at.
    #[inline]
    pub(super) fn hear(&mut self, sender: Sender, links: LinkSet, now: u64) -> LinkSet {
        let epoch = self.epoch;
        let (system, component) = self.entries(sender.sysid, sender.compid);
        let missing = sender.seq.wrapping_sub(component.next_seq);
        if component.stats.frames > 0 && missing < 128 {
            component.stats.lost += u64::from(missing);
        }
        component.next_seq = sender.seq.wrapping_add(1);
        component.stats.frames += 1;
        component.stats.bytes += sender.len as u64;
        component.stats.heard = now;
        system.heard.learn(links, epoch);
        component.routes.heard.learn(links, epoch);
        component.routes.heard.links(epoch)
    }

    /// Counts a copy of a frame that came over `links` from a component that was heard before.
    pub(super) fn hear_duplicate(&mut self, sysid: u8, compid: u8, links: LinkSet) {
        let epoch = self.epoch;
        let Some(system) = &mut self.systems[usize::from(sysid)] else { return };
        if let Some(component) = &mut system.components[usize::from(compid)] {
            component.stats.duplicates += 1;
            component.routes.renew(links, epoch);
            system.routes.renew(links, epoch);
        }
    }

    /// Links over which a system was heard.
    #[inline]
    pub(super) fn system(&self, sysid: u8) -> LinkSet {
        let system = self.systems[usize::from(sysid)].as_ref();
        system.map_or(LinkSet::EMPTY, |system| system.routes.links(self.epoch))
    }

    /// Links over which a component was heard; those of its system as long as it has not been heard itself.
    #[inline]
    pub(super) fn component(&self, sysid: u8, compid: u8) -> LinkSet {
        let epoch = self.epoch;
        let Some(system) = self.systems[usize::from(sysid)].as_ref() else {
            return LinkSet::EMPTY;
        };
        let component = system.components[usize::from(compid)].as_ref();
        let links = component.map_or(LinkSet::EMPTY, |component| component.routes.links(epoch));
        if links.is_empty() { system.routes.links(epoch) } else { links }
    }

    /// Forgets all routes over a link.
    pub(super) fn forget_link(&mut self, link: LinkId) {
        let links = LinkSet::only(link);
        for system in self.systems.iter_mut().flatten() {
            system.routes.forget(links);
            for component in system.components.iter_mut().flatten() {
                component.routes.forget(links);
            }
        }
    }

    /// Everyone who was heard since the router was made, with the links that lead there now.
    pub(super) fn components(
        &self,
        now: u64,
    ) -> impl Iterator<Item = (u8, u8, ComponentStats, LinkSet)> {
        let epoch = (now / self.epoch_len) as u32;
        let systems = (0..=u8::MAX).zip(&self.systems);
        systems.filter_map(|(sysid, system)| Some((sysid, system.as_ref()?))).flat_map(
            move |(sysid, system)| {
                let components = (0..=u8::MAX).zip(system.components.iter());
                components.filter_map(move |(compid, component)| {
                    let component = component.as_ref()?;
                    Some((sysid, compid, component.stats, component.routes.links(epoch)))
                })
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AGE: u64 = 1_000;

    impl Table {
        fn learn(&mut self, sysid: u8, compid: u8, links: LinkSet) -> LinkSet {
            self.hear(Sender { sysid, compid, seq: 0, len: 0 }, links, 0)
        }
    }

    fn link(n: u8) -> LinkSet {
        LinkSet::only(LinkId(n))
    }

    #[test]
    fn routes_age_and_come_back() {
        let mut table = Table::new(AGE);
        table.advance(500);
        assert_eq!(table.learn(1, 1, link(3)), link(3));
        assert_eq!(table.learn(1, 1, link(4)), link(3) | link(4));
        table.advance(1_900);
        assert_eq!(table.system(1), link(3) | link(4), "at least its age");
        assert_eq!(table.learn(1, 1, link(4)), link(3) | link(4));
        table.advance(2_000);
        assert_eq!(table.component(1, 1), link(4), "link 3 is quiet for too long");
        table.advance(3_999);
        assert_eq!(table.component(1, 1), LinkSet::EMPTY);
        table.advance(9_000);
        assert_eq!(table.learn(1, 1, link(5)), link(5));
        table.advance(u64::MAX);
        assert_eq!(table.learn(1, 1, link(6)), link(6));
    }

    #[test]
    fn a_component_that_is_not_known_is_looked_for_at_its_system() {
        let mut table = Table::new(AGE);
        table.learn(1, 1, link(0));
        table.learn(1, 2, link(1));
        assert_eq!(table.component(1, 1), link(0));
        assert_eq!(table.component(1, 2), link(1));
        assert_eq!(table.component(1, 9), link(0) | link(1));
        assert_eq!(table.component(2, 1), LinkSet::EMPTY);
    }

    #[test]
    fn r17_missing_numbers_are_counted() {
        let mut table = Table::new(AGE);
        for seq in [250, 251, 254, 3, 1, 2, 4] {
            table.hear(Sender { sysid: 1, compid: 1, seq, len: 20 }, link(0), 7);
        }
        table.hear_duplicate(1, 1, link(0));
        table.hear_duplicate(1, 2, link(0)); // nobody knows it
        let lost = 2 + 4 + 1;
        let expected = ComponentStats { frames: 7, bytes: 140, lost, duplicates: 1, heard: 7 };
        let listed: Vec<_> = table.components(7).collect();
        assert_eq!(listed, [(1, 1, expected, link(0))]);
    }

    #[test]
    fn copies_renew_a_route_and_make_none() {
        let mut table = Table::new(AGE);
        table.learn(1, 1, link(0));
        table.learn(1, 1, link(1));
        for now in [1_500, 2_500, 3_500] {
            table.advance(now);
            assert_eq!(table.learn(1, 1, link(1)) - link(0), link(1));
            table.hear_duplicate(1, 1, link(0));
            table.hear_duplicate(1, 1, link(2));
            assert_eq!(table.component(1, 1), link(0) | link(1), "{now}");
            assert_eq!(table.system(1), link(0) | link(1), "{now}");
        }
        assert_eq!(table.learn(1, 1, link(1)), link(1), "it was not heard there for long");
        table.forget_link(LinkId(0));
        assert_eq!((table.system(1), table.component(1, 1)), (link(1), link(1)));
    }

    #[test]
    fn links_are_forgotten() {
        let mut table = Table::new(AGE);
        table.learn(2, 1, link(0));
        table.learn(2, 1, link(1));
        table.forget_link(LinkId(0));
        assert_eq!((table.system(2), table.component(2, 1)), (link(1), link(1)));
    }
}
