"""`mavwire dump` prints what mavlogdump.py prints, line by line, for all its options."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from dump_logs import clean_log, compare, damaged_log, mavwire_dump, oracle_dump
from tool_runs import Log, attitude, heartbeat

CASES = (
    "",
    "--format json",
    "--show-source --show-seq",
    "--format json --show-source --show-seq",
    "--types ATTITUDE,PARAM* --show-source",
    "--types '*'",
    "--types '' --format json",
    "--types BAD_DATA",
    "--types UNKNOWN*",
    "--types NO_SUCH_TYPE --no-bad-data",
    "--nottypes 'ATT*,BAD_DATA,*RAW*'",
    "--types ATTITUDE --nottypes 'ATT*'",
    "--format csv --types ATTITUDE,HEARTBEAT",
    "--format csv --types DATA96,STATUSTEXT,BATTERY_STATUS,TIMESYNC --csv_sep ';'",
    "--format csv --types HEARTBEAT,HEARTBEAT --show-source",
    "--format csv --types WIND_COV",
    "--no-bad-data --source-system 1 --source-component 1",
    "--source-system 0 --format json",
    "--source-system 999",
    "--link 1",
    "--link 2 --types HEARTBEAT,SYS_STATUS --format json",
    "--show-loss",
    "--show-loss --types HEARTBEAT",
    "--show-loss --format csv --types HEARTBEAT",
    "--show-loss --source-system 7 --format json",
    "--reduce 2",
    "--reduce -3",
    "--reduce 3 --reduce-rate 2",
    "--reduce-rate 1.5 --types HEARTBEAT,ATTITUDE",
    "--verbose",
    "--condition 'HEARTBEAT.type==2'",
    "--condition 'BATTERY_STATUS[0].id==0' --types ATTITUDE",
    "--condition 'NO_SUCH_TYPE.x>0' --meta",
    "--mav10 --planner --robust --zero-time-base",
    "--dialect common",
    "--dialect minimal --format json",
    "--no-timestamps",
    "--no-timestamps --types 'ATT*,HEART*' --format json",
    "--no-timestamps --format csv --types ATTITUDE",
    "--quiet",
)
OUTPUT_CASES = (
    "",
    "--quiet --types 'ATT*'",
    "--parms --types ATTITUDE",
    "--parms --source-system 7",
    "--parms --condition False",
    "--no-bad-data --link 1",
    "--reduce-rate 1 --format json",
)
# Of these nothing is left of a clean log, or only a header.
SILENT = frozenset(
    (
        "--types '' --format json",
        "--types BAD_DATA",
        "--types UNKNOWN*",
        "--types NO_SUCH_TYPE --no-bad-data",
        "--types ATTITUDE --nottypes 'ATT*'",
        "--format csv --types WIND_COV",
        "--source-system 999",
        "--condition 'NO_SUCH_TYPE.x>0' --meta",
        "--quiet",
    )
)
# While pymavlink indexes a damaged log and seeks in it, what it read of a broken record spoils the
# next one, which docs/compatibility.md tells.
SPOILT = ("--types '*'", "--show-loss")


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(clean_log(tmp_path_factory.mktemp("clean") / "clean.tlog"))


@pytest.fixture(scope="module")
def damaged(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(damaged_log(tmp_path_factory.mktemp("damaged") / "damaged.tlog"))


@pytest.mark.parametrize("options", CASES)
def test_clean_log(options: str, clean: str, oracle: str) -> None:
    lines = compare(*shlex.split(options), clean)
    assert (lines > 1) == (options not in SILENT)


@pytest.mark.parametrize("options", [one for one in CASES if not one.startswith(SPOILT)])
def test_damaged_log(options: str, damaged: str, oracle: str) -> None:
    compare(*shlex.split(options), damaged)


@pytest.mark.parametrize("options", OUTPUT_CASES)
def test_output_file(options: str, clean: str, damaged: str, oracle: str, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.tlog", tmp_path / "theirs.tlog"
    for log in (damaged, clean):
        our_lines = mavwire_dump(*shlex.split(options), "-o", str(ours), log)
        assert our_lines == oracle_dump(*shlex.split(options), "-o", str(theirs), log)
        assert ours.read_bytes() == theirs.read_bytes()
    assert ours.stat().st_size > 0


@pytest.mark.parametrize("options", ["", "--quiet", "--format json", "--types 'ATT*'"])
def test_types_in_the_log(options: str, damaged: str, oracle: str) -> None:
    """mavlogdump's order is that of a set, so only what is printed is compared."""
    arguments = ["--show-types", *shlex.split(options), damaged]
    ours, theirs = mavwire_dump(*arguments), oracle_dump(*arguments)
    assert sorted(ours[0]) == sorted(theirs[0])
    assert len(ours[0]) > 1


@pytest.mark.parametrize("start", [b"", b"\x00", b"\xfd\x01\x02", bytes(12), b"\xfe" * 30])
def test_a_log_that_begins_with_garbage(start: bytes, tmp_path: Path, oracle: str) -> None:
    path = tmp_path / "start.tlog"
    whole = clean_log(tmp_path / "clean.tlog").read_bytes()
    path.write_bytes(
        start + (bytes([whole[0] ^ 1]) if start else b"") + whole[1 if start else 60 :]
    )
    compare("--show-source", "--format", "json", str(path))


@pytest.mark.parametrize("rate", ["0.5", "2", "10"])
def test_a_reduced_log_whose_clock_goes_back(rate: str, tmp_path: Path, oracle: str) -> None:
    """Back by much and by little, and on from a time that damage made."""
    log = Log(tmp_path / "back.tlog")
    for start in (0.0, 100.0, 1.0, 0.7, 1e6, 3.0):
        for step in (0.0, 0.1, 0.4, 0.6, 1.0, 1.2):
            log.add(start + step, attitude(step))
            log.add(start + step * 7, heartbeat())
    assert compare("--reduce-rate", rate, str(log.done())) > 5


def test_a_log_without_a_message(tmp_path: Path, oracle: str) -> None:
    garbage = tmp_path / "garbage.tlog"
    garbage.write_bytes(bytes(range(1, 200)) * 30)
    empty = tmp_path / "empty.tlog"
    empty.write_bytes(b"")
    for path in (garbage, empty):
        assert compare(str(path)) == 0
        assert compare("--format", "json", str(path)) == 0
