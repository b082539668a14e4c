"""Clients that lose their other end: when they try again, that nobody waits for it, and what the next
connection begins with."""

from __future__ import annotations

import errno
import socket
import threading
import time
from itertools import pairwise

import pytest
from mavwire import mavutil
from mavwire.links import reconnecting, tcp, websocket
from mavwire.links.stream import StreamLink
from unit.link_tools import heartbeat
from watchdog import watched

WAIT = 60.0


pytestmark = pytest.mark.usefixtures("mavlink20")


class Server:
    """Where a TCP or Unix domain client connects to."""

    def __init__(self, kind, folder):
        family = socket.AF_UNIX if kind == "uds" else socket.AF_INET
        self.listener = socket.socket(family)
        self.listener.bind(f"{folder}/socket" if kind == "uds" else ("127.0.0.1", 0))
        self.listener.listen()
        self.listener.settimeout(WAIT)
        address = self.listener.getsockname()
        self.device = f"uds:{address}" if kind == "uds" else f"tcp:127.0.0.1:{address[1]}"

    def link(self):
        """A client that connects again, and this side of its connection."""
        link = mavutil.mavlink_connection(self.device, autoreconnect=True)
        return link, self.accept()

    def accept(self):
        peer = self.listener.accept()[0]
        peer.settimeout(WAIT)
        return peer


@pytest.fixture(params=["tcp", "uds"])
def server(request, tmp_path):
    server = Server(request.param, tmp_path)
    yield server
    server.listener.close()


class Attempts:
    """A clock of the test's own, and the moments of the attempts, which end before `recv` does."""

    def __init__(self, monkeypatch):
        self.now = 1000.0
        self.moments = []
        monkeypatch.setattr(reconnecting, "monotonic", lambda: self.now)
        monkeypatch.setattr(reconnecting, "start_new_thread", lambda job, args: job(*args))

    def of(self, link, after=lambda: None):
        """Have the attempts of `link` noted, and `after` called behind each that succeeds."""
        connect = link._connect

        def noting():
            self.moments.append(self.now)
            connection = connect()
            after()
            return connection

        link._connect = noting

    def pauses(self):
        return [after - before for before, after in pairwise(self.moments)]


@pytest.fixture
def attempts(monkeypatch):
    return Attempts(monkeypatch)


def test_a_peer_that_only_hangs_up_is_left_in_peace(server, attempts):
    link, peer = server.link()
    peer.close()
    attempts.of(link, after=lambda: server.accept().close())
    with watched(WAIT):
        while len(attempts.moments) < 7:
            assert link.recv_msg() is None
            attempts.now += 0.0 if link.port else 0.5
    link.close()
    assert attempts.pauses() == [1, 2, 4, 8, 16, 16]


def test_a_peer_that_sent_a_message_is_connected_to_at_once(server, attempts):
    link, peer = server.link()
    attempts.of(link)
    for seq in range(5):
        attempts.now += 1
        peer.sendall(heartbeat(seq))
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == seq
        peer.close()
        with watched(WAIT):
            while len(attempts.moments) <= seq:
                assert link.recv_msg() is None
        peer = server.accept()
    link.close()
    peer.close()
    assert attempts.pauses() == [1, 1, 1, 1]


def test_a_peer_that_sends_a_message_and_hangs_up_is_left_in_peace(server, attempts):
    link, peer = server.link()
    attempts.of(link)
    for seq in range(5):
        peer.sendall(heartbeat(seq))
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == seq
        peer.close()
        with watched(WAIT):
            while len(attempts.moments) <= seq:
                assert link.recv_msg() is None
                attempts.now += 0.0 if link.port else 0.5
        peer = server.accept()
    link.close()
    peer.close()
    assert attempts.pauses() == [1, 2, 4, 8]


