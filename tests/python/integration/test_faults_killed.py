"""Processes that are killed or told to end at any moment: what was promised is on the disk, and nothing is half there."""

from __future__ import annotations

import json
import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from integration.processes import announced_ports, mavwire
from mavwire import mavutil, open_log, traffic
from mavwire.logs.rewriting import repair
from unit.bridge_tools import LIMIT, udp_peer, wait_until
from unit.faults import ENVIRONMENT, files
from unit.link_tools import heartbeat

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
RECORD = 29

RECORDER = """
import sys
from mavwire import mavutil
link = mavutil.mavlink_connection(sys.argv[1])
link.setup_logfile(sys.argv[2])
while True:
    link.recv_match(blocking=True)
"""


def numbered(n: int) -> bytes:
    return heartbeat(n % 256, sysid=1 + n // 256)


def numbers(path: Path) -> list[int]:
    return [msg.get_seq() + 256 * (msg.get_srcSystem() - 1) for msg in open_log(path)]


def assert_untorn(path: Path, promised: int) -> None:
    """All of the log is there up to its end, which may be in the middle of a record."""
    size = path.stat().st_size
    assert numbers(path) == list(range(size // RECORD)) and size // RECORD >= promised
    # The cut end is named, and dropped.
    done = repair(path, path.with_suffix(".repaired"))
    assert (done.written, done.bad_bytes) == (size // RECORD, size % RECORD)
    with mavutil.mavlink_connection(str(path)) as log:
        assert sum(1 for _ in iter(log.recv_msg, None)) >= size // RECORD


def record_until_killed(
    send: Callable[[bytes], object], kill: Callable[[], object], path: Path
) -> None:
    """Some records are waited for on the disk; while more come, the process is killed."""
    for n in range(500):
        send(numbered(n))
    wait_until("what was promised", lambda: path.stat().st_size >= 500 * RECORD)
    more = random.Random(time.time_ns()).randrange(3000)
    for n in range(500, 500 + more):
        send(numbered(n))
    kill()
    assert_untorn(path, 500)


def test_a_link_that_records_is_killed(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(LIMIT)
        device = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        for _ in range(3):
            command = [sys.executable, "-c", RECORDER, device, str(path)]
            with subprocess.Popen(command, env=ENVIRONMENT) as process:
                peer, _ = server.accept()
                wait_until("the log", path.exists)
                with peer:
                    peer.settimeout(LIMIT)
                    record_until_killed(peer.sendall, process.kill, path)
            path.unlink()


def test_a_bridge_that_records_is_killed(tmp_path: Path) -> None:
    for turn in range(2):
        folder = tmp_path / str(turn)
        arguments = ["udpin:127.0.0.1:0", "--record", str(folder), "--record-flush", "10ms"]
        with mavwire("bridge", *arguments) as (process, lines), udp_peer() as peer:
            peer.connect(("127.0.0.1", announced_ports(lines)[0]))
            (path,) = folder.iterdir()

            sent = 0

            def slowly(frame: bytes, path: Path = path, peer: socket.socket = peer) -> None:
                """A hundred at a time, so that no datagram is lost on the way."""
                nonlocal sent
                peer.send(frame)
                sent += 1
                if sent % 100 == 0:
                    wait_until("it", lambda: path.stat().st_size >= sent * RECORD)

            record_until_killed(slowly, process.kill, path)
            process.wait(LIMIT)


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Long enough that work on it takes a while."""
    folder = tmp_path_factory.mktemp("log")
    traffic.generate(folder / "short.tlog", 30_000)
    path = folder / "flight.tlog"
    path.write_bytes((folder / "short.tlog").read_bytes() * 8)
    return path


WRITING = {
    "repair": ["repair", "LOG", "-o", "OUT/made.tlog"],
    "anonymize": ["anonymize", "LOG", "-o", "OUT/made.tlog"],
    "mcap": ["convert", "LOG", "-o", "OUT", "--format", "mcap"],
    "parquet": ["convert", "LOG", "-o", "OUT", "--types", "ATTITUDE"],
}


def begin(name: str, log: Path, out: Path) -> subprocess.Popen[str]:
    words = [word.replace("LOG", str(log)).replace("OUT", str(out)) for word in WRITING[name]]
    return subprocess.Popen(
        [sys.executable, "-m", "mavwire", *words, "--quiet"],
        env=ENVIRONMENT, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def begun(out: Path) -> bool:
    """Whether the work itself is being written."""
    return any(not one.startswith("manifest.") and one.endswith(".part") for one in files(out))


def finished(out: Path) -> list[str]:
    """Files under their own names."""
    drafts = (".part", ".json")
    return [one for one in files(out) if not one.endswith(drafts)]


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("name", WRITING)
def test_what_is_being_written_appears_whole_or_not_at_all(
    name: str, number: signal.Signals, flight: Path, tmp_path: Path
) -> None:
    process = begin(name, flight, tmp_path)
    with process:
        wait_until("a draft", lambda: begun(tmp_path) or process.poll() is not None)
        process.send_signal(number)
        assert process.stderr is not None
        said = process.stderr.read()
    in_order = number is not signal.SIGKILL
    interrupted = 130 if in_order else -number
    assert process.returncode in (0, interrupted) and said == "", said
    # The signal may come when all is written and the process has not ended yet.
    assert len(finished(tmp_path)) <= 1 and (finished(tmp_path) or process.returncode != 0)
    if in_order:
        assert not any(tmp_path.rglob("*.part")), "Ctrl-C cleans up"
        assert finished(tmp_path) or not any(one.is_dir() for one in tmp_path.iterdir())
    if number is signal.SIGKILL:
        with begin(name, flight, tmp_path) as process:
            assert process.wait(2 * LIMIT) == 0
        assert len(finished(tmp_path)) == 1
        # A folder of conversions knows its own drafts; that of a single file may belong to a run that goes on.
        assert "convert" not in WRITING[name] or not any(tmp_path.rglob("*.part"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_runs_until_it_is_told_ends_quietly(number: signal.Signals, flight: Path) -> None:
    """A bridge closes its recording on both; it says nothing but what it said at the start, and neither do others."""
    interrupted = (0, 130) if number is signal.SIGINT else (-number,)
    for words, codes in (
        (["bridge"], (0,)),
        (["sim", "--out"], interrupted),
        (["replay", str(flight), "--out"], interrupted),
    ):
        with udp_peer() as peer:
            out = f"udpout:127.0.0.1:{peer.getsockname()[1]}"
            with mavwire(*words, out) as (process, lines):
                if words[0] == "replay":
                    assert peer.recv(65536)
                else:
                    assert lines.get(timeout=LIMIT).endswith("Ctrl-C ends it")
                process.send_signal(number)
                assert process.wait(LIMIT) in codes, words
            assert lines.empty(), words


@pytest.mark.parametrize("ignored", [False, True])
def test_a_terminal_that_closes_loses_no_record(tmp_path: Path, ignored: bool) -> None:
    """Under `nohup` the bridge goes on."""
    logs = tmp_path / "logs"
    words = [sys.executable, "-m", "mavwire", "bridge", "udpin:127.0.0.1:0", "--json", "0.1s",
             "--record", str(logs), "--record-flush", "1h"]  # fmt: skip
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN if ignored else signal.SIG_DFL)
    try:
        process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    finally:
        signal.signal(signal.SIGHUP, before)
    with process:
        assert process.stdout is not None
        lines = (json.loads(line) for line in process.stdout if line.startswith("{"))
        where = next(lines)["links"][0]["endpoint"].split(":")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            vehicle.connect((where[1], int(where[2])))
            for seq in range(100):
                vehicle.send(heartbeat(seq))
            while sum(one["received"] for one in next(lines)["links"]) < 100:
                pass
        process.send_signal(signal.SIGHUP)
        if ignored:
            next(lines)
            next(lines)
            process.send_signal(signal.SIGTERM)
        assert process.wait(LIMIT) == 0
    (log,) = logs.iterdir()
    assert sum(1 for _ in open_log(log)) == 100
