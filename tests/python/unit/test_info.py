"""`mavwire info`: the figures are right, whatever is in the log."""

from __future__ import annotations

import argparse
import gzip
import importlib
import json
import os
import random
import re
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import mavwire
import pytest
from dataflash_writer import Log, sample
from mavwire import cli, traffic
from mavwire.cli.logs import info
from mavwire.logs.summary import Count
from unit.link_tools import T0, heartbeat, record


@pytest.fixture(scope="module")
def mavutil(subject: str) -> ModuleType:
    return importlib.import_module(f"{subject}.mavutil")


@pytest.fixture(scope="module")
def dialect(subject: str) -> ModuleType:
    return importlib.import_module(f"{subject}.dialects.v20.ardupilotmega")


def test_names_of_a_log_steer_no_terminal(tmp_path, capsys):
    """A name of four bytes clears a screen, and one with a line break makes a row of its own."""
    log = Log().define("\x1b[2J", "QB", "TimeUS,X", 1).define("A\n B", "QB", "TimeUS,X", 2)
    path = log.add("\x1b[2J", 1, 1).add("A\n B", 2, 2).write(tmp_path / "na\x07me.BIN")
    assert cli.main(["info", path]) == 0
    shown = capsys.readouterr().out
    assert not re.search(r"[\x00-\x09\x0b-\x1f]", shown)
    assert r"\x1b[2J " in shown and r"  A\x0a B " in shown and r"na\x07me.BIN" in shown
    assert cli.main(["info", "--json", path]) == 0
    assert {"\x1b[2J", "A\n B"} <= json.loads(capsys.readouterr().out)["types"].keys()


