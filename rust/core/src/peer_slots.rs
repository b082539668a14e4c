//! Decides which peer of a server gives up its slot to a new one.
//!
//! A server has a fixed number of slots, and anyone can ask for any number of them. One address may hold all slots as long
//! as no other address wants one. Its share is three quarters of them. In a full server a new peer replaces the least
//! useful silent peer, or a peer beyond the share of its address. The replaced peer comes from the same address as the new
//! one, or from an address that holds more slots. So no single address takes the slots of the others. A peer that sends a
//! frame every few seconds keeps its slot.

use core::net::IpAddr;

/// A peer that sends a valid frame more often than this is active; microseconds.
pub const ACTIVE: u64 = 5_000_000;
/// A new peer has so long to send its first valid frame; microseconds.
pub const TIME_TO_PROVE: u64 = 1_000_000;

/// The IPv4 address of a peer, or its IPv6 network (/64): one host can use any number of addresses of its network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Origin(u64);

impl From<IpAddr> for Origin {
    fn from(address: IpAddr) -> Self {
        match address.to_canonical() {
            IpAddr::V4(address) => Self(address.to_bits().into()),
            IpAddr::V6(address) => Self((address.to_bits() >> 64) as u64),
        }
    }
}

/// How useful a peer is. Less useful peers are replaced first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Usefulness {
    /// It has sent no valid frame.
    Unproven,
    /// It has sent valid frames.
    Heard,
    /// It has sent a frame to a known system, or proved that it has the key.
    Useful,
}

/// A peer that holds a slot.
#[derive(Debug, Clone, Copy)]
pub struct SlotHolder {
    /// Its address.
    pub origin: Origin,
    /// Its rank.
    pub usefulness: Usefulness,
    /// Time since its last valid frame, or since it came if it has sent none; microseconds.
    pub silence: u64,
}

impl SlotHolder {
    fn is_silent(&self) -> bool {
        let patience = if self.usefulness == Usefulness::Unproven { TIME_TO_PROVE } else { ACTIVE };
        self.silence > patience
    }
}

/// The outcome for a new peer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// A slot is free.
    Free,
    /// It gets the slot of the peer at this position.
    Replace(usize),
    /// It gets no slot.
    Refused,
}

