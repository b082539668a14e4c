"""Both packages on the two ends of every transport, signed and unsigned."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import select
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from integration.relays import null_modem, tls_server, unix_server
from mavwire import mavutil
from unit.link_tools import free_port, make_certificate

HERE = Path(__file__).parent
WAIT = 60.0
MAV_CMD_REQUEST_MESSAGE = 512
KEY = bytes(range(32))


pytestmark = pytest.mark.usefixtures("mavlink20")


@contextlib.contextmanager
def peer(
    package: str, device: str, signed: bool, meanwhile: Callable[[], object] = lambda: None
) -> Iterator[None]:
    """The other package on `device`, in a process of its own.

    `meanwhile` is called until that has connected: a WebSocket server has to shake hands.
    """
    environment = {**os.environ, "MAVLINK20": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, str(HERE / "echo_peer.py"), package, device, str(int(signed))]
    with subprocess.Popen(
        command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            while not select.select([process.stdout], [], [], 0.05)[0]:
                meanwhile()
            assert process.stdout.readline() == "ready\n"
            yield
        finally:
            process.kill()


@contextlib.contextmanager
def ends_of(kind: str, certificate: Path | None, folder: Path) -> Iterator[tuple[str, str]]:
    """The device strings of the end that listens and of the one that connects."""
    datagram = kind in ("udp", "udpbcast", "mcast")
    port = free_port(socket.SOCK_DGRAM if datagram else socket.SOCK_STREAM)
    if kind == "serial":
        with null_modem() as devices:
            yield devices
    elif kind == "uds":
        with unix_server(folder / "socket"):
            yield f"uds:{folder}/socket", f"unix:{folder}/socket"
    elif kind == "wss":
        assert certificate is not None
        with tls_server(certificate, port) as encrypted:
            yield f"wsserver:127.0.0.1:{port}", f"wss:localhost:{encrypted}"
    else:
        yield {
            "udp": (f"udpin:127.0.0.1:{port}", f"udpout:127.0.0.1:{port}"),
            "udpbcast": (f"udpin:127.0.0.1:{port}", f"udpbcast:127.0.0.1:{port}"),
            "tcp": (f"tcpin:127.0.0.1:{port}", f"tcp:127.0.0.1:{port}"),
            "ws": (f"wsserver:127.0.0.1:{port}", f"ws:127.0.0.1:{port}"),
            "mcast": (f"mcast:{port}", f"mcast:{port}"),
        }[kind]


def converse(link, signed: bool) -> None:
    """A heartbeat, a command, its ack: both directions work and are believed."""
    if signed:
        link.setup_signing(KEY)
    for number in range(3):
        while True:  # the first frames of a datagram or serial link may precede the peer
            link.mav.command_long_send(42, 1, MAV_CMD_REQUEST_MESSAGE, 0, number, 0, 0, 0, 0, 0, 0)
            ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=0.3)
            if ack is not None:
                break
        assert (ack.command, ack.get_srcSystem()) == (MAV_CMD_REQUEST_MESSAGE, 42)
        assert ack.get_signed() is signed
    heartbeat = link.recv_match(type="HEARTBEAT", blocking=True, timeout=WAIT)
    assert (heartbeat.get_srcSystem(), heartbeat.get_signed()) == (42, signed)
    assert (link.target_system, link.mav.total_receive_errors) == (42, 0)


@pytest.mark.parametrize("signed", [False, True], ids=["unsigned", "signed"])
@pytest.mark.parametrize("listens", [True, False], ids=["listening", "connecting"])
@pytest.mark.parametrize("kind", ["udp", "udpbcast", "tcp", "uds", "mcast", "ws", "wss", "serial"])
def test_a_conversation(
    kind: str, listens: bool, signed: bool, oracle: str,
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    needed = {"ws": "wsproto", "wss": "wsproto", "serial": "serial"}.get(kind)
    if needed is not None and importlib.util.find_spec(needed) is None:
        pytest.skip(f"{needed} is not installed: pip install -r requirements/test.txt")
    certificate = make_certificate(tmp_path, monkeypatch) if kind == "wss" else None
    with ends_of(kind, certificate, tmp_path) as (listening, connecting):
        if listens:
            with (
                mavutil.mavlink_connection(listening) as link,
                peer(oracle, connecting, signed, meanwhile=link.recv_msg),
            ):
                converse(link, signed)
        else:
            with peer(oracle, listening, signed), mavutil.mavlink_connection(connecting) as link:
                converse(link, signed)
