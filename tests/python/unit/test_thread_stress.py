"""Every public method and attribute of an object, called from eight threads at once.

A thread may see an object before or after the call of another thread, never between. A call therefore raises nothing that it
does not raise on a new object of its own. Exceptions that follow from the order of the calls are listed.
"""

from __future__ import annotations

import contextlib
import copy
import os
import pickle
import socket
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import dataflash_writer
import mavwire
import pytest
from mavwire import mavutil, traffic
from mavwire.dialects.v20 import all as mavlink
from unit import link_tools
from unit.link_tools import KEY, THREADS, heartbeat

SECONDS = 0.3
"""How long each kind of object is stressed."""

Action = Callable[[Any], object]


@dataclass
class Plan:
    """What the threads do with an object."""

    make: Callable[[], Any]
    arguments: dict[str, tuple[Any, ...]] = field(default_factory=dict)
    left_out: frozenset[str] = frozenset()
    """Names that wait for something or end the object."""
    more: dict[str, Action] = field(default_factory=dict)
    """Actions that are no public name."""
    expected: dict[str, tuple[type[BaseException], ...]] = field(default_factory=dict)

    def actions(self) -> list[tuple[str, Action]]:
        """One for each public name: a method is called, everything else is read."""
        subject = self.make()
        names = [n for n in dir(subject) if not n.startswith("_") and n not in self.left_out]
        found = [(name, self._action(subject, name)) for name in names]
        return found + list(self.more.items())

    def _action(self, subject: Any, name: str) -> Action:
        arguments = self.arguments.get(name, ())
        if callable(getattr(subject, name, None)):
            return lambda one: getattr(one, name)(*arguments)
        return lambda one: getattr(one, name)


@pytest.fixture(autouse=True)
def frequent_switches() -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def error_of(action: Action, subject: Any) -> BaseException | None:
    try:
        action(subject)
    except BaseException as error:
        return error
    return None


def stress(plan: Plan, seconds: float = SECONDS) -> None:
    """Rounds with a new object each, since much is made when it is first asked for."""
    actions = plan.actions()
    alone = {name: error_of(action, plan.make()) for name, action in actions}
    allowed = {name: (*plan.expected.get(name, ()), type(alone[name])) for name in alone}
    failures: Counter[str] = Counter()
    subject: list[Any] = []
    end = time.monotonic() + seconds

    def next_round() -> None:
        subject[:] = [plan.make()] if time.monotonic() < end else []

    barrier = threading.Barrier(THREADS, next_round)

    def work(number: int) -> None:
        first = number * len(actions) // THREADS
        own = (actions[first:] + actions[:first])[:: 1 if number % 2 else -1]
        while barrier.wait() is not None and subject:
            one = subject[0]
            for name, action in own:
                error = error_of(action, one)
                if error is not None and not isinstance(error, allowed[name]):
                    failures[f"{name}: {error!r:.300}"] += 1
            barrier.wait()

    link_tools.at_once(work)
    assert not failures


# Messages

SENDER = mavlink.MAVLink(None, srcSystem=7, srcComponent=8)
FIELDS = ("type", "autopilot", "base_mode", "custom_mode", "system_status", "mavlink_version")


def parsed(frame: bytes) -> Any:
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    mav.signing.secret_key = KEY
    mav.signing.allow_unsigned_callback = lambda *_: True
    (msg,) = mav.parse_buffer(frame) or []
    msg._timestamp = 1.5
    return msg


def edited(frame: bytes) -> Any:
    msg = parsed(frame)
    msg.custom_mode = 5
    assert msg.get_header() is not None
    return msg


def built() -> Any:
    msg = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    msg._timestamp = 1.5
    return msg


def same_fields(msg: Any) -> None:
    assert [vars(msg)[name] for name in ("type", "autopilot", "base_mode")] == [2, 3, 81]


def through_vars(msg: Any) -> None:
    for name, value in vars(msg).items():
        assert name is not value


def header_agrees(msg: Any) -> None:
    assert (msg._header.msgId, msg.get_msgId()) == (0, 0)


