"""Live links on this machine: sockets, a pseudo terminal, a child process, a websocket."""

from __future__ import annotations

import importlib.util
import os
import socket
import sys
import threading
import time
from itertools import pairwise

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.links import reconnecting, udp
from unit.link_tools import KEY, drain, free_port, heartbeat, pack, signed
from watchdog import watched

WAIT = 60.0
RADIO = pack(mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7), sysid=51, compid=68)


pytestmark = pytest.mark.usefixtures("mavlink20")


def receive(link, **kw):
    """The next HEARTBEAT, waiting for it."""
    return link.recv_match(type="HEARTBEAT", blocking=True, timeout=WAIT, **kw)


def until(condition):
    """Wait for something that another thread or the system is about to do."""
    deadline = time.monotonic() + WAIT
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert condition()


# -- UDP


@pytest.fixture
def server():
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    yield link
    link.close()


@pytest.fixture
def peer(server):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.settimeout(WAIT)
        sock.connect(server.port.getsockname())
        yield sock


def test_a_peer_becomes_a_target_with_its_first_valid_frame(server, peer):
    """R61."""
    damaged = bytearray(heartbeat())
    damaged[-1] ^= 1
    for garbage in (b"x", bytes(damaged), heartbeat()[:5]):
        peer.send(garbage)
        until(lambda: server.select(0.1))
        drain(server)
    assert server.clients == set()
    server.mav.buf_len() and server._drop_partial()
    peer.send(heartbeat())
    assert receive(server) is not None
    assert server.clients == {peer.getsockname()}
    server.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert peer.recv(100)[7:10] == b"\0\0\0"


def test_with_a_key_a_target_needs_a_good_signature(server, peer):
    """R61."""
    server.setup_signing(KEY, initial_timestamp=0)
    msg = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    peer.send(pack(msg))
    assert server.recv_match(blocking=True, timeout=WAIT).get_type() == "BAD_DATA"
    assert server.clients == set()
    peer.send(signed(msg, timestamp=100))
    assert receive(server).get_signed()
    assert len(server.clients) == 1


@pytest.mark.parametrize("native", [True, False])
def test_with_a_key_a_message_that_a_callback_let_pass_makes_no_target(server, peer, native):
    """R61."""
    peer.send(heartbeat())
    assert receive(server)  # the protocol version is found out
    server.clients.clear()
    if not native:
        server.recv = server.recv
    allowing = {"allow_unsigned_callback": mavutil.allow_radio_status}
    server.setup_signing(KEY, initial_timestamp=0, **allowing)
    peer.send(RADIO)
    assert server.recv_match(blocking=True, timeout=WAIT).get_type() == "RADIO_STATUS"
    assert (server.clients, server.last_address) == (set(), peer.getsockname())
    peer.send(signed(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3), timestamp=100))
    assert receive(server).get_signed()
    assert server.clients == {peer.getsockname()}


def test_with_a_key_a_broadcaster_does_not_lock_on_to_what_a_callback_let_pass(peer):
    """R61."""
    with mavutil.mavlink_connection("udpbcast:127.0.0.1:9") as link:
        link.setup_signing(KEY, allow_unsigned_callback=mavutil.allow_radio_status)
        link.mav.heartbeat_send(6, 8, 0, 0, 0)  # which gives the socket its port
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as attacker:
            for _ in range(2):  # both ways of receiving
                attacker.sendto(RADIO, ("127.0.0.1", link.port.getsockname()[1]))
                assert link.recv_match(type="RADIO_STATUS", blocking=True, timeout=WAIT)
        assert (link.broadcast, link.destination_addr) == (True, ("127.0.0.1", 9))


def test_clients_are_capped_and_the_silent_one_makes_room(server, peer, monkeypatch):
    """R61."""
    monkeypatch.setattr(udp, "MAX_CLIENTS", 2)
    one, two, three = [("127.0.0.1", port) for port in (1, 2, 3)]
    for address in (one, two, three):
        server._heard(address)
    assert (len(server.clients), server.clients_refused) == (2, 1)
    server.clients_last_alive[one] -= 6
    server._heard(three)
    assert server.clients == {two, three}


