"""Other ends that misbehave: hosts that move, second listeners, children that do not read, clients that only hold the
line, floods of made-up ids.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import socket
import threading
import time

import pytest
from mavwire import aio, mavutil
from mavwire.aio.transports import OneClientServer
from mavwire.dialects.v20 import all as mavlink
from mavwire.links import one_client, udp
from mavwire.links.signing import signing_timestamp
from unit.aio_tools import eventually, run
from unit.link_tools import KEY, Capture, drain_in_portions, free_port, heartbeat, pack, signed
from watchdog import watched

WAIT = 60.0


pytestmark = pytest.mark.usefixtures("mavlink20")


def receive(link):
    """The next HEARTBEAT, waiting for it."""
    return link.recv_match(type="HEARTBEAT", blocking=True, timeout=WAIT)


# -- the name of a UDP destination


class Names:
    """Looks up names in the test's own table."""

    def __init__(self):
        self.known = {}
        self.asked = []

    def __call__(self, host, port, *args):
        self.asked.append(host)
        if host not in self.known:
            raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")
        return [(socket.AF_INET, socket.SOCK_DGRAM, 17, "", (self.known[host], port))]


@pytest.fixture
def names(monkeypatch):
    names = Names()
    monkeypatch.setattr(socket, "getaddrinfo", names)
    return names


@pytest.fixture
def vehicle():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(WAIT)
        yield sock


def test_a_name_is_looked_up_once(names, vehicle):
    names.known["vehicle.test"] = "127.0.0.1"
    with mavutil.mavlink_connection(f"udpout:vehicle.test:{vehicle.getsockname()[1]}") as link:
        for seq in range(20):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert vehicle.recv(100)[4] == seq
    assert names.asked == ["vehicle.test"]


def test_an_unknown_name_is_looked_up_again_after_a_pause(names, vehicle, monkeypatch, caplog):
    with mavutil.mavlink_connection(f"udpout:vehicle.test:{vehicle.getsockname()[1]}") as link:
        for _ in range(100):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert (len(names.asked), link.write_errors) == (1, 100)
        (record,) = caplog.records
        assert "no IPv4 address of vehicle.test:" in record.getMessage()
        now = time.monotonic() + udp.LOOKUP_PAUSE
        monkeypatch.setattr(udp, "monotonic", lambda: now)
        names.known["vehicle.test"] = "127.0.0.1"
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert vehicle.recv(100)[4] == 100
        assert len(names.asked) == 2


class Unreachable:
    """A socket whose network knows no way to some addresses."""

    family = socket.AF_INET

    def __init__(self, real, *gone):
        self.fileno, self.recvfrom = real.fileno, real.recvfrom
        self.gone = gone
        self.sent = []

    def sendto(self, data, address):
        if address[0] in self.gone:
            raise OSError(errno.EHOSTUNREACH, "No route to host")
        self.sent.append(address[0])
        return len(data)

    def close(self):
        pass


def test_a_host_that_moved_is_found_again(names, monkeypatch):
    monkeypatch.setattr(udp, "LOOKUP_PAUSE", 0.0)
    names.known["vehicle.test"] = "10.0.0.1"
    with mavutil.mavlink_connection("udpout:vehicle.test:14550") as link:
        real, link.port = link.port, Unreachable(link.port, "10.0.0.1")
        link.write(b"1")
        del names.known["vehicle.test"]
        link.write(b"2")  # no answer: the last address is tried again
        names.known["vehicle.test"] = "10.0.0.2"
        link.write(b"3")
        link.write(b"4")
        assert (link.port.sent, link.write_errors) == (["10.0.0.2"] * 2, 2)
        assert len(names.asked) == 3
        link.port = real


def test_a_loop_goes_on_while_a_name_is_looked_up(names, monkeypatch):
    monkeypatch.setattr(udp, "LOOKUP_PAUSE", 0.0)
    names.known["vehicle.test"] = "10.0.0.1"
    answer = threading.Event()

    async def main():
        async with aio.connect("udpout:vehicle.test:14550") as link:
            real = link.sync.port
            link.sync.port = Unreachable(real, "10.0.0.1")
            try:
                names.known["vehicle.test"] = "10.0.0.2"
                resolve = link.sync._resolve
                link.sync._resolve = lambda: answer.wait(WAIT) and resolve()
                for _ in range(10):
                    link.mav.heartbeat_send(6, 8, 0, 0, 0)
                    await asyncio.sleep(0)
                assert link.sync.resolved_destination_addr[0] == "10.0.0.1"
                answer.set()
                await eventually(lambda: link.sync.resolved_destination_addr[0] == "10.0.0.2")
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert link.sync.port.sent == ["10.0.0.2"]
                assert len(names.asked) == 2
            finally:
                answer.set()
                link.sync.port = real

    run(main())


