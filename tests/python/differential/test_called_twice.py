"""Every public method of a log and of a link called at its start, in the middle of reading and at its end, twice in a
row and again, beside pymavlink's.

The names are those of the reference's objects. A method that needs arguments and has none in `ARGUMENTS`
fails the test, so that none is forgotten.
"""

from __future__ import annotations

import contextlib
import importlib
import inspect
import io
import socket
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from differential.dataflash_logs import flight, text_log
from unit.link_tools import T0, heartbeat, pack, record

ROUNDS = 20
FLIGHT = {"mavlogfile": "flight.tlog", "mavmmaplog": "flight.tlog", "DFReader_binary": "flight.bin",
          "DFReader_text": "flight.log", "CSVReader": "flight.csv"}  # fmt: skip
MODULES = {"m": "mavutil", "D": "DFReader", "C": "CSVReader"}


def new_format(of: Any) -> Any:
    return of("DFReader").DFFormat(1, "NEW", 0, "QB", "TimeUS,A")


# Arguments of methods that need some; a function makes them for a log and the modules of its package.
ARGUMENTS: dict[str, Any] = {
    "add_format": lambda _log, of: (new_format(of),),
    "auto_mavlink_version": (b"\xfd123",),
    "check_condition": ("1==1",),
    "field": ("ATTITUDE", "roll"),
    "init_clock_gps_interpolated": lambda _log, of: (
        of("DFReader").DFReaderClock_gps_interpolated(),
    ),
    "init_clock_px4": (SimpleNamespace(StartTime=5000), SimpleNamespace(GPSTime=1.5e15)),
    "make_format_msgbuf": lambda _log, of: (new_format(of),),
    "make_msgbuf": lambda _log, of: (new_format(of), (1, 2)),
    "name_to_id": ("CSV",),
    "param": ("P1", 7),
    "param_fetch_one": ("X",),
    "param_set_send": ("X", 1),
    "post_message": lambda log, _of: (type(log.mav)(None).parse_char(heartbeat()),),
    "probably_vehicle_heartbeat": lambda log, _of: (type(log.mav)(None).parse_char(heartbeat()),),
    "recv": (10,),
    "scan_timestamp": ((T0 + 7).to_bytes(8, "big"),),
    "select": (0.01,),
    "set_mode": (4,),
    "set_mode_apm": (4,),
    "set_mode_flag": (128, True),
    "set_mode_px4": ("RTL", 0, 0),
    "set_rtscts": (True,),
    "set_servo": (1, 2),
    "setup_logfile": lambda log, _of: (f"{log.address}.received",),
    "setup_logfile_raw": lambda log, _of: (f"{log.address}.raw",),
    "setup_signing": (bytes(32),),
    "skip_to_type": lambda _log, _of: ({"ATTITUDE", "IMU"},),
    "time_since": ("NONE",),
    "waypoint_count_send": (1,),
    "waypoint_request_send": (1,),
    "waypoint_set_current_send": (1,),
    "write": (b"abc",),
}
# They wait for messages, and at the end of a log for ever. A filter of an indexed log stays in force, so that
# what some of them wait for may never come.
WAITING = frozenset(
    "location motors_armed_wait motors_disarmed_wait wait_gps_fix wait_heartbeat waypoint_current".split()
)
FILTER_STAYS = frozenset("location wait_gps_fix waypoint_current".split())
# Methods that differ, and words of the row of docs/compatibility.md that says so.
DIFFERENT = {
    "auto_mavlink_version": "`auto_mavlink_version`",
    "close": "reading a closed log",
    "init_arrays": "`init_arrays` of a dataflash log that is open",
    "init_arrays_fast": "`init_arrays` of a dataflash log that is open",
    "init_clock": "`messages` right after opening",
    "init_clock_msec": "logs by TimeMS: GPS messages without `T`",
    "pre_message": "`pre_message` of a log, called twice",
    "recv": "`recv` of a ",
    "scan_timestamp": "`scan_timestamp` before the first message",
    "skip_to_type": "`percent` and `remaining` after `skip_to_type`",
    "write": "`write` on a log opened to be read",
}
# They end or begin a connection, of which the page says more.
CONNECTING = frozenset("do_connect handle_disconnect handle_eof reconnect".split())
# An indexed telemetry log has methods of the same names that do not.
ALIKE = {"mavmmaplog": ("init_arrays", "skip_to_type")}
PAGE = Path(__file__).parents[3] / "docs" / "compatibility.md"


