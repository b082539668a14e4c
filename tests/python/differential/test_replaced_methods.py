"""Programs that replace methods of a link's `MAVLink` object: both packages call what is there now."""

from __future__ import annotations

import importlib
import inspect
import socket
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from differential import workload
from unit.link_tools import T0, free_port, heartbeat, record

WAIT = 60.0
TYPES = ("HEARTBEAT", "ATTITUDE")
LINK_METHODS = ("recv", "recv_msg", "pre_message", "post_message")
REPLACED = ("parse_char", "parse_buffer", "decode", "bytes_needed", "check_signature", "send")


class Ours:
    """One package with a log of heartbeats and attitudes in turn."""

    def __init__(self, package: str, folder: Path) -> None:
        self.mavutil = importlib.import_module(f"{package}.mavutil")
        self.mavutil.set_dialect("common")
        self.mavlink = self.mavutil.mavlink
        self.log = folder / "turns.tlog"
        self.log.write_bytes(b"".join(record(frame, T0 + i) for i, frame in enumerate(frames())))

    def open(self, kind: str) -> Any:
        return getattr(self.mavutil, kind)(str(self.log))


def frames() -> list[bytes]:
    mavlink = importlib.import_module("mavwire.dialects.v20.common")
    mav = mavlink.MAVLink(None, 1, 1)
    found = []
    for mav.seq in range(12):
        if mav.seq % 2:
            msg = mavlink.MAVLink_attitude_message(mav.seq, 0.5, 0, 0, 0, 0, 0)
        else:
            msg = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
        found.append(bytes(msg.pack(mav)))
    return found


@pytest.fixture
def both(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, subject: str, oracle: str
) -> Iterator[list[Ours]]:
    monkeypatch.setenv("MAVLINK20", "1")
    packages = [Ours(subject, tmp_path), Ours(oracle, tmp_path)]
    yield packages
    monkeypatch.delenv("MAVLINK20")
    for package in packages:
        package.mavutil.set_dialect("all")


def spy(mav: Any, name: str) -> list[Any]:
    """Puts a function of the same effect in the method's place; a list of what it is asked."""
    calls: list[Any] = []
    original = getattr(mav, name)

    def replacement(*arguments: Any) -> Any:
        calls.append(arguments)
        return original(*arguments)

    setattr(mav, name, replacement)
    return calls


def name_of(msg: Any) -> str | None:
    return None if msg is None else str(msg.get_type())