def test_a_host_that_only_has_an_ipv6_address_is_named_by_it(monkeypatch, caplog):
    def find(host, port, family, *_):
        assert family == socket.AF_INET
        raise socket.gaierror(socket.EAI_ADDRFAMILY, "Address family not supported")

    monkeypatch.setattr(socket, "getaddrinfo", find)
    with mavutil.mavlink_connection("udpout:vehicle.test:14550") as link:
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert link.write_errors == 1
    assert r"written [ADDRESS]:PORT" in caplog.text


# -- the place of another


def test_a_second_listener_takes_no_datagrams():
    """V15."""
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as first:
        address = first.port.getsockname()
        with pytest.raises(OSError, match=f"127.0.0.1:{address[1]}") as refused:
            mavutil.mavlink_connection(f"udpin:127.0.0.1:{address[1]}")
        assert refused.value.errno == errno.EADDRINUSE
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
            peer.sendto(heartbeat(5), address)
            assert receive(first).get_seq() == 5
    mavutil.mavlink_connection(f"udpin:127.0.0.1:{address[1]}").close()


def test_a_child_that_reads_nothing_blocks_nobody(tmp_path):
    """R63: frames are whole or dropped, and counted."""
    go = tmp_path / "go"
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\nwhile [ ! -e {go} ]; do sleep 0.05; done\nexec cat\n")
    program.chmod(0o700)
    sent = 0
    with mavutil.mavlink_connection(f"exec:{program}") as link, watched(WAIT):
        text = mavlink.MAVLink_statustext_message(6, b"x" * 50)
        while link.frames_dropped < 100:
            link.mav.send(text)
            sent += 1
        go.touch()
        for _ in range(sent - link.frames_dropped):
            assert link.recv_match(blocking=True, timeout=WAIT).get_type() == "STATUSTEXT"
        link.child.kill()
        link.child.wait()
        dropped = link.frames_dropped
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert link.frames_dropped == dropped + 2


class Clock:
    """The time by which clients are silent."""

    def __init__(self):
        self.now = 1000.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(one_client, "monotonic", clock)
    return clock


def accepted(link):
    """The client that a server has now."""
    with watched(WAIT):
        while link.port is None:
            link.recv_msg()
    return link.port


class Refusing:
    """A listening socket without a descriptor for its clients."""

    def __init__(self, listen):
        self._listen = listen

    def accept(self):
        raise OSError(errno.EMFILE, "Too many open files")

    def __getattr__(self, name):
        return getattr(self._listen, name)


@pytest.mark.parametrize("kind", ["tcpin", "wsserver"])
def test_who_sends_does_not_wait_for_descriptors(kind, monkeypatch):
    """A reader would find the client waiting over and over."""
    if kind == "wsserver":
        pytest.importorskip("wsproto")
    pauses = []
    monkeypatch.setattr(one_client, "sleep", pauses.append)
    with mavutil.mavlink_connection(f"{kind}:127.0.0.1:0") as link:
        real, link.listen = link.listen, Refusing(link.listen)
        for _ in range(50):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert (pauses, link.frames_dropped) == ([], 50)
        assert link.recv() == b""
        assert pauses == [one_client.ACCEPT_PAUSE]
        link.listen = real
        assert link.recv() == b""
        assert len(pauses) == 1


def test_a_silent_client_makes_room_for_one_that_waits(clock):
    with mavutil.mavlink_connection("tcpin:127.0.0.1:0") as link:
        address = link.listen.getsockname()
        with socket.create_connection(address):
            first = accepted(link)
            clock.now += 10 * one_client.CLIENT_SILENCE
            link._drop_silent_client()
            assert link.port is first  # nobody else wants the place
            with socket.create_connection(address) as second:
                second.sendall(heartbeat(7))
                assert receive(link).get_seq() == 7
                assert (link.port is first, link.clients_replaced) == (False, 1)


