"""The HTTP servers of a bridge: by which names they answer, and what wears them out."""

from __future__ import annotations

import errno
import json
import socket
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: pip install 'mavwire[web]'")

from mavwire import Bridge
from mavwire.bridge import web_server
from mavwire.bridge.metrics import MetricsServer, prometheus
from mavwire.bridge.sinks import CLOSE_TIME, Sink
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import LIMIT, UDP, wait_until
from unit.link_tools import heartbeat


@pytest.fixture
def bridge() -> Iterator[Bridge]:
    with Bridge() as running:
        yield running


def status(port: int, headers: str = "Host: localhost", version: str = "1.1") -> bytes:
    """What a server answers, b"" for nothing."""
    with socket.create_connection(("127.0.0.1", port), LIMIT) as client:
        client.sendall(f"GET /metrics HTTP/{version}\r\n{headers}\r\n\r\n".encode())
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
        # HTTP/1.1 has to say whom it asks; HTTP/1.0 does not, and no browser speaks it.
        assert status(port, "Accept: text/plain", "1.0") == b"200"
        assert status(port, "Origin: http://evil.example", "1.0") == b"403"


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


def test_connections_are_bounded_and_idle_ones_end(
    monkeypatch: pytest.MonkeyPatch, bridge: Bridge
) -> None:
    monkeypatch.setattr(web_server, "MAX_CONNECTIONS", 4)
    with ExitStack() as stack:
        server = stack.enter_context(MetricsServer(bridge, "127.0.0.1", 0))
        where = ("127.0.0.1", server.port)
        for _ in range(4):
            stack.enter_context(socket.create_connection(where, LIMIT))
        wait_until("all", lambda: len(server.connections) == 4)
        with socket.create_connection(where, LIMIT) as other:
            assert other.recv(1) == b""
        monkeypatch.setattr(web_server, "MAX_CONNECTIONS", 64)
        monkeypatch.setattr(web_server, "REQUEST_TIME", 0.1)
        with socket.create_connection(where, LIMIT) as idle:
            assert idle.recv(1) == b""
        assert status(server.port) == b"200"


def test_an_answer_says_nothing_of_the_library(bridge: Bridge) -> None:
    with MetricsServer(bridge, "127.0.0.1", 0) as server:
        for request in (b"GET /stats HTTP/1.1\r\nHost: evil\r\n\r\n", b"nonsense\r\n\r\n"):
            with socket.create_connection(("127.0.0.1", server.port), LIMIT) as client:
                client.sendall(request)
                answer = b"".join(iter(lambda: client.recv(65536), b""))
            assert b"Server: mavwire\r\n" in answer and b"aiohttp" not in answer


def test_one_socket_serves_both_versions_of_ip(bridge: Bridge) -> None:
    if not socket.has_dualstack_ipv6():
        pytest.skip("no IPv6 here")
    with MetricsServer(bridge, "::", 0) as server:
        assert status(server.port) == b"200"
        with socket.create_connection(("::1", server.port), LIMIT) as client:
            client.sendall(b"GET /stats HTTP/1.1\r\nHost: [::1]\r\n\r\n")
            assert client.recv(15) == b"HTTP/1.1 200 OK"


@pytest.mark.parametrize("is_busy", [False, True])
def test_closing_takes_no_longer_than_promised(bridge: Bridge, is_busy: bool) -> None:
    with ExitStack() as stack:
        server = stack.enter_context(MetricsServer(bridge, "127.0.0.1", 0))
        for _ in range(8):
            client = socket.create_connection(("127.0.0.1", server.port), LIMIT)
            stack.enter_context(client)
            client.sendall(b"GET /" if is_busy else b"")
        wait_until("all", lambda: len(server.connections) == 8)
        begun = time.monotonic()
        server.close()
        assert time.monotonic() - begun < CLOSE_TIME


def test_counters_over_http() -> None:
    with Bridge([UDP]) as bridge, MetricsServer(bridge, "127.0.0.1", 0) as server:
        bridge.send(heartbeat(sysid=7))
        wait_until("it", lambda: bridge.stats()["components"])

        def fetch(path: str) -> str:
            url = f"http://127.0.0.1:{server.port}{path}"
            with urllib.request.urlopen(url, timeout=LIMIT) as answer:
                return str(answer.read().decode())

        assert json.loads(fetch("/stats"))["components"][0]["system"] == 7
        text = fetch("/metrics")
        assert 'mavwire_bridge_component_frames_total{system="7",component="1"} 1' in text
        assert 'mavwire_bridge_link_received_total{link="program",peer=""} 1' in text
        with pytest.raises(urllib.error.HTTPError, match="404"):
            fetch("/etc/passwd")
        url = f"http://127.0.0.1:{server.port}/stats"
        for name, value in (("Host", "evil.example"), ("Origin", "http://evil.example")):
            foreign = urllib.request.Request(url, headers={name: value})
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(foreign, timeout=LIMIT)
        with socket.create_connection(("127.0.0.1", server.port), LIMIT) as hostile:
            hostile.sendall(b"\x00\xff" * 1000 + b"\r\n\r\n")
        bridge.stop()
        with pytest.raises(urllib.error.HTTPError, match="503"):
            fetch("/metrics")


def mavlink_of_no_dialect() -> bytes:
    """A frame of id 50000 with CRC_EXTRA 77."""
    body = bytes([1, 0, 0, 0, 1, 1, *(50_000).to_bytes(3, "little"), 5])
    return b"\xfd" + body + mavlink.x25crc(body + bytes([77])).crc.to_bytes(2, "little")


def test_the_text_of_metrics_is_well_formed() -> None:
    with Bridge() as bridge:
        bridge.add(UDP, name='a "quoted"\nname\\')
        bridge.send(mavlink_of_no_dialect())
        wait_until("its frame", lambda: bridge.stats()["links"][-1]["received"])
        text = prometheus(bridge.stats())
    unknown = 'link_unknown_total{link="program",peer="",id="50000",crc_extra="77"} 1'
    assert f"mavwire_bridge_{unknown}" in text.splitlines()
    assert '{link="a \\"quoted\\"\\nname\\\\",peer=""} 0' in text
    names = [line.split()[2] for line in text.splitlines() if line.startswith("# TYPE")]
    assert len(names) == len(set(names)) > 20
    for line in text.splitlines():
        assert line.startswith("#") or any(line.startswith(name) for name in names)
        assert line.startswith("#") or float(line.rpartition(" ")[2]) >= 0
