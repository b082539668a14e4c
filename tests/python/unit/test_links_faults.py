"""What goes wrong on live links: several threads, a link that is closed under them, silent peers."""

from __future__ import annotations

import errno
import math
import os
import signal
import socket
import ssl
import struct
import threading
import time

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.links import one_client
from mavwire.links import serial_port as serial_port_module
from unit.link_tools import Capture, heartbeat, make_certificate
from watchdog import watched

WAIT = 60


def connected(**kw):
    """A link over TCP and the other end of it."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}", **kw)
        return link, server.accept()[0]


def in_threads(*jobs):
    """Start `jobs`; what they raise goes into the list returned."""
    raised: list[Exception] = []

    def run(job):
        try:
            job()
        except Exception as error:
            raised.append(error)

    threads = [threading.Thread(target=run, args=(job,), daemon=True) for job in jobs]
    for thread in threads:
        thread.start()
    return threads, raised


def join(threads):
    for thread in threads:
        thread.join(WAIT)
        assert not thread.is_alive()


def test_threads_that_write_and_receive_send_whole_frames():
    """R63."""
    link, peer = connected()
    frames, writers = 20_000, 2
    received = bytearray()

    def write():
        for seq in range(frames):
            link.write(heartbeat_frames[seq % 256])

    def receive():
        while any(thread.is_alive() for thread in sending) or link._has_unsent:
            link.recv_msg()

    def read():
        peer.settimeout(WAIT)
        while data := peer.recv(3000):
            received.extend(data)

    heartbeat_frames = [heartbeat(seq) for seq in range(256)]
    sending, raised = in_threads(*[write] * writers)
    others, raised_too = in_threads(receive, read)
    join([*sending, others[0]])
    link.close()
    join(others)
    peer.close()
    assert raised == raised_too == []
    messages = mavlink.MAVLink(None).parse_buffer(bytes(received))
    assert len(messages) == frames * writers - link.frames_dropped
    assert {msg.get_type() for msg in messages} == {"HEARTBEAT"}


@pytest.mark.parametrize(
    "device", ["tcp", "udpin:127.0.0.1:0", "mcast:", "tcpin:127.0.0.1:0", "serial", "exec"]
)
def test_closing_a_link_ends_a_thread_that_receives(device, tmp_path):
    if device == "tcp":
        link, _ = connected(autoreconnect=True)
    elif device == "serial":
        pytest.importorskip("serial")
        _, port = os.openpty()
        link = mavutil.mavlink_connection(os.ttyname(port), autoreconnect=True)
    elif device == "exec":
        program = tmp_path / "program"
        program.write_text("#!/bin/sh\nexec cat\n")
        program.chmod(0o700)
        link = mavutil.mavlink_connection(f"exec:{program}")
    else:
        link = mavutil.mavlink_connection(device)
    threads, raised = in_threads(
        lambda: link.recv_match(blocking=True), lambda: link.select(1000 * WAIT)
    )
    time.sleep(0.05)
    link.close()
    join(threads)
    assert [error.errno for error in raised if isinstance(error, OSError)] in (
        [errno.EBADF],
        [None],
    )
    assert link.fd is None


def test_closing_a_link_under_threads_that_use_it():
    for _ in range(20):
        link, peer = connected()

        def write(link=link):
            while not link._closed:
                link.write(heartbeat())

        def receive(link=link):
            while True:
                link.recv_msg()

        threads, raised = in_threads(write, receive)
        time.sleep(0.01)
        link.close()
        join(threads)
        peer.close()
        assert [type(error) for error in raised] == [OSError]


class Silent:
    """The socket of a connection whose peer stopped answering."""

    def __init__(self, port):
        self.fileno, self.close = port.fileno, port.close

    def recv(self, size):
        raise TimeoutError(errno.ETIMEDOUT, "Connection timed out")


def test_a_peer_that_stopped_answering_is_left(capsys):
    """R64."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        link = mavutil.mavlink_connection(device, autoreconnect=True)
        first, _ = server.accept()
        link.port = Silent(link.port)
        assert link.recv_msg() is None
        second, _ = server.accept()
        second.sendall(heartbeat(7))
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 7
        for end in (first, second, link):
            end.close()


