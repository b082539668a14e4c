//! A bridge with real sockets on loopback. Waits are for conditions, with a limit far beyond what they take.

mod numbers;
mod recordings;

use super::*;
use mavwire_core::builtin;
use mavwire_core::frame::{self, Header, MAX_FRAME_LEN};
use mavwire_core::router::Filter;
use mavwire_core::schema::WireVersion;
use std::io::Read as _;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::path::PathBuf;
use std::time::{Duration, Instant};

const PROGRAM: &str = event_loop::PROGRAM_NAME;
const LIMIT: Duration = Duration::from_secs(60);

fn registry() -> Arc<Registry> {
    Arc::new(Registry::new(builtin::dialect("common", WireVersion::V2).expect("it is built in")))
}

fn start(recording: Option<Recording>) -> Bridge {
    Bridge::start(registry(), Settings::new(3), recording).expect("a bridge")
}

fn link(name: &str, endpoint: Endpoint) -> LinkSpec {
    LinkSpec {
        name: name.into(),
        endpoint,
        port: PortSpec { queue: 64 << 10, ..PortSpec::default() },
        peer_timeout: LIMIT,
        retry: Some(Duration::from_secs(1)),
    }
}

fn local() -> String {
    "127.0.0.1".into()
}

/// The port that a server listens on which was to take any.
fn server_port(bridge: &Bridge, name: &str) -> u16 {
    let endpoint = report(bridge, name).endpoint;
    endpoint.rsplit(':').next().and_then(|port| port.parse().ok()).expect("a port")
}

fn heartbeat(sysid: u8, seq: u8) -> Vec<u8> {
    frame_of(sysid, 0, seq, &[0, 0, 0, 0, 2, 3, 81, 4, 3], 50)
}

/// A command from the station 255 to a system.
fn command(target: u8, seq: u8) -> Vec<u8> {
    let mut payload = [1; 33];
    (payload[30], payload[31]) = (target, 1);
    frame_of(255, 76, seq, &payload, 152)
}

fn frame_of(sysid: u8, msgid: u32, seq: u8, payload: &[u8], crc_extra: u8) -> Vec<u8> {
    let header = Header::new(WireVersion::V2, seq, sysid, 1, msgid);
    let mut out = Vec::new();
    frame::encode(&mut out, header, payload, crc_extra).expect("a valid header");
    out
}

fn station(bridge: &Bridge, name: &str) -> UdpSocket {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    socket.set_read_timeout(Some(LIMIT)).unwrap();
    let port = socket.local_addr().unwrap().port();
    bridge
        .add(link(name, Endpoint::Net { kind: NetKind::UdpClient, host: local(), port }))
        .unwrap();
    socket
}

fn receive(socket: &UdpSocket) -> (Vec<u8>, SocketAddr) {
    let mut buffer = [0; MAX_FRAME_LEN];
    let (len, from) = socket.recv_from(&mut buffer).expect("a frame arrives");
    (buffer[..len].to_vec(), from)
}

fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    let start = Instant::now();
    while !condition() {
        assert!(start.elapsed() < LIMIT, "waited for {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn report(bridge: &Bridge, name: &str) -> LinkReport {
    let stats = bridge.stats().expect("it runs");
    stats.links.into_iter().find(|link| link.name == name).expect("the link is there")
}

#[test]
fn vehicles_and_stations_over_udp_find_each_other() {
    let bridge = start(None);
    bridge
        .add(link("in", Endpoint::Net { kind: NetKind::UdpServer, host: local(), port: 0 }))
        .unwrap();
    let server_port = server_port(&bridge, "in");
    let stations = [station(&bridge, "first"), station(&bridge, "second")];
    let vehicles: Vec<UdpSocket> = (0..2)
        .map(|_| {
            let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
            socket.set_read_timeout(Some(LIMIT)).unwrap();
            socket.connect((Ipv4Addr::LOCALHOST, server_port)).unwrap();
            socket
        })
        .collect();
    vehicles[0].send(b"no frame, and so no peer").unwrap();
    for (vehicle, sysid) in vehicles.iter().zip(1..) {
        vehicle.send(&heartbeat(sysid, 7)).unwrap();
        for station in &stations {
            assert_eq!(receive(station).0, heartbeat(sysid, 7));
        }
    }
    assert_eq!(receive(&vehicles[0]).0, heartbeat(2, 7), "what has no target goes to peers too");
    let (_, bridge_address) = {
        vehicles[0].send(&heartbeat(1, 8)).unwrap();
        receive(&stations[0])
    };
    stations[0].send_to(&command(2, 1), bridge_address).unwrap();
    stations[0].send_to(&heartbeat(255, 2), bridge_address).unwrap();
    assert_eq!(receive(&vehicles[1]).0, heartbeat(1, 8));
    assert_eq!(receive(&vehicles[1]).0, command(2, 1));
    assert_eq!(receive(&vehicles[0]).0, heartbeat(255, 2), "and not the other's command");
    let stats = bridge.stats().unwrap();
    assert_eq!(stats.links.iter().filter(|link| link.name == "in").count(), 3);
    assert_eq!(stats.components.iter().map(|one| one.sysid).collect::<Vec<_>>(), [1, 2, 255]);
    assert_eq!(stats.components[0].links, ["in"]);
}

#[test]
fn connections_are_made_and_made_again() {
    let bridge = start(None);
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    bridge
        .add(link("server", Endpoint::Net { kind: NetKind::TcpClient, host: local(), port }))
        .unwrap();
    let station = station(&bridge, "station");
    for n in 1..=3 {
        let (mut stream, _) = listener.accept().unwrap();
        let (first, second) = (heartbeat(1, n), heartbeat(1, n + 100));
        // A frame that is cut by the end of the connection does not spoil the next one.
        stream.write_all(&[&first[..], &second[..9]].concat()).unwrap();
        assert_eq!(receive(&station).0, first);
        wait_for("the connection", || report(&bridge, "server").connections == u64::from(n));
    }
    assert_eq!(report(&bridge, "server").endpoint, format!("tcp:127.0.0.1:{port}"));
}

#[test]
fn one_that_reads_nothing_slows_nobody() {
    let bridge = start(None);
    bridge
        .add(link("clients", Endpoint::Net { kind: NetKind::TcpServer, host: local(), port: 0 }))
        .unwrap();
    let port = server_port(&bridge, "clients");
    let stalled = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    let mut reading = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    reading.set_read_timeout(Some(LIMIT)).unwrap();
    wait_for("both", || bridge.stats().unwrap().links.len() == 4);
    let dropped = |bridge: &Bridge| -> u64 {
        bridge.stats().unwrap().links.iter().map(|link| link.traffic.dropped).sum()
    };
    let mut sent = 0_u64;
    let mut buffer = vec![0; 21 * 1_000];
    wait_for("drops on the stalled one", || {
        let burst: Vec<u8> =
            (0..1_000).flat_map(|n| heartbeat((n % 200) as u8 + 1, (n / 200) as u8)).collect();
        bridge.send(&burst).unwrap();
        sent += 1_000;
        reading.read_exact(&mut buffer).expect("the other one gets everything");
        assert_eq!(buffer, burst);
        dropped(&bridge) > 0
    });
    let stats = bridge.stats().unwrap();
    let whole = stats.links.iter().filter(|link| link.peer.is_some() && link.traffic.sent == sent);
    assert_eq!(whole.count(), 1, "{:?}", stats.links);
    assert!(stats.links.iter().all(|link| link.queued <= (64 << 10) + MAX_FRAME_LEN));
    drop(stalled);
    wait_for("its end", || bridge.stats().unwrap().links.len() == 3);
    assert!(report(&bridge, "clients").traffic.dropped > 0, "its numbers stay");
}

#[test]
fn a_burst_beyond_the_queue_loses_nothing_where_the_link_takes_it() {
    let bridge = start(None);
    let _station = station(&bridge, "station");
    let frames = 50_000;
    let burst: Vec<u8> =
        (0..frames).flat_map(|n| heartbeat((n % 200) as u8 + 1, (n / 200) as u8)).collect();
    assert!(burst.len() > 10 * (64 << 10), "sixteen times what may wait");
    bridge.send(&burst).unwrap();
    wait_for("them", || report(&bridge, "station").traffic.sent == frames);
    assert_eq!(report(&bridge, "station").traffic.dropped, 0);
}

#[test]
fn only_whole_frames_are_sent() {
    let bridge = start(None);
    let station = station(&bridge, "station");
    let (one, half) = (heartbeat(1, 1), &heartbeat(1, 2)[..9]);
    for (junk, at) in
        [(b"xx".to_vec(), 0), ([&one, half].concat(), 21), ([&one[..], b"junk", &one].concat(), 21)]
    {
        let error = bridge.send(&junk).unwrap_err().to_string();
        assert_eq!(
            error,
            format!("no whole frame at byte {at} of {}: send whole frames", junk.len())
        );
    }
    // Whole by its length, and damaged.
    let mut broken = heartbeat(1, 3);
    broken[1] += 3;
    let error = bridge.send(&[&one[..], &broken, &[0; 3]].concat()).unwrap_err().to_string();
    assert!(error.starts_with("no good frame at byte 21 of 45: invalid MAVLink CRC"), "{error}");
    bridge.send(&heartbeat(1, 4)).unwrap();
    assert_eq!(receive(&station).0, heartbeat(1, 4));
    assert_eq!(report(&bridge, PROGRAM).traffic.junk_bytes, 0);
}

#[test]
fn links_come_and_go_while_frames_pass() {
    let bridge = start(None);
    let first = station(&bridge, "first");
    for round in 0..20 {
        let second = station(&bridge, "second");
        bridge.send(&heartbeat(1, round)).unwrap();
        assert_eq!(receive(&first).0, heartbeat(1, round));
        assert_eq!(receive(&second).0, heartbeat(1, round));
        bridge.remove("second").unwrap();
    }
    assert!(
        matches!(bridge.remove("second"), Err(BridgeError::NoSuchLink(name)) if name == "second")
    );
    let again = link("first", Endpoint::Net { kind: NetKind::UdpClient, host: local(), port: 9 });
    assert!(matches!(bridge.add(again), Err(BridgeError::NameTaken(name)) if name == "first"));
    bridge.stop();
    assert!(matches!(bridge.send(&[]), Err(BridgeError::Stopped)));
    assert!(matches!(bridge.stats(), Err(BridgeError::Stopped)));
}

#[test]
fn what_cannot_be_opened_is_told_with_its_name() {
    let bridge = start(None);
    let taken = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = taken.local_addr().unwrap().port();
    let error = bridge
        .add(link("in", Endpoint::Net { kind: NetKind::UdpServer, host: local(), port }))
        .unwrap_err();
    assert!(error.to_string().starts_with("in: "), "{error}");
    assert!(
        matches!(error, BridgeError::Io { error, .. } if error.kind() == io::ErrorKind::AddrInUse)
    );
    let (path, baud) = (PathBuf::from("/no/such/device"), 57_600);
    let serial = Endpoint::Serial { path, baud, flow_control: false };
    assert_eq!(serial.to_string(), "serial:/no/such/device:57600");
    let error = bridge.add(link("fc", serial)).unwrap_err();
    assert!(
        matches!(error, BridgeError::Io { error, .. } if error.kind() == io::ErrorKind::NotFound)
    );
    assert_eq!(bridge.stats().unwrap().links.len(), 1, "only the program around it");
}

#[test]
fn junk_is_counted_and_goes_no_further() {
    let bridge = start(None);
    bridge
        .add(link("clients", Endpoint::Net { kind: NetKind::TcpServer, host: local(), port: 0 }))
        .unwrap();
    let port = server_port(&bridge, "clients");
    let station = station(&bridge, "station");
    let mut hostile = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    let mut broken = heartbeat(9, 0);
    broken[12] ^= 1;
    // The parser waits for the rest of anything that looks like the start of a frame, so good frames have to follow.
    let good: Vec<u8> = (0..40).flat_map(|seq| heartbeat(1, seq)).collect();
    hostile.write_all(&[&vec![0xFE; 70_000][..], b"junk", &broken, &good].concat()).unwrap();
    for seq in 0..20 {
        assert_eq!(receive(&station).0, heartbeat(1, seq));
    }
    let stats = bridge.stats().unwrap();
    let peer = stats.links.iter().find(|link| link.name == "clients" && link.peer.is_some());
    let traffic = peer.expect("it is connected").traffic;
    assert_eq!(traffic.junk_bytes, 70_004 + 21);
    assert!(traffic.damaged > 0);
}

#[test]
fn what_strangers_send_to_a_udp_server_is_counted_in_its_own_entry() {
    let bridge = start(None);
    bridge
        .add(link("in", Endpoint::Net { kind: NetKind::UdpServer, host: local(), port: 0 }))
        .unwrap();
    let stranger = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    stranger.connect((Ipv4Addr::LOCALHOST, server_port(&bridge, "in"))).unwrap();
    let mut broken = heartbeat(9, 0);
    broken[12] ^= 1;
    for datagram in [&b"junk"[..], &broken, &heartbeat(1, 0)[..9]] {
        stranger.send(datagram).unwrap();
    }
    wait_for("them", || report(&bridge, "in").traffic.junk_bytes == 4 + 21 + 9);
    let own = report(&bridge, "in");
    assert_eq!((own.traffic.damaged, own.traffic.routed.received, own.connections), (1, 0, 0));
}

#[test]
fn a_program_that_sends_without_pause_stops_no_link() {
    let bridge = start(None);
    bridge
        .add(link("in", Endpoint::Net { kind: NetKind::UdpServer, host: local(), port: 0 }))
        .unwrap();
    let port = server_port(&bridge, "in");
    let station = station(&bridge, "station");
    let vehicle = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    vehicle.connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    let ended = std::sync::atomic::AtomicBool::new(false);
    let mut buffer = [0; MAX_FRAME_LEN];
    let got = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !ended.load(std::sync::atomic::Ordering::Relaxed) {
                bridge.send(&[]).unwrap();
            }
        });
        let sent = vehicle.send(&heartbeat(1, 1));
        let got = sent.and_then(|_| station.recv(&mut buffer));
        ended.store(true, std::sync::atomic::Ordering::Relaxed);
        got
    });
    assert_eq!(&buffer[..got.expect("a frame arrives")], heartbeat(1, 1));
}

#[test]
fn what_is_asked_for_is_done_where_nothing_wakes_the_loop() {
    let mut bridge = start(None);
    // Nobody is at the other end: each write fails. The loop's own signal stays open, as its waker has it too.
    bridge.waker.signal = Arc::new(UnixStream::pair().unwrap().0);
    let station = station(&bridge, "station");
    bridge.send(&heartbeat(1, 1)).unwrap();
    assert_eq!(receive(&station).0, heartbeat(1, 1));
    bridge.remove("station").unwrap();
    bridge.stop();
}

#[test]
fn however_the_loop_ends_its_taps_do() {
    let (commands, receiver) = sync_channel(1);
    let (signal, wake) = UnixStream::pair().unwrap();
    let waker = Waker { commands, signal: Arc::new(signal) };
    let hub = Arc::new(Hub::new());
    let tap = hub.tap(Filter::default());
    let ended = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let switch = Switch::new(registry(), Settings::new(3));
        let _running = EventLoop::new(switch, Arc::clone(&hub), None, receiver, waker, wake);
        std::panic::resume_unwind(Box::new("a mistake"));
    }));
    assert!(ended.is_err());
    assert!(tap.wait(1, LIMIT) && tap.take(1).is_none());
}
