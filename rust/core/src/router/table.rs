//! Which links lead to which system and component, and what each of them sent.
//!
//! A route lasts while its owner is heard. Each keeps the links of this epoch and of the one before, so that ageing is a
//! comparison at the next look and nothing has to be swept. The table is bounded by the protocol, which has 256 systems
//! of 256 components: some 10 MB if someone makes up all of them.

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

    fn keep(&mut self, links: LinkSet) {
        self.current = self.current & links;
        self.previous = self.previous & links;
    }

    /// Adds the links of another one, as old as they are there.
    fn join(&mut self, other: &Self, epoch: u32) {
        match epoch.wrapping_sub(other.epoch) {
            0 => {
                self.current = self.current | other.current;
                self.previous = self.previous | other.previous;
            }
            1 => self.previous = self.previous | other.current,
            _ => {}
        }
    }
}

/// What was heard from a component.
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
    route: Route,
    stats: ComponentStats,
    next_seq: u8,
    /// Its last `SYSTEM_TIME` over each link: there may be two that have the same address.
    boots: Vec<Boot>,
}

/// The time since boot that a component gave over a link.
#[derive(Debug, Clone, Copy)]
struct Boot {
    link: LinkId,
    /// `time_boot_ms`.
    age_ms: u32,
    /// When it came, in microseconds.
    at: u64,
}

impl Boot {
    /// Frames may overtake each other by so much, and clocks differ.
    const SLACK_MS: u32 = 5_000;
    /// No restart is faster. Two that have the same address are heard side by side; microseconds.
    const SILENCE: u64 = 3_000_000;

    /// Whether a later age means a restart.
    fn is_before_restart(&self, age_ms: u32) -> bool {
        age_ms < self.age_ms.saturating_sub(Self::SLACK_MS)
    }

    /// Whether a later one is of the same start: it grew as time went by.
    fn goes_on(&self, later: &Self) -> bool {
        let grown_ms = later.age_ms.saturating_sub(self.age_ms).saturating_add(Self::SLACK_MS);
        later.at.saturating_sub(self.at) / 1_000 <= u64::from(grown_ms)
    }

    fn is_silent(&self, now: u64) -> bool {
        now.saturating_sub(self.at) >= Self::SILENCE
    }
}

#[derive(Debug, Clone)]
struct System {
    /// The links of all its components.
    route: Route,
    components: Box<[Option<Box<Component>>; 256]>,
}