def test_tcpin_leaves_a_client_that_stopped_answering():
    """R64."""
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    address = link.listen.getsockname()
    with socket.create_connection(address), socket.create_connection(address) as second:
        with watched(WAIT):
            while link.port is None:
                link.recv_msg()
        link.port = Silent(link.port)
        assert link.recv_msg() is None
        second.sendall(heartbeat(7))
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 7
    link.close()


@pytest.mark.skipif(not hasattr(socket, "TCP_KEEPIDLE"), reason="not to be set on this system")
def test_connections_are_kept_alive():
    link, peer = connected()
    assert link.port.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
    assert link.port.getsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE) == 10
    link.close()
    peer.close()


def test_ctrl_c_ends_waiting_for_another_sender():
    """R65."""
    entered, leave = threading.Event(), threading.Event()

    class Slow(Capture):
        def write(self, buf):
            entered.set()
            leave.wait(WAIT)

    link = Slow()
    threads, _ = in_threads(lambda: link.mav.heartbeat_send(1, 2, 3, 4, 5))
    assert entered.wait(WAIT)
    waits = threading.Event()

    def interrupt():
        waits.wait(WAIT)
        time.sleep(0.1)  # now it does, most likely
        os.kill(os.getpid(), signal.SIGINT)

    interrupting, _ = in_threads(interrupt)
    try:
        with watched(WAIT), pytest.raises(KeyboardInterrupt):
            waits.set()
            link.mav.heartbeat_send(1, 2, 3, 4, 5)
            leave.wait(WAIT)  # if it was interrupted nowhere
    finally:
        leave.set()
    join([*threads, *interrupting])
    link.mav.heartbeat_send(1, 2, 3, 4, 5)
    assert link.mav.total_packets_sent == 2


def test_a_closed_websocket_link_stays_closed():
    pytest.importorskip("wsproto")
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))  # where nobody listens yet
        link = mavutil.mavlink_connection(f"ws:127.0.0.1:{server.getsockname()[1]}")
        link.close()
        server.listen()
        server.setblocking(False)
        with pytest.raises(OSError, match="Bad file descriptor"):
            link.recv_msg()
        link.write(heartbeat())
        with pytest.raises(BlockingIOError):
            server.accept()


@pytest.mark.parametrize("kind", ["tcpin", "wsserver"])
def test_a_server_that_is_closed_while_it_accepts_keeps_no_client(kind, monkeypatch):
    if kind == "wsserver":
        pytest.importorskip("wsproto")
    link = mavutil.mavlink_connection(f"{kind}:127.0.0.1:0")
    with socket.create_connection(link.listen.getsockname(), WAIT) as client:
        # Another thread closes it in between.
        monkeypatch.setattr(one_client, "prepare_tcp", lambda port: link.close())
        for _ in range(2):
            with pytest.raises(OSError) as caught:
                link.recv_msg()
            assert caught.value.errno == errno.EBADF
        assert (link.port, link.fd, client.recv(1)) == (None, None, b"")


def test_a_websocket_under_tls_outlives_silence(tmp_path, monkeypatch):
    wsproto = pytest.importorskip("wsproto")
    certificate = make_certificate(tmp_path, monkeypatch)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate)
    listener = socket.create_server(("127.0.0.1", 0))
    sent = threading.Event()

    def serve():
        client, _ = listener.accept()
        peer = context.wrap_socket(client, server_side=True)
        peer.settimeout(WAIT)
        ws = wsproto.WSConnection(wsproto.ConnectionType.SERVER)
        ws.receive_data(peer.recv(65536))
        next(iter(ws.events()))
        peer.sendall(ws.send(wsproto.events.AcceptConnection()))
        assert sent.wait(WAIT)
        peer.sendall(ws.send(wsproto.events.BytesMessage(data=heartbeat(7))))
        ws.receive_data(peer.recv(65536))
        assert [bytes(event.data) for event in ws.events()] == [heartbeat(8)]

    threads, raised = in_threads(serve)
    link = mavutil.mavlink_connection(f"wss:localhost:{listener.getsockname()[1]}")
    port = link.port
    for _ in range(3):
        assert link.recv_msg() is None
    sent.set()
    assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 7
    link.write(heartbeat(8))
    join(threads)
    assert raised == []
    assert link.port is port
    link.close()
    listener.close()


