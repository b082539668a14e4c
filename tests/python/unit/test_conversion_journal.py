"""Runs that are killed lose no log that was finished and double none."""

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
from mavwire._native import draft_stem
from mavwire.logs import journal
from mavwire.logs.conversion import convert
from mavwire.logs.manifest import JOURNAL, MANIFEST, Manifest
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


def lines(out: Path) -> int:
    """How many lines the journal has now."""
    try:
        return (out / JOURNAL).read_bytes().count(b"\n")
    except FileNotFoundError:
        return 0


def start(out: Path, logs: list[Path]) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", PROGRAM, str(out), *map(str, logs)])


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_run_that_is_killed_over_and_over_ends_like_one_that_is_not(tmp_path, tiny):
    out, whole = tmp_path / "out", tmp_path / "whole"
    convert(tiny, whole, types=["HEARTBEAT", "ATTITUDE"])
    done, kills = 0, 0
    for step in range(2 * len(tiny)):
        process = start(out, tiny[::-1] if step % 2 else tiny)
        deadline = time.monotonic() + 120
        # Some lines on, wherever in the work that is.
        while process.poll() is None and lines(out) < 7 + step % 6 and time.monotonic() < deadline:
            time.sleep(0.001)
        process.kill()
        kills += process.wait() == -signal.SIGKILL
        known = {row["path"]: row for row in rows_of(out)}
        finished = [row for row in known.values() if row["error"] is None]
        assert len(finished) >= done, "a finished log is lost"
        done = len(finished)
        if done == len(tiny):
            break
    assert kills
    rows = convert(tiny, out, types=["HEARTBEAT", "ATTITUDE"])
    assert sum(row.skipped for row in rows) >= done
    named = {path: row["name"] for path, row in by_path(whole).items()}
    found = outcome(out)
    assert found["others"] == [MANIFEST]
    assert len(found["files"]) == len(tiny) == len(set(named.values()))
    assert set(found["files"].values()) == set(outcome(whole)["files"].values())
    assert {row["rows"] for row in found["manifest"]["logs"]} == {HEARTBEATS}
    assert len({row["name"] for row in found["manifest"]["logs"]}) == len(tiny)


def rows_of(out: Path) -> list[dict[str, Any]]:
    """What manifest and journal of a killed run say together."""
    rows = json.loads((out / MANIFEST).read_text())["logs"] if (out / MANIFEST).exists() else []
    text = (out / JOURNAL).read_text() if (out / JOURNAL).exists() else ""
    every = rows + [json.loads(line) for line in text.split("\n")[1:-1]]
    return list({row["path"]: row for row in every}.values())


def by_path(out: Path) -> dict[str, dict[str, Any]]:
    return {row["path"]: row for row in rows_of(out)}


def test_a_log_that_was_begun_keeps_its_name(tmp_path):
    """Else the files that a killed run left of it would be those of a log of the same name."""
    out = tmp_path / "out"
    for part in ("one", "two"):
        (tmp_path / part).mkdir()
        traffic.generate(tmp_path / part / "flight.tlog", 100)
    first, second = tmp_path / "one" / "flight.tlog", tmp_path / "two" / "flight.tlog"
    convert([first], out)
    manifest = json.loads((out / MANIFEST).read_text())
    (row,) = manifest["logs"]
    (out / MANIFEST).write_text(json.dumps({**manifest, "logs": []}))
    begun = {**row, "files": {}, "rows": 0, "error": journal.BEGUN}
    head = {"version": manifest["version"], "options": manifest["options"]}
    (out / JOURNAL).write_text(f"{json.dumps(head)}\n{json.dumps(begun)}\n" + json.dumps(row)[:-9])
    (other,) = convert([second], out)
    assert (other.name, other.error) == ("flight-2", None)
    assert not (out / JOURNAL).exists()
    (again,) = convert([first], out)
    assert (again.name, again.skipped, again.rows) == ("flight", False, 100)


def test_what_a_killed_run_noted_is_not_done_again(tmp_path, tiny):
    out = tmp_path / "out"
    convert(tiny[:2], out)
    manifest = json.loads((out / MANIFEST).read_text())
    (out / MANIFEST).unlink()
    head = {"version": manifest["version"], "options": manifest["options"]}
    text = [json.dumps(head), *(json.dumps(row) for row in manifest["logs"]), '{"path": "half']
    (out / JOURNAL).write_text("\n".join(text))
    rows = convert(tiny[:3], out)
    assert [row.skipped for row in rows] == [True, True, False]
    assert not (out / JOURNAL).exists()
    assert len(json.loads((out / MANIFEST).read_text())["logs"]) == 3


def test_with_other_options_a_journal_counts_for_nothing(tmp_path, tiny):
    out = tmp_path / "out"
    (out).mkdir()
    head = {"version": 2, "options": {"format": "csv"}}
    (out / JOURNAL).write_text(json.dumps(head) + "\n")
    (row,) = convert(tiny[:1], out)
    assert (row.error, row.skipped) == (None, False)
    assert not (out / JOURNAL).exists()


