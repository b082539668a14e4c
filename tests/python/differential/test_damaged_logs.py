"""Damaged and cut logs through both packages: the same messages, times, counters and indexes.

The differences that are there on purpose are taken out of pymavlink by the `mended` module. The
logs are made here, and the heads of real ones are damaged too where there are any (see test_logs).
`MAVWIRE_DAMAGED` is how many damaged logs each way of reading compares.
"""

from __future__ import annotations

import os
import struct
import subprocess
from collections.abc import Iterator
from importlib import import_module
from itertools import cycle
from pathlib import Path
from random import Random

import pytest
from differential.damage import damaged
from differential.frames import FrameMaker, Framing, layouts
from differential.test_logs import transcript
from real_logs import logs

COUNT = int(os.environ.get("MAVWIRE_DAMAGED", "250"))
READERS = ("stream", "mmap", "mmap-again", "mmap-types", "mmap-condition", "raw")
EVERYDAY = (0, 1, 22, 24, 27, 30, 33, 35, 74, 76, 105, 147, 245, 251, 253)


def made_log(oracle: str, seed: int, version: int) -> bytes:
    """A log of everyday messages, with odd values, from several systems."""
    maker = FrameMaker(seed, Framing(version=version))
    dialect = import_module(f"{oracle}.dialects.v20.common")
    every = [one for one in layouts(dialect) if one.msgid in EVERYDAY]
    start = 1_600_000_000_000_000
    return b"".join(
        struct.pack(">Q", start + 100_003 * index) + frame
        for index, frame in enumerate(maker.frames(every, 60))
    )


def sources(oracle: str) -> Iterator[bytes]:
    made = [made_log(oracle, seed, version) for seed in (1, 2) for version in (1, 2)]
    made.append(made[0] + made[3])
    return cycle([*made, *(path.read_bytes() for path in logs("*.tlog"))])


@pytest.fixture(scope="module")
def damaged_logs(tmp_path_factory: pytest.TempPathFactory, oracle: str) -> list[Path]:
    folder = tmp_path_factory.mktemp("damaged")
    paths = []
    for seed, source in zip(range(COUNT), sources(oracle), strict=False):
        rand = Random(seed)
        paths.append(folder / f"damaged{seed:05}.tlog")
        data = damaged(source[: rand.choice((600, 2000, 6000))], rand)
        # An empty log is a difference of its own, tested with the links.
        paths[-1].write_bytes(data or b"\0")
    return paths


@pytest.fixture(scope="module")
def cut_logs(tmp_path_factory: pytest.TempPathFactory, oracle: str) -> list[Path]:
    """Short logs cut at every byte."""
    folder = tmp_path_factory.mktemp("cut")
    paths = []
    for version in (1, 2):
        data = made_log(oracle, 5, version)[:1000]
        for size in range(1, len(data) + 1):
            paths.append(folder / f"cut{version}_{size:05}.tlog")
            paths[-1].write_bytes(data[:size])
    return paths


def by_file(process: subprocess.Popen[str]) -> dict[str, list[str]]:
    """Lines of each log of a transcript of many."""
    text, _ = process.communicate(timeout=300)
    assert process.returncode == 0
    files: dict[str, list[str]] = {}
    for line in text.splitlines():
        if line.startswith("file "):
            lines = files[Path(line[5:]).name] = []
        else:
            lines.append(line)
    return files


def compare_all(subject: str, oracle: str, reader: str, paths: list[Path], v2: bool) -> int:
    """Compare the transcripts of many logs; the number of lines."""
    theirs = transcript(f"{oracle}+mended", reader, *paths, v2=v2)
    ours = by_file(transcript(subject, reader, *paths, v2=v2))
    lines = 0
    for name, expected in by_file(theirs).items():
        assert ours[name] == expected, f"{name} read with {reader}"
        lines += len(expected)
    assert len(ours) == len(paths)
    return lines


@pytest.mark.parametrize("v2", [False, True], ids=["v10", "v20"])
@pytest.mark.parametrize("reader", READERS)
def test_damaged_logs(
    damaged_logs: list[Path], subject: str, oracle: str, reader: str, v2: bool
) -> None:
    lines = compare_all(subject, oracle, reader, damaged_logs, v2)
    assert lines > 10 * len(damaged_logs)
    print(f"{len(damaged_logs)} logs, {lines} lines")


@pytest.mark.parametrize("reader", ["stream", "mmap", "mmap-again"])
def test_logs_cut_at_every_byte(
    cut_logs: list[Path], subject: str, oracle: str, reader: str
) -> None:
    assert compare_all(subject, oracle, reader, cut_logs, v2=True) > 10 * len(cut_logs)