def telemetry() -> list[bytes]:
    """Frames of a flight, eight for each second of it."""
    mavlink = importlib.import_module("mavwire.dialects.v20.all")
    frames: list[bytes] = []
    for n in range(ROUNDS):
        armed = 128 * (n % 2)
        for msg in (
            mavlink.MAVLink_heartbeat_message(2, 3, 81 + armed, (0, 5, 4, 9)[n // 5], 4, 3),
            mavlink.MAVLink_attitude_message(n, 0.5, 0, 0, 0, 0, 0),
            mavlink.MAVLink_param_value_message(b"P%d" % n, n, 9, 60, n),
            mavlink.MAVLink_mission_current_message(n),
            mavlink.MAVLink_gps_raw_int_message(n, 3, 473977418, 85455939, 488000, 1, 1, 1, 1, 9),
            mavlink.MAVLink_vfr_hud_message(1, 2, 3, 4, n, 6),
            mavlink.MAVLink_global_position_int_message(n, 473977418, 85455939, 1, 2, 1, 2, 3, 100),
            mavlink.MAVLink_battery_status_message(n % 2, 1, 0, 0, [65535] * 10, 5, 6, 7, 80),
        ):
            frames.append(pack(msg, len(frames) % 256))
    return frames


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("logs")
    records = (record(frame, T0 + at * 100_000) for at, frame in enumerate(telemetry()))
    (folder / "flight.tlog").write_bytes(b"".join(records))
    flight(1).write(folder / "flight.bin")
    (folder / "flight.log").write_text(text_log(0), encoding="utf-8")
    rows = "".join(f"{n};{n * 2};{n % 3}\n" for n in range(ROUNDS))
    (folder / "flight.csv").write_text("time;a;b\n" + rows)
    return folder


def shown(value: Any) -> Any:
    """The comparable part of a value: numbers by value, messages by text and time, current times as such."""
    if isinstance(value, float) and abs(value - time.time()) < NOW:
        return "now"
    if value is None or isinstance(value, (bool, int, float, str, bytes)):
        return value
    if hasattr(value, "get_type"):
        return value.get_type(), str(value), shown(getattr(value, "_timestamp", None))
    if isinstance(value, dict):
        return {key: shown(one) for key, one in value.items()}
    if isinstance(value, set):
        return sorted(value)
    if isinstance(value, (list, tuple)):
        return [shown(one) for one in value]
    # A recording is unbuffered in mavwire alone.
    return "BufferedWriter" if isinstance(value, io.FileIO) else type(value).__name__


# Seconds around now that count as now.
NOW = 600
# Attributes that are no values, name this very link, or are the insides of the reader, or of which the order says nothing.
LEFT_OUT = frozenset(
    "f filehandle data_map unpackers formats reader metadata indexes prev_type type_list "
    "fd port address listen listen_addr clients clients_last_alive last_address destination_addr "
    "resolved_destination_addr device".split()
)
UNORDERED = ("type_nums",)
# Those of text logs that docs/compatibility.md lists.
OF_TEXT_LOGS = ("type_nums", "offset")


class Script:
    """The answers of one package, line by line."""

    attributes: list[str]

    def __init__(self, package: str, kind: str, open_it: Callable[[Any], Any]) -> None:
        self.of: Callable[[str], Any] = lambda module: importlib.import_module(
            f"{package}.{module}"
        )
        mavutil: Any = self.of("mavutil")
        mavutil.set_dialect("all")
        mavutil.global_link_id = 0
        self.kind = kind
        self.log = open_it(self.of)
        self.lines: list[Any] = []

    def state(self) -> dict[str, Any]:
        """The public attributes that are no methods."""
        found = {}
        for name in self.attributes:
            value = getattr(self.log, name, "absent")
            if name in OF_TEXT_LOGS and self.kind == "DFReader_text":
                continue
            found[name] = sorted(value) if name in UNORDERED and value else shown(value)
        return found

    def call(self, name: str) -> None:
        arguments = ARGUMENTS.get(name, ())
        if callable(arguments):
            arguments = arguments(self.log, self.of)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            try:
                answer = shown(getattr(self.log, name)(*arguments))
                if name == "time_since":
                    answer = round(answer)
            except Exception as error:
                answer = f"{type(error).__name__}: {error}"
        self.lines.append((name, answer, printed.getvalue(), self.state()))

    def read(self, most: int, **wanted: Any) -> None:
        for _ in range(most):
            msg = self.log.recv_match(**wanted) if wanted else self.log.recv_msg()
            self.lines.append(shown(msg))
            if msg is None:
                break

    def close(self) -> None:
        self.lines.append(self.state())
        if hasattr(self.log, "close"):
            self.log.close()


class LogScript(Script):
    def __init__(self, package: str, kind: str, path: Path) -> None:
        super().__init__(package, kind, lambda of: getattr(of(MODULES[kind[0]]), kind)(str(path)))
        if kind[0] == "m":
            self.log.write = lambda data: None  # pymavlink's logs raise
        else:
            self.log.rewind()  # what `messages` shows right after opening differs

    def run(self, name: str) -> None:
        some = {"C": "CSV", "m": "ATTITUDE", "D": "IMU"}[self.kind[0]]
        self.call(name)
        self.read(5)
        self.call(name)
        self.call(name)
        if name not in WAITING:
            self.read(3, type=some)
            self.call(name)
            self.read(2)
            self.read(2, type=[some, "NONE"])
            self.read(1000)
            self.call(name)
            self.call(name)
        self.read(1000)
        self.close()


class LinkScript(Script):
    """A link to a vehicle that sends the flight."""

    def __init__(self, package: str, kind: str, recorded: Path) -> None:
        super().__init__(package, kind, lambda of: self.connect(of("mavutil")))
        self.log.address = str(recorded)
        self.frames = telemetry()

    def connect(self, mavutil: Any) -> Any:
        self.vehicle: socket.socket
        if self.kind == "udpin":
            link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
            self.vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.vehicle.connect(link.port.getsockname())
        elif self.kind == "udpout":
            self.vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.vehicle.bind(("127.0.0.1", 0))
            port = self.vehicle.getsockname()[1]
            link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}")
            link.write(b"here")
            self.vehicle.connect(self.vehicle.recvfrom(9)[1])
        elif self.kind == "tcp":
            with socket.create_server(("127.0.0.1", 0)) as server:
                link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}")
                self.vehicle = server.accept()[0]
        else:
            link = mavutil.mavlink_connection("tcpin:127.0.0.1:0")
            self.vehicle = socket.create_connection(link.listen.getsockname())
            link.recv_msg()
        return link

    def fly(self, rounds: int) -> None:
        for _ in range(8 * rounds):
            self.vehicle.send(self.frames.pop(0))

    def receive(self, most: int, timeout: float) -> None:
        for _ in range(most):
            msg = self.log.recv_match(blocking=True, timeout=timeout)
            self.lines.append(shown(msg) and shown(msg)[:2])
            if msg is None:
                break

    def run(self, name: str) -> None:
        if name in WAITING:
            self.fly(4)
        self.call(name)
        self.fly(8 if name in WAITING else 3)
        self.receive(5, WAIT)
        self.call(name)
        self.call(name)
        self.receive(1000, QUIET)
        if name not in WAITING:
            self.call(name)
        self.fly(1)
        self.receive(1000, QUIET)
        self.close()
        self.vehicle.close()


