"""A filter of `scan_polars` gives the rows that it gives on the whole table, with the same values."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import mavwire
import pytest
from dataflash_writer import Log
from mavwire import traffic
from mavwire.logs import scanning
from real_logs import each_log
from unit.column_tools import log_of_every_type

pl = pytest.importorskip("polars")
testing = pytest.importorskip("polars.testing")

READABLE = {"units": "si", "enums": "names"}
TYPES = ("HIGH_LATENCY2", "BATTERY_STATUS", "PARAM_VALUE", "HIL_STATE_QUATERNION", "STATUSTEXT",
         "ODOMETRY", "OPEN_DRONE_ID_BASIC_ID", "AUTOPILOT_VERSION", "HEARTBEAT")  # fmt: skip
"""With enums, arrays, texts, floats that are no numbers, and many columns."""


@pytest.fixture(scope="module")
def every(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "all.tlog"
    log_of_every_type(path, each=60)
    return path


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 5_000)
    return path


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The columns of each table that a predicate is asked about."""
    names: list[list[str]] = []
    kept = scanning._kept

    def noted(empty: Any, predicate: Any, rows: Any) -> Any:
        names.append(rows.names)
        return kept(empty, predicate, rows)

    monkeypatch.setattr(scanning, "_kept", noted)
    return names


def check(lazy: Any, whole: Any, predicate: Any, columns: list[str] | None = None) -> int:
    """Assert that a pushed filter gives what it gives on the whole table; the number of rows."""
    columns = whole.columns if columns is None else columns
    expected = whole.filter(predicate).select(columns)
    chosen = lazy.filter(predicate).select(columns)
    for engine in ("auto", "streaming"):
        found = chosen.collect(engine=engine)
        testing.assert_frame_equal(found, expected, check_exact=True)
    middle = len(expected) // 2
    testing.assert_frame_equal(chosen.head(3).collect(), expected.head(3), check_exact=True)
    found = chosen.slice(middle, 2).collect()
    testing.assert_frame_equal(found, expected.slice(middle, 2), check_exact=True)
    return len(expected)


def leaf(random: Random, frame: Any) -> Any:
    """A predicate about one column, with values that it has."""
    name = random.choice(frame.columns)
    column, kind = pl.col(name), frame.schema[name]
    if random.random() < 0.1:
        return random.choice([column.is_null(), column.is_not_null()])
    if isinstance(kind, pl.Array):
        column, kind = column.arr.get(random.randrange(kind.size)), kind.inner
    values = (
        frame.select(column.drop_nulls())
        .to_series()
        .cast(pl.String if isinstance(kind, pl.Categorical | pl.Enum) else kind)
    )
    if values.is_empty():
        return column.is_null()
    one, other = (values[random.randrange(len(values))] for _ in range(2))
    equal = [column == one, column != one, column.is_in([one, other]), column.eq_missing(one)]
    if isinstance(kind, pl.Categorical | pl.Enum | pl.Binary):
        return random.choice(equal)
    if kind == pl.String:
        return random.choice([*equal, column.str.starts_with(one[:1]), column > one])
    order = [
        column < one,
        column <= one,
        column > one,
        column >= one,
        column.is_between(one, other),
    ]
    if kind.is_float():
        order += [column.is_nan(), column == pl.lit(float("nan")), column.abs() < 1e30]
    return random.choice([*equal, *order])


def tree(random: Random, frame: Any, depth: int = 2) -> Any:
    """A predicate of some such, by boolean algebra."""
    if depth == 0 or random.random() < 0.2:
        return leaf(random, frame)
    one, other = tree(random, frame, depth - 1), tree(random, frame, depth - 1)
    return random.choice([one & other, one | other, ~one, one ^ other])


@pytest.mark.parametrize("how", [{}, {"invalid": "null"}, READABLE], ids=["plain", "null", "names"])
@pytest.mark.parametrize("name", TYPES)
def test_any_predicate_of_any_columns(every, asked, name, how):
    random, lazy = Random(name), mavwire.scan_polars(every, name, **how)
    whole = lazy.collect()
    assert len(whole) > 30
    kept = []
    for _ in range(25):
        columns = random.sample(whole.columns, random.randrange(1, whole.width + 1))
        kept.append(check(lazy, whole, tree(random, whole), random.choice([None, columns])))
    assert min(kept) < len(whole) and max(kept) > 0
    is_late = any("" in names and len(names) < whole.width for names in asked)
    assert is_late == (
        name not in ("STATUSTEXT", "HEARTBEAT") or (name, how) == ("HEARTBEAT", READABLE)
    )


def test_only_what_the_predicate_asks_for_is_decoded_of_all_rows(flight, asked):
    lazy = mavwire.scan_polars(flight, "SYS_STATUS", **READABLE)
    whole = lazy.collect()
    assert (
        check(lazy, whole, (pl.col("load") > whole["load"].median()) & (pl.col("sysid") == 1)) > 0
    )
    assert {*map(tuple, asked)} == {("timestamp", "sysid", "load", "")}
    asked.clear()
    check(lazy, whole, pl.col("load") > 0, ["load", "seq"])
    assert {"" in names for names in asked} == {False}  # a copy of the records would cost more


@pytest.mark.parametrize("predicate", [pl.lit(True), pl.lit(False), pl.col("roll") > 1e9])
def test_all_rows_and_none(flight, predicate):
    lazy = mavwire.scan_polars(flight, "ATTITUDE", units="si")
    whole = lazy.collect()
    assert check(lazy, whole, predicate) in (0, len(whole))
    assert lazy.filter(predicate).select(pl.len()).collect().item() == len(whole.filter(predicate))


