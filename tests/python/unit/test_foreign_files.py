"""Files without a record: every command says so on standard error and prints what it always does."""

from __future__ import annotations

import contextlib
import errno
import gzip
import os
import zipfile
from pathlib import Path

import mavwire
import pytest
from dataflash_writer import sample
from encoder import heartbeat, record
from mavwire import cli, mavutil
from mavwire._native import LogKind
from mavwire.logs import LogFormatError
from mavwire.logs.format_error import _OTHERS

EMPTY = "the log is empty: repeat the copy or the download"
NO_RECORD = "the log ends within its first record: repeat the copy or the download"
NO_TELEMETRY = "no telemetry record found; `mavwire info --help` names the kinds of logs; copy a truncated log again"
NO_DATAFLASH = "no dataflash record found; `mavwire info --help` names the kinds of logs; copy a truncated log again"
NOISE = bytes(number * number * 7 % 251 for number in range(3000))
COMMANDS = ("dump", "info", "parms", "flightmodes", "summarize")


def test_each_kind_of_log_is_telemetry_or_has_a_text() -> None:
    kinds = {kind for kind in vars(LogKind).values() if isinstance(kind, LogKind)}
    assert {kind for kind in kinds if not kind.is_telemetry} - {*_OTHERS} == {
        LogKind.CUT,
        LogKind.UNKNOWN,
    }
    assert {kind for kind in kinds if kind.is_dataflash} == {
        LogKind.DATAFLASH, LogKind.DATAFLASH_TEXT, LogKind.HEADERLESS
    }  # fmt: skip


