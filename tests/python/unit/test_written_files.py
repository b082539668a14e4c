"""Files that commands write are complete or as they were; what is meant to grow, or streams, does so at once."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

import dataflash_writer
import pytest
from mavwire import cli
from mavwire._atomic_file import Replacement
from mavwire.cli import _output, _reading
from tool_runs import flight_log
from unit.faults import ENVIRONMENT

COMMANDS = {
    "dump": "dump flight.tlog --quiet -o made",
    "mat": "dump flight.tlog --format mat --mat_file made",
    "merge": "merge flight.tlog --quiet -o made",
    "split_sysid": "split_sysid flight.tlog",
    "extract": "extract --mode loiter flight.tlog",
    "isb_extract": "isb_extract batches.bin",
    "extract_batch_imu": "extract_batch_imu batches.bin made",
    "tomfile": "tomfile flight.tlog -o made",
    "togpx": "togpx flight.tlog",
    "kml": "kml flight.tlog -o made",
}
LOGS = {"flight.tlog", "batches.bin"}
# Of the commands that name their files themselves.
NAMES = {"split_sysid": "flight-1.tlog", "isb_extract": "Accel0.csv", "togpx": "flight.tlog.gpx"}


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("logs")
    flight_log(folder / "flight.tlog")
    log = dataflash_writer.Log()
    log.define("ISBH", "QHBBHHQf", "TimeUS,N,type,instance,mul,smp_cnt,SampleUS,smp_rate")
    log.define("ISBD", "QHHaaa", "TimeUS,N,seqno,x,y,z")
    for number in range(3):
        log.add("ISBH", number, number, 0, 0, 1000, 32, 0, 1000.0)
        log.add("ISBD", number, number, 0, *[bytes(64)] * 3)
    log.write(folder / "batches.bin")
    return folder


@pytest.fixture
def folder(logs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in LOGS:
        shutil.copy(logs / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def sigterm_ignored() -> Iterator[None]:
    """SIGTERM that comes when nothing is written ends no tests."""
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture
def ended_while_writing(sigterm_ignored: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """SIGTERM comes when something was written."""
    write = _output.OutputFile.write

    def write_and_end(self: _output.OutputFile, data: bytes) -> None:
        write(self, data)
        signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(_output.OutputFile, "write", write_and_end)


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.usefixtures("ended_while_writing")
def test_what_ends_a_command_leaves_what_was_there(command: str, folder: Path) -> None:
    made = folder / NAMES.get(command, "made")
    made.write_text("precious")
    assert cli.main(COMMANDS[command].split()) == cli.EXIT_INTERRUPTED
    assert made.read_text() == "precious"
    assert {one.name for one in folder.iterdir()} == LOGS | {made.name}


def end_first(act: Callable[[Replacement], None]) -> Callable[[Replacement], None]:
    """SIGTERM comes before a method does what it is for."""

    def end_and_act(self: Replacement) -> None:
        signal.raise_signal(signal.SIGTERM)
        act(self)

    return end_and_act


@pytest.mark.usefixtures("sigterm_ignored")
def test_what_ends_a_command_as_files_are_moved_leaves_none_beside(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Replacement, "finish", end_first(Replacement.finish))
    assert cli.main(COMMANDS["split_sysid"].split()) == cli.EXIT_INTERRUPTED
    assert {one.name for one in folder.iterdir()} == LOGS


@pytest.mark.usefixtures("ended_while_writing")
def test_a_second_signal_leaves_none_beside(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Replacement, "discard", end_first(Replacement.discard))
    assert cli.main(COMMANDS["split_sysid"].split()) == cli.EXIT_INTERRUPTED
    assert {one.name for one in folder.iterdir()} == LOGS


@pytest.mark.parametrize("command", COMMANDS)
def test_a_complete_file_takes_the_place_of_another(command: str, folder: Path) -> None:
    made = folder / NAMES.get(command, "LOITER1.tlog" if command == "extract" else "made")
    if command != "extract":  # which takes a name that no file has
        made.write_text("to be replaced")
    assert cli.main(COMMANDS[command].split()) == 0
    assert made.read_bytes()[:14] != b"to be replaced"
    assert not [one for one in os.listdir(folder) if one.startswith(".")]


@pytest.mark.parametrize("link", [os.link, os.symlink])
@pytest.mark.parametrize("command", sorted(COMMANDS.keys() - {"extract"}))
def test_a_log_is_not_written_over(
    command: str, link: object, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = folder / ("batches.bin" if "batch" in COMMANDS[command] else "flight.tlog")
    made, before = folder / NAMES.get(command, "made"), log.read_bytes()
    link(log, made)  # type: ignore[operator]
    assert cli.main(COMMANDS[command].split()) == 1
    assert f"{made.name} is the log itself" in capsys.readouterr().err
    assert log.read_bytes() == before


def dumped(folder: Path) -> bytes:
    """What a complete file has."""
    assert cli.main(["dump", "flight.tlog", "--quiet", "-o", "whole"]) == 0
    return (folder / "whole").read_bytes()


def test_a_log_that_is_followed_is_there_after_an_interrupt(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(seconds: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(_reading.time, "sleep", interrupt)
    command = "dump flight.tlog --quiet --follow -o made"
    assert cli.main(command.split()) == cli.EXIT_INTERRUPTED
    assert (folder / "made").read_bytes() == dumped(folder)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_has_at_once_what_is_written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No copy of it waits in a temporary folder."""
    monkeypatch.setenv("TMPDIR", str(folder / "none"))
    os.mkfifo("made")
    read: list[bytes] = []
    reader = threading.Thread(
        target=lambda: read.append((folder / "made").read_bytes()), daemon=True
    )
    reader.start()
    assert cli.main(COMMANDS["dump"].split()) == 0
    reader.join(30)
    assert read == [dumped(folder)]


