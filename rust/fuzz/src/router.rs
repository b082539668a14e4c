//! The router: where each frame goes and what is counted of it, beside a plain account of who was heard where.

use std::collections::BTreeMap;

use mavwire_core::frame::{FrameRef, Header};
use mavwire_core::router::{
    ByteRate, ComponentStats, Fate, Filter, Limits, LinkId, LinkOptions, LinkStats, Part, Router,
    Settings,
};

use crate::dialects::{ALL, any_frame};
use crate::input::Input;

fn options(input: &mut Input<'_>) -> LinkOptions {
    let flags = input.byte();
    let mut options = LinkOptions {
        group: (flags & 1 != 0).then_some(u16::from(flags >> 6)),
        private: flags & 2 != 0,
        sniffer: flags & 4 != 0,
        ..LinkOptions::default()
    };
    if flags & 8 != 0 {
        options.inbound = Filter::default().block(Part::Systems, [input.byte().into()]);
    }
    if flags & 16 != 0 {
        options.outbound =
            Filter::default().allow(Part::Messages, [0, 30, u32::from(input.number())]);
    }
    if flags & 32 != 0 {
        let rate = f64::from(input.number());
        options.limits = Limits {
            bytes_per_second: Some(ByteRate::new(rate)),
            message_rate: Some(rate / 100.0),
            ..Limits::default()
        };
    }
    options
}

/// The expected state of a component: its counts, its next sequence number, and the links that it was ever heard on.
#[derive(Default)]
struct Heard {
    stats: ComponentStats,
    next_seq: u8,
    links: Vec<LinkId>,
}

#[derive(Default)]
struct Account {
    links: BTreeMap<LinkId, (LinkOptions, LinkStats)>,
    senders: BTreeMap<(u8, u8), Heard>,
    sniffer_sysid: u8,
}

impl Account {
    fn options(&self, link: LinkId) -> &LinkOptions {
        &self.links[&link].0
    }

    /// The link and those of its group.
    fn group(&self, link: LinkId) -> Vec<LinkId> {
        let group = self.options(link).group;
        let own = |other: &LinkId| {
            *other == link || group.is_some() && self.options(*other).group == group
        };
        self.links.keys().copied().filter(own).collect()
    }

    /// Whether a system, or one component of it, was ever heard over a link.
    fn was_heard(&self, link: LinkId, sysid: u8, compid: Option<u8>) -> bool {
        let mut heard = self.senders.iter().filter(|(_, one)| one.links.contains(&link));
        heard.any(|(id, _)| id.0 == sysid && compid.is_none_or(|compid| id.1 == compid))
    }

    fn note(&mut self, fate: Fate, header: &Header, len: usize, source: LinkId, now: u64) {
        let group = self.group(source);
        let stats = &mut self.links.get_mut(&source).expect("a link").1;
        stats.received += 1;
        stats.received_bytes += len as u64;
        match fate {
            Fate::Filtered => stats.filtered_in += 1,
            Fate::Duplicate => stats.duplicates += 1,
            Fate::Withheld => stats.withheld += 1,
            Fate::Unroutable => stats.unroutable += 1,
            Fate::Forwarded(_) => {}
        }
        let id = (header.sysid, header.compid);
        match fate {
            Fate::Duplicate => {
                if let Some(sender) = self.senders.get_mut(&id) {
                    sender.stats.duplicates += 1;
                }
            }
            Fate::Forwarded(_) | Fate::Unroutable => {
                let Heard { stats, next_seq, links } = self.senders.entry(id).or_default();
                let missing = header.seq.wrapping_sub(*next_seq);
                stats.lost += if stats.frames > 0 && missing < 128 { missing.into() } else { 0 };
                *next_seq = header.seq.wrapping_add(1);
                (stats.frames, stats.bytes, stats.heard) =
                    (stats.frames + 1, stats.bytes + len as u64, now);
                links.extend(group);
            }
            Fate::Filtered | Fate::Withheld => {}
        }
    }

