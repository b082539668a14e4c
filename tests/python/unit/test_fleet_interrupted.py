"""Runs of a fleet whose client is killed: the next run, of whatever kind, loses and doubles nothing."""

from __future__ import annotations

import errno
import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest
from mavwire import traffic
from mavwire.dialects import UPSTREAM
from mavwire.fleet import convert as convert_fleet
from mavwire.fleet import running, stores
from mavwire.fleet.stores import Folder, store_of
from mavwire.fleet.tasks import Recipe
from mavwire.logs import manifest
from mavwire.logs.conversion import convert, prepare
from mavwire.logs.manifest import MANIFEST, Converted, Manifest
from mavwire.logs.store import Store
from unit.link_tools import heartbeat, record

TASK = 2 << 20


class Killed(BaseException):
    """The client is gone."""


class Done:
    """A future of a task that is done at once."""

    status = "finished"

    def __init__(self, key: str, found: Any) -> None:
        self.key = key
        self._found = found

    def result(self) -> Any:
        return self._found


class Dies:
    """A client, and the future of a task that ended the workers which had it."""

    status, key = "error", "task"

    def submit(self, *arguments: Any, pure: bool) -> Dies:
        return self

    def exception(self) -> Exception:
        return RuntimeError("no worker is left")


class Here:
    """A client that works at once, and is killed before a task."""

    def __init__(self, tasks: int) -> None:
        self.left = tasks

    def submit(self, function: Any, *arguments: Any, pure: bool) -> Done:
        self.left -= 1
        if self.left < 0:
            raise Killed
        return Done(f"task {self.left}", function(*arguments))


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of three parts, nearly all of it ATTITUDE."""
    folder = tmp_path_factory.mktemp("large")
    traffic.generate(folder / "piece.tlog", 3000)
    piece = (folder / "piece.tlog").read_bytes()
    path = folder / "large.tlog"
    path.write_bytes(piece * (13 * TASK // 2 // len(piece)))
    return path


@pytest.fixture
def small(tmp_path: Path) -> list[Path]:
    path = tmp_path / "small.tlog"
    path.write_bytes(record(heartbeat()) * 3)
    return [path]


@pytest.fixture(scope="module")
def inside(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A cluster without processes of its own."""
    distributed = pytest.importorskip("distributed")
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0",
        local_directory=str(tmp_path_factory.mktemp("dask")), set_as_default=False,
    ) as client:  # fmt: skip
        yield client


def killed_after(tasks: int, out: str, logs: list[Path], task_bytes: int = TASK) -> None:
    """A run of a fleet whose client is killed when it has handed out some tasks."""
    types = ["HEARTBEAT", "ATTITUDE"]
    compression, _, query, how = prepare("parquet", None, types, UPSTREAM)
    store = store_of(out)
    made = Manifest(store, how, lambda path: (os.path.getsize(path), os.stat(path).st_mtime_ns))
    run = running._Run(
        made, Recipe(out, None, query, UPSTREAM, "parquet", compression), task_bytes, None
    )
    paths = list(map(str, logs))
    todo = run.look(
        made.names(paths),
        {path: (os.path.getsize(path), os.stat(path).st_mtime_ns) for path in paths},
    )
    run.begin(todo)
    client = Here(tasks)
    with pytest.raises(Killed):
        for piece in todo:
            pending = [run._look_for_cuts(client, piece)]
            while pending:
                pending += run._completed(client, pending.pop(0))


def files_of(out: Path) -> set[str]:
    return {str(path.relative_to(out)) for path in out.glob("*/*")}


def test_parts_that_were_published_are_not_there_beside_the_whole_log(tmp_path, large):
    out = tmp_path / "out"
    killed_after(3, str(out), [large])
    assert {"ATTITUDE/large+0000.parquet", "ATTITUDE/large+0001.parquet"} <= files_of(out)
    (row,) = convert([large], out, types=["HEARTBEAT", "ATTITUDE"])
    assert row.error is None
    assert files_of(out) == set(row.files) == {
        "ATTITUDE/large.parquet", "HEARTBEAT/large.parquet"
    }  # fmt: skip