def test_a_websocket_is_read_by_one_thread_at_a_time():
    """A second one would find a generator that runs already, and raise."""
    pytest.importorskip("wsproto")
    inside, go = threading.Event(), threading.Event()
    with mavutil.mavlink_connection("wsserver:127.0.0.1:0") as link, watched(WAIT):

        def accept():
            inside.set()
            assert go.wait(WAIT)
            return False

        link._accept = accept
        threads, raised = in_threads(link.recv_msg)
        assert inside.wait(WAIT)
        link._accept = None
        assert link.recv_msg() is None
        go.set()
        join(threads)
        assert raised == []


class Watching:
    """Time that passes with sleeping alone."""

    now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


@pytest.mark.parametrize("timeout", [1.0, 0.1, math.nan, -1.0])
def test_a_descriptor_that_cannot_be_watched_costs_no_processor_time(timeout, monkeypatch):
    link = Capture()
    clock = Watching()
    monkeypatch.setattr("mavwire.links.mavfile.time", clock)
    with socket.socket() as port:
        closed = port.fileno()
    for fd in (-1, "none", closed):
        link.fd = fd
        before = clock.now
        assert link.select(timeout) is False
        assert clock.now - before == pytest.approx(max(0, min(0.25, timeout)))


def test_a_time_that_is_no_number_does_not_wait_for_ever():
    with socket.socketpair()[0] as port, watched(WAIT):
        link = Capture()
        link.fd = port.fileno()
        assert link.select(math.nan) is False


def test_what_is_left_to_send_is_known():
    """Or what is left would wait for the next frame."""
    link, peer = connected()

    class Port:
        """Takes frames, then nothing for a while."""

        takes = True

        def send(self, data):
            if not self.takes:
                raise BlockingIOError
            return len(data)

    port = Port()
    known = []
    for act in (
        lambda: link._send_frame(port, heartbeat()),
        lambda: setattr(port, "takes", False),
        lambda: link._send_frame(port, heartbeat()),
        link._forget_unsent,
        lambda: link._send_frame(port, heartbeat()),
        lambda: link._send_rest(port),
        lambda: setattr(port, "takes", True),
        lambda: link._send_rest(port),
    ):
        act()
        known.append(link._has_unsent)
    assert known == [False, False, True, False, True, True, True, False]
    link.close()
    peer.close()


def test_a_frame_that_comes_while_another_thread_ends_its_sending_is_not_left_behind():
    link, peer = connected()
    sent = []

    class Port:
        """While the first frame is being sent, another thread brings the second."""

        def send(self, data):
            if not sent:
                sent.append(data)
                thread = threading.Thread(target=link._send_frame, args=[self, heartbeat(2)])
                thread.start()
                thread.join()
            else:
                sent.append(data)
            return len(data)

    link._send_frame(Port(), heartbeat(1))
    assert sent == [heartbeat(1), heartbeat(2)]
    assert not link._has_unsent
    link.close()
    peer.close()


@pytest.fixture
def line():
    """A serial port, and the descriptor of its other end."""
    if not hasattr(os, "openpty"):
        pytest.skip("no pseudo terminals")
    pytest.importorskip("serial")
    ends = os.openpty()
    yield os.ttyname(ends[1]), ends[0]
    for end in ends:
        os.close(end)


@pytest.fixture
def serial_port(line):
    return line[0]


def sequence(end, count, flush=lambda: None):
    """The sequence numbers of the next `count` messages at one end of a serial line."""
    mav = mavlink.MAVLink(None)
    os.set_blocking(end, False)
    seen = []
    while len(seen) < count:
        try:
            seen += [msg.get_seq() for msg in mav.parse_buffer(os.read(end, 4096)) or []]
        except BlockingIOError:
            flush()
            time.sleep(0.001)
    return seen