def test_summary_of_clean_traffic(dialect: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    written = traffic.generate(path, 5_000, systems=2, dialect=dialect)
    summary = info.read(str(path))
    found = summary.info
    assert found.messages == sum(one.messages for one in found.types.values()) == 5_000
    assert found.senders.keys() == {(1, 1), (2, 1), (255, 190)}
    assert sum(one.count.messages for one in found.senders.values()) == 5_000
    assert (found.lost, found.bad_bytes, found.bad_count) == (0, 0, 0)
    assert found.count.seconds == pytest.approx(written.seconds, abs=1e-3)
    assert summary.rate(found.types["ATTITUDE"].messages) == pytest.approx(20, rel=0.05)


def test_summary_counts_losses_and_damage(dialect: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    written = traffic.generate(path, 5_000, loss=0.05, corruption=0.01, dialect=dialect)
    found = info.read(str(path)).info
    assert found.lost > 150
    assert found.bad_count == written.corrupted > 0
    assert found.bad_bytes > 10 * found.bad_count


def test_table_and_json_say_the_same(dialect: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 1_000, dialect=dialect)
    summary = info.read(str(path))
    text = info.table(summary)
    plain = json.loads(json.dumps(summary.as_dict()))
    assert plain["messages"] == 1_000
    assert "1,000 messages of" in text
    assert "2024-01-01 00:00:00 to 2024-01-01 00:00:" in text
    for kind, count in plain["types"].items():
        assert re.search(rf"^  {kind} +{count:,} ", text, re.MULTILINE)
    for system in plain["systems"]:
        assert f"  {system} " in text


def test_empty_log(tmp_path: Path) -> None:
    path = tmp_path / "empty.tlog"
    path.write_bytes(b"")
    summary = info.read(str(path))
    assert summary.info.messages == 0
    assert "0 messages of 0 types" in info.table(summary)
    assert "time     none, there is no message" in info.table(summary)


def test_times_that_no_calendar_has_are_shown_as_years(tmp_path: Path) -> None:
    path = tmp_path / "one.tlog"
    path.write_bytes(record(heartbeat(0), T0))
    summary = info.read(str(path))
    summary.info = replace(summary.info, count=Count(1, 1e17, 1e17, 0))
    assert "year 3.169e9" in info.table(summary)


def test_a_missing_log_is_named_and_the_others_are_read(
    mavutil: ModuleType, dialect: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if mavutil.__name__ != "mavwire.mavutil":
        pytest.skip("the command uses mavwire")
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 100, dialect=dialect)
    parser = argparse.ArgumentParser()
    info.add_arguments(parser)
    missing = str(tmp_path / "missing.tlog")
    assert info.main(parser.parse_args([missing, str(path), "--json"])) == 1
    printed = capsys.readouterr()
    assert missing in printed.err
    assert json.loads(printed.out)["messages"] == 100


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("folder", "Is a directory"),
        ("pipe.tlog", "a pipe or a socket is neither a log nor a port"),
        ("/dev/null", "not a log file"),
        ("nowhere", "no such log file"),
        ("", "no device: the name is empty"),
        ("gzip.tlog", "a gzip file, not a telemetry log"),
    ],
)
def test_what_is_no_log_is_named(
    name: str,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("gzip.tlog").write_bytes(b"\x1f\x8b\x08" + bytes(100))
    os.mkfifo("pipe.tlog")
    assert cli.main(["info", name]) == 1
    error = capsys.readouterr().err
    assert error.startswith("mavwire info: ")
    assert error.count("\n") == 1
    assert name in error
    assert said in error


def test_the_dialect_of_the_process_stays(tmp_path: Path) -> None:
    from mavwire import mavutil

    log = tmp_path / "a.tlog"
    traffic.generate(log, 10)
    before = mavutil.current_dialect, mavutil.mavlink
    assert before[0] != "minimal"
    assert cli.main(["info", "--dialect", "minimal", str(log)]) == 0
    assert (mavutil.current_dialect, mavutil.mavlink) == before


def test_a_dialect_that_nobody_defines_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["info", "--dialect", "klingon", "a.tlog", "b.tlog"]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "no dialect 'klingon'" in error


def test_dataflash_times_without_a_fix_are_since_start(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    without, with_fix = tmp_path / "without.BIN", tmp_path / "with.BIN"
    log = Log().define("IMU", "Qf", "TimeUS,AccX")
    log.add("IMU", 1_500_000, 1.0).add("IMU", 4_000_000, 2.0).write(without)
    sample().write(with_fix)
    assert cli.main(["info", str(without)]) == 0
    assert "  time     0.000 to 4.000 s since start, 4.0 s\n" in capsys.readouterr().out
    assert cli.main(["info", str(with_fix)]) == 0
    assert "  time     2022-03-06 00:01:" in capsys.readouterr().out


def test_places_of_a_dataflash_log_are_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "damaged.BIN"
    log = Log().define("IMU", "Qf", "TimeUS,AccX").add("IMU", 1_500_000, 1.0)
    log.raw(b"junk").add("IMU", 9_500_000, 2.0).add("IMU", 9_600_000, 2.0).write(path)
    (bad,) = mavwire.open_log(path).info().bad
    assert cli.main(["info", str(path)]) == 0
    said = capsys.readouterr().out
    assert f"  damage   bytes 4 at {bad[0]}\n" in said
    assert "  gaps     1 without a message: 8.0 s\n" in said and "mavlink" not in said
    assert cli.main(["info", "--json", str(path)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["bad"], found["gaps"]) == ([list(bad)], [[1.5, 9.5]])
    assert "signed" not in found


def test_messages_that_two_links_heard_are_not_lost(tmp_path: Path) -> None:
    path = tmp_path / "twice.tlog"
    beats = [record(heartbeat(n), T0 + n) for n in (0, 1, 2, 5, 6)]
    path.write_bytes(b"".join(beats[n // 2] for n in range(10)))
    summary = info.read(str(path))
    assert (summary.info.lost, summary.info.repeated) == (2, 5)
    assert summary.as_dict()["systems"] == {"1/1": {"messages": 10, "lost": 2, "repeated": 5}}
    text = info.table(summary)
    assert "  lost     2 messages by sequence number, 5 came again\n" in text
    assert re.search("^  1/1 +10 +2 +5$", text, re.MULTILINE)


def test_what_a_log_does_not_have_is_not_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Numbers in line, of a dataflash log; rates, of a raw stream; anything, of what is no log."""
    onboard, raw, notes = tmp_path / "a.BIN", tmp_path / "b.tlog.raw", tmp_path / "c.txt"
    sample().write(onboard)
    raw.write_bytes(b"".join(heartbeat(n) for n in range(5)))
    notes.write_text("hello\n")
    assert cli.main(["info", str(onboard)]) == 0
    said = capsys.readouterr().out
    assert "sequence number" not in said and "PER SECOND" in said
    assert cli.main(["info", str(raw)]) == 0
    said = capsys.readouterr().out
    assert "none, a log without times" in said and "PER SECOND" not in said
    assert re.search("^  HEARTBEAT +5$", said, re.MULTILINE)
    assert cli.main(["info", str(notes)]) == 1
    said, error = capsys.readouterr()
    assert (said, error.count("\n")) == ("", 1)
    assert "no telemetry record found" in error and str(notes) in error


@pytest.mark.parametrize("pack", ["gz", "zst"])
def test_a_compressed_log_that_is_cut_off_is_said_to_be(
    tmp_path: Path, pack: str, capsys: pytest.CaptureFixture[str]
) -> None:
    flight, onboard = tmp_path / "flight.tlog", tmp_path / "onboard.BIN"
    traffic.generate(flight, 5_000)
    log = Log().define("IMU", "Qf", "TimeUS,AccX")
    for n in range(20_000):  # zstd has blocks of 128 kB
        log.add("IMU", n * 7919, random.random())
    log.write(onboard)
    for path in (flight, onboard):
        packed = compressed(path.read_bytes(), pack)
        whole, part = (
            tmp_path / f"whole{path.suffix}.{pack}",
            tmp_path / f"part{path.suffix}.{pack}",
        )
        whole.write_bytes(packed)
        part.write_bytes(packed[: len(packed) * 2 // 3])
        assert cli.main(["info", str(whole)]) == 0
        assert "cut off" not in capsys.readouterr().out
        assert cli.main(["info", str(part)]) == 0
        assert "  file     cut off or damaged: " in capsys.readouterr().out
        assert info.read(str(part)).as_dict()["damage"]


def compressed(content: bytes, pack: str) -> bytes:
    if pack == "gz":
        return gzip.compress(content)
    return bytes(pytest.importorskip("pyarrow").Codec("zstd").compress(content, asbytes=True))
