"""Real logs read through both packages in every way give the same transcript, message by message.

`real_logs` says where they are.
"""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import zip_longest
from pathlib import Path

import pytest
from real_logs import each_log

READERS = ("mmap", "stream", "mmap-types", "mmap-condition", "stream-type", "mmap-again")


def transcript(package: str, reader: str, *paths: Path, v2: bool = False) -> subprocess.Popen[str]:
    """Start reading logs in a process of its own, with none of the variables that pymavlink looks
    at, but MAVLINK20 if it is to start with MAVLink 2.
    """
    keep = {k: v for k, v in os.environ.items() if not k.startswith(("MAV", "MDEF"))}
    if v2:
        keep["MAVLINK20"] = "1"
    path = [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH")]
    keep["PYTHONPATH"] = os.pathsep.join(filter(None, path))
    command = [sys.executable, "-m", "differential.transcript", package, reader]
    return subprocess.Popen(
        [*command, *map(str, paths)],
        stdout=subprocess.PIPE,
        env=keep,
        text=True,
        encoding="utf-8",
        errors="backslashreplace",
    )


def compare(subject: str, oracle: str, reader: str, path: Path, v2: bool = False) -> int:
    """Compare two transcripts line by line; the number of lines.

    A damaged log may differ where docs/compatibility.md says so. It is then compared with
    the reference without the faults listed there, and has to be equal to that.
    """
    count, first = difference(subject, oracle, reader, path, v2)
    if first is not None and reader != "stream":
        count, first = difference(subject, f"{oracle}+mended", reader, path, v2)
    assert first is None, f"line {count} of {path.name} read with {reader}: {first}"
    return count


def difference(
    subject: str, oracle: str, reader: str, path: Path, v2: bool
) -> tuple[int, tuple[str, str] | None]:
    """Number of lines up to the first that differs, and that line of both."""
    count = 0
    with (
        transcript(subject, reader, path, v2=v2) as ours,
        transcript(oracle, reader, path, v2=v2) as theirs,
    ):
        assert ours.stdout and theirs.stdout
        for count, (our, their) in enumerate(zip_longest(ours.stdout, theirs.stdout), 1):
            if our != their:
                ours.kill()
                theirs.kill()
                return count, (our, their)
    assert (ours.returncode, theirs.returncode) == (0, 0)
    return count, None


@each_log("*.tlog")
@pytest.mark.parametrize("reader", READERS)
def test_telemetry_log(path: Path, reader: str, subject: str, oracle: str) -> None:
    # Half of the ways start with MAVLink 2.
    lines = compare(subject, oracle, reader, path, v2=READERS.index(reader) % 2 == 1)
    assert lines > 3
    print(f"{lines} lines")


@each_log("*.tlog.raw")
def test_raw_stream(path: Path, subject: str, oracle: str) -> None:
    assert compare(subject, oracle, "raw", path) > 100