def test_an_end_that_two_threads_notice_is_told_once_and_costs_one_connection(server, monkeypatch):
    """R64."""
    link, peer = server.link()
    told, sending, telling = [], threading.Event(), threading.Event()

    class Broken:
        fileno = link.port.fileno
        close = link.port.close

        def recv(self, n):
            return b""

        def send(self, data):
            sending.set()
            assert telling.wait(WAIT)
            raise ConnectionResetError

    def tell(text):
        if "socket" in text:
            told.append(text)
            telling.set()
            if threading.current_thread() is not writer:
                writer.join(WAIT)
                link.reconnect()
                until_connected()

    def until_connected():
        with watched(WAIT):
            while link.port is None:
                time.sleep(0.001)
        made.append(link.port)

    made = []
    monkeypatch.setattr("builtins.print", tell)
    writer = threading.Thread(target=link.write, args=[heartbeat()])
    link.port = Broken()
    writer.start()
    assert sending.wait(WAIT)
    assert link.recv() == b""
    assert len(told) == 1 and told[0].startswith("EOF on")
    assert [link.port] == made
    link.close()
    peer.close()


class Held:
    """The attempts of a link succeed, and take until `leave` is set."""

    def __init__(self, link):
        self.made, self.leave = threading.Event(), threading.Event()
        self.count = 0
        self._connect, link._connect = link._connect, self

    def __call__(self):
        self.count += 1
        connection = self._connect()
        self.made.set()
        self.leave.wait(WAIT)
        return connection


def lose(link, peer):
    """Have the peer hang up, and the link notice."""
    peer.close()
    with watched(WAIT):
        while link.port is not None:
            assert link.recv_msg() is None


def until(condition, link):
    with watched(WAIT):
        while not condition():
            link.recv_match(blocking=True, timeout=0.01)


def test_nobody_waits_for_an_attempt_and_there_is_one_at_a_time(server):
    link, peer = server.link()
    attempt = Held(link)
    with watched(WAIT):
        lose(link, peer)
        assert attempt.made.wait(WAIT)
        users = [threading.Thread(target=link.write, args=[heartbeat()]) for _ in range(3)]
        for user in users:
            user.start()
        for user in users:
            user.join()
        assert link.recv_match(blocking=True, timeout=0.05) is None
        assert (attempt.count, link.port, link.frames_dropped) == (1, None, 3)
    attempt.leave.set()
    until(lambda: link.port, link)
    with server.accept() as second:
        second.sendall(heartbeat(7))
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 7
        link.write(heartbeat(8))
        assert second.recv(100) == heartbeat(8)
    link.close()
    assert attempt.count == 1


def test_a_link_that_is_closed_during_an_attempt_stays_closed(server):
    link, peer = server.link()
    attempt = Held(link)
    lose(link, peer)
    assert attempt.made.wait(WAIT)
    link.close()
    attempt.leave.set()
    with server.accept() as second:
        assert second.recv(1) == b""  # the connection that was made
    assert (link.port, link.fd) == (None, None)


class Begun:
    """A connection that takes the beginning of a frame."""

    def __init__(self):
        self._takes = iter([5])

    def send(self, data):
        for taken in self._takes:
            return taken
        raise BlockingIOError


def test_a_connection_begins_with_a_whole_frame(server):
    """R63."""
    link, peer = server.link()
    link._writer.write(Begun(), heartbeat())
    link._use(link._connect())
    with server.accept() as second:
        link.write(heartbeat(7))
        assert second.recv(100) == heartbeat(7)
    link.close()
    peer.close()


def test_a_connection_that_cannot_be_prepared_is_closed(server, monkeypatch):
    if not server.device.startswith("tcp"):
        pytest.skip("there is nothing to prepare")

    def refuse(port):
        raise OSError(errno.EINVAL, "no such option")

    link, peer = server.link()
    monkeypatch.setattr(tcp, "prepare_tcp", refuse)
    lose(link, peer)
    until(lambda: link.connect_error, link)
    with server.accept() as second:
        assert second.recv(1) == b""
    assert link.connect_error.__traceback__ is None, "which would hold the link"
    link.close()


def test_without_a_thread_to_spare_the_next_attempt_is_later(server, attempts, monkeypatch):
    def refuse(*_):
        raise RuntimeError("can't start new thread")

    link, peer = server.link()
    attempts.of(link)
    with monkeypatch.context() as patch:
        patch.setattr(reconnecting, "start_new_thread", refuse)
        lose(link, peer)
    assert (link.recv_msg(), attempts.moments) == (None, [])
    attempts.now += 1
    assert (link.recv_msg(), attempts.moments) == (None, [1001])
    assert link.port is not None
    link.close()


# -- WebSocket


