"""Invalid values, by the attribute `invalid` of the definitions: nulls, or kept."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mavwire
import pytest
from compat.tool_runs import Log
from mavwire import cli
from mavwire.bridge.inspector_tables import View
from mavwire.dialects.v20 import all as mavlink
from mavwire.fleet.decoding import decode
from mavwire.logs.conversion import convert
from mavwire.logs.formats import FORMATS, ONE_FILE
from mavwire.plots.expressions import parse
from mavwire.plots.series import NO_VALUE, read_series
from mavwire.plots.track import read_track

np = pytest.importorskip("numpy")

NAN = math.nan
DEFINITIONS = Path(__file__).parents[3] / "message_definitions" / "v1.0"
UNKNOWN = [65535] * 9


def messages(known: bool) -> list[Any]:
    """A message with each form of the attribute, with valid or invalid values."""
    covariance = [0.5] * 21
    return [
        mavlink.MAVLink_gps_raw_int_message(
            0, 3, 473977420, 85455940, 500000, *([100, 200, 300, 9000, 9] if known else [*UNKNOWN[:4], 255]),
            yaw=18000 if known else 0,
        ),
        mavlink.MAVLink_sys_status_message(
            1, 1, 1, 500, *([12600, 250, 80] if known else [65535, -1, -1]), 0, 0, 0, 0, 0, 0
        ),
        mavlink.MAVLink_battery_status_message(
            0, 0, 0, 2500 if known else 32767, [4100, 4000, *([3900] * 8 if known else UNKNOWN[:8])],
            -1, -1, -1, -1,
        ),
        mavlink.MAVLink_global_position_int_cov_message(
            1, 0, 1, 2, 3, 4, 1.0, 2.0, 3.0, [1.0] * 36 if known else [NAN, *[1.0] * 35]
        ),
        mavlink.MAVLink_autopilot_state_for_gimbal_device_message(
            1, 1, 1, [1, 0, 0, 0], 0, 0, 0, 0, 0, 0, 0, 2 if known else 0, 0.5 if known else 0
        ),
        mavlink.MAVLink_attitude_message(1500, 0, 0, 0, 0, 0, 0),
        mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 4, 3),
        mavlink.MAVLink_odometry_message(
            0, 0, 0, 1, 2, 3, [1, 0, 0, 0], 0, 0, 0, 0, 0, 0, covariance,
            covariance if known else [NAN, *covariance[1:]],
        ),
    ]  # fmt: skip


@pytest.fixture
def path(tmp_path: Path) -> Path:
    log = Log(tmp_path / "flight.tlog")
    for seconds, known in enumerate((True, False)):
        for one in messages(known):
            log.add(float(seconds), one)
    return log.done()


def columns(path: Path, **how: Any) -> dict[str, list[Any]]:
    tables = mavwire.read(path, **how)
    return {f"{name}.{one}": list(table[one]) for name, table in tables.items() for one in table}


def same(found: Any, wanted: Any) -> bool:
    return bool(np.array_equal(np.asarray(found, float), np.asarray(wanted, float), equal_nan=True))


SCALED = {
    "GPS_RAW_INT.eph": [1.0, NAN],
    "GPS_RAW_INT.cog": [90.0, NAN],
    "GPS_RAW_INT.satellites_visible": [9, NAN],
    "GPS_RAW_INT.yaw": [180.0, NAN],
    "GPS_RAW_INT.lat": [47.397742, 47.397742],
    "SYS_STATUS.voltage_battery": [12.6, NAN],
    "SYS_STATUS.current_battery": [2.5, NAN],
    "SYS_STATUS.battery_remaining": [80, NAN],
    "BATTERY_STATUS.temperature": [25.0, NAN],
    "BATTERY_STATUS.voltages": [[4.1, 4.0, *[3.9] * 8], [4.1, 4.0, *[NAN] * 8]],
    "GLOBAL_POSITION_INT_COV.covariance": [[1.0] * 36, [NAN] * 36],
    "ODOMETRY.pose_covariance": [[0.5] * 21, [0.5] * 21],
    "ODOMETRY.velocity_covariance": [[0.5] * 21, [NAN] * 21],
    "AUTOPILOT_STATE_FOR_GIMBAL_DEVICE.landed_state": [2, NAN],
    "AUTOPILOT_STATE_FOR_GIMBAL_DEVICE.angular_velocity_z": [0.5, NAN],
}


def test_units_in_si_have_no_values_that_stand_for_none(path: Path) -> None:
    found = columns(path, units="si")
    for name, wanted in SCALED.items():
        assert same(found[name], wanted), name


def test_they_are_kept_where_that_is_wanted_and_by_default(path: Path) -> None:
    assert same(
        columns(path, units="si", invalid="keep")["SYS_STATUS.voltage_battery"], [12.6, 65.535]
    )
    for how in ({}, {"invalid": "keep"}):
        found = columns(path, **how)
        assert found["SYS_STATUS.current_battery"] == [250, -1]
        assert found["SYS_STATUS.current_battery"][0].dtype == "int16"
        assert same(found["BATTERY_STATUS.voltages"][1], [4100, 4000, *UNKNOWN[:8]])
    found = columns(path, invalid="null")
    assert same(found["SYS_STATUS.current_battery"], [250, NAN])
    with pytest.raises(ValueError, match="invalid must be None, 'null' or 'keep', not 'drop'"):
        mavwire.read(path, invalid="drop")


def test_names_of_enums(path: Path) -> None:
    name = "AUTOPILOT_STATE_FOR_GIMBAL_DEVICE.landed_state"
    kept = ["MAV_LANDED_STATE_IN_AIR", "MAV_LANDED_STATE_UNDEFINED"]
    assert columns(path, enums="names")[name] == kept
    assert columns(path, enums="names", invalid="null")[name] == [kept[0], None]


def test_metadata_says_what_stands_for_none(path: Path) -> None:
    for how in ({}, {"units": "si"}, {"invalid": "null"}):
        tables = mavwire.read(path, **how)
        assert tables["SYS_STATUS"].metadata["voltage_battery"]["invalid"] == "UINT16_MAX"
        assert tables["BATTERY_STATUS"].metadata["voltages"]["invalid"] == "[UINT16_MAX]"
    scaled = mavwire.read(path, "ATTITUDE", units="si")["ATTITUDE"]
    assert scaled["time_boot_ms"][0] == 1.5
    assert scaled.metadata["time_boot_ms"] == {"field": "time_boot_ms", "unit": "s"}


def test_every_way_to_tables(path: Path) -> None:
    wanted = [12.6, NAN]
    field = "voltage_battery"
    how: Any = {"types": "SYS_STATUS", "units": "si"}
    with mavwire.open_log(path) as log:
        assert same(log.read(**how)["SYS_STATUS"][field], wanted)
        for method in ("ffill", "nearest", "linear"):
            wide = log.align("SYS_STATUS", on="HEARTBEAT", units="si", method=method)
            assert same(wide[f"SYS_STATUS.{field}"], wanted), method
        for invalid, line in ("null", [NAN, NAN]), (None, [NAN, NAN]), ("keep", [39067.5, 65535]):
            wide = log.align("SYS_STATUS", rate="500ms", invalid=invalid, method="linear")
            assert same(wide[f"SYS_STATUS.{field}"], [12600, *line]), invalid
        kept = log.align("SYS_STATUS", on="HEARTBEAT")[f"SYS_STATUS.{field}"]
        assert list(kept) == [12600, 65535]
    assert same([v for table in mavwire.scan(path, **how) for v in table[field]], wanted)
    assert same(decode(path, **how)["SYS_STATUS"][field], wanted)


def test_polars_and_pandas(path: Path) -> None:
    pl = pytest.importorskip("polars")
    frame = mavwire.scan_polars(path, "BATTERY_STATUS", units="si").collect()
    assert frame["temperature"].to_list() == [25.0, None]
    assert frame["voltages"].to_list()[1] == [4.1, 4.0, *[None] * 8]
    assert frame.filter(pl.col("temperature").is_null()).height == 1
    pytest.importorskip("pandas")
    table = mavwire.read(path, "SYS_STATUS", invalid="null")["SYS_STATUS"]
    assert table.to_pandas(nullable=True)["current_battery"].isna().tolist() == [False, True]


@pytest.mark.parametrize("format", FORMATS)
def test_files_leave_them_out(format: str, path: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    how: dict[str, Any] = {} if format in ONE_FILE else {"units": "si"}
    (row,) = convert([path], out, format=format, **how)
    assert row.error is None
    if format == "jsonl":
        lines = [json.loads(one) for one in (out / "SYS_STATUS/flight.jsonl").open()]
        assert [one.get("voltage_battery") for one in lines] == [12.6, None]
        lines = [json.loads(one) for one in (out / "BATTERY_STATUS/flight.jsonl").open()]
        assert lines[1]["voltages"] == [4.1, 4.0, *[None] * 8]
    elif format == "csv":
        lines = (out / "SYS_STATUS/flight.csv").read_text().splitlines()
        place = lines[0].split(",").index("voltage_battery")
        assert [line.split(",")[place] for line in lines[1:]] == ["12.6", ""]
    elif format in ONE_FILE:
        from unit.mcap_tools import messages  # which needs the reader

        found = messages(out / "flight.mcap", "/1/1/SYS_STATUS")["/1/1/SYS_STATUS"]
        assert [content.get("voltage_battery") for *_, content in found] == [12600, None]
    else:
        pl = pytest.importorskip("polars")
        read = pl.read_parquet if format == "parquet" else pl.read_ipc
        frame = read(out / f"BATTERY_STATUS/flight.{format}")
        assert frame["voltages"].to_list()[1] == [4.1, 4.0, *[None] * 8]
        assert frame["temperature"].to_list() == [25.0, None]


def test_the_command_converts_as_it_is_asked(path: Path, tmp_path: Path) -> None:
    for invalid, wanted in (("null", ""), ("keep", "65535")):
        out = tmp_path / invalid
        command = ["convert", str(path), "-o", str(out), "--format", "csv", "--invalid", invalid]
        assert cli.main([*command, "--quiet"]) == 0
        lines = (out / "SYS_STATUS/flight.csv").read_text().splitlines()
        place = lines[0].split(",").index("voltage_battery")
        assert lines[2].split(",")[place] == wanted


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("SYS_STATUS.voltage_battery/1000", [12.6]),
        ("max(SYS_STATUS.voltage_battery, 0)/1000", [12.6]),
        ("BATTERY_STATUS.voltages[0]", [4100, 4100]),
        ("BATTERY_STATUS.voltages[2]", [3900]),
        ("max(BATTERY_STATUS.voltages[2], 0)", [3900]),
        ("max(BATTERY_STATUS.voltages[0], 0)", [4100, 4100]),
        ("max(GPS_RAW_INT.lat, 0)", [473977420, 473977420]),
    ],
)
def test_plots_leave_them_out(text: str, values: list[float], path: Path) -> None:
    (series,) = read_series(str(path), [parse(text)]).series
    assert list(series.values) == values
    assert series.left_out == 2 - len(values)
    assert series.error == (NO_VALUE if series.left_out else None)


def test_conditions_and_other_axes_leave_them_out(path: Path) -> None:
    for condition in ("SYS_STATUS.voltage_battery>0", "SYS_STATUS.voltage_battery!=5"):
        (series,) = read_series(str(path), [parse("SYS_STATUS.load")], condition=condition).series
        assert len(series.values) == 1
    xaxis = parse("SYS_STATUS.voltage_battery/1000")
    (series,) = read_series(str(path), [parse("SYS_STATUS.load")], xaxis=xaxis).series
    assert (list(series.times), series.left_out) == ([12.6], 1)


def test_maps_leave_them_out(tmp_path: Path) -> None:
    standard = (DEFINITIONS / "standard.xml").read_text()
    latitude = '<field type="int32_t" name="lat" units="degE7"'
    (tmp_path / "standard.xml").write_text(standard.replace(latitude, f'{latitude} invalid="0"'))
    own = tmp_path / "own.xml"
    own.write_text((DEFINITIONS / "common.xml").read_text())
    log = Log(tmp_path / "track.tlog")
    for seconds, lat in enumerate((473977420, 0, 473977430)):
        position = mavlink.MAVLink_global_position_int_message(
            1500, lat, 85455940, 500000, 0, 0, 0, 0, 0
        )
        log.add(float(seconds), position)
    path = str(log.done())
    assert list(read_track(path).lat) == [47.397742, 0, 47.397743]
    assert list(read_track(path, dialect=own).lat) == [47.397742, 47.397743]


def test_the_inspector_says_that_there_is_no_value() -> None:
    mav = mavlink.MAVLink(None)
    bridge: Any = SimpleNamespace(
        _native_dialect=lambda: mav._dialect, dialect=mavlink, event_definitions=None
    )
    view = View(bridge)
    shown = []
    for known in (True, False):
        one = messages(known)[2]
        one.pack(mav)
        shown.append(dict(zip(one.fieldnames, view._fields(one), strict=True)))
    assert shown[0]["temperature"] == [2500, ""]
    assert shown[1]["temperature"] == ["no value", ""]
    assert shown[1]["voltages"] == [[4100, 4000, *["no value"] * 8], ""]
