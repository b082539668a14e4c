"""Disks that are full or may not be written, files that vanish or shrink while they are read."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from mavwire import mavutil, open_log, traffic
from mavwire.logs import store
from mavwire.logs.conversion import convert
from mavwire.logs.formats import FORMATS
from unit.faults import files, mavwire, python, run
from unit.link_tools import drain, heartbeat, record

MOST_BYTES = 4096
"""Of a file: a manifest fits, nothing else does."""

COMMANDS = {
    "parquet": ["convert", "LOG", "-o", "OUT"],
    "csv": ["convert", "LOG", "-o", "OUT", "--format", "csv", "--compression", "gzip"],
    "jsonl": ["convert", "LOG", "-o", "OUT", "--format", "jsonl", "--compression", "zstd"],
    "arrow": ["convert", "LOG", "-o", "OUT", "--format", "arrow"],
    "mcap": ["convert", "LOG", "-o", "OUT", "--format", "mcap"],
    "mcap-json": ["convert", "LOG", "-o", "OUT", "--format", "mcap-json"],
    "cut": ["cut", "LOG", "-o", "OUT/made.tlog"],
    "repair": ["repair", "LOG", "-o", "OUT/made.tlog"],
    "anonymize": ["anonymize", "LOG", "-o", "OUT/made.tlog"],
    "merge": ["merge", "--exact", "LOG", "LOG", "-o", "OUT/made.tlog"],
    "map": ["map", "LOG", "-o", "OUT/made.html"],
    "plot": ["plot", "LOG", "ATTITUDE.roll", "-o", "OUT/made.html"],
}

pytestmark = pytest.mark.skipif(os.name != "posix", reason="limits and mounts are those of POSIX")


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "flight.tlog"
    traffic.generate(path, 3000)
    return path


# Runs each command with `LOG` and `OUT` filled in, and tells exit codes, errors and the files that are left.
RUNNER = """
import contextlib, io, json, pathlib, sys
from mavwire import cli
from unit.faults import files
def run_all(commands, log, out):
    told = {}
    for name, words in commands.items():
        folder = pathlib.Path(out, name)
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            words = [one.replace("LOG", log).replace("OUT", str(folder)) for one in words]
            code = cli.main(words)
        told[name] = [code, said.getvalue(), files(folder)]
    return told
commands, log, out = json.loads(sys.argv[1]), *sys.argv[2:]
"""


def test_commands_say_that_the_disk_is_full_and_leave_nothing_half_written(
    flight: Path, tmp_path: Path
) -> None:
    program = f"""{RUNNER}
import resource
for name in commands:
    pathlib.Path(out, name).mkdir()
