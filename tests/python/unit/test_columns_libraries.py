"""Tables in the libraries that people use, and back from files by them."""

from __future__ import annotations

import json
import signal
from datetime import datetime
from pathlib import Path

import mavwire
import pytest
from dataflash_writer import sample
from mavwire import cli, traffic
from mavwire.logs.align import align
from mavwire.logs.conversion import convert
from mavwire.logs.formats import TABLE_FORMATS
from unit.column_tools import log_of_every_type


@pytest.fixture(scope="module")
def every(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "all.tlog"
    log_of_every_type(path, each=4)
    return path


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 5_000)
    return path


@pytest.mark.parametrize("how", [{}, {"units": "si", "enums": "names"}], ids=["plain", "readable"])
def test_pyarrow_finds_nothing_wrong(every, how):
    pa = pytest.importorskip("pyarrow")
    for name, table in mavwire.read(every, **how).items():
        arrow = table.to_arrow()
        arrow.validate(full=True)
        assert (arrow.num_rows, arrow.column_names) == (4, table.columns), name
        assert pa.schema(table) == arrow.schema
        assert {f.name: (f.metadata or {}).get(b"unit") for f in arrow.schema} == {
            column: entries["unit"].encode() if "unit" in entries else None
            for column, entries in table.metadata.items()
        }


def test_polars_and_pandas_see_the_same(flight):
    pl, pd = pytest.importorskip("polars"), pytest.importorskip("pandas")
    for table in mavwire.read(flight).values():
        numpy = table.to_numpy()
        polars, pandas = table.to_polars(), table.to_pandas()
        assert isinstance(polars, pl.DataFrame) and isinstance(pandas, pd.DataFrame)
        assert list(pandas) == polars.columns == table.columns
        for column, values in numpy.items():
            if column == "timestamp":
                micros = values.astype("int64").tolist()
                assert polars[column].to_physical().to_list() == micros
                stamps = pandas[column].dt.tz_localize(None).to_numpy().astype("datetime64[us]")
                assert stamps.astype("int64").tolist() == micros
            else:
                assert polars[column].to_list() == values.tolist()
                rows = pandas[column].tolist()
                assert [r.tolist() if values.ndim > 1 else r for r in rows] == values.tolist()


def test_duckdb_queries_a_table(flight):
    duckdb = pytest.importorskip("duckdb")
    pytest.importorskip("pyarrow")
    attitude = mavwire.open_log(flight)["ATTITUDE"]
    found = duckdb.sql("select count(*), max(roll) from attitude").fetchall()
    assert found == [(len(attitude), attitude["roll"].max())]


@pytest.mark.parametrize("compression", ["zstd", "snappy", "none"])
def test_parquet_is_read_back(every, tmp_path, compression):
    pq = pytest.importorskip("pyarrow.parquet")
    rows = convert([every], tmp_path, compression=compression)
    assert rows[0].error is None
    for name, table in mavwire.read(every).items():
        file = tmp_path / name / "all.parquet"
        read = pq.read_table(file)
        expected = table.to_arrow()
        found = read.select(expected.column_names).cast(expected.schema)
        # As text, in which not-a-number equals itself.
        assert str(found.to_pylist()) == str(expected.to_pylist()), name
        groups = pq.ParquetFile(file).metadata
        assert groups.row_group(0).column(0).statistics.has_min_max


def test_parquet_in_polars_and_duckdb(flight, tmp_path):
    pl, duckdb = pytest.importorskip("polars"), pytest.importorskip("duckdb")
    convert([flight], tmp_path)
    for name, table in mavwire.read(flight).items():
        file = tmp_path / name / "flight.parquet"
        expected = table.to_polars()
        found = pl.read_parquet(file).select(expected.columns)
        # As text, in which not-a-number equals itself.
        assert str(found.rows()) == str(expected.rows()), name
        values = expected.drop("timestamp")
        columns = ", ".join(f'"{column}"' for column in values.columns)
        rows = duckdb.sql(f"select {columns} from '{file}'").fetchall()
        lists = [tuple(list(v) if isinstance(v, tuple) else v for v in row) for row in rows]
        assert str(lists) == str(values.rows()), name