MESSAGE_ACTIONS: dict[str, Action] = {
    **{name: (lambda msg, name=name: getattr(msg, name)) for name in (
        "_header", "_payload", "_msgbuf", "_crc", "_fieldnames", "_type", "_signed", "_link_id",
        "_instances", "_instance_field", "_instance_offset", "_timestamp")},
    "__dict__": lambda msg: msg.__dict__["_header"],
    "through_vars": through_vars,
    "str": str,
    "repr": repr,
    "==": lambda msg: msg == parsed(heartbeat()),
    "copy": lambda msg: vars(copy.copy(msg))["_header"],
    "deepcopy": lambda msg: vars(copy.deepcopy(msg))["_header"],
    "pickle": lambda msg: vars(pickle.loads(pickle.dumps(msg)))["_header"],
    "set _timestamp": lambda msg: setattr(msg, "_timestamp", 2.5),
}  # fmt: skip
KNOWN_ACTIONS: dict[str, Action] = {
    **MESSAGE_ACTIONS,
    "fields": same_fields,
    "header": header_agrees,
    "set mavlink_version": lambda msg: setattr(msg, "mavlink_version", 3),
    "pack as 1": lambda msg: msg.pack(SENDER, force_mavlink1=True),
}
MESSAGE_ARGUMENTS = {"pack": (SENDER,), "sign_packet": (SENDER,), "format_attr": ("type",)}
SENDER.signing.secret_key = KEY


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda: parsed(heartbeat()), id="received"),
        pytest.param(lambda: parsed(heartbeat(v1=True)), id="version-1"),
        pytest.param(lambda: parsed(link_tools.signed(built())), id="signed"),
        pytest.param(lambda: edited(heartbeat()), id="edited"),
        pytest.param(built, id="built"),
    ],
)
def test_a_message(make: Callable[[], Any]) -> None:
    """R34."""
    stress(Plan(make, MESSAGE_ARGUMENTS, more=KNOWN_ACTIONS))


@pytest.mark.parametrize("frame", [b"\x00", b"\xfd\x01\0\0\0\x01\x01\xff\xff\x7f\x01\0\0"])
def test_a_message_without_a_definition(frame: bytes) -> None:
    arguments = {**MESSAGE_ARGUMENTS, "format_attr": ("data",)}
    stress(Plan(lambda: parsed(frame), arguments, more=MESSAGE_ACTIONS))


# Parsers


class Sink:
    """A file that takes frames."""

    def write(self, frame: bytes) -> None:
        assert frame[0] == 0xFD


def parser() -> Any:
    mav = mavlink.MAVLink(Sink(), srcSystem=1, srcComponent=1)
    mav.robust_parsing = True
    return mav


PARSER_ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "parse_char": (heartbeat(),),
    "parse_buffer": (heartbeat() * 3,),
    "decode": (bytearray(heartbeat()),),
    "send": (built(),),
    "set_callback": (lambda *_: None,),
    "set_send_callback": (lambda *_: None,),
    "check_signature": (bytearray(link_tools.signed(built())), 1, 1),
}
BEAT = (2, 3, 81, 4, 4, 3)


def test_a_parser() -> None:
    """R34."""
    sends = frozenset(n for n in dir(mavlink.MAVLink) if n.endswith(("_send", "_encode")))
    more: dict[str, Action] = {
        "heartbeat_send": lambda mav: mav.heartbeat_send(*BEAT),
        "heartbeat_encode": lambda mav: mav.heartbeat_encode(*BEAT).pack(mav),
        "vars": lambda mav: dict(vars(mav)),
        "signing": lambda mav: dict(vars(mav.signing)),
        "set seq": lambda mav: setattr(mav, "seq", 3),
        "set secret_key": lambda mav: setattr(mav.signing, "secret_key", KEY),
        "no callback": lambda mav: mav.set_callback(None),
    }
    unsigned = {"decode": (mavlink.MAVError,)}  # once there is a key
    stress(Plan(parser, PARSER_ARGUMENTS, sends, more, unsigned))


# Logs and links

LINK_ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "age": ("HEARTBEAT",),
    "auto_mavlink_version": (heartbeat(),),
    "check_condition": ("ATTITUDE.roll > 0",),
    "field": ("ATTITUDE", "roll"),
    "latest": ("HEARTBEAT",),
    "messages_of": (1,),
    "param": ("RC1_MIN",),
    "param_fetch_one": ("RC1_MIN",),
    "param_set_send": ("RC1_MIN", 1.0),
    "post_message": (parsed(heartbeat()),),
    "probably_vehicle_heartbeat": (parsed(heartbeat()),),
    "select": (0,),
    "send_signing_key": (KEY,),
    "set_mode": ("LOITER",),
    "set_mode_apm": ("LOITER",),
    "set_mode_flag": (1, True),
    "set_mode_px4": ("LOITER", 0, 0),
    "set_rtscts": (False,),
    "set_servo": (1, 1500),
    "setup_logfile": (os.devnull,),
    "setup_logfile_raw": (os.devnull,),
    "setup_signing": (KEY,),
    "skip_to_type": ("HEARTBEAT",),
    "time_since": ("HEARTBEAT",),
    "waypoint_count_send": (1,),
    "waypoint_request_send": (1,),
    "waypoint_set_current_send": (1,),
    "write": (heartbeat(),),
    # DFReader
    "add_format": (),
    "find_unused_format": (),
    "make_format_msgbuf": (),
    "make_msgbuf": (),
}
LINK_ACTIONS: dict[str, Action] = {
    "vars": lambda link: dict(vars(link)),
    "received": lambda link: [vars(link.recv_match() or built()) for _ in range(5)],
    "messages": lambda link: list(link.messages.items()),
    "params": lambda link: list(link.params.items()),
}
WAITS = frozenset(
    "location motors_armed_wait motors_disarmed_wait wait_gps_fix wait_heartbeat waypoint_current".split()
)
# Each takes the clock of another kind of log, which `init_clock` meets half-way.
CLOCKS = frozenset(
    "init_clock_usec init_clock_msec init_clock_px4 init_clock_gps_interpolated".split()
)