def test_a_crowd_keeps_no_other_address_out_and_who_commands_goes_last(server):
    """R61: an address may have all places, and three quarters of them are its share."""
    crowd = [("10.0.0.9", port) for port in range(1, 129)]
    for address in crowd:
        server._heard(address)
    assert server.clients == set(crowd)
    others = [("10.0.0.1", port) for port in range(1, 34)]
    for address in others:
        server._heard(address, True)
    assert (server.clients_refused, len(server.clients)) == (1, 128)
    assert set(others[:32]) < server.clients
    for address in server.clients:
        server.clients_last_alive[address] -= 60
    for port in range(200, 250):  # they take the places of their own address
        server._heard(("10.0.0.9", port))
    for n in range(40):
        server._heard((f"10.0.1.{n}", 1))
    assert set(others[:32]) < server.clients


@pytest.mark.parametrize("native", [True, False])
def test_who_sends_to_a_system_is_known_as_useful(server, peer, native):
    """R61."""
    if not native:
        server.recv = server.recv
    peer.send(heartbeat())
    assert receive(server)
    assert server._useful_clients == set()
    until(lambda: time.time() - server.clients_last_alive[peer.getsockname()] > 0.02)
    peer.send(pack(mavlink.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0)))
    assert server.recv_match(type="MANUAL_CONTROL", blocking=True, timeout=WAIT)
    assert server._useful_clients == {peer.getsockname()}


def test_silent_clients_are_dropped_but_never_the_last(server):
    """R61."""
    server.timeout = 5
    now = time.time()
    server.clients = {("127.0.0.1", 1), ("127.0.0.1", 2)}
    server.clients_last_alive = {("127.0.0.1", 1): now - 60, ("127.0.0.1", 2): now - 30}
    server.write(b"x")
    assert server.clients == {("127.0.0.1", 2)}


class Shared(tuple):
    """An address; whoever looks it up in a table is interrupted by another thread, which does `meanwhile`."""

    meanwhile = None

    def __hash__(self):
        meanwhile, Shared.meanwhile = Shared.meanwhile, None
        if meanwhile is not None:
            meanwhile()
            Shared.meanwhile = meanwhile
        return super().__hash__()

    __eq__ = tuple.__eq__


def test_clients_come_and_go_while_others_are_looked_through(server, monkeypatch):
    """One thread sends, another one receives."""
    one, *others = [Shared(("127.0.0.1", port)) for port in range(1, 9)]

    def meanwhile():
        if others:
            server._heard(others.pop())
            server._forget_silent_clients()
            server._forget_client(one)

    monkeypatch.setattr(udp, "MAX_CLIENTS", 3)
    server.timeout = 1e-9
    for address in (one, others.pop(), others.pop()):
        server._heard(address)
    monkeypatch.setattr(Shared, "meanwhile", staticmethod(meanwhile))
    server.write(heartbeat())
    assert len(server.clients) >= 1
    monkeypatch.setattr(server, "clients_last_alive", {})
    others.extend(Shared(("127.0.0.1", port)) for port in range(9, 15))
    server._heard(Shared(("127.0.0.1", 15)))
    assert ("127.0.0.1", 15) in server.clients


def test_a_datagram_s_messages_come_before_the_next_datagram(server, peer):
    for burst in range(20):
        peer.send(b"".join(heartbeat(burst * 10 + i) for i in range(10)))
    seqs = []
    until(lambda: server.select(0.1))
    while (msg := server.recv_msg()) is not None:
        seqs.append(msg.get_seq())
        assert server.mav.buf_len() <= 10 * 21
    assert seqs == list(range(200))
    assert server.mav_loss == 0