@pytest.fixture(autouse=True)
def in_its_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", [*COMMANDS, "loss"])
@pytest.mark.parametrize("name", ["empty.BIN", "empty.tlog", "empty.log"])
def test_an_empty_log(name: str, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path(name).write_bytes(b"")
    assert cli.main([command, name]) == 0
    assert capsys.readouterr().err == f"mavwire {command}: {EMPTY}: {name!r}\n"


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("noise.BIN", NOISE, NO_DATAFLASH),
        ("text.tlog", b"hello\n", NO_TELEMETRY),
        ("one.tlog", b"x", NO_TELEMETRY),
        ("seven.tlog", b"1234567", NO_TELEMETRY),
        ("markers.tlog", b"\xfd" * 20_000, NO_TELEMETRY),
    ],
)
def test_no_record(
    name: str,
    content: bytes,
    said: str,
    command: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path(name).write_bytes(content)
    assert cli.main([command, name]) == (1 if command == "info" else 0)
    line = f"{name}: {said}" if command == "info" else f"{said}: {name!r}"
    assert capsys.readouterr().err == f"mavwire {command}: {line}\n"


STARTS = {
    "tlog": record(heartbeat(), 10**15),
    "raw": heartbeat(),
    "BIN": b"\xa3\x95\x80\x80\x59FMT" + bytes(20),
    "log": b"FMT, 128, 89, FMT, BBnNZ, Type,Length",
}


@pytest.mark.parametrize("size", [1, 2, 3, 5, 8, 9, 20])
@pytest.mark.parametrize("kind", STARTS)
def test_a_log_that_ends_in_its_first_record(
    kind: str, size: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is a log: nobody refuses it, and all say that it has nothing."""
    name, out = f"start.{kind}", Path("out.tlog")
    Path(name).write_bytes(STARTS[kind][:size])
    with mavwire.open_log(name) as log:
        assert (log.read(), log.info().messages, log.info().bad_bytes) == ({}, 0, size)
    assert mavwire.read(name) == {} and list(mavwire.scan(name)) == []
    for command in COMMANDS:
        assert cli.main([command, name]) == 0
        assert capsys.readouterr().err == f"mavwire {command}: {NO_RECORD}: {name!r}\n"
    assert cli.main(["convert", name, "-o", "tables"]) == 0
    printed = capsys.readouterr()
    assert f"0 rows in 0 files, {size} bytes were not part of any message" in printed.out
    assert printed.err == f"mavwire convert: {NO_RECORD}: {os.path.abspath(name)!r}\n"
    if kind not in ("tlog", "raw"):
        return
    for words in (["repair"], ["cut", "--types", "ATTITUDE"], ["merge", "--exact"]):
        if (kind, words[0]) == ("raw", "merge"):
            continue
        assert cli.main([*words, name, "-o", str(out)]) == 0
        assert NO_RECORD in capsys.readouterr().err and out.read_bytes() == b""


@pytest.mark.parametrize("kind", ["BIN", "log"])
def test_a_compressed_log_that_is_short(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    name = f"start.{kind}.gz"
    Path(name).write_bytes(gzip.compress(STARTS[kind][:3]))
    for command in ("info", "dump", "msgstats"):
        assert cli.main([command, name]) == 0
        assert NO_RECORD in capsys.readouterr().err
    sample().write(Path("flight.BIN"))
    Path("flight.BIN.gz").write_bytes(gzip.compress(Path("flight.BIN").read_bytes()))
    shown = []
    for log in ("flight.BIN", "flight.BIN.gz"):
        assert cli.main(["dump", log]) == 0
        shown.append(capsys.readouterr().out)
    assert shown[0] == shown[1] != ""


TABLES = {
    "info": ["info", "FILE"],
    "convert": ["convert", "FILE", "-o", "tables"],
    "cut": ["cut", "FILE", "-o", "cut.tlog"],
    "repair": ["repair", "FILE", "-o", "repaired.tlog"],
    "plot": ["plot", "FILE", "ATTITUDE.roll", "--out", "plot.html"],
    "map": ["map", "FILE", "--out", "map.html"],
}
TEXT = b"FMT, x\n" * 100
ODD = [
    ("empty.tlog", b"", EMPTY, False),
    ("empty.BIN", b"", EMPTY, False),
    ("empty.log.gz", b"", EMPTY, False),
    ("start.tlog.gz", STARTS["tlog"][:5], NO_RECORD, False),
    ("noise.BIN", NOISE, NO_DATAFLASH, True),
    ("noise.tlog", NOISE, NO_TELEMETRY, True),
    ("text.log", TEXT, NO_DATAFLASH, True),
    ("text.txt", TEXT, NO_DATAFLASH, True),
    ("text.BIN", TEXT, NO_DATAFLASH, True),
    ("text.log.gz", TEXT, NO_DATAFLASH, True),
    (
        "maps.tlog",
        b"PK\3\4" + bytes(300),
        "a ZIP archive, not a telemetry log; unpack it first",
        True,
    ),
]


def test_a_log_in_an_archive_that_does_not_compress_is_read() -> None:
    log = b"".join(record(heartbeat(number), number) for number in range(200))
    Path("flight.tlog").write_bytes(log)
    for kind in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        with zipfile.ZipFile("flight.zip", "w", kind) as archive:
            archive.writestr("flight.tlog", log)
        if kind == zipfile.ZIP_DEFLATED:
            with pytest.raises(LogFormatError, match="ZIP archive"):
                mavwire.open_log("flight.zip")
        else:
            assert len(mavwire.open_log("flight.zip")) == len(mavwire.open_log("flight.tlog"))


@pytest.mark.parametrize("command", [*TABLES, "dump", "msgstats", "loss"])
@pytest.mark.parametrize(
    ("name", "content", "said", "is_foreign"), ODD, ids=[one[0] for one in ODD]
)
def test_all_commands_say_the_same(
    name: str,
    content: bytes,
    said: str,
    is_foreign: bool,
    command: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """By the name that the user gave, whatever is decompressed on the way. A picture of nothing is an
    error, and so is a table or log of what is none.
    """
    if command in ("plot", "map"):
        pytest.importorskip("numpy")
    Path(name).write_bytes(gzip.compress(content) if name.endswith(".gz") else content)
    words = [one.replace("FILE", name) for one in TABLES.get(command, [command, "FILE"])]
    code = cli.main(words)
    printed = capsys.readouterr().err
    assert said in printed and name in printed and printed.count("\n") == 1
    assert "/mavwire-" not in printed
    if command in TABLES:
        assert code == (1 if is_foreign or command in ("plot", "map") else 0)


def test_a_log_that_is_called_as_one_of_another_kind(capsys: pytest.CaptureFixture[str]) -> None:
    """It is read under any name."""
    Path("raw.BIN").write_bytes(heartbeat() * 3)
    broken = b"\0" * 9 + heartbeat()[1:]
    Path("broken.BIN").write_bytes(broken + (b"\0" * 8 + heartbeat()) * 9)
    for name in ("raw.BIN", "broken.BIN"):
        assert cli.main(["dump", name]) == 0
        said = capsys.readouterr()
        assert "HEARTBEAT" in said.out and said.err == "", name
    text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    Path("flight.txt").write_text(text)
    assert cli.main(["dump", "flight.txt"]) == 0
    said = capsys.readouterr()
    assert "FMT {Type : 128" in said.out and said.err == ""


@pytest.mark.parametrize("name", ["empty.tlog.gz", "empty.BIN.zst"])
def test_an_empty_compressed_log_is_called_as_the_user_does(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pack = gzip.compress if name.endswith(".gz") else pytest.importorskip("zstandard").compress
    Path(name).write_bytes(pack(b""))
    for command in ("merge", "info"):
        assert cli.main([command, name]) == 0
        assert capsys.readouterr().err == f"mavwire {command}: {EMPTY}: {name!r}\n"


def test_info_of_what_looks_like_frames_alone(capsys: pytest.CaptureFixture[str]) -> None:
    Path("markers.tlog").write_bytes(b"\xfe" * 20_000)
    assert cli.main(["info", "markers.tlog"]) == 1
    assert NO_TELEMETRY in capsys.readouterr().err


def test_a_dataflash_log_behind_noise_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    sample().write(Path("flight.BIN"))
    Path("late.BIN").write_bytes(b"noise" + Path("flight.BIN").read_bytes())
    assert cli.main(["info", "late.BIN"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert "bad      5 bytes in 1 pieces\n" in printed.out


PREFIX = ("dump", "info", "parms", "flightmodes", "flighttime", "summarize", "loss", "msgstats", "search",
          "mission", "togpx", "extract", "tomfile")  # fmt: skip


@pytest.fixture
def named_like_a_program(monkeypatch: pytest.MonkeyPatch) -> Path:
    """R69. Files of a stranger: a program, and an empty log that is called as who runs it would be."""
    program = Path("payload.tlog")
    program.write_text("#!/bin/sh\n: > ran\n")
    program.chmod(0o755)
    Path("exec:payload.tlog").write_bytes(b"")
    Path("exec:.").mkdir()
    Path("exec:.", "payload.tlog").write_bytes(b"")
    monkeypatch.setenv("PATH", f".:{os.environ['PATH']}")
    return Path("ran")


@pytest.mark.skipif(os.name == "nt", reason="such names are not allowed there")
@pytest.mark.parametrize("command", PREFIX)
def test_the_name_of_a_log_runs_no_program(named_like_a_program: Path, command: str) -> None:
    """R69."""
    for name in ("exec:payload.tlog", "exec:./payload.tlog"):
        with contextlib.suppress(SystemExit):
            cli.main([command, name])
        plot = ["plot", name, "ATTITUDE.roll", "--out", "plot.png"]
        assert cli.main(plot) in (0, 1)
        with contextlib.suppress(OSError, ValueError):
            mavutil.mavlink_connection(name).close()
    assert not named_like_a_program.exists()


@pytest.mark.skipif(os.name == "nt", reason="such names are not allowed there")
def test_the_name_of_a_log_opens_no_connection(capsys: pytest.CaptureFixture[str]) -> None:
    name = "udpin:127.0.0.1:0.tlog"
    Path(name).write_bytes(record(heartbeat(), 10**15))
    assert cli.main(["dump", name]) == 0
    assert "HEARTBEAT" in capsys.readouterr().out


def test_a_replay_of_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    for name, content in (("empty.tlog", b""), ("empty.tlog.gz", gzip.compress(b""))):
        Path(name).write_bytes(content)
        code = cli.main(["replay", name, "--out", "udpout:127.0.0.1:9"])
        assert code == (1 if name.endswith(".gz") else 0)
        assert f"{EMPTY}: {name!r}" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["cut.tlog", "cut.BIN"])
def test_a_replay_of_less_than_a_record(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path(name).write_bytes(b"\xa3")
    assert cli.main(["replay", name, "--out", "udpout:127.0.0.1:9"]) == 0
    assert capsys.readouterr().err == f"mavwire replay: {NO_RECORD}: {name!r}\n0 frames\n"


@pytest.mark.skipif(
    not os.path.exists("/proc/self/mem"), reason="needs a file that reading fails of"
)
def test_a_log_that_cannot_be_read_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    os.symlink("/proc/self/mem", "bad.tlog")
    for words in (*TABLES.values(), ["dump", "FILE"], ["togpx", "FILE"]):
        assert cli.main([one.replace("FILE", "bad.tlog") for one in words]) == 1
        assert capsys.readouterr().err.endswith("bad.tlog: Input/output error\n")
    with pytest.raises(OSError) as caught:
        mavutil.mavlink_connection("bad.tlog")
    assert caught.value.errno == errno.EIO
