"""The tools and pymavlink's scripts over real logs: the same lines and files.

MAVWIRE_LOGS names a directory of logs (the default is `logs` in a directory `shared` beside the
checkout); without one these tests are skipped.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from tool_runs import compare

ROOT = Path(__file__).parents[3]
LOGS = Path(os.environ.get("MAVWIRE_LOGS", ROOT.parent / "shared" / "logs"))
TLOGS = sorted(LOGS.glob("*.tlog"))
NOTICE = f"no logs in {LOGS}: set MAVWIRE_LOGS to a directory of .tlog files"
RUNS = (
    ("mavparms", "parms", ""),
    ("mavflightmodes", "flightmodes", ""),
    ("mavflighttime", "flighttime", ""),
    ("mavloss", "loss", "--stats"),
    ("mavsummarize", "summarize", ""),
    ("mavmission", "mission", ""),
    ("mavtogpx", "togpx", ""),
    ("mavsearch", "search", "--types HEARTBEAT,STATUSTEXT"),
    ("mavextract", "extract", "--mode rtl"),
    ("mavbitmask_change", "bitmask_change", "LOG SYS_STATUS.onboard_control_sensors_health"),
)


@pytest.mark.skipif(not TLOGS, reason=NOTICE)
@pytest.mark.parametrize(("script", "verb", "options"), RUNS)
@pytest.mark.parametrize("path", TLOGS, ids=lambda path: path.name)
def test_real_log(
    path: Path, script: str, verb: str, options: str, tmp_path: Path, oracle: str
) -> None:
    compare(script, verb, options, tmp_path, path)
