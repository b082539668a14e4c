"""The tools and pymavlink's scripts over real logs: the same lines and files.

`real_logs` says where they are.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from real_logs import each_log
from tool_runs import compare

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
    ("mavgps_CEP", "gps_CEP", ""),
    ("mavsplit_sysid", "split_sysid", ""),
    ("mavbitmask_change", "bitmask_change", "LOG SYS_STATUS.onboard_control_sensors_health"),
)


@pytest.mark.parametrize(("script", "verb", "options"), RUNS)
@each_log("*.tlog")
def test_real_log(
    path: Path, script: str, verb: str, options: str, tmp_path: Path, oracle: str
) -> None:
    compare(script, verb, options, tmp_path, path)


# What gpslock, togpx and flightmodes do otherwise is in docs/pymavlink-tools.md.
DATAFLASH_RUNS = (
    ("mavparms", "parms", ""),
    ("mavflighttime", "flighttime", ""),
    ("mavmission", "mission", ""),
    ("mavsearch", "search", "--types MSG,MODE"),
    ("mavsigloss", "sigloss", "--deltat 0.3 --types ATT,GPS"),
)


@pytest.mark.parametrize(("script", "verb", "options"), DATAFLASH_RUNS)
@each_log("*.BIN", "*.log")
def test_real_dataflash_log(
    path: Path, script: str, verb: str, options: str, tmp_path: Path, oracle: str
) -> None:
    compare(script, verb, options, tmp_path, path)