def test_a_client_that_sends_messages_stays(clock):
    with mavutil.mavlink_connection("tcpin:127.0.0.1:0") as link:
        address = link.listen.getsockname()
        with socket.create_connection(address) as client, socket.create_connection(address):
            first = accepted(link)
            for seq in range(5):
                client.sendall(heartbeat(seq))
                assert receive(link).get_seq() == seq
                link._drop_silent_client()
                clock.now += one_client.CLIENT_SILENCE - 1
                link._drop_silent_client()
            assert (link.port, link.clients_replaced) == (first, 0)
            client.sendall(b"no message")  # which does not count
            clock.now += 1
            with watched(WAIT):
                while link.port is first:
                    link.recv_msg()


def test_a_websocket_client_that_never_shakes_hands_makes_room(clock):
    pytest.importorskip("wsproto")
    with mavutil.mavlink_connection("wsserver:127.0.0.1:0") as link:
        host, port = link.listen.getsockname()
        with socket.create_connection((host, port)):
            accepted(link)
            clock.now += 5

            def talk():
                with mavutil.mavlink_connection(f"ws:{host}:{port}") as client:
                    client.mav.heartbeat_send(2, 3, 81, 4, 4)
                    done.wait(WAIT)

            done = threading.Event()
            thread = threading.Thread(target=talk)
            thread.start()
            assert receive(link) is not None
            done.set()
            thread.join()
            assert link.clients_replaced == 1


@pytest.mark.parametrize("name", ["Host", "Connection", "Sec-WebSocket-Extensions"])
def test_a_websocket_client_with_headers_that_are_not_ascii_is_let_go(name):
    pytest.importorskip("wsproto")
    with mavutil.mavlink_connection("wsserver:127.0.0.1:0") as link, watched(WAIT):
        host, port = link.listen.getsockname()
        with socket.create_connection((host, port)) as client:
            first = accepted(link)
            headers = {"Host": b"x", "Upgrade": b"websocket", "Connection": b"Upgrade"}
            headers |= {
                "Sec-WebSocket-Key": b"dGhlIHNhbXBsZSBub25jZQ==",
                "Sec-WebSocket-Version": b"13",
            }
            headers[name] = b"\xff"
            lines = [b"%s: %s" % (key.encode(), value) for key, value in headers.items()]
            client.sendall(b"\r\n".join([b"GET / HTTP/1.1", *lines, b"", b""]))
            while link.port is first:
                assert link.recv_msg() is None


class Flooder:
    """A client that has always sent more than was read."""

    def __init__(self, client, data):
        client.setblocking(False)
        self._client, self._data, self._unsent = client, data, b""

    def __call__(self):
        while True:
            self._unsent = self._unsent or self._data
            try:
                self._unsent = self._unsent[self._client.send(self._unsent) :]
            except BlockingIOError:
                return


def masked(data):
    """A WebSocket message as a client sends it."""
    return b"\x82\xfe" + len(data).to_bytes(2) + bytes(4) + data


