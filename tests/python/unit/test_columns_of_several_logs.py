"""One frame of several logs has the columns of all of them, in an order that does not depend on theirs."""

from __future__ import annotations

import pickle
import re
from itertools import permutations
from typing import Any

import mavwire
import pytest
from dataflash_writer import Log
from mavwire import cli, traffic

pa = pytest.importorskip("pyarrow")
pl = pytest.importorskip("polars")


def described(path: Any, format: str, columns: str, *rows: tuple[Any, ...], units: str = "") -> str:
    """A log with a type `TST`, its rows, and the ids of its units."""
    log = Log().define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 115)
    log.define("UNIT", "QbZ", "TimeUS,Id,Label", 116).define("TST", format, columns, 251)
    for unit_id, label in ("m", "m"), ("c", "cm"):
        log.add("UNIT", 1, ord(unit_id), label)
    if units:
        log.add("FMTU", 2, 251, units, "-" * len(units))
    for row in rows:
        log.add("TST", *row)
    return log.write(path)


@pytest.fixture
def three(tmp_path) -> list[str]:
    """An old log, one that has instances, and one with another column and a wider one."""
    return [
        described(tmp_path / "old.BIN", "Qh", "TimeUS,A", (1, -1)),
        described(tmp_path / "new.BIN", "QBf", "TimeUS,I,A", (1, 0, 1.5), (2, 1, 2.5), units="s#m"),
        described(tmp_path / "other.BIN", "QiB", "TimeUS,A,Gone", (3, 70_000, 9)),
    ]


def frames(paths: list[str], name: str, **how: Any) -> list[Any]:
    """The same by a polars frame, an Arrow stream and a Dask frame, as Arrow tables."""
    found = [
        pa.table(mavwire.scan_polars(paths, name, **how).collect().to_arrow()),
        pa.table(mavwire.scan(paths, name, **how)),
    ]
    try:
        from mavwire.fleet import dask_frame
    except ImportError:
        return found
    frame = dask_frame(paths, name, **how)
    computed = frame.compute(scheduler="sync")
    assert computed.dtypes.equals(frame.dtypes)
    return [*found, pa.Table.from_pandas(computed, preserve_index=False)]


def test_every_column_of_every_log_in_whatever_order(three):
    names = ["timestamp", "TimeUS", "I", "A", "Gone"]
    for paths in permutations(three):
        for found in frames(list(paths), "TST"):
            assert found.column_names == names
            rows = sorted(
                zip(*(found[name].to_pylist() for name in names[1:]), strict=True), key=str
            )
            expected = [
                (1, 0, 1.5, None),
                (1, None, -1.0, None),
                (2, 1, 2.5, None),
                (3, None, 70_000.0, 9),
            ]
            assert rows == expected
            assert found.schema.field("A").type == pa.float64()


def test_the_column_that_tells_instances_apart_is_marked(three):
    stream = pa.RecordBatchReader.from_stream(mavwire.scan(three, "TST"))
    assert stream.schema.field("I").metadata[b"instance"] == b"true"
    lazy = pickle.loads(pickle.dumps(mavwire.scan_polars(three, "TST")))
    one = lazy.filter(pl.col("I") == 1).select("A", "Gone").collect()
    assert one.rows() == [(2.5, None)]


def test_a_unit_is_that_of_all_logs(tmp_path):
    paths = [
        described(tmp_path / f"{number}.BIN", "Qff", "TimeUS,A,B", (1, 1, 1), units=units)
        for number, units in enumerate(("-mm", "-cm"))
    ]
    schema = pa.RecordBatchReader.from_stream(mavwire.scan(paths, "TST")).schema
    assert b"unit" not in schema.field("A").metadata
    assert schema.field("B").metadata[b"unit"] == b"m"


