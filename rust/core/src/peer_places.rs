//! Which peer of a server makes room for a new one.
//!
//! A server has so many places, and anyone can ask for any number of them. An address may hold all places as long as no
//! other one wants them; three quarters are its share. In a full server a new peer gets the place of the least useful peer
//! that is silent, or of one beyond the share of its address. It comes from its own address or from one with more places,
//! so that no single address takes the places of the others. A peer that is heard every few seconds stays.

use core::net::IpAddr;

/// A peer that is heard more often than this is active; microseconds.
pub const ACTIVE: u64 = 5_000_000;
/// A new peer has this long for its first good frame; microseconds.
pub const TIME_TO_PROVE: u64 = 1_000_000;

/// Where a peer comes from: an IPv4 address, or the network of an IPv6 address, which has any number of addresses.
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

/// How useful a peer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// It sent no good frame.
    Unproven,
    /// It sent good frames.
    Heard,
    /// It sent something to a system that is known, or proved that it has the key.
    Useful,
}

/// What is known of a peer.
#[derive(Debug, Clone, Copy)]
pub struct Peer {
    /// Where it comes from.
    pub origin: Origin,
    /// How useful it is.
    pub standing: Standing,
    /// For how long it sent no good frame, or has been there without one; microseconds.
    pub silence: u64,
}

impl Peer {
    fn is_silent(&self) -> bool {
        let patience = if self.standing == Standing::Unproven { TIME_TO_PROVE } else { ACTIVE };
        self.silence > patience
    }
}

/// What becomes of a new peer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A place is free.
    Free,
    /// The peer at this position makes room.
    Of(usize),
    /// It is turned away.
    None,
}

/// The place of a new peer from `origin` beside the `peers` of a server that has `room` for so many.
pub fn place_for(origin: Origin, peers: &[Peer], room: usize) -> Place {
    if peers.len() < room {
        return Place::Free;
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
        may_go.then_some((!is_beyond_share, peer.standing, u64::MAX - peer.silence, n))
    });
    candidates.min().map_or(Place::None, |(.., n)| Place::Of(n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::net::{Ipv4Addr, Ipv6Addr};
    use proptest::prelude::*;

    const SECOND: u64 = 1_000_000;
    const ROOM: usize = 64;

    fn peer(origin: u64, standing: Standing, seconds: u64) -> Peer {
        Peer { origin: Origin(origin), standing, silence: seconds * SECOND }
    }

    fn place(origin: u64, peers: &[Peer]) -> Place {
        place_for(Origin(origin), peers, ROOM)
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
    fn one_address_may_have_all_places_until_another_wants_one() {
        for standing in [Standing::Heard, Standing::Useful] {
            let mut peers = Vec::new();
            while place(1, &peers) == Place::Free {
                peers.push(peer(1, standing, 0));
            }
            assert_eq!((peers.len(), place(1, &peers)), (ROOM, Place::None), "all are active");
            // The others get a quarter, and no more of those that are active.
            for n in 0..ROOM / 4 {
                let Place::Of(gone) = place(2 + n as u64, &peers) else { panic!("{n}: {peers:?}") };
                assert_eq!(peers[gone].origin, Origin(1));
                peers[gone] = peer(2 + n as u64, standing, 0);
            }
            assert_eq!(place(99, &peers), Place::None);
        }
    }

    #[test]
    fn a_frame_a_minute_holds_no_place() {
        let crowd: Vec<Peer> = (0..64).map(|n| peer(1, Standing::Useful, n)).collect();
        assert_eq!(place(2, &crowd), Place::Of(63), "the longest silent");
        let many: Vec<Peer> = (0..64).map(|n| peer(n, Standing::Heard, n)).collect();
        assert_eq!(place(99, &many), Place::Of(63));
        assert_eq!(place(3, &many), Place::None, "each has one, and its own is active");
        assert_eq!(place(33, &many), Place::Of(33), "its own");
    }

    #[test]
    fn the_least_useful_goes_first() {
        use Standing::{Heard, Unproven, Useful};
        let mut peers: Vec<Peer> = (0..64).map(|n| peer(n, Useful, 50)).collect();
        (peers[7], peers[8]) = (peer(7, Heard, 6), peer(8, Heard, 7));
        assert_eq!(place(99, &peers), Place::Of(8));
        peers[9] = peer(9, Unproven, 2);
        assert_eq!(place(99, &peers), Place::Of(9));
        peers[9] = peer(9, Unproven, 1);
        assert_eq!(place(99, &peers), Place::Of(8), "it has time to prove itself");
    }

    fn any_peer() -> impl Strategy<Value = Peer> {
        let standing =
            prop_oneof![Just(Standing::Unproven), Just(Standing::Heard), Just(Standing::Useful)];
        (0..4_u64, standing, 0..100_u64).prop_map(|(origin, standing, s)| peer(origin, standing, s))
    }

    proptest! {
        #[test]
        fn whoever_asks_takes_no_place_of_an_active_peer_within_its_share(
            mut peers in prop::collection::vec(any_peer(), 8..9),
            asking in prop::collection::vec(0..6_u64, 1..40),
        ) {
            for origin in asking {
                let before = peers.clone();
                let count = |of: Origin| before.iter().filter(|one| one.origin == of).count();
                let Place::Of(n) = place_for(Origin(origin), &peers, 8) else { continue };
                let gone = &before[n];
                prop_assert!(gone.is_silent() || count(gone.origin) > 6);
                prop_assert!(gone.origin == Origin(origin) || count(gone.origin) > count(Origin(origin)));
                peers[n] = peer(origin, Standing::Heard, 0);
            }
        }
    }
}
