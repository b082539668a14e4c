"""Damaged logs, and logs on disks that fail."""

from __future__ import annotations

import importlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

from dataflash_writer import Log, fmt
from encoder import attitude, frame, heartbeat, record, signed

from hardening.tools import (
    KEY,
    T0,
    alarm,
    capture_of,
    drain,
    good,
    mavutil_of,
    silence,
    until,
)

LIMIT = 20.0  # seconds that a log of a few kilobytes may take
WHOLE_MESSAGES = 100  # that the whole logs have at least, of which the damaged ones are made


def tlog_records() -> list[bytes]:
    """What a ground station records, version 1 and 2, signed and not: 3 kB."""
    frames = []
    for n in range(20):
        frames += [
            heartbeat(n, v1=n % 5 == 0),
            frame(30, attitude(n, 0.1, -0.2, 3, 0, 0, 0.5), n),
            frame(253, bytes([6]) + b"a text of some length".ljust(50, b"\0"), n),
            signed(0, heartbeat()[10:-2], KEY, 1000 + n),
        ]
    return [record(one, T0 + 1000 * n) for n, one in enumerate(frames)]


def cuts(package: str, short: bool) -> dict[str, Any]:
    """A log that ends at any byte: exceptions of both readers, and records that do not come, or come too often."""
    mavutil = mavutil_of(package)
    records = tlog_records()
    data = b"".join(records)
    ends, at = [], 0
    for one in records:
        at += len(one)
        ends.append(at)
    found = {
        "exceptions, stream": 0,
        "exceptions, indexed": 0,
        "intact records lost, or too many": 0,
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cut.tlog"
        for size in range(1, len(data) + 1, 23 if short else 1):
            path.write_bytes(data[:size])
            whole = sum(end <= size for end in ends)
            for kind, options in (("stream", {"append": True}), ("indexed", {})):
                try:
                    with silence():
                        log = mavutil.mavlink_connection(str(path), **options)
                        found["intact records lost, or too many"] += abs(whole - good(drain(log)))
                        log.close()
                except Exception:
                    found[f"exceptions, {kind}"] += 1
    return {f"{name} ({'some' if short else 'all'} cuts)": n for name, n in found.items()}


def binary_log() -> bytes:
    log = Log().define("ATT", "QccC", "TimeUS,Roll,Pitch,Yaw", 5)
    log.define("GPS", "QBIHBcLLe", "TimeUS,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt", 6)
    log.define("PARM", "QNf", "TimeUS,Name,Value", 7).define("MSG", "QZ", "TimeUS,Message", 8)
    for n in range(25):
        time = 1_000_000 + n * 100_000
        log.add("ATT", time, n, -n, 100 * n).add("PARM", time, f"P{n}", n / 2)
        log.add("GPS", time, 3, 1000 * n, 2000, 9, 80, 470000000 + n, 80000000, 400)
        log.add("MSG", time, "ArduCopter V4.5")
    return bytes(log.data)


def text_log() -> bytes:
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 5, 17, ATT, QccC, TimeUS,Roll,Pitch,Yaw",
        "FMT, 7, 31, PARM, QNf, TimeUS,Name,Value",
    ]
    for n in range(60):
        lines += [f"ATT, {n * 1000}, {n}.5, {-n}, {n}", f"PARM, {n * 1000}, P{n}, {n}.25"]
    return "\n".join(lines).encode() + b"\n"


def mutations(data: bytes, count: int) -> Iterator[bytes]:
    """Bits flipped, bytes set, pieces lost and put in, the end cut off."""
    for seed in range(count):
        rand, copy = Random(seed), bytearray(data)
        for _ in range(rand.randrange(1, 12)):
            at = rand.randrange(len(copy))
            kind = rand.randrange(5)
            if kind == 0:
                copy[at] ^= 1 << rand.randrange(8)
            elif kind == 1:
                copy[at] = rand.choice((0, 0xFF, 0xA3, rand.randrange(256)))
            elif kind == 2:
                del copy[at : at + rand.randrange(1, 40)]
            elif kind == 3:
                copy[at:at] = rand.randbytes(rand.randrange(1, 30))
            elif len(copy) > 200:
                del copy[max(at, 200) :]
        yield bytes(copy)


def odd_lengths() -> Iterator[bytes]:
    """Record types that claim to be shorter than their own head, with a field and without one."""
    head = bytes(Log().define("ATT", "QccC", "TimeUS,Roll,Pitch,Yaw", 5).data)
    for length in range(4):
        for repeats in (1, 300):
            yield head + fmt(9, "ODD", "B", "X", length=length) + b"\xa3\x95\x09\x01" * repeats
        yield head + fmt(9, "ODD", "", "", length=length) + b"\xa3\x95\x09\x01"


def read_log(open_log: Callable[[str], Any], path: Path, limit: float) -> str:
    """What becomes of a log: `end`, `exception`, `hang` or `endless`."""
    size = path.stat().st_size
    try:
        with alarm(limit):
            log = open_log(str(path))
            for _ in range(size + 2):
                if log.recv_msg() is None:
                    return "end"
            return "endless"
    except TimeoutError:
        return "hang"
    except Exception:
        return "exception"