class HeldSerial:
    """Opening a serial port succeeds, and takes until `leave` is set."""

    def __init__(self, monkeypatch):
        import serial

        self.made, self.leave = threading.Event(), threading.Event()
        self.opened = []
        self._open = serial.Serial
        monkeypatch.setattr(serial, "Serial", self)

    def __call__(self, *args, **kw):
        port = self._open(*args, **kw)
        self.opened.append(port)
        self.made.set()
        self.leave.wait(WAIT)
        return port


def test_a_serial_port_is_reopened_by_one_thread_and_not_after_closing(serial_port, monkeypatch):
    link = mavutil.mavlink_connection(serial_port, autoreconnect=True)
    held = HeldSerial(monkeypatch)
    thread = threading.Thread(target=link._lost, args=[link.port])
    thread.start()
    assert held.made.wait(WAIT)
    with watched(WAIT):
        assert link.reset() is False
        link._maybe_reset()
        link.close()
    held.leave.set()
    thread.join(WAIT)
    assert len(held.opened) == 1
    assert (held.opened[0].is_open, link.port.is_open, link.fd) == (False, False, None)
    assert link.reset() is False


def test_an_error_of_a_serial_port_is_not_one_of_the_next(line, monkeypatch, capsys):
    """The receiving thread opens the port anew while another one is told that it is gone."""
    device, _ = line
    with mavutil.mavlink_connection(device, autoreconnect=True) as link:
        old, send = link.port, link._send_frame

        def fail(port, frame):
            monkeypatch.setattr(link, "_send_frame", send)
            assert link.reset()
            link._writer.write(Begun(), heartbeat(9))
            raise OSError(errno.EIO, "Input/output error")

        monkeypatch.setattr(link, "_send_frame", fail)
        assert link.write(heartbeat(1)) == -1
        assert (link.port is not old, link.port.is_open, link.portdead) == (True, True, False)
        assert link._writer.unsent == heartbeat(9)[5:]
        assert "dead" not in capsys.readouterr().out


class Begun:
    """A connection that takes the beginning of a frame."""

    taken = b""

    def send(self, data):
        if self.taken:
            raise BlockingIOError
        self.taken = data[:5]
        return 5

    def close(self):
        raise KeyboardInterrupt


def test_an_interrupt_while_a_client_is_let_go_leaves_nothing_to_the_next():
    link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
    address = link.listen.getsockname()
    with watched(WAIT), socket.create_connection(address):
        while link.port is None:
            link.recv_match(blocking=True, timeout=1.0)
        first, link.port = link.port, Begun()
        link.write(heartbeat(1))
        with pytest.raises(KeyboardInterrupt):
            link._let_go(link.port)
        first.close()
        with socket.create_connection(address) as second:
            while link.port is None:
                link.recv_match(blocking=True, timeout=1.0)
            link.write(heartbeat(2))
            assert second.recv(100) == heartbeat(2)
    assert link.frames_dropped == 1
    link.close()


def test_a_thread_that_is_late_touches_no_later_connection():
    link, peer = connected(autoreconnect=True)
    old = link.port
    link._writer.write(Begun(), heartbeat(1))
    assert link._let_go(old)
    assert (link.port, link._has_unsent, link.frames_dropped) == (None, False, 1)
    link.port = new = Begun()
    link.write(heartbeat(2))
    # It sends nothing of what the new one has begun, and ends nothing.
    link._send_frame(old, heartbeat(3))
    link._send_rest(old)
    assert not link._let_go(old)
    assert link.port is new
    assert link._writer.unsent == heartbeat(2)[5:]
    assert link.frames_dropped == 2
    link.port = None
    link.close()
    peer.close()


