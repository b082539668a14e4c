"""The HTTP servers of a bridge: by which names they answer, and what wears them out."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest
from mavwire import Bridge
from mavwire.bridge.metrics import MetricsServer
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
        assert status(port, "Accept: text/plain") == b"403"