    /// A target is where it was heard; what has none goes everywhere else; nothing passes a filter that stops it.
    fn check(&self, fate: Fate, frame: &FrameRef<'_>, source: LinkId) {
        let header = frame.header();
        let message = ALL.lookup(header.msgid).map(|entry| ALL.message(entry.index));
        let byte = |at: Option<u8>| {
            at.and_then(|at| frame.payload().get(usize::from(at))).copied().unwrap_or(0)
        };
        let target = message.map_or(0, |message| byte(message.target_system_offset));
        let group = self.group(source);
        let passes = self.options(source).inbound.accept(header);
        assert_eq!(fate == Fate::Filtered, !passes);
        if header.msgid == 256 {
            assert!(matches!(fate, Fate::Filtered | Fate::Duplicate | Fate::Withheld), "a key");
        }
        assert!(fate != Fate::Unroutable || target != 0, "a broadcast can always be routed");
        let Fate::Forwarded(to) = fate else { return };
        for (&link, (options, _)) in &self.links {
            let is_sniffer = options.sniffer || self.was_heard(link, self.sniffer_sysid, None);
            let sysid = if target == 0 { None } else { Some(target) };
            let is_target = sysid.map_or(!options.private, |id| self.was_heard(link, id, None));
            if to.contains(link) {
                assert!(!group.contains(&link), "back to where it came from");
                assert!(options.outbound.accept(header), "through a filter");
                assert!(is_target || is_sniffer, "to who has nothing to do with it");
            } else if sysid.is_none() && !options.private || options.sniffer {
                let lives_there = self.was_heard(link, header.sysid, Some(header.compid));
                let is_stopped = !options.outbound.accept(header) || !options.limits.is_open();
                assert!(lives_there || is_stopped || group.contains(&link), "left out");
            }
        }
        assert!(to.iter().all(|link| self.links.contains_key(&link)), "to nowhere");
    }
}

/// Any sequence of links that come and go and frames from any of them.
pub fn router(data: &[u8]) {
    let mut input = Input::new(data);
    let mut settings = Settings::new(input.long());
    settings.sniffer_sysid = input.byte();
    settings.max_age = u64::from(input.number()) * 1000;
    let mut router = Router::new(&ALL, settings);
    let mut account = Account { sniffer_sysid: settings.sniffer_sysid, ..Account::default() };
    let (mut now, mut last) = (0, Vec::new());
    while !input.is_empty() {
        now += u64::from(input.number()) * 100;
        let step = input.byte();
        let count = account.links.len();
        if count == 0 || step.is_multiple_of(8) && count < 16 {
            let options = options(&mut input);
            let link = router.add_link(options.clone()).expect("there is room");
            account.links.insert(link, (options, LinkStats::default()));
            continue;
        }
        let nth = usize::from(input.byte()) % count;
        let link = *account.links.keys().nth(nth).expect("a link");
        if step % 8 == 1 {
            let stats = router.remove_link(link).expect("it was there");
            same_counts(stats, account.links.remove(&link).expect("it was there").1);
            assert_eq!(router.link_stats(link), None);
            account.senders.values_mut().for_each(|sender| sender.links.retain(|&one| one != link));
            continue;
        }
        // The same once more is a copy where it comes over another link.
        let frame = if step % 8 == 2 && !last.is_empty() { last } else { any_frame(&mut input) };
        let whole = FrameRef::parse(&frame).expect("a frame");
        let header = *whole.header();
        let fate = router.route(&frame, &header, ALL.lookup(header.msgid), link, now);
        account.note(fate, &header, frame.len(), link, now);
        account.check(fate, &whole, link);
        last = frame;
        same_counts(router.link_stats(link).expect("a link"), account.links[&link].1);
    }
    let counted = router.components(now).map(|(sysid, compid, stats, _)| ((sysid, compid), stats));
    let expected = account.senders.iter().map(|(&id, sender)| (id, sender.stats));
    assert!(counted.eq(expected), "components are counted");
}

/// Frames stopped on the way out are not counted here, nor those that only a sniffer got.
fn same_counts(found: LinkStats, noted: LinkStats) {
    let LinkStats { filtered_out, limited, unroutable, .. } = found;
    assert_eq!(found, LinkStats { filtered_out, limited, unroutable, ..noted });
    assert!((noted.unroutable..=noted.received).contains(&unroutable));
}
