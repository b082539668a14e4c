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
    assert rows("filter") == ["filter-mmap", "filter-stream", "bin-filter", "bin-filter-rare"]


def test_no_such_row() -> None:
    command = [sys.executable, str(BENCHES / "compare.py"), "--only", "nothing"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout) == (1, "")
    assert "--only nothing: no such row; there are\n  G1   stream-64k\n" in result.stderr


SYSTEMS_OF_A_MIX = """
import sys
sys.path.insert(0, sys.argv[1])
from bridge_worker import frames
print(*{frame[5] for frame in frames("mix")})
"""


def test_a_mix_is_of_a_vehicle_alone() -> None:
    """What a station sends the vehicle over the same link goes nowhere, and would be called lost."""
    command = [sys.executable, "-c", SYSTEMS_OF_A_MIX, str(BENCHES / "python")]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed.split() == ["1"]


LIVE_LINES = """
import sys
sys.path.insert(0, sys.argv[1])
from live import rate_lines
measured = {"kind": "udpin", "rate": 20000, "received": 1000, "lost": 0}
failed = {"kind": "udpin", "rate": 20000, "failed": "no answer"}
group = [
    {"package": "mavwire", "cpu": 0.004, **measured},
    {"package": "mavwire.aio", "received": 0, **measured, **failed},
    {"package": "pymavlink", "cpu": 0.018, **measured},
]
print(*rate_lines(group), *rate_lines(group[:1]), sep="\\n")
"""


def test_live_rows_say_how_many_times_theirs_is_ours() -> None:
    command = [sys.executable, "-c", LIVE_LINES, str(BENCHES)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert [line.split()[2:] for line in printed.splitlines()] == [
        ["mavwire", "1,000", "0", "4.00", "4.5", "x"],
        ["mavwire.aio", "no", "answer"],
        ["pymavlink", "1,000", "0", "18.00", "1.0", "x"],
        ["mavwire", "1,000", "0", "4.00"],
    ]


WRITE_TABLES = """
import pathlib, sys
sys.path.insert(0, sys.argv.pop(1))
import large_log
large_log.DOCUMENT = pathlib.Path(sys.argv.pop(1))
large_log.main()
"""


def test_the_tables_of_long_logs_are_written_into_the_document(tmp_path: Path) -> None:
    page = tmp_path / "benchmarks.md"
    page.write_text((BENCHES.parent / "docs" / "benchmarks.md").read_text())
    options = ["--bytes", "1e5", "--runs", "1", "--only-convert", "--document"]
    command = [sys.executable, "-c", WRITE_TABLES, str(BENCHES), str(page), *options]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    table = page.read_text().partition("<!-- conversions")[2].partition("<!-- /conversions -->")[0]
    assert "\nMedians of 1 processes.\n\n" in table
    assert table.count("MB .tlog |") == table.count("MB .BIN |") == 3
    assert printed.strip() in table
