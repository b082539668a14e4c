"""Lakes: many logs as one table for each message type."""

from __future__ import annotations

import errno
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mavwire
import pytest
from dataflash_writer import Log, flight
from mavwire import cli, traffic
from real_logs import LOGS
from unit.column_tools import log_of_every_type

deltalake = pytest.importorskip("deltalake")
pa = pytest.importorskip("pyarrow")
pl = pytest.importorskip("polars")

from mavwire import lake  # noqa: E402
from mavwire.lake import committing, delta, ledger, planning, rewriting  # noqa: E402


@pytest.fixture
def logs(tmp_path: Path) -> list[Path]:
    folder = tmp_path / "logs"
    folder.mkdir()
    paths = [folder / f"flight{n}.tlog" for n in range(3)]
    for n, path in enumerate(paths):
        traffic.generate(path, 400, seed=n, systems=2)
    return paths


def contents(root: Path) -> dict[str, list[str]]:
    """The rows of all tables, in an order of their own."""
    found = {}
    for name, (path, version) in lake.tables(root).items():
        rows = deltalake.DeltaTable(path, version=version).to_pyarrow_table()
        rows = rows.select(sorted(rows.column_names)).to_pylist()
        if rows:
            found[name] = sorted(map(repr, rows))
    return found


def plain(value: Any) -> Any:
    """A value as a table of a lake has it."""
    if isinstance(value, list):
        return [plain(one) for one in value]
    if isinstance(value, int) and value >= 2**63:
        return value - 2**64
    return value


def check_rows(root: Path, paths: list[Path], **query: Any) -> None:
    """The tables have the rows of these logs, in their order."""
    seen = 0
    for name, (place, version) in lake.tables(root).items():
        frame = deltalake.DeltaTable(place, version=version).to_pyarrow_table()
        for path in paths:
            of_log = frame.filter(pa.compute.equal(frame["log"], str(path)))
            seen += len(of_log)
            tables = mavwire.read(path, **query)
            if name not in tables:
                assert not len(of_log)
                continue
            wanted = tables[name].to_arrow()
            columns = [one for one in wanted.column_names if one in of_log.column_names]
            assert columns == wanted.column_names
            rows = sorted(repr([plain(one) for one in row.values()]) for row in wanted.to_pylist())
            found = of_log.select(columns).to_pylist()
            assert sorted(repr([*row.values()]) for row in found) == rows, name
    assert seen == sum(
        len(table) for path in paths for table in mavwire.read(path, **query).values()
    )


def test_rows_are_those_of_the_logs(logs: list[Path], tmp_path: Path) -> None:
    every = tmp_path / "logs" / "every.tlog"
    log_of_every_type(every)
    rows = lake.ingest([*logs, every], tmp_path / "lake")
    assert [row.error for row in rows] == [None] * 4
    check_rows(tmp_path / "lake", [*logs, every])


def test_rows_of_all_kinds_of_logs(tmp_path: Path) -> None:
    paths = sorted(
        path for path in LOGS.glob("*") if path.suffix in (".tlog", ".raw", ".BIN", ".log")
    )
    if not paths:
        pytest.skip("set MAVWIRE_LOGS to a directory of logs")
    rows = lake.ingest(paths, tmp_path / "lake")
    assert not [row.error for row in rows if row.error]
    total = sum(
        pl.scan_delta(path, version=version).select(pl.len()).collect().item()
        for path, version in lake.tables(tmp_path / "lake").values()
    )
    assert total == sum(row.rows for row in rows)
    check_rows(
        tmp_path / "lake",
        [path for path in paths if path.stat().st_size < 400_000 and path.suffix == ".tlog"],
    )


def test_a_second_run_adds_only_new_logs(logs: list[Path], tmp_path: Path) -> None:
    root = tmp_path / "lake"
    lake.ingest(logs[:2], root)
    versions = lake.tables(root)
    rows = lake.ingest(logs[:2], root)
    assert all(row.skipped for row in rows)
    assert lake.tables(root) == versions
    rows = lake.ingest(logs, root)
    assert [row.skipped for row in rows] == [True, True, False]
    check_rows(root, logs)


