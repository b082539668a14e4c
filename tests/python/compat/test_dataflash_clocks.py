"""Times of dataflash logs of all ages, on both packages: which records tell when a log began, and in
which order. The tables say the same as the messages.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import mavwire
import pytest
from dataflash_writer import Log
from mavwire import DFReader

PROGRAM = """
import json, sys
from pymavlink import DFReader
for path in sys.argv[1:]:
    kind = DFReader.DFReader_text if path.endswith(".log") else DFReader.DFReader_binary
    log = kind(path)
    print(json.dumps([[m.get_type(), m._timestamp] for m in iter(log.recv_msg, None)]))
"""

MICROS, OLD, PX4, RATES = "TimeUS,GMS,GWk", "Status,TimeMS,Week,T", "GPSTime,Fix", "TimeMS,Week"
FORMATS = {MICROS: "QIH", OLD: "BIHI", PX4: "QB", RATES: "IH", "StartTime": "Q"}
FORMATS |= {"TimeUS,X": "QB", "TimeMS,X": "IB", "X": "B", "X,TimeUS": "BQ", "X,TimeMS": "BI"}
FORMATS |= {"TimeMS,TimeUS": "IQ", "GWk,GMS,TimeUS": "HIQ", "TimeUS,GWk,GMS,T": "QHIf"}

US, MS, TIME = {"ATT": "TimeUS,X"}, {"ATT": "TimeMS,X"}, {"TIME": "StartTime", "ATT": "X"}
BOTH = {"GPS": MICROS, "GPS2": MICROS, **US}
UNIX = 1_400_000_000_000_000

Records = list[tuple[Any, ...]]
CASES: dict[str, tuple[dict[str, str], Records]] = {
    "the second receiver tells first": (
        BOTH,
        [("ATT", 1000, 1), ("GPS2", 4_000_000, 99_000, 1801), ("GPS", 5_000_000, 100_000, 1800)],
    ),
    "the second receiver tells, the first never": (
        BOTH,
        [("GPS2", 3_000_000, 1000, 1801), ("GPS", 3_100_000, 0, 0), ("ATT", 4_000_000, 1)],
    ),
    "the first receiver has no records": (
        BOTH,
        [("ATT", 1000, 1), ("GPS2", 4_000_000, 99_000, 1801), ("ATT", 5_000_000, 1)],
    ),
    "the first receiver has old records": (
        {"GPS": OLD, "GPS2": MICROS, **US},
        [("GPS2", 2000, 1000, 1801), ("GPS", 3, 3000, 1800, 1000), ("ATT", 4000, 1)],
    ),
    "the second receiver of an old log": (
        {"GPS": OLD, "GPS2": OLD, **MS},
        [("GPS2", 3, 100_000, 1800, 5000), ("ATT", 5100, 1), ("GPS", 3, 102_000, 1800, 6000)],
    ),
    "T is 0": (
        {"GPS": OLD, **MS},
        [("ATT", 1000, 1), ("GPS", 3, 100_000, 1800, 0), ("GPS", 3, 107_000, 1800, 5000)],
    ),
    "TimeUS is 0": ({"GPS": MICROS, **US}, [("ATT", 1000, 1), ("GPS", 0, 1000, 1800)]),
    "week 0, then a time of another type": (
        {"GPS": OLD, "X": "X", **MS},
        [("X", 1), ("GPS", 3, 1, 0, 3000), ("ATT", 4000, 1), ("GPS", 3, 107_000, 1800, 5000)],
    ),
    "week 0, then the time": (
        {"GPS": OLD, "X": "X", **MS},
        [("X", 1), ("GPS", 3, 1, 0, 3000), ("GPS", 3, 107_000, 1800, 5000), ("ATT", 6000, 1)],
    ),
    "TimeUS behind another column": (
        {"GPS": MICROS, "ATT": "X,TimeUS", "B": "TimeUS,X"},
        [("B", 1000, 1), ("ATT", 1, 2000), ("GPS", 5_000_000, 1000, 1800), ("ATT", 1, 5_500_000)],
    ),
    "TimeUS of GPS behind other columns": (
        {"GPS": "GWk,GMS,TimeUS", **US},
        [("ATT", 1000, 1), ("GPS", 1800, 1000, 5_000_000), ("ATT", 5_500_000, 1)],
    ),
    "TimeMS behind another column": (
        {"GPS": OLD, "ATT": "X,TimeMS", "B": "TimeMS,X"},
        [("B", 1000, 1), ("ATT", 1, 2000), ("GPS", 3, 100_000, 1800, 3000), ("ATT", 1, 5500)],
    ),
    "both times": (
        {"GPS": MICROS, "ATT": "TimeMS,TimeUS", "B": "TimeUS,X"},
        [("B", 1000, 1), ("ATT", 7, 2000), ("GPS", 3_000_000, 3000, 1800), ("ATT", 5500, 1)],
    ),
    "a column that nobody asks is no number": (
        {"GPS": "TimeUS,GWk,GMS,T", **US},
        [("ATT", 1000, 1), ("GPS", 5_000_000, 1800, 100_000, float("nan")), ("ATT", 5_100_000, 1)],
    ),
    "TIME of 0": (
        {"GPS": PX4, **TIME},
        [("TIME", 0), ("ATT", 1), ("GPS", UNIX, 3), ("TIME", 5_000_000), ("ATT", 1)],
    ),
    "no receiver": (
        {"ATT": "X,TimeUS", "B": "TimeUS,X"},
        [("ATT", 1, 1000), ("B", 3000, 1), ("ATT", 1, 4000)],
    ),
}  # fmt: skip
RATED: dict[str, Records] = {
    "GPS times that are equal": [(1000, 1800), (1000, 1800)],
    "GPS times that fall": [(1000, 1800), (900, 1800)],
    "GPS times that fall and come back": [(1000, 1800), (900, 1800), (1000, 1800)],
    "a week of 0 between": [(1000, 1800), (900, 0), (1000, 1800)],
    "GPS times of different weeks": [(1000, 1800), (1000, 7)],
}
for name, fixes in RATED.items():
    records: Records = [("ATT", 1, 1), ("ATT", 2, 1)]
    for fix in fixes:
        records += [("GPS", *fix), ("ATT", 1, 1), ("ATT", 2, 1)]
    CASES[name] = ({"GPS": RATES, **US}, records)

DESCRIBED = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
OF_TEXT = f"{DESCRIBED}FMT, 2, 30, ATT, QB, TimeUS,X\nATT, 1000, 1\n"
AFTER = "ATT, 5100000, 1\nGPS, 6000000, 1801, 100000, 1\n"
TEXTS = {
    f"{value!r} in a column that nobody asks": f"{OF_TEXT}FMT, 1, 30, GPS, QHI{kind}, "
    f"TimeUS,GWk,GMS,X\nGPS, 5000000, 1800, 100000, {value}\n{AFTER}"
    for value, kind in (("1.5", "I"), ("a", "I"), ("", "I"), ("nan", "I"), ("a", "f"), ("1", "f"))
}
TEXTS["spaces around a week"] = (
    f"{OF_TEXT}FMT, 1, 30, GPS, QHII, TimeUS,GWk,GMS,X\nGPS, 5000000,  1800 , 100000, 1\n{AFTER}"
)


def write(folder: Path) -> dict[str, Path]:
    """All logs, by the names of the cases."""
    paths = {}
    for number, (case, (types, records)) in enumerate(CASES.items()):
        log = Log()
        for kind, columns in types.items():
            log.define(kind, FORMATS[columns], columns)
        for record in records:
            log.add(*record)
        paths[case] = Path(log.write(folder / f"{number}.BIN"))
    for number, (case, text) in enumerate(TEXTS.items()):
        paths[case] = folder / f"{number}.log"
        paths[case].write_text(text)
    return paths


def times_of(path: Path) -> list[tuple[str, float]]:
    reader = DFReader.DFReader_text if path.suffix == ".log" else DFReader.DFReader_binary
    with reader(str(path)) as log:
        return [(m.get_type(), m._timestamp) for m in iter(log.recv_msg, None)]


def test_same_as_pymavlink(oracle: str, tmp_path: Path) -> None:
    paths = write(tmp_path)
    command = [sys.executable, "-c", PROGRAM, *map(str, paths.values())]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    theirs = [json.loads(line) for line in ran.stdout.splitlines()]
    for (case, path), expected in zip(paths.items(), theirs, strict=True):
        found = times_of(path)
        assert [kind for kind, _ in found] == [kind for kind, _ in expected], case
        assert [time for _, time in found] == pytest.approx([time for _, time in expected]), case


def test_tables_say_the_same(tmp_path: Path) -> None:
    for case, path in write(tmp_path).items():
        if case in RATED:  # docs/columns.md: tables do not reckon with rates
            continue
        times: dict[str, list[float]] = {}
        for kind, time in times_of(path):
            times.setdefault(kind, []).append(time)
        for kind, table in mavwire.read(path).items():
            found = table["timestamp"].astype("int64") / 1e6
            assert found.tolist() == pytest.approx(times[kind], abs=2e-6, rel=0), (case, kind)


HUGE = "9" * 303


@pytest.mark.parametrize(
    "lines",
    [
        f"FMT, 1, 9, GPS, QI, Week,TimeMS\nGPS, {HUGE}, 1000\nGPS, {HUGE}1, 2000\n",
        f"FMT, 1, 9, GPS, QQI, TimeUS,GWk,GMS\nGPS, 5000, {HUGE}99, 1000\n",
        f"FMT, 1, 9, GPS, IQI, TimeMS,Week,T\nGPS, 5, {HUGE}999, 1000\n",
        "FMT, 1, 9, GPS, QdI, TimeUS,GWk,GMS\nGPS, 5000, 1e308, 1000\n",
        "FMT, 1, 9, TIME, Q, StartTime\nTIME, 5.5\nFMT, 3, 9, GPS, Q, GPSTime\nGPS, 7\n",
    ],
)
def test_what_makes_no_time_is_none(tmp_path: Path, lines: str) -> None:
    path = tmp_path / "odd.log"
    path.write_text(f"{DESCRIBED}{lines}FMT, 2, 15, IMU, Q, TimeUS\nIMU, 7000\n")
    assert times_of(path)[-1] == ("IMU", pytest.approx(0.007))
    assert mavwire.read(path)["IMU"]["timestamp"].astype("int64").tolist() == [7000]


def test_milliseconds_with_a_fraction(tmp_path: Path) -> None:
    log = Log().define("ATT", "fB", "TimeMS,X").add("ATT", 0.5, 1).add("ATT", 2.25, 1)
    path = Path(log.write(tmp_path / "fractions.BIN"))
    found = [time for kind, time in times_of(path) if kind == "ATT"]
    assert found == pytest.approx([0.0005, 0.00225])
    assert mavwire.read(path)["ATT"]["timestamp"].astype("int64").tolist() == [500, 2250]