def test_udp_and_multicast_links_record(server, peer, tmp_path):
    server.setup_logfile(str(tmp_path / "a.tlog"))
    server.setup_logfile_raw(str(tmp_path / "a.raw"))
    peer.send(b"\x01" + heartbeat())
    assert receive(server)
    server.logfile.close()
    server.logfile_raw.close()
    assert (tmp_path / "a.tlog").stat().st_size == 29
    assert (tmp_path / "a.raw").read_bytes() == b"\x01" + heartbeat()


def test_a_garbage_flood_does_not_outrun_the_timeout(server, peer):
    stop = threading.Event()

    def flood():
        while not stop.is_set():
            peer.send(b"\x00")

    thread = threading.Thread(target=flood)
    thread.start()
    try:
        with watched():
            assert server.recv_match(type="HEARTBEAT", blocking=True, timeout=0.3) is None
    finally:
        stop.set()
        thread.join()


@pytest.mark.parametrize("prefix", ["udpbcast", "udpcast"])
def test_a_broadcaster_locks_on_to_who_answers(prefix):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        vehicle.settimeout(WAIT)
        link = mavutil.mavlink_connection(f"{prefix}:127.0.0.1:{vehicle.getsockname()[1]}")
        assert link.broadcast
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        _, address = vehicle.recvfrom(100)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as answering:
            answering.bind(("127.0.0.1", 0))
            answering.sendto(heartbeat(), address)
            assert receive(link)
            assert not link.broadcast
            assert link.destination_addr == answering.getsockname()
        link.close()


def test_an_unknown_host_is_counted():
    link = mavutil.mavlink_connection("udpout:no.such.host.invalid:14550")
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert link.write_errors == 1
    link.close()


@pytest.mark.parametrize(
    ("here", "there"),
    [
        ("udpin:[::1]:{}", "udpout:[::1]:{}"),
        ("tcpin:[::1]:{}", "tcp:[::1]:{}"),
        ("mcast:[ff05::4d41]:{}", "mcast:[ff05::4d41]:{}"),
        ("wsserver:[::1]:{}", "ws:[::1]:{}:mavlink"),
    ],
)
def test_ipv6_addresses(here, there):
    if "ws" in here:
        pytest.importorskip("wsproto")
    port = free_port()
    try:
        server = mavutil.mavlink_connection(here.format(port))
    except OSError:
        pytest.skip("no IPv6 loopback")
    stop = threading.Event()
    answers = []

    def serve():
        while not stop.is_set():
            if server.recv_match(type="HEARTBEAT", blocking=True, timeout=0.05):
                answers.append(server.mav.heartbeat_send(6, 8, 0, 0, 0))

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        with mavutil.mavlink_connection(there.format(port)) as client:
            client.mav.heartbeat_send(2, 3, 81, 4, 4)
            assert receive(client).type == 6
    finally:
        stop.set()
        thread.join()
        server.close()


@pytest.mark.parametrize(
    "device",
    [
        "udpin:nohost", "udpin:1.2.3.4:x", "tcp:::1:5", "tcpin:", "UDP:1.2.3.4:5", "mcast:a:b",
        "udpin:1.2.3.4:65536", "udpout:1.2.3.4:-1", "tcp:1.2.3.4:99999", "tcpin:1.2.3.4:99999",
    ],
)  # fmt: skip
def test_bad_addresses_are_named(device):
    with pytest.raises(ValueError, match="port"):
        mavutil.mavlink_connection(device)


@pytest.mark.parametrize(
    ("device", "module", "said"),
    [
        ("/dev/ttyX9", "serial", "/dev/ttyX9 needs pyserial: pip install 'mavwire[serial]'"),
        ("ws:127.0.0.1:1", "wsproto", "ws:127.0.0.1:1 needs wsproto: pip install 'mavwire[ws]'"),
    ],
)
def test_a_link_without_its_package_says_which_extra_brings_it(monkeypatch, device, module, said):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ModuleNotFoundError) as error:
        mavutil.mavlink_connection(device)
    assert (str(error.value), error.value.name) == (said, module)


