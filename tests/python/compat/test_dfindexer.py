"""The index of dataflash logs, on both packages: whole logs, cut ones, damaged ones."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from pathlib import Path

import dataflash_writer
import pytest
from mavwire import dfindexer

ARGUMENTS = (0x80, 89, 3, 4, 0xA3, 0x95)
PROGRAM = """
import json, sys
from pymavlink import dfindexer
assert dfindexer.available
for line in open(sys.argv[1]):
    told = []
    found = dfindexer.build_offsets(bytes.fromhex(line), *ARGUMENTS, told.append)
    print(json.dumps([found, told]))
""".replace("ARGUMENTS", f"({', '.join(map(str, ARGUMENTS))})")


def logs() -> list[bytes]:
    """A log, parts of it, and damaged copies."""
    log = bytes(dataflash_writer.sample().data)
    head, rest = log[:89], log[89:]
    made = [log, head + b"zz" + rest, b"xx" + log, head + b"\xa3" + rest, head + b"zzzzzz"]
    made += [log[:cut] for cut in (1, 2, 3, 88, 89, 90, 92, 93, 95, -1, -5)]
    made.append(head + b"\xa3\x95\x77" + bytes(40) + rest)
    described = dataflash_writer.fmt(9, "AA", "Q", "T")
    for length in (0, 1, 2, 3, 4, 250):
        wrong = described[:4] + bytes([length]) + described[5:]
        made.append(head + wrong + b"\xa3\x95\x09" + rest)
    source = random.Random(3)
    for _ in range(100):
        damaged = bytearray(log)
        for _ in range(source.randrange(4)):
            damaged[source.randrange(len(log))] = source.randrange(256)
        start = source.randrange(len(log))
        del damaged[start : start + source.choice((0, 0, 1, 30))]
        made.append(bytes(damaged))
    return made


def test_same_as_pymavlink(oracle: str, tmp_path: Path) -> None:
    path = tmp_path / "logs.txt"
    path.write_text("".join(f"{log.hex()}\n" for log in logs()))
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(path)], capture_output=True, text=True, check=True
    )
    theirs = [json.loads(line) for line in ran.stdout.splitlines()]
    assert len(theirs) == len(logs())
    for log, (found, told) in zip(logs(), theirs, strict=True):
        ours: list[int] = []
        assert dfindexer.build_offsets(log, *ARGUMENTS, ours.append) == found, log.hex()
        assert ours == told, log.hex()


def test_no_bytes_and_numbers_that_are_no_bytes() -> None:
    assert dfindexer.build_offsets(b"", *ARGUMENTS) == [[] for _ in range(256)]
    with pytest.raises(ValueError, match="fmt_type"):
        dfindexer.build_offsets(b"", 300, *ARGUMENTS[1:])
