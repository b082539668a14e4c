"""The HTTP servers of a bridge: by which names they answer, and what wears them out."""

from __future__ import annotations

import errno
import socket
import socketserver
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from mavwire import Bridge
from mavwire.bridge import serving, slow_peer
from mavwire.bridge.metrics import MetricsServer
from mavwire.bridge.sinks import Sink
from unit.bridge_tools import LIMIT


@pytest.fixture
def bridge() -> Iterator[Bridge]:
    with Bridge() as running:
        yield running


def status(port: int, headers: str = "Host: localhost") -> bytes:
    """What a server answers, b"" for nothing."""
    with socket.create_connection(("127.0.0.1", port), LIMIT) as client:
        client.sendall(f"GET /metrics HTTP/1.1\r\n{headers}\r\n\r\n".encode())
        return client.makefile("rb").readline()[9:12]


def test_a_name_that_someone_has_lead_here_reads_nothing(
    monkeypatch: pytest.MonkeyPatch, bridge: Bridge
) -> None:
    """On no address: a page would ask as its visitor."""
    monkeypatch.setattr(socket, "gethostname", lambda: "Rover.lan")
    with MetricsServer(bridge, "0.0.0.0", 0, ["proxy.example"]) as server:
        port = server.port
        own = ["127.0.0.1", "192.168.1.5", "[fd00::2]", "localhost", "rover.lan", "ROVER.local"]
        for host in [*own, "rover", "proxy.example"]:
            for named in (host, f"{host}:{port}"):
                assert status(port, f"Host: {named}") == b"200"
                assert status(port, f"Host: {named}\r\nOrigin: http://{named}") == b"200"
        for host in ("evil.example", f"evil.example:{port}", "1.2.3.4.evil.example", ""):
            assert status(port, f"Host: {host}") == b"403"
            assert status(port, f"Host: {host}\r\nOrigin: http://{host}") == b"403"
        # Browsers always say both whom they ask and for whom.
        assert status(port, "Accept: text/plain") == b"200"
        assert status(port, "Origin: http://evil.example") == b"403"


def test_what_has_no_thread_keeps_no_place(monkeypatch: pytest.MonkeyPatch, bridge: Bridge) -> None:
    def no_thread(*_: object) -> None:
        raise RuntimeError("can't start new thread")

    with MetricsServer(bridge, "127.0.0.1", 0) as server:
        with monkeypatch.context() as patched:
            patched.setattr(socketserver.ThreadingMixIn, "process_request", no_thread)
            for _ in range(serving.MAX_CONNECTIONS):
                with socket.create_connection(("127.0.0.1", server.port), LIMIT) as client:
                    assert client.recv(1) == b""
        assert status(server.port) == b"200"


def test_a_server_that_gets_no_thread_leaves_its_port(
    monkeypatch: pytest.MonkeyPatch, bridge: Bridge
) -> None:
    def no_thread(*_: object) -> None:
        raise RuntimeError("can't start new thread")

    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with monkeypatch.context() as patched, pytest.raises(OSError, match="new thread") as failed:
        patched.setattr(threading.Thread, "start", no_thread)
        MetricsServer(bridge, "127.0.0.1", port)
    assert failed.value.errno == errno.EAGAIN
    with MetricsServer(bridge, "127.0.0.1", port):
        assert status(port) == b"200"


def test_a_sink_that_gets_no_thread_takes_no_frames(
    monkeypatch: pytest.MonkeyPatch, bridge: Bridge
) -> None:
    def no_thread(*_: object) -> None:
        raise RuntimeError("can't start new thread")

    publisher: Any = SimpleNamespace(close=lambda: closed.append(True))
    closed: list[bool] = []
    batches = bridge.frames()
    with monkeypatch.context() as patched, pytest.raises(OSError, match="new thread"):
        patched.setattr(threading.Thread, "start", no_thread)
        patched.setattr(bridge, "frames", lambda: batches)
        Sink(bridge, publisher, "mavlink", "nobody")
    assert closed == [True]
    assert batches.next(LIMIT) is None, "the bridge gathers no frames for it"


def test_a_server_without_descriptors_rests(
    monkeypatch: pytest.MonkeyPatch, bridge: Bridge
) -> None:
    with MetricsServer(bridge, "127.0.0.1", 0) as server:
        rests: list[float] = []
        for number in (errno.EMFILE, errno.ECONNABORTED):
            with monkeypatch.context() as patched, pytest.raises(OSError):
                patched.setattr(server.closing, "wait", rests.append)
                fail = OSError(number, "no")
                patched.setattr(socketserver.TCPServer, "get_request", raising(fail))
                server._server.get_request()
        assert len(rests) == 1
        assert status(server.port) == b"200"


def raising(error: Exception) -> Any:
    def fail(*_: object) -> None:
        raise error

    return fail


def test_who_takes_little_at_a_time_has_time_for_each_piece() -> None:
    class Slow:
        timeout = 0.0
        got = b""

        def settimeout(self, seconds: float) -> None:
            self.timeout = seconds

        def sendall(self, data: bytes) -> None:
            assert len(data) <= slow_peer.PIECE and self.timeout == slow_peer.PATIENCE
            self.got += data

    slow: Any = Slow()
    whole = bytes(range(256)) * 1000
    slow_peer.send_all(slow, whole)
    assert slow.got == whole
