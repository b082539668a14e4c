"""What is written when it is complete takes the place of a file, never of a device, a pipe or a link."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import mavwire
import pytest
from mavwire import cli, traffic
from mavwire.logs.conversion import convert
from mavwire.logs.rewriting import cut, merge
from mavwire.logs.targets import file_to_write
from mavwire.plots import charts
from unit.faults import python

needs_pipes = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 300)
    return path


def writers(flight: Path) -> list[tuple[str, Callable[[str], object]]]:
    from mavwire.plots import draw_map

    return [
        ("x.tlog", lambda out: cut(flight, out)),
        ("x.tlog", lambda out: merge([flight, flight], out)),
        ("x.csv", lambda out: mavwire.open_log(flight)["ATTITUDE"].write(out)),
        ("x.kml", lambda out: draw_map(flight, out)),
    ]


@needs_pipes
def test_a_pipe_stays_a_pipe(flight, tmp_path):
    for name, write in writers(flight):
        pipe = tmp_path / name
        pipe.unlink(missing_ok=True)
        os.mkfifo(pipe)
        with pytest.raises(ValueError, match="a device or a pipe"):
            write(str(pipe))
        assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert cli.main(["cut", str(flight), "-o", str(tmp_path / "x.tlog")]) == 1


def test_a_link_stays_a_link(flight, tmp_path):
    for name, write in writers(flight):
        target, link = tmp_path / f"target of {name}", tmp_path / name
        target.unlink(missing_ok=True)
        link.unlink(missing_ok=True)
        try:
            link.symlink_to(target)
        except OSError:
            pytest.skip("no links here")
        write(str(link))
        write(str(link))
        assert link.is_symlink() and target.stat().st_size > 0


def test_folders_and_places_that_are_not_there(tmp_path):
    with pytest.raises(ValueError, match="is a folder"):
        file_to_write(tmp_path)
    assert file_to_write(str(tmp_path / "x")) == str(tmp_path / "x")


def test_a_folder_that_is_not_there_is_not_made(flight, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, write in writers(flight):
        with pytest.raises(FileNotFoundError, match="no such folder") as caught:
            write(f"typo/{name}")
        assert caught.value.filename == "typo"
        write(name)
    assert not (tmp_path / "typo").exists()
    assert cli.main(["repair", str(flight), "-o", "typo/x.tlog"]) == 1
    assert capsys.readouterr().err == "mavwire repair: error: typo: there is no such folder\n"


def test_an_error_of_a_table_names_its_file(flight, tmp_path):
    """A limit stands for the full disk; it is a process of its own that has it."""
    program = """
import errno, resource, sys
import mavwire
from mavwire.logs.formats import TABLE_FORMATS
log, folder = sys.argv[1:]
table = mavwire.open_log(log)["ATTITUDE"]
resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
for suffix in (*TABLE_FORMATS, "csv.zst"):
    try:
        table.write(f"{folder}/x.{suffix}")
    except OSError as error:
        assert error.errno == errno.EFBIG and error.filename == f"{folder}/x.{suffix}", error
    else:
        raise AssertionError(suffix)
"""
    pytest.importorskip("resource")
    done = python(program, str(flight), str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["x.tlog.gz", "x.ZST"])
def test_a_log_does_not_look_compressed(flight, tmp_path, name):
    with pytest.raises(ValueError, match="uncompressed"):
        cut(flight, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_urls_are_no_folders(flight, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for logs, out in (([flight], "s3://bucket/out"), (["s3://bucket/x.tlog"], "out")):
        with pytest.raises(ValueError, match="is a URL"):
            convert(logs, out)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="others have no such permissions")
def test_who_may_read_a_file_stays(flight, tmp_path):
    for name, write in writers(flight):
        out = tmp_path / name
        out.write_text("before")
        out.chmod(0o600)
        write(str(out))
        assert stat.S_IMODE(out.stat().st_mode) == 0o600, name
        assert out.stat().st_size > len("before")


def test_a_file_that_may_not_be_written_stays(flight, tmp_path, monkeypatch, capsys):
    """Also at the end of a link, and it is told before the log is read."""
    if getattr(os, "geteuid", lambda: 1)() == 0:  # to whom all is allowed
        monkeypatch.setattr(os, "access", lambda path, mode: not os.path.exists(path))
    monkeypatch.setattr(charts, "read_series", None)
    every = [*writers(flight), ("x.html", lambda out: charts.plot(flight, "ATTITUDE.roll", out))]
    for name, write in every:
        out, link = tmp_path / name, tmp_path / f"link of {name}"
        out.write_text("before")
        out.chmod(0o444)
        link.symlink_to(out)
        for place in (out, link):
            with pytest.raises(PermissionError) as caught:
                write(str(place))
            assert caught.value.filename == str(place)
        assert out.read_text() == "before" and link.is_symlink()
        out.unlink()
        link.unlink()
    (tmp_path / "x.tlog").touch(0o444)
    assert cli.main(["cut", str(flight), "-o", str(tmp_path / "x.tlog")]) == 1
    said = f"mavwire cut: error: {tmp_path / 'x.tlog'}: Permission denied\n"
    assert capsys.readouterr().err == said


@pytest.mark.skipif(not os.path.exists("/dev/stdout"), reason="needs names of open files")
def test_a_file_that_is_open_already_keeps_its_place(flight, tmp_path):
    log = tmp_path / "all.txt"
    log.write_text("before\n")
    code = f"from mavwire import cli; exit(cli.main(['cut', {str(flight)!r}, '-o', '/dev/stdout']))"
    with log.open("a") as out:
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, check=False, stdout=out, stderr=subprocess.PIPE)
    assert (done.returncode, log.read_text()) == (1, "before\n")
    assert b"name a file to write" in done.stderr
