"""Frames, ports and a link without a device, for the tests of the links."""

from __future__ import annotations

import os
import random
import shutil
import socket
import struct
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink

T0 = 1_600_000_000_000_000
KEY = bytes(range(32))
THREADS = 8


class Undecided:
    """What is neither true nor false."""

    def __bool__(self) -> bool:
        raise ValueError("undecided")

    def __repr__(self) -> str:
        return "Undecided()"


# Arguments that `setup_signing` refuses, each alone among good ones.
WRONG_SIGNING: list[dict[str, Any]] = [
    {"link_id": 300},
    {"link_id": -1},
    {"link_id": 1.5},
    {"link_id": "x"},
    {"initial_timestamp": -1},
    {"initial_timestamp": 1 << 48},
    {"initial_timestamp": float("nan")},
    {"initial_timestamp": "x"},
    {"secret_key": b"short"},
    {"secret_key": "a text of thirty-two characters."},
    {"secret_key": None},
    {"secret_key": dict.fromkeys(range(32), 1)},
    {"secret_key": frozenset(range(32))},
    {"sign_outgoing": Undecided()},
    {"max_ahead": -1},
    {"max_ahead": float("nan")},
    {"max_ahead": float("inf")},
    {"max_ahead": "x"},
    {"max_ahead": 60, "initial_timestamp": 0},
    {"allow_unsigned_callback": 5},
    {"timestamp_store": 5},
]


def signing_state(link: Any) -> tuple[Any, ...]:
    """What `setup_signing` sets: of `link`, and of all links."""
    signing = link.mav.signing
    return (
        signing.secret_key,
        signing.sign_outgoing,
        signing.link_id,
        signing.timestamp,
        signing.allow_unsigned_callback,
        mavutil.global_link_id,
    )


class Capture(mavutil.mavfile):
    """A link that receives what is put into `rx` and keeps what is sent in `tx`."""

    def __init__(self, **kw: Any) -> None:
        self.rx = bytearray()
        self.tx = bytearray()
        super().__init__(None, "capture", **kw)

    def recv(self, n: int | None = None) -> bytes:
        n = len(self.rx) if n is None else n
        data = bytes(self.rx[:n])
        del self.rx[:n]
        return data

    def write(self, buf: bytes) -> None:
        self.tx += buf


def heartbeat(seq: int = 0, sysid: int = 1, compid: int = 1, v1: bool = False) -> bytes:
    """A vehicle's HEARTBEAT as a frame."""
    msg = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    return pack(msg, seq, sysid, compid, v1)


def pack(msg: Any, seq: int = 0, sysid: int = 1, compid: int = 1, v1: bool = False) -> bytes:
    """`msg` as an unsigned frame."""
    mav = mavlink.MAVLink(None, srcSystem=sysid, srcComponent=compid)
    mav.seq = seq
    return bytes(msg.pack(mav, force_mavlink1=v1))


def signed(msg: Any, timestamp: int = 1, link_id: int = 3, seq: int = 0) -> bytes:
    """`msg` as a frame signed with KEY."""
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    mav.seq = seq
    mav.signing.secret_key = KEY
    mav.signing.sign_outgoing = True
    mav.signing.link_id = link_id
    mav.signing.timestamp = timestamp
    return bytes(msg.pack(mav))


def record(frame: bytes, microseconds: int = T0) -> bytes:
    """A telemetry log record."""
    return struct.pack(">Q", microseconds) + frame


def telemetry_log(messages: list[Any]) -> bytes:
    """Received messages as a log, a hundredth of a second apart."""
    return b"".join(
        record(bytes(msg.get_msgbuf()), T0 + index * 10_000) for index, msg in enumerate(messages)
    )


def drain(link: Any, **kw: Any) -> list[Any]:
    """Every message that is there now."""
    found = []
    while (msg := link.recv_match(**kw)) is not None:
        found.append(msg)
    return found


def drain_in_portions(link: Capture) -> None:
    """`Capture` takes bytes off the front of a buffer, which is slow with a long one."""
    received, link.rx = bytes(link.rx), bytearray()
    for start in range(0, len(received), 4096):
        link.rx += received[start : start + 4096]
        drain(link)


def types(messages: list[Any]) -> list[str]:
    return [msg.get_type() for msg in messages]


# Ports that no system hands out by itself, so that only tests compete for them: each process begins
# somewhere else, and uses none twice before all others.
PORTS = range(20_000, 32_000)
_next_port = random.Random(os.getpid()).randrange(len(PORTS))


def free_port(kind: int = socket.SOCK_STREAM) -> int:
    """A port of 127.0.0.1 that nobody uses; for an end that can say its own, port 0 is better."""
    global _next_port
    for _ in PORTS:
        _next_port = (_next_port + 1) % len(PORTS)
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", PORTS[_next_port]))
            except OSError:
                continue
            return PORTS[_next_port]
    raise OSError("no port is free")


def make_certificate(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A certificate for localhost with its key in one file, which clients trust. Skips without openssl."""
    if shutil.which("openssl") is None:
        pytest.skip("needs openssl to make a certificate")
    path, made = folder / "certificate.pem", folder / "made.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost",
         "-addext", "subjectAltName=DNS:localhost", "-keyout", path, "-out", made],
        check=True, capture_output=True,
    )  # fmt: skip
    path.write_bytes(path.read_bytes() + made.read_bytes())
    monkeypatch.setenv("SSL_CERT_FILE", str(path))
    return path


def at_once(work: Callable[[int], None], count: int = THREADS) -> None:
    """Run `work(0)` to `work(count - 1)` in threads that start together."""
    start = threading.Barrier(count)
    failures: list[BaseException] = []

    def run(number: int) -> None:
        start.wait()
        try:
            work(number)
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not failures
    assert not any(thread.is_alive() for thread in threads)
