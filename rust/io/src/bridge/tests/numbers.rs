//! Tests of the counters, and of the numbers that the bridge hands out.

use super::*;
use mavwire_core::border::BorderOptions;
use mavwire_core::router::LinkOptions;
use mavwire_core::signing::SecretKey;
use mavwire_core::unknown::UnknownCounts;

fn with_key(name: &str, endpoint: Endpoint, verify: bool) -> LinkSpec {
    let key = Some(Arc::new(SecretKey::new(&[7; 32]).expect("32 bytes")));
    let border = BorderOptions { key, verify, sign: true, ..BorderOptions::default() };
    let mut spec = link(name, endpoint);
    spec.port.options = LinkOptions { border, ..LinkOptions::default() };
    spec
}

#[test]
fn no_two_links_sign_with_one_link_id() {
    let bridge = start(None);
    let add = |name: &str| {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(LIMIT)).unwrap();
        let port = socket.local_addr().unwrap().port();
        let endpoint = Endpoint::Net { kind: NetKind::UdpClient, host: local(), port };
        bridge.add(with_key(name, endpoint, false)).unwrap();
        socket
    };
    let first = add("first");
    for _ in 0..255 {
        add("guest");
        bridge.remove("guest").unwrap();
    }
    let last = add("last");
    bridge.send(&heartbeat(1, 1)).unwrap();
    let [one, other] = [&first, &last].map(|socket| receive(socket).0);
    assert_eq!((one.len(), other.len()), (34, 34), "signed");
    assert_ne!(one[21], other[21], "the link id");
}

#[test]
fn for_a_stranger_nothing_is_dropped() {
    let bridge = start(None);
    let endpoint = Endpoint::Net { kind: NetKind::TcpServer, host: local(), port: 0 };
    bridge.add(with_key("clients", endpoint, true)).unwrap();
    let address = (Ipv4Addr::LOCALHOST, server_port(&bridge, "clients"));
    let _stranger = TcpStream::connect(address).unwrap();
    wait_for("it", || report(&bridge, "clients").connections == 1);
    let station = station(&bridge, "station");
    bridge.send(&heartbeat(1, 1)).unwrap();
    receive(&station);
    let links = bridge.stats().unwrap().links;
    let stranger = links.iter().find(|link| link.peer.is_some() && link.name == "clients");
    let traffic = stranger.expect("it is connected").traffic;
    assert_eq!((traffic.sent, traffic.dropped), (0, 0));
}

#[test]
fn what_left_after_all_was_not_refused() {
    let bridge = start(None);
    drop(station(&bridge, "nobody"));
    for seq in 0..10 {
        bridge.send(&heartbeat(1, seq)).unwrap();
        wait_for("it", || report(&bridge, "nobody").traffic.sent == u64::from(seq) + 1);
    }
    let traffic = report(&bridge, "nobody").traffic;
    assert_eq!(
        (traffic.send_errors, traffic.dropped),
        (0, 0),
        "that nobody is there is another matter"
    );
}

#[test]
fn a_datagram_that_begins_with_a_frame_ends_the_wait_for_another() {
    let bridge = start(None);
    bridge
        .add(link("in", Endpoint::Net { kind: NetKind::UdpServer, host: local(), port: 0 }))
        .unwrap();
    let vehicle = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    vehicle.connect((Ipv4Addr::LOCALHOST, server_port(&bridge, "in"))).unwrap();
    let station = station(&bridge, "station");
    let cut = frame_of(1, 33, 1, &[1; 28], 104);
    // A stream cut into datagrams goes on where it was cut.
    for (datagram, arrives) in [
        (&heartbeat(1, 0)[..], Some(heartbeat(1, 0))),
        (&cut[..9], None),
        (&cut[9..], Some(cut.clone())),
        (&cut[..20], None),
        (&heartbeat(1, 2)[..], Some(heartbeat(1, 2))),
    ] {
        vehicle.send(datagram).unwrap();
        if let Some(frame) = arrives {
            assert_eq!(receive(&station).0, frame);
        }
    }
    let links = bridge.stats().unwrap().links;
    let peer = links.iter().find(|link| link.peer.is_some() && link.name == "in");
    assert_eq!(peer.expect("it is there").traffic.junk_bytes, 20);
}

#[test]
fn what_is_sent_waits_in_pieces_of_whole_frames() {
    let (commands, receiver) = sync_channel(MAX_COMMANDS);
    let (signal, _wake) = UnixStream::pair().unwrap();
    signal.set_nonblocking(true).unwrap();
    let waker = Waker { commands, signal: Arc::new(signal) };
    let (registry, hub, thread) = (registry(), Arc::new(Hub::new()), Mutex::new(None));
    let bridge = Bridge { registry, waker, hub, thread };
    let frame = heartbeat(1, 7);
    let count = 2 * SENT_PIECE * MAX_COMMANDS / frame.len(); // so that it has to wait
    std::thread::scope(|scope| {
        let (bridge, frames) = (&bridge, frame.repeat(count));
        scope.spawn(move || bridge.send(&frames).unwrap());
        let mut left = count;
        while left > 0 {
            let Ok(Command::Send(piece)) = receiver.recv_timeout(LIMIT) else {
                panic!("nothing else is asked for")
            };
            assert!(piece.len() <= SENT_PIECE && piece.len().is_multiple_of(frame.len()));
            left -= piece.len() / frame.len();
        }
    });
    assert!(receiver.try_recv().is_err());
}

#[test]
fn messages_that_the_dialect_does_not_define_are_counted_by_kind() {
    let bridge = start(None);
    let station = station(&bridge, "station");
    for (msgid, count) in [(50_000, 3), (50_001, 1)] {
        for seq in 0..count {
            let frame = frame_of(1, msgid, seq, &[seq + 1; 3], 77);
            bridge.send(&frame).unwrap();
            assert_eq!(receive(&station).0, frame);
        }
    }
    bridge.send(&heartbeat(1, 9)).unwrap();
    let UnknownCounts { listed, unlisted } = report(&bridge, PROGRAM).unknown;
    let listed: Vec<_> = listed.into_iter().map(|(k, n)| (k.msgid, k.crc_extra, n)).collect();
    assert_eq!((listed, unlisted), (vec![(50_000, 77, 3), (50_001, 77, 1)], 0));
    for msgid in 0..100 {
        bridge.send(&frame_of(1, 60_000 + msgid, 0, &[1], 5)).unwrap();
        receive(&station);
    }
    let counts = report(&bridge, PROGRAM).unknown;
    assert_eq!((counts.listed.len(), counts.unlisted), (64, 38));
}
