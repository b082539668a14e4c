"""R65 where a name is looked up: nothing interrupts the system's answer, but Ctrl-C ends the wait for it."""

from __future__ import annotations

import os
import signal
import socket
import threading
from collections.abc import Iterator

import pytest
from mavwire import mavutil
from mavwire.links.names import connect_to, look_up
from watchdog import watched

WAIT = 60.0


class SlowNames:
    """A name server that says that it does not know, once it is told to."""

    def __init__(self) -> None:
        self.asked, self.answers = threading.Event(), threading.Event()

    def __call__(self, *_: object) -> object:
        self.asked.set()
        self.answers.wait(WAIT)
        raise socket.gaierror(socket.EAI_AGAIN, "Temporary failure in name resolution")


@pytest.fixture
def names(monkeypatch: pytest.MonkeyPatch) -> Iterator[SlowNames]:
    """Ctrl-C follows the first question."""
    names = SlowNames()
    monkeypatch.setattr(socket, "getaddrinfo", names)

    def interrupt() -> None:
        if names.asked.wait(WAIT):
            os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    yield names
    names.answers.set()
    thread.join()


@pytest.mark.parametrize(
    "device",
    [
        *("tcp:vehicle.test:5760", "ws:vehicle.test:80"),
        *("udpin:vehicle.test:14550", "tcpin:vehicle.test:5760", "wsserver:vehicle.test:80"),
    ],
)
def test_ctrl_c_ends_opening_a_link(device: str, names: SlowNames) -> None:
    """R65."""
    if device.startswith("ws"):
        pytest.importorskip("wsproto")
    with watched(WAIT), pytest.raises(KeyboardInterrupt):
        mavutil.mavlink_connection(device)


def test_ctrl_c_ends_sending_and_the_link_goes_on(names: SlowNames) -> None:
    """R65."""
    with mavutil.mavlink_connection("udpout:vehicle.test:14550") as link:
        with watched(WAIT), pytest.raises(KeyboardInterrupt):
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        names.answers.set()
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert link.write_errors == 1


def test_without_a_thread_to_spare_the_caller_looks_a_name_up(monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("_thread.start_new_thread", refuse)
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_: ["here"])
    assert look_up("vehicle.test", 1, 0, 0) == ["here"]


def test_addresses_and_errors_are_those_of_the_system() -> None:
    for host in ("127.0.0.1", "localhost", ""):
        found = look_up(host, 5760, socket.AF_INET, socket.SOCK_STREAM)
        assert found[0][4] == ("127.0.0.1", 5760)
    with pytest.raises(socket.gaierror):
        look_up("no host\n", 5760, 0, socket.SOCK_STREAM)
    with pytest.raises(UnicodeError):
        look_up("a" * 64 + ".test", 5760, 0, socket.SOCK_STREAM)


def test_every_address_of_a_host_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
        found = [
            (socket.AF_INET, socket.SOCK_STREAM, 6, "", (host, number))
            for host in ("127.0.0.2", "127.0.0.1")
        ]
        monkeypatch.setattr(socket, "getaddrinfo", lambda *_: found)
        with connect_to("vehicle.test", number, WAIT) as port:
            assert port.getpeername() == ("127.0.0.1", number)
        with pytest.raises(ConnectionRefusedError):
            found[1:] = []
            connect_to("vehicle.test", number, WAIT)