def agree(both: list[Ours], scenario: Callable[[Ours], Any]) -> Any:
    """What both packages answer."""
    ours, theirs = (scenario(package) for package in both)
    assert ours == theirs
    return ours


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
@pytest.mark.parametrize("name", REPLACED)
@pytest.mark.parametrize("wanted", [None, "ATTITUDE"])
def test_a_method_of_a_log(both: list[Ours], kind: str, name: str, wanted: str | None) -> None:
    def scenario(package: Ours) -> Any:
        log = package.open(kind)
        log.recv_msg()
        calls = spy(log.mav, name)
        seen = [name_of(log.recv_match(type=wanted)) for _ in range(3)]
        while_replaced = bool(calls)
        # How often `bytes_needed` is asked depends on the reader.
        times = 0 if name == "bytes_needed" else len(calls)
        delattr(log.mav, name)
        calls.clear()
        seen.append(name_of(log.recv_match(type=wanted)))
        log.close()
        return seen, while_replaced, times, calls, log.mav_count, log.mav_loss

    _, while_replaced, *_ = agree(both, scenario)
    assert while_replaced == (name in ("parse_char", "decode", "bytes_needed"))


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
@pytest.mark.parametrize("name", LINK_METHODS)
@pytest.mark.parametrize("wanted", [None, "ATTITUDE"])
def test_a_method_of_the_log_itself(
    both: list[Ours], kind: str, name: str, wanted: str | None
) -> None:
    def scenario(package: Ours) -> Any:
        log = package.open(kind)
        log.recv_msg()
        calls = spy(log, name)
        seen = [name_of(log.recv_match(type=wanted)) for _ in range(3)]
        # How often `recv` is asked depends on the reader.
        times = bool(calls) if name == "recv" else len(calls)
        delattr(log, name)
        calls.clear()
        seen.append(name_of(log.recv_match(type=wanted)))
        log.close()
        return seen, times, calls, log.mav_count, log.mav_loss

    _, times, *_ = agree(both, scenario)
    assert times


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
@pytest.mark.parametrize("wanted", [None, "ATTITUDE"])
@pytest.mark.parametrize("place", ["class", "object"])
def test_a_post_message_that_calls_no_other(
    both: list[Ours], kind: str, wanted: str | None, place: str
) -> None:
    """The next record begins behind each message, whoever heard of it. Who never hears of a system matches none of its
    messages.
    """

    def scenario(package: Ours) -> Any:
        base = getattr(package.mavutil, kind)
        heard: list[Any] = []
        if place == "class":
            log = type("Log", (base,), {"post_message": lambda _, msg: heard.append(name_of(msg))})(
                str(package.log)
            )
        else:
            log = base(str(package.log))
            log.post_message = lambda msg: heard.append(name_of(msg))
        heard.clear()  # opening an indexed log posts as well
        messages = [name_of(log.recv_msg()) for _ in range(3)]
        matching = name_of(log.recv_match(type=wanted)), name_of(log.recv_match(condition="True"))
        return messages, matching, heard, log.mav_count

    messages, *_ = agree(both, scenario)
    assert messages == ["HEARTBEAT", "ATTITUDE", "HEARTBEAT"]


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
def test_a_program_that_parses_by_itself_and_posts_nothing(both: list[Ours], kind: str) -> None:
    def next_message(log: Any) -> Any:
        log.pre_message()
        while True:
            data = log.recv(log.mav.bytes_needed())
            msg = log.mav.parse_char(data)
            if msg is not None or not data:
                return msg

    def scenario(package: Ours) -> Any:
        log = package.open(kind)
        return [name_of(next_message(log)) for _ in range(13)]

    assert agree(both, scenario) == [*TYPES * 6, None]


def test_a_post_message_of_a_live_link_that_calls_no_other(both: list[Ours]) -> None:
    def scenario(package: Ours) -> Any:
        port = free_port(socket.SOCK_DGRAM)
        link = package.mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
        heard: list[Any] = []
        link.post_message = lambda msg: heard.append(name_of(msg))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            vehicle.connect(("127.0.0.1", port))
            for seq in range(3):
                vehicle.send(heartbeat(seq))
        link.select(WAIT)
        seen = [name_of(link.recv_msg()), name_of(link.recv_match(condition="True"))]
        link.close()
        return seen, heard, sorted(link.sysid_state)

    assert agree(both, scenario) == (["HEARTBEAT", None], ["HEARTBEAT"] * 3, [0])


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
def test_a_parser_that_finds_nothing_raises_or_is_another_object(
    both: list[Ours], kind: str
) -> None:
    class Other:
        def __init__(self, mav: Any) -> None:
            self.bytes_needed, self.parse_char = mav.bytes_needed, mav.parse_char

    def refuse(_data: bytes) -> None:
        raise KeyError("mine")

    def scenario(package: Ours) -> Any:
        deaf, raising, wrapped = (package.open(kind) for _ in range(3))
        deaf.mav.parse_char = lambda _data: None
        raising.mav.parse_char = refuse
        with pytest.raises(KeyError, match="mine"):
            raising.recv_match(type="ATTITUDE")
        wrapped.mav = Other(wrapped.mav)
        seen = [name_of(wrapped.recv_msg()), name_of(wrapped.recv_match(type="ATTITUDE"))]
        return deaf.recv_msg(), deaf.recv_match(type="ATTITUDE"), seen

    assert agree(both, scenario) == (None, None, ["HEARTBEAT", "ATTITUDE"])


@pytest.mark.parametrize("kind", ["mavlogfile", "mavmmaplog"])
def test_callbacks_of_a_log(both: list[Ours], kind: str) -> None:
    def scenario(package: Ours) -> Any:
        log = package.open(kind)
        log.recv_msg()
        seen: list[Any] = []
        log.mav.set_callback(lambda msg, *extra: seen.append((name_of(msg), extra)), 1)
        log.recv_match(type="ATTITUDE")
        log.mav.callback = lambda msg, *extra: seen.append((extra, name_of(msg)))
        log.recv_msg()
        log.mav.callback = None
        log.recv_msg()
        return seen

    assert len(agree(both, scenario)) >= 2