def test_a_changed_log_replaces_its_rows(logs: list[Path], tmp_path: Path) -> None:
    root = tmp_path / "lake"
    lake.ingest(logs, root)
    traffic.generate(logs[1], 300, seed=9)
    os.utime(logs[2], ns=(1, 1))  # the same bytes
    rows = lake.ingest(logs, root)
    assert [row.skipped for row in rows] == [True, False, True]
    check_rows(root, logs)
    assert all(row.skipped for row in lake.ingest(logs, root))
    assert contents(root) == contents_of(logs, tmp_path / "other")


def contents_of(paths: list[Path], root: Path, **options: Any) -> dict[str, list[str]]:
    """The rows of a lake that is made in one go."""
    lake.ingest(paths, root, **options)
    return contents(root)


def test_a_log_that_cannot_be_read_any_more_keeps_its_rows(
    logs: list[Path], tmp_path: Path
) -> None:
    root = tmp_path / "lake"
    lake.ingest(logs, root)
    before = contents(root)
    logs[0].write_bytes(b"x" * 1000)
    for _ in range(2):
        rows = lake.ingest(logs, root)
        assert rows[0].error and not rows[0].skipped
        assert contents(root) == before
    logs[0].unlink()
    assert "No such file" in str(lake.ingest(logs, root)[0].error)


def test_numbers_have_signs(tmp_path: Path) -> None:
    root, path = tmp_path / "lake", tmp_path / "every.tlog"
    log_of_every_type(path)
    lake.ingest([path], root)
    schema = {one.name: one for one in deltalake.DeltaTable(root / "SYS_STATUS").schema().fields}
    assert schema["sysid"].type.type == "short"
    assert schema["onboard_control_sensors_present"].type.type == "long"
    assert schema["voltage_battery"].metadata["unit"] == "mV"
    described = json.loads(deltalake.DeltaTable(root / "SYSTEM_TIME").schema().to_json())
    kinds = {one["name"]: one["type"] for one in described["fields"]}
    assert kinds["time_unix_usec"] == "long"
    assert kinds["day"] == "date"


def test_dataflash_columns_of_other_types(tmp_path: Path) -> None:
    """Numbers become floats where others are; what has no common type gets an underscore."""
    kinds = {"one": ("Qf", 1.5), "two": ("QI", 7), "three": ("Qn", "text"), "four": ("QZ", "more")}
    paths = []
    for name, (kind, value) in kinds.items():
        path = tmp_path / f"{name}.BIN"
        Log().define("ABC", kind, "TimeUS,X").add("ABC", 1000, value).write(path)
        paths.append(path)
        rows = lake.ingest(path, tmp_path / "lake")
        assert rows[0].error is None
    table = pl.scan_delta(str(tmp_path / "lake" / "ABC")).sort("log").collect()
    found = {Path(row["log"]).stem: (row["X"], row["X_"]) for row in table.to_dicts()}
    assert found == {
        "one": (1.5, None),
        "two": (7.0, None),
        "three": (None, "text"),
        "four": (None, "more"),
    }
    lake.compact(tmp_path / "lake")
    assert pl.scan_delta(str(tmp_path / "lake" / "ABC")).sort("log").collect().equals(table)


def test_one_run_with_columns_of_other_types(tmp_path: Path) -> None:
    paths = []
    for name, kind, value in (("one", "Qf", 1.5), ("two", "Qn", "text")):
        paths.append(tmp_path / f"{name}.BIN")
        Log().define("ABC", kind, "TimeUS,X").add("ABC", 1000, value).write(paths[-1])
    assert not [row.error for row in lake.ingest(paths, tmp_path / "lake") if row.error]
    table = pl.scan_delta(str(tmp_path / "lake" / "ABC")).collect()
    assert table.height == 2 and table["X"].null_count() == table["X_"].null_count() == 1


def test_partitions(logs: list[Path], tmp_path: Path) -> None:
    flight().write(tmp_path / "logs" / "00000042.BIN")
    every = [*logs, tmp_path / "logs" / "00000042.BIN"]
    whole = {name: len(rows) for name, rows in contents_of(every, tmp_path / "lake").items()}
    parts = {
        path.parent.relative_to(tmp_path / "lake")
        for path in (tmp_path / "lake").rglob("*.parquet")
    }
    assert Path("HEARTBEAT/day=2024-01-01/vehicle=1") in parts
    for names in ((), ("year", "vehicle"), ("month",)):
        other = contents_of(every, tmp_path / f"by-{'-'.join(names)}", partition=names)
        assert {name: len(rows) for name, rows in other.items()} == whole
    with pytest.raises(ValueError, match="a partition is one of day"):
        lake.ingest(logs, tmp_path / "lake", partition=["hour"])


