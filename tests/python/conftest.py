"""Which package is under test, and what every test may rely on.

`MAVWIRE_SUBJECT=pymavlink` runs the comparing tests with the reference implementation on both
sides: a check of the harness itself, which must find no difference.
"""

from __future__ import annotations

import importlib.util
import os
import re
import signal
import tempfile
from collections.abc import Iterator

import pytest

SUBJECT = os.environ.get("MAVWIRE_SUBJECT", "mavwire")
ORACLE = "pymavlink"

# Definitions and descriptions that the user of this machine installed are none of the tests' business.
os.environ["XDG_DATA_HOME"] = os.path.join(tempfile.gettempdir(), "mavwire-no-data")

# A shell that starts the tests in the background has them ignore Ctrl-C, and all processes that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Tests with real sockets, processes, signals and clocks: on a machine that stalls for seconds one
# may fail though nothing is wrong. It is tried twice more, and the summary shows that it was.
LIVE = re.compile(
    "integration/|unit/test_(aio|alias|bench|bridge|cli|conversion|faults|fleet|hardening|links|live|run|sim|threads|tool_playback)"
)


def pytest_report_header() -> str:
    return f"mavwire: subject {SUBJECT}, oracle {ORACLE}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if LIVE.search(item.path.as_posix()):
            item.add_marker(pytest.mark.flaky(reruns=2))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Why tests were tried again."""
    for report in terminalreporter.getreports("rerun"):
        terminalreporter.section(f"tried again: {report.nodeid}", sep="-")
        terminalreporter.write_line(report.longreprtext)


@pytest.fixture(scope="session")
def subject() -> str:
    """Root package name of the implementation under test."""
    return SUBJECT


@pytest.fixture(scope="session")
def oracle() -> str:
    """Root package name of the reference implementation; the test is skipped where it is not
    installed.
    """
    if importlib.util.find_spec(ORACLE) is None:
        pytest.skip(f"{ORACLE} is not installed: pip install -r requirements/test.txt")
    return ORACLE


@pytest.fixture
def mavlink20() -> Iterator[None]:
    """Links of this test speak MAVLink 2 and know all messages; those of the next one what they did before."""
    from mavwire import mavutil

    mavutil.set_wire_protocol("2.0")
    mavutil.set_dialect("all")
    yield
    mavutil.set_wire_protocol(None)
    mavutil.set_dialect("all")


@pytest.fixture(autouse=True)
def own_signing_streams(monkeypatch: pytest.MonkeyPatch) -> None:
    """No test shares streams with the links of another that used the same key."""
    if importlib.util.find_spec("mavwire") is not None:
        from mavwire.links import signing

        monkeypatch.setattr(signing, "_with_key", [])
