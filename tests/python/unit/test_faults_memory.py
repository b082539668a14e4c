"""No memory left: what is read, converted or routed then ends with an error that says so, and no file is half there."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from mavwire import traffic
from unit.faults import python

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="limits of memory are those of Linux"
)

ACTIONS = {
    "link": "drain(mavutil.mavlink_connection(log))",
    "parquet": "convert([log], out)",
    "mcap": "convert([log], out, format='mcap')",
    "repair": "repair(log, out / 'made.tlog')",
    "bridge": """
with Bridge(["udpin:127.0.0.1:0"]) as bridge:
    for _ in range(100):
        bridge.send(heartbeat() * 100)
    bridge.stats()
""",
}
EXTRA = [1_000_000, 300, 6000]
"""kB that a process may have more than it has when it begins: at first more than enough."""
ENDS = {"done", "MemoryError", "OSError", "BlockingIOError", "ended with -6"}
"""-6: what cannot be allocated natively ends the process with a line about it."""
DRAFTS = (".part", ".json")

# Runs each action in a fork with so many kB more than the process has, and tells what came of it.
SQUEEZED = """
import json, os, pathlib, resource, sys
os.environ["RUST_BACKTRACE"] = "0"  # it takes its time
import mavwire
from mavwire import Bridge, cli, mavutil, open_log, traffic
from mavwire.logs.conversion import convert
from mavwire.logs.rewriting import repair
from unit.link_tools import Capture, drain, heartbeat
log, folder = sys.argv[1:]
def used():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[0]) * resource.getpagesize()
def squeezed(action, kilobytes):
    read, write = os.pipe()
    pid = os.fork()
    if pid == 0:
        told = "done"
        try:
            resource.setrlimit(resource.RLIMIT_AS, (used() + 1024 * kilobytes,) * 2)
            action()
        except BaseException as error:
            told = type(error).__name__
        os.write(write, told.encode())
        os._exit(0)
    os.close(write)
    told = os.read(read, 99).decode()
    os.close(read)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    return told if code == 0 else f"ended with {code}"
"""


def test_no_file_is_half_there_where_memory_ends(tmp_path: Path) -> None:
    """A process may end where the system has no memory for it, as Rust's allocator has it; what has its name by then is
    whole, and what Python is told of is an exception.
    """
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 10_000)
    program = f"""{SQUEEZED}
actions, extra = {ACTIONS!r}, {EXTRA!r}
found = {{}}
for name, text in actions.items():
    code = compile(text, name, "exec")
    for kilobytes in extra:
        out = pathlib.Path(folder, name, str(kilobytes))
        out.mkdir(parents=True)
        told = squeezed(lambda: exec(code, globals()), kilobytes)
        left = {{str(one.relative_to(out)): one.stat().st_size for one in out.rglob("*") if one.is_file()}}
        found.setdefault(name, []).append([told, left])
print(json.dumps(found))
"""
    done = python(program, str(log), str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    ends = set()
    for name, rows in json.loads(done.stdout.splitlines()[-1]).items():
        (told, whole), *squeezed = rows
        assert told == "done", name
        for how, left in squeezed:
            ends.add(how)
            assert how in ENDS, (name, how)
            made = {path: size for path, size in left.items() if not path.endswith(DRAFTS)}
            assert made.items() <= whole.items(), (name, how)
    assert ends != {"done"}, "there was memory enough for all"


# What a program or an option asks for beyond the memory that there is: the action, and what comes of it.
ASKED = {
    "a piece of a log": (
        "mavutil.mavlogfile(sparse, notimestamps=True).recv(1 << 40)",
        "MemoryError",
    ),
    "input": ("mav.parse_buffer(large)", "MemoryError"),
    "what goes on after that": (
        """
with contextlib.suppress(MemoryError):
    mav.parse_buffer(large)
assert mav.total_bytes_received == 0
assert [msg.get_type() for msg in mav.parse_buffer(heartbeat())] == ["HEARTBEAT"]
""",
        "done",
    ),
    "a queue": (
        """
with socket.create_server(("127.0.0.1", 0)) as server, Bridge() as bridge:
    bridge.add(f"tcp:127.0.0.1:{server.getsockname()[1]}", name="link", queue_bytes=1 << 30)
    peer = server.accept()[0]  # which reads nothing
    def link():
        return next(one for one in bridge.stats()["links"] if one["name"] == "link")
    while link()["state"] != "up":
        pass
    while not link()["dropped"]:
        bridge.send(frames)
    assert link()["queued_bytes"] < 1 << 30
""",
        "done",
    ),
}


def test_what_is_asked_for_beyond_the_memory_is_refused(tmp_path: Path) -> None:
    """A size that a program or an option says ends no process."""
    sparse = tmp_path / "sparse.tlog"
    traffic.generate(sparse, 10)
    with open(sparse, "r+b") as file:
        file.truncate(1 << 32)
    program = f"""{SQUEEZED}
import contextlib, socket
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import pack
sparse = log
mav = mavlink.MAVLink(None)
large = bytes(300 << 20)
frames = pack(mavlink.MAVLink_file_transfer_protocol_message(0, 0, 0, [1] * 251), 0) * 10_000
told = {{}}
for name, (text, _) in {ASKED!r}.items():
    code = compile(text, name, "exec")
    told[name] = squeezed(lambda: exec(code, globals()), 200_000)
print(json.dumps(told))
"""
    done = python(program, str(sparse), str(tmp_path))
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    assert told == {name: end for name, (_, end) in ASKED.items()}, done.stderr


def test_input_takes_the_room_of_what_was_parsed(tmp_path: Path) -> None:
    """There need not be memory for both."""
    program = f"""{SQUEEZED}
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import pack
mav = mavlink.MAVLink(None)
mav.robust_parsing = True
frames = pack(mavlink.MAVLink_file_transfer_protocol_message(0, 0, 0, [1] * 251), 0) * 10_000
assert mav.parse_char(bytes(24 << 20) + frames).get_type() == "BAD_DATA"
more = frames * 6
def parse():
    assert mav.parse_char(more).get_type() == "FILE_TRANSFER_PROTOCOL"
print(squeezed(parse, 12_000))
"""
    done = python(program, "", "")
    assert (done.returncode, done.stdout.strip()) == (0, "done"), done.stderr