FIRST = [1, 2, 255]
WIDER = [
    ("B", "i", [300, -5, 70_000], pa.int32()), ("B", "b", [-1, 127], pa.int16()),
    ("b", "B", [128, 5], pa.int16()), ("H", "b", [-1], pa.int32()), ("I", "h", [-1], pa.int64()),
    ("B", "Q", [2**64 - 1], pa.uint64()), ("Q", "q", [-1, 2**62], pa.float64()),
    ("q", "Q", [2**63, 5], pa.float64()), ("B", "f", [1.5, 1e30], pa.float64()),
    ("q", "d", [2.0**63, 0.5], pa.float64()), ("f", "i", [3, -(2**24)], pa.float64()),
    ("f", "d", [0.1], pa.float64()), ("f", "g", [0.5], pa.float32()), ("B", "L", [-353_632_620], pa.float64()),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "other", "values", "expected"), WIDER)
def test_numbers_widen(tmp_path, kind, other, values, expected):
    """No number becomes another one, and none is lost."""
    first = [1, 2] if kind == "b" else FIRST
    paths = [
        described(tmp_path / "0.BIN", f"Q{kind}", "TimeUS,X", *enumerate(first)),
        described(tmp_path / "1.BIN", f"Q{other}", "TimeUS,X", *enumerate(values)),
    ]
    stored = [1e-7 * one if other == "L" else one for one in values]
    for logs, whole in ((paths, [*first, *stored]), (paths[::-1], [*stored, *first])):
        for found in frames(logs, "TST")[:2]:
            assert found.schema.field("X").type == expected
            assert found["X"].to_pylist() == pytest.approx(whole, rel=1e-7)


@pytest.mark.parametrize(
    ("kind", "other", "said"),
    [
        ("B", "Z", "a number (UInt8) in {0} and text in {1}"),
        ("Z", "B", "a number (UInt8) in {1} and text in {0}"),
        ("a", "Z", "a list of 32 Int16 in {0} and text in {1}"),
    ],
)
def test_text_beside_numbers_is_refused_with_both_logs(tmp_path, kind, other, said):
    paths = [
        described(tmp_path / f"{number}.BIN", f"Q{form}B", "TimeUS,X,N")
        for number, form in enumerate((kind, other))
    ]
    whole = re.escape(f'column "X" of TST is {said.format(*paths)}. One frame cannot hold both')
    calls: list[Any] = [
        lambda logs: mavwire.scan_polars(logs, "TST"),
        lambda logs: pa.table(mavwire.scan(logs, "TST")),
    ]
    for logs in (paths, paths[::-1]):
        for call in calls:
            with pytest.raises(ValueError, match=whole):
                call(logs)
        assert pa.table(mavwire.scan(logs, "TST", fields="N")).column_names[-1] == "N"
        assert list(mavwire.scan(logs, "TST")) == []  # tables of each log by itself
    pytest.importorskip("dask.dataframe")
    from mavwire.fleet import dask_frame

    with pytest.raises(ValueError, match=whole):
        dask_frame(paths, "TST")
    assert list(dask_frame(paths, "TST", "N").columns) == ["N"]


@pytest.fixture
def both_kinds(tmp_path) -> list[str]:
    """Logs of both kinds with a type that both have."""
    from mavwire.dialects.v20 import all as dialect

    onboard = Log().define("RPM", "Qff", "TimeUS,rpm1,Other", 1).add("RPM", 5, 7.5, 1)
    mav = dialect.MAVLink(None, 3, 1)
    frame = dialect.MAVLink_rpm_message(1.5, 2.5).pack(mav)
    (tmp_path / "x.tlog").write_bytes(b"".join(bytes(7) + b"\x01" + frame for _ in range(3)))
    return [onboard.write(tmp_path / "x.BIN"), str(tmp_path / "x.tlog")]


