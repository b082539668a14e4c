"""Files of tables: whole whoever else writes them, with rows of any time, in pieces of a bounded size."""

from __future__ import annotations

import json
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mavwire
import pyarrow as pa
import pytest
from mavwire import traffic
from mavwire._native import RecordBatches
from mavwire.dialects.v20 import all as mavlink
from mavwire.logs import Table
from mavwire.logs.conversion import convert
from mavwire.logs.formats import FORMATS
from mavwire.logs.store import write_file
from unit.link_tools import T0, heartbeat, pack, record

ROWS = 200_000
GROUP = 65_536


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("long") / "long.tlog"
    path.write_bytes(record(heartbeat()) * ROWS)
    return path


def test_two_writers_of_one_file(tmp_path):
    log, out = tmp_path / "flight.tlog", tmp_path / "out"
    out.mkdir()
    traffic.generate(log, 3_000)
    tables = list(mavwire.read(log, ["ATTITUDE", "GPS_RAW_INT"]).values())
    whole = []
    for table in tables:
        table.write(tmp_path / "one.parquet")
        whole.append((tmp_path / "one.parquet").read_bytes())

    def write(number: int) -> bool:
        tables[number % 2].write(out / "same.parquet")
        return (out / "same.parquet").read_bytes() in whole

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(write, range(40)))
        contents = [bytes([n]) * (1 + 100 * n) for n in range(40)]
        list(pool.map(lambda content: write_file(str(out / "other"), content), contents))
    assert (out / "other").read_bytes() in contents
    assert sorted(one.name for one in out.iterdir()) == ["other", "same.parquet"]


def test_a_file_of_the_name_of_a_draft_stays(tmp_path):
    log, precious = tmp_path / "flight.tlog", tmp_path / "x.parquet.part"
    traffic.generate(log, 100)
    precious.write_text("precious")
    mavwire.read(log, "ATTITUDE")["ATTITUDE"].write(tmp_path / "x.parquet")
    assert precious.read_text() == "precious"


@pytest.mark.parametrize("format", FORMATS)
def test_a_time_beyond_all_calendars_loses_no_row(tmp_path, format):
    path = tmp_path / "odd.tlog"
    stamps = [2**64 - 1, T0, 2**63 - 1, T0 + 1]
    path.write_bytes(b"".join(record(heartbeat(n), at) for n, at in enumerate(stamps)))
    (row,) = convert([path], tmp_path / "out", format=format)
    assert (row.error, row.rows) == (None, 4)
    if format in ("csv", "jsonl"):
        (file,) = (tmp_path / "out" / "HEARTBEAT").iterdir()
        lines = file.read_text().splitlines()[-4:]
        times = [line.split(",")[0] for line in lines]
        if format == "jsonl":
            times = [json.loads(line)["timestamp"] for line in lines]
        assert "262142-12-31" in times[0] and "262142-12-31" in times[2]
        assert times[1].startswith("2020-") and times[3].startswith("2020-")


def test_batches_are_no_larger_than_was_asked_for(long):
    sizes = [len(batch) for batch in mavwire.scan(long, batch_rows=1000)]
    assert sum(sizes) == ROWS
    assert max(sizes) <= 1000
    assert len(sizes) < 2 * ROWS / 1000, "and hardly smaller"
    batch = next(mavwire.scan(long, batch_rows=1000))
    assert batch.nbytes < 1000 * 100, "of its rows alone"


def test_row_groups_are_no_larger_than_readers_like(long, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    convert([long], tmp_path)
    table = mavwire.read(long, "HEARTBEAT")["HEARTBEAT"]
    table.write(tmp_path / "whole.parquet")
    for path in (tmp_path / "whole.parquet", tmp_path / "HEARTBEAT" / "long.parquet"):
        file = parquet.ParquetFile(path)
        sizes = [file.metadata.row_group(n).num_rows for n in range(file.metadata.num_row_groups)]
        assert sum(sizes) == ROWS
        assert max(sizes) <= GROUP and len(sizes) < 2 * ROWS / GROUP + 1


@pytest.fixture
def named(tmp_path: Path) -> Table:
    """Two batches with names of enums, of which each has some that the other has not."""
    parts = []
    for kinds in ((2, 1), (13, 2, 250)):
        path = tmp_path / "part.tlog"
        messages = [mavlink.MAVLink_heartbeat_message(kind, 3, 0, 0, 4, 3) for kind in kinds]
        path.write_bytes(b"".join(record(pack(one, n)) for n, one in enumerate(messages)))
        parts.append(mavwire.read(path, enums="names")["HEARTBEAT"]._batches)
    return Table("HEARTBEAT", RecordBatches.joined(parts), None)


NAMES = [
    "MAV_TYPE_QUADROTOR", "MAV_TYPE_FIXED_WING", "MAV_TYPE_HEXAROTOR", "MAV_TYPE_QUADROTOR", "250",
]  # fmt: skip


def test_pickling_names_of_several_batches(named):
    copy = pickle.loads(pickle.dumps(named))
    assert copy["type"].tolist() == NAMES
    assert copy.metadata == named.metadata


def test_an_arrow_file_of_names_of_several_batches(named, tmp_path):
    pa = pytest.importorskip("pyarrow")
    named.write(tmp_path / "names.arrow")
    with pa.OSFile(str(tmp_path / "names.arrow")) as file:
        table = pa.ipc.open_file(file).read_all()
    assert table["type"].to_pylist() == NAMES
    assert table.schema.field("type").type == pa.string()
    assert table.schema.field("type").metadata == {
        key.encode(): value.encode() for key, value in named.metadata["type"].items()
    }


def test_a_short_first_batch_does_not_keep_columns_from_being_compressed(tmp_path):
    parts = [RecordBatches.from_stream(pa.table({"x": [0.5] * rows})) for rows in (1, ROWS)]
    Table("T", RecordBatches.joined(parts)).write(tmp_path / "parts.parquet")
    assert (tmp_path / "parts.parquet").stat().st_size < ROWS