def test_a_predicate_that_fails(flight):
    whole = mavwire.read(flight, "SYS_STATUS")["SYS_STATUS"].to_polars()
    lazy = mavwire.scan_polars(flight, "SYS_STATUS", units="si", enums="names")
    failing = pl.col("load").map_elements(lambda _: 1 // 0, return_dtype=pl.Boolean)
    for frame in (whole.lazy(), lazy):
        with pytest.raises((pl.exceptions.ComputeError, ZeroDivisionError), match="division"):
            frame.filter(failing).collect()
        with pytest.raises(pl.exceptions.ColumnNotFoundError):
            frame.filter(pl.col("nothing") > 1).collect()


def test_several_systems_and_a_raw_stream(tmp_path, flight):
    frames = [bytes(msg.get_msgbuf()) for msg in mavwire.open_log(flight).messages("SYS_STATUS")]
    raw = tmp_path / "flight.raw"
    raw.write_bytes(b"".join(frames))
    lazy = mavwire.scan_polars([flight, raw], "SYS_STATUS", units="si", systems=1)
    whole = lazy.collect()
    assert whole["timestamp"].null_count() == len(frames)
    assert check(lazy, whole, pl.col("timestamp").is_null() & (pl.col("load") > 0)) > 0
    assert check(lazy, whole, pl.col("timestamp").is_not_null() & (pl.col("sysid") == 1)) > 0
    assert check(lazy, whole, pl.col("sysid") != 1) == 0


def test_long_texts_are_filtered_whole(tmp_path):
    from mavwire.dialects.v20 import common

    mav = common.MAVLink(None, srcSystem=1)
    path, text = tmp_path / "text.tlog", "x" * 80
    with path.open("wb") as file:
        for id, words in enumerate(
            [text, "short", "y" * 60, "\xe9".encode("latin1").decode("latin1")], 1
        ):
            parts = [words[at : at + 50] for at in range(0, len(words), 50)]
            for number, part in enumerate(parts):
                chunk = number if len(parts) > 1 else 0
                message = mav.statustext_encode(
                    6, part.encode(), id if len(parts) > 1 else 0, chunk
                )
                file.write((id * 10**6).to_bytes(8, "big") + message.pack(mav))
    lazy = mavwire.scan_polars(path, "STATUSTEXT", **READABLE)
    whole = lazy.collect()
    assert check(lazy, whole, pl.col("text") == text) == 1
    assert check(lazy, whole, pl.col("text").str.len_chars() > 50) == 2


WIDE = ("QNhcCLeafZbBM", "TimeUS,Name,A,B,C,Lat,Alt,Arr,F,Text,D,E,Mode")


def dataflash(path: Path, rows: int, *, again: bool = False) -> str:
    """A log of a type with many columns; `again` describes it a second time, with one column less."""
    random, log = Random(rows), Log().define("WIDE", *WIDE, 200)
    log.define("GPS", "QBBIHL", "TimeUS,I,Status,GMS,GWk,Lat", 160)
    log.add("GPS", 5_000_000, 0, 3, 100_000, 2200, -353_632_620)
    for number in range(rows):
        if again and number == rows // 2:
            log.define("WIDE", WIDE[0][:-1], WIDE[1].rpartition(",")[0], 200)
        small, float_ = random.randrange(-100, 100), random.choice([1.5, float("nan"), -2e9])
        values = [number * 1000, f"N{number % 7}", small, small, abs(small), small, small]
        values += [random.randbytes(64), float_, f"text {number % 5}\xff", small, abs(small), 3]
        log.add("WIDE", *values[: len(log.types["WIDE"][1])])
    return log.write(path)


@pytest.mark.parametrize("again", [False, True], ids=["one description", "two"])
@pytest.mark.parametrize("how", [{}, {"units": "si"}], ids=["plain", "si"])
def test_dataflash_logs(tmp_path, asked, how, again):
    paths = [dataflash(tmp_path / f"{rows}.BIN", rows, again=again) for rows in (90, 30)]
    paths.append(
        Log()
        .define("WIDE", "QhB", "TimeUS,A,Gone", 3)
        .add("WIDE", 1, 7, 9)
        .write(tmp_path / "old.BIN")
    )
    lazy = mavwire.scan_polars(paths, "WIDE", **how)
    whole, random = lazy.collect(), Random(5)
    assert len(whole) == 121
    for _ in range(30):
        check(lazy, whole, tree(random, whole))
    assert check(lazy, whole, pl.col("Gone") == 9) == 1
    assert any("" in names for names in asked) is not again


def test_text_logs_and_logs_of_both_kinds(tmp_path, flight):
    text = tmp_path / "text.log"
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    head += "FMT, 1, 31, ATTITUDE, Qfff, TimeUS,roll,pitch,other\n"
    text.write_text(head + "".join(f"ATTITUDE, {n}, {n / 10}, -1, {n}\n" for n in range(40)))
    lazy = mavwire.scan_polars([text, flight], "ATTITUDE", units="si")
    whole = lazy.collect()
    assert 0 < check(lazy, whole, pl.col("roll") > 1) < len(whole)
    assert check(lazy, whole, pl.col("other").is_in([3.0, 4.0])) == 2


@each_log("*.tlog", "*.raw", "*.BIN", "*.log")
def test_types_of_real_logs(path):
    random = Random(path.name)
    tables = mavwire.read(path, unknown="ignore")
    for name in random.sample(sorted(tables), min(6, len(tables))):
        for how in ({}, READABLE):
            lazy = mavwire.scan_polars(path, name, **how)
            whole = lazy.collect()
            for _ in range(4):
                check(lazy, whole, tree(random, whole))
