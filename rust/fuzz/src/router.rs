//! The router: no frame goes back where it came from, and none to a link that is not there.

use mavwire_core::frame::FrameRef;
use mavwire_core::router::{ByteRate, Fate, Filter, Limits, LinkId, LinkOptions, Router, Settings};

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
        options.inbound = Filter::default().block_systems([input.byte()]);
    }
    if flags & 16 != 0 {
        options.outbound = Filter::default().allow_messages([0, 30, u32::from(input.number())]);
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

/// Any sequence of links that come and go and frames from any of them.
pub fn router(data: &[u8]) {
    let mut input = Input::new(data);
    let mut settings = Settings::new(input.long());
    settings.sniffer_sysid = input.byte();
    settings.max_age = u64::from(input.number()) * 1000;
    let mut router = Router::new(&ALL, settings);
    let (mut links, mut now, mut received) = (Vec::<LinkId>::new(), 0, 0_u64);
    while !input.is_empty() {
        now += u64::from(input.number()) * 100;
        match input.byte() % 8 {
            0 if links.len() < 16 => links.extend(router.add_link(options(&mut input))),
            1 if !links.is_empty() => {
                let gone = links.swap_remove(usize::from(input.byte()) % links.len());
                received -= router.remove_link(gone).map_or(0, |stats| stats.received);
                assert_eq!(router.link_stats(gone), None);
            }
            _ if links.is_empty() => links.extend(router.add_link(LinkOptions::default())),
            _ => {
                let source = links[usize::from(input.byte()) % links.len()];
                let frame = any_frame(&mut input);
                let header = *FrameRef::parse(&frame).expect("a frame").header();
                let entry = ALL.lookup(header.msgid);
                let fate = router.route(&frame, &header, entry, source, now);
                received += 1;
                if let Fate::Forwarded(to) = fate {
                    assert!(!to.contains(source), "back to where it came from");
                    assert!(to.iter().all(|link| links.contains(&link)), "to nowhere");
                    assert_ne!(header.msgid, 256, "a key is not forwarded");
                }
            }
        }
        let counted = links.iter().filter_map(|&link| router.link_stats(link));
        assert_eq!(counted.map(|stats| stats.received).sum::<u64>(), received);
    }
    assert!(router.components(now).count() <= 1 << 16);
}