def test_scan_polars_pushes_down(flight):
    pl = pytest.importorskip("polars")
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    frame = table.to_polars()
    lazy = mavwire.scan_polars(flight, "ATTITUDE")
    assert lazy.collect().equals(frame)
    middle = frame["timestamp"][len(frame) // 2]
    condition = (pl.col("timestamp") >= middle) & (pl.col("roll") != frame["roll"][-1])
    found = lazy.filter(condition).select("pitch").collect()
    assert found.equals(frame.filter(condition).select("pitch"))
    assert 0 < len(found) < len(frame)
    exact = lazy.filter(pl.col("timestamp") == middle).collect()
    assert exact.equals(frame.filter(pl.col("timestamp") == middle))
    assert lazy.head(7).collect().equals(frame.head(7))
    assert mavwire.scan_polars([flight, flight], "ATTITUDE").select(pl.len()).collect().item() == (
        2 * len(frame)
    )


def test_a_filter_by_the_last_time_there_is(flight, tmp_path):
    pl = pytest.importorskip("polars")
    path, last = tmp_path / "last.tlog", 2**63 - 1
    frames = (bytes(msg.get_msgbuf()) for msg in mavwire.open_log(flight))
    path.write_bytes(b"".join(last.to_bytes(8, "big") + frame for frame in frames))
    whole = mavwire.read(path, "ATTITUDE")["ATTITUDE"].to_polars()
    time = pl.lit(last).cast(pl.Int64).cast(pl.Datetime("us", "UTC"))
    for condition in (pl.col("timestamp") <= time, pl.col("timestamp") == time):
        found = mavwire.scan_polars(path, "ATTITUDE").filter(condition).collect()
        assert found.height == whole.filter(condition).height > 0


@pytest.mark.parametrize(
    "condition",
    [
        "ts > a",
        "ts.is_between(a, b)",
        "(ts >= a) & (ts < b) & (pl.col('sysid') == 1)",
        "(ts < b) | (pl.col('sysid') == 1)",
        "pl.col('sysid') == pl.col('seq').clip(0)",
    ],
)
def test_a_filter_is_that_of_polars(flight, monkeypatch, condition):
    pl = pytest.importorskip("polars")
    from mavwire.logs import reading

    asked = []
    run = reading.columns_from

    def noted(tables, source, native, query):
        asked.append(query)
        return run(tables, source, native, query)

    monkeypatch.setattr(reading, "columns_from", noted)
    frame = mavwire.read(flight, "ATTITUDE")["ATTITUDE"].to_polars()
    a, b = frame["timestamp"][len(frame) // 3], frame["timestamp"][len(frame) // 2]
    chosen = eval(condition, {"pl": pl, "ts": pl.col("timestamp"), "a": a, "b": b})
    found = mavwire.scan_polars(flight, "ATTITUDE").filter(chosen).select("pitch").collect()
    assert found.equals(frame.filter(chosen).select("pitch"))
    (query,) = asked
    assert "yaw" not in query.columns and "pitch" in query.columns


def test_a_sender_that_a_filter_names_is_about_telemetry_alone(flight, tmp_path):
    pl = pytest.importorskip("polars")
    onboard = sample().write(tmp_path / "flight.BIN")
    lazy = mavwire.scan_polars([flight, onboard], "ATTITUDE")
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    found = lazy.filter(pl.col("sysid") == table["sysid"][0]).collect()
    assert len(found) == (table["sysid"] == table["sysid"][0]).sum() > 0


def test_pandas_frames_can_be_written_to_and_keep_categories(flight):
    pd = pytest.importorskip("pandas")
    table = mavwire.read(flight, "HEARTBEAT", enums="names")["HEARTBEAT"]
    frame = table.to_pandas()
    frame.loc[0, "custom_mode"] = 77
    assert frame["custom_mode"][0] == 77 != table["custom_mode"][0]
    assert isinstance(frame["autopilot"].dtype, pd.CategoricalDtype)
    assert frame["autopilot"].tolist() == table["autopilot"].tolist()


def test_pandas_integers_without_values(tmp_path):
    pd = pytest.importorskip("pandas")
    large = 2**60 + 1
    log = tmp_path / "flight.log"
    log.write_text(
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
        f"FMT, 200, 19, ABC, QQ, TimeUS,Count\nABC, 1000, {large}\nABC, 2000, none\n"
    )
    table = mavwire.read(log, "ABC")["ABC"]
    assert table.to_pandas()["Count"].dtype == "float64"
    frame = table.to_pandas(nullable=True)
    assert frame["Count"].dtype in (pd.Int64Dtype(), pd.UInt64Dtype())
    assert frame["Count"].tolist() == [large, pd.NA]


def test_numpy_takes_a_table_as_records(flight):
    import numpy as np

    table = mavwire.read(flight, "BATTERY_STATUS")["BATTERY_STATUS"]
    records = np.asarray(table)
    assert records.dtype.names == tuple(table.columns)
    assert records["voltages"].tolist() == table["voltages"].tolist()


def test_tables_of_other_libraries(flight, tmp_path):
    pl = pytest.importorskip("polars")
    frame = mavwire.read(flight, "ATTITUDE")["ATTITUDE"].to_polars()
    steep = mavwire.logs.Table.from_arrow(frame.filter(pl.col("roll") > 0), "STEEP")
    assert (steep.name, len(steep)) == ("STEEP", (frame["roll"] > 0).sum())
    steep.write(tmp_path / "steep.csv.gz")
    assert len(pl.read_csv(tmp_path / "steep.csv.gz")) == len(steep)
    assert steep.to_polars().equals(frame.filter(pl.col("roll") > 0))


@pytest.mark.parametrize("zone", [None, "UTC", "Europe/Berlin"])
@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_times_of_other_libraries_are_microseconds(unit, zone):
    import numpy as np

    pa = pytest.importorskip("pyarrow")
    times = pa.array([datetime(2024, 1, 1), None, datetime(1969, 12, 31)], pa.timestamp(unit, zone))
    table = mavwire.logs.Table.from_arrow(pa.table({"timestamp": times, "x": [1, 2, 3]}), "T")
    expected = np.array(["2024-01-01", "NaT", "1969-12-31"], "datetime64[us]")
    np.testing.assert_array_equal(table["timestamp"], expected)
    assert table.dtypes["x"] == "Int64" and table["x"].tolist() == [1, 2, 3]
    assert len(align({"T": table.slice(0, 1)}, on="T")) == 1


def test_a_time_beyond_microseconds_is_refused():
    pa = pytest.importorskip("pyarrow")
    times = pa.table({"timestamp": pa.array([2**60], pa.timestamp("s"))})
    with pytest.raises(ValueError, match="'timestamp'"):
        mavwire.logs.Table.from_arrow(times, "T")


def test_what_is_no_table_of_arrow_is_named():
    with pytest.raises(TypeError, match="a table of Arrow is wanted, not list"):
        mavwire.logs.Table.from_arrow([1, 2], "T")


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs signals")
def test_an_interrupt_ends_the_writing_of_a_table(tmp_path):
    """It is not heard when the file is there."""
    pa = pytest.importorskip("pyarrow")
    numbers = pa.table({"x": pa.array(range(500_000))})
    table = mavwire.logs.Table.from_arrow(numbers, "T")

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, 0.005)
            table.write(tmp_path / "x.csv.gz")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert list(tmp_path.iterdir()) == []


def test_texts_and_categories_of_other_libraries(tmp_path):
    pa, pl = pytest.importorskip("pyarrow"), pytest.importorskip("polars")
    kinds = {"s": pl.String, "c": pl.Categorical, "e": pl.Enum(["a", "b"])}
    frame = pl.DataFrame({name: pl.Series(["a", None, "b"], dtype=k) for name, k in kinds.items()})
    frame = frame.with_columns(ok=pl.Series([True, False, True]), raw=pl.Series([b"a", None, b"b"]))
    for one in (frame, pl.concat([frame.head(1), frame.tail(2)], rechunk=False), frame.to_arrow()):
        table = mavwire.logs.Table.from_arrow(one, "P")
        assert [table[name].tolist() for name in kinds] == [["a", None, "b"]] * 3
        assert table["raw"].tolist() == [b"a", None, b"b"]
        table.write(tmp_path / "p.parquet")
        assert pl.read_parquet(tmp_path / "p.parquet")["ok"].to_list() == [True, False, True]
        with pytest.raises(TypeError, match="ok: Boolean"):
            table["ok"]
    numbers = pa.table({"n": pa.array([500, 7, 500]).dictionary_encode()})
    assert mavwire.logs.Table.from_arrow(numbers, "N")["n"].tolist() == [500, 7, 500]
    none = frame.clear()
    assert len(mavwire.logs.Table.from_arrow(none, "P").to_arrow()) == 0


def test_lists_in_which_values_are_missing_are_refused():
    pa = pytest.importorskip("pyarrow")
    kind = pa.list_(pa.int32(), 2)
    whole = pa.table({"l": pa.array([[1, 2], None], kind)})
    assert mavwire.logs.Table.from_arrow(whole, "L")["l"][0].tolist() == [1, 2]
    with pytest.raises(ValueError, match="'l' has lists"):
        mavwire.logs.Table.from_arrow(pa.table({"l": pa.array([[1, None]], kind)}), "L")


def test_convert_csv_and_json_lines(flight, tmp_path):
    convert([flight], tmp_path / "csv", format="csv", types="BATTERY_STATUS")
    convert([flight], tmp_path / "jsonl", format="jsonl", types="BATTERY_STATUS")
    table = mavwire.read(flight, "BATTERY_STATUS")["BATTERY_STATUS"]
    lines = (tmp_path / "csv" / "BATTERY_STATUS" / "flight.csv").read_text().splitlines()
    assert len(lines) == len(table) + 1
    assert "voltages[0],voltages[1]" in lines[0]
    first = dict(zip(lines[0].split(","), lines[1].split(","), strict=True))
    assert [int(first[f"voltages[{n}]"]) for n in range(10)] == table["voltages"][0].tolist()
    text = (tmp_path / "jsonl" / "BATTERY_STATUS" / "flight.jsonl").read_text()
    objects = [json.loads(line) for line in text.splitlines()]
    assert [one["voltages"] for one in objects] == table["voltages"].tolist()


def test_convert_arrow(flight, tmp_path):
    pa = pytest.importorskip("pyarrow")
    convert([flight], tmp_path, format="arrow", types="ATTITUDE")
    with pa.ipc.open_file(tmp_path / "ATTITUDE" / "flight.arrow") as file:
        found = file.read_all()
    assert found.equals(mavwire.read(flight)["ATTITUDE"].to_arrow())


def test_convert_goes_on_where_it_stopped(flight, every, tmp_path):
    out = tmp_path / "out"
    missing = tmp_path / "missing.tlog"
    rows = convert([flight, missing], out)
    assert [row.error is None for row in rows] == [True, False]
    assert rows[1].error == "No such file or directory"
    manifest = json.loads((out / "manifest.json").read_text())
    assert [one["path"] for one in manifest["logs"]] == [str(flight), str(missing)]
    assert sum(manifest["logs"][0]["files"].values()) == rows[0].rows == 5_000
    again = convert([flight, every], out)
    assert [row.skipped for row in again] == [True, False]
    (out / "ATTITUDE" / "flight.parquet").unlink()
    assert not convert([flight], out)[0].skipped
    assert (out / "ATTITUDE" / "flight.parquet").exists()
    assert not convert([flight], out, compression="snappy")[0].skipped, "other options"
    assert not list(out.rglob("*.part"))


def test_a_log_is_converted_again_when_the_definitions_are_others(flight, tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    definition = tmp_path / "mine.xml"
    text = """<mavlink><messages><message id="30" name="ATTITUDE"><description>x</description>
        <field type="uint32_t" name="time_boot_ms"/>%s</message></messages></mavlink>"""
    fields = "".join(
        f'<field type="float" name="{name}" units="rad"/>'
        for name in ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
    )

    def run(log: Path) -> tuple[bool, bytes]:
        (row,) = convert([log], tmp_path / "out", types="ATTITUDE", dialect=str(definition))
        assert row.error is None and row.rows
        schema = pq.read_schema(tmp_path / "out" / "ATTITUDE" / "flight.parquet")
        return row.skipped, schema.field("roll").metadata[b"unit"]

    definition.write_text(text % fields)
    assert [run(flight), run(flight)] == [(False, b"rad"), (True, b"rad")]
    definition.write_text(text % fields.replace("rad", "deg"))
    assert [run(flight), run(flight)] == [(False, b"deg"), (True, b"deg")]


def test_what_is_no_log_is_a_row_with_an_error(flight, tmp_path):
    other = tmp_path / "text.tlog"
    other.write_text("this is no telemetry log\n" * 100)
    archive = tmp_path / "flight.zip"
    archive.write_bytes(b"PK\x03\x04" + bytes(1000))
    empty = tmp_path / "empty.tlog"
    empty.write_bytes(b"")
    rows = convert([other, archive, empty, flight], tmp_path / "out")
    assert "no telemetry record found" in str(rows[0].error)
    assert "a ZIP archive, not a telemetry log" in str(rows[1].error)
    assert [(row.error, row.rows) for row in rows[2:]] == [(None, 0), (None, 5_000)]


def test_logs_with_one_name_do_not_overwrite_each_other(flight, tmp_path):
    other = tmp_path / "other" / "flight.tlog"
    other.parent.mkdir()
    other.write_bytes(flight.read_bytes()[:20_000])
    rows = convert([flight, other], tmp_path / "out", types="ATTITUDE")
    assert [list(row.files) for row in rows] == [
        ["ATTITUDE/flight.parquet"],
        ["ATTITUDE/flight-2.parquet"],
    ]


def test_later_runs_do_not_overwrite_each_other(flight, tmp_path):
    other = tmp_path / "other" / "flight.tlog"
    other.parent.mkdir()
    other.write_bytes(flight.read_bytes()[:20_000])
    out = tmp_path / "out"
    first = convert([flight], out, types="ATTITUDE")[0]
    second = convert([other], out, types="ATTITUDE")[0]
    assert list(second.files) == ["ATTITUDE/flight-2.parquet"]
    written = (out / "ATTITUDE" / "flight.parquet").read_bytes()
    assert convert([flight], out, types="ATTITUDE")[0].skipped
    assert (out / "ATTITUDE" / "flight.parquet").read_bytes() == written
    # A log keeps its name when it has changed, in whatever order it is given.
    other.write_bytes(flight.read_bytes()[:40_000])
    rows = convert([other, flight], out, types="ATTITUDE")
    assert [row.files.keys() for row in rows] == [second.files.keys(), first.files.keys()]
    assert [row.skipped for row in rows] == [False, True]


def test_the_files_of_a_log_that_is_gone_stay(flight, tmp_path):
    gone, other = tmp_path / "a" / "flight.tlog", tmp_path / "b" / "flight.tlog"
    for path in (gone, other):
        path.parent.mkdir()
        path.write_bytes(flight.read_bytes()[:20_000])
    out = tmp_path / "out"
    convert([gone], out, types="ATTITUDE")
    gone.unlink()
    assert "No such file" in str(convert([gone], out, types="ATTITUDE")[0].error)
    row = convert([other], out, types="ATTITUDE")[0]
    assert list(row.files) == ["ATTITUDE/flight-2.parquet"]


ROW = {"path": "x", "name": "x", "size": 1, "mtime_ns": 1, "rows": 1, "bad_bytes": 0}


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[]",
        "{}",
        "[" * 100_000,
        '{"version": 2}',
        '{"version": 3, "options": {}, "logs": []}',
        '{"version": 2, "options": {}, "logs": {}}',
        '{"version": 2, "options": {}, "logs": [{"path": "x"}]}',
        json.dumps(
            {
                "version": 2,
                "options": {},
                "logs": [{**ROW, "name": "../../x", "files": {}, "error": None}],
            }
        ),
        '{"name": "A web page", "icons": []}',
        b"\xff\xfe",
    ],
    ids=range(11),
)
def test_a_manifest_of_others_is_left_alone(flight, tmp_path, capsys, content):
    manifest = tmp_path / "manifest.json"
    manifest.write_bytes(content if isinstance(content, bytes) else content.encode())
    before = manifest.read_bytes()
    with pytest.raises(ValueError, match=r"manifest\.json is no manifest"):
        convert([flight], tmp_path, types="ATTITUDE")
    assert cli.main(["convert", str(flight), "-o", str(tmp_path)]) == 1
    assert "manifest.json" in capsys.readouterr().err
    assert manifest.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["manifest.json"]


