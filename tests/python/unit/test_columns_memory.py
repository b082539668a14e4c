"""Logs are read and converted in bounded memory, on all processors, and opened without being read."""

from __future__ import annotations

import gzip
import json
import os
import random
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from runpy import run_path
from typing import Any

import mavwire
import pytest
from dataflash_writer import FMT, fmt, record
from mavwire.dialects.v20 import all as every
from mavwire.dialects.v20 import common
from mavwire.logs import memory
from mavwire.logs.formats import FORMATS

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")

EVERY_TYPE = Path(__file__).parents[3] / "benches" / "python" / "every_type_log.py"
MEGABYTES = 64
"""Of a log: more than any reader holds of it."""
LIMIT = 128 * 1024
"""kB that a process may take, the interpreter with it: less than the log and its tables."""
MANY_LIMIT = 192 * 1024
"""The same for a log of all types, four times as long."""
HOSTILE_LIMIT = 300 * 1024
"""The same whatever the log."""

THREADS = {"RAYON_NUM_THREADS": "2"}
"""Each has stores of its own in the allocator: the limits are those of two."""

REPORT = """
import json, os, pathlib
def taken():
    status = pathlib.Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0])
def read():
    return int(pathlib.Path("/proc/self/io").read_text().partition("rchar:")[2].split()[0])
def busy():
    tasks = pathlib.Path("/proc/self/task").iterdir()
    fields = ((one / "stat").read_text().rpartition(")")[2].split() for one in tasks)
    return sorted(int(field[11]) + int(field[12]) for field in fields)
"""


def run(code: str, *arguments: str | Path) -> Any:
    """What a program says as JSON."""
    command = [sys.executable, "-c", REPORT + code, *map(str, arguments)]
    env = os.environ | THREADS
    return json.loads(subprocess.run(command, check=True, capture_output=True, env=env).stdout)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of three types, whose times go on."""
    mav = common.MAVLink(None, 1, 1)
    messages = [
        common.MAVLink_attitude_message(1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
        common.MAVLink_vfr_hud_message(1.0, 2.0, 3, 4, 5.0, 6.0),
        common.MAVLink_statustext_message(6, b"a text of a vehicle"),
    ]
    frames = [message.pack(mav) for message in messages]
    path = tmp_path_factory.mktemp("large") / "large.tlog"
    with path.open("wb") as file:
        time = 1_700_000_000_000_000
        while file.tell() < MEGABYTES << 20:
            times = range(time, time + 10_000 * 3, 1)
            file.write(b"".join(t.to_bytes(8, "big") + frames[t % 3] for t in times))
            time = times.stop
    return path


@pytest.mark.parametrize("form", FORMATS)
def test_memory_of_a_conversion_is_bounded(log: Path, tmp_path: Path, form: str) -> None:
    code = """
import sys
from mavwire.logs.conversion import convert
done = convert([sys.argv[1]], sys.argv[2], format=sys.argv[3])
print(json.dumps(taken()))
"""
    assert run(code, log, tmp_path, form) < LIMIT


def test_memory_of_a_scan_is_bounded(log: Path) -> None:
    code = """
import sys, mavwire
rows = sum(len(table) for table in mavwire.scan(sys.argv[1]))
print(json.dumps([rows, taken()]))
"""
    rows, memory = run(code, log)
    assert rows > 1_000_000 and memory < LIMIT


def test_a_log_is_opened_without_being_read(log: Path) -> None:
    code = """
import sys, mavwire
before = read()
log = mavwire.open_log(sys.argv[1])
print(json.dumps(read() - before))
"""
    assert run(code, log) < (MEGABYTES << 20) / 10


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="needs two processors")
def test_a_log_is_read_on_all_processors(log: Path) -> None:
    code = """
import sys, mavwire
before = sum(busy())
for _ in range(4):
    mavwire.read(sys.argv[1])