/// The slot of a new peer from `origin` in a server with `room` slots, held by `peers`.
pub fn slot_for(origin: Origin, peers: &[SlotHolder], room: usize) -> Slot {
    if peers.len() < room {
        return Slot::Free;
    }
    let share = room * 3 / 4;
    let mut origins: Vec<Origin> = peers.iter().map(|peer| peer.origin).collect();
    origins.sort_unstable();
    let count = |of: Origin| {
        let end = origins.partition_point(|&other| other <= of);
        end - origins.partition_point(|&other| other < of)
    };
    let own = count(origin);
    let candidates = peers.iter().enumerate().filter_map(|(n, peer)| {
        let held = count(peer.origin);
        let is_foreign = peer.origin != origin;
        let is_beyond_share = is_foreign && held > share;
        let may_go = (!is_foreign || held > own) && (peer.is_silent() || is_beyond_share);
        may_go.then_some((!is_beyond_share, peer.usefulness, u64::MAX - peer.silence, n))
    });
    candidates.min().map_or(Slot::Refused, |(.., n)| Slot::Replace(n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::net::{Ipv4Addr, Ipv6Addr};
    use proptest::prelude::*;

    const SECOND: u64 = 1_000_000;
    const ROOM: usize = 64;

    fn peer(origin: u64, usefulness: Usefulness, seconds: u64) -> SlotHolder {
        SlotHolder { origin: Origin(origin), usefulness, silence: seconds * SECOND }
    }

    fn slot(origin: u64, peers: &[SlotHolder]) -> Slot {
        slot_for(Origin(origin), peers, ROOM)
    }

    #[test]
    fn origins_are_hosts_and_networks() {
        let v4 = |octets: [u8; 4]| Origin::from(IpAddr::from(Ipv4Addr::from(octets)));
        let v6 = |text: &str| Origin::from(IpAddr::from(text.parse::<Ipv6Addr>().expect("one")));
        assert_ne!(v4([10, 0, 0, 1]), v4([10, 0, 0, 2]));
        assert_eq!(v6("::ffff:10.0.0.1"), v4([10, 0, 0, 1]));
        assert_eq!(v6("2001:db8:1:2::1"), v6("2001:db8:1:2:ffff::9"));
        assert_ne!(v6("2001:db8:1:2::1"), v6("2001:db8:1:3::1"));
    }

    #[test]
    fn one_address_may_have_all_slots_until_another_wants_one() {
        for usefulness in [Usefulness::Heard, Usefulness::Useful] {
            let mut peers = Vec::new();
            while slot(1, &peers) == Slot::Free {
                peers.push(peer(1, usefulness, 0));
            }
            assert_eq!((peers.len(), slot(1, &peers)), (ROOM, Slot::Refused), "all are active");
            // The others get a quarter of the slots. They get no more from active peers.
            for n in 0..ROOM / 4 {
                let Slot::Replace(gone) = slot(2 + n as u64, &peers) else {
                    panic!("{n}: {peers:?}")
                };
                assert_eq!(peers[gone].origin, Origin(1));
                peers[gone] = peer(2 + n as u64, usefulness, 0);
            }
            assert_eq!(slot(99, &peers), Slot::Refused);
        }
    }

    #[test]
    fn a_frame_a_minute_keeps_no_slot() {
        let crowd: Vec<SlotHolder> = (0..64).map(|n| peer(1, Usefulness::Useful, n)).collect();
        assert_eq!(slot(2, &crowd), Slot::Replace(63), "the longest silent");
        let many: Vec<SlotHolder> = (0..64).map(|n| peer(n, Usefulness::Heard, n)).collect();
        assert_eq!(slot(99, &many), Slot::Replace(63));
        assert_eq!(
            slot(3, &many),
            Slot::Refused,
            "no address has more slots than address 3, and its own peer is active"
        );
        assert_eq!(slot(33, &many), Slot::Replace(33), "its own");
    }

    #[test]
    fn the_least_useful_goes_first() {
        use Usefulness::{Heard, Unproven, Useful};
        let mut peers: Vec<SlotHolder> = (0..64).map(|n| peer(n, Useful, 50)).collect();
        (peers[7], peers[8]) = (peer(7, Heard, 6), peer(8, Heard, 7));
        assert_eq!(slot(99, &peers), Slot::Replace(8));
        peers[9] = peer(9, Unproven, 2);
        assert_eq!(slot(99, &peers), Slot::Replace(9));
        peers[9] = peer(9, Unproven, 1);
        assert_eq!(slot(99, &peers), Slot::Replace(8), "it has time to prove itself");
    }

    fn any_peer() -> impl Strategy<Value = SlotHolder> {
        let usefulness = prop_oneof![
            Just(Usefulness::Unproven),
            Just(Usefulness::Heard),
            Just(Usefulness::Useful)
        ];
        (0..4_u64, usefulness, 0..100_u64)
            .prop_map(|(origin, usefulness, s)| peer(origin, usefulness, s))
    }

    proptest! {
        #[test]
        fn active_peers_within_their_share_keep_their_slots(
            mut peers in prop::collection::vec(any_peer(), 8..9),
            asking in prop::collection::vec(0..6_u64, 1..40),
        ) {
            for origin in asking {
                let before = peers.clone();
                let count = |of: Origin| before.iter().filter(|one| one.origin == of).count();
                let Slot::Replace(n) = slot_for(Origin(origin), &peers, 8) else { continue };
                let gone = &before[n];
                prop_assert!(gone.is_silent() || count(gone.origin) > 6);
                prop_assert!(gone.origin == Origin(origin) || count(gone.origin) > count(Origin(origin)));
                peers[n] = peer(origin, Usefulness::Heard, 0);
            }
        }
    }
}