def test_a_log_that_changed_meanwhile_leaves_no_file_of_before(tmp_path, large):
    out, log = tmp_path / "out", tmp_path / "one.tlog"
    shutil.copy(large, log)
    killed_after(3, str(out), [log])
    assert len(files_of(out)) == 4
    log.write_bytes(record(heartbeat()))
    killed_after(0, str(out), [log])
    (row,) = convert([log], out, types=["HEARTBEAT", "ATTITUDE"])
    assert files_of(out) == set(row.files) == {"HEARTBEAT/one.parquet"}


def test_a_fleet_that_cuts_otherwise_goes_on_too(tmp_path, large, inside):
    out = tmp_path / "out"
    killed_after(3, str(out), [large])
    (row,) = convert_fleet(large, out, inside, types=["HEARTBEAT", "ATTITUDE"], task_bytes=2 * TASK)
    assert files_of(out) == set(row.files)
    assert {"ATTITUDE/large+0000.parquet", "ATTITUDE/large+0001.parquet"} <= set(row.files)
    assert row.rows == convert([large], tmp_path / "whole", types=["HEARTBEAT", "ATTITUDE"])[0].rows


def test_a_log_that_was_begun_keeps_its_name(tmp_path, large):
    out, other = tmp_path / "out", tmp_path / "large.tlog"
    shutil.copy(large, other)
    killed_after(6, str(out), [large, other])
    assert "ATTITUDE/large-2+0000.parquet" in files_of(out)
    (row,) = convert([other], out, types=["HEARTBEAT", "ATTITUDE"])
    assert row.name == "large-2" and "ATTITUDE/large-2+0000.parquet" not in files_of(out)


def test_what_nobody_began_stays(tmp_path, large):
    """Files of other runs and formats."""
    out = tmp_path / "out"
    (out / "ATTITUDE").mkdir(parents=True)
    for name in ("large+0000.csv", "other+0000.parquet"):
        (out / "ATTITUDE" / name).write_text("of someone else")
    killed_after(3, str(out), [large])
    convert([large], out, types=["HEARTBEAT", "ATTITUDE"])
    assert {
        "ATTITUDE/large+0000.csv", "ATTITUDE/other+0000.parquet"
    } < files_of(out)  # fmt: skip


TYPES = ["ATTITUDE", "GPS_RAW_INT", "HEARTBEAT"]


@pytest.fixture
def mixed(tmp_path: Path) -> Path:
    path = tmp_path / "mixed.tlog"
    traffic.generate(path, 300)
    return path


def test_half_of_a_log_is_not_published(tmp_path, mixed, inside):
    out = tmp_path / "out"
    out.mkdir()
    in_the_way = out / "HEARTBEAT"
    in_the_way.write_text("no folder")
    (row,) = convert_fleet(mixed, out, inside, types=TYPES)
    assert "HEARTBEAT" in row.error and (row.files, row.rows, row.stale) == ({}, 0, [])
    assert files_of(out) == set()
    in_the_way.unlink()
    (row,) = convert_fleet(mixed, out, inside, types=TYPES)
    assert row.error is None and files_of(out) == set(row.files)
    assert {name.split("/")[0] for name in row.files} == set(TYPES)


def test_a_file_that_cannot_have_its_name_leaves_no_folders(tmp_path, mixed, inside):
    out = tmp_path / "out"
    in_the_way = out / "HEARTBEAT" / "mixed.parquet"
    in_the_way.mkdir(parents=True)
    (row,) = convert_fleet(mixed, out, inside, types=TYPES)
    assert str(row.error).startswith(f"{in_the_way}: "), "not the name that it had before"
    assert sorted(path.name for path in out.iterdir()) == ["HEARTBEAT", MANIFEST]


def test_a_file_that_cannot_be_moved_leaves_no_folder(tmp_path, monkeypatch):
    def refuse(draft: str, place: str) -> None:
        raise OSError(errno.EIO, "Input/output error", draft, None, place)

    monkeypatch.setattr("os.replace", refuse)
    out = tmp_path / "out"
    with pytest.raises(OSError) as caught:
        Folder(str(out)).publish(str(tmp_path / "draft"), "ATTITUDE/a.parquet")
    assert caught.value.filename == str(out / "ATTITUDE" / "a.parquet")
    assert not list(out.rglob("*"))