def test_statistics_tell_which_files_have_a_log(logs: list[Path], tmp_path: Path) -> None:
    for path in logs:
        lake.ingest(path, tmp_path / "lake")
    table = deltalake.DeltaTable(tmp_path / "lake" / "ATTITUDE")
    for path in logs:
        assert any(committing._may_have(file["logs"], str(path)) for file in delta.files_of(table))
        assert not any(committing._may_have(file["logs"], "/a") for file in delta.files_of(table))
    stats = table.get_add_actions(flatten=True)
    assert stats["min.timestamp"].to_pylist()[0].year == 2024
    assert sum(stats["num_records"].to_pylist()) == table.to_pyarrow_table().num_rows


def test_other_options_and_other_folders_are_refused(logs: list[Path], tmp_path: Path) -> None:
    root = tmp_path / "lake"
    lake.ingest(logs, root, units="si")
    with pytest.raises(ValueError, match=r"other options \(si True"):
        lake.ingest(logs, root)
    with pytest.raises(ValueError, match="is no lake"):
        lake.tables(tmp_path)
    with pytest.raises(ValueError, match="is no lake"):
        lake.compact(tmp_path / "logs")
    with pytest.raises(ValueError, match="a lake is a folder"):
        lake.ingest(logs, "s3://bucket/lake")
    (root / ledger.LEDGER).write_text("{}")
    with pytest.raises(ValueError, match="is no ledger"):
        lake.ingest(logs, root, units="si")


def test_shards_are_parts_of_one_lake(logs: list[Path], tmp_path: Path) -> None:
    expected = contents_of(logs, tmp_path / "one")
    rows = [
        row
        for number in (1, 2, 3)
        for row in lake.ingest(logs, tmp_path / "lake", shard=(number, 3))
    ]
    assert sorted(row.path for row in rows) == sorted(map(str, logs))
    assert contents(tmp_path / "lake") == expected
    assert planning.of_shard(["a", "b"], None) == ["a", "b"]
    with pytest.raises(ValueError, match="a shard is one of 1/3 to 3/3, not 4/3"):
        lake.ingest(logs, tmp_path / "lake", shard=(4, 3))


def test_shards_may_run_at_the_same_time(logs: list[Path], tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "mavwire",
        "ingest",
        *map(str, logs),
        "-o",
        str(tmp_path / "lake"),
    ]
    jobs = [subprocess.Popen([*command, "--quiet", "--shard", f"{one}/4"]) for one in range(1, 5)]
    assert [job.wait(timeout=120) for job in jobs] == [0] * 4
    assert contents(tmp_path / "lake") == contents_of(logs, tmp_path / "one")


def test_processes_make_the_same_lake(logs: list[Path], tmp_path: Path) -> None:
    expected = contents_of(logs, tmp_path / "one")
    assert contents_of(logs, tmp_path / "two", workers=2, part_bytes=10_000) == expected


def test_compaction_keeps_the_rows(logs: list[Path], tmp_path: Path) -> None:
    root = tmp_path / "lake"
    for path in logs:
        lake.ingest(path, root)
    before = contents(root)
    files = len(list(root.glob("*/day=*/*/*.parquet")))
    merged = lake.compact(root, retention_hours=0)
    assert sum(merged.values()) and contents(root) == before
    assert len(list(root.glob("*/day=*/*/*.parquet"))) < files / 2
    assert not lake.compact(root)
    traffic.generate(logs[0], 200, seed=7)
    lake.ingest(logs, root)
    assert contents(root) == contents_of(logs, tmp_path / "other")


STEPS = (
    (committing.os, "rename"),
    (committing.os, "replace"),
    (committing.os, "remove"),
    (committing, "write_file"),
    (committing.shutil, "rmtree"),
    (delta, "apply"),
    (ledger, "write_file"),
)
"""What a commit consists of."""


class Killed(BaseException):
    """As if the process had ended."""


