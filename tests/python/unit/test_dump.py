"""`mavwire dump`: both of its loops write the same, and it behaves in pipes, on terminals and with
wrong arguments. What it prints is compared with mavlogdump.py in tests/python/compat.
"""

from __future__ import annotations

import gzip
import io
import os
import re
import shlex
import signal
import socket
import struct
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from dataflash_writer import sample
from mavwire import cli, mavutil, traffic
from mavwire._native import dump_log
from mavwire._text import guarded_output
from mavwire.cli import _progress, _reading
from mavwire.cli.logs import _dump_native
from mavwire.dialects.v20 import ardupilotmega as mavlink
from mavwire.links.inspect_message import local_time
from mavwire.links.readiness import wait_readable
from unit.link_tools import heartbeat, record

NATIVE_CASES = (
    "",
    "--format json",
    "--format json --show-source",
    "--show-source --show-seq",
    "--types 'ATT*,PARAM_VALUE,STATUSTEXT' --format json",
    "--types BAD_DATA",
    "--types 'UNKNOWN*' --no-bad-data",
    "--nottypes '*RAW*,BAD_DATA'",
    "--format csv --types ATTITUDE,STATUSTEXT,HEARTBEAT --csv_sep tab",
    "--format csv --types WIND_COV --csv_sep ' ; '",
    "--source-system 1 --link 0",
    "--source-component 190 --format json",
    "--link 3",
    "--source-system -1",
    "--quiet",
    "--parms",
)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Damaged traffic over several links, with an unknown message and a text that is no ASCII."""
    path = tmp_path_factory.mktemp("dump") / "flight.tlog"
    options = traffic.Options(messages=4000, seed=2, systems=2, loss=0.01, corruption=0.01)
    text = mavlink.MAVLink_statustext_message(3, b"\xff\xe9 caf\xc3\xa9\n\"'\\\x01")
    unknown = bytes([0xFD, 2, 0, 0, 0, 1, 1, 0x11, 0x99, 1, 1, 2, 3, 4])
    odd = [text.pack(mavlink.MAVLink(None, 1, 1)), unknown]
    with path.open("wb") as file:
        for number, (micros, frame, _) in enumerate(traffic.records(options)):
            file.write(struct.pack(">Q", micros | number % 4) + frame)
            if number % 1000 == 500:
                file.writelines(struct.pack(">Q", micros) + one for one in odd)
    return str(path)


@pytest.fixture(scope="module")
def long_log(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("long") / "long.tlog"
    traffic.generate(path, 40_000)
    return str(path)


def dumped(capsysbinary: pytest.CaptureFixture[bytes], *options: str) -> bytes:
    """Standard output of a run that must succeed. On standard error it may name messages that are not defined."""
    assert cli.main(["dump", *options]) == 0
    captured = capsysbinary.readouterr()
    assert all(b" are not in the dialect " in line for line in captured.err.splitlines())
    return captured.out


@pytest.mark.parametrize("options", NATIVE_CASES)
def test_both_loops_write_the_same(
    options: str,
    log: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsysbinary: pytest.CaptureFixture[bytes],
) -> None:
    arguments = shlex.split(options)
    output = [] if "--parms" in arguments else ["-o", str(tmp_path / "out.tlog")]
    runs = []
    monkeypatch.setattr(
        _dump_native, "dump", lambda *a, run=_dump_native.dump: runs.append(run(*a))
    )
    native = dumped(capsysbinary, *arguments, *output, log)
    records = (tmp_path / "out.tlog").read_bytes() if output else b""
    assert len(runs) == 1
    monkeypatch.setattr(_dump_native, "fits", lambda args, log: False)
    assert dumped(capsysbinary, *arguments, *output, log) == native
    assert len(runs) == 1
    if output:
        assert (tmp_path / "out.tlog").read_bytes() == records


def test_output_of_everything_is_the_log_again(
    tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    """Except for the microsecond or two that a time loses as a float, and the link number in it."""
    path, copy = tmp_path / "flight.tlog", tmp_path / "copy.tlog"
    traffic.generate(path, 2000)
    dumped(capsysbinary, "-q", "-o", str(copy), str(path))
    first, second = (
        [line.split(b": ", 1)[1] for line in dumped(capsysbinary, str(log)).splitlines()]
        for log in (path, copy)
    )
    assert first == second
    assert len(first) == 2000
    assert copy.stat().st_size == path.stat().st_size


@pytest.mark.parametrize("option", ["", "--show-loss"], ids=["native", "ordinary"])
def test_output_of_the_last_time_there_is(
    option: str, tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    path, copy = tmp_path / "flight.tlog", tmp_path / "copy.tlog"
    path.write_bytes(record(heartbeat(), 2**64 - 1))
    dumped(capsysbinary, "-q", "-o", str(copy), *option.split(), str(path))
    assert copy.read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "words", "code"),
    [
        (["missing.tlog"], ["no such log", "missing.tlog"], 1),
        ([str(Path(__file__).parent)], ["cannot open", "directory", "udpin:"], 1),
        (["--dialect", "klingon", "LOG"], ["no dialect 'klingon'", "MDEF"], 1),
        (["--format", "mat", "LOG"], ["--mat_file FILE"], 2),
        (["--format", "csv", "LOG"], ["--types ATTITUDE"], 1),
        (["--format", "csv", "--types", "ATT*", "LOG"], ["no message type 'ATT*'", "exact"], 1),
        (["--format", "csv", "--types", "heartbeat", "LOG"], ["'heartbeat'"], 1),
        (["/dev/null"], ["cannot open /dev/null: "], 1),
        (["-f", "-"], ["--follow: standard input"], 1),
        (["--condition", "", "LOG"], ["--condition '': the condition is empty"], 1),
        (["--condition", "ATTITUDE.roll >", "LOG"], ["--condition", "invalid syntax"], 1),
        (["--condition", "HEARTBEAT.no_such_field", "LOG"], ["HEARTBEAT has no field"], 1),
        (["-o", "/no/such/folder/x", "LOG"], ["--output /no/such/folder/x", "No such file"], 1),
        (["-o", "LOG", "LOG"], ["is the log itself"], 1),
        (["-o", "hard.tlog", "LOG"], ["hard.tlog is the log itself"], 1),
        (["-o", "symbolic.tlog", "LOG"], ["symbolic.tlog is the log itself"], 1),
        (["-q", "-o", "/dev/full", "LOG"], ["--output /dev/full", "No space left"], 1),
        (["-q", "-o", "/dev/full", "--condition", "1", "LOG"], ["--output /dev/full"], 1),
        (["udpin:127.0.0.1:99999"], ["cannot open", "port number 99999"], 1),
    ],
)
def test_errors_say_what_to_do(
    arguments: list[str],
    words: list[str],
    code: int,
    log: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    os.link(log, "hard.tlog")
    os.symlink(log, "symbolic.tlog")
    size = os.path.getsize(log)
    assert cli.main(["dump", *(log if one == "LOG" else one for one in arguments)]) == code
    error = capsys.readouterr().err
    assert error.startswith("mavwire dump: error: ")
    assert error.count("\n") == 1
    for word in words:
        assert word in error
    assert os.path.getsize(log) == size


def test_what_is_wrong_with_a_file_is_its_content(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "program.elf"
    path.write_bytes(b"\x7fELF")
    assert cli.main(["dump", str(path)]) == 1
    error = capsys.readouterr().err
    assert f"cannot open {path}: " in error
    assert "LOG is" not in error


def test_what_a_link_says_is_not_among_the_messages(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as closed:  # its port answers nobody
        closed.bind(("127.0.0.1", 0))
        port = closed.getsockname()[1]
        assert cli.main(["dump", "--format", "json", f"tcp:127.0.0.1:{port}"]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "refused" in printed.err


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            bytes(1000),
            "no telemetry record found; `mavwire info --help` names the kinds of logs; copy a truncated log again",
        ),
        (b"", "the log is empty: repeat the copy or the download"),
    ],
)
def test_what_is_no_log_is_said_on_standard_error(
    content: bytes, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(content)
    assert cli.main(["dump", "--no-bad-data", str(path)]) == 0
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == f"mavwire dump: {said}: {str(path)!r}\n"


@pytest.mark.parametrize("content", [b"", b"no log at all"])
def test_standard_input_is_not_called_by_the_file_that_keeps_it(
    content: bytes, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))
    assert cli.main(["dump", "-"]) == 0
    assert capsys.readouterr().err.endswith(": 'standard input'\n")


def test_a_compressed_log_is_read_as_the_log_that_is_in_it(
    log: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "flight.tlog.gz"
    packed = gzip.compress(Path(log).read_bytes())
    path.write_bytes(packed)
    for command in ("dump", "loss", "parms"):
        said = []
        for name in (log, str(path)):
            assert cli.main([command, name]) == 0
            said.append(capsys.readouterr().out.replace(name, "LOG"))
        assert said[0] == said[1] != ""
    path.write_bytes(packed[:-20])
    assert cli.main(["dump", "-q", str(path)]) == 0
    said = capsys.readouterr().err
    assert said.startswith("mavwire dump: the compressed log is cut off or damaged (")
    assert said.endswith(f"): {str(path)!r}\n")
    path.write_bytes(b"\x1f\x8b\x08" + bytes(100))
    assert cli.main(["dump", str(path)]) == 1
    damage = "as far as it can be read (corrupt deflate stream); repeat the copy or the download"
    said = f"cannot open {path}: a gzip file, not a telemetry log, {damage}"
    assert capsys.readouterr().err == f"mavwire dump: error: {said}\n"


def test_dialect_and_protocol_of_the_process_stay(log: str) -> None:
    before = mavutil.mavlink, mavutil.current_dialect, mavutil.mavlink20()
    assert cli.main(["dump", "-q", "--dialect", "common", "--mav10", log]) == 0
    assert cli.main(["dump", "-q", "--dialect", "no_such", log]) == 1
    assert (mavutil.mavlink, mavutil.current_dialect, mavutil.mavlink20()) == before


@pytest.mark.parametrize("options", ["", "--verbose"])
def test_a_reader_that_goes_away(options: str, log: str) -> None:
    command = [sys.executable, "-m", "mavwire", "dump", *shlex.split(options), log]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stderr
        assert process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(timeout=60) == 0


def test_encodings_without_the_letters(log: str) -> None:
    for options in ("", "--show-loss"):
        command = [sys.executable, "-m", "mavwire", "dump", *shlex.split(options), log]
        environment = {**os.environ, "PYTHONIOENCODING": "latin-1"}
        result = subprocess.run(command, capture_output=True, env=environment, check=True)
        assert rb"\ufffd\ufffd caf\ufffd\ufffd" in result.stdout


def test_standard_output_without_bytes(log: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for options in (["--format", "json"], ["--format", "json", "--show-loss"]):
        text = io.StringIO()
        monkeypatch.setattr(sys, "stdout", text)
        assert cli.main(["dump", *options, log]) == 0
        assert text.getvalue().count('{"meta": ') > 3900


def test_follow_prints_what_is_appended(tmp_path: Path) -> None:
    path = tmp_path / "growing.tlog"
    records = [
        struct.pack(">Q", micros) + frame
        for micros, frame, _ in traffic.records(traffic.Options(messages=60))
    ]
    path.write_bytes(b"".join(records[:30]))
    command = [sys.executable, "-m", "mavwire", "dump", "--follow", str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        lines = [process.stdout.readline() for _ in range(30)]
        with path.open("ab") as file:
            file.write(b"".join(records[30:]))
        lines += [process.stdout.readline() for _ in range(30)]
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert all(b" {" in line for line in lines)
    assert (process.returncode, error) == (cli.EXIT_INTERRUPTED, b"")


def test_follow_shows_types_that_come_later(tmp_path: Path) -> None:
    path = tmp_path / "growing.tlog"
    mav = mavlink.MAVLink(None)
    messages = [mavlink.MAVLink_attitude_message(seq, 0, 0, 0, 0, 0, 0) for seq in range(2)]
    messages += [mavlink.MAVLink_ahrs2_message(0, 0, 0, seq, 0, 0) for seq in range(2)]
    records = [struct.pack(">Q", 1_700_000_000_000_000) + bytes(one.pack(mav)) for one in messages]
    path.write_bytes(records[0])
    command = [sys.executable, "-m", "mavwire", "dump", "--follow", "--types", "A*", str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        lines = [process.stdout.readline()]
        with path.open("ab") as file:
            file.write(b"".join(records[1:]))
        lines += [process.stdout.readline() for _ in range(3)]
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    names = [line.split(b" {")[0].rsplit(b" ", 1)[1] for line in lines]
    assert names == [b"ATTITUDE", b"ATTITUDE", b"AHRS2", b"AHRS2"]
    assert (process.returncode, error) == (cli.EXIT_INTERRUPTED, b"")


def test_follow_starts_again_where_the_log_was_cut(tmp_path: Path) -> None:
    path = tmp_path / "growing.tlog"
    records = [
        struct.pack(">Q", micros) + frame
        for micros, frame, _ in traffic.records(traffic.Options(messages=20))
    ]
    command = [sys.executable, "-m", "mavwire", "dump", "--follow", str(path)]
    for types in ([], ["--types", "*"]):  # which makes an index
        path.write_bytes(b"".join(records))
        with subprocess.Popen(
            [*command, *types], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        ) as process:
            assert process.stdout
            assert process.stderr
            before = [process.stdout.readline() for _ in range(20)]
            path.write_bytes(b"")
            said = process.stderr.readline()
            path.write_bytes(b"".join(records))
            after = [process.stdout.readline() for _ in range(20)]
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=60)
        assert b"the log was cut, it is read from its start again" in said
        assert before == after
        assert (process.returncode, error) == (cli.EXIT_INTERRUPTED, b"")


@pytest.mark.parametrize("command", ["dump", "info"])
def test_standard_input(command: str, log: str, tmp_path: Path) -> None:
    def run(name: str, data: bytes) -> list[bytes]:
        arguments = [sys.executable, "-m", "mavwire", command, name]
        result = subprocess.run(arguments, input=data, capture_output=True, check=True)
        assert all(b" are not in the dialect " in line for line in result.stderr.splitlines())
        lines = result.stdout.replace(name.encode() + b":", b"").splitlines()
        return [line for line in lines if b"read in" not in line]

    flash = tmp_path / "flight.BIN"
    sample().write(flash)
    for path in (Path(log), flash):
        assert run("-", path.read_bytes()) == run(str(path), b"")


def test_types_that_there_are_none_of(log: str, capsys: pytest.CaptureFixture[str]) -> None:
    types = "ATT*,UNKNOWN_7,BAD_DATA,BAD*,HEARTBEAT,HEARTBEET,NOPE_NOPE,ATX*"
    assert cli.main(["dump", "-q", "--types", types, log]) == 0
    assert capsys.readouterr().err == (
        "mavwire dump: no message type 'HEARTBEET' in dialect ardupilotmega; "
        "did you mean 'HEARTBEAT'?\n"
        "mavwire dump: no message type 'NOPE_NOPE' in dialect ardupilotmega\n"
        "mavwire dump: no message type matches 'ATX*' in dialect ardupilotmega\n"
    )


def test_a_live_link(
    monkeypatch: pytest.MonkeyPatch, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    """Without --follow what has arrived is printed; a link has no index and no end."""
    opened = mavutil.mavlink_connection

    def opened_and_reached(*args: Any, **kwargs: Any) -> Any:
        link = opened(*args, **kwargs)
        port = link.port.getsockname()[1]
        with opened(f"udpout:127.0.0.1:{port}", source_system=9) as sender:
            sender.mav.heartbeat_send(2, 3, 81, 4, 4)
        assert wait_readable(link.fd, 60)
        return link

    monkeypatch.setattr(mavutil, "mavlink_connection", opened_and_reached)
    lines = dumped(capsysbinary, "--show-source", "--types", "HEART*", "udpin:127.0.0.1:0")
    assert lines.count(b"\n") == 1
    assert b": HEARTBEAT {type : 2, " in lines
    assert lines.endswith(b" srcSystem=9 srcComponent=0\n")


class Terminal(io.StringIO):
    """Standard error as a terminal."""

    def isatty(self) -> bool:
        return True


def test_without_rich_no_progress_is_drawn(long_log: str, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(_progress, "PROGRESS_AFTER", 0.0)
    monkeypatch.setattr(_progress, "PROGRESS_INTERVAL", 0.0)
    monkeypatch.setitem(sys.modules, "rich.console", None)
    assert cli.main(["dump", "--format", "json", long_log]) == 0
    assert terminal.getvalue() == ""


def test_progress_by_rich_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[object] = []

    class Bar:
        def __init__(self, **_kwargs: object) -> None:
            self.start = lambda: calls.append("start")
            self.stop = lambda: calls.append("stop")

        def add_task(self, name: str, total: float) -> int:
            calls.append((name, total))
            return 7

        def update(self, task: int, completed: float) -> None:
            calls.append((task, completed))

    console, progress = ModuleType("rich.console"), ModuleType("rich.progress")
    console.Console = lambda **kwargs: kwargs["file"]  # type: ignore[attr-defined]
    progress.Progress = Bar  # type: ignore[attr-defined]
    markup = ModuleType("rich.markup")
    markup.escape = lambda text: f"no markup: {text}"  # type: ignore[attr-defined]
    for name, module in (
        ("rich", ModuleType("rich")),
        ("rich.console", console),
        ("rich.progress", progress),
        ("rich.markup", markup),
    ):
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setattr(_progress, "PROGRESS_AFTER", 0.0)
    with _progress.Progress("a[/b].tlog") as bar:
        bar.update(25.0)
    assert calls == [("no markup: a[/b].tlog", 100), "start", (7, 25.0), "stop"]


@pytest.mark.parametrize("name", ["flights[old]/x.tlog", "/logs[/old]/x.tlog", "[red]x"])
def test_a_name_is_no_markup(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    pytest.importorskip("rich")
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(_progress, "PROGRESS_AFTER", 0.0)
    for key, value in (("TERM", "xterm"), ("COLUMNS", "120")):
        monkeypatch.setenv(key, value)
    with _progress.Progress(name) as bar:
        bar.update(25.0)
    drawn = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", terminal.getvalue())
    assert name in drawn


@pytest.mark.parametrize("to_file", [False, True])
def test_what_is_printed_beside_a_bar(to_file: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rich")
    screen, file = Terminal(), io.StringIO()
    streams = {"stdout": file if to_file else screen, "stderr": screen}
    for name, stream in streams.items():
        monkeypatch.setattr(sys, name, stream)
    monkeypatch.setattr(_progress, "PROGRESS_AFTER", 0.0)
    monkeypatch.setenv("TERM", "xterm")
    with guarded_output(), _progress.Progress("a\x1b]0;pwned\x07.tlog") as bar:
        bar.update(25.0)
        print("\x1b]0;row\x07")
        print("\x1b]0;error\x07", file=sys.stderr)
    assert {"stdout": sys.stdout, "stderr": sys.stderr} == streams
    assert file.getvalue() == ("\x1b]0;row\x07\n" if to_file else "")
    drawn = screen.getvalue()
    assert "a\\x1b]0;pwned\\x07.tlog" in drawn and "\\x1b]0;error\\x07" in drawn
    assert to_file or "\\x1b]0;row\\x07" in drawn
    assert "\x1b]0" not in drawn and "\x07" not in drawn


def test_two_bars_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rich")
    screen = Terminal()
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, screen)
    monkeypatch.setattr(_progress, "PROGRESS_AFTER", 0.0)
    monkeypatch.setenv("TERM", "xterm")
    with (
        guarded_output(),
        _progress.Progress("a.tlog") as first,
        _progress.Progress("b.tlog") as second,
    ):
        first.update(25.0)
        second.update(25.0)
        print("\x1b]0;row\x07")
    assert screen.getvalue().count("\\x1b") == 1
    assert "\x1b]0" not in screen.getvalue()


def test_logs_that_are_merged_have_one_bar(log: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[bool] = []

    class Bar(_progress.Progress):
        def __init__(self, name: str, enabled: bool = True) -> None:
            made.append(enabled)
            super().__init__(name, enabled)

    monkeypatch.setattr(_reading, "Progress", Bar)
    assert cli.main(["merge", "--quiet", log, log]) == 0
    assert made == [True, False]


def test_progress_keeps_quiet_for_short_waits(log: str, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert cli.main(["dump", "--quiet", log]) == 0
    assert terminal.getvalue() == ""


def options_for(write: object, **more: object) -> SimpleNamespace:
    """Options of the native loop that print all as JSON."""
    values: dict[str, object] = {
        "format": "json", "write": write, "record": None, "wanted": lambda kind: True,
        "types": None, "progress": lambda percent: None, "source_system": None,
        "source_component": None, "link": None, "show_source": False, "show_seq": False,
        "separator": ",", "columns": [], "local_time": local_time,
    }  # fmt: skip
    return SimpleNamespace(**values | more)


def test_native_loop_writes_in_portions_and_tells_how_far_it_is(long_log: str) -> None:
    sizes: list[int] = []
    percents: list[float] = []
    link = mavutil.mavlink_connection(long_log, dialect="ardupilotmega")
    dump_log(link, options_for(lambda data: sizes.append(len(data)), progress=percents.append))
    assert len(sizes) > 10
    assert max(sizes) < 270_000
    assert percents == sorted(percents)
    assert len(percents) == 2
    assert 0 < percents[0] < percents[1] < 100


def test_native_loop_asks_once_for_each_type_and_second(long_log: str) -> None:
    asked: list[str] = []
    seconds: list[int] = []
    link = mavutil.mavlink_connection(long_log, dialect="ardupilotmega")
    options = options_for(
        lambda data: None,
        format="standard",
        wanted=lambda kind: asked.append(kind) or True,
        local_time=lambda second: seconds.append(second) or "then",
    )
    dump_log(link, options)
    assert len(asked) == len(set(asked)) > 20
    assert len(seconds) == len(set(seconds)) > 100


def test_a_callback_that_raises_ends_the_native_loop(long_log: str) -> None:
    """What was formatted before is written all the same, and nothing twice."""
    written: list[bytes] = []

    def stop(_percent: float) -> None:
        raise KeyboardInterrupt

    link = mavutil.mavlink_connection(long_log, dialect="ardupilotmega")
    with pytest.raises(KeyboardInterrupt):
        dump_log(link, options_for(written.append, progress=stop))
    lines = b"".join(written).splitlines()
    assert len(lines) == len(set(lines)) == 16384

    def fail(_data: bytes) -> None:
        raise OSError("the disk is full")

    link = mavutil.mavlink_connection(long_log, dialect="ardupilotmega")
    with pytest.raises(OSError, match="the disk is full"):
        dump_log(link, options_for(fail))


def test_native_loop_refuses_what_it_does_not_know(log: str, tmp_path: Path) -> None:
    link = mavutil.mavlink_connection(log, dialect="ardupilotmega")
    for wrong in ({"format": "xml"}, {"format": "csv", "columns": ["NO_SUCH_TYPE"]}):
        with pytest.raises(ValueError, match="no such"):
            dump_log(link, options_for(print, **wrong))
    link.close()
    empty = tmp_path / "empty.tlog"
    empty.write_bytes(b"")
    for unready in (link, mavutil.mavlink_connection(str(empty))):
        with pytest.raises(RuntimeError, match="not ready"):
            dump_log(unready, options_for(print))


def test_interrupt_ends_a_long_dump_quietly(long_log: str) -> None:
    command = [sys.executable, "-m", "mavwire", "dump", long_log]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        process.stdout.read(1000)  # far from its end, and the pipe has no room for the rest
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert (process.returncode, error) == (cli.EXIT_INTERRUPTED, b"")