@pytest.mark.parametrize(
    "content", ["not a journal\n", "[]\n", '{"version": 2, "options": {}}\n7\n']
)
def test_a_file_of_something_else_is_not_replaced(tmp_path, tiny, content):
    (tmp_path / JOURNAL).write_text(content)
    with pytest.raises(ValueError, match=r"manifest\.journal"):
        convert(tiny[:1], tmp_path)
    assert (tmp_path / JOURNAL).read_text() == content


def test_a_journal_without_a_whole_line_is_an_empty_one(tmp_path, tiny):
    (tmp_path / JOURNAL).write_bytes(b'{"version": 2, "opt')
    assert convert(tiny[:1], tmp_path)[0].error is None
    assert not (tmp_path / JOURNAL).exists()


def test_the_manifest_is_written_now_and_then_and_not_for_each_log(tmp_path, tiny, monkeypatch):
    written: list[int] = []
    replace = os.replace

    def count(source: str, target: str) -> None:
        written.append(1)
        replace(source, target)

    monkeypatch.setattr("mavwire.logs.store.os.replace", count)
    monkeypatch.setattr(journal, "PAUSE", 3600.0)
    convert(tiny[:20], tmp_path / "late")
    assert len(written) == 2, "at the start and at the end"
    monkeypatch.setattr(journal, "PAUSE", 0.0)
    monkeypatch.setattr(journal, "SHARE", 0.0)
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
    (tmp_path / JOURNAL).write_bytes(b'{"version": 2, "opt')
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
    # What a run that was killed left of it is found again.
    left = made.with_name(f"{draft_stem(made.name)}.123-4.part")
    other = made.with_name(f"{draft_stem('y' + made.name[1:])}.123-4.part")
    for path in (left, other):
        path.write_text("left")
    manifest = json.loads((out / MANIFEST).read_text())
    manifest["logs"][0]["error"] = journal.BEGUN
    (out / MANIFEST).write_text(json.dumps(manifest))
    convert([log], out, format=format, compression=compression)
    assert not left.exists() and other.exists() and made.exists()


def test_drafts_of_a_killed_run_are_removed(tiny, tmp_path):
    (row,) = convert(tiny[:1], tmp_path)
    folder = tmp_path / "HEARTBEAT"
    left = folder / f"{row.name}.parquet.123-4.part"
    others = [folder / f"{row.name}.parquet.part", folder / f"other-{row.name}.parquet.1-2.part"]
    for path in (left, *others):
        path.write_text("left")
    manifest = json.loads((tmp_path / MANIFEST).read_text())
    manifest["logs"][0]["error"] = journal.BEGUN
    (tmp_path / MANIFEST).write_text(json.dumps(manifest))
    (again,) = convert(tiny[:1], tmp_path)
    assert again.error is None and not again.skipped
    assert not left.exists() and all(path.exists() for path in others)


def test_drafts_of_a_killed_run_are_removed_where_many_logs_begin_together(tiny, tmp_path):
    """As a fleet's do."""
    rows = convert(tiny[:2], tmp_path)
    left = [tmp_path / "HEARTBEAT" / f"{row.name}.parquet.123-4.part" for row in rows]
    for path in left:
        path.write_text("left")
    noted = json.loads((tmp_path / MANIFEST).read_text())
    noted["logs"][0]["error"] = journal.BEGUN
    (tmp_path / MANIFEST).write_text(json.dumps(noted))
    store = Store(str(tmp_path))
    manifest = Manifest(store, noted["options"])
    journal.Journal(store, manifest).begin_all({row.path: row.name for row in rows})
    assert [path.exists() for path in left] == [False, True]


@pytest.mark.parametrize("note", [MANIFEST, JOURNAL])
def test_drafts_of_a_killed_run_with_other_options_are_removed(tiny, tmp_path, note):
    """Nobody else would: the manifest that names their log begins anew."""
    (row,) = convert(tiny[:1], tmp_path)
    folder = tmp_path / "HEARTBEAT"
    left = [folder / f"{name}.parquet.123-4.part" for name in (row.name, f"{row.name}+0001")]
    other = folder / "other.parquet.1-2.part"
    for path in (*left, other):
        path.write_text("left")
    manifest = json.loads((tmp_path / MANIFEST).read_text())
    (begun,) = manifest.pop("logs")
    begun |= {"error": journal.BEGUN, "parts": [f"{row.name}+0001"]}
    if note == JOURNAL:
        (tmp_path / JOURNAL).write_text(f"{json.dumps(manifest)}\n{json.dumps(begun)}\n")
        (tmp_path / MANIFEST).unlink()
    else:
        (tmp_path / MANIFEST).write_text(json.dumps(manifest | {"logs": [begun]}))
    convert(tiny[1:2], tmp_path, format="csv")
    assert not any(path.exists() for path in left) and other.exists()