# -- TCP


@pytest.fixture
def listener():
    with socket.create_server(("127.0.0.1", 0)) as sock:
        sock.settimeout(WAIT)
        yield sock


def address_of(sock) -> str:
    host, port = sock.getsockname()
    return f"{host}:{port}"


def test_tcp_end_is_noticed_once_and_costs_nothing(listener, capsys):
    """R64."""
    link = mavutil.mavlink_connection(f"tcp:{address_of(listener)}")
    vehicle, _ = listener.accept()
    vehicle.sendall(heartbeat())
    assert receive(link)
    vehicle.close()
    until(lambda: link.recv_msg() is None and link.portdead)
    wakings = []
    idle = link._idle
    link._idle = lambda *args: wakings.append(idle(*args))
    assert link.recv_match(blocking=True, timeout=0.5) is None
    assert len(wakings) <= 10  # and not thousands
    assert capsys.readouterr().out == "EOF on TCP socket\n"
    assert (link.fd, link.portdead) == (None, True)
    link.mav.heartbeat_send(6, 8, 0, 0, 0)  # raises nothing, and is counted
    assert link.frames_dropped == 1
    link.close()


def test_tcp_reconnects_with_a_fresh_descriptor(listener, capsys):
    """R64."""
    link = mavutil.mavlink_connection(
        f"tcp:{address_of(listener)}", autoreconnect=True, reconnect_delay=0.05
    )
    first, _ = listener.accept()
    first.sendall(heartbeat(1) + heartbeat(2)[:9])  # ends in the middle of a frame
    assert receive(link).get_seq() == 1
    first.close()
    before = link.port
    until(lambda: link.recv_msg() is None and link.port not in (None, before))
    second, _ = listener.accept()
    assert link.fd == link.port.fileno()
    second.sendall(heartbeat(3))
    assert receive(link).get_seq() == 3
    assert capsys.readouterr().out == "EOF on TCP socket\nAttempting reconnect\n"
    second.close()
    link.close()


def test_tcp_reconnect_backs_off(listener, monkeypatch, capsys):
    link = mavutil.mavlink_connection(
        f"tcp:{address_of(listener)}", autoreconnect=True, reconnect_delay=1
    )
    now, attempts = [1000.0], []

    def refuse():
        attempts.append(now[0])
        raise ConnectionRefusedError

    monkeypatch.setattr(link, "_connect", refuse)
    monkeypatch.setattr(reconnecting, "monotonic", lambda: now[0])
    monkeypatch.setattr(reconnecting, "start_new_thread", lambda job, args: job(*args))
    listener.accept()[0].close()
    until(lambda: link.recv_msg() is None and link.portdead)
    while len(attempts) < 7:
        now[0] += 1
        link.recv_msg()
    pauses = [after - before for before, after in pairwise(attempts)]
    assert pauses == [1, 2, 4, 8, 16, 16]
    assert capsys.readouterr().out.count("Attempting reconnect") == 7
    link.close()


def test_a_slow_reader_gets_whole_frames_and_the_rest_is_counted(listener):
    """R63."""
    link = mavutil.mavlink_connection(f"tcp:{address_of(listener)}")
    slow, _ = listener.accept()
    text = mavlink.MAVLink_statustext_message(6, b"x" * 50)
    sent = 0
    while link.frames_dropped < 1000:
        link.mav.send(text)
        sent += 1
    received = bytearray()
    slow.settimeout(WAIT)
    whole = (sent - link.frames_dropped) * (len(pack(text)))
    while len(received) < whole:
        link.recv_msg()  # a receive sends on what was queued
        received += slow.recv(1 << 20)
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    got = parser.parse_buffer(bytes(received))
    assert parser.buf_len() == 0
    assert {m.get_type() for m in got} == {"STATUSTEXT"}
    assert len(got) == sent - link.frames_dropped
    slow.close()
    link.close()


