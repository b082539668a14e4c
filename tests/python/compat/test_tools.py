"""The tools print what pymavlink's scripts print and write the same files, on generated logs."""

from __future__ import annotations

from pathlib import Path

import dataflash_writer
import pytest
from tool_runs import (
    Log,
    attitude,
    compare,
    damaged_log,
    flight_log,
    gps,
    heartbeat,
    random_log,
)

SENSORS = "SYS_STATUS.onboard_control_sensors_health"
# Subcommand -> script, and the options that it is run with.
CASES = {
    "parms": ("mavparms", ["", "--changes", "--qgc", "-c --qgc"]),
    "flightmodes": ("mavflightmodes", [""]),
    "flighttime": ("mavflighttime", ["", "--groundspeed 0.5", "--condition HEARTBEAT.type==2"]),
    "loss": ("mavloss", ["", "--stats", "--sysid 1 --stats", "--sysid 1 --compid 1",
                         "--sysid 99", "--condition HEARTBEAT.type==2", "--dialect common"]),
    "summarize": ("mavsummarize", ["", "--condition GPS_RAW_INT.fix_type==3"]),
    "mission": ("mavmission", ["", "--output other.txt"]),
    "togpx": ("mavtogpx", ["", "--nofixcheck", "--condition HEARTBEAT.custom_mode==5",
                           "LOG --type GPS_RAW_INT"]),
    "search": ("mavsearch", ["", "--types HEARTBEAT", "--types ATTITUDE,HEARTBEAT --stop",
                             "--condition HEARTBEAT.custom_mode==5",
                             "--condition HEARTBEAT.custom_mode==0 --types ATTITUDE",
                             "--condition HEARTBEAT.custom_mode==5 --stopcondition",
                             "--types NO_SUCH_TYPE"]),
    "extract": ("mavextract", ["", "--mode guided", "--mode STABILIZE", "--mode loiter --link 1",
                               "--mode stabilize --link 2", "--mode no_such_mode",
                               "--mode loiter --condition HEARTBEAT.base_mode!=89"]),
    "tomfile": ("mavtomfile", ["", "--types ATTITUDE,STATUSTEXT",
                               "--condition HEARTBEAT.custom_mode==0"]),
    "gpslock": ("mavgpslock", [""]),
    "sigloss": ("mavsigloss", ["--deltat 0.9", "--types HEARTBEAT --deltat 2"]),
    "bitmask_change": ("mavbitmask_change", [f"LOG {SENSORS}", f"LOG HEARTBEAT.base_mode {SENSORS}",
                                             "LOG HEARTBEAT.type EKF_STATUS_REPORT.flags"]),
    "sensor_status_change": ("mavsensor_status_change", [""]),
}  # fmt: skip


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("logs")
    return {
        "flight": flight_log(folder / "flight.tlog"),
        "random": random_log(folder / "random.tlog", 1),
        "other": random_log(folder / "other.tlog", 2),
        "damaged": damaged_log(folder / "damaged.tlog"),
    }


# mavtomfile.py fails on messages of unknown types.
DAMAGED = [verb for verb in CASES if verb not in ("tomfile", "bitmask_change", "mission")]


@pytest.mark.parametrize(
    ("verb", "options"), [(verb, one) for verb, (_, all_) in CASES.items() for one in all_]
)
def test_options(
    verb: str, options: str, logs: dict[str, Path], tmp_path: Path, oracle: str
) -> None:
    compare(CASES[verb][0], verb, options, tmp_path, logs["random"])


@pytest.mark.parametrize("verb", CASES)
def test_a_flight(verb: str, logs: dict[str, Path], tmp_path: Path, oracle: str) -> None:
    options = CASES[verb][1][-1 if verb in ("bitmask_change", "extract") else 0]
    compare(CASES[verb][0], verb, options, tmp_path, logs["flight"])


@pytest.mark.parametrize("verb", DAMAGED)
def test_a_damaged_log(verb: str, logs: dict[str, Path], tmp_path: Path, oracle: str) -> None:
    options = "--stats" if verb == "loss" else ""
    compare(CASES[verb][0], verb, options, tmp_path, logs["damaged"])


@pytest.mark.parametrize(
    ("verb", "options"),
    [
        ("parms", ""),
        ("parms", "--changes"),
        ("flightmodes", ""),
        ("flighttime", ""),
        ("loss", "--stats"),
        ("summarize", ""),
        ("mission", ""),
        ("togpx", ""),
        ("search", "--types HEARTBEAT --stop"),
        ("gpslock", ""),
    ],
)
def test_several_logs(
    verb: str, options: str, logs: dict[str, Path], tmp_path: Path, oracle: str
) -> None:
    lines = compare(
        CASES[verb][0], verb, options, tmp_path, logs["flight"], logs["other"], logs["random"]
    )
    assert len(lines) > 2