@pytest.mark.skipif(os.name != "posix", reason="needs a shell script")
def test_a_child_that_is_closed_by_another_thread_is_not_read_by_its_number(tmp_path, monkeypatch):
    program = tmp_path / "child"
    program.write_text("#!/bin/sh\nexec cat\n")
    program.chmod(0o700)
    link = mavutil.mavlink_connection(f"exec:{program}")
    number = link.fd
    other, writes = os.pipe()
    os.write(writes, b"somebody else's")

    def close(port):
        link.close()
        os.dup2(other, number)

    monkeypatch.setattr(link, "_send_rest", close)
    with pytest.raises(OSError, match="descriptor"):
        link.recv(100)
    assert os.read(other, 100) == b"somebody else's"
    for fd in (number, other, writes):
        os.close(fd)


def test_a_serial_port_is_reopened_once_a_second_at_most(serial_port, monkeypatch):
    link = mavutil.mavlink_connection(serial_port, autoreconnect=True)
    held = HeldSerial(monkeypatch)
    held.leave.set()
    now = 1000.0
    monkeypatch.setattr("mavwire.links.serial_port.monotonic", lambda: now)
    for _ in range(3):
        link._maybe_reset()
    assert len(held.opened) == 1
    now += 1
    link._maybe_reset()
    assert len(held.opened) == 2
    link.close()


@pytest.mark.parametrize("baud", ["x", -5, None, float("inf")])
def test_an_unusable_baud_rate_is_why_a_serial_port_stays_dead(serial_port, baud, caplog):
    link = mavutil.mavlink_connection(serial_port, autoreconnect=True, reconnect_delay=0)
    link.baud = baud
    for _ in range(2):
        assert not link.reset()
    reason = f"the baud rate {baud!r} of the serial port {serial_port} is not a number"
    assert link.connect_error.strerror == reason
    assert [record.getMessage() for record in caplog.records] == [f"{reason}; trying again"]
    link.baud = 115200
    assert link.reset() and link.connect_error is None
    link.close()


def test_a_serial_port_whose_rate_is_refused_is_not_left_open(serial_port, monkeypatch):
    import serial

    opened, open_port = [], serial.Serial
    monkeypatch.setattr(
        serial, "Serial", lambda *args, **kw: opened.append(open_port(*args, **kw)) or opened[0]
    )
    with pytest.raises(ValueError, match="invalid literal"):
        mavutil.mavlink_connection(serial_port, baud="x")
    assert [port.is_open for port in opened] == [False]


def test_a_rate_that_is_no_number_of_the_systems_is_why_a_port_stays_dead(serial_port):
    link = mavutil.mavlink_connection(serial_port, autoreconnect=True, reconnect_delay=0)
    link.baud = 10**12
    link._lost(link.port)
    assert link.recv() == b""
    assert link.portdead and link.connect_error
    link.close()


def test_a_serial_port_is_reopened_with_its_flow_control(serial_port):
    link = mavutil.mavlink_connection(serial_port, autoreconnect=True)
    link.set_rtscts(True)
    before = link.port
    assert link.reset()
    assert (link.port is not before, link.port.rtscts) == (True, True)
    link.close()


def test_a_serial_port_that_is_unplugged_while_it_is_opened_is_tried_again(
    serial_port, monkeypatch, caplog
):
    import termios

    import serial

    def unplugged(port):
        raise termios.error(errno.EIO, "Input/output error")

    link = mavutil.mavlink_connection(serial_port, autoreconnect=True, reconnect_delay=0)
    with monkeypatch.context() as patched:
        patched.setattr(serial.Serial, "_reset_input_buffer", unplugged)
        link._lost(link.port)
        assert link.recv() == b""
        reason = f"{serial_port}: Input/output error; trying again"
        assert [record.getMessage() for record in caplog.records] == [reason]
        with pytest.raises(serial.SerialException, match="Input/output error"):
            mavutil.mavlink_connection(serial_port)
    assert link.reset()
    link.close()