def test_tcpin_takes_the_next_client(capsys):
    """R64."""
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    address = link.listen.getsockname()
    for seq in (1, 2, 3):
        with socket.create_connection(address) as client:
            client.settimeout(WAIT)
            client.sendall(heartbeat(seq) + heartbeat()[:7])
            assert receive(link).get_seq() == seq
            assert link.fd == link.port.fileno()
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert client.recv(100)
        until(lambda: link.recv_msg() is None and link.port is None)
        assert link.fd == link.listen.fileno()
    assert capsys.readouterr().out == ""
    link.close()


def test_unix_sockets(tmp_path, capsys):
    if not hasattr(socket, "AF_UNIX"):
        pytest.skip("no Unix domain sockets")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "s"))
        server.listen(1)
        link = mavutil.mavlink_connection(f"unix:{tmp_path / 's'}")
        vehicle, _ = server.accept()
        vehicle.sendall(heartbeat())
        assert receive(link)
        vehicle.close()
        assert link.recv_msg() is None
        assert "EOF" in capsys.readouterr().out
        link.close()
    with pytest.raises(ValueError, match="path must be specified"):
        mavutil.mavlink_connection("uds:")


# -- others


def test_a_program_runs_only_with_the_prefix(tmp_path):
    """R69."""
    directory = tmp_path / "bin"
    directory.mkdir()
    program = directory / "vehicle"
    program.write_text(
        f"#!{sys.executable}\n"
        "import sys\n"
        f"sys.stdout.buffer.write({heartbeat()!r}); sys.stdout.flush()\n"
        "sys.stdout.buffer.write(sys.stdin.buffer.read(21)); sys.stdout.flush()\n"
    )
    program.chmod(0o755)
    with pytest.raises(PermissionError, match="exec:"):
        mavutil.mavlink_connection(str(program))
    link = mavutil.mavlink_connection(f"exec:{program}", source_system=9)
    assert receive(link).get_srcSystem() == 1
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert receive(link).get_srcSystem() == 9
    assert link.recv_match(blocking=True, timeout=0.2) is None
    link.close()
    assert link.child.returncode is not None


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo terminals")
def test_serial_ports():
    pytest.importorskip("serial")
    import tty

    vehicle, port = os.openpty()
    tty.setraw(vehicle)
    tty.setraw(port)
    link = mavutil.mavlink_connection(f"{os.ttyname(port)},57600")
    assert (link.port.baudrate, link.baud) == (57600, "57600")
    os.write(vehicle, b"middle of a frame" + heartbeat(1) + heartbeat(2))
    assert [receive(link).get_seq() for _ in range(2)] == [1, 2]
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert os.read(vehicle, 100)[0] == 0xFD
    link.set_baudrate(115200)
    assert link.port.baudrate == 115200
    link.close()
    os.close(vehicle)
    os.close(port)


def test_a_dead_serial_port_is_reported_once(capsys):
    pytest.importorskip("serial")
    link = mavutil.mavlink_connection("/dev/no-such-port", force_connected=True)
    assert (link.fd, link.autoreconnect, link.recv_msg()) == (None, True, None)
    for _ in range(3):
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert capsys.readouterr().out == "Device /dev/no-such-port is dead\n"
    assert link.portdead
    link.close()


@pytest.mark.skipif(importlib.util.find_spec("wsproto") is None, reason="wsproto not installed")
def test_websockets_both_ways_and_again():
    server = mavutil.mavlink_connection("wsserver:127.0.0.1:0")
    address = f"ws:127.0.0.1:{server.listen.getsockname()[1]}"
    stop = threading.Event()

    def serve():
        while not stop.is_set():
            if server.recv_match(blocking=True, timeout=0.05):
                server.mav.heartbeat_send(6, 8, 0, 0, 0)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        for _ in range(2):
            client = mavutil.mavlink_connection(address)
            client.mav.heartbeat_send(2, 3, 81, 4, 4)
            assert receive(client).type == 6
            client.close()
            until(lambda: server.port is None)
    finally:
        stop.set()
        thread.join()
        server.close()