resource.setrlimit(resource.RLIMIT_FSIZE, ({MOST_BYTES}, resource.RLIM_INFINITY))
full = run_all(commands, log, out)
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
print(json.dumps([full, run_all(commands, log, out)]))
"""
    done = python(program, json.dumps(COMMANDS), str(flight), str(tmp_path))
    assert done.returncode == 0, done.stderr
    full, again = json.loads(done.stdout.splitlines()[-1])
    for name, (code, said, left) in full.items():
        assert code == 1, name
        assert len(said.splitlines()) == 1 and "File too large" in said, said
        assert [one for one in left if one != "manifest.json"] == [], (name, left)
        assert f"{tmp_path}/{name}/" in said, said
    for name in ("map", "plot"):
        assert f"{tmp_path}/{name}/made.html: File too large" in full[name][1]
    for name in ("cut", "repair", "anonymize", "merge"):
        assert f"{tmp_path}/{name}/made.tlog: File too large" in full[name][1]
    for name in FORMATS:
        assert ": File too large" in full[name][1]
    for name, (code, said, made) in again.items():
        assert (code, said) == (0, ""), name
        assert any(one != "manifest.json" for one in made)
        assert not any(one.endswith(".part") for one in made)


@pytest.mark.parametrize("is_followed", [False, True])
def test_a_dump_to_a_full_disk_ends_with_an_error(
    is_followed: bool, flight: Path, tmp_path: Path
) -> None:
    """What was there stays; of a log that is followed there are the records that fit."""
    out = tmp_path / "made.tlog"
    out.write_text("precious")
    options = ["--follow"] if is_followed else []
    done = mavwire("dump", str(flight), "--quiet", "-o", str(out), *options, before="ulimit -f 8")
    assert done.returncode == 1
    assert done.stderr == f"mavwire dump: error: --output {out}: File too large\n"
    assert os.listdir(tmp_path) == [out.name]
    if not is_followed:
        assert out.read_text() == "precious"
        return
    found, whole = list(open_log(out)), list(open_log(flight))
    assert 0 < len(found) < len(whole)
    assert [bytes(msg.get_msgbuf()) for msg in found] == [
        bytes(msg.get_msgbuf()) for msg in whole[: len(found)]
    ]


def _works(command: list[str]) -> bool:
    if shutil.which(command[0]) is None:
        return False
    return not subprocess.run(command, check=False, capture_output=True).returncode


@pytest.mark.parametrize(
    ("mount", "said"),
    [("size=16k", "No space left on device"), ("ro", "Read-only file system")],
)
def test_disks_that_are_full_and_disks_that_may_not_be_written(
    mount: str, said: str, flight: Path, tmp_path: Path
) -> None:
    """In a mount namespace of its own, which takes the disk with it."""
    mounted = [
        "sh",
        "-c",
        f"mount -t tmpfs none {tmp_path} && mkdir {tmp_path}/repair && "
        f'mount -t tmpfs -o remount,{mount} none {tmp_path} && "$@"',
        "sh",
    ]
    # Who is not root may be root of a namespace of users.
    ways = (["unshare", "--mount", *mounted], ["unshare", "--map-root-user", "--mount", *mounted])
    command = next((way for way in ways if _works([*way, "true"])), None)
    if command is None:
        pytest.skip("mounting needs more rights than there are here")
    some = {name: COMMANDS[name] for name in ("parquet", "mcap", "repair")}
    program = f"{RUNNER}print(json.dumps(run_all(commands, log, out)))"
    done = run(
        [*command, sys.executable, "-c", program, json.dumps(some), str(flight), str(tmp_path)]
    )
    assert done.returncode == 0, done.stderr
    for name, (code, error, left) in json.loads(done.stdout.splitlines()[-1]).items():
        assert code == 1 and said in error, (name, error)
        assert len(error.splitlines()) == 1, error
        assert not any(one.endswith(".part") or one.startswith("made.") for one in left), left


def test_a_link_goes_on_recording_when_there_is_room_again(tmp_path: Path) -> None:
    """R66. A limit stands for the full disk; it is a process of its own that has it."""
    program = """
