"""Writes down everything observable about reading logs through one package's mavutil, one line for
each message.

Runs in a process of its own, `python -m differential.transcript PACKAGE READER LOG...`, because
reading a log changes process-wide state (the current dialect module, MAVLINK20). The lines of both
packages are then compared.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TextIO
from zlib import crc32

from differential import mended, observe

STATE_EVERY = 500
STARTS_WITH_V2 = "MAVLINK20" in os.environ
INDEX = (
    "filesize", "name_to_id", "id_to_name", "data_len", "offset", "type_nums",
)  # fmt: skip
INSTANCES = ("instance_offsets", "instance_lengths")


def _all(log: Any) -> Iterator[Any]:
    return iter(log.recv_msg, None)


def _again_and_again(log: Any) -> Iterator[Any]:
    """Parts of the log after each other, with a rewind between them."""
    for how in (
        {},
        {"type": "ATTITUDE"},
        {"type": {"SYS_STATUS", "HEARTBEAT"}},
        {"type": ["GPS_RAW_INT", "BAD_DATA"], "condition": "GPS_RAW_INT.fix_type>=0"},
    ):
        for _ in range(60):
            msg = log.recv_match(**how)
            if msg is None:
                break
            yield msg
        log.rewind()
    log.flightmode_list()
    yield from _all(log)


def _matching(**how: Any) -> Callable[[Any], Iterator[Any]]:
    return lambda log: iter(lambda: log.recv_match(**how), None)


# Reader name -> (how to open, how to read)
READERS: dict[str, tuple[Callable[[Any, str], Any], Callable[[Any], Iterator[Any]]]] = {
    "mmap": (lambda mavutil, path: mavutil.mavlink_connection(path), _all),
    "stream": (lambda mavutil, path: mavutil.mavlogfile(path), _all),
    "raw": (lambda mavutil, path: mavutil.mavlink_connection(path, notimestamps=True), _all),
    "mmap-again": (lambda mavutil, path: mavutil.mavlink_connection(path), _again_and_again),
    "mmap-types": (
        lambda mavutil, path: mavutil.mavlink_connection(path),
        _matching(type=["ATTITUDE", "GLOBAL_POSITION_INT", "STATUSTEXT"]),
    ),
    "mmap-condition": (
        lambda mavutil, path: mavutil.mavlink_connection(path),
        _matching(condition="abs(ATTITUDE.roll)>=0 and ATTITUDE.time_boot_ms%2==0"),
    ),
    "stream-type": (
        lambda mavutil, path: mavutil.mavlogfile(path),
        _matching(type="VFR_HUD", condition="VFR_HUD.groundspeed>=0"),
    ),
}


def transcribe(package: str, reader: str, path: str, out: TextIO) -> None:
    """Write the transcript of one log. `PACKAGE+mended` is the package without its known faults."""
    package, _, is_mended = package.partition("+")
    mavutil = fresh_mavutil(package)
    opening, reading = READERS[reader]
    if is_mended:
        mended.mend(mavutil)
    log = observe.raised(lambda: opening(mavutil, path))
    if isinstance(log, str):
        print(log, file=out)
        return
    if is_mended:
        mended.forget_misnamed(log)
    print("opened", *state(log), file=out)
    print("index", *index(log), file=out)
    print("messages", sorted(log.messages), file=out)
    count = 0
    for count, msg in enumerate(reading(log), 1):
        print(line(msg, with_json=reader == "stream"), file=out)
        if count % STATE_EVERY == 0:
            print("state", *state(log), file=out)
    print("end", count, *state(log), file=out)
    for sysid in sorted(log.sysid_state):
        print("system", sysid, *system(log.sysid_state[sysid]), file=out)
    for key in sorted(log.param_state):
        print("params", key, sorted(log.param_state[key].params.items()), file=out)
    if hasattr(log, "flightmode_list"):
        print("modes", observe.raised(log.flightmode_list), file=out)
    log.close()


def fresh_mavutil(package: str) -> Any:
    """`mavutil` as in a new process: switching to MAVLink 2 is not undone by opening another log."""
    mavutil: Any = importlib.import_module(f"{package}.mavutil")
    if STARTS_WITH_V2:
        os.environ["MAVLINK20"] = "1"
    else:
        os.environ.pop("MAVLINK20", None)
    if hasattr(mavutil, "set_wire_protocol"):
        mavutil.set_wire_protocol(None)
    mavutil.set_dialect("all")
    return mavutil


def line(msg: Any, with_json: bool) -> str:
    """One message, where it came from and when."""
    parts: list[Any] = [
        repr(getattr(msg, "_timestamp", None)),
        getattr(msg, "_link", None),
        f"{msg.get_srcSystem()}/{msg.get_srcComponent()}",
        msg.get_seq(),
        msg.get_signed(),
        f"{crc32(msg.get_msgbuf()):08x}",
    ]
    if with_json:
        text = observe.json(msg)
        parts.append(f"{crc32(text.encode()):08x}")
    return " ".join(map(str, parts)) + f" {observe.text(msg)}"


def state(log: Any) -> tuple[Any, ...]:
    """What the link itself keeps."""
    return (
        log.mav_count,
        log.mav_loss,
        f"{log.packet_loss():.6f}",
        log.target_system,
        log.target_component,
        log.flightmode,
        repr(log.timestamp),
        repr(log.uptime),
        sorted(log.last_seq.items()),
        observe.parser(log.mav)[0][0],
    )


def index(log: Any) -> tuple[Any, ...]:
    """What an indexed log knows of its records.

    Where the instance of a type is, pymavlink does not know if the first record of the type is
    damaged. Then it also indexes a record that the end of the log cuts off before the instance.
    Both are left out for such types.
    """
    whole = [repr(getattr(log, name, None)) for name in INDEX]
    if not hasattr(log, "id_to_name"):
        return tuple(whole)
    assert log.counts == {msgid: len(found) for msgid, found in log.offsets.items()}
    assert log._count == sum(log.counts.values())
    heard = {msgid for msgid, name in log.id_to_name.items() if name in log.messages}
    for name in INSTANCES:
        whole.append(repr({k: v for k, v in getattr(log, name).items() if k in heard}))
    data = Path(log.filename).read_bytes()
    for msgid, found in log.offsets.items():
        whole.append(str((msgid, [at for at in found if msgid in heard or complete(data, at)])))
    return tuple(whole)


def complete(data: bytes, offset: int) -> bool:
    """Whether the record at `offset` of a log ends before the log does."""
    stx, length, flags = data[offset + 8 : offset + 11].ljust(3, b"\0")
    frame = 12 + length + 13 * (flags & 1) if stx == 0xFD else 8 + length
    return offset + 8 + frame <= len(data)


def system(kept: Any) -> tuple[Any, ...]:
    """What is kept of one system, with the last message of every type.

    When the first record of a type is damaged, pymavlink's index keeps the BAD_DATA under the name
    of that type; mavwire deliberately does not, so such entries are left out.
    """
    last = [
        (name, str(msg))
        for name, msg in sorted(kept.messages.items())
        if name != "MAV" and (name == "BAD_DATA" or msg.get_type() != "BAD_DATA")
    ]
    return (kept.flightmode, kept.vehicle_type, kept.mav_type, kept.mav_autopilot, kept.armed, last)


def main() -> int:
    package, reader, *paths = sys.argv[1:]
    for path in paths:
        print("file", path)
        transcribe(package, reader, path, sys.stdout)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