*_, second, first = busy()
print(json.dumps([first - before, second]))
"""
    first, second = run(code, log)
    assert second > first / 4, f"one thread took {first} ticks, the next one {second}"


def wide_rows() -> bytes:
    """Records of three bytes in a table of hundreds of columns."""
    data = FMT
    for first in "abcdefghijklmno":
        columns = ",".join(first + second for second in "abcdefghijklmnop")
        data += fmt(2, "A", "aaa" + "c" * 13, columns)
    return data + fmt(2, "A", "", "") + b"\xa3\x95\x02" * 3_000_000


def wide_lines() -> bytes:
    """The same as text."""
    head = ["FMT,128,89,FMT,BBnNZ,Type,Length,Name,Format,Columns", "FMT,2,3,A,b,x"]
    for first in "abcdefghijklmn":
        columns = ",".join(f"{first}{second}" for second in range(126))
        head.append(f"FMT,2,3,A,{'c' * 126},{columns}")
    return "\n".join([*head, "FMT,2,3,A,b,x"]).encode() + b"\nA,1" * 2_000_000


def many_wide_types() -> bytes:
    """Records of three bytes of two hundred types, which are described five times each."""
    ids = [number if number < 128 else number + 1 for number in range(200)]
    data = FMT
    for type_id in ids:
        for first in "abcd":
            columns = ",".join(first + second for second in "abcdefghijklmno")
            data += fmt(type_id, f"T{type_id}", "c" * 15, columns)
        data += fmt(type_id, f"T{type_id}", "", "")
    return data + b"".join(b"\xa3\x95" + bytes([type_id]) for type_id in ids) * 15_000


def many_multipliers() -> bytes:
    """Records of three bytes of a type whose descriptions differ in their multipliers alone."""
    data = FMT + fmt(152, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds")
    data += fmt(151, "MULT", "Qbd", "TimeUS,Id,Mult")
    for number, factor in enumerate("abcdefghijklmno", start=1):
        data += record(151, "Qbd", 1, ord(factor), 2.0 + number)
        data += fmt(number, "A", "h" * 15, ",".join("abcdefghijklmno"))
        data += record(152, "QBNN", 1, number, "-" * 15, factor * 15)
    return data + fmt(40, "A", "", "") + b"\xa3\x95\x28" * 2_000_000


def many_names() -> bytes:
    """Descriptions of types, each with a long name of its own."""
    fmt = b"FMT,1,4,N%d" + b"n" * 30_000 + b",b,x\n"
    return b"FMT,128,89,FMT,BBnNZ,Type,Length,Name,Format,Columns\n" + b"".join(
        fmt % number for number in range(8_000)
    )


def short_frames() -> bytes:
    """Frames of a byte of payload of which rows have 251."""
    mav = common.MAVLink(None, 1, 1)
    return common.MAVLink_file_transfer_protocol_message(1, 0, 0, [0] * 251).pack(mav) * 1_000_000


@pytest.mark.parametrize("units", [None, "si"])
@pytest.mark.parametrize(
    "make", [wide_rows, many_wide_types, wide_lines, many_multipliers, many_names, short_frames]
)
def test_memory_does_not_grow_with_what_a_hostile_log_describes(
    tmp_path: Path, make: Callable[[], bytes], units: str | None
) -> None:
    path = tmp_path / "log.gz"
    path.write_bytes(gzip.compress(make(), 1))
    code = """
import sys, mavwire
from mavwire.logs.conversion import convert
units = json.loads(sys.argv[3])
rows = sum(len(table) for table in mavwire.scan(sys.argv[1], units=units))
found = mavwire.open_log(sys.argv[1]).info().messages
(row,) = convert([sys.argv[1]], sys.argv[2], units=units)
print(json.dumps([rows, found, row.rows, taken()]))
"""
    *counts, memory = run(code, path, tmp_path / "out", json.dumps(units))
    assert len(set(counts)) == 1
    assert memory < HOSTILE_LIMIT


def test_memory_does_not_grow_with_the_names_of_bit_masks(tmp_path: Path) -> None:
    mav = common.MAVLink(None, 1, 1)
    chance = random.Random(3)
    frames = []
    for _ in range(200_000):
        masks = [chance.getrandbits(31) for _ in range(3)]
        message = common.MAVLink_sys_status_message(*masks, *range(10))
        frames.append(message.pack(mav))
    path = tmp_path / "masks.raw"
    path.write_bytes(b"".join(frames))
    code = """
import sys, mavwire
from mavwire.logs.conversion import convert
rows = sum(len(table) for table in mavwire.scan(sys.argv[1], enums="names"))
(row,) = convert([sys.argv[1]], sys.argv[2], enums="names")
print(json.dumps([rows, row.rows, taken()]))
"""
    *counts, memory = run(code, path, tmp_path / "out")
    assert counts == [200_000, 200_000]
    assert memory < HOSTILE_LIMIT


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_memory_of_compressed_texts_of_many_types(
    many_types: Path, tmp_path: Path, form: str
) -> None:
    code = """
import sys
from mavwire.logs.conversion import convert
convert([sys.argv[1]], sys.argv[2], format=sys.argv[3], compression="zstd")
print(json.dumps(taken()))
"""
    assert run(code, many_types, tmp_path, form) < HOSTILE_LIMIT


@pytest.fixture(scope="module")
def many_types(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The benches' log of every type there is."""
    path = tmp_path_factory.mktemp("many") / "many.tlog"
    run_path(str(EVERY_TYPE))["write"](path, 4 * MEGABYTES << 20)
    return path


def test_memory_does_not_grow_with_the_types(many_types: Path, tmp_path: Path) -> None:
    code = """
import sys
from mavwire.logs.conversion import convert
(row,) = convert([sys.argv[1]], sys.argv[2])
print(json.dumps([len(row.files), row.bad_bytes, taken()]))
"""
    files, bad, memory = run(code, many_types, tmp_path)
    assert (files, bad) == (len(every.mavlink_map) - 1, 0)  # the log has no STATUSTEXT
    assert memory < MANY_LIMIT


def test_tables_that_will_not_fit_are_told(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    needed, free = MEGABYTES << 20, memory.available()
    assert free is not None and free > 0
    monkeypatch.setattr(memory, "available", lambda: needed >> 1)
    with pytest.warns(UserWarning, match=r"take about 0\.1 GiB, and 0\.0 GiB .*: ask for less"):
        mavwire.read(log)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mavwire.read(log, "HEARTBEAT")
        mavwire.read(log, fields="type", types=None)
        monkeypatch.setattr(memory, "available", lambda: needed << 1)
        mavwire.read(log)