@pytest.mark.parametrize(
    "arguments",
    [
        "HEARTBEAT base_mode 81",
        f"{SENSORS.replace('.', ' ')} 12345",
        "heartbeat base_mode 1000",
        "EKF_STATUS_REPORT flags 0",
        "HEARTBEAT base_mode -- -1",
    ],
)
def test_bits(arguments: str, tmp_path: Path, oracle: str) -> None:
    compare("mavlink_bitmask_decoder", "bitmask_decoder", arguments, tmp_path)


@pytest.mark.parametrize(
    ("script", "verb", "options"),
    [
        ("mavlogdump", "dump", ""),
        ("mavlogdump", "dump", "--show-types"),
        ("mavlogdump", "dump", "--quiet"),
        ("mavlogdump", "dump", "--nottypes X --condition 'CSV.A>2'"),
        ("mavsearch", "search", "--condition 'CSV.A>2'"),
        ("mavsigloss", "sigloss", ""),
        ("mavparms", "parms", ""),
    ],
)
def test_csv_logs(script: str, verb: str, options: str, tmp_path: Path, oracle: str) -> None:
    path = tmp_path / "table.csv"
    path.write_text("T;A;B\n1000;1.5;foo\n2000;2.5;bar\n")
    compare(script, verb, f"{options} csv:LOG", tmp_path, path)


@pytest.mark.parametrize("options", ["", "-t", "--full-diff", "-t --hide-only1 --hide-only2"])
def test_parameter_files(options: str, tmp_path: Path, oracle: str) -> None:
    one, other = tmp_path / "one.parm", tmp_path / "other.parm"
    one.write_text("A 1\nB 2.5\nC 3\nMIS_TOTAL 5\nA_NAME_THAT_IS_LONG 3\nSAME 1\n")
    other.write_text("A 1.0\nB 2.6\nD,4\nMIS_TOTAL 6\nE=7\nF 0x10\n# c\nG 1 # x\nSAME\t1\n")
    lines = compare("mavparmdiff", "parmdiff", options, tmp_path, one, other)
    assert len(lines) > 5


def test_sizes_where_no_zeros_are_cut_off(tmp_path: Path, oracle: str) -> None:
    """mavmsgstats.py takes all messages of a type to be as long as the first one, so that only
    MAVLink 1 is counted alike.
    """
    log = Log(tmp_path / "version_1.tlog")
    for number in range(30):
        log.add(number, attitude(number), version_1=True)
        if number % 3 == 0:
            log.add(number + 0.2, heartbeat(), version_1=True)
    compare("mavmsgstats", "msgstats", "", tmp_path, log.done())


def test_a_log_with_positions_at_zero(tmp_path: Path, oracle: str) -> None:
    log = Log(tmp_path / "zero.tlog")
    for number, (lat, lon, fix) in enumerate(
        [(0, 2, 3), (0, 3, 3), (1, 0, 3), (3, 3, 3), (3, 4, 2), (3, 5, 4), (3, 6, 6), (3, 6, 1)]
    ):
        log.add(number, gps(number, lat, 5.0, fix, lon))
    path = log.done()
    for verb in ("flighttime", "summarize", "togpx", "gpslock"):
        (tmp_path / verb).mkdir()
        compare(CASES[verb][0], verb, "", tmp_path / verb, path)


def test_a_log_without_what_is_looked_for(tmp_path: Path, oracle: str) -> None:
    log = Log(tmp_path / "nothing.tlog")
    log.add(0, attitude(0))
    path = log.done()
    for verb in ("parms", "flightmodes", "flighttime", "summarize", "mission", "togpx", "loss"):
        (tmp_path / verb).mkdir()
        compare(CASES[verb][0], verb, "", tmp_path / verb, path)


@pytest.mark.parametrize("options", ["", "-s GPS --aoff 10.5 -e", "-o other.kml"])
def test_ways_as_kml(options: str, tmp_path: Path, oracle: str) -> None:
    pytest.importorskip("simplekml", reason="mavkml.py needs simplekml")
    log = dataflash_writer.Log()
    log.define("GPOS", "QLLf", "TimeUS,Lat,Lon,Alt")
    log.define("GPS", "QBIHLLf", "TimeUS,Status,GMS,GWk,Lat,Lon,Alt")
    log.define("STAT", "QB", "TimeUS,MainState")
    for number in range(60):
        if number % 12 == 11:
            log.add("STAT", number * 100_000, number // 12 * 3 % 10)
        place = 100_000_000 + number, -200_000_000 + number * number
        log.add("GPOS", number * 100_000, *place, 1.5 * number)
        log.add("GPS", number * 100_000, 3, number * 100, 2200, *place, 2.5 * number)
    compare("mavkml", "kml", options, tmp_path, Path(log.write(tmp_path / "way.bin")))


def test_a_log_without_a_way_as_kml(tmp_path: Path, oracle: str) -> None:
    pytest.importorskip("simplekml", reason="mavkml.py needs simplekml")
    log = Log(tmp_path / "flight.tlog")
    log.add(0, attitude(0))
    compare("mavkml", "kml", "", tmp_path, log.done())
