"""What kind of log a file is: every entry point gives the same answer, over a grid of made files."""

from __future__ import annotations

import gzip
import json
import subprocess
import sys
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import mavwire
import pytest
from dataflash_writer import flight
from encoder import heartbeat, record
from mavwire import cli, mavutil
from mavwire._native import LogKind, identify
from mavwire.logs import LogFormatError
from mavwire.logs.conversion import convert

COUNT = 30
NOISE = bytes(number * number * 7 % 251 for number in range(3000))
SECOND = 1_000_000
START = 1_700_000_000 * SECOND


def telemetry(*, v1: bool, stamped: bool) -> bytes:
    frames = (heartbeat(number, v1=v1) for number in range(COUNT))
    times = range(START, START + COUNT * SECOND, SECOND)
    pairs = zip(frames, times, strict=True)
    return b"".join(record(frame, time) if stamped else frame for frame, time in pairs)


def text_log() -> bytes:
    head = (
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
        "FMT, 129, 15, ATT, Qf, TimeUS,Roll\n"
    )
    return (head + "".join(f"ATT, {number * SECOND}, 1.5\n" for number in range(COUNT))).encode()


def binary_log(tmp_path: Path) -> bytes:
    path = tmp_path / "made"
    flight(COUNT).write(path)
    return path.read_bytes()


