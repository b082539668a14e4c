"""Hostile and slow peers on links."""

from __future__ import annotations

import json
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from encoder import frame, heartbeat, signed

from hardening.tools import (
    KEY,
    capture_of,
    datagrams,
    dialect_of,
    drain,
    feed,
    good,
    mavutil_of,
    memory,
    parse,
    parser_of,
    silence,
    udp_server,
    until,
)

FTP_OPEN, FTP_ACK = 4, 128
LEAST_KEYS = 1000
"""Messages that must come through while tables fill: who takes none in keeps nothing."""
INTERRUPT = Path(__file__).parents[3] / "benches" / "python" / "interrupt_worker.py"


def names(first: int, count: int) -> Iterator[bytes]:
    for n in range(first, first + count):
        yield frame(251, struct.pack("<If10s", 1, 2.5, b"N%d" % n))


def unknown_ids(first: int, count: int) -> Iterator[bytes]:
    for n in range(first, first + count):
        yield frame(1_000_000 + n, b"\1\2\3", crc_extra=77)


def parameters(first: int, count: int) -> Iterator[bytes]:
    for n in range(first, first + count):
        yield frame(22, struct.pack("<fHH16sB", 1.5, 65535, 0, b"P%d" % n, 9))


def systems(first: int, count: int) -> Iterator[bytes]:
    """Heartbeats of all systems and components that there are, over and over."""
    for n in range(first, first + count):
        yield heartbeat(n, sysid=1 + n % 255, compid=1 + n // 255 % 255)


def streams(first: int, count: int) -> Iterator[bytes]:
    """Signed frames, each of a stream of its own."""
    payload = heartbeat()[10:-2]
    for n in range(first, first + count):
        sysid, compid, link_id = 1 + n % 255, 1 + n // 255 % 255, n // (255 * 255)
        yield signed(0, payload, KEY, 1000 + n, link_id, sysid=sysid, compid=compid)


def tables(package: str, short: bool) -> dict[str, Any]:
    """Bytes kept for each further key that a peer makes up, once the tables are full."""
    # A link lists each entry that its reader has not seen once more, so its tables are full after two rounds.
    # pymavlink's have no end: it need not be waited for.
    full, further = (140_000, 30_000) if package == "mavwire" else (2_000, 10_000)
    found: dict[str, Any] = {}
    for name, made in (
        ("names", names),
        ("unknown ids", unknown_ids),
        ("parameters", parameters),
        ("systems and components", systems),
        ("streams that are signed", streams),
    ):
        link = capture_of(package)
        if made is streams:
            link.setup_signing(KEY, initial_timestamp=0)
        link.rx += heartbeat()
        # Signing takes its time here. The streams come from systems, whose table has to be full, too.
        more = further // 10 if made is streams else further
        if feed(link, made(0, full)) < LEAST_KEYS:
            found[name] = "the messages do not come"
            continue
        before = memory()
        feed(link, made(full, more))
        found[name] = max(memory() - before, 0) // more
    return found | peers(package)


def peers(package: str) -> dict[str, Any]:
    """Bytes kept for each further address that a datagram comes from, whole messages or not."""
    link, address = udp_server(package)
    full, further = 300, 1000

    def speak(count: int) -> int:
        came = 0
        for n in range(count):
            with datagrams() as peer:
                peer.sendto(heartbeat(n)[: None if n % 2 else 9], address)
                until(lambda: link.select(0.1))
                came += good(drain(link))
        return came

    came = speak(full)
    before = memory()
    came += speak(further)
    grown = max(memory() - before, 0) // further
    link.close()
    # pymavlink has one parser for all, in which pieces end messages of others.
    return {"peers": grown if came >= further // 4 else "the messages do not come"}


def ftp_sessions(package: str, short: bool) -> dict[str, Any]:
    """Files that a simulated vehicle, which only mavwire has, lets a peer open that closes none."""
    if package != "mavwire":
        return {}
    from mavwire.sim import Vehicle

    vehicle, path, opened = Vehicle(seed=1), b"@PARAM/param.pck", 0
    for session in range(256):
        request = struct.pack("<HBBBBBBI", session, session, FTP_OPEN, len(path), 0, 0, 0, 0) + path
        payload = bytes([0, 1, 1]) + request.ljust(251, b"\0")
        answers = vehicle.step(0.02, frame(110, payload, session, sysid=255, crc_extra=84))
        opened += sum(
            msg.get_type() == "FILE_TRANSFER_PROTOCOL" and msg.payload[3] == FTP_ACK
            for msg in parse(parser_of(package), answers)
        )
    return {"open at once, of 256": opened}


def backlog(package: str, short: bool) -> dict[str, Any]:
    """Messages that wait in the parser, ten in each datagram and one taken for each datagram. The others wait
    in the receive buffer of the system, which has a bound: what comes of them, and is neither counted as
    dropped, is the second row.
    """
    count = 300 if short else 3000
    taken = 0
    link, address = udp_server(package)
    most = 0
    with datagrams() as peer:
        for n in range(count):
            peer.sendto(b"".join(heartbeat(10 * n + i) for i in range(10)), address)
            until(lambda: link.select(0.1))
            taken += link.recv_msg() is not None
            most = max(most, link.mav.buf_len() // len(heartbeat()))
    while (msg := link.recv_match(blocking=True, timeout=0.5)) is not None:
        taken += msg.get_type() == "HEARTBEAT"
    dropped = 10 * getattr(link, "datagrams_dropped", 0)
    link.close()
    return {
        f"of {10 * count:,}, waiting in memory": most,
        "neither read later nor counted as dropped": 10 * count - taken - dropped,
    }


def injection(package: str, short: bool) -> dict[str, Any]:
    """Frames kept of 500 in two pieces each, while another peer sends one to three bytes."""
    link, address = udp_server(package)
    kept = 0
    with datagrams() as victim, datagrams() as other:
        victim.sendto(heartbeat(), address)
        until(lambda: link.recv_msg() is not None)
        for n in range(500):
            for peer, data in (
                (victim, heartbeat(n)[:11]),
                (other, b"\xfd\xff\x01"[: 1 + n % 3]),
                (victim, heartbeat(n)[11:]),
            ):
                peer.sendto(data, address)
                until(lambda: link.select(0.1))
                kept += sum(msg.get_type() == "HEARTBEAT" for msg in drain(link))
    link.close()
    return {"kept": kept}


def reflection(package: str, short: bool) -> dict[str, Any]:
    """Whether a peer that sent one byte is sent our traffic."""
    link, address = udp_server(package)
    with datagrams() as peer:
        peer.sendto(b"x", address)
        until(lambda: link.select(0.1))
        drain(link)
        is_sent = _is_sent(link, peer, 0.5)
        # A whole message makes it a peer: else there was nothing to see.
        peer.sendto(heartbeat(), address)
        until(lambda: link.recv_msg() is not None)
        becomes_one = _is_sent(link, peer, 30)
        link.close()
    return {"it is": "yes" if is_sent else "no" if becomes_one else "nobody is sent anything"}


def _is_sent(link: Any, peer: socket.socket, seconds: float) -> bool:
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    peer.settimeout(seconds)
    try:
        return bool(peer.recv(300))
    except TimeoutError:
        return False


def tcp_server(package: str) -> tuple[Any, tuple[str, int]]:
    """A `tcpin:` link and its address."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        address = probe.getsockname()
    return mavutil_of(package).mavlink_connection(f"tcpin:127.0.0.1:{address[1]}"), address


def second_client(package: str, short: bool) -> dict[str, Any]:
    """Whether a server takes the next client after one left."""
    link, address = tcp_server(package)
    taken = []
    for seq in (1, 2):
        seen: list[Any] = []
        with socket.create_connection(address) as client, silence():
            client.sendall(heartbeat(seq))

            def look(seen: list[Any] = seen) -> bool:
                seen.extend(drain(link))
                return bool(seen)

            taken.append(until(look, 30 if package == "mavwire" else 3))
        with silence():
            until(lambda: link.recv_msg() is None and link.port is None, 0.5)
    link.close()
    return {"taken": "yes" if taken == [True, True] else "no"}


def end_of_stream(package: str, short: bool) -> dict[str, Any]:
    """Lines printed within two seconds after the other end hung up."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        link = mavutil_of(package).mavlink_connection(f"tcp:127.0.0.1:{port}")
        server.accept()[0].close()
        with silence() as lines:
            end = time.monotonic() + (0.5 if short else 2)
            while time.monotonic() < end:
                link.recv_match(blocking=True, timeout=0.1)
        link.close()
    return {"lines": lines[0]}


def slow_reader(package: str, short: bool) -> dict[str, Any]:
    """What becomes of frames that the other end does not read in time."""
    count = 60_000 if short else 200_000
    with socket.socket() as server:
        server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 16)
        server.bind(("127.0.0.1", 0))
        server.listen(1)
        port = server.getsockname()[1]
        link = mavutil_of(package).mavlink_connection(f"tcp:127.0.0.1:{port}")
        link.port.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 16)
        slow, _ = server.accept()
        failed = 0
        with silence():
            for n in range(count):
                try:
                    link.mav.statustext_send(6, b"%050d" % n)
                except Exception:
                    failed += 1
            received = bytearray()
            slow.settimeout(1)
            try:
                while True:
                    link.recv_msg()  # sends on what was queued
                    received += slow.recv(1 << 20)
            except TimeoutError:
                pass
        slow.close()
        link.close()
    parser = parser_of("mavwire")
    found = [msg.get_type() for msg in parser.parse_buffer(bytes(received)) or []]
    whole = found.count("STATUSTEXT")
    told = getattr(link, "frames_dropped", 0) + failed
    torn = len(found) - whole + (parser.buf_len() > 0)
    silently = count - whole - told if whole else "nothing came"
    return {f"lost silently of {count:,}": silently, "torn": torn}


def senders(package: str, short: bool) -> dict[str, Any]:
    """Four threads that send signed frames through one object."""
    each = 1000 if short else 3000
    sys.setswitchinterval(1e-5)
    frames: list[bytes] = []

    class Wire:
        def write(self, data: bytes) -> None:
            frames.append(bytes(data))

    mav = dialect_of(package).MAVLink(Wire(), 1, 1)
    mav.signing.secret_key = KEY
    mav.signing.sign_outgoing = True
    mav.signing.timestamp = 1000

    def send() -> None:
        for n in range(each):
            mav.heartbeat_send(2, 3, 81, n, 4)

    threads = [threading.Thread(target=send) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    rows = ("breaks of the sequence", "timestamps used twice")
    if len(frames) != len(threads) * each:
        return dict.fromkeys(rows, f"{len(frames)} were sent")
    numbers = [data[4] for data in frames]
    stamps = [data[-12:-6] for data in frames]
    breaks = sum((a + 1) % 256 != b for a, b in pairwise(numbers))
    return dict(zip(rows, (breaks, len(stamps) - len(set(stamps))), strict=True))


def interrupted(package: str, short: bool) -> dict[str, Any]:
    """Milliseconds that Ctrl-C takes to end a blocking receive, at worst."""
    found = {}
    every = (
        "udpin",
        "udpout",
        "mcast",
        "tcp",
        "reconnecting",
        "tcpin",
        "uds",
        "wsserver",
        "serial",
        "exec",
    )
    for kind in every[:1] if short else every:
        command = [sys.executable, str(INTERRUPT), package, kind]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
        # Behind what the links print.
        _, brace, answer = done.stdout.rpartition("{")
        seconds = json.loads(brace + answer)["seconds"] if brace else None
        found[f"{kind}, ms"] = "does not run" if seconds is None else round(1000 * seconds, 1)
    return found