def test_a_serial_port_that_is_closed_under_a_writer_says_nothing(serial_port, capsys):
    link = mavutil.mavlink_connection(serial_port)

    class Closing:
        """The other thread closes the link while this one writes."""

        def write(self, data):
            link.close()
            raise OSError(errno.EBADF, "Bad file descriptor")

    real, link.port = link.port, Closing()
    link.port.close = real.close
    assert link.write(heartbeat()) == -1
    assert (capsys.readouterr().out, real.is_open) == ("", False)


def test_a_serial_port_that_nobody_reads_stops_no_sender(line, monkeypatch):
    device, end = line
    waits = []

    def wait_writable(fd, timeout):
        waits.append(timeout)
        return real(fd, min(timeout, 0.01))

    real = serial_port_module.wait_writable
    monkeypatch.setattr(serial_port_module, "wait_writable", wait_writable)
    with mavutil.mavlink_connection(device) as link, watched(WAIT):
        sent = 3000
        for _ in range(sent):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert waits.count(serial_port_module.WRITE_TIMEOUT) == 1
        assert len(link._writer.unsent) <= serial_port_module.MAX_UNSENT
        left = sent - link.frames_dropped
        assert 0 < left < sent
        assert link.write(heartbeat()) == 0
        assert sequence(end, left, link.recv_msg) == [seq % 256 for seq in range(left)]
        # It is waited for again, and loses nothing more.
        dropped = link.frames_dropped
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert sequence(end, 1, link.recv_msg) == [sent % 256]
        assert (link.frames_dropped, link._is_stuck) == (dropped, False)


def test_a_serial_line_that_another_thread_does_not_stop_sending_on_is_not_waited_for(
    line, monkeypatch
):
    device, end = line
    monkeypatch.setattr(serial_port_module, "WRITE_TIMEOUT", 0.01)
    with mavutil.mavlink_connection(device) as link, watched(WAIT):

        class Other:
            """The port as another thread uses it, which is in the middle of sending."""

            def send(self, data):
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                raise BlockingIOError

        link._writer.write(Other(), heartbeat(9))
        assert link._is_stuck
        assert sequence(end, 2, link.recv_msg) == [9, 0]
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert sequence(end, 1) == [1]
        assert (link.frames_dropped, link._is_stuck) == (0, False)


def test_a_sender_that_is_faster_than_the_serial_line_is_slowed_down(line, monkeypatch):
    device, end = line
    # The reader may be kept from reading for as long as it takes.
    monkeypatch.setattr(serial_port_module, "WRITE_TIMEOUT", WAIT)
    sent = 3000
    with mavutil.mavlink_connection(device) as link, watched(WAIT):
        seen = []
        reader = threading.Thread(target=lambda: seen.extend(sequence(end, sent)))
        reader.start()
        for _ in range(sent):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        reader.join(WAIT)
        assert (len(seen), link.frames_dropped) == (sent, 0)


def reset(client):
    """End a connection so that the peer is told of an error, not of an end."""
    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()


def test_a_connection_that_was_reset_is_an_error_once(capsys):
    """The system says so to the native read alone."""
    link, peer = connected()
    peer.sendall(heartbeat(7))
    assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 7
    reset(peer)
    with watched(WAIT), pytest.raises(ConnectionResetError) as raised:
        while True:
            link.recv_match(blocking=True)
    assert raised.value.errno == errno.ECONNRESET
    assert capsys.readouterr().out == "Connection reset or closed by peer on TCP socket\n"
    assert link.port is None
    link.close()


def test_the_error_of_a_connection_is_not_taken_for_one_of_the_next(monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        first, next_port = server.accept()[0], socket.create_connection(server.getsockname())
        second = server.accept()[0]
        slowly = link._recv_by_methods

        def meanwhile():
            """Another thread has a new connection by now."""
            link.port, old = next_port, link.port
            link.fd = next_port.fileno()
            next_port.setblocking(False)
            old.close()
            return slowly()

        link._recv_by_methods = meanwhile
        reset(first)
        with watched(WAIT):
            while link.port is not next_port:
                link.recv_msg()
        link._recv_by_methods = slowly
        second.sendall(heartbeat(8))
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 8
        assert link.port is next_port
        for end in (second, link):
            end.close()
