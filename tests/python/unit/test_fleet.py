"""Fleets: many logs at once give what one reader gives, whatever happens to workers and logs."""

from __future__ import annotations

import contextlib
import gzip
import json
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import mavwire
import numpy as np
import pytest
from dataflash_writer import Log, sample
from mavwire import cli, traffic
from mavwire.dialects.v20 import all as mavlink
from mavwire.fleet import convert, dask_frame, decode, running, to_parquet
from mavwire.fleet.cuts import find_cuts
from mavwire.fleet.grouping import group_bytes, grouped
from mavwire.fleet.places import expand, located, status
from mavwire.fleet.stores import store_of
from mavwire.fleet.tasks import Recipe
from mavwire.logs.conversion import convert as convert_here
from mavwire.logs.conversion import prepare
from mavwire.logs.manifest import Manifest
from unit.link_tools import heartbeat, record

pytest.importorskip("fsspec")
# Dask's own threads end when they like.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

BLOCK = 4 << 20
"""Bytes that the reader reads at once: cuts are at the places it came by between two."""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("small")
    paths = [folder / f"flight{n}.tlog" for n in range(4)]
    for n, path in enumerate(paths):
        traffic.generate(path, 400, seed=n, corruption=0.01 * n)
    return paths


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory, small: list[Path]) -> Path:
    """Three blocks and a bit, with damage in the first."""
    path = tmp_path_factory.mktemp("large") / "large.tlog"
    piece = small[0].read_bytes()
    copies = 3 * BLOCK // len(piece) + 5
    path.write_bytes(piece + b"\xfd\x09 damage" * 50 + piece * copies)
    return path