@pytest.fixture
def interrupted(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Has a run end in front of its n-th step, or behind it; whether it came so far."""

    def run(work: Any, last: int, behind: bool) -> bool:
        count = 0
        with monkeypatch.context() as patched:
            for module, name in STEPS:
                original = getattr(module, name)

                def step(*args: Any, original: Any = original, **options: Any) -> Any:
                    nonlocal count
                    count += 1
                    if count > last and not behind:
                        raise Killed
                    done = original(*args, **options)
                    if count > last:
                        raise Killed
                    return done

                patched.setattr(module, name, step)
            try:
                work()
            except Killed:
                return True
        return False

    yield run


@pytest.mark.parametrize("behind", [False, True])
def test_each_step_of_a_commit_may_be_the_last(
    logs: list[Path], tmp_path: Path, interrupted: Any, behind: bool
) -> None:
    types = ["ATTITUDE", "HEARTBEAT"]
    base, root = tmp_path / "base", tmp_path / "lake"
    before = contents_of(logs[:2], base, types=types)
    traffic.generate(logs[1], 200, seed=7)
    after = contents_of(logs, tmp_path / "other", types=types)
    for last in range(1000):
        shutil.rmtree(root, ignore_errors=True)
        shutil.copytree(base, root)
        if not interrupted(lambda: lake.ingest(logs, root, types=types), last, behind):
            break
        assert contents(root) in (before, after)
        lake.ingest(logs, root, types=types)
        assert contents(root) == after
        assert not [name for name in os.listdir(root) if name.startswith(".")]
    assert last > 10


def test_a_large_log_has_files_of_its_own(
    logs: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from mavwire.lake import doing

    expected = contents_of(logs, tmp_path / "one")
    monkeypatch.setattr(doing, "LARGE_BYTES", 1)
    monkeypatch.setattr(doing, "GROUP_ROWS", 10)
    monkeypatch.setattr(doing, "FILE_BYTES", 2000)
    monkeypatch.setattr(doing, "OPEN_FILES", 3)
    assert contents_of(logs, tmp_path / "two") == expected
    monkeypatch.setattr(doing, "LARGE_BYTES", 1 << 30)
    monkeypatch.setattr(doing, "WAITING_BYTES", 1)
    monkeypatch.setattr(rewriting, "FILE_BYTES", 2000)
    assert contents_of(logs, tmp_path / "three") == expected


def test_a_full_disk_ends_a_run_and_the_next_one_adds_all(
    logs: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from mavwire.lake import doing

    class Full:
        def __init__(self, path: str) -> None:
            self._path = path

        def write(self, pieces: Any) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), self._path)

    with monkeypatch.context() as patched:
        patched.setattr(doing, "GROUP_ROWS", 1)
        patched.setattr(doing, "LakeFile", Full)
        with pytest.raises(OSError, match="No space left"):
            lake.ingest(logs, tmp_path / "lake")
        assert not [*(tmp_path / "lake").iterdir()]
    assert contents_of(logs, tmp_path / "lake") == contents_of(logs, tmp_path / "other")


def test_without_deltalake_no_log_is_read(
    logs: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "deltalake", None)
    with pytest.raises(ImportError, match=r"deltalake is needed: pip install 'mavwire\[lake\]'"):
        lake.ingest(logs, tmp_path / "lake")
    assert not (tmp_path / "lake").exists()


def test_command(logs: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = str(tmp_path / "lake")
    assert cli.main(["ingest", *map(str, logs), "-o", root]) == 0
    assert "flight0.tlog: added, 400 rows\n" in capsys.readouterr().out
    assert cli.main(["ingest", f"{logs[0].parent}/*.tlog", "-o", root, "--compact"]) == 0
    out = capsys.readouterr().out
    assert f"{root}: 3 logs were added before\n" in out and "merged" in out
    assert "flight0" not in out
    bad = tmp_path / "notes.txt"
    bad.write_text("no log")
    assert cli.main(["ingest", str(bad), "-o", root, "--shard", "1/1"]) == 1
    assert "1 of 1 logs could not be read" in capsys.readouterr().err
    for wrong in (["--shard", "1"], ["--shard", "2/1"], ["--workers", "0"], ["--partition", "x"]):
        assert cli.main(["ingest", str(bad), "-o", root, *wrong]) == 1
    assert cli.main(["ingest", "-o", root]) == 1
    assert "name logs, or --compact" in capsys.readouterr().err