/// Who sent a frame, and what of it counts.
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
    fn entries(&mut self, sysid: u8, compid: u8) -> (&mut Route, &mut Component) {
        let system = self.systems[usize::from(sysid)].get_or_insert_with(|| System {
            route: Route::default(),
            components: Box::new([const { None }; 256]),
        });
        let component = system.components[usize::from(compid)].get_or_insert_with(Box::default);
        (&mut system.route, component)
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
        system.learn(links, epoch);
        component.route.learn(links, epoch);
        component.route.links(epoch)
    }

    /// Counts a copy of a frame from a component that was heard before.
    pub(super) fn count_duplicate(&mut self, sysid: u8, compid: u8) {
        let system = self.systems[usize::from(sysid)].as_mut();
        let component = system.and_then(|system| system.components[usize::from(compid)].as_mut());
        if let Some(component) = component {
            component.stats.duplicates += 1;
        }
    }

    /// Links over which a system was heard.
    #[inline]
    pub(super) fn system(&self, sysid: u8) -> LinkSet {
        let system = self.systems[usize::from(sysid)].as_ref();
        system.map_or(LinkSet::EMPTY, |system| system.route.links(self.epoch))
    }

    /// Links over which a component was heard; those of its system as long as it has not been heard itself.
    #[inline]
    pub(super) fn component(&self, sysid: u8, compid: u8) -> LinkSet {
        let epoch = self.epoch;
        let Some(system) = self.systems[usize::from(sysid)].as_ref() else {
            return LinkSet::EMPTY;
        };
        let component = system.components[usize::from(compid)].as_ref();
        let links = component.map_or(LinkSet::EMPTY, |component| component.route.links(epoch));
        if links.is_empty() { system.route.links(epoch) } else { links }
    }

    /// Notes the time since boot that a component gives over a link; true if that means that it was restarted.
    pub(super) fn is_reboot(
        &mut self,
        sysid: u8,
        compid: u8,
        link: LinkId,
        boot_ms: u32,
        now: u64,
    ) -> bool {
        let (_, Component { boots, .. }) = self.entries(sysid, compid);
        let boot = Boot { link, age_ms: boot_ms, at: now };
        let last = boots.iter().find(|last| last.link == link);
        let is_younger = last.is_some_and(|last| last.is_before_restart(boot_ms));
        // It may have come back over another link than before, be it one of earlier.
        let is_back = |other: &Boot| other.is_before_restart(boot_ms) && other.is_silent(now);
        let goes_on = last.is_some_and(|last| last.goes_on(&boot));
        let restarted = is_younger || !goes_on && boots.iter().any(is_back);
        // What it gave over other links before a restart would be one again.
        boots.retain(|other| other.link != link && !(restarted && other.is_silent(now)));
        boots.push(boot);
        restarted
    }

    /// Forgets the routes to a component over other links than these; those to the rest of its system stay.
    pub(super) fn forget_elsewhere(&mut self, sysid: u8, compid: u8, links: LinkSet) {
        let epoch = self.epoch;
        let Some(system) = &mut self.systems[usize::from(sysid)] else { return };
        if let Some(component) = &mut system.components[usize::from(compid)] {
            component.route.keep(links);
        }
        system.route = Route { epoch, ..Route::default() };
        for component in system.components.iter().flatten() {
            system.route.join(&component.route, epoch);
        }
    }

    /// Forgets all routes over a link.
    pub(super) fn forget_link(&mut self, link: LinkId) {
        let links = LinkSet::only(link);
        for system in self.systems.iter_mut().flatten() {
            system.route.forget(links);
            for component in system.components.iter_mut().flatten() {
                component.route.forget(links);
                component.boots.retain(|boot| boot.link != link);
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
                    Some((sysid, compid, component.stats, component.route.links(epoch)))
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
        table.count_duplicate(1, 1);
        table.count_duplicate(1, 2); // nobody knows it
        let lost = 2 + 4 + 1;
        let expected = ComponentStats { frames: 7, bytes: 140, lost, duplicates: 1, heard: 7 };
        let listed: Vec<_> = table.components(7).collect();
        assert_eq!(listed, [(1, 1, expected, link(0))]);
    }

    #[test]
    fn a_restart_shows_in_the_time_since_boot() {
        let mut table = Table::new(AGE);
        for (boot_ms, restarted) in
            [(60_000, false), (61_000, false), (60_500, false), (900, true), (1_000, false)]
        {
            assert_eq!(table.is_reboot(1, 1, LinkId(0), boot_ms, 0), restarted, "{boot_ms}");
            let twin = table.is_reboot(1, 1, LinkId(1), 100_000 + boot_ms, 0);
            assert_eq!(twin, restarted, "another one of that address: {boot_ms}");
        }
        table.forget_link(LinkId(0));
        assert!(!table.is_reboot(1, 1, LinkId(0), 0, 0), "a new link of the old number");
    }

    #[test]
    fn one_that_comes_back_over_another_link_was_silent_and_is_younger() {
        for (boot_ms, silence, restarted) in
            [(7_000, 3, true), (7_000, 2, false), (96_000, 4, false), (104_000, 4, false)]
        {
            let mut table = Table::new(AGE);
            assert!(!table.is_reboot(1, 1, LinkId(0), 100_000, 5));
            let back = table.is_reboot(1, 1, LinkId(1), boot_ms, 5 + silence * 1_000_000);
            assert_eq!(back, restarted, "{boot_ms} after {silence} s");
            assert!(!table.is_reboot(1, 1, LinkId(1), boot_ms + 57_000, 60_000_000), "only once");
        }
    }

    #[test]
    fn a_restart_is_seen_over_a_link_of_earlier_and_once() {
        let (usb, radio, wifi) = (LinkId(0), LinkId(1), LinkId(2));
        let mut table = Table::new(AGE);
        let mut steps = |steps: &[(LinkId, u32, u64, bool)]| {
            for &(link, age_s, at_s, restarted) in steps {
                let got = table.is_reboot(1, 1, link, age_s * 1_000, at_s * 1_000_000);
                assert_eq!(got, restarted, "{age_s} s over {link:?} at {at_s} s");
            }
        };
        steps(&[(usb, 3, 10, false), (radio, 5, 12, false), (radio, 3_600, 3_607, false)]);
        steps(&[(usb, 4, 3_620, true), (usb, 9, 3_625, false), (radio, 20, 3_636, false)]);
        steps(&[(usb, 100, 3_716, false), (radio, 2, 3_730, true), (radio, 50, 3_778, false)]);
        steps(&[(wifi, 50, 3_778, false), (usb, 60, 3_788, false), (radio, 61, 3_789, false)]);
    }

    #[test]
    fn two_of_one_address_that_seldom_tell_their_age_are_no_restarts() {
        let mut table = Table::new(AGE);
        for n in 0..10 {
            assert!(!table.is_reboot(1, 1, LinkId(0), n * 10_000, u64::from(n) * 10_000_000));
            let (age, at) = (1_000_000 + n * 10_000, u64::from(n) * 10_000_000 + 5_000_000);
            assert!(!table.is_reboot(1, 1, LinkId(1), age, at), "{n}");
        }
    }

    #[test]
    fn what_a_component_leaves_behind_is_forgotten_and_no_more() {
        let mut table = Table::new(AGE);
        table.learn(1, 1, link(0));
        table.learn(1, 2, link(2));
        table.advance(1_500);
        table.learn(1, 1, link(1));
        table.forget_elsewhere(1, 1, link(1));
        assert_eq!((table.component(1, 1), table.component(1, 2)), (link(1), link(2)));
        assert_eq!(table.system(1), link(1) | link(2));
        table.advance(2_000);
        assert_eq!(table.system(1), link(1), "as old as before");
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
