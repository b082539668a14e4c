"""`mavwire dump` and mavlogdump.py over real logs: the same lines.

`real_logs` says where they are.
"""

from __future__ import annotations

from pathlib import Path

from dump_logs import compare
from real_logs import each_log


@each_log("*.tlog")
def test_telemetry_log(path: Path, oracle: str) -> None:
    lines = compare("--show-source", "--show-seq", str(path))
    assert compare("--format", "json", str(path)) == lines > 3
    compare("--types", "ATTITUDE,GPS*,STATUS*,HEART*", "--format", "json", str(path))
    assert compare("--format", "csv", "--types", "ATTITUDE,HEARTBEAT", str(path)) > 0


@each_log("*.tlog.raw")
def test_raw_stream(path: Path, oracle: str) -> None:
    assert compare("--no-timestamps", str(path)) > 100