LOGS: dict[str, tuple[Callable[[Path], bytes], LogKind, str]] = {
    "tlog 1": (lambda _: telemetry(v1=True, stamped=True), LogKind.TLOG, "HEARTBEAT"),
    "tlog 2": (lambda _: telemetry(v1=False, stamped=True), LogKind.TLOG, "HEARTBEAT"),
    "raw 1": (lambda _: telemetry(v1=True, stamped=False), LogKind.RAW, "HEARTBEAT"),
    "raw 2": (lambda _: telemetry(v1=False, stamped=False), LogKind.RAW, "HEARTBEAT"),
    "binary": (binary_log, LogKind.DATAFLASH, "ATT"),
    "text": (lambda _: text_log(), LogKind.DATAFLASH_TEXT, "ATT"),
}
CHANGES: dict[str, Callable[[bytes], bytes]] = {
    "whole": lambda log: log,
    "noise in front": lambda log: b"noise" + log,
    "zeros in front": lambda log: bytes(512) + log,
    "truncated": lambda log: log[:-5],
    "short": lambda log: log[: len(log) // 3],
}
NAMES = (
    "flight.tlog", "flight.BIN", "flight.log", "flight.raw", "flight.txt", "flight", "FLIGHT.LOG",
    "a b.tlog", "-flight.bin",
)  # fmt: skip
FOREIGN = {
    "photo.png": b"\x89PNG\r\n\x1a\n" + NOISE,
    "flight.pcap": b"\xd4\xc3\xb2\xa1" + NOISE,
    "program.tlog": b"\x7fELF" + NOISE,
    "flight.ulg": b"ULog\x01\x12\x35" + NOISE,
    "log.db": b"SQLite format 3\0" + NOISE,
    "notes.txt": b"Wind from the south, 4 m/s.\n" * 40,
    "noise.tlog": NOISE,
    "noise.BIN": NOISE,
    "data.csv": b"time,roll\n1,2\n" * 40,
}


@pytest.fixture(autouse=True)
def in_its_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def by_mavutil(name: str, kind: str) -> int:
    with mavutil.mavlink_connection(name) as log:
        return sum(msg.get_type() == kind for msg in iter(log.recv_msg, None))


def by_info(name: str, kind: str) -> int:
    info = mavwire.open_log(name).info()
    return info.types[kind].messages


BY_TABLES: dict[str, Callable[[str, str], int]] = {
    "read": lambda name, kind: len(mavwire.read(name)[kind]),
    "scan": lambda name, kind: sum(len(one) for one in mavwire.scan(name) if one.name == kind),
    "info": by_info,
    "convert": lambda name, kind: convert([name], "tables", types=kind)[0].rows,
}
BY_MESSAGES: dict[str, Callable[[str, str], int]] = {
    "mavutil": by_mavutil,
    "open_log": lambda name, kind: sum(one.get_type() == kind for one in mavwire.open_log(name)),
}


def by_commands(name: str, kind: str, capsys: pytest.CaptureFixture[str]) -> list[int]:
    """What `info` and `dump` say."""
    path = f"./{name}"
    assert cli.main(["info", "--json", path]) == 0
    types = json.loads(capsys.readouterr().out)["types"]
    counted = types[kind]
    assert cli.main(["dump", "--types", kind, path]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    return [counted["count"] if isinstance(counted, dict) else counted, said.out.count("\n")]


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("log", LOGS)
def test_a_log_is_the_same_for_all(
    log: str, change: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Under any name, with damage in front, and cut off."""
    made, kind, message = LOGS[log]
    content = CHANGES[change](made(tmp_path))
    names = NAMES if change == "whole" else NAMES[:2]
    answers = {}
    for name in names:
        Path(name).write_bytes(content)
        assert identify(name) is kind, name
        for way, count in (BY_TABLES | BY_MESSAGES).items():
            answers[name, way] = count(name, message)
        answers[name, "info command"], answers[name, "dump"] = by_commands(name, message, capsys)
    if kind is LogKind.TLOG and change == "noise in front":
        # mavutil takes the noise for a time stamp, and for MAVLink 1, as pymavlink does.
        found = {answers.pop((name, "mavutil")) for name in names}
        assert found == {{"tlog 1": COUNT - 2, "tlog 2": 0}[log]}
    assert len(set(answers.values())) == 1, answers
    assert all(answers.values())


@pytest.mark.parametrize("suffix", ["gz", "zst"])
@pytest.mark.parametrize("log", LOGS)
def test_a_compressed_log_is_read_as_tables(
    log: str, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made, kind, message = LOGS[log]
    if suffix == "gz":
        packed = gzip.compress(made(tmp_path))
    else:
        packed = pytest.importorskip("zstandard").compress(made(tmp_path))
    Path("plain").write_bytes(made(tmp_path))
    for name in (f"flight.{suffix}", "flight.tlog"):
        Path(name).write_bytes(packed)
        assert identify(name) is (LogKind.GZIP if suffix == "gz" else LogKind.ZSTD)
        assert identify(name, unpack=True) is kind
        found = {way: count(name, message) for way, count in BY_TABLES.items()}
        assert set(found.values()) == {by_info("plain", message)}, found
        shown = []
        for each in ("plain", name):
            assert cli.main(["dump", each]) == 0
            shown.append(capsys.readouterr().out)
        assert shown[0] == shown[1]


def zipped() -> bytes:
    packed = BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("notes.txt", NOISE)
    return packed.getvalue()


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("name", [*FOREIGN, "archive.zip"])
def test_another_file_is_refused_by_all_in_the_same_words(
    name: str, packed: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    content = FOREIGN.get(name) or zipped()
    if packed:
        name, content = f"{name}.gz", gzip.compress(content)
    Path(name).write_bytes(content)
    said = []
    for count in (*BY_TABLES.values(), BY_MESSAGES["open_log"]):
        try:
            count(name, "HEARTBEAT")
        except LogFormatError as error:
            said.append(str(error).rsplit(": ", 1)[0])
        except KeyError:
            said.append("no error")
    for words in (["info", name], ["dump", name], ["msgstats", name]):
        assert cli.main(words) == (1 if words[0] == "info" else 0)
        printed = capsys.readouterr()
        assert said[0] in printed.err, printed.err
    assert "no error" not in said and len(set(said)) == 1, said
    assert "; " in said[0]


@pytest.mark.parametrize("content", [b"", b"\0", b"\0\5", b"\xfd", b"\xfe\t", b"\xa3", b"F"])
@pytest.mark.parametrize("name", ["flight.tlog", "flight.BIN", "flight.log", "flight"])
def test_a_log_without_a_whole_record_is_none_of_another_kind(name: str, content: bytes) -> None:
    Path(name).write_bytes(content)
    assert identify(name) is LogKind.CUT
    assert mavwire.read(name) == {} and list(mavwire.scan(name)) == []
    assert list(mavwire.open_log(name)) == [] and mavwire.open_log(name).info().messages == 0
    assert cli.main(["info", name]) == cli.main(["dump", name]) == 0


@pytest.mark.parametrize("log", LOGS)
def test_a_pipe_is_read_as_the_file_is(log: str, tmp_path: Path) -> None:
    made, _, message = LOGS[log]
    content = made(tmp_path)
    Path("flight").write_bytes(content)
    words = [sys.executable, "-m", "mavwire", "dump", "--types", message]
    piped = subprocess.run([*words, "-"], input=content, capture_output=True, check=True)
    named = subprocess.run([*words, "flight"], capture_output=True, check=True)
    assert piped.stdout == named.stdout and piped.stdout and not piped.stderr
