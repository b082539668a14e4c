"""Runs that are killed double no log, and the next one completes them."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from mavwire import traffic
from mavwire.logs import manifest
from mavwire.logs.conversion import convert
from mavwire.logs.manifest import BEGUN, MANIFEST
from mavwire.logs.store import Store
from unit.link_tools import heartbeat, record

HEARTBEATS = 3

PROGRAM = """
import sys
from mavwire.logs.conversion import convert
convert(sys.argv[2:], sys.argv[1], types=["HEARTBEAT", "ATTITUDE"])
"""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Many small logs, half of them with the names of the other half."""
    folder = tmp_path_factory.mktemp("tiny")
    paths = [folder / part / f"{n}.tlog" for n in range(15) for part in ("one", "two")]
    for part in ("one", "two"):
        (folder / part).mkdir()
    for path in paths:
        path.write_bytes(record(heartbeat()) * HEARTBEATS)
    return paths


def outcome(out: Path) -> dict[str, Any]:
    """The files of a folder, and its manifest."""
    files = {str(one.relative_to(out)): one.read_bytes() for one in out.rglob("*.parquet")}
    others = sorted(
        one.name for one in out.rglob("*") if one.is_file() and one.suffix != ".parquet"
    )
    manifest = json.loads((out / MANIFEST).read_text())
    manifest["logs"].sort(key=lambda row: row["path"])
    return {"files": files, "others": others, "manifest": manifest}


def finished(out: Path) -> int:
    """How many logs have their file now."""
    return len(list(out.glob("HEARTBEAT/*.parquet")))


def start(out: Path, logs: list[Path]) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", PROGRAM, str(out), *map(str, logs)])


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_run_that_is_killed_over_and_over_ends_like_one_that_is_not(tmp_path, tiny):
    out, whole = tmp_path / "out", tmp_path / "whole"
    convert(tiny, whole, types=["HEARTBEAT", "ATTITUDE"])
    kills = 0
    for step in range(6):
        process = start(out, tiny[::-1] if step % 2 else tiny)
        deadline = time.monotonic() + 120
        # Some logs on, wherever in the work that is.
        while (
            process.poll() is None and finished(out) < 3 + step % 9 and time.monotonic() < deadline
        ):
            time.sleep(0.001)
        process.kill()
        kills += process.wait() == -signal.SIGKILL
    assert kills
    rows = convert(tiny, out, types=["HEARTBEAT", "ATTITUDE"])
    assert [row.error for row in rows] == [None] * len(tiny)
    found = outcome(out)
    assert found["others"] == [MANIFEST]
    assert len(found["files"]) == len(tiny)
    assert set(found["files"].values()) == set(outcome(whole)["files"].values())
    assert {row["rows"] for row in found["manifest"]["logs"]} == {HEARTBEATS}
    assert len({row["name"] for row in found["manifest"]["logs"]}) == len(tiny)


def test_a_log_that_was_begun_keeps_its_name(tmp_path):
    """Else the files that a killed run left of it would be those of a log of the same name."""
    out = tmp_path / "out"
    for part in ("one", "two"):
        (tmp_path / part).mkdir()
        traffic.generate(tmp_path / part / "flight.tlog", 100)
    first, second = tmp_path / "one" / "flight.tlog", tmp_path / "two" / "flight.tlog"
    convert([first], out)
    interrupt(out)
    (other,) = convert([second], out)
    assert (other.name, other.error) == ("flight-2", None)
    (again,) = convert([first], out)
    assert (again.name, again.skipped, again.rows) == ("flight", False, 100)


def interrupt(out: Path) -> None:
    """Leaves the manifest as a run that was killed before it had finished any log."""
    manifest = json.loads((out / MANIFEST).read_text())
    for row in manifest["logs"]:
        row |= {"files": {}, "rows": 0, "error": BEGUN}
    (out / MANIFEST).write_text(json.dumps(manifest))


def test_nothing_is_left_of_a_killed_run(tiny, tmp_path):
    """Parts are those of a fleet, which a run with other limits would not replace."""
    rows = convert(tiny[:2], tmp_path)
    interrupt(tmp_path)
    folder = tmp_path / "HEARTBEAT"
    left = [folder / f"{rows[0].name}{end}" for end in ("+0001.parquet", ".parquet.123-4.part")]
    others = [folder / name for name in ("mine.parquet", f"{rows[0].name}.parquet.part")]
    for path in (*left, *others):
        path.write_text("left")
    (again,) = convert(tiny[:1], tmp_path)
    assert (again.error, again.skipped) == (None, False)
    found = {folder / f"{rows[0].name}.parquet", *others}
    assert set(folder.iterdir()) == found, "of the other log nothing is left"


def test_drafts_of_a_killed_run_with_other_options_are_removed(tiny, tmp_path):
    convert(tiny[:1], tmp_path)
    interrupt(tmp_path)
    left = tmp_path / "HEARTBEAT" / "0.parquet.123-4.part"
    left.write_text("left")
    (row,) = convert(tiny[:1], tmp_path, format="csv")
    assert (row.error, row.skipped, left.exists()) == (None, False, False)


@pytest.mark.parametrize("content", ["not a manifest\n", "[]\n", '{"version": 2, "options": {}}\n'])
def test_a_file_of_something_else_is_not_replaced(tmp_path, tiny, content):
    (tmp_path / MANIFEST).write_text(content)
    with pytest.raises(ValueError, match=r"manifest\.json"):
        convert(tiny[:1], tmp_path)
    assert (tmp_path / MANIFEST).read_text() == content


