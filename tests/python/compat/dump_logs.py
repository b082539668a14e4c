"""Logs to dump, and both commands that dump them: mavlogdump.py and `mavwire dump`."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from itertools import zip_longest
from pathlib import Path
from random import Random

import pytest
from mavwire import traffic
from mavwire.dialects.v20 import ardupilotmega as mavlink

# The installed script, beside the interpreter that pymavlink is installed for.
MAVLOGDUMP = Path(sys.executable).parent / "mavlogdump.py"
NOTICE = "mavlogdump.py is not installed: pip install -r requirements/test.txt"
ODD_FLOATS = (float("nan"), float("inf"), -float("inf"), -0.0, 1e-9, 1e20)


def environment() -> dict[str, str]:
    """None of the variables that change what pymavlink reads; the same clock for both."""
    keep = {k: v for k, v in os.environ.items() if not k.startswith(("MAV", "MDEF"))}
    return keep | {"TZ": "America/St_Johns", "PYTHONIOENCODING": "utf-8"}


def run(command: list[str], *options: str) -> tuple[list[str], int]:
    """Lines on standard output, and the exit code."""
    result = subprocess.run(
        [sys.executable, *command, *options],
        capture_output=True, check=False, env=environment(), timeout=250,
    )  # fmt: skip
    return result.stdout.decode().split("\n"), result.returncode


def oracle_dump(*options: str) -> tuple[list[str], int]:
    """What mavlogdump.py does; the test is skipped where it is not installed."""
    if not MAVLOGDUMP.exists():
        pytest.skip(NOTICE)
    return run([str(MAVLOGDUMP)], *options)


def mavwire_dump(*options: str) -> tuple[list[str], int]:
    """What `mavwire dump` does, in a process of its own."""
    return run(["-m", "mavwire", "dump"], *options)


def compare(*options: str) -> int:
    """Both commands print the same lines and end alike; the number of lines."""
    theirs, their_code = oracle_dump(*options)
    assert their_code == 0, options
    for way in (["dump"], ["run", str(MAVLOGDUMP)]):
        ours, our_code = run(["-m", "mavwire", *way], *options)
        for number, (our, their) in enumerate(zip_longest(ours, theirs), 1):
            assert our == their, f"line {number} of {way} {options}"
        assert our_code == 0, (way, options)
    return len(theirs) - 1


def odd_messages() -> list[mavlink.MAVLink_message]:
    """Texts that are no ASCII, numbers at their limits, arrays, instances, mode changes."""
    return [
        mavlink.MAVLink_statustext_message(6, b'caf\xc3\xa9 \xff "quoted\\", tab\t and\nnewline'),
        mavlink.MAVLink_attitude_message(2**32 - 1, *ODD_FLOATS),
        mavlink.MAVLink_timesync_message(-(2**63), 2**63 - 1),
        mavlink.MAVLink_battery_status_message(3, 0, 0, -5, [1] * 10, 0, 0, 0, 50),
        mavlink.MAVLink_param_value_message(b"SIXTEEN_LETTERS_", 1.5, 9, 1, 0),
        mavlink.MAVLink_data96_message(1, 2, list(range(96))),
        mavlink.MAVLink_named_value_float_message(7, b"a name", 0.1),
        mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7),
        mavlink.MAVLink_gps_raw_int_message(2**64 - 1, 3, -1, 2, 3, 4, 5, 6, 7, 8),
        mavlink.MAVLink_heartbeat_message(2, 3, 209, 5, 4, 3),
    ]


def odd_frames(seed: int) -> list[bytes]:
    """`odd_messages` from a second vehicle, the radio and an unknown sender, in MAVLink 2 and 1."""
    frames = []
    for sysid, compid, version_1 in ((7, 100, False), (51, 68, True), (0, 0, False)):
        mav = mavlink.MAVLink(None, srcSystem=sysid, srcComponent=compid)
        mav.seq = seed
        frames += [message.pack(mav, version_1) for message in odd_messages()]
    return frames


def clean_log(path: Path) -> Path:
    """Traffic of two vehicles with losses, over four links, with odd messages in between."""
    random = Random(5)
    options = traffic.Options(messages=1200, systems=2, loss=0.02)
    odd = odd_frames(250)
    with path.open("wb") as file:
        for number, (micros, frame, _) in enumerate(traffic.records(options)):
            link = random.randrange(4)
            file.write(struct.pack(">Q", micros | link) + frame)
            if number % 40 == 39 and odd:
                file.write(struct.pack(">Q", micros + 4 | link) + odd.pop(0))
    return path


def damaged_log(path: Path) -> Path:
    """Flipped bits, unknown messages, garbage between the records, and a cut end."""
    random = Random(6)
    options = traffic.Options(messages=1200, corruption=0.03)
    with path.open("wb") as file:
        for number, (micros, frame, _) in enumerate(traffic.records(options)):
            file.write(struct.pack(">Q", micros) + frame)
            if number % 150 == 100:
                file.write(struct.pack(">Q", micros) + _unknown(number))
            if number % 200 == 120:
                file.write(struct.pack(">Q", micros) + random.randbytes(9).replace(b"\xfe", b"x"))
        file.truncate(file.tell() - 7)
    return path


def _unknown(number: int) -> bytes:
    return bytes([0xFD, 3, 0, 0, number & 255, 9, 9, 0x11, 0x99, 1 + (number & 3), 1, 2, 3, 4, 5])