@pytest.mark.parametrize("command", ["dump flight.tlog -o made", "merge flight.tlog -o made"])
def test_who_reads_no_more_of_the_messages_is_told_of_the_file(command: str, folder: Path) -> None:
    """It is not complete, as the rest of the log was not read."""
    (folder / "made").write_text("precious")
    theirs, ours = os.pipe()
    os.close(theirs)
    done = subprocess.run(
        [sys.executable, "-m", "mavwire", *command.split()],
        check=False, stdout=ours, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT,
    )  # fmt: skip
    os.close(ours)
    reason = "--output made is not written: nobody reads standard output any more"
    assert done.stderr == f"mavwire {command.split(maxsplit=1)[0]}: error: {reason}\n"
    assert done.returncode == 1
    assert (folder / "made").read_text() == "precious"
    assert {one.name for one in folder.iterdir()} == LOGS | {"made"}


@pytest.mark.parametrize("suffix", ["png", "svg", "PDF"])
def test_a_picture_that_cannot_be_written_leaves_the_file(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures = pytest.importorskip("matplotlib.figure", reason="matplotlib is not installed")
    from mavwire.plots.windows import Figures

    def drawn() -> list[str]:
        figure = Figures(str(picture))
        figure.figure("one")
        return figure.finish()

    picture = tmp_path / f"made.{suffix}"
    assert drawn() == [str(picture)]
    whole = picture.read_bytes()
    save = figures.Figure.savefig

    def save_half(self: object, place: object, **options: object) -> None:
        save(self, place, **options)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(figures.Figure, "savefig", save_half)
    picture.write_text("precious")
    with pytest.raises(OSError, match="No space") as caught:
        drawn()
    assert caught.value.filename == str(picture)
    assert picture.read_text() == "precious"
    assert whole and [one.name for one in tmp_path.iterdir()] == [picture.name]


def test_a_compressed_picture_does_not_tell_where_it_was_written(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    from mavwire.plots.windows import Figures

    picture = tmp_path / "made.svgz"
    drawn = Figures(str(picture))
    drawn.figure("one")
    drawn.finish()
    assert b".mavwire_" not in picture.read_bytes()


@pytest.mark.usefixtures("sigterm_ignored")
def test_what_ends_a_command_leaves_no_half_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures = pytest.importorskip("matplotlib.figure", reason="matplotlib is not installed")
    from mavwire.plots.windows import Figures

    def end(self: object, place: IO[bytes], **options: object) -> None:
        place.write(b"half")
        signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(figures.Figure, "savefig", end)
    drawn = Figures(str(tmp_path / "made.png"))
    drawn.figure("one")
    with pytest.raises(KeyboardInterrupt):
        drawn.finish()
    assert not os.listdir(tmp_path)