def test_tunnelled_serial_port(monkeypatch):
    class Vehicle:
        """Echoes what SERIAL_CONTROL sends."""

        def __init__(self):
            self.mav = self
            self.sent = []
            self.echo = []

        def wait_heartbeat(self):
            pass

        def serial_control_send(self, device, flags, timeout, baudrate, count, data):
            self.sent.append((device, flags, baudrate, bytes(data[:count])))
            if count:
                msg = mavlink.MAVLink_serial_control_message(device, flags, 0, 0, count, data)
                self.echo.append(msg)

        def recv_match(self, **kw):
            return self.echo.pop(0) if self.echo else None

    vehicle = Vehicle()
    monkeypatch.setattr(mavutil, "mavlink_connection", lambda *args, **kw: vehicle)
    port = mavutil.MavlinkSerialPort("tcp:x:1", 115200, devnum=2, devbaud=9600, timeout=0.1)
    port.write(b"a" * 75)
    assert [len(data) for *_, data in vehicle.sent] == [0, 70, 5]
    assert vehicle.sent[0][:3] == (2, 6, 9600)
    assert port.read(100) == b"a" * 70
    assert (port.read(3), port.read(9), port.read(1)) == (b"aaa", b"aa", b"")


def test_serial_detection(monkeypatch):
    monkeypatch.setattr("glob.glob", lambda pattern: [pattern.replace("*", "0")])
    every = mavutil.auto_detect_serial_unix()
    assert [p.device for p in every][:3] == ["/dev/ttyS0", "/dev/ttyUSB0", "/dev/ttyACM0"]
    assert [str(p) for p in mavutil.auto_detect_serial(["*ACM*"])] == ["/dev/ttyACM0"]
    assert len(mavutil.auto_detect_serial_unix(["nothing"])) == len(every)


def test_logs_of_other_kinds_go_to_their_readers(tmp_path, monkeypatch):
    import types as module_types

    opened = []
    for module, names in {
        "DFReader": ("DFReader_binary", "DFReader_text"), "CSVReader": ("CSVReader",)
    }.items():  # fmt: skip
        fake = module_types.ModuleType(f"mavwire.{module}")
        for name in names:
            setattr(fake, name, lambda *a, _n=name, **k: opened.append((_n, a, k)) or _n)
        monkeypatch.setitem(sys.modules, fake.__name__, fake)
        monkeypatch.setattr(f"mavwire.{module}", fake, raising=False)
    dataflash = tmp_path / "flash.tlog"
    dataflash.write_bytes(b"\xa3\x95\x80\x80\x59" + bytes(100))
    assert mavutil.mavlink_connection(str(dataflash)) == "DFReader_binary"
    assert mavutil.mavfile_global == "DFReader_binary"
    text = tmp_path / "TEXT.LOG"
    text.write_text("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n")
    assert mavutil.mavlink_connection(str(text)) == "DFReader_text"
    mavutil.mavlink_connection("csv:C:\\x\\f.csv:separator=::name=v", extra=1)
    name, args, kwargs = opened[-1]
    assert (name, args) == ("CSVReader", ("C:\\x\\f.csv",))
    assert {k: kwargs[k] for k in ("separator", "name", "extra")} == {
        "separator": ":", "name": "v", "extra": 1
    }  # fmt: skip
    mavutil.mavfile_global = None


def test_a_first_message_in_pieces_survives_the_switch_to_mavlink_2():
    """A stream is read in pieces; the one that switches the version must not get lost."""
    mavutil.set_wire_protocol("1.0")
    mavutil.set_dialect("all")
    server = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    with socket.create_connection(server.listen.getsockname()) as peer:
        frame = heartbeat()
        assert frame[0] == 0xFD
        peer.send(frame)
        assert receive(server).get_msgbuf() == frame
    server.close()