def telemetry(folder: Path) -> str:
    path = folder / "flight.tlog"
    traffic.generate(path, 200)
    return str(path)


def dataflash(folder: Path) -> str:
    return dataflash_writer.flight(2).write(folder / "flight.BIN")


def dataflash_text(folder: Path) -> str:
    path = folder / "flight.log"
    lines = ["FMT, 1, 20, ATT, Qff, TimeUS,Roll,Pitch", "FMT, 2, 20, MODE, QB, TimeUS,Mode"]
    for n in range(50):
        lines += [f"ATT, {n * 1000}, {n}.5, 1.0", f"MODE, {n * 1000}, {n % 5}"]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


@pytest.mark.parametrize("kind", [telemetry, dataflash, dataflash_text])
def test_a_log_link(kind: Callable[[Path], str], tmp_path: Path) -> None:
    """R34."""
    path = kind(tmp_path)
    left_out = WAITS | CLOCKS | {"close"}
    link = lambda: mavutil.mavlink_connection(path)  # noqa: E731
    stress(Plan(link, LINK_ARGUMENTS, left_out, LINK_ACTIONS))


@pytest.mark.parametrize("kind", [telemetry, dataflash, dataflash_text])
def test_a_log_and_its_tables(kind: Callable[[Path], str], tmp_path: Path) -> None:
    """R34."""
    path = kind(tmp_path)
    name = "ATTITUDE" if kind is telemetry else "ATT"
    more = {"iterate": lambda log: sum(1 for _ in log.messages())}
    stress(Plan(lambda: mavwire.open_log(path), {"read": (name,)}, frozenset({"close"}), more))
    columns = {"slice": (0, 10), "select": (["Roll"],), "write": (str(tmp_path / "t.csv"),)}
    stress(Plan(lambda: mavwire.read(path, name)[name], columns))


def test_a_live_link() -> None:
    """R34."""
    links: list[Any] = []

    def listening() -> Any:
        for link in links:
            link.close()
        links[:] = [mavutil.mavlink_connection("udpin:127.0.0.1:0")]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for n in range(40):
                sender.sendto(heartbeat(n), links[0].port.getsockname())
        return links[0]

    stress(Plan(listening, LINK_ARGUMENTS, WAITS | {"close"}, LINK_ACTIONS))


def test_a_dataflash_message(tmp_path: Path) -> None:
    """R34."""
    path = dataflash(tmp_path)

    def message() -> Any:
        with contextlib.closing(mavutil.mavlink_connection(path)) as log:
            return log.recv_match(type="ATT")

    more: dict[str, Action] = {
        "str": str,
        "vars": lambda msg: dict(vars(msg)),
        "fields": lambda msg: [getattr(msg, name) for name in ("TimeUS", "Roll", "Pitch")],
        "set Pitch": lambda msg: setattr(msg, "Pitch", 1.0),
        "copy": lambda msg: copy.copy(msg).Roll,
        "pickle": pickle.dumps,
    }
    stress(Plan(message, more=more))


def test_progress_callbacks_read_on(tmp_path: Path) -> None:
    """The callback of `init_arrays` sees an open log."""
    log = mavutil.mavlink_connection(dataflash(tmp_path))
    read: list[Any] = []
    log.init_arrays(lambda _: read.append(log.recv_msg()))
    assert read and None not in read


@pytest.mark.parametrize("kind", [dataflash, dataflash_text])
def test_a_closed_log_says_so(kind: Callable[[Path], str], tmp_path: Path) -> None:
    log = mavutil.mavlink_connection(kind(tmp_path))
    log.close()
    with pytest.raises(ValueError, match="the log is closed"):
        log.init_arrays()
