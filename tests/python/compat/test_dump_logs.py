"""`mavwire dump` and mavlogdump.py over real logs: the same lines.

MAVWIRE_LOGS names a directory of logs (the default is `logs` in a directory `shared` beside the
checkout); without one these tests are skipped.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from dump_logs import compare

ROOT = Path(__file__).parents[3]
LOGS = Path(os.environ.get("MAVWIRE_LOGS", ROOT.parent / "shared" / "logs"))
TLOGS = sorted(LOGS.glob("*.tlog"))
RAW = sorted(LOGS.glob("*.tlog.raw"))
NOTICE = f"no logs in {LOGS}: set MAVWIRE_LOGS to a directory of .tlog files"


@pytest.mark.skipif(not TLOGS, reason=NOTICE)
@pytest.mark.parametrize("path", TLOGS, ids=lambda path: path.name)
def test_telemetry_log(path: Path, oracle: str) -> None:
    lines = compare("--show-source", "--show-seq", str(path))
    assert compare("--format", "json", str(path)) == lines > 3
    compare("--types", "ATTITUDE,GPS*,STATUS*,HEART*", "--format", "json", str(path))
    assert compare("--format", "csv", "--types", "ATTITUDE,HEARTBEAT", str(path)) > 0


@pytest.mark.skipif(not RAW, reason=NOTICE)
@pytest.mark.parametrize("path", RAW, ids=lambda path: path.name)
def test_raw_stream(path: Path, oracle: str) -> None:
    assert compare("--no-timestamps", str(path)) > 100