@pytest.mark.parametrize("beside", ["", "-other"])
def test_a_file_that_cannot_be_written_is_called_as_it_would_be(
    beside, tmp_path, mixed, inside, monkeypatch
):
    """Another one, beside those that are not complete, is called as it is."""
    names = []

    def refuse(log, query, out, file, format, compression):
        names.append(f"{out}{beside}/ATTITUDE/{file}")
        raise OSError(errno.ENOSPC, "No space left on device", names[0])

    monkeypatch.setattr("mavwire.logs.conversion.Converter", refuse)
    (row,) = convert_fleet(mixed, tmp_path / "out", inside, types=TYPES)
    table = names[0] if beside else tmp_path / "out" / "ATTITUDE" / "mixed.parquet"
    assert row.error == f"{table}: No space left on device"


def test_a_folder_that_another_process_removes_is_made_again(tmp_path, monkeypatch):
    store = Folder(str(tmp_path / "out"))
    draft = tmp_path / "draft"
    draft.write_text("table")
    makedirs, made = os.makedirs, []

    def once_in_vain(folder, exist_ok):
        made.append(folder)
        if len(made) > 1:
            makedirs(folder, exist_ok=exist_ok)

    monkeypatch.setattr(os, "makedirs", once_in_vain)
    store.publish(str(draft), "ATTITUDE/mixed.parquet")
    assert (tmp_path / "out/ATTITUDE/mixed.parquet").read_text() == "table"


@pytest.mark.parametrize("remote", [False, True])
def test_what_a_task_that_died_published_is_removed(tmp_path, mixed, remote):
    fsspec = pytest.importorskip("fsspec")
    out = "memory://fleet-died" if remote else str(tmp_path / "out")
    compression, _, query, how = prepare("parquet", None, TYPES, UPSTREAM)
    store = store_of(out)
    made = Manifest(store, how, lambda path: (1, 1))
    recipe = Recipe(out, None, query, UPSTREAM, "parquet", compression)
    run = running._Run(made, recipe, TASK, None)
    (todo,) = run.look({str(mixed): "mixed"}, {str(mixed): (1, 1)})
    run.begin([todo])
    try:
        assert list(store.names()) == [MANIFEST]
        run._submit(Dies(), [todo])
        for name in ("mixed", "other"):
            (tmp_path / "draft").write_text(name)
            store.publish(str(tmp_path / "draft"), f"ATTITUDE/{name}.parquet")
        assert run._completed(None, Dies()) == []
        assert set(store.names()) == {"ATTITUDE/other.parquet", MANIFEST}
        assert run.rows[str(mixed)].error == "no worker is left"
    finally:
        if remote:
            fsspec.filesystem("memory").rm("/fleet-died", recursive=True)


def test_one_run_at_a_time(tmp_path, small, inside):
    """A second one would take what the first is about for what a killed run left."""
    pytest.importorskip("fcntl")
    out = tmp_path / "out"
    with Store(str(out)).locked(), pytest.raises(ValueError, match="another conversion"):
        convert_fleet(small, out, inside)
    assert not out.exists()
    refused = []

    def second(done: int, logs: int) -> None:
        with pytest.raises(ValueError, match="another conversion"):
            convert(small, out)
        refused.append(done)

    (row,) = convert_fleet(small, out, inside, progress=second)
    assert refused == [1] and row.error is None
    assert files_of(out) == set(row.files)
    (again,) = convert(small, out)
    assert again.skipped


def test_on_an_object_store(tmp_path, large):
    fsspec = pytest.importorskip("fsspec")
    memory = fsspec.filesystem("memory")
    url = "memory://fleet-interrupted"
    try:
        killed_after(3, url, [large])
        how = json.loads(memory.cat_file(f"/fleet-interrupted/{MANIFEST}"))["options"]
        made = Manifest(store_of(url), how)
        made.add(Converted(str(large), "large", files={"ATTITUDE/large.parquet": 1}))
        made.store()
        left = [path.rpartition("/")[2] for path in memory.find("/fleet-interrupted")]
        assert left == [MANIFEST]
    finally:
        memory.rm("/fleet-interrupted", recursive=True)