def test_the_manifest_is_written_now_and_then_and_not_for_each_log(tmp_path, tiny, monkeypatch):
    written: list[int] = []
    replace = os.replace

    def count(source: str, target: str) -> None:
        written.append(1)
        replace(source, target)

    monkeypatch.setattr("mavwire.logs.store.os.replace", count)
    monkeypatch.setattr(manifest, "PAUSE", 3600.0)
    convert(tiny[:20], tmp_path / "late")
    assert len(written) == 2, "at the start and at the end"
    monkeypatch.setattr(manifest, "PAUSE", 0.0)
    monkeypatch.setattr(manifest, "SHARE", 0.0)
    convert(tiny[:20], tmp_path / "often")
    assert len(written) == 2 + 21, "at the start and behind each log"
    assert outcome(tmp_path / "often") == outcome(tmp_path / "late")


def test_a_log_that_changed_leaves_no_file_of_before(tmp_path):
    log, out = tmp_path / "one.tlog", tmp_path / "out"
    traffic.generate(log, 100)
    convert([log], out)
    assert (out / "ATTITUDE" / "one.parquet").exists()
    log.write_bytes(record(heartbeat()))
    (row,) = convert([log], out)
    assert row.files == {"HEARTBEAT/one.parquet": 1}
    assert sorted(path.name for path in out.iterdir()) == ["HEARTBEAT", MANIFEST]


@pytest.mark.parametrize("fails", [1, 2])
def test_a_log_that_failed_in_between_leaves_no_file_of_before(tmp_path, fails):
    log, out = tmp_path / "one.tlog", tmp_path / "out"
    traffic.generate(log, 100)
    (first,) = convert([log], out)
    assert len(first.files) > 1
    for n in range(fails):
        log.write_bytes(b"of something else" * (100 + n))
        (row,) = convert([log], out)
        assert row.error is not None and row.files == {}
        assert sorted(row.stale) == sorted(first.files), "nothing intact is removed"
        (stored,) = json.loads((out / MANIFEST).read_text())["logs"]
        assert sorted(stored["stale"]) == sorted(first.files)
    log.unlink()
    (row,) = convert([log], out)
    assert row.error == "No such file or directory" and sorted(row.stale) == sorted(first.files)
    log.write_bytes(record(heartbeat()))
    (row,) = convert([log], out)
    assert (row.files, row.stale) == ({"HEARTBEAT/one.parquet": 1}, [])
    assert sorted(path.name for path in out.iterdir()) == ["HEARTBEAT", MANIFEST]
    assert "stale" not in json.loads((out / MANIFEST).read_text())["logs"][0]


def test_what_is_intact_of_a_damaged_log_takes_the_place_of_all_that_was_there(tmp_path):
    log, out = tmp_path / "one.tlog.gz", tmp_path / "out"
    flight = tmp_path / "flight.tlog"
    traffic.generate(flight, 100)
    log.write_bytes(gzip.compress(flight.read_bytes()))
    (first,) = convert([log], out)
    damaged = gzip.compress(record(heartbeat()) + os.urandom(1 << 16))
    log.write_bytes(damaged[: len(damaged) // 2])
    (row,) = convert([log], out)
    assert row.error is not None and (list(row.files), row.stale) == (["HEARTBEAT/one.parquet"], [])
    assert "HEARTBEAT/one.parquet" in first.files and len(first.files) > 1
    assert [str(path.relative_to(out)) for path in out.glob("*/*")] == list(row.files)


def test_a_log_that_failed_and_came_back_is_converted_again(tmp_path):
    log, out = tmp_path / "one.tlog", tmp_path / "out"
    log.write_bytes(record(heartbeat()))
    (first,) = convert([log], out)
    log.rename(tmp_path / "moved")
    assert convert([log], out)[0].error is not None
    (tmp_path / "moved").rename(log)
    (row,) = convert([log], out)
    assert (row.error, row.skipped, row.files, row.stale) == (None, False, first.files, [])


def test_one_run_at_a_time(tiny, tmp_path):
    pytest.importorskip("fcntl")
    with Store(str(tmp_path)).locked(), pytest.raises(ValueError, match="another conversion"):
        convert(tiny, tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert all(row.error is None for row in convert(tiny, tmp_path))


def test_a_draft_of_the_manifest_is_removed(tiny, tmp_path):
    draft = tmp_path / f"{MANIFEST}.123-0a1b2c3d.part"
    draft.write_text("{")
    convert(tiny[:1], tmp_path)
    assert [path.name for path in tmp_path.iterdir() if path.is_file()] == [MANIFEST]


@pytest.mark.parametrize(("format", "suffix"), [("parquet", ".parquet"), ("csv", ".csv.gz")])
@pytest.mark.parametrize("length", [200, 201, 244, 255])
def test_names_as_long_as_names_are(tiny, tmp_path, length, format, suffix):
    log = tmp_path / f"{'x' * (length - len(suffix))}"
    shutil.copy(tiny[0], log)
    out = tmp_path / "out"
    compression = "gzip" if format == "csv" else None
    (row,) = convert([log], out, format=format, compression=compression)
    (made,) = (out / "HEARTBEAT").iterdir()
    assert (row.error, len(made.name)) == (None, length)