def test_the_command(flight, tmp_path, capsys):
    out = tmp_path / "out"
    command = ["convert", str(flight), "-o", str(out), "--format", "csv", "--types", "ATTITUDE"]
    assert cli.main(command) == 0
    assert "converted" in capsys.readouterr().out
    assert (out / "ATTITUDE" / "flight.csv").exists()
    assert cli.main(command) == 0
    assert "converted before" in capsys.readouterr().out
    assert cli.main(["convert", str(tmp_path / "no.tlog"), "-o", str(out)]) == 1
    assert "no.tlog" in capsys.readouterr().err
    assert cli.main(["convert", str(flight), "-o", str(out), "--start", "yesterday"]) != 0
    snappy = ["convert", str(flight), "-o", str(out), "--format", "csv", "--compression", "snappy"]
    assert cli.main(snappy) != 0
    assert "snappy" in capsys.readouterr().err


def test_write_by_suffix(flight, tmp_path):
    table = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]
    for suffix in TABLE_FORMATS:
        table.write(tmp_path / f"a.{suffix}")
        assert (tmp_path / f"a.{suffix}").stat().st_size > 1000
    for suffix in ("csv.gz", "csv.zst", "jsonl.gz", "JSONL.ZST"):
        table.write(tmp_path / f"a.{suffix}")
        magic = b"\x1f\x8b" if suffix.endswith("gz") else b"\x28\xb5\x2f\xfd"
        assert (tmp_path / f"a.{suffix}").read_bytes().startswith(magic)
    for name in ("a.xyz", "a.gz", "a.parquet.gz", "a.mcap"):
        with pytest.raises(ValueError, match="format"):
            table.write(tmp_path / name)