HANDSHAKE = (
    b"GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
BAD_CHECKSUM = heartbeat()[:-1] + bytes([heartbeat()[-1] ^ 1])


@pytest.mark.parametrize("robust", [True, False])
@pytest.mark.parametrize(
    ("kind", "garbage"),
    [
        ("tcpin", bytes(30_000)),
        ("tcpin", BAD_CHECKSUM * 1000),
        ("wsserver", masked(bytes(30_000))),
        ("wsserver", masked(BAD_CHECKSUM * 1000)),
    ],
)
def test_a_client_that_sends_garbage_makes_room_for_one_that_waits(clock, kind, garbage, robust):
    if kind == "wsserver":
        pytest.importorskip("wsproto")
    with mavutil.mavlink_connection(f"{kind}:127.0.0.1:0") as link:
        link.mav.robust_parsing = robust
        address = link.listen.getsockname()
        with socket.create_connection(address) as client:
            first = accepted(link)
            if kind == "wsserver":
                client.sendall(HANDSHAKE)
                with watched(WAIT):
                    while not link._established():
                        link.recv_msg()
            flood = Flooder(client, garbage)
            with socket.create_connection(address), watched(WAIT):
                while link.port is first:
                    flood()
                    with contextlib.suppress(mavlink.MAVError):
                        link.recv_msg()
                    clock.now += one_client.CLIENT_SILENCE / 20
            assert link.clients_replaced == 1


def test_a_silent_client_makes_room_in_a_loop(monkeypatch):
    monkeypatch.setattr(one_client, "CLIENT_SILENCE", 0.05)
    monkeypatch.setattr(OneClientServer, "look_interval", 0.01)
    port = free_port()

    async def main():
        async with aio.connect(f"tcpin:127.0.0.1:{port}") as link:
            with socket.create_connection(("127.0.0.1", port)):
                await eventually(lambda: link.sync.port is not None)
                with socket.create_connection(("127.0.0.1", port)) as second:
                    second.sendall(heartbeat(7))
                    assert (await link.recv_match(timeout=WAIT)).get_seq() == 7
                    assert link.sync.clients_replaced == 1

    run(main())


# -- made-up ids


def flood(systems, components, names):
    """NAMED_VALUE_FLOAT messages of everyone under many names."""
    mav = mavlink.MAVLink(None)
    frames = []
    for mav.srcSystem in systems:
        for mav.srcComponent in components:
            for name in range(names):
                label = b"%d.%d" % (mav.srcComponent, name)
                frames.append(mavlink.MAVLink_named_value_float_message(1, label, 0).pack(mav))
    return b"".join(frames)


def telemetry(sysid, number):
    """What a vehicle and its camera say."""
    beats = [heartbeat(number, sysid, compid) for compid in (1, 100)]
    attitude = mavlink.MAVLink_attitude_message(number, 0.5, 0, 0, 0, 0, 0)
    return b"".join([*beats, pack(attitude, number + 1, sysid)])


def assert_known(link, sysid, number):
    assert link.latest("ATTITUDE", sysid, 1).time_boot_ms == number
    beats = [link.latest("HEARTBEAT", sysid, compid) for compid in (1, 100)]
    assert [beat.get_srcComponent() for beat in beats] == [1, 100]
    assert link.sysid_state[sysid].flightmode != "UNKNOWN"


def messages_kept(link):
    states = [link.sysid_state[sysid] for sysid in link.sysid_state]
    tables = [table for state in states for table in state.components.values()]
    return sum(len(table) - ("NAMED_VALUE_FLOAT" in table) for table in tables)


def test_a_flood_of_made_up_senders_is_bounded_and_shuts_out_no_vehicle():
    """R68, over all tables of a link: 512 messages of each system, and 4,096 others."""
    link = Capture()
    link.rx += telemetry(1, 5)
    drain_in_portions(link)
    for first in range(2, 66, 16):
        link.rx += flood(range(first, first + 16), range(256), 12) + telemetry(1, first)
        drain_in_portions(link)
        assert_known(link, 1, first)
    kept, refused = messages_kept(link), link.names_refused
    assert 4_096 < kept < 66 * 512 + 4_096
    assert refused > 150_000
    link.rx += telemetry(200, 7)  # who comes late finds room too
    drain_in_portions(link)
    assert_known(link, 200, 7)
    assert link.names_refused == refused


def test_parameters_are_bounded_over_all_senders():
    """R68."""
    of_one, of_all = 16_384, 262_144
    link = Capture()
    link.rx += heartbeat()

    def value(sysid, name):
        msg = mavlink.MAVLink_param_value_message(name.encode(), 1.5, 9, 200, 0)
        return pack(msg, 0, sysid)

    others = of_all // of_one + 1
    for sysid in range(2, 2 + others):
        for name in range(of_one):
            link.rx += value(sysid, f"P{name}")
    for name in range(200):
        link.rx += value(1, f"P{name}")
    drain_in_portions(link)
    assert len(link.params) == 200  # the target's
    assert sum(len(state.params) for state in link.param_state.values()) == of_all + 200
    assert link.names_refused == of_one


# -- servers that only send


def sends_until_heard(link: mavutil.mavtcpin, client: socket.socket) -> bool:
    """Whether `client` gets a heartbeat of a server that does nothing but send them."""
    client.settimeout(0.05)
    deadline = time.monotonic() + WAIT
    while time.monotonic() < deadline:
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        with contextlib.suppress(TimeoutError):
            return client.recv(1) == b"\xfd"
    return False


def test_a_tcp_server_that_only_sends_takes_one_client_after_the_other():
    with mavutil.mavlink_connection("tcpin:127.0.0.1:0") as link:
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert (link.port, link.frames_dropped) == (None, 1)
        for _ in range(2):
            with socket.create_connection(link.listen.getsockname(), WAIT) as client:
                assert sends_until_heard(link, client)
    link.mav.heartbeat_send(6, 8, 0, 0, 0)  # closed, which raises nothing
    assert (link.port, link.fd) == (None, None)


def test_a_sender_takes_no_second_client_while_another_thread_takes_one():
    with mavutil.mavlink_connection("tcpin:127.0.0.1:0") as link:
        accept, inside, go = link._accept, threading.Event(), threading.Event()

        def slowly():
            link._accept = accept
            inside.set()
            assert go.wait(WAIT)
            return accept()

        link._accept = slowly
        with socket.create_connection(link.listen.getsockname(), WAIT), watched(WAIT):
            receiver = threading.Thread(target=link.recv_msg)
            receiver.start()
            assert inside.wait(WAIT)
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert (link.port, link.frames_dropped) == (None, 1)
            go.set()
            receiver.join(WAIT)
            assert link.port is not None


# -- programs that read with `recv` and parse by themselves


def peer_of(link: mavutil.mavudp) -> socket.socket:
    """A bare socket that speaks to a server."""
    peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    peer.settimeout(WAIT)
    peer.connect(link.port.getsockname())
    return peer


def pump(link: mavutil.mavudp) -> list:
    """What MAVProxy does when the descriptor is ready."""
    assert link.select(WAIT)
    messages = link.mav.parse_buffer(link.recv(16 * 1024)) or []
    for msg in messages:
        link.post_message(msg)
    return messages


def test_who_sent_what_a_program_parsed_itself_is_answered():
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        peer.send(heartbeat())
        assert [msg.get_type() for msg in pump(link)] == ["HEARTBEAT"]
        assert link.clients == {peer.getsockname()}
        link.mav.ping_send(1, 2, 0, 0)
        assert peer.recv(300)[7] == mavlink.MAVLINK_MSG_ID_PING
        assert link.target_system == 1 and link.mav_count == 1


def test_who_sent_what_a_program_only_parsed_is_answered():
    """R61. MAVProxy does no more than that with its outputs."""
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        for nonsense in (b"x", heartbeat()[:-1], b"\xfd" * 300):
            peer.send(nonsense)
            assert link.select(WAIT) and link.recv() == nonsense
        assert not link.clients
        peer.send(b"x" + heartbeat())
        assert link.select(WAIT)
        (msg,) = link.mav.parse_buffer(link.recv()[1:])
        assert link.clients == {peer.getsockname()}
        link.write(msg.get_msgbuf())
        assert peer.recv(300) == heartbeat()


BEAT = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)


