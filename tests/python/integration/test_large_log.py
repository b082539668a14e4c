"""`benches/large_log.py`, with small logs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).parents[3] / "benches" / "large_log.py"


def test_every_message_of_each_log_is_read() -> None:
    command = [sys.executable, str(SCRIPT), "--bytes", "2e5", "--runs", "1"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert run.returncode == 0, run.stderr
    reading, converting = (table(text) for text in run.stdout.split("\n\n")[:2])
    assert len(reading) == 3 and len(converting) == 6
    messages = [int(row[1].replace(",", "")) for row in reading]
    assert messages[0] < messages[1] < messages[2]
    assert 2e5 / 60 < messages[2] < 2e5 / 30


def test_logs_of_every_type_are_converted_to_any_format() -> None:
    command = [sys.executable, str(SCRIPT), "--bytes", "4e5", "--runs", "1", "--only-convert"]
    command += ["--every-type", "--format", "csv"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert run.returncode == 0, run.stderr
    messages = [int(row[1].replace(",", "")) for row in table(run.stdout.strip())]
    assert 1000 < messages[0] <= messages[1] < messages[2]


def table(text: str) -> list[list[str]]:
    """The rows below the head, which all have as many cells as it."""
    head, _, *rows = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()
    ]
    assert [len(row) for row in rows] == [len(head)] * len(rows)
    return rows
