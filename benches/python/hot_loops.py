"""The loops of a user's program, one at a time, for counting instructions: CASE and the number of
messages.

Run by tools/instruction_budget.py under callgrind. The input is made before the loop and its cost
is the same for every message, so only the slope between two lengths counts; input that is cheap to
make keeps that slope clean.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

KEY = bytes(32)
BLOCK = 500  # frames that are made once and then repeated


def block(mavlink: Any, signed: bool = False, instances: bool = False) -> list[bytes]:
    """Frames of a fixed mix of telemetry; with `instances` one in five is of a type that has instances."""
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    if signed:
        mav.signing.secret_key, mav.signing.sign_outgoing = KEY, True
    kinds = [
        mavlink.MAVLink_attitude_message(1000, 0.1, -0.2, 1.5, 0.01, 0.02, 0.03),
        mavlink.MAVLink_global_position_int_message(
            1000, 473_977_418, 85_455_939, 500_000, 12_000, 3, -4, 5, 9000
        ),
        mavlink.MAVLink_vfr_hud_message(12.5, 13.5, 90, 45, 500.5, 0.1),
        mavlink.MAVLink_sys_status_message(1, 1, 1, 300, 16_000, 1800, 80, 0, 0, 0, 0, 0, 0),
        mavlink.MAVLink_statustext_message(6, b"Leg finished, turning"),
    ]
    if instances:
        kinds[-1] = mavlink.MAVLink_servo_output_raw_message(1000, 0, *range(1500, 1508))
    frames = []
    for number in range(BLOCK):
        frames.append(bytes(kinds[number % len(kinds)].pack(mav)))
        mav.seq = (mav.seq + 1) % 256
    return frames


def repeated(frames: list[bytes], messages: int) -> list[bytes]:
    """Streams of one block each."""
    return [b"".join(frames)] * (messages // BLOCK)


def receive(mav: Any, pieces: list[bytes], use: Callable[[Any], Any] | None = None) -> None:
    """Parse, and use every message."""
    for piece in pieces:
        for msg in mav.parse_buffer(piece):
            if use is not None:
                use(msg)


def all_fields(msg: Any) -> None:
    """Read every field."""
    for name in msg.get_fieldnames():
        getattr(msg, name)


def noise(mavlink: Any, count: int) -> None:
    """A strict parser goes over noise a byte at a time: the cost of one, however many follow it."""
    mav = mavlink.MAVLink(None)
    data = bytes(count)
    while mav.buf_len() or data:
        try:
            mav.parse_char(data)
        except mavlink.MAVError:
            pass
        data = b""


def log(mavlink: Any, messages: int, instances: bool = False, **how: Any) -> None:
    """Read a telemetry log."""
    from mavwire import mavutil

    records = b"".join(bytes(8) + frame for frame in block(mavlink, instances=instances)) * (
        messages // BLOCK
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flight.tlog"
        path.write_bytes(records)
        opened = mavutil.mavlink_connection(str(path), dialect="ardupilotmega")
        while opened.recv_match(**how) is not None:
            pass
        opened.close()


def flight(mavlink: Any, messages: int) -> bytes:
    """A telemetry log whose values change."""
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    records = []
    for number in range(BLOCK):
        one = number / BLOCK
        kinds = [
            mavlink.MAVLink_attitude_message(20 * number, one, -one, 2 * one, one, one, 0.03),
            mavlink.MAVLink_global_position_int_message(
                20 * number, 473_977_418 + number, 85_455_939, 500_000, 12_000, 3, -4, 5, number
            ),
            mavlink.MAVLink_servo_output_raw_message(20 * number, 0, *range(number, number + 8)),
            mavlink.MAVLink_statustext_message(6, b"Leg finished, turning"),
        ]
        stamp = 1_700_000_000_000_000 + 20_000 * number
        records.append(stamp.to_bytes(8, "big") + kinds[number % len(kinds)].pack(mav))
        mav.seq = (mav.seq + 1) % 256
    return b"".join(records) * (messages // BLOCK)


def tables(case: str, mavlink: Any, messages: int) -> None:
    """A telemetry or dataflash log into tables, or on into Parquet."""
    import dataflash_log
    import mavwire
    from mavwire.logs.conversion import convert

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flight.log"
        if case == "columns-bin":
            dataflash_log.write(path, BLOCK)
            content, head = path.read_bytes(), dataflash_log.HEAD_LEN
            path.write_bytes(content[:head] + content[head:] * (messages // BLOCK))
        else:
            path.write_bytes(flight(mavlink, messages))
        if case == "parquet":
            convert([path], Path(folder) / "out", dialect=mavlink)
        else:
            mavwire.read(path, dialect=mavlink)


class Sink:
    """A transport that drops everything."""

    def write(self, data: bytes) -> None:
        """Take the bytes."""


def run(case: str, messages: int) -> None:
    """One loop."""
    mavlink = importlib.import_module("mavwire.dialects.v20.ardupilotmega")

    mav = mavlink.MAVLink(Sink(), srcSystem=1, srcComponent=1)
    if case in ("parse", "fields"):
        receive(mav, repeated(block(mavlink), messages), all_fields if case == "fields" else None)
    elif case == "verify":
        for piece in repeated(block(mavlink, signed=True), messages):
            receiver = mavlink.MAVLink(None)  # one that has not seen these timestamps
            receiver.signing.secret_key = KEY
            receive(receiver, [piece])
    elif case == "noise":
        noise(mavlink, messages)
    elif case in ("recv_match", "instances"):
        log(mavlink, messages, instances=case == "instances")
    elif case == "filter":
        log(mavlink, messages, type=["VFR_HUD"])
    elif case in ("columns", "columns-bin", "parquet"):
        tables(case, mavlink, messages)
    elif case == "pack":
        message = mavlink.MAVLink_attitude_message(1000, 0.1, -0.2, 1.5, 0.01, 0.02, 0.03)
        for _ in range(messages):
            message.pack(mav)
    elif case == "send":
        for number in range(messages):
            mav.attitude_send(number, 0.1, -0.2, 1.5, 0.01, 0.02, 0.03)
    else:
        raise SystemExit(f"there is no case {case}")


if __name__ == "__main__":
    run(sys.argv[1], int(sys.argv[2]))