def received(link: mavutil.mavudp, peer: socket.socket, data: bytes) -> bytes:
    """What `recv` gives a program when `peer` has sent `data`."""
    peer.send(data)
    assert link.select(WAIT)
    return link.recv()


def test_with_a_key_who_sent_what_a_program_only_parsed_needs_a_good_signature(caplog):
    """What was looked at is still new to the program's parser; what was believed once is not again."""
    caplog.set_level(logging.INFO)
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        link.setup_signing(KEY, initial_timestamp=0, allow_unsigned_callback=lambda *_: True)
        assert link.mav.parse_buffer(received(link, peer, heartbeat()))
        assert not link.clients
        data = received(link, peer, signed(BEAT, timestamp=100))
        assert link.clients == {peer.getsockname()}
        signing = link.mav.signing
        assert (signing.sig_count, signing.timestamp, signing.stream_timestamps) == (0, 0, {})
        assert not caplog.records
        (msg,) = link.mav.parse_buffer(data)
        assert msg.get_signed() and signing.goodsig_count == 1
        with peer_of(link) as replayer:
            received(link, replayer, signed(BEAT, timestamp=100))
        assert link.clients == {peer.getsockname()}


def test_with_a_key_what_a_program_only_handed_on_is_no_good_for_a_second_time():
    """R39, R42: nor is what came while its sender was known, or over another link."""
    with (
        mavutil.mavlink_connection("udpin:127.0.0.1:0") as link,
        mavutil.mavlink_connection("udpin:127.0.0.1:0") as other,
        peer_of(link) as peer,
        peer_of(link) as replayer,
        peer_of(other) as stranger,
    ):
        for each in (link, other):
            each.setup_signing(KEY, initial_timestamp=0)
        frames = [signed(BEAT, timestamp=timestamp) for timestamp in (100, 101, 102)]
        received(link, peer, frames[0])
        received(link, peer, frames[1] + frames[2])
        for frame in frames:
            received(link, replayer, frame)
            received(other, stranger, frame)
        assert link.clients == {peer.getsockname()}
        assert not other.clients
        # Who read the frames as messages has no use for them either.
        assert len(link.mav.parse_buffer(signed(BEAT, timestamp=110))) == 1
        received(link, replayer, signed(BEAT, timestamp=109))
        assert link.clients == {peer.getsockname()}