class WebSocketServer:
    """A server of ours in a thread."""

    def __init__(self):
        pytest.importorskip("wsproto")
        self.link = mavutil.mavlink_connection("wsserver:127.0.0.1:0")
        self.device = f"ws:127.0.0.1:{self.link.listen.getsockname()[1]}"
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self):
        while not self._stop.is_set():
            self.link.recv_match(blocking=True, timeout=0.02)

    def close(self):
        self._stop.set()
        self._thread.join()
        self.link.close()


@pytest.fixture
def websockets():
    server = WebSocketServer()
    yield server
    server.close()


def test_a_websocket_without_a_server_is_tried_now_and_then(attempts):
    pytest.importorskip("wsproto")
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))  # and nobody listens
        with mavutil.mavlink_connection(f"ws:127.0.0.1:{silent.getsockname()[1]}") as link:
            attempts.of(link)
            while len(attempts.moments) < 5:
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert link.recv_msg() is None
                attempts.now += 0.5
            assert attempts.pauses() == [1, 2, 4, 8]
            assert link.frames_dropped == 31


def test_a_websocket_server_that_fails_otherwise_is_tried_again(websockets, attempts):
    link = mavutil.mavlink_connection(websockets.device)

    def fail():
        attempts.moments.append(attempts.now)
        raise TimeoutError("no answer")

    link._connect = fail
    link.close_port()
    for _ in range(4):
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert link.recv_msg() is None
        attempts.now += 1
    assert attempts.pauses() == [1, 2]
    link.close()


def test_nobody_waits_for_a_websocket(websockets):
    link = mavutil.mavlink_connection(websockets.device)
    attempt = Held(link)
    link.close_port()
    with watched(WAIT):
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert attempt.made.wait(WAIT)
        assert link.recv_match(blocking=True, timeout=0.05) is None
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
    assert (attempt.count, link.frames_dropped) == (1, 2)
    attempt.leave.set()
    until(link._established, link)
    link.close()
    assert attempt.count == 1


def test_a_websocket_that_is_closed_during_an_attempt_stays_closed(websockets):
    link = mavutil.mavlink_connection(websockets.device)
    attempt = Held(link)
    link.close_port()
    assert link.recv_msg() is None
    assert attempt.made.wait(WAIT)
    link.close()
    attempt.leave.set()
    with watched(WAIT):
        while link._connecting.locked():
            pass
    assert (link.port, link.ws, link.fd) == (None, None, None)


def test_an_attempt_that_fails_once_the_link_is_closed_is_no_news(server, caplog):
    link, peer = server.link()
    begun, leave = threading.Event(), threading.Event()

    def fail():
        begun.set()
        assert leave.wait(WAIT)
        raise TimeoutError("no answer")

    link._connect = fail
    lose(link, peer)
    assert begun.wait(WAIT)
    link.close()
    leave.set()
    with watched(WAIT):
        while link._connecting.locked():
            pass
    assert (link.connect_error, caplog.records) == (None, [])


def test_messages_that_come_with_the_handshake_are_received():
    wsproto = pytest.importorskip("wsproto")
    listener = socket.create_server(("127.0.0.1", 0))

    def serve():
        peer = listener.accept()[0]
        ws = wsproto.WSConnection(wsproto.ConnectionType.SERVER)
        ws.receive_data(peer.recv(65536))
        accept = ws.send(wsproto.events.AcceptConnection())
        peer.sendall(accept + ws.send(wsproto.events.BytesMessage(data=heartbeat(7))))
        with peer:
            peer.recv(1)

    thread = threading.Thread(target=serve)
    thread.start()
    with mavutil.mavlink_connection(f"ws:127.0.0.1:{listener.getsockname()[1]}") as link:
        assert link.recv_match(blocking=True, timeout=WAIT).get_seq() == 7
    thread.join()
    listener.close()