# Seconds until a message must have come, and until no more will.
WAIT, QUIET = 60.0, 0.03


def names_of(script: Script) -> tuple[list[str], list[str]]:
    """Public methods of the reference's log or link, and its other public attributes."""
    log = script.log
    public = [name for name in dir(log) if not name.startswith("_")]
    methods = [name for name in public if inspect.isroutine(getattr(log, name))]
    for name in methods:
        parameters = inspect.signature(getattr(log, name)).parameters.values()
        required = [one for one in parameters if one.default is one.empty]
        assert not required or name in ARGUMENTS, f"ARGUMENTS say nothing of {name}"
    attributes = [name for name in public if name not in methods and name not in LEFT_OUT]
    return methods, attributes


def differences(
    make: Callable[[str], Any], subject: str, oracle: str, left_out: Callable[[str], bool]
) -> dict[str, Any]:
    """Method -> the first difference between the packages."""
    methods, attributes = names_of(make(oracle))
    assert len(methods) > 5
    wanted = [name for name in methods if not left_out(name)]
    found = {name: difference(make, name, attributes, subject, oracle) for name in wanted}
    return {name: one for name, one in found.items() if one is not None}


def difference(
    make: Callable[[str], Any], name: str, attributes: list[str], subject: str, oracle: str
) -> Any:
    """The first difference; None if there is none in one of three runs. On a busy machine a message
    of a link may come when the script has stopped to wait.
    """
    for _ in range(3):
        scripts = [make(package) for package in (subject, oracle)]
        for script in scripts:
            script.attributes = attributes
            script.run(name)
        ours, theirs = (script.lines for script in scripts)
        if ours == theirs:
            return None
    pairs = zip(ours, theirs, strict=False)
    return next((pair for pair in pairs if pair[0] != pair[1]), (len(ours), len(theirs)))


@pytest.fixture(autouse=True)
def _protocol(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MAVLINK20", "1")


@pytest.mark.parametrize("kind", FLIGHT)
def test_methods_of_a_log(kind: str, logs: Path, subject: str, oracle: str) -> None:
    def left_out(name: str) -> bool:
        if kind == "mavmmaplog" and name in FILTER_STAYS:
            return True
        return name in DIFFERENT and name not in ALIKE.get(kind, ())

    def make(package: str) -> Script:
        return LogScript(package, kind, logs / FLIGHT[kind])

    assert not differences(make, subject, oracle, left_out)


@pytest.mark.parametrize("kind", ["udpin", "udpout", "tcp", "tcpin"])
def test_methods_of_a_link(kind: str, tmp_path: Path, subject: str, oracle: str) -> None:
    def make(package: str) -> Script:
        return LinkScript(package, kind, tmp_path / "link")

    def left_out(name: str) -> bool:
        return name in DIFFERENT or name in CONNECTING

    assert not differences(make, subject, oracle, left_out)


def test_differences_are_listed() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert not [row for row in DIFFERENT.values() if row not in page]
