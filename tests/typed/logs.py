"""Logs: telemetry, dataflash, CSV, as messages and as tables."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, assert_type

import mavwire
from mavwire import mavutil
from mavwire.CSVReader import CSVReader
from mavwire.DFReader import DFMessage, DFReader_binary
from mavwire.dialects.v20 import ardupilotmega as mavlink


def altitudes(path: str) -> Iterator[tuple[float, float]]:
    """Time and altitude out of a telemetry log, in the manner of pymavlink."""
    log = mavutil.mavlink_connection(path, dialect="ardupilotmega")
    while (msg := log.recv_match(type="VFR_HUD")) is not None:
        if isinstance(msg, mavlink.MAVLink_vfr_hud_message):
            yield log.timestamp, msg.alt
    log.rewind()


def indexed(path: str) -> dict[int, int]:
    """The index of a telemetry log."""
    log = mavutil.mavmmaplog(path, resync="rescan")
    assert_type(log.percent, float)
    assert_type(log.flightmode_list(), list[tuple[str, float, float]])
    assert_type(log.offsets, dict[int, list[int]])
    return log.counts


def dataflash(path: str) -> list[str]:
    """A dataflash log: columns are Any, all else is known."""
    types: list[str] = []
    with DFReader_binary(path, zero_time_base=True) as log:
        while (msg := log.recv_match(type=["IMU", "GPS"])) is not None:
            assert_type(msg, DFMessage)
            assert_type(msg.get_type(), str)
            assert_type(msg.to_dict(), dict[str, Any])
            types.append(msg.get_type())
        assert_type(log.flightmode_list(), list[tuple[str, float, float]])
        assert_type(log.params, dict[str, float])
    return types


def csv(path: str) -> int:
    """Rows of a CSV file."""
    rows = CSVReader(path, separator=";")
    return rows.name_to_id("CSV")


def tables(path: str) -> None:
    """The same logs as tables."""
    with mavwire.open_log(path) as log:
        table = log["ATTITUDE"]
        print(len(table), table.to_pandas())
    chosen = mavwire.read(path, "ATTITUDE", fields=["roll"], start="2024-01-31", units="si")
    mavwire.read(path, unit="si")  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    print(chosen["ATTITUDE"])
