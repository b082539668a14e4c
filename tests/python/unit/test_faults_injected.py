"""Every call of the system that links and bridges make fails once: each time in a process where a library stands before
the system's own. Nothing hangs, nothing is torn, no descriptor is left, and what is raised is the system's error.
"""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from unit.failing_peers import GROUP
from unit.failing_sessions import BRIDGES, KINDS, LINKS
from unit.faults import ENVIRONMENT

HERE = Path(__file__).parent
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or COMPILER is None,
    reason="needs Linux and a C compiler for a library that is preloaded",
)

# What each kind is known to call, so that a library that is passed by is noticed.
CALLS = {
    "udpin": {"socket", "bind", "setsockopt", "poll", "receive", "send", "close"},
    "udpout": {"socket", "setsockopt", "poll", "receive", "send", "close"},
    "udpbcast": {"socket", "setsockopt", "poll", "receive", "send", "close"},
    "mcast": {"socket", "bind", "connect", "setsockopt", "getsockname", "poll", "receive", "send", "close"},
    "tcp": {"socket", "connect", "setsockopt", "poll", "receive", "send", "close"},
    "uds": {"socket", "connect", "poll", "receive", "send", "close"},
    "tcpin": {"socket", "bind", "listen", "accept", "setsockopt", "poll", "receive", "send", "close"},
    "wsserver": {"socket", "bind", "listen", "accept", "setsockopt", "poll", "receive", "send", "close"},
    "ws": {"socket", "connect", "setsockopt", "poll", "receive", "send", "close"},
    "serial": {"poll", "receive", "send", "close"},
    "child": {"poll", "receive", "send"},
    "bridge_udpin": {"socket", "bind", "poll", "receive", "send", "close"},
    "bridge_udpout": {"socket", "poll", "receive", "send", "close"},
    "bridge_tcpin": {"socket", "bind", "listen", "accept", "poll", "receive", "send", "close"},
    "bridge_tcp": {"socket", "connect", "poll", "receive", "send", "close"},
    "bridge_serial": {"poll", "receive", "send", "close"},
}  # fmt: skip


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where failing_calls.c was compiled to."""
    made = tmp_path_factory.mktemp("library") / "failing_calls.so"
    assert COMPILER is not None
    command = [
        COMPILER,
        "-shared",
        "-fPIC",
        "-O1",
        "-o",
        str(made),
        str(HERE / "failing_calls.c"),
        "-ldl",
    ]
    built = subprocess.run(command, capture_output=True, text=True, check=False)
    if built.returncode:
        pytest.skip(
            f"the C compiler does not make libraries here: {built.stderr.splitlines()[-1:]}"
        )
    return made


GROUPS = {
    "datagrams": ["udpin", "udpout", "udpbcast", "mcast"],
    "streams": ["tcp", "uds", "tcpin", "child"],
    "WebSockets": ["ws", "wsserver"],
    "serial": ["serial", "bridge_serial"],
    "bridge": ["bridge_udpin", "bridge_udpout", "bridge_tcpin", "bridge_tcp"],
}


def test_each_kind_has_its_turn() -> None:
    assert sorted(kind for group in GROUPS.values() for kind in group) == sorted(LINKS | BRIDGES)


@pytest.mark.parametrize("group", GROUPS)
def test_each_call_fails_once(group: str, library: Path) -> None:
    """R63, R64."""
    kinds = list(GROUPS[group])
    for module, name in (("wsproto", "WebSockets"), ("serial", "serial")):
        if group == name:
            pytest.importorskip(module)
    if group == "datagrams" and not has_multicast():
        kinds.remove("mcast")
    environment = ENVIRONMENT | {"LD_PRELOAD": str(library), "MAVLINK20": "1"}
    command = [sys.executable, "-m", "unit.failing_sessions", *kinds]
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=240, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert "Traceback" not in done.stderr
    told: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    for kind in kinds:
        calls, failed = told[kind]["calls"], told[kind]["failed"]
        assert set(calls) == set(KINDS)
        assert {name for name, count in calls.items() if count} >= CALLS[kind], kind
        assert {name for name, count in failed.items() if count} >= CALLS[kind], kind


def has_multicast() -> bool:
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.sendto(b"", (GROUP, 9))
    except OSError:
        return False
    return True
