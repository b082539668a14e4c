"""pymavlog, a reader that stands on pymavlink's, finds in logs what it finds on pymavlink."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from dataflash_writer import sample
from integration.station_tools import command, needs, report
from unit.link_tools import telemetry_log
from unit.sim_tools import flying

READER = Path(__file__).with_name("pymavlog_reader.py")

pytestmark = needs("pymavlog", "pymavlink", "numpy")


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """A dataflash log, and a telemetry log of a flight."""
    folder = tmp_path_factory.mktemp("logs")
    dataflash, telemetry = folder / "flight.bin", folder / "flight.tlog"
    sample().write(dataflash)
    _, ground = flying("ardupilot")
    telemetry.write_bytes(telemetry_log(ground.messages))
    return [str(dataflash), str(telemetry)]


def test_the_same_as_on_pymavlink(logs: list[str]) -> None:
    def read(under: str) -> dict[str, Any]:
        found: dict[str, Any] = report(command(under, str(READER), *logs))
        return found

    theirs, ours = read("pymavlink"), read("mavwire")
    assert ours == theirs
    dataflash, telemetry = (ours[path] for path in logs)
    assert {"IMU", "GPS", "PARM"} <= set(dataflash["messages"])
    assert len(telemetry["messages"]["ATTITUDE"]["yaw"]) > 5