def test_a_place_of_fsspec_that_is_no_object_store(tmp_path, mixed, inside, monkeypatch):
    """A file has its name when it is complete, there too."""
    local = pytest.importorskip("fsspec.implementations.local").LocalFileSystem
    url = f"local://{tmp_path / 'out'}"
    (row,) = convert_fleet(mixed, url, inside, types=TYPES)
    assert row.error is None and files_of(tmp_path / "out") == set(row.files)
    store = store_of(url)
    before = store.read(MANIFEST)

    def half(self: Any, path: str, value: bytes, **_: Any) -> None:
        Path(path).write_bytes(value[:10])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(local, "pipe_file", half)
    with pytest.raises(OSError, match="No space"):
        store.write(MANIFEST, b"anything else")
    assert store.read(MANIFEST) == before
    assert {path.name for path in (tmp_path / "out").iterdir() if path.is_file()} == {MANIFEST}
    left = tmp_path / "out" / "ATTITUDE" / "mixed.parquet.12-0a1b2c3d.part"
    left.write_bytes(b"of a run that was killed")
    store.remove_drafts()
    assert not left.exists()


def test_a_place_that_moves_nothing_onto_a_file(tmp_path, monkeypatch):
    local = pytest.importorskip("fsspec.implementations.local").LocalFileSystem
    move = local.mv

    def careful(self: Any, source: str, target: str, **how: Any) -> None:
        if os.path.exists(target):
            raise FileExistsError(target)
        move(self, source, target, **how)

    monkeypatch.setattr(local, "mv", careful)
    store = store_of(f"local://{tmp_path}")
    for content in (b"one", b"two"):
        store.write(MANIFEST, content)
        assert store.read(MANIFEST) == content
    assert [path.name for path in tmp_path.iterdir()] == [MANIFEST]


def test_the_manifest_is_written_now_and_then_to_an_object_store(monkeypatch):
    fsspec = pytest.importorskip("fsspec")
    memory = fsspec.filesystem("memory")
    monkeypatch.setattr(manifest, "PAUSE", 3600.0)
    store = stores.Remote("memory://fleet-manifest")
    made = Manifest(store, {"format": "parquet"}, lambda path: (1, 1))
    try:
        made.begin({f"/{n}.tlog": str(n) for n in range(9)})
        written = memory.cat_file(f"/fleet-manifest/{MANIFEST}")
        for n in range(9):
            made.add(Converted(f"/{n}.tlog", str(n), 1, 1))
        assert memory.cat_file(f"/fleet-manifest/{MANIFEST}") == written
        made.close()
        assert [row["error"] for row in stored(memory, MANIFEST)] == [None] * 9
    finally:
        memory.rm("/fleet-manifest", recursive=True)


def stored(memory: Any, name: str) -> Any:
    return json.loads(memory.cat_file(f"/fleet-manifest/{name}"))["logs"]


@pytest.mark.parametrize("stale", ["x", [7], {}])
def test_stale_files_of_a_manifest_of_others(tmp_path, stale):
    assert_no_manifest(tmp_path, {"stale": stale})


def assert_no_manifest(out: Path, more: dict[str, Any]) -> None:
    row = {"path": "x", "name": "x", "size": 1, "mtime_ns": 1, "rows": 1, "bad_bytes": 0}
    log = {**row, "files": {}, "error": manifest.BEGUN, **more}
    content = {"version": 2, "options": {}, "logs": [log]}
    (out / MANIFEST).write_text(json.dumps(content))
    with pytest.raises(ValueError, match="is no manifest"):
        convert([], out)


def test_names_of_many_logs_of_one_name_are_found_without_going_through_them_again():
    class Counting(set[str]):
        asked = 0

        def __contains__(self, name: object) -> bool:
            Counting.asked += 1
            return super().__contains__(name)

    taken = Counting({"flight", "flight-3"})
    names = manifest._names([f"/{n}/flight.tlog" for n in range(2000)], {}, taken)
    assert len(set(names.values())) == 2000
    assert list(names.values())[:3] == ["flight-2", "flight-4", "flight-5"]
    assert Counting.asked <= 4 * 2000