def test_a_type_of_telemetry_and_of_dataflash_logs(both_kinds):
    names = ["timestamp", "sysid", "compid", "seq", "rpm1", "rpm2", "TimeUS", "Other"]
    for paths in (both_kinds, both_kinds[::-1]):
        for found in frames(paths, "RPM"):
            assert found.column_names == names
            assert sorted(found["rpm1"].to_pylist()) == [1.5, 1.5, 1.5, 7.5]
            assert found["sysid"].null_count == found["rpm2"].null_count == 1
            assert found["Other"].null_count == found["TimeUS"].null_count == 3
    telemetry = pa.table(mavwire.scan(both_kinds[1:], "RPM"))
    assert telemetry.column_names == names[:6]
    assert not telemetry.schema.field("sysid").nullable
    onboard = pa.table(mavwire.scan(both_kinds[:1], "RPM"))
    assert onboard.column_names == ["timestamp", "TimeUS", "rpm1", "Other"]


def test_columns_of_a_data_frame_are_those_of_any_log(both_kinds):
    pytest.importorskip("dask.dataframe")
    from mavwire.fleet import dask_frame

    found = dask_frame(both_kinds, "RPM", ["Other", "rpm2"]).compute(scheduler="sync")
    assert list(found.columns) == ["Other", "rpm2"] and found["Other"].notna().sum() == 1
    with pytest.raises(ValueError, match="no log has a column 'rpm3' of RPM"):
        dask_frame(both_kinds, "RPM", ["Other", "rpm3"])


def test_a_type_that_no_dataflash_log_has_is_answered_with_theirs(tmp_path, three, capsys):
    traffic.generate(tmp_path / "flight.tlog", 100)
    telemetry = str(tmp_path / "flight.tlog")
    calls: list[Any] = [
        mavwire.scan_polars,
        lambda logs, name: pa.table(mavwire.scan(logs, name)),
        lambda logs, name: list(mavwire.scan(logs, name)),
        lambda logs, name: mavwire.read(logs[0], name),
    ]
    for call in calls:
        for wrong, hint in (("TSTS", "; did you mean 'TST'?"), ("HEARTBEAT", ""), ("IMU", "")):
            of_one = f"the log describes no record type '{wrong}'{hint}"
            of_all = f"none of the 3 logs describes a record type '{wrong}'{hint}"
            said = of_one if call is calls[-1] else of_all
            with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
                call(three, wrong)
    with pytest.raises(KeyError, match="did you mean 'TST'"):
        mavwire.open_log(three[0])["TSTS"]
    with pytest.raises(ValueError, match="no message 'HEARTBEET'; did you mean 'HEARTBEAT'"):
        mavwire.scan_polars([*three, telemetry], "HEARTBEET")
    said = (
        "mavwire convert: none of the 3 logs describes a record type 'TSTS'; did you mean 'TST'?\n"
    )
    for again in "first", "converted before":
        assert cli.main(["convert", *three, "-o", str(tmp_path / "out"), "--types", "TSTS"]) == 1, (
            again
        )
        assert capsys.readouterr() == ("", said)
    assert cli.main(["convert", *three, "-o", str(tmp_path / "two"), "--types", "TST,TSTS"]) == 1
    shown = capsys.readouterr()
    assert shown.err == said and "old.BIN: converted, 1 rows in 1 files" in shown.out


def test_a_log_is_surveyed_once_for_columns_and_rows(three, monkeypatch):
    from mavwire.logs import common_columns

    opened = []
    survey = common_columns.open_dataflash
    monkeypatch.setattr(
        common_columns, "open_dataflash", lambda *log: opened.append(log) or survey(*log)
    )
    assert len(pa.table(mavwire.scan(three, "TST"))) == 4
    assert len(opened) == 3
    assert len(mavwire.scan_polars(three, "TST").collect()) == 4
    assert len(opened) == 6
    monkeypatch.setattr(common_columns, "MAX_KEPT", 1)
    assert len(pa.table(mavwire.scan(three, "TST"))) == 4
    assert len(opened) == 11