import resource, sys
from mavwire import open_log
from unit.link_tools import Capture, drain, heartbeat
resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, resource.RLIM_INFINITY))
link = Capture()
link.setup_logfile(sys.argv[1])
def receive(first, count):
    for seq in range(first, first + count):
        link.rx += heartbeat(seq % 256, sysid=1 + seq // 256)
        assert len(drain(link)) == 1
receive(0, 1000)
failed = link.logfile_errors
assert failed > 0
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
receive(1000, 1000)
assert link.logfile_errors == failed
link.logfile.close()
order = [msg.get_seq() + 256 * (msg.get_srcSystem() - 1) for msg in open_log(sys.argv[1])]
assert order == sorted(set(order)), "nothing twice"
assert order[:300] == list(range(300)) and order[-1000:] == list(range(1000, 2000))
"""
    done = python(program, str(tmp_path / "flight.tlog"))
    assert done.returncode == 0, done.stderr


def test_a_log_that_vanishes_before_its_turn_is_a_row(flight: Path, tmp_path: Path) -> None:
    logs = [tmp_path / f"{n}.tlog" for n in range(3)]
    for path in logs:
        shutil.copy(flight, path)

    def vanish(_path: str, _percent: float) -> None:
        logs[1].unlink(missing_ok=True)

    rows = convert(logs, tmp_path / "out", progress=vanish)
    assert [row.rows for row in rows] == [3000, 0, 3000]
    assert rows[1].error == "No such file or directory"


def test_a_log_that_vanishes_while_it_is_read_is_read_to_its_end(
    flight: Path, tmp_path: Path
) -> None:
    path = tmp_path / "flight.tlog"
    shutil.copy(flight, path)
    with mavutil.mavlink_connection(str(path)) as link:
        messages = iter(open_log(path))
        next(messages)
        path.unlink()
        assert sum(1 for _ in messages) == 2999
        assert len(drain(link)) == 3000


SHRINKING = """
import os, shutil, sys, threading
import mavwire
from mavwire import cli, mavutil
def begin(name):
    global path, out, size
    path, out = (os.path.join(sys.argv[2], name + end) for end in (".tlog", ".out"))
    shutil.copy(sys.argv[1], path)
    size = os.path.getsize(path)
def shrink(*_):
    os.truncate(path, min(os.path.getsize(path), size // 3))
"""

READERS = {
    "tables": """
def cut():
    for left in range(size, 0, -size // 200):
        os.truncate(path, left)
thread = threading.Thread(target=cut)
thread.start()
while thread.is_alive():
    try:
        mavwire.read(path)
    except ValueError:
        pass
thread.join()
""",
    "messages": """
log = mavwire.open_log(path)
messages = iter(log)
next(messages)
shrink()
assert 0 < sum(1 for _ in messages)
len(log["ATTITUDE"])
os.truncate(path, 0)
assert list(log) == []
""",
    "mavlink_connection": """
with mavutil.mavlink_connection(path) as log:
    log.recv_msg()
    log.data_map  # mapped, and not used by reading
    shrink()
    while log.recv_msg():
        pass
    log.rewind()
    while log.recv_match(type="ATTITUDE"):
        pass
""",
    "convert": """
from mavwire.logs.conversion import convert
(row,) = convert([path], out, progress=shrink)
assert row.error is None and row.rows
assert row.rows == sum(row.files.values())
""",
    "repair": """
from mavwire.logs.rewriting import repair
done = repair(path, out, progress=shrink)
assert sum(1 for _ in mavwire.open_log(out)) == done.written > 0
""",
    "commands": """
import io
from contextlib import redirect_stdout
for command in (["dump"], ["info"], ["loss"], ["summarize"]):
    shrink()
    size //= 2
    with redirect_stdout(io.TextIOWrapper(io.BytesIO())):
        assert cli.main([*command, path]) == 0, command
""",
}


def test_a_log_that_shrinks_under_its_readers_ends_earlier(tmp_path: Path) -> None:
    """No file is mapped by reading, so that no signal ends the process."""
    whole = tmp_path / "whole.tlog"
    traffic.generate(whole, 20_000)
    programs = [f"begin({name!r})\n{reader}" for name, reader in READERS.items()]
    done = python("\n".join([SHRINKING, *programs]), str(whole), str(tmp_path))
    assert (done.returncode, done.stderr) == (0, "")


def test_a_log_that_became_empty_can_be_closed(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(record(heartbeat()) * 3)
    link = mavutil.mavlink_connection(str(path))
    os.truncate(path, 0)
    link.close()
    assert link.f.closed


def test_what_is_interrupted_while_it_is_written_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_fd: int) -> None:
        raise KeyboardInterrupt

    path = tmp_path / "manifest.json"
    path.write_bytes(b"before")
    monkeypatch.setattr(store.os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        store.write_file(str(path), b"after")
    assert files(tmp_path) == ["manifest.json"]
    assert path.read_bytes() == b"before"
