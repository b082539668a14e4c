"""`make bench BENCH_FLAGS="--only ..."`: which rows that measures."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

BENCHES = Path(__file__).parents[3] / "benches"
CHOSEN = """
import sys
sys.path.insert(0, sys.argv[1])
from compare import DUMP_ROWS, ROWS, chosen
print(*(row.case for row in (*ROWS, *DUMP_ROWS) if chosen(row, sys.argv[2])))
"""


def rows(only: str) -> list[str]:
    command = [sys.executable, "-c", CHOSEN, str(BENCHES), only]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()


def test_rows_by_number_and_by_case() -> None:
    assert rows("G1") == ["stream-64k", "stream-280", "stream-1", "version1", "corrupt"]
    assert rows("g14") == ["dump-json", "dump-standard"]
    assert rows("filter") == ["filter-mmap", "filter-stream", "bin-filter"]


def test_no_such_row() -> None:
    command = [sys.executable, str(BENCHES / "compare.py"), "--only", "nothing"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout) == (1, "")
    assert "--only nothing: no such row; there are\n  G1   stream-64k\n" in result.stderr