def mutated(package: str, short: bool) -> dict[str, Any]:
    """Damaged dataflash logs: what does not come to its end."""
    reader = importlib.import_module(f"{package}.DFReader")
    count, limit = (60, LIMIT / 10 if package == "pymavlink" else LIMIT) if short else (1500, LIMIT)
    binary, text = binary_log(), text_log()
    kinds = {
        "binary": (reader.DFReader_binary, binary, [*mutations(binary, count), *odd_lengths()]),
        "text": (reader.DFReader_text, text, [*mutations(text, count)]),
    }
    found: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder, silence():
        path = Path(folder) / "log.bin"
        for kind, (open_log, whole, logs) in kinds.items():
            path.write_bytes(whole)
            is_read = len(drain(open_log(str(path)))) >= WHOLE_MESSAGES
            ends = dict.fromkeys(("end", "exception", "hang", "endless"), 0)
            for data in logs:
                path.write_bytes(data)
                ends[read_log(open_log, path, limit)] += 1
            numbers = (ends["exception"], ends["hang"] + ends["endless"])
            rows = (f"{kind}, exceptions of {len(logs):,}", f"{kind}, hangs and logs without end")
            for row, number in zip(rows, numbers, strict=True):
                found[row] = number if is_read else "whole logs are not read either"
    return found


def full_disk(package: str, short: bool) -> dict[str, Any]:
    """Messages that are received of 500 while the log cannot be written."""
    link = capture_of(package)
    received = 0
    with silence():
        link.setup_logfile("/dev/full")
        for seq in range(500):
            link.rx += heartbeat(seq)
            try:
                received += len(drain(link))
            except Exception:
                break
    return {"received": received}


RECORDER = """
import sys, time
from hardening.tools import mavutil_of
link = mavutil_of(sys.argv[1]).mavlink_connection(sys.argv[2])
link.setup_logfile(sys.argv[3])
while True:
    if link.recv_match(type="HEARTBEAT", blocking=True, timeout=0.05) is not None:
        print(time.monotonic(), flush=True)
"""
KEPT_BACK = 1.0
"""Seconds that a link may keep a record to itself, by its documentation."""


def received_until_killed(
    package: str, path: Path, send: Callable[[socket.socket], None]
) -> list[float]:
    """When a process that records received each of the messages that are sent to it; then it is killed."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        command = [sys.executable, "-c", RECORDER, package, device, str(path)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
            peer, _ = server.accept()
            with peer:
                send(peer)
                child.send_signal(signal.SIGKILL)
                assert child.stdout
                return [float(line) for line in child.stdout if line.endswith("\n")]


def killed(package: str, short: bool) -> dict[str, Any]:
    """Records that are not in the log of a process that was killed: of 500, 3 s after the last one, and of those that
    were older than what the link may keep back when it received its last one, at a moment of chance.
    """

    def at_once(peer: socket.socket) -> None:
        peer.sendall(b"".join(heartbeat(seq) for seq in range(500)))
        time.sleep(3)

    def evenly(peer: socket.socket) -> None:
        end, seq = time.monotonic() + Random(time.time_ns()).uniform(2.5, 4.0), 0
        while time.monotonic() < end:
            peer.sendall(heartbeat(seq))
            seq += 1
            time.sleep(0.01)

    found: dict[str, Any] = {
        "of 500, 3 s after the last": 0,
        "at any moment, older than a second": 0,
    }
    with tempfile.TemporaryDirectory() as folder:
        for name, send in zip(found, (at_once, evenly), strict=True):
            path = Path(folder, f"{name}.tlog")
            times = received_until_killed(package, path, send)
            late = KEPT_BACK if send is evenly else 0.0
            due = sum(one <= times[-1] - late for one in times)
            came = len(times) == 500 if send is at_once else due > 0
            lost = max(due - path.stat().st_size // 29, 0)
            found[name] = lost if came else f"{len(times)} were received"
    return found


def secrets(package: str, short: bool) -> dict[str, Any]:
    """Whether a recorded log holds the key, or signatures."""
    key = bytes(range(100, 132))
    setup = frame(256, (0).to_bytes(8, "little") + b"\1\1" + key)
    stamped = signed(0, heartbeat()[10:-2], KEY, 1000)
    with tempfile.TemporaryDirectory() as folder, socket.create_server(("127.0.0.1", 0)) as server:
        path = Path(folder) / "flight.tlog"
        device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        link = mavutil_of(package).mavlink_connection(device)
        link.setup_logfile(str(path))
        peer, _ = server.accept()
        peer.sendall(setup + stamped)
        seen: list[Any] = []

        def both() -> bool:
            seen.extend(drain(link))
            return len(seen) >= 2

        came = until(both)
        link.logfile.close()
        log = path.read_bytes()
        link.close()
        peer.close()
    if not came or len(log) < 2 * 8 + len(setup) + len(stamped) - 13:
        return dict.fromkeys(("key", "signatures"), "not recorded")
    answers = {True: "yes", False: "no"}
    return {"key": answers[key in log], "signatures": answers[stamped[-13:] in log]}
