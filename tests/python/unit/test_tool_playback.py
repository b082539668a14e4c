"""`mavwire playback`: frames when they are due, and a flight that FlightGear understands."""

from __future__ import annotations

import socket
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import encoder
import pytest
from mavwire import cli, mavutil
from mavwire.cli.vehicle import playback
from mavwire.cli.vehicle._player import LONGEST_GAP, Flight, Player
from mavwire.fgFDM import fgFDM
from tool_runs import Log, attitude, flight_log, gps, heartbeat, position


def messages(path: Path) -> list[Any]:
    log = mavutil.mavlogfile(str(path))
    return list(iter(log.recv_msg, None))


@pytest.fixture
def log(tmp_path: Path) -> Path:
    made = Log(tmp_path / "flight.tlog")
    made.add(0, heartbeat())
    made.add(0.5, attitude(0.5))
    made.add(2, position(2, 10.0))
    made.add(500, gps(500, 11.0, 3.0))
    made.add(400, heartbeat())
    return made.done()


class Clock:
    """A clock that goes when it is told to."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_frames_leave_when_they_are_due(log: Path) -> None:
    clock, sent = Clock(), []
    player = Player(messages(log), sent.append, lambda _: None, Flight(), 2.0, clock)
    for wait in (0.25, 0.75, LONGEST_GAP / 2, 0.0):
        assert player.step() == pytest.approx(wait, abs=1e-4)
        clock.now += wait + 1e-5
    assert player.done
    assert b"".join(sent) == b"".join(bytes(msg.get_msgbuf()) for msg in messages(log))


def test_a_pause_delays_what_follows(log: Path) -> None:
    clock = Clock()
    player = Player(messages(log), lambda _: None, lambda _: None, Flight(), 1.0, clock)
    player.step()
    player.paused = True
    clock.now += 1000
    player.step()
    assert player.sent == 1
    player.paused = False
    player.step()
    assert 2 <= player.sent < 5


def test_flightgear_gets_the_flight(log: Path) -> None:
    packets: list[bytes] = []
    for gps_altitude, metres in ((False, 123.456), (True, 123.456)):
        flight = Flight(gps_altitude)
        packets = [one for one in map(flight.add, messages(log)) if one is not None]
        assert len(packets) == 3
        told = fgFDM()
        told.parse(packets[-1])
        assert told.get("phi") == pytest.approx(0.1)
        assert told.get("latitude", units="degrees") == pytest.approx(11.0)
        assert told.get("altitude", units="meters") == pytest.approx(metres)


def test_the_command_sends_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = flight_log(tmp_path / "flight.tlog")
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gear,
    ):
        for one in (station, gear):
            one.bind(("127.0.0.1", 0))
            one.settimeout(60)
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        ports = [f"127.0.0.1:{one.getsockname()[1]}" for one in (station, gear)]
        options = ["--out", ports[0], "--fgout", ports[1], "--speed", "100000", "--headless"]
        assert cli.main(["playback", str(path), *options]) == 0
        first = station.recv(1000)
        assert first == bytes(messages(path)[0].get_msgbuf())
        assert len(gear.recv(1000)) == fgFDM().packet_size()
    assert f"{len(messages(path))} messages" in capsys.readouterr().err


def test_keys_stay_in_the_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """R53."""
    path = tmp_path / "key.tlog"
    beat = encoder.heartbeat()
    key = encoder.frame(256, bytes([1, 1, *b"k" * 32, 5]).ljust(42, b"\0"))
    path.write_bytes(b"".join(encoder.record(one, 10**15) for one in (key, beat)))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("127.0.0.1", 0))
        station.settimeout(60)
        out = f"127.0.0.1:{station.getsockname()[1]}"
        assert cli.main(["playback", str(path), "--out", out, "--headless"]) == 0
        assert station.recv(1000) == beat
    assert "1 messages, 1 with a signing key left out" in capsys.readouterr().err


def test_where_it_cannot_send(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["playback", str(log), "--headless", "--out", "nowhere:x"]) == 1
    assert "cannot open nowhere:x" in capsys.readouterr().err


class Widget:
    """Any widget of a window that nobody sees."""

    def __init__(self, *_: Any, **options: Any) -> None:
        self.options = options

    def config(self, **options: Any) -> None:
        self.options.update(options)

    def pack(self, **_: Any) -> None:
        """There is no screen."""

    def get(self) -> Any:
        return self.options["value"]


class Root(Widget):
    """A main window that calls what is due at once."""

    destroyed = False

    def __init__(self) -> None:
        super().__init__()
        self.waiting: list[tuple[int, Any]] = []

    def title(self, text: str) -> None:
        self.options["title"] = text

    def after(self, milliseconds: int, call: Any) -> None:
        self.waiting.append((milliseconds, call))

    def destroy(self) -> None:
        self.destroyed = True


class Toolkit:
    """As much of tkinter as the window needs."""

    Label = Button = Spinbox = DoubleVar = Widget
    TclError = RuntimeError


def test_a_window_plays_to_the_end(log: Path) -> None:
    clock, root = Clock(), Root()
    player = Player(messages(log), lambda _: None, lambda _: None, Flight(), 1.0, clock)
    playback.window(player, Toolkit, root, "flight.tlog")
    assert root.options["title"] == "mavwire playback: flight.tlog"
    while root.waiting:
        milliseconds, call = root.waiting.pop()
        clock.now += milliseconds / 1000
        call()
    assert root.destroyed
    assert player.done


@pytest.mark.parametrize(
    ("endpoint", "name"),
    [
        ("127.0.0.1:14550", "udpout:127.0.0.1:14550"),
        ("mcast:", "mcast:"),
        ("uds:/tmp/x.sock", "uds:/tmp/x.sock"),
        ("udpbcast:10.0.0.255:14550", "udpbcast:10.0.0.255:14550"),
    ],
)
def test_any_endpoint_is_an_output(
    endpoint: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    class Link:
        """A link that was opened."""

        def close(self) -> None:
            """Nothing is open."""

    def connect(device: str, **_: Any) -> Link:
        opened.append(device)
        return Link()

    monkeypatch.setattr(mavutil, "mavlink_connection", connect)
    with ExitStack() as stack:
        playback._links([endpoint], 57600, stack)
    assert opened == [name]