WRONG_KEY = (
    b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Accept: AAAA\r\n\r\n"
)
NOT_ASCII = WRONG_KEY.replace(b"Connection: Upgrade", b"Connection: \xff")


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (b"", "hung up during"),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", "refused the WebSocket handshake: HTTP status 404"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhello", "HTTP status 200"),
        (b"no web server\r\n\r\n", "does not speak WebSocket"),
        (WRONG_KEY, "does not speak WebSocket"),
        (NOT_ASCII, "does not speak WebSocket"),
    ],
)
def test_a_websocket_that_is_refused_says_why(answer, reason, caplog, monkeypatch):
    pytest.importorskip("wsproto")
    monkeypatch.setattr(websocket, "HANDSHAKE_TIMEOUT", WAIT)  # whatever else the machine does
    listener = socket.create_server(("127.0.0.1", 0))
    device = f"ws:127.0.0.1:{listener.getsockname()[1]}"
    stop = threading.Event()

    def serve():
        while not stop.is_set():
            with listener.accept()[0] as peer:
                if peer.recv(65536):
                    peer.sendall(answer)

    thread = threading.Thread(target=serve)
    thread.start()
    with pytest.raises(OSError, match=f"{device} .*{reason}"):
        mavutil.mavlink_connection(device)
    # A link that loses its server is told the same, goes on trying, and logs it once.
    with without_server(device) as link, watched(WAIT):
        link.reconnect_delay = 0.0
        while link.connect_error is None or reason not in str(link.connect_error):
            link.recv_msg()
        failure = link.connect_error
        while link.connect_error is failure:
            link.recv_msg()
    assert [reason in record.getMessage() for record in caplog.records] == [True]
    stop.set()
    socket.create_connection(listener.getsockname()).close()
    thread.join()
    listener.close()


def without_server(device):
    """A WebSocket link whose server was not there when it was opened."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mavutil.mavwebsocket_client, "connect", lambda self: False)
        return mavutil.mavlink_connection(device)


def test_a_websocket_server_that_is_not_up_yet_is_logged_once(attempts, caplog):
    pytest.importorskip("wsproto")
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))  # and nobody listens
        device = f"ws:127.0.0.1:{silent.getsockname()[1]}"
        with mavutil.mavlink_connection(device) as link:
            attempts.of(link)
            while len(attempts.moments) < 3:
                assert link.recv_msg() is None
                attempts.now += 0.5
            assert isinstance(link.connect_error, ConnectionRefusedError)
    (record,) = caplog.records
    assert record.getMessage() == f"{device}: Connection refused; trying again"


@pytest.mark.parametrize(
    "error",
    [
        OSError(errno.ETIMEDOUT, "Connection timed out"),
        OSError(errno.ENETUNREACH, "Network is unreachable"),
        socket.gaierror(socket.EAI_NONAME, "Name or service not known"),
    ],
)
def test_a_websocket_server_that_cannot_be_reached_is_waited_for(error, attempts, monkeypatch):
    pytest.importorskip("wsproto")

    def refuse(*_):
        raise error

    monkeypatch.setattr(websocket, "connect_to", refuse)
    link = mavutil.mavlink_connection("ws:127.0.0.1:9")
    assert link.connect_error is error
    attempts.of(link)
    attempts.now += 1
    link.recv_match()
    assert len(attempts.moments) == 1
    link.close()


def test_a_websocket_whose_end_was_interrupted_is_connected_again(
    websockets, attempts, monkeypatch
):
    class Stop(Exception):
        pass

    let_go = StreamLink._let_go

    def interrupt(one, port):
        if one is link:
            raise Stop
        return let_go(one, port)

    link = mavutil.mavlink_connection(websockets.device)
    attempts.of(link)
    with monkeypatch.context() as patch, watched(WAIT):
        patch.setattr(StreamLink, "_let_go", interrupt)
        websockets.link.close_port()
        with pytest.raises(Stop):
            while True:
                link.recv_msg()
    with watched(WAIT):
        while not attempts.moments:
            link.recv_msg()
            attempts.now += 1
    assert link._established()
    link.close()


def test_who_lets_go_of_a_connection_has_closed_it(server):
    """Whatever a signal handler raises next."""
    link, peer = server.link()
    port = link.port
    assert link._end_connection(port, None)
    assert (port.fileno(), link.port) == (-1, None)
    peer.close()
    link.close()


def test_sending_on_a_websocket_that_just_ended_is_counted(websockets):
    from wsproto.events import CloseConnection

    with mavutil.mavlink_connection(websockets.device) as link:
        link.ws.send(CloseConnection(code=1000))
        link._established = lambda: True  # as it was a moment ago
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert link.frames_dropped == 1