@pytest.fixture(scope="module")
def inside(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A cluster without processes of its own."""
    distributed = pytest.importorskip("distributed")
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=2, dashboard_address="127.0.0.1:0",
        local_directory=str(tmp_path_factory.mktemp("dask")), set_as_default=False,
    ) as client:  # fmt: skip
        yield client


def rows_of(out: Path) -> dict[str, list[Any]]:
    """The rows of all files of a folder, sorted, by type."""
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    found: dict[str, list[Any]] = {}
    for folder in sorted(path for path in out.iterdir() if path.is_dir()):
        tables = [parquet.read_table(path) for path in sorted(folder.iterdir())]
        rows = pa.concat_tables(tables).to_pylist()
        found[folder.name] = sorted(map(repr, rows))
    return found


def outcome(rows: Any) -> list[tuple[Any, ...]]:
    return [(row.path, row.name, row.rows, row.bad_bytes, row.error) for row in rows]


def test_the_same_files_and_manifest_as_without_a_cluster(tmp_path, small, inside):
    missing, wrong = tmp_path / "none.tlog", tmp_path / "wrong.tlog"
    wrong.write_bytes(b"no log at all" * 100)
    logs = [*small, missing, wrong]
    here = convert_here(logs, tmp_path / "here")
    there = to_parquet(logs, tmp_path / "there", inside)
    assert outcome(here) == outcome(there)
    assert [row.error is None for row in there] == [True] * 4 + [False] * 2
    assert rows_of(tmp_path / "here") == rows_of(tmp_path / "there")
    manifests = [
        json.loads((tmp_path / n / "manifest.json").read_text()) for n in ("here", "there")
    ]
    for manifest in manifests:
        manifest["logs"].sort(key=lambda row: row["path"])
    assert manifests[0] == manifests[1]
    assert sorted(p.name for p in (tmp_path / "there").iterdir() if p.name.startswith(".")) == []


def test_a_second_run_does_what_is_missing(tmp_path, small, inside):
    out = tmp_path / "out"
    to_parquet(small[:2], out, inside)
    rows = to_parquet(small[:3], out, inside)
    assert [row.skipped for row in rows] == [True, True, False]
    (out / "ATTITUDE" / "flight0.parquet").unlink()
    assert [row.skipped for row in to_parquet(small[:3], out, inside)] == [False, True, True]
    assert [row.skipped for row in convert_here(small[:3], out)] == [True] * 3
    convert_here(small[:3], tmp_path / "anew")
    assert rows_of(out) == rows_of(tmp_path / "anew")


def test_a_log_that_changed_leaves_no_file_of_before(tmp_path, small, inside):
    out, log = tmp_path / "out", tmp_path / "one.tlog"
    log.write_bytes(small[0].read_bytes())
    to_parquet(log, out, inside)
    assert (out / "ATTITUDE" / "one.parquet").exists()
    log.write_bytes(record(heartbeat()))
    (row,) = to_parquet(log, out, inside)
    assert row.files == {"HEARTBEAT/one.parquet": 1}
    assert [path.name for path in out.glob("*/*")] == ["one.parquet"]


def test_what_a_manifest_of_others_names_is_not_removed(tmp_path, small, inside):
    out, log, precious = tmp_path / "out", tmp_path / "one.tlog", tmp_path / "a.parquet"
    log.write_bytes(small[0].read_bytes())
    to_parquet(log, out, inside)
    precious.write_text("precious")
    manifest = json.loads((out / "manifest.json").read_text())
    manifest["logs"][0]["files"]["../a.parquet"] = 1
    (out / "manifest.json").write_text(json.dumps(manifest))
    log.write_bytes(record(heartbeat()))
    to_parquet(log, out, inside)
    assert precious.read_text() == "precious"


def test_a_large_log_in_parts_gives_exactly_its_rows(tmp_path, small, large, inside):
    cuts = find_cuts(str(large), BLOCK // 2)
    assert len(cuts) == 3, "not in the first block, where damage is not far enough away"
    assert [start for start, *_ in cuts[1:]] == [end for _, end, _ in cuts[:-1]]
    assert (cuts[0][0], cuts[-1][1]) == (0, large.stat().st_size)
    assert {stamped for *_, stamped in cuts} == {True}
    whole = mavwire.read(large)
    parts = [decode(large, one) for one in cuts]
    for name, table in whole.items():
        for column in table:
            pieces = [part[name][column] for part in parts if name in part]
            np.testing.assert_array_equal(np.concatenate(pieces), table[column])
    (row,) = to_parquet(
        large, tmp_path / "out", inside, types="ATTITUDE", fields="roll", task_bytes=BLOCK // 2
    )
    names = [f"ATTITUDE/large+000{n}.parquet" for n in range(3)]
    assert (list(row.files), row.rows, row.error) == (names, len(whole["ATTITUDE"]), None)
    assert row.bad_bytes == mavwire.open_log(large).info().bad_bytes
    parquet = pytest.importorskip("pyarrow.parquet")
    rolls = [parquet.read_table(tmp_path / "out" / name)["roll"].to_numpy() for name in names]
    np.testing.assert_array_equal(np.concatenate(rolls), whole["ATTITUDE"]["roll"])


@pytest.mark.parametrize("what", ["unknown", "damaged", "compressed", "dataflash"])
def test_a_log_that_cannot_be_cut_exactly_stays_whole(tmp_path, large, what):
    path, content = tmp_path / "log.tlog", large.read_bytes()[: 2 * BLOCK + 100_000]
    if what == "unknown":
        body = heartbeat()[1:7] + (54_321).to_bytes(3, "little") + bytes(9)
        crc = mavlink.x25crc(body + b"\x2a").crc.to_bytes(2, "little")
        content = record(b"\xfd" + body + crc) + content
    elif what == "damaged":
        junk = b"\xfe junk that is no record "
        content = b"".join(content[n : n + 50_000] + junk for n in range(0, len(content), 50_000))
    elif what == "compressed":
        content = gzip.compress(content, 1)
    else:
        content = b"\xa3\x95\x80" + content
    path.write_bytes(content)
    assert find_cuts(str(path), BLOCK // 2) == []


def test_a_dataflash_log_of_any_kind_is_not_searched_for_cuts(tmp_path, monkeypatch):
    log = tmp_path / "flight.log"
    text = "FMT, 200, 19, ABC, QB, TimeUS,Count\n" + "ABC, 1000, 1\n" * 2000
    log.write_text("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n" + text)
    onboard = tmp_path / "flight.BIN"
    onboard.write_bytes(b"begins late" + Path(sample().write(tmp_path / "whole.BIN")).read_bytes())
    monkeypatch.delattr("mavwire.fleet.cuts.summarise")
    assert find_cuts(str(log), 1000) == find_cuts(str(onboard), 100) == []


def test_names_of_parts_do_not_meet_names_of_logs(tmp_path, large, small, inside):
    twin = tmp_path / "large+0000.tlog"
    twin.write_bytes(small[0].read_bytes())
    rows = convert(
        [large, twin], tmp_path / "out", inside, types="HEARTBEAT", task_bytes=BLOCK // 2
    )
    files = [name for row in rows for name in row.files]
    assert len(set(files)) == len(files) == 4


def test_object_stores(small, inside):
    fsspec = pytest.importorskip("fsspec")
    memory = fsspec.filesystem("memory")
    for path in small[:2]:
        memory.pipe_file(f"/fleet-in/{path.name}", path.read_bytes())
    memory.pipe_file("/fleet-in/wrong.tlog", b"wrong")
    try:
        rows = to_parquet("memory://fleet-in/*.tlog", "memory://fleet-out", inside)
        good, damaged, wrong = rows
        assert [row.rows for row in rows] == [400, mavwire.open_log(small[1]).info().messages, 0]
        assert good.error is None and damaged.error is None
        assert str(wrong.error).startswith("no telemetry record found")
        content = memory.cat_file("/fleet-out/ATTITUDE/flight0.parquet")
        assert content[:4] == content[-4:] == b"PAR1"
        again = to_parquet("memory://fleet-in/*.tlog", "memory://fleet-out", inside)
        assert [row.skipped for row in again] == [True, True, False]
        named = to_parquet("memory://fleet-in/flight0.tlog", "memory://fleet-out", inside)
        assert [row.skipped for row in named] == [True], "one log by any spelling of its address"
        gone = to_parquet("memory://fleet-in/none.tlog", "memory://fleet-out", inside)
        assert gone[0].error == "no such file: /fleet-in/none.tlog"
        frame = dask_frame("memory://fleet-in/flight0.tlog", "HEARTBEAT", ["seq"])
        table = mavwire.open_log(small[0])["HEARTBEAT"]
        assert frame.compute(scheduler="sync")["seq"].tolist() == table["seq"].tolist()
    finally:
        memory.rm("/fleet-in", recursive=True)
        memory.rm("/fleet-out", recursive=True)


def test_a_data_frame_of_many_logs(small):
    pytest.importorskip("dask.dataframe")
    frame = dask_frame([str(path) for path in small], "BATTERY_STATUS", task_bytes=1)
    assert frame.npartitions == 4
    found = frame.compute(scheduler="sync")
    tables = [mavwire.open_log(path)["BATTERY_STATUS"] for path in small]
    assert found["sysid"].tolist() == [one for t in tables for one in t["sysid"].tolist()]
    voltages = [one.tolist() for one in found["voltages"]]
    assert voltages == [one for t in tables for one in t["voltages"].tolist()]
    assert found.dtypes.equals(frame.dtypes)
    text = dask_frame(small[0], "STATUSTEXT").compute(scheduler="sync")
    assert text["text"].tolist() == mavwire.open_log(small[0])["STATUSTEXT"]["text"].tolist()
    with pytest.raises(ValueError, match="'rol'"):
        dask_frame(small, "ATTITUDE", "rol")
    with pytest.raises(FileNotFoundError):
        dask_frame("none.tlog", "ATTITUDE")


@pytest.mark.parametrize("enums", [None, "names"])
@pytest.mark.parametrize("units", [None, "si"])
def test_a_data_frame_has_the_types_and_columns_that_it_tells(small, units, enums):
    """HEARTBEAT has enums, PARAM_VALUE texts, BATTERY_STATUS arrays, GPS_RAW_INT invalid values."""
    pytest.importorskip("dask.dataframe")
    types = sorted(mavwire.read(small[0]))
    assert {"BATTERY_STATUS", "GPS_RAW_INT", "HEARTBEAT", "PARAM_VALUE"} < set(types)
    for name in types:
        frame = dask_frame(small[:2], name, units=units, enums=enums)
        found = frame.compute(scheduler="sync")
        assert list(found.dtypes.items()) == list(frame.dtypes.items()), name
    columns = ["voltages", "current_battery", "sysid"]
    frame = dask_frame(small, "BATTERY_STATUS", columns, units=units, enums=enums, task_bytes=1)
    found = frame.compute(scheduler="sync")
    assert list(frame.columns) == list(found.columns) == columns
    assert found.dtypes.equals(frame.dtypes) and found.dtypes["voltages"] == "object"


@pytest.mark.parametrize("task_bytes", [1, 1 << 20])
def test_a_data_frame_of_dataflash_logs_has_the_types_that_it_tells(tmp_path, task_bytes):
    """A binary log tells the columns; in a text one values are missing, and in another columns."""
    pytest.importorskip("dask.dataframe")
    columns = "TimeUS,Count,Half,Text,Many"
    whole = (
        Log().define("TST", "QIfZa", columns, 1).add("TST", 1, 2**32 - 1, 0.1, b"text", bytes(64))
    )
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    text = tmp_path / "1.log"
    text.write_text(
        f"{head}FMT, 9, 150, TST, QIfZ, TimeUS,Count,Half,Text\nTST, x, word, word, b\n"
    )
    fewer = Log().define("TST", "Q", "TimeUS", 1).add("TST", 3).write(tmp_path / "2.BIN")
    logs = [whole.write(tmp_path / "0.BIN"), text, fewer]
    frame = dask_frame(logs, "TST", task_bytes=task_bytes)
    found = frame.compute(scheduler="sync")
    assert list(found.dtypes.items()) == list(frame.dtypes.items())
    assert found["Count"].isna().tolist() == [False, True, True]
    assert found["Count"].iloc[0] == 2**32 - 1
    for name in ("FMT", "TST"):
        frame = dask_frame(text, name)
        assert frame.compute(scheduler="sync").dtypes.equals(frame.dtypes)


def test_a_data_frame_of_a_large_log(large):
    pytest.importorskip("dask.dataframe")
    frame = dask_frame(large, "ATTITUDE", ["roll"], task_bytes=BLOCK // 2)
    assert frame.npartitions == 3
    found = frame["roll"].compute(scheduler="sync").to_numpy()
    np.testing.assert_array_equal(found, mavwire.read(large, "ATTITUDE")["ATTITUDE"]["roll"])


def test_dataflash_logs(tmp_path, inside):
    log = sample().write(tmp_path / "00000001.BIN")
    whole = mavwire.read(log, "IMU")["IMU"]
    tables = decode(log, types="IMU", columns=["timestamp", "AccX"])
    assert list(tables) == ["IMU"] and list(tables["IMU"].columns) == ["timestamp", "AccX"]
    np.testing.assert_array_equal(tables["IMU"]["AccX"], whole["AccX"])
    [row] = to_parquet(log, tmp_path / "out", inside, types="IMU", fields="AccX")
    assert (row.error, row.files) == (None, {"IMU/00000001.parquet": 3})
    pytest.importorskip("dask.dataframe")
    frame = dask_frame(log, "IMU", "AccX").compute(scheduler="sync")
    np.testing.assert_array_equal(frame["AccX"], whole["AccX"])
    with pytest.raises(ValueError, match="'ABC'"):
        dask_frame(log, "ABC")
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"type": ["IMU"]}, "type is the name of one"), ({"columns": 5}, "a name is a text, not 5"),
        ({"task_bytes": 0}, "at least 1, not 0"), ({"task_bytes": "x"}, "at least 1, not 'x'"),
    ]  # fmt: skip
    for arguments, said in wrong:
        with pytest.raises(ValueError, match=said):
            dask_frame(log, **{"type": "IMU", **arguments})


def test_fields_are_those_of_any_log(tmp_path, small, inside):
    log = sample().write(tmp_path / "00000001.BIN")
    here, there = tmp_path / "here", tmp_path / "there"
    logs = [small[0], log]
    alone = convert_here(logs, here, fields="AccX")
    rows = convert(logs, there, inside, fields="AccX")
    assert outcome(rows) == outcome(alone) and not any(row.error for row in rows)
    assert rows_of(there) == rows_of(here)
    with pytest.raises(ValueError, match="no wanted message has a field 'nope'"):
        convert(logs, there, inside, fields=["AccX", "nope"])
    for wrong in ("nope", iter(["nope"])):
        with pytest.raises(ValueError, match="no wanted type has a field 'nope'"):
            convert(log, there, inside, types="IMU", fields=wrong)


def test_fields_of_logs_that_are_not_here_are_not_refused(tmp_path, inside):
    fsspec = pytest.importorskip("fsspec")
    place = "memory://fields/00000001.BIN"
    with fsspec.open(place, "wb") as file:
        file.write(sample().data)
    rows = convert([place, str(tmp_path / "none.BIN")], tmp_path / "out", inside, fields="AccX")
    assert [(row.error is None, row.rows > 0) for row in rows] == [(True, True), (False, False)]


def test_places(tmp_path, small):
    folder = small[0].parent
    assert expand(f"{folder}/*.tlog") == [str(path) for path in small]
    same = [small[0], f"file://{small[0]}", str(small[0]), f"/{small[0]}", f"file:///{small[0]}"]
    assert expand(same) == [str(small[0])]
    assert expand("nosuch://logs/*.tlog") == ["nosuch://logs/*.tlog"], "which its row says"
    fsspec = pytest.importorskip("fsspec")
    for name in ("places/a[1].tlog", "places/a1.tlog"):
        fsspec.filesystem("memory").pipe(name, b"x")
    inside = ["memory:///places/a[1].tlog", "memory://places/a[1].tlog"]
    assert expand(inside) == inside[1:], "one log by two names that look like patterns"
    fsspec.filesystem("memory").pipe("places/b?.tlog", b"x")
    fsspec.filesystem("memory").pipe("places/b1.tlog", b"x")
    assert expand("memory://places/b?.tlog") == ["memory://places/b?.tlog"]
    assert expand("memory:///places/a*") == ["memory://places/a1.tlog", inside[1]]
    assert expand(f"local://{small[0]}") == [str(small[0])]
    odd = tmp_path / "odd[1].tlog"
    odd.write_bytes(b"x" * 10)
    assert expand(odd) == [str(odd)], "a name that looks like a pattern"
    assert expand(tmp_path / "no*.tlog") == [str(tmp_path / "no*.tlog")]
    assert status(str(odd))[0] == 10
    with located(str(odd), (2, 6)) as source:
        assert source == (str(odd), 2, 6)
    for wrong, said in [((5, 20), "ends 10 bytes before"), ((6, 2), "no range"), ((-1, 2), "no r")]:
        with pytest.raises(ValueError, match=said), located(str(odd), wrong):
            pass
    with pytest.raises(IsADirectoryError), located(str(tmp_path), (0, 1)):
        pass


@pytest.mark.skipif(os.name != "posix", reason="no locks on folders")
@pytest.mark.parametrize("convert", [convert_here, partial(convert, workers=1)])
def test_the_folder_of_a_run_that_was_killed_is_removed(tmp_path, small, convert):
    out = tmp_path / "out"
    if convert is not convert_here:
        pytest.importorskip("distributed")
    kept = out / ".mavwire-staging-file"
    foreign = out / ".staging-area"
    foreign.mkdir(parents=True)
    kept.write_bytes(b"no folder")
    for is_done in (False, True):
        (out / ".mavwire-staging-left" / "task-1").mkdir(parents=True)
        assert all(row.skipped == is_done for row in convert(small, out))
        assert list(out.glob(".mavwire-staging-*")) == [kept]
        assert foreign.is_dir()


def test_groups():
    items = [(n, size) for n, size in enumerate([5, 5, 20, 1, 1, 1])]
    assert grouped(items, 10) == [[0, 1], [2], [3, 4, 5]]
    assert grouped([], 10) == []
    assert group_bytes(1_000, 2, 10_000) == 126
    assert group_bytes(10_000_000, 2, 10_000) == 10_000


class Failed:
    """A future of a task that ended its workers."""

    status = "error"

    def __init__(self, key: str) -> None:
        self.key = key

    def exception(self) -> Exception:
        return MemoryError("the worker is gone")


class Doomed:
    """A client whose workers all die."""

    def __init__(self) -> None:
        self.submitted: list[Any] = []

    def submit(self, function: Any, *arguments: Any, pure: bool) -> Failed:
        self.submitted.append(arguments[0])
        return Failed(str(len(self.submitted)))


def test_a_log_that_ends_its_workers_is_a_row_and_its_neighbours_are_tried_alone(tmp_path, small):
    client, store = Doomed(), store_of(str(tmp_path / "out"))
    compression, _, query, how = prepare("parquet", None, None, "all")
    recipe = Recipe(store.root, None, query, "all", "parquet", compression)
    run = running._Run(Manifest(store, how), recipe, 1 << 30, None)
    pieces = run.look({str(p): p.stem for p in small}, {str(p): (1, 0) for p in small})
    run.begin(pieces)
    pending = [run._submit(client, pieces)]
    while pending:
        pending += run._completed(client, pending.pop(0))
    assert client.submitted == [pieces, *([piece] for piece in pieces)]
    assert {row.error for row in run.rows.values()} == {"the worker is gone"}


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"workers": 0}, "^workers must be at least 1, not 0$"),
        ({"format": "xls"}, "format"),
        ({"fields": "rol"}, "'rol'"),
    ],
)
def test_wrong_arguments_are_named_before_anything_begins(tmp_path, small, wrong, said):
    with pytest.raises(ValueError, match=said):
        convert(small, tmp_path / "out", types="ATTITUDE", **wrong)
    assert not (tmp_path / "out").exists()


def test_the_command_says_when_there_is_no_scheduler(tmp_path, small, capsys):
    pytest.importorskip("distributed")
    argv = ["convert", str(small[0]), "-o", str(tmp_path / "out"), "--scheduler", "nonsense://x"]
    assert cli.main(argv) == 1
    assert "nonsense" in capsys.readouterr().err


def test_a_scheduler_behind_a_url(tmp_path, small):
    """WebSockets of Dask go by URLs, which may have a path, and need no port."""
    distributed = pytest.importorskip("distributed")
    options: dict[str, Any] = {
        "processes": False,
        "n_workers": 1,
        "dashboard_address": "127.0.0.1:0",
    }
    with distributed.LocalCluster(protocol="ws://", **options) as cluster:
        rows = to_parquet(small[:1], tmp_path / "out", f"{cluster.scheduler_address}/")
    assert [row.error for row in rows] == [None]


NO_ADDRESSES = [
    "garbage", "tcp://", "tcp://host", "http://x:1", "host:8786x", ":8786", "wss://", 5,
    "tcp://host:99999", "tcp://host:-1", "host:0",
]  # fmt: skip


@pytest.mark.parametrize("client", NO_ADDRESSES)
def test_what_is_no_address_of_a_scheduler_is_said(tmp_path, small, client):
    """By itself Dask fails too, and then waits for what it has begun."""
    pytest.importorskip("distributed")
    with pytest.raises(ValueError, match="address of a scheduler such as tcp://host:8786, not "):
        to_parquet(small, tmp_path / "out", client)


def test_a_command_that_is_told_no_address_ends(tmp_path, small):
    pytest.importorskip("distributed")
    argv = ["convert", str(small[0]), "-o", str(tmp_path / "out"), "--scheduler", "garbage"]
    done = subprocess.run(
        [sys.executable, "-m", "mavwire", *argv],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "'garbage'" in done.stderr


def test_a_scheduler_of_this_process(tmp_path, small):
    distributed = pytest.importorskip("distributed")
    options: dict[str, Any] = {"processes": False, "n_workers": 1, "dashboard_address": None}
    with distributed.LocalCluster(protocol="inproc://", **options) as cluster:
        rows = to_parquet(small[:1], tmp_path / "out", cluster.scheduler_address)
    assert [row.error for row in rows] == [None]


@pytest.fixture(params=["another program", "nothing"])
def listener(request: pytest.FixtureRequest) -> Iterator[str]:
    """The address of a port that is no scheduler's: what it says is junk, or nothing."""
    said = b"HTTP/1.0 200 OK\r\n\r\nhello" * 3 if request.param == "another program" else b""
    with socket.create_server(("127.0.0.1", 0)) as server:
        taken = []

        def answer() -> None:
            with contextlib.suppress(OSError):
                while True:
                    taken.append(server.accept()[0])
                    taken[-1].sendall(said)

        threading.Thread(target=answer, daemon=True).start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
        for one in taken:
            one.close()


def assert_ends(address: str, folder: Path, log: Path) -> None:
    """By itself Dask fails too, and then waits for what it has begun."""
    argv = ["convert", str(log), "-o", str(folder / "out"), "--scheduler", address, "--quiet"]
    done = subprocess.run(
        [sys.executable, "-m", "mavwire", *argv],
        check=False, capture_output=True, text=True, timeout=120,
        env=os.environ | {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "2s"},
    )  # fmt: skip
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert f"no scheduler answers at {address}" in done.stderr
    assert not (folder / "out").exists()


@pytest.mark.parametrize("address", ["tls://127.0.0.1:1", "inproc://1/2/3", "tcp://127.0.0.1:1"])
def test_a_command_whose_scheduler_is_not_there_ends(tmp_path, small, address):
    pytest.importorskip("distributed")
    assert_ends(address, tmp_path, small[0])


def test_a_command_whose_scheduler_is_something_else_ends(tmp_path, small, listener):
    pytest.importorskip("distributed")
    assert_ends(listener, tmp_path, small[0])


def test_the_command_names_its_own_options(tmp_path, small, capsys):
    argv = ["convert", str(small[0]), "-o", str(tmp_path / "out"), "--workers", "0"]
    assert cli.main(argv) == 1
    assert capsys.readouterr().err.endswith("--workers takes a number from 1 on, not 0\n")


def test_the_command_says_what_to_install(tmp_path, small, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "distributed", None)
    argv = ["convert", str(small[0]), "-o", str(tmp_path / "out"), "--workers", "2"]
    assert cli.main(argv) == 1
    assert "pip install 'mavwire[fleet]'" in capsys.readouterr().err