@pytest.mark.parametrize("age", [-7200, 3600])
def test_with_a_key_who_sent_what_the_links_rules_refuse_is_not_answered(age, monkeypatch):
    """R40, R52: a recording of a stream that is not known, and a clock that is ahead."""
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        with monkeypatch.context() as patch:
            early = time.time() - 3 * 3600
            patch.setattr(time, "time", lambda: early)
            link.setup_signing(KEY, max_ahead=60)
        refused = signed(BEAT, timestamp=signing_timestamp(time.time() + age))
        (bad,) = link.mav.parse_buffer(received(link, peer, refused))
        assert (bad.get_type(), link.clients) == ("BAD_DATA", set())
        received(link, peer, signed(BEAT, timestamp=signing_timestamp(time.time())))
        assert link.clients == {peer.getsockname()}


def test_a_link_that_reads_its_own_messages_looks_at_nothing_twice(tmp_path, monkeypatch):
    """While the first byte is looked for, and with a raw log, what decides is what is received."""
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        link.setup_signing(KEY)
        link.setup_logfile_raw(str(tmp_path / "raw.log"))
        monkeypatch.setattr(link, "_holds_trusted", None)
        for junk in (b"x", b""):
            now = signing_timestamp(time.time())
            peer.send(junk + signed(BEAT, timestamp=now))
            assert receive(link).get_signed()
        assert link.clients == {peer.getsockname()}


def test_what_replaces_recv_reads_the_link():
    class Counting(mavutil.mavudp):
        reads = 0

        def recv(self, n=None):
            self.reads += 1
            return super().recv(n)

    with Counting("127.0.0.1:0") as link, peer_of(link) as peer:
        peer.send(heartbeat())
        assert receive(link) is not None
        assert link.reads and link.clients == {peer.getsockname()}


class OwnSigning:
    secret_key = None


class OwnParser:
    """A parser of the program's own."""

    def __init__(self):
        self.signing = OwnSigning()

    def parse_char(self, data):
        return None

    def bytes_needed(self):
        return 1


@pytest.mark.parametrize("is_native", [True, False])
def test_with_a_parser_of_a_programs_own_only_that_knows_its_key(is_native, monkeypatch):
    """Where the dialect is a program's own, too, that looks."""

    class OwnDialect:
        robust_parsing = False

        def parse_buffer(self, data):
            return mavlink.MAVLink(None).parse_buffer(data) if self.robust_parsing else None

    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        mav, link.mav = link.mav, OwnParser()
        if not is_native:
            monkeypatch.setattr(link, "_new_mav", OwnDialect)
        link.mav.signing.secret_key = KEY
        received(link, peer, heartbeat())
        assert not link.clients
        link.mav.signing.secret_key = None
        received(link, peer, heartbeat())
        assert link.clients == {peer.getsockname()}
        link.mav = mav


def test_a_client_whose_messages_a_program_only_hands_on_counts_as_heard():
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        peer.send(heartbeat())
        assert link.select(WAIT) and link.recv()
        address = peer.getsockname()
        link.clients_last_alive[address] = 1.0
        peer.send(heartbeat(seq=1))
        assert link.select(WAIT) and link.recv()
        assert link.clients_last_alive[address] > 1.0


def test_nobody_else_is_answered_for_what_a_program_parsed_itself():
    with mavutil.mavlink_connection("udpin:127.0.0.1:0") as link, peer_of(link) as peer:
        link.mav.robust_parsing = True
        peer.send(b"nonsense")
        assert {msg.get_type() for msg in pump(link)} <= {"BAD_DATA"}
        assert not link.clients
        with peer_of(link) as stranger:
            peer.send(heartbeat())
            msg = receive(link)
            stranger.send(b"nonsense")
            pump(link)
            link.post_message(msg)  # once more, while the stranger was heard last
            assert link.clients == {peer.getsockname()}
        link.setup_signing(b"k" * 32)
        with peer_of(link) as forger:
            forger.send(heartbeat(seq=1))
            pump(link)
            assert link.clients == {peer.getsockname()}
