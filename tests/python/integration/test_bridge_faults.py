"""Bridges as processes: each end is killed and started again, and the clock on the wall jumps."""

from __future__ import annotations

import shutil
import signal
import socket
import struct
import subprocess
import time
from pathlib import Path

import pytest
from integration.processes import announced_ports, mavwire
from mavwire import open_log
from unit.bridge_tools import LIMIT, UDP, command, receive, udp_peer, wait_until
from unit.link_tools import KEY, heartbeat

DAY = 86_400
# Stands before the system's own, and adds the seconds that a file has.
CLOCK = """
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static volatile int64_t *ahead;

__attribute__((constructor)) static void begin(void) {
    int fd = open(getenv("CLOCK_AHEAD"), O_RDONLY);
    void *mapped = mmap(0, sizeof *ahead, PROT_READ, MAP_SHARED, fd, 0);
    ahead = mapped == MAP_FAILED ? 0 : mapped;
}

int clock_gettime(clockid_t id, struct timespec *now) {
    int result = syscall(SYS_clock_gettime, id, now);
    if (result == 0 && id == CLOCK_REALTIME && ahead)
        now->tv_sec += *ahead;
    return result;
}
"""

# A name server that does not answer while the test lasts; the file says that it was asked.
NAMES = """
#include <fcntl.h>
#include <netdb.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int getaddrinfo(const char *node, const char *service, const struct addrinfo *hints,
                struct addrinfo **result) {
    if (node && strstr(node, "vehicle.test")) {
        close(open(getenv("ASKED"), O_CREAT | O_WRONLY, 0600));
        sleep(600);
    }
    return EAI_AGAIN;
}
"""


def reset(connection: socket.socket) -> None:
    """End it as the system does for a process that is killed."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


def fly(vehicle: socket.socket, station: socket.socket) -> None:
    """Send until the station hears it, and have it answer."""
    station.settimeout(0.05)
    end = time.monotonic() + LIMIT
    heard = b""
    while not heard:
        assert time.monotonic() < end, "nothing comes through"
        vehicle.send(heartbeat())
        try:
            heard = station.recv(65536)
        except TimeoutError:
            continue
    assert heard.startswith(heartbeat())
    station.settimeout(LIMIT)
    station.sendall(command(1))
    assert receive(vehicle) == command(1)


def test_each_end_is_killed_and_started_again() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(LIMIT)
        links = [f"udpin:127.0.0.1:{port}", f"tcp:127.0.0.1:{server.getsockname()[1]}"]
        for _ in range(2):
            with mavwire("bridge", *links) as (process, lines):
                announced_ports(lines)
                station, _ = server.accept()
                for _ in range(2):
                    with udp_peer() as vehicle:  # with another port each time
                        vehicle.connect(("127.0.0.1", port))
                        fly(vehicle, station)
                        reset(station)
                        station, _ = server.accept()
                        fly(vehicle, station)
                process.send_signal(signal.SIGKILL)
                process.wait(LIMIT)
                station.settimeout(LIMIT)
                with station:
                    while station.recv(65536):
                        pass


def before_the_system(folder: Path, text: str) -> dict[str, str]:
    """The environment of a process that has these functions instead of the system's own."""
    source, library = folder / "instead.c", folder / "instead.so"
    source.write_text(text)
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler: apt-get install gcc")
    build = [compiler, "-shared", "-fPIC", "-o", str(library), str(source)]
    if subprocess.run(build, capture_output=True, check=False).returncode:
        pytest.skip("it does not compile here")
    return {"LD_PRELOAD": str(library)}


@pytest.fixture
def clock(tmp_path: Path) -> dict[str, str]:
    """The environment of a process whose clock the file `ahead` moves."""
    ahead = tmp_path / "ahead"
    ahead.write_bytes(bytes(8))
    return {**before_the_system(tmp_path, CLOCK), "CLOCK_AHEAD": str(ahead)}


@pytest.mark.parametrize("kind", ["udpin", "udpout", "tcpin", "tcp"])
def test_ctrl_c_ends_looking_a_name_up(tmp_path: Path, kind: str) -> None:
    asked = tmp_path / "asked"
    env = {**before_the_system(tmp_path, NAMES), "ASKED": str(asked)}
    with mavwire("bridge", f"{kind}:vehicle.test:14550", env=env) as (process, lines):
        wait_until("the question", asked.exists)
        process.send_signal(signal.SIGINT)
        assert process.wait(LIMIT) in (0, 130)
    assert lines.empty(), "nothing to read about that"


def test_the_clock_jumps(tmp_path: Path, clock: dict[str, str]) -> None:
    """Routes, copies and peers are a matter of time that passes, and signatures only ever move on."""
    logs, config = tmp_path / "logs", tmp_path / "bridge.toml"
    with udp_peer() as station:
        config.write_text(f"""
            dedup = {LIMIT}
            [record]
            directory = "{logs}"
            [[link]]
            endpoint = "{UDP}"
            [[link]]
            endpoint = "udpout:127.0.0.1:{station.getsockname()[1]}"
            signing_key = "{KEY.hex()}"
            sign_out = true
        """)
        jumps = [0, DAY, -400 * DAY, 0]
        stamps = []
        with mavwire("bridge", "--config", str(config), env=clock) as (process, lines):
            port = announced_ports(lines)[0]
            with udp_peer() as vehicle, udp_peer() as other:
                for peer in (vehicle, other):
                    peer.connect(("127.0.0.1", port))
                for seq, jump in enumerate(jumps):
                    Path(clock["CLOCK_AHEAD"]).write_bytes(jump.to_bytes(8, "little", signed=True))
                    vehicle.send(heartbeat(seq, sysid=1))
                    signed, where = station.recvfrom(65536)
                    assert (signed[4], signed[5]) == (seq, 1), "and not the copy"
                    stamps.append(int.from_bytes(signed[-12:-6], "little"))
                    other.send(heartbeat(seq, sysid=1))  # a copy, which goes nowhere
                    station.sendto(command(1, seq), where)
                    assert receive(vehicle) == command(1, seq)
            process.send_signal(signal.SIGTERM)
            assert process.wait(LIMIT) == 0
    assert stamps == sorted(set(stamps)), stamps
    (log,) = logs.iterdir()
    times = [msg._timestamp for msg in open_log(log) if msg.get_type() == "HEARTBEAT"]
    moved = [round((one - times[0]) / DAY) for one in times]
    assert moved == [jump // DAY for jump in jumps], "as the clock said, and nothing is left out"