@pytest.mark.parametrize("name", ["decode", "parse_char"])
def test_a_method_of_the_class_replaced_before_the_log_is_opened(
    both: list[Ours], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def scenario(package: Ours) -> Any:
        calls = []
        original = getattr(package.mavlink.MAVLink, name)

        def replacement(mav: Any, data: Any) -> Any:
            calls.append(bytes(data))
            return original(mav, data)

        with monkeypatch.context() as patch:
            patch.setattr(package.mavlink.MAVLink, name, replacement)
            log = package.open("mavlogfile")
            seen = [name_of(log.recv_msg()), name_of(log.recv_match(type="ATTITUDE"))]
        return seen, len(calls)

    seen, calls = agree(both, scenario)
    assert seen == list(TYPES) and calls


@pytest.mark.parametrize("name", REPLACED)
def test_a_method_of_a_live_link(both: list[Ours], name: str) -> None:
    def scenario(package: Ours) -> Any:
        port = free_port(socket.SOCK_DGRAM)
        link = package.mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            vehicle.connect(("127.0.0.1", port))
            calls: list[Any] = []
            seen = []
            for seq in range(3):
                vehicle.send(heartbeat(seq))
                seen.append(name_of(link.recv_match(blocking=True, timeout=WAIT)))
                if seq == 0:
                    calls = spy(link.mav, name)
            link.close()
        return seen, bool(calls), link.mav_count

    seen, called, count = agree(both, scenario)
    assert (seen, count) == (["HEARTBEAT"] * 3, 3)
    assert called == (name in ("parse_char", "decode"))


def test_what_was_read_ahead_is_shown_to_a_new_parser(both: list[Ours]) -> None:
    """Several frames of one datagram: those behind the first go through the replaced method."""

    def scenario(package: Ours) -> Any:
        port = free_port(socket.SOCK_DGRAM)
        link = package.mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            vehicle.connect(("127.0.0.1", port))
            vehicle.send(b"".join(heartbeat(seq) for seq in range(3)))
            first = link.recv_match(blocking=True, timeout=WAIT)
            link.mav.decode = lambda frame: package.mavlink.MAVLink.decode(link.mav, frame)
            calls = spy(link.mav, "decode")
            rest = [link.recv_match(blocking=True, timeout=WAIT) for _ in range(2)]
            link.close()
        return [msg.get_seq() for msg in (first, *rest)], [bytes(frame)[4] for (frame,) in calls]

    assert agree(both, scenario) == ([0, 1, 2], [1, 2])


@pytest.fixture
def own(tmp_path: Path) -> Iterator[Ours]:
    """mavwire, for what is its own."""
    from mavwire import mavutil

    mavutil.set_wire_protocol("2.0")
    yield Ours("mavwire", tmp_path)
    mavutil.set_wire_protocol(None)
    mavutil.set_dialect("all")


def test_a_method_of_the_class_replaced_later_is_for_later_links(
    own: Ours, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And `buf_len`, which pymavlink's parser calls, is not called: replacing it warns."""
    earlier = own.open("mavlogfile")
    with pytest.warns(RuntimeWarning, match="does not call it"):
        asked = spy(earlier.mav, "buf_len")
    calls: list[Any] = []
    original = own.mavlink.MAVLink.decode

    def replacement(mav: Any, frame: Any) -> Any:
        calls.append(mav)
        return original(mav, frame)

    monkeypatch.setattr(own.mavlink.MAVLink, "decode", replacement)
    later = own.open("mavlogfile")
    assert name_of(earlier.recv_msg()) == name_of(later.recv_msg()) == "HEARTBEAT"
    assert (calls, asked) == ([later.mav], [])


def test_a_partial_frame_is_dropped_and_the_replaced_method_stays(own: Ours) -> None:
    """A peer that is gone leaves half a frame behind, which is forgotten, and nothing else is."""
    log = own.open("mavlogfile")
    log.recv_msg()
    before = log.mav.total_bytes_received
    calls = spy(log.mav, "parse_char")
    log.mav.parse_char(heartbeat()[:9])
    log._drop_partial()
    assert (log.mav.buf_len(), log.mav.total_bytes_received) == (0, before)
    calls.clear()
    assert log.recv_msg().get_type() == "ATTITUDE"
    assert calls


@pytest.mark.parametrize("place", ["pack", "encode", "init", "patched"])
def test_x_send_calls_what_was_replaced_in_classes_before_its_first_use(
    subject: str, oracle: str, place: str
) -> None:
    program = f"""
import io, sys
from unittest import mock
from {{}}.dialects.v20 import common as m
calls, cls = [], m.MAVLink_heartbeat_message
def noting(function):
    def wrapper(*args, **kwargs):
        calls.append(function)
        return function(*args, **kwargs)
    return wrapper
def send():
    out = io.BytesIO()
    mav = m.MAVLink(out, 1, 1)
    mav.heartbeat_send(2, 3, 81, 4, 4, 3)
    mav.system_time_send(1, 2)
    return out.getvalue().hex()
if {place!r} == "pack":
    cls.pack = noting(cls.pack)
elif {place!r} == "encode":
    m.MAVLink.heartbeat_encode = noting(m.MAVLink.heartbeat_encode)
elif {place!r} == "init":
    cls.__init__ = noting(cls.__init__)
else:
    with mock.patch.object(cls, "pack", noting(cls.pack)):
        with mock.patch.object(m.MAVLink, "heartbeat_encode", noting(m.MAVLink.heartbeat_encode)):
            send()
print(send(), len(calls))
"""
    ours, theirs = (
        subprocess.run(
            [sys.executable, "-c", program.format(name)],
            capture_output=True, text=True, check=True,
        ).stdout
        for name in (subject, oracle)
    )  # fmt: skip
    assert ours == theirs
    assert ours.split()[1] == ("2" if place == "patched" else "1")


@pytest.mark.parametrize("base", [False, True])
@pytest.mark.parametrize("name", ["to_dict", "format_attr"])
def test_texts_call_what_was_replaced_in_message_classes(
    both: list[Ours], name: str, base: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def scenario(package: Ours) -> Any:
        mavlink, calls = package.mavlink, list[str]()
        cls = mavlink.MAVLink_message if base else mavlink.MAVLink_attitude_message
        with monkeypatch.context() as patch:
            replaced_in(cls, name, calls, patch)
            msg = mavlink.MAVLink(None).parse_buffer(bytearray(frames()[1]))[0]
            return [(ask(msg), calls.copy()) for ask in (str, type(msg).to_json, type(msg).to_dict)]

    assert agree(both, scenario)[-1][1]


@pytest.mark.parametrize("name", ["_pack", "sign_packet"])
def test_what_is_never_called_warns_before_the_first_message(subject: str, name: str) -> None:
    program = (
        f"from {subject}.dialects.v20 import common as m\n"
        f"m.MAVLink_message.{name} = print\n"
        "m.MAVLink(None).heartbeat_encode(1, 2, 3, 4, 5)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], check=False, capture_output=True, text=True
    )
    assert f"RuntimeWarning: MAVLink_heartbeat_message.{name} was replaced" in done.stderr


def test_a_scan_timestamp_of_the_program_warns(both: list[Ours]) -> None:
    ours = both[0]

    class Log(ours.mavutil.mavlogfile):  # type: ignore[name-defined]
        def scan_timestamp(self, tbuf: bytes) -> float:
            return 0.0

    with pytest.warns(RuntimeWarning, match="mavlogfile.scan_timestamp was replaced"):
        Log(str(ours.log)).close()


# Class -> its module, and what uses it.
CLASSES: dict[str, tuple[str, Callable[[workload.Package, Any], None]]] = {
    "mavfile": ("mavutil", workload.bare_link),
    "mavlogfile": ("mavutil", workload.telemetry_log),
    "mavmmaplog": ("mavutil", workload.telemetry_log),
    "mavudp": ("mavutil", workload.udpin),
    "mavtcp": ("mavutil", workload.tcp),
    "mavtcpin": ("mavutil", workload.tcpin),
    "DFReader_binary": (
        "DFReader", lambda of, cls: workload.dataflash_log(cls(of.file("flight.bin"))),
    ),
    "DFReader_text": (
        "DFReader", lambda of, cls: workload.dataflash_log(cls(of.file("flight.log"))),
    ),
    "CSVReader": ("CSVReader", lambda of, cls: workload.csv_rows(cls(of.file("flight.csv")))),
    "DFFormat": ("DFReader", workload.record_type),
    "DFReaderClock_usec": ("DFReader", workload.clock),
    "DFReaderClock_msec": ("DFReader", workload.clock),
    "DFReaderClock_gps_interpolated": ("DFReader", workload.clock),
    "MAVLink": ("dialects.v20.all", workload.parser),
    "MAVLink_heartbeat_message": ("dialects.v20.all", workload.message),
}  # fmt: skip


def methods_of(cls: Any) -> list[str]:
    """Public methods and properties of the reference's class, and those with one underscore."""
    found = set()
    for base in cls.__mro__[:-1]:
        for name, value in vars(base).items():
            if name.startswith("__") or "__" in name[1:]:  # the class's own business
                continue
            # Of some hundred methods that are made alike.
            if name.endswith(("_send", "_encode")) and not name.startswith(("heartbeat", "way")):
                continue
            if callable(value) or isinstance(value, property):
                found.add(name)
    return sorted(found)


def overridden(cls: Any, name: str, calls: list[str]) -> Any:
    """A class derived from `cls` that notes when its method or property is used."""
    value = inspect.getattr_static(cls, name)
    body: Any
    if callable(value):

        def body(self: Any, *args: Any, **kwargs: Any) -> Any:
            calls.append(name)
            return getattr(super(derived, self), name)(*args, **kwargs)
    else:

        def get(self: Any) -> Any:
            calls.append(name)
            return getattr(super(derived, self), name)

        body = property(get, lambda self, new: value.__set__(self, new))
    derived: Any = type(cls.__name__, (cls,), {name: body, "__module__": "mine"})
    return derived


def replaced_in(cls: Any, name: str, calls: list[str], patch: pytest.MonkeyPatch) -> Any:
    """`cls` with another method of its own."""
    original = getattr(cls, name)

    def method(self: Any, *args: Any, **kwargs: Any) -> Any:
        calls.append(name)
        return original(self, *args, **kwargs)

    patch.setattr(cls, name, method)
    return cls


def is_used(package: workload.Package, kind: str, name: str, way: str) -> bool | str:
    """Whether ordinary use calls the method `name` that a program has replaced, or "warns"."""
    module, use = CLASSES[kind]
    package.mavutil.set_dialect("all")
    package.mavutil.global_link_id = 0
    cls = getattr(package.module(module), kind)
    calls: list[str] = []
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        if way == "derived":
            cls = overridden(cls, name, calls)
        elif inspect.isroutine(inspect.getattr_static(cls, name)):
            cls = replaced_in(cls, name, calls, patch)
        package.use([lambda of: use(of, cls)])
    return bool(calls) or any("does not call it" in str(one.message) for one in said)


@pytest.mark.parametrize("way", ["derived", "in the class"])
@pytest.mark.parametrize("kind", CLASSES)
def test_overridden_methods_are_called_or_warn(
    kind: str, way: str, subject: str, oracle: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a class of the program's own, and replaced in ours before an object is made."""
    monkeypatch.setenv("MAVLINK20", "1")
    ours, theirs = (workload.Package(name, tmp_path) for name in (subject, oracle))
    names = methods_of(getattr(theirs.module(CLASSES[kind][0]), kind))
    called = [name for name in names if is_used(theirs, kind, name, way)]
    assert called
    never = [
        name for name in called if (kind, name) not in LEFT and not is_used(ours, kind, name, way)
    ]
    assert not never


# Not called, as docs/compatibility.md says: methods assigned to a message class.
LEFT = (("MAVLink_heartbeat_message", "_pack"), ("MAVLink_heartbeat_message", "sign_packet"))
